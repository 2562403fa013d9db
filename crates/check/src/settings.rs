//! Settings: the clock, the timeout, the default margin.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_stream::Duration;
use lapwing_syntax::ast::{ItemKind, Number, Setting};

use crate::checked::{Clock, Dim};
use crate::context::{Cx, Env};
use crate::dims::in_si;

/// Rates above this are no clock of a monitor.
const FASTEST: f64 = 1_000_000_000.0;

/// Reads the settings of the file; those of used files are their own.
pub(crate) fn read(cx: &mut Cx) {
    let env = Env::default();
    let names = cx.names;
    let mut seen: Vec<(std::mem::Discriminant<Setting>, Span)> = Vec::new();
    let mut clocks: Vec<(bool, Span)> = Vec::new();
    for entry in names.items.iter().filter(|e| !e.library) {
        let ItemKind::Setting(setting) = &entry.item.kind else { continue };
        let (span, kind) = (entry.item.span, std::mem::discriminant(setting));
        if let Some((_, first)) = seen.iter().find(|(k, _)| *k == kind) {
            let diagnostic =
                Diagnostic::new(Code::DuplicateName, span, "this is set twice").also(*first, "first set here");
            cx.report(&env, diagnostic);
            continue;
        }
        seen.push((kind, span));
        match setting {
            Setting::Rate(number) => {
                clocks.push((true, span));
                rate(cx, &env, number);
            }
            Setting::ClockEvents => clocks.push((false, span)),
            Setting::Timeout(number) => timeout(cx, &env, number),
            Setting::Margin(number) => margin(cx, &env, number),
        }
    }
    if let [(_, first), (_, second)] = clocks.as_slice() {
        let message = "a rate and `clock events` contradict each other";
        let diagnostic = Diagnostic::new(Code::ClockConflict, *second, message)
            .label("one of the two must go")
            .also(*first, "the other clock")
            .help("`clock events` looks at every message and is the default; a rate looks so many times a second");
        cx.report(&env, diagnostic);
    }
    guards(cx, &env, &clocks);
}

/// A guard decides message by message; between the instants of a rate it could not.
fn guards(cx: &mut Cx, env: &Env, clocks: &[(bool, Span)]) {
    let Some((_, rate)) = clocks.iter().find(|(is_rate, _)| *is_rate) else { return };
    let names = cx.names;
    for entry in names.items.iter().filter(|e| !e.library && matches!(e.item.kind, ItemKind::Guard(_))) {
        let message = "a guard must see every message, and a rate does not";
        let diagnostic = Diagnostic::new(Code::ClockConflict, entry.item.span, message)
            .also(*rate, "the rate is set here")
            .help("leave the rate out, or put the guard into a file of its own");
        cx.report(env, diagnostic);
    }
}

/// What is no whole number has been reported by the parser.
fn rate(cx: &mut Cx, env: &Env, number: &Number) {
    let (hertz, dim) = number.unit.map_or((number.value, Dim::FREQUENCY), |unit| in_si(number.value, unit));
    if dim != Dim::FREQUENCY || hertz > FASTEST {
        bad(cx, env, number, "a rate is a number of instants a second, at most a thousand million");
    } else if hertz.fract() == 0.0 && hertz >= 1.0 {
        cx.spec.clock = Clock::Rate(hertz as u32);
    }
}

fn timeout(cx: &mut Cx, env: &Env, number: &Number) {
    let scale = match number.unit {
        None => Some(1_000_000_000),
        Some(unit) => unit.nanoseconds(),
    };
    match scale.map(|scale| lapwing_syntax::nanoseconds(&number.text, scale)) {
        Some(Ok(0)) => cx.spec.timeout = None,
        Some(Ok(nanos)) => cx.spec.timeout = Some(Duration::from_nanos(nanos)),
        _ => bad(cx, env, number, "a timeout is a time in seconds"),
    }
}

fn margin(cx: &mut Cx, env: &Env, number: &Number) {
    let value = number.unit.map_or(number.value, |unit| in_si(number.value, unit).0);
    if value >= 0.0 && value.is_finite() {
        cx.margin = Some(value);
        return;
    }
    bad(cx, env, number, "a margin is a number that is not negative");
}

fn bad(cx: &mut Cx, env: &Env, number: &Number, message: &str) {
    cx.report(env, Diagnostic::new(Code::BadSetting, number.span, message).label("not such a number"));
}
