//! When a failure of a formula is known, and what has to be remembered for it.

use lapwing_check::checked::{Bound, Connective, Expr, Kind, Scope};
use lapwing_check::compile::OPEN_LIMIT;
use lapwing_stream::Duration;

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
pub(super) fn known(formula: &Expr) -> String {
    match fails(formula, false) {
        Known::AtOnce => "at once".to_owned(),
        Known::Within(d) => format!("at the latest {d} after what fails began"),
        Known::Next => "at the next instant".to_owned(),
        Known::Closed => "at the latest when what it stands in is over".to_owned(),
        Known::Never => "only at the end: what has not happened may still happen (then it is `unmet`)".to_owned(),
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

/// What has to be remembered for a formula, in words.
pub(super) fn memory(formula: &Expr) -> String {
    let mut parts = Vec::new();
    gather(formula, &mut parts);
    if formula.has_future() && fails(formula, false) != Known::AtOnce {
        parts.push(format!("open obligations as runs, at most {OPEN_LIMIT}"));
    }
    parts.dedup();
    match parts.is_empty() {
        true => "constant".to_owned(),
        false => parts.join("; "),
    }
}

fn gather(e: &Expr, parts: &mut Vec<String>) {
    match &e.kind {
        Kind::Window(_, _, over) => parts.push(format!("the values of the last {over}")),
        Kind::Frequency(_, over) => parts.push(format!("the stamps of the last {over}")),
        Kind::Lookback(_, depth) => parts.push(format!("{depth} values back")),
        _ => {}
    }
    e.children().into_iter().for_each(|c| gather(c, parts));
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
        assert_eq!(costs("never p"), ("at once".into(), "constant".into()));
        let within = costs("whenever p, eventually within 2 s q");
        assert_eq!(within.0, "at the latest 2 s after what fails began");
        assert_eq!(
            costs("eventually p").0,
            "only at the end: what has not happened may still happen (then it is `unmet`)"
        );
        assert_eq!(costs("after_until p, q, eventually p").0, "at the latest when what it stands in is over");
        assert_eq!(costs("after p, never q").0, "at once");
    }
}
