//! How often scopes are entered that are looked at where a formula about the future says so: at the positions up to the last that `until` looks at,
//! inside of a scope that opens or closes on such a formula. Where that is shows later, so what the formulas stand on is stored, position by
//! position, and counted when the trace is over.

use alloc::collections::{BTreeSet, VecDeque};
use alloc::vec::Vec;
use core::cell::Cell;

use serde::{Deserialize, Serialize};

use super::evaluate::{Asking, End, First, Segment};
use super::replay::{MOST_STORED, MOST_WORK};
use super::{Moment, Pass};
use crate::pack::packed;
use crate::program::{Survey, Term};
use crate::times::Pos;

/// The stamps of all positions, and the values of the state formulas there.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct State {
    stamps: VecDeque<i64>,
    values: VecDeque<bool>,
    /// Whether some positions are not stored.
    is_partial: bool,
    /// How often each scope was entered, once that is known.
    entered: Option<Vec<u64>>,
}

packed!(State { stamps, values, is_partial, entered });

impl State {
    /// How often each scope was entered, in the order of the text, where it could be counted.
    pub fn entered(&self) -> Option<&[u64]> {
        self.entered.as_deref()
    }

    /// It cannot be counted: there are positions that are not stored.
    pub fn give_up(&mut self) {
        *self = State { is_partial: true, ..State::default() };
    }
}

pub(crate) fn step(state: &mut State, context: u32, survey: &Survey, pass: &Pass<'_>) {
    if state.is_partial {
        return;
    }
    if pass.position(context).is_some() {
        state.stamps.push_back(pass.view.now);
        state.values.extend(survey.formula.leaves.iter().map(|&leaf| pass.view.bool(leaf)));
        if state.stamps.len() > MOST_STORED {
            state.give_up();
        }
    }
    if let Moment::End { last } = pass.moment {
        state.entered = count(state, survey, last);
    }
}

/// Walks through the formula as its meaning does; `None` where that is too much work.
fn count(state: &State, survey: &Survey, last: i64) -> Option<Vec<u64>> {
    let positions = state.stamps.len();
    let segment = Segment::new(positions as Pos, End::Cut { last });
    let answers = alloc::vec![Cell::new(None); survey.formula.terms.len() * positions];
    let asking = Asking {
        formula: &survey.formula,
        first: 0,
        stored: &state.stamps,
        values: &state.values,
        segment,
        answers: &answers,
        limit: (last, true),
        work: Cell::new(0),
    };
    let mut walk =
        Walk { asking, survey, seen: BTreeSet::new(), entered: alloc::vec![BTreeSet::new(); survey.scopes.len()] };
    if positions > 0 {
        walk.at(survey.formula.terms.len().saturating_sub(1), 0, segment);
    }
    let is_complete = walk.asking.work.get() <= MOST_WORK;
    is_complete.then(|| walk.entered.iter().map(|positions| positions.len() as u64).collect())
}

struct Walk<'a> {
    asking: Asking<'a>,
    survey: &'a Survey,
    /// What has been looked at: term, position, and the end of the segment.
    seen: BTreeSet<(usize, Pos, Pos)>,
    /// The positions at which each scope was entered.
    entered: Vec<BTreeSet<Pos>>,
}

