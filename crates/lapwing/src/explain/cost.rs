//! When a failure of a formula is known, and what has to be remembered for it.

use lapwing_check::checked::{Bound, Clock, Connective, Expr, Kind, Scope, Spec, Window};
use lapwing_check::compile::OPEN_LIMIT;
use lapwing_stream::{Duration, Time, Type, Value};

/// When something is known, from the soonest to the latest.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Known {
    AtOnce,
    Within(Duration),
    /// At the next instant.
    Next,
    /// When what it stands in is over.
    Closed,
    /// Never before the recording ends.
    Never,
}

/// When a failure of a property is known, in words.
pub(super) fn known(formula: &Expr, clock: Clock) -> String {
    let known = match fails(formula, false) {
        Known::AtOnce => "at once".to_owned(),
        Known::Within(d) => format!("at the latest {d} after what fails began"),
        Known::Next => "at the next instant".to_owned(),
        Known::Closed => "at the latest when what it stands in is over".to_owned(),
        Known::Never => "only at the end: what has not happened may still happen (then it is `unmet`)".to_owned(),
    };
    match clock {
        Clock::Events => known,
        Clock::Rate(hz) => {
            let period = Duration::from_nanos(1_000_000_000_u64.div_ceil(u64::from(hz.max(1))) as i64);
            format!("{known}; what happens is seen up to {period} later, at the next of {hz} instants a second")
        }
    }
}

/// When a failure of a machine is known, and what it keeps.
pub(super) fn of_machine(meaning: &Spec, number: usize) -> (String, String) {
    match longest_stay(meaning, number) {
        None => ("at once".to_owned(), "the current state".to_owned()),
        Some(stay) => (
            format!("at once; of a stay that is too short or too long, at the latest {stay} after it began"),
            "the current state, and since when it is".to_owned(),
        ),
    }
}

/// The longest bound on staying in a state of a machine: so long ago what fails may have begun.
pub(super) fn longest_stay(meaning: &Spec, number: usize) -> Option<Duration> {
    let states = meaning.machines.get(number).into_iter().flat_map(|machine| &machine.states);
    states.flat_map(|state| [state.at_most, state.at_least]).flatten().max()
}

/// How long after it began a failure is known at the latest; `None` where nothing bounds that.
pub(super) fn latency(formula: &Expr) -> Option<Duration> {
    match fails(formula, false) {
        Known::Within(d) => Some(d),
        Known::AtOnce | Known::Next | Known::Never => Some(Duration::ZERO),
        Known::Closed => None,
    }
}

/// When it is known that an obligation of the formula failed; inside a segment that closes nothing stays unknown.
fn fails(e: &Expr, closes: bool) -> Known {
    if !e.has_future() {
        return Known::AtOnce;
    }
    let unbounded = if closes { Known::Closed } else { Known::Never };
    match &e.kind {
        Kind::Always(_, of) => fails(of, closes),
        Kind::Eventually(bound, of) | Kind::Until(bound, _, of) => end(bound, unbounded).and(fails(of, closes)),
        Kind::Next(of) => Known::Next.and(fails(of, closes)),
        Kind::Not(of) => holds(of, closes),
        Kind::Connective(Connective::Implies, l, r) => holds(l, closes).and(fails(r, closes)),
        Kind::Connective(Connective::Iff, l, r) => {
            [l, r].map(|e| fails(e, closes).and(holds(e, closes))).into_iter().fold(Known::AtOnce, Known::and)
        }
        Kind::Connective(_, l, r) => fails(l, closes).and(fails(r, closes)),
        Kind::Scope(Scope::After, _, body) | Kind::Scope(Scope::Whenever, _, body) => fails(body, closes),
        Kind::Scope(Scope::Before, ..) => Known::Closed,
        Kind::Scope(Scope::Until, _, body) => unbounded.max(fails(body, true)),
        Kind::Scope(Scope::While, _, body) | Kind::AfterUntil(_, _, body) => fails(body, true),
        _ => unbounded,
    }
}

/// When it is known that a formula is true.
fn holds(e: &Expr, closes: bool) -> Known {
    if !e.has_future() {
        return Known::AtOnce;
    }
    let unbounded = if closes { Known::Closed } else { Known::Never };
    match &e.kind {
        Kind::Always(bound, of) => end(bound, unbounded).and(holds(of, closes)),
        Kind::Eventually(_, of) | Kind::Until(_, _, of) => holds(of, closes),
        Kind::Next(of) => Known::Next.and(holds(of, closes)),
        Kind::Not(of) => fails(of, closes),
        Kind::Connective(Connective::Implies, l, r) => fails(l, closes).and(holds(r, closes)),
        Kind::Connective(_, l, r) => holds(l, closes).and(holds(r, closes)),
        _ => unbounded,
    }
}

