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
    /// It is over.
    Closed,
    /// The trace ends here, its last stamp this; what reaches beyond stays unknown.
    Cut { last: i64 },
}

/// A segment: the positions before `sure` belong to it, those from there up to `hi` perhaps, where it depends on what is unknown which is its
/// last; and how it ends, if not among them.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Segment {
    pub sure: Pos,
    pub hi: Pos,
    pub end: End,
}

impl Segment {
    /// All of whose positions are sure.
    pub fn new(hi: Pos, end: End) -> Segment {
        Segment { sure: hi, hi, end }
    }

    /// The part of it that ends before a position.
    pub fn until(self, hi: Pos) -> Segment {
        Segment { sure: self.sure.min(hi), hi, end: End::Closed }
    }

    /// Whether a position among the known ones belongs to it.
    fn has(self, j: Pos) -> Option<bool> {
        (j < self.sure).then_some(true)
    }
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
            Term::Next(f) if k + 1 < s.hi => and(self.term(f, k + 1, s), s.has(k + 1)),
            Term::Next(_) => {
                if s.end == End::Closed {
                    Some(false)
                } else {
                    None
                }
            }
            Term::Until(b, l, r) => self.until(&b, l, r, k, s),
            Term::After(x, f) => self.after(x, f, k, s),
            Term::UntilScope(x, f) => {
                let (comes, body) = self.up_to(x, f, k, s);
                and(comes, body)
            }
            Term::Before(x, f) => {
                let (comes, body) = self.up_to(x, f, k, s);
                or(comes.map(|c| !c), body)
            }
            Term::AfterUntil(x, y, f) => self.each(k, s, f, x, (y, false), 1),
            Term::While(x, f) => self.each(k, s, f, x, (x, true), 0),
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
                found = or(found, and(self.term(f, j, s).map(|x| x != negated), s.has(j)));
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
                found = or(found, and(and(all, self.term(r, j, s)), s.has(j)));
            }
            all = and(all, self.term(l, j, s));
            if found == Some(true) || all == Some(false) {
                return found;
            }
        }
        if self.is_over(bound, k, s) { found } else { or(found, and(all, None)) }
    }

    /// Whether `x` holds at a position of the segment, or with `negated` does not.
    fn holds_at(&self, x: usize, negated: bool, j: Pos, s: Segment) -> Option<bool> {
        and(self.term(x, j, s).map(|holds| holds != negated), s.has(j))
    }

    /// The first position from `from` on at which `x` holds, or with `negated` does not.
    pub fn first(&self, x: usize, negated: bool, from: Pos, s: Segment) -> First {
        for j in from..s.hi {
            match self.holds_at(x, negated, j, s) {
                Some(true) => return First::At(j),
                Some(false) => {}
                None => return First::Unknown(j),
            }
        }
        First::Nowhere
    }

    /// `f` at `k` in the part of a segment up to the first `x` at or after `k`, or with `negated` the first that is not, which is not known earlier
    /// than at `u`. Where it is at `k` itself nothing is asked of `f`; else `k` belongs to that part.
    fn up_to_unknown(&self, f: usize, k: Pos, (x, negated, u): (usize, bool, Pos), s: Segment) -> Option<bool> {
        let certain = (u..s.hi).find(|&j| self.holds_at(x, negated, j, s) == Some(true));
        let part = Segment { sure: u.min(s.sure).max(k + 1), ..certain.map_or(s, |j| s.until(j)) };
        let value = self.term(f, k, part);
        if u == k { or(None, value) } else { value }
    }

    /// `after X, f` at `k`: wherever X may hold first, f holds.
    fn after(&self, x: usize, f: usize, k: Pos, s: Segment) -> Option<bool> {
        let (mut all, mut came) = (Some(true), Some(false));
        for j in k..s.hi {
            let here = self.holds_at(x, false, j, s);
            if here != Some(false) {
                all = and(all, or(or(here.map(|x| !x), came), self.term(f, j, s)));
                came = or(came, here);
            }
            if came == Some(true) || all == Some(false) {
                return all;
            }
        }
        and(all, or(came, self.nothing_more(s)))
    }

    /// Of `until X, f` at `k`: whether X comes, and whether f holds up to it.
    fn up_to(&self, x: usize, f: usize, k: Pos, s: Segment) -> (Option<bool>, Option<bool>) {
        match self.first(x, false, k, s) {
            First::At(j) if j == k => (Some(true), Some(true)),
            First::At(j) => (Some(true), self.term(f, k, s.until(j))),
            First::Unknown(u) => {
                let comes = (u..s.hi).any(|j| self.holds_at(x, false, j, s) == Some(true));
                (comes.then_some(true), self.up_to_unknown(f, k, (x, false, u), s))
            }
            First::Nowhere => (self.nothing_more(s).map(|_| false), self.term(f, k, s)),
        }
    }

    /// `f` in each segment that `x` opens and `y` closes, or with `negated` the lack of it, from `k` on; the search goes on `skip` after a close.
    fn each(&self, k: Pos, s: Segment, f: usize, x: usize, (y, negated): (usize, bool), skip: u64) -> Option<bool> {
        let (mut all, mut from) = (Some(true), k);
        loop {
            let start = match self.first(x, false, from, s) {
                First::At(start) => start,
                First::Unknown(_) => return and(all, None),
                First::Nowhere => return and(all, self.nothing_more(s)),
            };
            match self.first(y, negated, start, s) {
                First::At(end) => {
                    if end > start {
                        all = and(all, self.term(f, start, s.until(end)));
                    }
                    from = end + skip;
                }
                First::Unknown(u) => {
                    let body = self.up_to_unknown(f, start, (y, negated, u), s);
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
