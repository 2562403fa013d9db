//! Which numbers satisfy a few comparisons of one thing with constants.

use crate::checked::{Compare, Expr, Kind};
use crate::constant::constant;

/// The numbers between two ends, each in or out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    lo: f64,
    lo_in: bool,
    hi: f64,
    hi_in: bool,
}

/// A comparison of something with a constant: what is compared, and the numbers that satisfy it.
pub(super) fn comparison(expr: &Expr) -> Option<(&Expr, Range)> {
    let Kind::Compare { op, margin, left, right } = &expr.kind else { return None };
    let margin = match margin {
        Some(margin) => constant(margin)?,
        None => 0.0,
    };
    let (what, op, value) = match (constant(left), constant(right)) {
        (None, Some(value)) => (&**left, *op, value),
        (Some(value), None) => (&**right, op.mirrored(), value),
        _ => return None,
    };
    Range::of(op, value, margin).map(|range| (what, range))
}

impl Range {
    fn of(op: Compare, value: f64, margin: f64) -> Option<Range> {
        let all = Range { lo: f64::NEG_INFINITY, lo_in: true, hi: f64::INFINITY, hi_in: true };
        if value.is_nan() || margin.is_nan() {
            return None;
        }
        Some(match op {
            Compare::Eq => Range { lo: value - margin, lo_in: true, hi: value + margin, hi_in: true },
            Compare::Lt => Range { hi: value + margin, hi_in: false, ..all },
            Compare::Le => Range { hi: value + margin, ..all },
            Compare::Gt => Range { lo: value - margin, lo_in: false, ..all },
            Compare::Ge => Range { lo: value - margin, ..all },
            Compare::Ne => return None,
        })
    }

    /// The numbers in both.
    pub fn and(self, other: Range) -> Range {
        let (lo, lo_in) = match self.lo.total_cmp(&other.lo) {
            std::cmp::Ordering::Less => (other.lo, other.lo_in),
            std::cmp::Ordering::Greater => (self.lo, self.lo_in),
            std::cmp::Ordering::Equal => (self.lo, self.lo_in && other.lo_in),
        };
        let (hi, hi_in) = match self.hi.total_cmp(&other.hi) {
            std::cmp::Ordering::Greater => (other.hi, other.hi_in),
            std::cmp::Ordering::Less => (self.hi, self.hi_in),
            std::cmp::Ordering::Equal => (self.hi, self.hi_in && other.hi_in),
        };
        Range { lo, lo_in, hi, hi_in }
    }

    /// Whether no number is in it.
    pub fn is_empty(self) -> bool {
        self.lo > self.hi || (self.lo == self.hi && !(self.lo_in && self.hi_in))
    }

    /// Whether the two leave no number out: one reaches down, the other up, and they meet.
    pub fn covers_all_with(self, other: Range) -> bool {
        let meets = |low: Range, high: Range| {
            let down = low.lo == f64::NEG_INFINITY && high.hi == f64::INFINITY;
            down && (low.hi > high.lo || (low.hi == high.lo && (low.hi_in || high.lo_in)))
        };
        meets(self, other) || meets(other, self)
    }
}
