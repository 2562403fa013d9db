//! Scopes asked at every position of a segment, over stored columns.

use alloc::vec::Vec;

use super::plan::Term;
use super::terms::{Span, Stored};
use super::{CERTAIN, IMPOSSIBLE};

/// Whether a truth value is true, and not just unknown.
pub(super) fn is_true(truth: f64) -> bool {
    truth == CERTAIN
}

impl Stored<'_> {
    /// Where a formula holds.
    fn holds(&self, x: &Term, span: Span) -> Vec<bool> {
        self.truth().values(x, span).into_iter().map(is_true).collect()
    }

    /// A body in the segments that end before each position that closes one, and with the span; an empty segment counts as true.
    fn segmented(&self, body: &Term, closes: &[bool], span: Span) -> Vec<f64> {
        let mut values = Vec::with_capacity(closes.len());
        let mut from = span.from;
        for to in span.positions().filter(|k| closes[k - span.from]).chain([span.to]) {
            if from < to {
                values.extend(self.values(body, span.part(from, to)));
            }
            if to < span.to {
                values.push(CERTAIN);
            }
            from = to + 1;
        }
        values
    }

    pub(super) fn after(&self, x: &Term, body: &Term, span: Span) -> Vec<f64> {
        let (x, mut values) = (self.holds(x, span), self.values(body, span));
        let mut at_x = CERTAIN;
        for (value, x) in values.iter_mut().zip(x).rev() {
            at_x = if x { *value } else { at_x };
            *value = at_x;
        }
        values
    }

    pub(super) fn until_scope(&self, x: &Term, comes: &Term, body: &Term, span: Span) -> Vec<f64> {
        let (x, comes) = (self.holds(x, span), self.values(comes, span));
        let mut values = self.segmented(body, &x, span);
        // The margin of the next X, and the greatest that X has from here on.
        let (mut next, mut greatest) = (None, IMPOSSIBLE);
        for ((value, x), comes) in values.iter_mut().zip(x).zip(comes).rev() {
            next = if x { Some(comes) } else { next };
            greatest = greatest.max(comes);
            *value = next.map_or(greatest, |next| value.min(next));
        }
        values
    }

    pub(super) fn before(&self, x: &Term, body: &Term, span: Span) -> Vec<f64> {
        let x = self.holds(x, span);
        let mut values = self.segmented(body, &x, span);
        let last = x.iter().rposition(|x| *x).map_or(0, |last| last + 1);
        values[last..].fill(CERTAIN);
        values
    }

    pub(super) fn while_(&self, x: &Term, body: &Term, span: Span) -> Vec<f64> {
        let breaks: Vec<bool> = self.holds(x, span).into_iter().map(|x| !x).collect();
        let mut values = self.segmented(body, &breaks, span);
        // The worst of the runs that begin later.
        let mut worst = CERTAIN;
        for i in (0..values.len()).rev() {
            let value = if breaks[i] { worst } else { values[i].min(worst) };
            let begins = !breaks[i] && (i == 0 || breaks[i - 1]);
            worst = if begins { value } else { worst };
            values[i] = value;
        }
        values
    }

    pub(super) fn after_until(&self, x: &Term, y: &Term, body: &Term, span: Span) -> Vec<f64> {
        let (x, y) = (self.holds(x, span), self.holds(y, span));
        let mut values = self.segmented(body, &y, span);
        // The worst when asked one position later, and one after the next Y.
        let (mut later, mut beyond) = (CERTAIN, CERTAIN);
        for i in (0..values.len()).rev() {
            if y[i] {
                beyond = later;
            } else if x[i] {
                later = values[i].min(beyond);
            }
            values[i] = later;
        }
        values
    }
}
