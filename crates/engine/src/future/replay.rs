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

use super::{Decided, Moment, Pass};
use crate::pack::packed;
use crate::program::{Bound, Replay, Term};
use crate::runs::Runs;
use crate::times::Pos;

/// A formula is given up that takes more evaluations of its terms than this when something is new.
const MOST_WORK: usize = 1 << 20;
/// A formula is given up that keeps more positions than this.
const MOST_STORED: usize = 1 << 16;
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

/// What a term is at a position of the segment: not asked yet, or true, false, unknown.
type Answer = Option<Option<bool>>;

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
        let segment = Segment { hi: self.next(), end };
        self.answers.clear();
        self.answers.resize(formula.terms.len() * self.stored.len(), Cell::new(None));
        let asking = Asking {
            formula,
            first: self.first,
            stored: &self.stored,
            values: &self.values,
            segment,
            answers: &self.answers,
            limit,
            work: Cell::new(0),
        };
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

/// How a segment ends.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    /// It goes on.
    Open,
    /// Where it ends depends on what is unknown; what may still belong to it has this stamp or a later one.
    Undetermined { from: i64 },
    /// It is over.
    Closed,
    /// The trace ends here, its last stamp this; what reaches beyond stays unknown.
    Cut { last: i64 },
}

/// A segment: the position after the last that is known to belong to it, and how it ends.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Segment {
    hi: Pos,
    end: End,
}

/// Where a formula first holds.
enum First {
    At(Pos),
    /// Not before this position, where it is unknown.
    Unknown(Pos),
    /// Nowhere among the known positions.
    Nowhere,
}

/// An evaluation.
struct Asking<'a> {
    formula: &'a Replay,
    first: Pos,
    stored: &'a VecDeque<i64>,
    values: &'a VecDeque<bool>,
    /// The segment in which the formula stands, and the answers in it, of the first term at all positions, then of the next.
    segment: Segment,
    answers: &'a [Cell<Answer>],
    /// Bounds that end before this are over.
    limit: (i64, bool),
    /// How often a term was evaluated.
    work: Cell<usize>,
}

fn and(a: Option<bool>, b: Option<bool>) -> Option<bool> {
    match (a, b) {
        (Some(false), _) | (_, Some(false)) => Some(false),
        (Some(true), Some(true)) => Some(true),
        _ => None,
    }
}

fn or(a: Option<bool>, b: Option<bool>) -> Option<bool> {
    and(a.map(|x| !x), b.map(|x| !x)).map(|x| !x)
}

