//! Formulas beyond the other nodes: scopes that open or close on a future formula, `until` between future formulas.
//!
//! Their state formulas are stored, position by position, and the formula is evaluated anew at every open position whenever
//! something is new: each term once at each position of the segment, those without a bound from the last position backwards, each from the one
//! after. Only inside the segments of scopes in it the cost is, at worst, a power of what is open. The limit on open runs counts
//! every stored position, and what takes too many or too much work is given up, as if more runs were open than any limit allows. Such
//! formulas are rare, and their meaning subtle enough for the plainest evaluation to be the best.

use alloc::collections::VecDeque;
use alloc::vec::Vec;
use core::cell::Cell;

use serde::{Deserialize, Serialize};

use super::evaluate::{Answer, Asking, End, Segment};
use super::{Decided, Moment, Pass};
use crate::pack::packed;
use crate::program::{Replay, Term};
use crate::runs::Runs;
use crate::times::Pos;

/// A formula is given up that takes more evaluations of its terms than this when something is new.
pub(super) const MOST_WORK: usize = 1 << 20;
/// A formula is given up that keeps more positions than this.
pub(super) const MOST_STORED: usize = 1 << 16;
/// What is given up counts as so many runs: more than any limit, and few enough to be added up.
const TOO_MANY: usize = usize::MAX >> 8;

/// The stamps and the values of the state formulas at the positions from the oldest undecided one on.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct State {
    /// The position of the first stored value.
    first: Pos,
    /// The stamps.
    stored: VecDeque<i64>,
    /// The values of all leaves at each stamp, one after the other.
    values: VecDeque<bool>,
    open: Runs,
    deadline: Option<(i64, bool)>,
    is_given_up: bool,
    /// A buffer: what the terms are at the stored positions, as far as that was asked.
    #[serde(skip)]
    answers: Vec<Cell<Answer>>,
}

packed!(State { first, stored, values, open, deadline, is_given_up } without { answers });

impl State {
    pub fn runs(&self) -> usize {
        if self.is_given_up { TOO_MANY } else { self.stored.len() }
    }

    pub fn oldest(&self) -> Option<Pos> {
        self.open.first()
    }

    pub fn deadline(&self) -> Option<(i64, bool)> {
        self.deadline
    }

    fn next(&self) -> Pos {
        self.first + self.stored.len() as u64
    }

    /// Decides what can be decided.
    fn decide(&mut self, formula: &Replay, end: End, limit: (i64, bool), out: &mut Vec<Decided>) {
        let segment = Segment::new(self.next(), end);
        self.answers.clear();
        self.answers.resize(formula.terms.len() * self.stored.len(), Cell::new(None));
        let State { first, stored, values, answers, .. } = &*self;
        let asking = Asking { formula, first: *first, stored, values, segment, answers, limit, work: Cell::new(0) };
        let top = formula.terms.len().saturating_sub(1);
        out.extend(self.open.iter().flat_map(|(a, b)| a..=b).filter_map(|k| {
            let value = asking.term(top, k, segment)?;
            Some(Decided { from: k, to: k, value })
        }));
        self.is_given_up = asking.work.get() > MOST_WORK || self.stored.len() > MOST_STORED;
    }

    /// What is decided need not be stored, nor what lies before the oldest open position.
    fn forget(&mut self, leaves: usize, out: &[Decided]) {
        for d in out {
            self.open.take(d.from, d.to, |_, _| ());
        }
        let keep = self.open.first().unwrap_or(self.next());
        while self.first < keep && self.stored.pop_front().is_some() {
            self.first += 1;
            self.values.drain(..leaves);
        }
    }

    /// The segment is over, and all is decided.
    fn clear(&mut self) {
        self.stored.clear();
        self.values.clear();
        self.open.clear();
        self.deadline = None;
    }

    /// The next end of a bound of any term at any stored position.
    fn find_deadline(&self, formula: &Replay, limit: (i64, bool)) -> Option<(i64, bool)> {
        let bounds = formula.terms.iter().filter_map(|t| match t {
            Term::Always(b, _) | Term::Eventually(b, _) | Term::Until(b, ..) if b.has_end() => Some(b),
            _ => None,
        });
        bounds
            .filter_map(|b| {
                let end = |t: i64| (t.saturating_add(b.hi), b.hi_closed);
                let i = self.stored.partition_point(|&t| end(t) < limit);
                self.stored.get(i).map(|&t| end(t))
            })
            .min()
    }
}

pub(crate) fn step(state: &mut State, context: u32, formula: &Replay, pass: &Pass<'_>, out: &mut Vec<Decided>) {
    if state.is_given_up {
        state.clear();
        return;
    }
    if let Some(n) = pass.position(context) {
        if state.stored.is_empty() {
            state.first = n;
        }
        state.stored.push_back(pass.view.now);
        state.values.extend(formula.leaves.iter().map(|&leaf| pass.view.bool(leaf)));
        state.open.push(n);
    }
    if state.open.is_empty() {
        state.deadline = None;
        return;
    }
    let now = pass.view.now;
    match pass.moment {
        _ if pass.closes(context) => {
            state.decide(formula, End::Closed, (now, true), out);
            debug_assert_eq!(out.len() as u64, state.open.positions(), "a closed segment decides everything");
            state.clear();
            return;
        }
        Moment::End { last } => {
            state.decide(formula, End::Cut { last }, (last, true), out);
            return;
        }
        // An open bound that ends now is over before the positions with this stamp, a closed one only after them.
        Moment::Position(_) | Moment::Close => state.decide(formula, End::Open, (now, true), out),
        Moment::Deadline { at, closed } => {
            let limit = if closed { (at.saturating_add(1), false) } else { (at, true) };
            state.decide(formula, End::Open, limit, out);
        }
    }
    state.forget(formula.leaves.len(), out);
    let limit = match pass.moment {
        Moment::Deadline { at, closed: true } => (at.saturating_add(1), false),
        _ => (now, true),
    };
    state.deadline = if state.open.is_empty() { None } else { state.find_deadline(formula, limit) };
}