impl Walk<'_> {
    /// A term is looked at, at position `k` of a segment.
    fn at(&mut self, term: usize, k: Pos, s: Segment) {
        let work = &self.asking.work;
        work.set(work.get() + 1);
        let formula = self.asking.formula;
        let of = &formula.terms[term];
        if matches!(of, Term::Leaf(_)) || work.get() > MOST_WORK || !self.seen.insert((term, k, s.hi)) {
            return;
        }
        match *of {
            Term::Leaf(_) => {}
            Term::Not(f) => self.at(f, k, s),
            Term::And(l, r) | Term::Or(l, r) | Term::Iff(l, r) => {
                self.at(l, k, s);
                self.at(r, k, s);
            }
            Term::Always(_, f) if self.is_scope(term) => self.whenever(term, f, k, s),
            Term::Always(bound, f) | Term::Eventually(bound, f) => {
                let within = |j: &Pos| bound.contains(self.distance(k, *j));
                let looked: Vec<Pos> = (k..s.hi).filter(within).collect();
                looked.into_iter().for_each(|j| self.at(f, j, s));
            }
            Term::Next(f) => {
                if k + 1 < s.hi {
                    self.at(f, k + 1, s);
                }
            }
            Term::Until(bound, l, r) => {
                let within = |j: &Pos| bound.contains(self.distance(k, *j));
                let looked: Vec<Pos> = (k..s.hi).filter(within).collect();
                let last = looked.last().copied().unwrap_or(k);
                looked.into_iter().for_each(|j| self.at(r, j, s));
                (k..last).for_each(|j| self.at(l, j, s));
            }
            Term::After(x, f) => {
                if let Some(j) = self.first(x, k, s) {
                    self.enter(term, j);
                    self.at(f, j, s);
                }
            }
            Term::UntilScope(x, f) | Term::Before(x, f) => {
                if let Some(j) = self.first(x, k, s) {
                    self.enter(term, j);
                    self.inside(f, k, Some(j), s);
                }
            }
            Term::While(x, f) => self.runs((term, x, f), k, s),
            Term::AfterUntil(x, y, f) => self.stretches((term, x, y, f), k, s),
        }
    }

    /// `whenever X, f` is `always (not X or f)`: f is looked at where X holds.
    fn whenever(&mut self, term: usize, inner: usize, k: Pos, s: Segment) {
        let terms = &self.asking.formula.terms;
        let Term::Or(not, f) = terms[inner] else { return };
        let Term::Not(x) = terms[not] else { return };
        for j in k..s.hi {
            self.at(x, j, s);
            if self.asking.term(x, j, s) == Some(true) {
                self.enter(term, j);
                self.at(f, j, s);
            }
        }
    }

    fn runs(&mut self, (term, x, f): (usize, usize, usize), k: Pos, s: Segment) {
        let mut from = k;
        while let Some(i) = self.first(x, from, s) {
            let end = (i..s.hi).find(|&j| self.asking.term(x, j, s) != Some(true));
            (i..end.unwrap_or(i)).for_each(|j| self.at(x, j, s));
            self.enter(term, i);
            self.inside(f, i, end, s);
            match end {
                Some(end) => from = end,
                None => return,
            }
        }
    }

    fn stretches(&mut self, (term, x, y, f): (usize, usize, usize, usize), k: Pos, s: Segment) {
        let mut from = k;
        while let Some(i) = self.first(x, from, s) {
            let end = self.first(y, i, s);
            self.enter(term, i);
            self.inside(f, i, end, s);
            match end {
                Some(end) => from = end + 1,
                None => return,
            }
        }
    }

    /// A scope's body in the segment from `i` to `end`, where that is known; nothing looks into an empty one.
    fn inside(&mut self, f: usize, i: Pos, end: Option<Pos>, s: Segment) {
        let s = end.map_or(s, |hi| s.until(hi));
        if i < s.hi {
            self.at(f, i, s);
        }
    }

    /// The first position with X; those up to it are looked at. What stays unknown ends the search.
    fn first(&mut self, x: usize, from: Pos, s: Segment) -> Option<Pos> {
        let (found, upto) = match self.asking.first(x, false, from, s) {
            First::At(j) => (Some(j), j + 1),
            First::Unknown(j) => (None, j + 1),
            First::Nowhere => (None, s.hi),
        };
        (from..upto).for_each(|j| self.at(x, j, s));
        found
    }

    fn distance(&self, k: Pos, j: Pos) -> i64 {
        self.asking.stamp(j).saturating_sub(self.asking.stamp(k))
    }

    fn is_scope(&self, term: usize) -> bool {
        self.survey.scopes.contains(&term)
    }

    fn enter(&mut self, term: usize, at: Pos) {
        if let Some(number) = self.survey.scopes.iter().position(|&scope| scope == term) {
            self.entered[number].insert(at);
        }
    }
}