fn end(bound: &Bound, unbounded: Known) -> Known {
    bound.hi.map_or(unbounded, Known::Within)
}

impl Known {
    /// One after the other.
    fn and(self, then: Known) -> Known {
        match (self, then) {
            (Known::Within(a), Known::Within(b)) => {
                Known::Within(Duration::from_nanos(a.nanos().saturating_add(b.nanos())))
            }
            (a, b) => a.max(b),
        }
    }
}

/// What has to be remembered for a formula beside its latest values, in words, with the bytes where they are known beforehand.
pub(super) fn memory(formula: &Expr, clock: Clock) -> String {
    let mut parts = Vec::new();
    gather(formula, clock, &mut parts);
    if formula.has_future() && fails(formula, false) != Known::AtOnce {
        parts.push(format!("open obligations, neighbours that fare alike as one: at most {OPEN_LIMIT} of these"));
    }
    parts.dedup();
    match parts.is_empty() {
        true => "constant: nothing but the latest values".to_owned(),
        false => parts.join("; "),
    }
}

/// The bytes of a stamp, and of a number with its stamp.
const STAMP: i64 = size_of::<Time>() as i64;
const NUMBER: i64 = STAMP + size_of::<f64>() as i64;

fn gather(e: &Expr, clock: Clock, parts: &mut Vec<String>) {
    match &e.kind {
        Kind::Window(Window::Count, _, over) => parts.push(window("the stamps", *over, STAMP, clock)),
        Kind::Window(_, _, over) => parts.push(window("the numbers", *over, NUMBER, clock)),
        Kind::Frequency(_, over) => {
            parts.push(format!("the stamps of the messages of the last {over}, {STAMP} bytes each"));
        }
        Kind::Lookback(of, depth) => {
            let bytes = depth * size_of::<Value>();
            let more =
                if matches!(of.ty, Type::Num { .. } | Type::Bool) { "" } else { " and what texts and arrays take" };
            parts.push(format!("{depth} values back: {bytes} bytes{more}"));
        }
        Kind::Once(bound, _) | Kind::Historically(bound, _) | Kind::Since(bound, ..) => {
            // What begins where it stands needs the latest stamp alone.
            if let (Some(hi), false) = (bound.hi, bound.lo.nanos() == 0 && bound.lo_closed) {
                parts.push(window("the stamps", hi, STAMP, clock));
            }
        }
        _ => {}
    }
    e.children().into_iter().for_each(|c| gather(c, clock, parts));
}

/// What is kept of the instants of a window: of a rate it is known how many there are.
fn window(what: &str, over: Duration, each: i64, clock: Clock) -> String {
    match clock {
        Clock::Events => format!("{what} of the instants of the last {over}, {each} bytes each"),
        Clock::Rate(hz) => {
            let count = i128::from(over.nanos()) * i128::from(hz) / 1_000_000_000 + 2;
            format!("{what} of the last {over}: at most {count}, {} bytes", count * i128::from(each))
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::Spec;
    use crate::explain::explain;

    fn costs(formula: &str) -> (String, String) {
        let spec = Spec::parse("t.rv", &format!("event p\nevent q\n{formula}\n"), &|_| None).unwrap();
        let explained = explain(&spec, None, &Default::default(), lapwing_diag::Style::Plain).unwrap();
        let property = &explained.properties[0];
        (property.known.clone(), property.memory.clone())
    }

    #[test]
    fn failures_are_known_at_once_at_a_deadline_when_a_scope_closes_or_never() {
        assert_eq!(costs("never p"), ("at once".into(), "constant: nothing but the latest values".into()));
        let within = costs("whenever p, eventually within 2 s q");
        assert_eq!(within.0, "at the latest 2 s after what fails began");
        assert_eq!(
            costs("eventually p").0,
            "only at the end: what has not happened may still happen (then it is `unmet`)"
        );
        assert_eq!(costs("after_until p, q, eventually p").0, "at the latest when what it stands in is over");
        assert_eq!(costs("after p, never q").0, "at once");
    }

    #[test]
    fn a_rate_bounds_what_a_window_takes_and_delays_what_is_seen() {
        let text = "__rate__ = 10\nevent p\nnever p and count(p, 2 s) > 3\n";
        let spec = Spec::parse("t.rv", text, &|_| None).unwrap();
        let explained = explain(&spec, None, &Default::default(), lapwing_diag::Style::Plain).unwrap();
        let property = &explained.properties[0];
        assert_eq!(property.memory, "the stamps of the last 2 s: at most 22, 176 bytes");
        assert!(property.known.starts_with("at once; what happens is seen up to 100 ms later"), "{}", property.known);
        assert_eq!(
            costs("never @{p, -3}").1,
            format!("3 values back: {} bytes", 3 * size_of::<lapwing_stream::Value>())
        );
    }
}
