//! The plainest evaluation of a formula over stored positions, in Kleene's logic: each term from those that it stands on, at each position asked.

use alloc::collections::VecDeque;
use core::cell::Cell;

use crate::program::{Bound, Replay, Term};
use crate::times::Pos;

/// What a term is at a position of the segment: not asked yet, or true, false, unknown.
pub(super) type Answer = Option<Option<bool>>;

/// How a segment ends.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
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
pub(super) struct Segment {
    pub hi: Pos,
    pub end: End,
}

/// Where a formula first holds.
pub(super) enum First {
    At(Pos),
    /// Not before this position, where it is unknown.
    Unknown(Pos),
    /// Nowhere among the known positions.
    Nowhere,
}

/// An evaluation.
pub(super) struct Asking<'a> {
    pub formula: &'a Replay,
    pub first: Pos,
    pub stored: &'a VecDeque<i64>,
    pub values: &'a VecDeque<bool>,
    /// The segment in which the formula stands, and the answers in it, of the first term at all positions, then of the next.
    pub segment: Segment,
    pub answers: &'a [Cell<Answer>],
    /// Bounds that end before this are over.
    pub limit: (i64, bool),
    /// How often a term was evaluated.
    pub work: Cell<usize>,
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
    pub fn stamp(&self, k: Pos) -> i64 {
        self.stored[(k - self.first) as usize]
    }

    fn leaf(&self, leaf: usize, k: Pos) -> bool {
        self.values[(k - self.first) as usize * self.formula.leaves.len() + leaf]
    }

    /// A term at position `k` of a segment.
    pub fn term(&self, term: usize, k: Pos, s: Segment) -> Option<bool> {
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
    pub fn first(&self, x: usize, negated: bool, from: Pos, s: Segment) -> First {
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
