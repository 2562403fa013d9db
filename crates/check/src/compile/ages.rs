//! Comparisons of an age with a constant: when, after a message, their value changes.

use lapwing_engine::program::{self as engine, AgeFlips};
use lapwing_stream::Duration;

use super::below;
use crate::checked::{self, Clock, EventSource, Expr, Kind};
use crate::constant::constant;

/// The flips that make instants for a property: those of its formula, and those of the machines that it reads.
pub(crate) fn of_property(spec: &checked::Spec, property: &checked::Property, formula: &Expr) -> Vec<AgeFlips> {
    let mut flips = of_expr(spec, formula);
    for &machine in &property.machines {
        merge(&mut flips, of_machine(spec, &spec.machines[machine]));
    }
    for &event in property.alphabet.iter().flatten() {
        merge(&mut flips, of_event(spec, event));
    }
    flips
}

/// The flips at which a machine may enter or leave a state, where that is what the event is.
fn of_event(spec: &checked::Spec, event: usize) -> Vec<AgeFlips> {
    match spec.events[event].source {
        EventSource::Entered { machine, .. } | EventSource::Left { machine, .. } => {
            of_machine(spec, &spec.machines[machine])
        }
        _ => Vec::new(),
    }
}

/// The flips that make instants for a machine.
pub(crate) fn of_machine(spec: &checked::Spec, machine: &checked::Machine) -> Vec<AgeFlips> {
    let mut flips = Vec::new();
    for e in machine.conditions() {
        merge(&mut flips, of_expr(spec, e));
    }
    let events = machine.states.iter().filter_map(|s| s.on).chain(machine.edges.iter().filter_map(|e| e.on));
    for event in events {
        merge(&mut flips, of_event(spec, event));
    }
    flips
}

fn merge(into: &mut Vec<AgeFlips>, more: Vec<AgeFlips>) {
    for flips in more {
        if !into.contains(&flips) {
            into.push(flips);
        }
    }
}

fn of_expr(spec: &checked::Spec, e: &Expr) -> Vec<AgeFlips> {
    let mut flips = Vec::new();
    if spec.clock != Clock::Events {
        return flips;
    }
    below(e, &mut |e| match e.kind {
        Kind::Compare { op, ref margin, ref left, ref right } => {
            let margin = margin.as_deref().map_or(Some(0.0), constant);
            let found = match (&left.kind, &right.kind) {
                (Kind::Age(topic), _) => constant(right).map(|c| (*topic, c, true)),
                (_, Kind::Age(topic)) => constant(left).map(|c| (*topic, c, false)),
                _ => None,
            };
            if let (Some((topic, constant, age_left)), Some(margin)) = (found, margin) {
                let after = changes(&Comparison { op: super::expr::compare(op), constant, margin, age_left });
                merge(&mut flips, vec![AgeFlips { topic, after }]);
            }
        }
        Kind::Event(event) => merge(&mut flips, of_event(spec, event)),
        Kind::InState { machine, .. } => {
            if let Some(machine) = spec.machines.get(machine) {
                merge(&mut flips, of_machine(spec, machine));
            }
        }
        _ => {}
    });
    flips
}

/// A comparison of an age with a constant.
struct Comparison {
    op: engine::Compare,
    constant: f64,
    margin: f64,
    age_left: bool,
}

impl Comparison {
    /// Its value so many nanoseconds after a message, by the very arithmetic that evaluates it, sides and all.
    fn holds(&self, nanos: i64) -> bool {
        let age = Duration::from_nanos(nanos).seconds();
        let (left, right) = if self.age_left { (age, self.constant) } else { (self.constant, age) };
        lapwing_engine::compare(self.op, left, right, self.margin)
    }
}

/// The distances from a message, from a nanosecond on, at which the comparison of the age differs from what it was just before.
///
/// The age only grows, so that a comparison is true in one stretch at most: its ends are found by bisection over whole nanoseconds.
fn changes(comparison: &Comparison) -> Vec<Duration> {
    let holds = |nanos| comparison.holds(nanos);
    let ends = match comparison.op {
        engine::Compare::Eq | engine::Compare::Ne => {
            let is_equal = |n| Comparison { op: engine::Compare::Eq, ..*comparison }.holds(n);
            let age = |n: i64| Duration::from_nanos(n).seconds();
            let begins = first(|n| age(n) >= comparison.constant || is_equal(n));
            let over = first(|n| age(n) > comparison.constant && !is_equal(n));
            vec![begins, over]
        }
        _ => {
            let before = holds(0);
            vec![first(|n| holds(n) != before)]
        }
    };
    let mut ends: Vec<i64> = ends.into_iter().flatten().filter(|&n| n > 0 && holds(n) != holds(n - 1)).collect();
    ends.sort_unstable();
    ends.dedup();
    ends.into_iter().map(Duration::from_nanos).collect()
}

/// The first whole nanosecond at which a condition that stays true once it is holds.
fn first(holds: impl Fn(i64) -> bool) -> Option<i64> {
    let (mut lo, mut hi) = (0, i64::MAX / 4);
    if !holds(hi) {
        return None;
    }
    while lo < hi {
        let middle = lo + (hi - lo) / 2;
        if holds(middle) { hi = middle } else { lo = middle + 1 }
    }
    Some(lo)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nanos(op: engine::Compare, constant: f64, margin: f64) -> Vec<i64> {
        let comparison = Comparison { op, constant, margin, age_left: true };
        changes(&comparison).into_iter().map(Duration::nanos).collect()
    }

    #[test]
    fn an_age_crosses_a_constant_once() {
        assert_eq!(nanos(engine::Compare::Lt, 0.1, 0.0), [100_000_000]);
        assert_eq!(nanos(engine::Compare::Le, 0.1, 0.0), [100_000_001]);
        assert_eq!(nanos(engine::Compare::Gt, 0.1, 0.0), [100_000_001]);
        assert_eq!(nanos(engine::Compare::Ge, 0.1, 0.0), [100_000_000]);
        assert_eq!(nanos(engine::Compare::Gt, -1.0, 0.0), []);
    }

    #[test]
    fn the_side_of_the_age_matters_where_a_margin_rounds() {
        let right = Comparison { op: engine::Compare::Gt, constant: 0.2, margin: 1.0, age_left: false };
        assert_eq!(changes(&right), [Duration::from_nanos(1_200_000_001)]);
        assert_eq!(nanos(engine::Compare::Lt, 0.2, 1.0), [1_200_000_000]);
    }

    #[test]
    fn equality_begins_and_ends() {
        assert_eq!(nanos(engine::Compare::Eq, 0.1, 0.0), [100_000_000, 100_000_001]);
        assert_eq!(nanos(engine::Compare::Ne, 1.0, 0.5), [500_000_000, 1_500_000_001]);
        assert_eq!(nanos(engine::Compare::Eq, 0.0, 0.5), [500_000_001]);
    }
}