impl Asking<'_> {
    fn stamp(&self, k: Pos) -> i64 {
        self.stored[(k - self.first) as usize]
    }

    fn leaf(&self, leaf: usize, k: Pos) -> bool {
        self.values[(k - self.first) as usize * self.formula.leaves.len() + leaf]
    }

    /// A term at position `k` of a segment.
    fn term(&self, term: usize, k: Pos, s: Segment) -> Option<bool> {
        if s == self.segment { self.answered(term, k, || self.evaluate(term, k, s)) } else { self.evaluate(term, k, s) }
    }

    /// A term at a position of the segment in which the formula stands, found where it has not been asked yet.
    fn answered(&self, term: usize, k: Pos, find: impl FnOnce() -> Option<bool>) -> Option<bool> {
        let answer = &self.answers[term * self.stored.len() + (k - self.first) as usize];
        answer.get().unwrap_or_else(|| {
            let found = find();
            answer.set(Some(found));
            found
        })
    }

    /// A term without a bound, which is `nowhere` over no positions, from the last position of that segment back to `k`: `from_next` says what
    /// it is from what it is at the next.
    fn backwards(
        &self,
        term: usize,
        k: Pos,
        nowhere: bool,
        from_next: impl Fn(Pos, Option<bool>) -> Option<bool>,
    ) -> Option<bool> {
        let beyond = self.is_over(&Bound::ALL, k, self.segment).then_some(nowhere);
        (k..self.segment.hi).rev().fold(beyond, |next, j| self.answered(term, j, || from_next(j, next)))
    }

    fn evaluate(&self, term: usize, k: Pos, s: Segment) -> Option<bool> {
        self.work.set(self.work.get() + 1);
        match self.formula.terms[term] {
            Term::Leaf(i) => Some(self.leaf(i, k)),
            Term::Not(f) => self.term(f, k, s).map(|x| !x),
            Term::And(l, r) => and(self.term(l, k, s), self.term(r, k, s)),
            Term::Or(l, r) => or(self.term(l, k, s), self.term(r, k, s)),
            Term::Iff(l, r) => self.term(l, k, s).zip(self.term(r, k, s)).map(|(a, b)| a == b),
            Term::Eventually(Bound::ALL, f) if s == self.segment => {
                self.backwards(term, k, false, |j, next| or(self.term(f, j, s), next))
            }
            Term::Always(Bound::ALL, f) if s == self.segment => {
                self.backwards(term, k, true, |j, next| and(self.term(f, j, s), next))
            }
            Term::Until(Bound::ALL, l, r) if s == self.segment => {
                self.backwards(term, k, false, |j, next| or(self.term(r, j, s), and(self.term(l, j, s), next)))
            }
            Term::Eventually(b, f) => self.eventually(&b, f, k, s, false),
            Term::Always(b, f) => self.eventually(&b, f, k, s, true).map(|x| !x),
            Term::Next(f) if k + 1 < s.hi => self.term(f, k + 1, s),
            Term::Next(_) => {
                if s.end == End::Closed {
                    Some(false)
                } else {
                    None
                }
            }
            Term::Until(b, l, r) => self.until(&b, l, r, k, s),
            Term::After(x, f) => match self.first(x, false, k, s) {
                First::At(j) => self.term(f, j, s),
                First::Unknown(_) => None,
                First::Nowhere => self.nothing_more(s),
            },
            Term::UntilScope(x, f) => {
                let (comes, body) = self.up_to(x, f, k, s);
                and(comes, body)
            }
            Term::Before(x, f) => {
                let (comes, body) = self.up_to(x, f, k, s);
                or(comes.map(|c| !c), body)
            }
            Term::AfterUntil(x, y, f) => {
                self.each(k, s, f, |from| self.first(x, false, from, s), |from| self.first(y, false, from, s), 1)
            }
            Term::While(x, f) => {
                self.each(k, s, f, |from| self.first(x, false, from, s), |from| self.first(x, true, from, s), 0)
            }
        }
    }

    /// True where no further position can come.
    fn nothing_more(&self, s: Segment) -> Option<bool> {
        matches!(s.end, End::Closed | End::Cut { .. }).then_some(true)
    }

    /// Whether no position beyond the known ones can lie within the bound of `k`.
    fn is_over(&self, bound: &Bound, k: Pos, s: Segment) -> bool {
        let end = (self.stamp(k).saturating_add(bound.hi), bound.hi_closed);
        match s.end {
            End::Open => bound.has_end() && end < self.limit,
            End::Undetermined { from } => bound.has_end() && end < (from, true),
            End::Closed => true,
            End::Cut { last } => !bound.has_end() || end.0 <= last,
        }
    }

    /// `eventually f`, or with `negated` `eventually not f`.
    fn eventually(&self, bound: &Bound, f: usize, k: Pos, s: Segment, negated: bool) -> Option<bool> {
        let mut found = Some(false);
        for j in k..s.hi {
            let distance = self.stamp(j).saturating_sub(self.stamp(k));
            if !bound.not_over(distance) {
                return found;
            }
            if bound.begun(distance) {
                found = or(found, self.term(f, j, s).map(|x| x != negated));
            }
            if found == Some(true) {
                return found;
            }
        }
        if self.is_over(bound, k, s) { found } else { or(found, None) }
    }

    fn until(&self, bound: &Bound, l: usize, r: usize, k: Pos, s: Segment) -> Option<bool> {
        let (mut found, mut all) = (Some(false), Some(true));
        for j in k..s.hi {
            let distance = self.stamp(j).saturating_sub(self.stamp(k));
            if !bound.not_over(distance) {
                return found;
            }
            if bound.begun(distance) {
                found = or(found, and(all, self.term(r, j, s)));
            }
            all = and(all, self.term(l, j, s));
            if found == Some(true) || all == Some(false) {
                return found;
            }
        }
        if self.is_over(bound, k, s) { found } else { or(found, and(all, None)) }
    }

    /// The first position from `from` on at which `x` holds, or with `negated` does not.
    fn first(&self, x: usize, negated: bool, from: Pos, s: Segment) -> First {
        for j in from..s.hi {
            match self.term(x, j, s) {
                Some(v) if v != negated => return First::At(j),
                Some(_) => {}
                None => return First::Unknown(j),
            }
        }
        First::Nowhere
    }

    /// Of `until X, f` at `k`: whether X comes, and whether f holds up to it.
    fn up_to(&self, x: usize, f: usize, k: Pos, s: Segment) -> (Option<bool>, Option<bool>) {
        match self.first(x, false, k, s) {
            First::At(j) if j == k => (Some(true), Some(true)),
            First::At(j) => (Some(true), self.term(f, k, Segment { hi: j, end: End::Closed })),
            First::Unknown(u) => {
                let comes = (u..s.hi).any(|j| self.term(x, j, s) == Some(true));
                let body = if u == k {
                    None
                } else {
                    self.term(f, k, Segment { hi: u, end: End::Undetermined { from: self.stamp(u) } })
                };
                (comes.then_some(true), body)
            }
            First::Nowhere => (self.nothing_more(s).map(|_| false), self.term(f, k, s)),
        }
    }

    /// `f` in each segment that `opens` opens and `closes` closes, from `k` on; the search goes on `skip` after a close.
    fn each(
        &self,
        k: Pos,
        s: Segment,
        f: usize,
        opens: impl Fn(Pos) -> First,
        closes: impl Fn(Pos) -> First,
        skip: u64,
    ) -> Option<bool> {
        let (mut all, mut from) = (Some(true), k);
        loop {
            let start = match opens(from) {
                First::At(start) => start,
                First::Unknown(_) => return and(all, None),
                First::Nowhere => return and(all, self.nothing_more(s)),
            };
            match closes(start) {
                First::At(end) => {
                    if end > start {
                        all = and(all, self.term(f, start, Segment { hi: end, end: End::Closed }));
                    }
                    from = end + skip;
                }
                First::Unknown(u) => {
                    let body = if u == start {
                        None
                    } else {
                        self.term(f, start, Segment { hi: u, end: End::Undetermined { from: self.stamp(u) } })
                    };
                    return and(and(all, body), None);
                }
                First::Nowhere => {
                    let body = self.term(f, start, s);
                    return and(and(all, body), self.nothing_more(s));
                }
            }
        }
    }
}
