//! Obligations over stored columns: those of a formula at the top, and of bodies of scopes in each of their segments.

use super::CERTAIN;
use super::plan::{Duty, Term};
use super::scopes::is_true;
use super::terms::{Span, Stored};
use crate::program::Bound;

/// Who is told the margin of each obligation, with the position at which it begins.
type Tell<'t> = dyn FnMut(usize, f64) + 't;

impl Stored<'_> {
    /// The least margin of obligations in a segment that has a position; NaN where there is none. `can_fail` is false under a
    /// `before X` whose X never comes.
    pub fn least(&self, duties: &[Duty], span: Span, can_fail: bool) -> f64 {
        let mut least = f64::NAN;
        self.obligations(duties, span, can_fail, &mut |_, margin| least = least.min(margin));
        least
    }

    /// Tells all obligations in a segment that has a position.
    pub fn obligations(&self, duties: &[Duty], span: Span, can_fail: bool, tell: &mut Tell<'_>) {
        duties.iter().for_each(|duty| self.duty(duty, span, can_fail, tell));
    }

    fn duty(&self, duty: &Duty, span: Span, can_fail: bool, tell: &mut Tell<'_>) {
        match duty {
            Duty::Each(bound, term) => self.at_each(bound, term, span, can_fail, tell),
            Duty::Once(_) if !can_fail => tell(span.from, CERTAIN),
            Duty::Once(term) => tell(span.from, self.values(term, span).first().copied().unwrap_or(f64::NAN)),
            Duty::After { x, body } => {
                if let Some(first) = self.first(*x, span, true) {
                    self.obligations(body, span.part(first, span.to), can_fail, tell);
                }
            }
            Duty::UpTo { x, weak, body } => {
                let comes = self.first(*x, span, true);
                self.in_part(body, span, comes, can_fail && (!weak || comes.is_some()), tell);
            }
            Duty::While { x, body } => self.segments(*x, (*x, false), body, (span, can_fail), tell),
            Duty::AfterUntil { x, y, body } => self.segments(*x, (*y, true), body, (span, can_fail), tell),
        }
    }

    fn at_each(&self, bound: &Bound, term: &Term, span: Span, can_fail: bool, tell: &mut Tell<'_>) {
        let is_one = |k: &usize| bound.contains(self.stamps[*k].saturating_sub(self.stamps[span.from]));
        let positions = span.positions().filter(is_one);
        if !can_fail {
            positions.for_each(|k| tell(k, CERTAIN));
            return;
        }
        let values = self.values(term, span);
        positions.for_each(|k| tell(k, values[k - span.from]));
    }

    /// The first position of a segment at which a column of truth values is true, or is not.
    fn first(&self, column: usize, span: Span, truth: bool) -> Option<usize> {
        let values = &self.columns[column][span.from..span.to];
        values.iter().position(|value| is_true(*value) == truth).map(|i| span.from + i)
    }

    /// A body from the beginning of a segment to where it closes, or to its end; an empty part has no obligation.
    fn in_part(&self, body: &[Duty], span: Span, closes: Option<usize>, can_fail: bool, tell: &mut Tell<'_>) {
        let to = closes.unwrap_or(span.to);
        if to > span.from {
            // A part that is closed does not end because the trace does.
            let is_cut = span.is_cut && closes.is_none();
            self.obligations(body, Span { to, is_cut, ..span }, can_fail, tell);
        }
    }

    /// A body in every part that X opens and that closes where a column has that truth value.
    fn segments(
        &self,
        x: usize,
        (column, truth): (usize, bool),
        body: &[Duty],
        (span, can_fail): (Span, bool),
        tell: &mut Tell<'_>,
    ) {
        let mut rest = span;
        while let Some(opens) = self.first(x, rest, true) {
            let part = span.part(opens, span.to);
            let closes = self.first(column, part, truth);
            self.in_part(body, part, closes, can_fail, tell);
            rest.from = closes.map_or(span.to, |closes| closes + usize::from(truth));
        }
    }
}
