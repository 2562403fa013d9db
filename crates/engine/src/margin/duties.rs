//! Obligations over stored columns: those of a formula at the top, and of bodies of scopes in each of their segments.

use super::CERTAIN;
use super::plan::{Duty, Term};
use super::scopes::is_true;
use super::terms::{Span, Stored};
use crate::program::Bound;

impl Stored<'_> {
    /// The least margin of obligations in a segment that has a position; NaN where there is none. `can_fail` is false under a
    /// `before X` whose X never comes.
    pub fn least(&self, duties: &[Duty], span: Span, can_fail: bool) -> f64 {
        duties.iter().fold(f64::NAN, |least, duty| least.min(self.duty(duty, span, can_fail)))
    }

    fn duty(&self, duty: &Duty, span: Span, can_fail: bool) -> f64 {
        match duty {
            Duty::Each(bound, term) => self.at_each(bound, term, span, can_fail),
            Duty::Once(_) if !can_fail => CERTAIN,
            Duty::Once(term) => self.values(term, span).first().copied().unwrap_or(f64::NAN),
            Duty::After { x, body } => match self.first(*x, span, true) {
                Some(first) => self.least(body, span.part(first, span.to), can_fail),
                None => f64::NAN,
            },
            Duty::UpTo { x, weak, body } => {
                let comes = self.first(*x, span, true);
                self.in_part(body, span, comes, can_fail && (!weak || comes.is_some()))
            }
            Duty::While { x, body } => self.segments(*x, (*x, false), body, span, can_fail),
            Duty::AfterUntil { x, y, body } => self.segments(*x, (*y, true), body, span, can_fail),
        }
    }

    fn at_each(&self, bound: &Bound, term: &Term, span: Span, can_fail: bool) -> f64 {
        let is_one = |k: &usize| bound.contains(self.stamps[*k].saturating_sub(self.stamps[span.from]));
        let mut positions = span.positions().filter(is_one).peekable();
        if positions.peek().is_some() && !can_fail {
            return CERTAIN;
        }
        let values = self.values(term, span);
        positions.fold(f64::NAN, |least, k| least.min(values[k - span.from]))
    }

    /// The first position of a segment at which a column of truth values is true, or is not.
    fn first(&self, column: usize, span: Span, truth: bool) -> Option<usize> {
        let values = &self.columns[column][span.from..span.to];
        values.iter().position(|value| is_true(*value) == truth).map(|i| span.from + i)
    }

    /// A body from the beginning of a segment to where it closes, or to its end; an empty part has no obligation.
    fn in_part(&self, body: &[Duty], span: Span, closes: Option<usize>, can_fail: bool) -> f64 {
        let to = closes.unwrap_or(span.to);
        if to == span.from {
            return f64::NAN;
        }
        // A part that is closed does not end because the trace does.
        let is_cut = span.is_cut && closes.is_none();
        self.least(body, Span { to, is_cut, ..span }, can_fail)
    }

    /// A body in every part that X opens and that closes where a column has that truth value.
    fn segments(&self, x: usize, (column, truth): (usize, bool), body: &[Duty], span: Span, can_fail: bool) -> f64 {
        let (mut least, mut rest) = (f64::NAN, span);
        while let Some(opens) = self.first(x, rest, true) {
            let part = span.part(opens, span.to);
            let closes = self.first(column, part, truth);
            least = least.min(self.in_part(body, part, closes, can_fail));
            rest.from = closes.map_or(span.to, |closes| closes + usize::from(truth));
        }
        least
    }
}
