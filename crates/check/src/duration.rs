//! Durations: literals, and names that stand for them.

use lapwing_diag::{Code, Diagnostic};
use lapwing_stream::Duration;
use lapwing_syntax::DurationError;
use lapwing_syntax::ast::{self, ExprKind};

use crate::constant::{constant, says_seconds};
use crate::context::{Cx, Env};
use crate::names::Named;

impl Cx<'_> {
    /// A duration as it stands in a bound; `None` where an error has been reported, or where a parameter may stand for anything.
    pub fn duration(&mut self, env: &Env, duration: &ast::Dur) -> Option<Duration> {
        match duration {
            ast::Dur::Literal(duration, _) => Some(*duration),
            ast::Dur::Name(name) => {
                let path = ast::Expr { kind: ExprKind::Path(vec![name.clone()]), span: name.span, parens: false };
                self.duration_of(env, &path)
            }
        }
    }

    /// The duration that an expression stands for: a literal exactly, anything else to the nearest nanosecond.
    pub fn duration_of(&mut self, env: &Env, expr: &ast::Expr) -> Option<Duration> {
        if !self.allows(env, expr.span) {
            return None;
        }
        match &expr.kind {
            ExprKind::Number(number) => self.literal_duration(env, number),
            ExprKind::Path(idents) if idents.len() == 1 => {
                let name = idents[0].name.as_str();
                if let Some((_, arg)) = env.params.iter().find(|(param, _)| *param == name) {
                    let caller = env.caller.map_or_else(Env::default, Env::clone);
                    return self.duration_of(&Env { depth: env.depth + 1, ..caller }, arg);
                }
                match self.names.get(name) {
                    Some(Named::Formula(f)) if f.each.is_empty() && !self.graph.is_cyclic(f.item) => {
                        self.duration_of(&env.of_definition(), f.body)
                    }
                    _ => self.computed_duration(env, expr),
                }
            }
            _ => self.computed_duration(env, expr),
        }
    }

    fn literal_duration(&mut self, env: &Env, number: &ast::Number) -> Option<Duration> {
        let Some(scale) = number.unit.and_then(|u| u.nanoseconds()) else {
            let mut diagnostic =
                Diagnostic::new(Code::NotADuration, number.span, "a duration is wanted here").label("no unit of time");
            if number.unit.is_none() {
                let with_unit = format!("{} s", number.text);
                diagnostic = diagnostic.help(format!("in seconds it is `{with_unit}`")).fix(number.span, with_unit);
            }
            self.report(env, diagnostic);
            return None;
        };
        match lapwing_syntax::nanoseconds(&number.text, scale) {
            Ok(nanos) => Some(Duration::from_nanos(nanos)),
            // The parser has reported it, wherever it stands.
            Err(DurationError::TooShort) => {
                self.found.failed = true;
                None
            }
            Err(DurationError::TooLong) => {
                let message = "a duration is at least 1 ns and at most 292 years";
                self.report(env, Diagnostic::new(Code::DurationRange, number.span, message));
                None
            }
        }
    }

    fn computed_duration(&mut self, env: &Env, expr: &ast::Expr) -> Option<Duration> {
        let lowered = self.lower(env, expr).value(self, env);
        if self.found.failed || env.is_open(expr) {
            return None;
        }
        let Some(seconds) = constant(&lowered).filter(|_| says_seconds(&lowered)) else {
            let diagnostic = Diagnostic::new(Code::NotADuration, expr.span, "a duration is wanted here")
                .label("this is none that is known beforehand")
                .help("write it with a unit, `500 ms`, or name one: `limit = 500 ms`");
            self.report(env, diagnostic);
            return None;
        };
        let nanos = (seconds * 1e9).round_ties_even();
        if !(0.0..9.2e18).contains(&nanos) || (nanos == 0.0 && seconds != 0.0) {
            let message = "a duration is at least 1 ns and at most 292 years";
            self.report(env, Diagnostic::new(Code::DurationRange, expr.span, message));
            return None;
        }
        Some(Duration::from_nanos(nanos as i64))
    }
}
