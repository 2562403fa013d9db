//! The instants of one property: those of the clock, and those that a comparison of an age with a constant makes
//! (language reference, *Traces, instants, values*).

use crate::course::{Course, Needs};
use crate::machines;
use crate::piece::{Instant, Piece};
use crate::values;
use lapwing_check::checked::{Clock, Compare, Expr, Kind};
use lapwing_stream::{Duration, Time, Value};

/// All instants of what has these needs, in order.
pub(crate) fn of(piece: &Piece<'_>, needs: &Needs<'_>) -> Vec<Instant> {
    let mut instants = piece.clock_instants();
    if piece.spec.clock != Clock::Events {
        return instants;
    }
    let params: Vec<Value> = needs.slices.iter().map(|(_, v)| v.clone()).collect();
    let constants = Course::constants(piece, params);
    for comparison in all_ages(piece, needs) {
        for time in comparison.changes(piece, &constants) {
            let goes_on = time < piece.last;
            if goes_on && instants.iter().all(|i| i.time != time) {
                let arrived = piece.arrived(time);
                instants.push(Instant { time, from: arrived, upto: arrived });
            }
        }
    }
    instants.sort_by_key(Instant::key);
    instants
}

/// The comparisons of ages in a property and in the machines that it reads.
fn all_ages<'a>(piece: &Piece<'a>, needs: &Needs<'a>) -> Vec<AgeComparison<'a>> {
    let mut found = Vec::new();
    for e in &needs.exprs {
        ages(e, &mut found);
    }
    let alphabet = needs.alphabet.unwrap_or_default();
    for machine in machines::read_by(piece.spec, &needs.exprs, &needs.machines, alphabet) {
        for e in machines::exprs(&piece.spec.machines[machine]) {
            ages(e, &mut found);
        }
    }
    found
}

/// `age(topic) op constant`, or the other way round.
struct AgeComparison<'a> {
    topic: usize,
    op: Compare,
    margin: Option<&'a Expr>,
    constant: &'a Expr,
    age_is_left: bool,
}

fn ages<'a>(e: &'a Expr, found: &mut Vec<AgeComparison<'a>>) {
    if let Kind::Compare { op, margin, left, right } = &e.kind {
        let margin = margin.as_deref();
        let constants = margin.is_none_or(is_constant);
        match (&left.kind, &right.kind) {
            (Kind::Age(topic), _) if constants && is_constant(right) => {
                found.push(AgeComparison { topic: *topic, op: *op, margin, constant: right, age_is_left: true });
            }
            (_, Kind::Age(topic)) if constants && is_constant(left) => {
                found.push(AgeComparison { topic: *topic, op: *op, margin, constant: left, age_is_left: false });
            }
            _ => {}
        }
    }
    for child in e.children() {
        ages(child, found);
    }
}

/// Whether an expression names nothing that a trace could change.
fn is_constant(e: &Expr) -> bool {
    let itself = matches!(
        e.kind,
        Kind::Num(_) | Kind::Bool(_) | Kind::Str(_) | Kind::Param(_) | Kind::Neg(_) | Kind::Arith(..) | Kind::Call(..)
    );
    itself && e.children().into_iter().all(is_constant)
}

impl AgeComparison<'_> {
    /// The stamps at which the comparison's value is not what it was a nanosecond before, messages of the topic aside.
    fn changes(&self, piece: &Piece<'_>, constants: &Course<'_>) -> Vec<Time> {
        let constant = constants.value(self.constant, 0);
        let margin = self.margin.map_or(Value::Num(0.0), |m| constants.value(m, 0));
        let holds = |nanos: i64| {
            let age = Value::Num(Duration::from_nanos(nanos).seconds());
            let (left, right) = if self.age_is_left { (&age, &constant) } else { (&constant, &age) };
            values::compare(self.op, &margin, left, right).unwrap_or(false)
        };
        let Value::Num(limit) = constant else { return Vec::new() };
        let reaches = |nanos: i64| Duration::from_nanos(nanos).seconds() >= limit;

        let messages = piece.messages(self.topic, piece.samples.len());
        let mut stamps = Vec::new();
        for (n, message) in messages.iter().enumerate() {
            let next = messages.get(n + 1).copied().unwrap_or(piece.last);
            let end = next.since(*message).nanos();
            // Up to the constant the distance from it falls, from there on it grows: in each part one change at most.
            let turning = first(0, end, reaches);
            let falling = first(1, turning, |n| holds(n) != holds(0));
            let growing = first(turning + 1, end, |n| holds(n) != holds(turning));
            for nanos in [falling, turning, growing] {
                if nanos > 0 && nanos < end && holds(nanos) != holds(nanos - 1) {
                    stamps.push(*message + Duration::from_nanos(nanos));
                }
            }
        }
        stamps.sort();
        stamps.dedup();
        stamps
    }
}

/// The first number of `[lo, hi)` at which a test holds that holds ever after; `hi` where there is none.
fn first(mut lo: i64, mut hi: i64, test: impl Fn(i64) -> bool) -> i64 {
    while lo < hi {
        let middle = lo + (hi - lo) / 2;
        if test(middle) {
            hi = middle;
        } else {
            lo = middle + 1;
        }
    }
    lo
}
