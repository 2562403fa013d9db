//! Formulas with future operators, over stored columns: each operator in one pass over the positions of a segment.
//!
//! The same passes serve truth values, for what opens and closes scopes: true is +∞, false −∞, unknown 0.

use alloc::vec::Vec;

use super::peak::Peak;
use super::plan::Term;
use super::{CERTAIN, IMPOSSIBLE, opposite};
use crate::program::Bound;

/// What the end of a trace leaves open, among truth values.
const UNKNOWN: f64 = 0.0;

/// A segment of positions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub from: usize,
    pub to: usize,
    /// It ends because the trace does.
    pub is_cut: bool,
}

impl Span {
    pub fn positions(&self) -> impl DoubleEndedIterator<Item = usize> + ExactSizeIterator + use<> {
        self.from..self.to
    }

    /// The part of it from one position up to another.
    pub fn part(&self, from: usize, to: usize) -> Span {
        Span { from, to, is_cut: self.is_cut && to == self.to }
    }
}

/// What was stored of a trace.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stored<'a> {
    pub stamps: &'a [i64],
    pub columns: &'a [Vec<f64>],
    /// The last stamp of the trace.
    pub last: i64,
    /// Truth values are computed: what the end of the trace cuts off is unknown.
    pub is_truth: bool,
}

impl<'a> Stored<'a> {
    /// The same, for truth values.
    pub fn truth(&self) -> Stored<'a> {
        Stored { is_truth: true, ..*self }
    }

    /// The margins of a formula at all positions of a segment.
    pub fn values(&self, term: &Term, span: Span) -> Vec<f64> {
        match term {
            Term::Column(column) => self.columns[*column][span.from..span.to].to_vec(),
            Term::Not(of) => {
                let mut values = self.values(of, span);
                values.iter_mut().for_each(|value| *value = opposite(*value));
                values
            }
            Term::And(a, b) => self.each(a, b, span, f64::min),
            Term::Or(a, b) => self.each(a, b, span, f64::max),
            Term::Iff(a, b) => self.each(a, b, span, |a, b| opposite(a).max(b).min(opposite(b).max(a))),
            Term::Next(of) => self.next(self.values(of, span), span),
            Term::Eventually(bound, of) => self.eventually(bound, &self.values(of, span), span),
            Term::Until(bound, left, right) => {
                let (lefts, rights) = (self.values(left, span), self.values(right, span));
                if *bound == Bound::ALL {
                    until(&lefts, &rights)
                } else {
                    self.until_within(bound, &lefts, rights, span)
                }
            }
            Term::After { x, body } => self.after(x, body, span),
            Term::UntilScope { x, comes, body } => self.until_scope(x, comes, body, span),
            Term::Before { x, body } => self.before(x, body, span),
            Term::While { x, body } => self.while_(x, body, span),
            Term::AfterUntil { x, y, body } => self.after_until(x, y, body, span),
        }
    }

    /// Two formulas put together position by position.
    fn each(&self, a: &Term, b: &Term, span: Span, with: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let (a, b) = (self.values(a, span), self.values(b, span));
        a.into_iter().zip(b).map(|(a, b)| with(a, b)).collect()
    }

    fn next(&self, mut values: Vec<f64>, span: Span) -> Vec<f64> {
        let beyond = if self.is_truth && span.is_cut { UNKNOWN } else { IMPOSSIBLE };
        if !values.is_empty() {
            values.rotate_left(1);
        }
        if let Some(last) = values.last_mut() {
            *last = beyond;
        }
        values
    }

    fn distance(&self, from: usize, to: usize) -> i64 {
        self.stamps[to].saturating_sub(self.stamps[from])
    }

    /// Whether, among truth values, the end of the trace cuts off what a bound looks at from here.
    fn is_open(&self, bound: &Bound, k: usize, span: Span) -> bool {
        self.is_truth && span.is_cut && bound.has_end() && self.stamps[k].saturating_add(bound.hi) > self.last
    }

    fn eventually(&self, bound: &Bound, values: &[f64], span: Span) -> Vec<f64> {
        let mut greatest = alloc::vec![IMPOSSIBLE; values.len()];
        let mut peak = Peak::default();
        // The window of a position moves back with it: this is its first position.
        let mut first = span.to;
        for k in span.positions().rev() {
            while first > k && bound.begun(self.distance(k, first - 1)) {
                first -= 1;
                let value = values[first - span.from];
                if bound.has_end() { peak.push(first as i64, value) } else { peak.raise(value) }
            }
            if bound.has_end() {
                peak.forget(|j| !bound.not_over(self.distance(k, j as usize)));
            }
            let least = if self.is_open(bound, k, span) { UNKNOWN } else { IMPOSSIBLE };
            greatest[k - span.from] = peak.greatest().max(least);
        }
        greatest
    }

    /// `until` within a bound: the best right side in the window, as far as `until` without a bound is that good from the first
    /// position of the window on, and the left side is up to there. Beyond the window the left side can only have become worse, so
    /// what is best there is no better than what the window has.
    fn until_within(&self, bound: &Bound, lefts: &[f64], mut rights: Vec<f64>, span: Span) -> Vec<f64> {
        // A right side that is skipped leaves the left sides alone to count.
        rights.iter_mut().for_each(|right| *right = right.min(CERTAIN));
        let mut values = self.eventually(bound, &rights, Span { is_cut: false, ..span });
        let on = until(lefts, &rights);
        // The left sides before the window, negated, and the worst of all from here on.
        let (mut before, mut worst) = (Peak::default(), CERTAIN);
        let mut first = span.to;
        for k in span.positions().rev() {
            let left = lefts[k - span.from];
            worst = worst.min(left);
            before.push(k as i64, opposite(left));
            while first > k && bound.begun(self.distance(k, first - 1)) {
                first -= 1;
            }
            before.forget(|j| j >= first as i64);
            let open = if self.is_open(bound, k, span) { worst.min(UNKNOWN) } else { IMPOSSIBLE };
            let on = on.get(first - span.from).copied().unwrap_or(IMPOSSIBLE);
            let value = &mut values[k - span.from];
            *value = value.min(on).min(opposite(before.greatest())).max(open);
        }
        values
    }
}

/// `until` without a bound, from the end: either the right side here, or the left side here and the rest one position later.
fn until(lefts: &[f64], rights: &[f64]) -> Vec<f64> {
    let mut values = alloc::vec![IMPOSSIBLE; lefts.len()];
    let mut best = IMPOSSIBLE;
    for (value, (left, right)) in values.iter_mut().zip(lefts.iter().zip(rights)).rev() {
        best = right.min(CERTAIN).max(best.min(*left));
        *value = best;
    }
    values
}
