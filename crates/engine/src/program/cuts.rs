//! Where the truth of a comparison with constants changes, over the numbers that its signal may have: a robot's signals change with every
//! message, but few of their changes cross a limit that somebody named.

use alloc::vec::Vec;

use crate::functions::compare;

use super::code::Func;
use super::{Arith, Node, NodeId, Op, Positions, Wake};

/// The truth of operators is another below this number than from it on.
#[derive(Clone, Copy, Debug)]
pub struct Cut {
    /// The least number on the far side.
    pub at: f64,
    /// The operators.
    pub wake: Wake,
}

/// For an operator that compares nothing but one signal with constants: the signal, and the numbers at which the truth changes.
///
/// It counts for signals that are numbers, and stay so; NaN is none.
pub(super) fn cuts(at: &Positions, op: &Op) -> Option<(usize, Vec<f64>)> {
    match op {
        Op::Slot { slot, truth: true } => Some((*slot, changes(0.0, |x| x != 0.0))),
        Op::Holds(node) => comparison(at, *node),
        _ => None,
    }
}

fn comparison(at: &Positions, node: NodeId) -> Option<(usize, Vec<f64>)> {
    let (op, margin, left, right) = match *at.nodes.get(node as usize)? {
        Node::Compare { op, margin, left, right, .. } | Node::CompareAny { op, margin, left, right, .. } => {
            (op, margin, left, right)
        }
        _ => return None,
    };
    let margin = margin.map_or(Some(0.0), |margin| constant(at, margin))?;
    if let (Some(signal), Some(limit)) = (Signal::of(at, left), constant(at, right)) {
        return Some((signal.slot, changes(limit, |x| compare(op, signal.at(x), limit, margin))));
    }
    let (limit, signal) = (constant(at, left)?, Signal::of(at, right)?);
    Some((signal.slot, changes(limit, |x| compare(op, limit, signal.at(x), margin))))
}

/// A signal, or its absolute value.
struct Signal {
    slot: usize,
    absolute: bool,
}

impl Signal {
    fn of(at: &Positions, node: NodeId) -> Option<Signal> {
        match at.nodes.get(node as usize)? {
            Node::Slot(slot) => Some(Signal { slot: *slot, absolute: false }),
            Node::Call(Func::Abs, args) => match (&args[..], at.nodes.get(*args.first()? as usize)?) {
                ([_], Node::Slot(slot)) => Some(Signal { slot: *slot, absolute: true }),
                _ => None,
            },
            _ => None,
        }
    }

    fn at(&self, x: f64) -> f64 {
        if self.absolute { x.abs() } else { x }
    }
}

/// What an expression without signals comes to, where that is a number.
pub(super) fn constant(at: &Positions, node: NodeId) -> Option<f64> {
    let value = match at.nodes.get(node as usize)? {
        Node::Num(x) => *x,
        Node::Neg(of) => -constant(at, *of)?,
        Node::Arith(op, a, b) => {
            let (a, b) = (constant(at, *a)?, constant(at, *b)?);
            match op {
                Arith::Add => a + b,
                Arith::Sub => a - b,
                Arith::Mul => a * b,
                Arith::Div => a / b,
            }
        }
        _ => return None,
    };
    (!value.is_nan()).then_some(value)
}

/// The least numbers at which a truth is another than just below, in increasing order.
///
/// On either side of the limit, and of zero, a comparison of a signal or of its absolute value changes once at most, as rounding keeps
/// the order of numbers; bisection finds where, to the last bit, whatever the rounding of margins.
fn changes(limit: f64, holds: impl Fn(f64) -> bool) -> Vec<f64> {
    let limit = limit.abs();
    let borders = [f64::NEG_INFINITY, -limit, 0.0, limit, f64::INFINITY].map(rank);
    let holds = |rank: i64| holds(number(rank));
    let mut found = Vec::new();
    for (&(mut below), &(mut from)) in borders.iter().zip(&borders[1..]) {
        if holds(below) == holds(from) {
            continue;
        }
        while below + 1 < from {
            let middle = below + (from - below) / 2;
            if holds(middle) == holds(from) {
                from = middle;
            } else {
                below = middle;
            }
        }
        found.push(number(from));
    }
    found
}

/// The place of a number among all, infinities included: [`number`] is its inverse.
fn rank(x: f64) -> i64 {
    let bits = x.to_bits().cast_signed();
    bits ^ (bits >> 63).cast_unsigned().wrapping_shr(1).cast_signed()
}

fn number(rank: i64) -> f64 {
    let bits = rank ^ (rank >> 63).cast_unsigned().wrapping_shr(1).cast_signed();
    f64::from_bits(bits.cast_unsigned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::Compare;

    #[test]
    fn numbers_are_ranked_in_their_order() {
        let numbers =
            [f64::NEG_INFINITY, f64::MIN, -1.5, -f64::MIN_POSITIVE, -0.0, 0.0, 5e-324, 2.0, f64::MAX, f64::INFINITY];
        assert!(numbers.windows(2).all(|pair| rank(pair[0]) < rank(pair[1])));
        assert!(numbers.iter().all(|&x| number(rank(x)).to_bits() == x.to_bits()));
    }

    /// The truth that the cuts say, and the truth, at numbers around them.
    #[test]
    fn the_truth_changes_at_the_cuts_and_nowhere_else() {
        let operators = [Compare::Eq, Compare::Ne, Compare::Lt, Compare::Le, Compare::Gt, Compare::Ge];
        let limits = [0.0, -0.0, 1.0, -2.5, 0.1, 1e-310, 1e308, f64::INFINITY, f64::NEG_INFINITY];
        for op in operators {
            for limit in limits {
                for margin in [0.0, 0.05, 1e-17, 3.0, -1.0, f64::INFINITY] {
                    let plain = |x: f64| compare(op, x, limit, margin);
                    let turned = |x: f64| compare(op, limit, x, margin);
                    let absolute = |x: f64| compare(op, x.abs(), limit, margin);
                    let all: [&dyn Fn(f64) -> bool; 3] = [&plain, &turned, &absolute];
                    all.into_iter().for_each(|holds| hold_between(limit, holds));
                }
            }
        }
    }

    fn hold_between(limit: f64, holds: &dyn Fn(f64) -> bool) {
        let cuts = changes(limit, holds);
        assert!(cuts.windows(2).all(|pair| pair[0] < pair[1]), "{cuts:?}");
        let others = [limit, 0.0, 3.0, -3.0, 1e300];
        let near = cuts.iter().chain(&others).flat_map(|x| [x.next_down(), *x, x.next_up(), x + 0.7]);
        for x in near.chain([f64::NEG_INFINITY, f64::INFINITY]).filter(|x| !x.is_nan()) {
            let crossed = cuts.iter().filter(|&&cut| cut <= x).count();
            assert_eq!(holds(x), holds(f64::NEG_INFINITY) ^ (crossed % 2 == 1), "{x:?}: {cuts:?}, {limit:?}");
        }
    }
}
