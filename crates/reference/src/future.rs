//! The future operators, one function each: the table of *Temporal operators* of the language reference, with *unknown* for what
//! is not yet seen (*Verdicts*).

use crate::course::Course;
use crate::truth::Truth::{self, False, True, Unknown};
use lapwing_check::checked::{Bound, Connective, Expr, Kind, Scope};
use lapwing_stream::Time;

/// How much of a segment is seen, and from when.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) struct View {
    /// The positions before this one are seen.
    pub(crate) seen: usize,
    /// Those before this one belong to the segment for sure; of the others that are seen it is not known.
    pub(crate) sure: usize,
    /// The stamps of those not yet seen are at least this.
    pub(crate) rest: (Time, bool),
    /// How the segment ends.
    pub(crate) end: End,
}

/// How a segment ends.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum End {
    /// Before this position.
    At(usize),
    /// Not within what is seen.
    Open,
    /// With the trace, as it is: nothing more comes, but what a bound or `next` cuts off is unknown.
    Cut,
}

impl View {
    /// The position after the last that is seen of the segment.
    pub(crate) fn upto(&self) -> usize {
        match self.end {
            End::At(end) => end,
            End::Open | End::Cut => self.seen,
        }
    }

    /// The part of the segment before `end`.
    pub(crate) fn until(&self, end: usize) -> View {
        View { end: End::At(end), ..*self }
    }

    /// Whether a position that is seen belongs to the segment.
    fn has(&self, j: usize) -> Truth {
        if j < self.sure { True } else { Unknown }
    }
}

/// The first position with some property, as far as can be told.
enum First {
    At(usize),
    /// Perhaps nowhere.
    NotKnown,
    Nowhere,
}

impl Course<'_> {
    /// Whether a formula holds at position `k` of a segment.
    pub(crate) fn truth(&self, f: &Expr, k: usize, view: View) -> Truth {
        if !f.has_future() {
            return self.state(f, k, view);
        }
        let key = (std::ptr::from_ref(f), k, view);
        if let Some(truth) = self.found.borrow().get(&key) {
            return *truth;
        }
        let truth = self.table(f, k, view);
        self.found.borrow_mut().insert(key, truth);
        truth
    }

    /// The table of future operators and of connectives that have one below.
    fn table(&self, f: &Expr, k: usize, view: View) -> Truth {
        match &f.kind {
            Kind::Always(bound, f) => self.always(bound, |j| self.truth(f, j, view), k, view),
            Kind::Eventually(bound, f) => self.eventually(bound, |j| self.truth(f, j, view), k, view),
            Kind::Next(f) => self.next(f, k, view),
            Kind::Until(bound, left, right) => self.until(bound, left, right, k, view),
            Kind::Scope(Scope::After, x, f) => self.after(x, f, k, view),
            Kind::Scope(Scope::Until, x, f) => self.exists(x, k, view).and(self.up_to(x, f, k, view)),
            Kind::Scope(Scope::Before, x, f) => (!self.exists(x, k, view)).or(self.up_to(x, f, k, view)),
            Kind::Scope(Scope::While, x, f) => self.while_(x, f, k, view),
            Kind::Scope(Scope::Whenever, x, f) => {
                self.always(&Bound::ALL, |j| self.truth(x, j, view).implies(self.truth(f, j, view)), k, view)
            }
            Kind::AfterUntil(x, y, f) => self.after_until(x, y, f, k, view),
            Kind::Not(f) => !self.truth(f, k, view),
            Kind::Connective(op, left, right) => {
                let (left, right) = (self.truth(left, k, view), self.truth(right, k, view));
                match op {
                    Connective::And => left.and(right),
                    Connective::Or => left.or(right),
                    Connective::Implies => left.implies(right),
                    Connective::Iff => left.iff(right),
                }
            }
            // Nothing else has a future operator below it.
            _ => self.state(f, k, view),
        }
    }

    /// `φ̂`: `always φ` where φ contains no future operator, else φ.
    fn hat(&self, f: &Expr, k: usize, view: View) -> Truth {
        if f.has_future() {
            self.truth(f, k, view)
        } else {
            self.always(&Bound::ALL, |j| self.truth(f, j, view), k, view)
        }
    }

    /// A formula without future operators. At a position that does not exist no event occurs and there is no past.
    fn state(&self, f: &Expr, k: usize, view: View) -> Truth {
        match view.end {
            _ if k < self.len() && k < view.seen => self.holds(f, k as i64).into(),
            End::Open => Unknown,
            End::At(_) | End::Cut => self.holds(f, -1).into(),
        }
    }

    /// The positions of `[k, hi)` that are seen and within the bound.
    fn within(&self, bound: &Bound, k: usize, view: View) -> impl Iterator<Item = usize> {
        (k..view.upto()).filter(move |&j| bound.contains(self.time(j).since(self.time(k))))
    }

    /// Whether `[k, hi)` may have further positions within the bound.
    fn may_go_on(&self, bound: &Bound, k: usize, view: View) -> bool {
        let deadline = bound.hi.map(|hi| if k < self.len() { self.time(k) + hi } else { self.piece.last });
        match (view.end, deadline) {
            (End::At(_), _) => false,
            (End::Open, None) => true,
            (End::Open, Some(deadline)) if bound.hi_closed => view.rest <= (deadline, false),
            (End::Open, Some(deadline)) => view.rest < (deadline, false),
            (End::Cut, None) => false,
            (End::Cut, Some(deadline)) => deadline > self.piece.last,
        }
    }

    /// φ holds at every position of `[k, hi)` within the bound.
    fn always(&self, bound: &Bound, holds: impl Fn(usize) -> Truth, k: usize, view: View) -> Truth {
        let seen = self.within(bound, k, view).fold(True, |all, j| all.and(view.has(j).implies(holds(j))));
        if self.may_go_on(bound, k, view) { seen.and(Unknown) } else { seen }
    }

    /// φ holds at some position of `[k, hi)` within the bound.
    fn eventually(&self, bound: &Bound, holds: impl Fn(usize) -> Truth, k: usize, view: View) -> Truth {
        let seen = self.within(bound, k, view).fold(False, |any, j| any.or(view.has(j).and(holds(j))));
        if self.may_go_on(bound, k, view) { seen.or(Unknown) } else { seen }
    }

    /// `k+1 < hi` and φ holds there.
    fn next(&self, f: &Expr, k: usize, view: View) -> Truth {
        if k + 1 < view.upto() {
            return view.has(k + 1).and(self.truth(f, k + 1, view));
        }
        match view.end {
            End::At(_) => False,
            End::Open => Unknown,
            // At the last position it is cut off; where there is no position, nothing will come.
            End::Cut if k < view.upto() => Unknown,
            End::Cut => False,
        }
    }

    /// ψ holds at some `j` in `[k, hi)` within the bound and φ at all of `[k, j)`.
    fn until(&self, bound: &Bound, left: &Expr, right: &Expr, k: usize, view: View) -> Truth {
        let (mut any, mut before) = (False, True);
        for j in k..view.upto() {
            if bound.contains(self.time(j).since(self.time(k))) {
                any = any.or(view.has(j).and(self.truth(right, j, view)).and(before));
            }
            before = before.and(self.truth(left, j, view));
        }
        if self.may_go_on(bound, k, view) { any.or(Unknown.and(before)) } else { any }
    }

    /// With `j` the first position of `[k, hi)` with X: none, or `φ̂` holds at `j` in the segment `[j, hi)`.
    fn after(&self, x: &Expr, f: &Expr, k: usize, view: View) -> Truth {
        let (mut all, mut came) = (True, False);
        for j in k..view.upto() {
            let first = view.has(j).and(self.truth(x, j, view)).and(!came);
            if first != False {
                all = all.and(first.implies(self.hat(f, j, view)));
            }
            came = came.or(first);
        }
        // What is not seen yet may have the first.
        if view.end == End::Open { all.and(came.or(Unknown)) } else { all }
    }

    /// X holds somewhere in `[k, hi)`.
    pub(crate) fn exists(&self, x: &Expr, k: usize, view: View) -> Truth {
        self.eventually(&Bound::ALL, |j| self.truth(x, j, view), k, view)
    }

    /// With `j` the first position of `[k, hi)` with X: `j = k`, or `φ̂` holds at `k` in the segment `[k, j)`.
    fn up_to(&self, x: &Expr, f: &Expr, k: usize, view: View) -> Truth {
        self.body(f, k, |j| self.truth(x, j, view), view)
    }

    /// In each segment `[i, j)` that an X opens and the next Y at or after `i` closes, `φ̂` holds at `i`.
    fn after_until(&self, x: &Expr, y: &Expr, f: &Expr, k: usize, view: View) -> Truth {
        let mut all = True;
        let mut from = k;
        loop {
            let i = match self.first(x, from, view) {
                First::At(i) => i,
                First::NotKnown => return all.and(Unknown),
                First::Nowhere => return all,
            };
            let end = self.first(y, i, view);
            from = match end {
                First::At(j) => j + 1,
                First::NotKnown | First::Nowhere => usize::MAX,
            };
            let goes_on = matches!(end, First::NotKnown);
            all = all.and(self.body(f, i, |j| self.truth(y, j, view), view));
            if from == usize::MAX {
                return if goes_on { all.and(Unknown) } else { all };
            }
        }
    }

    /// `φ̂` holds at the first position of every maximal run of positions with X.
    fn while_(&self, x: &Expr, f: &Expr, k: usize, view: View) -> Truth {
        let mut all = True;
        let mut from = k;
        loop {
            let i = match self.first(x, from, view) {
                First::At(i) => i,
                First::NotKnown => return all.and(Unknown),
                First::Nowhere => return all,
            };
            let end = self.first_with(i, view, |j| !self.truth(x, j, view));
            let next = match end {
                First::At(j) => Some(j),
                First::NotKnown | First::Nowhere => None,
            };
            let goes_on = matches!(end, First::NotKnown);
            all = all.and(self.body(f, i, |j| !self.truth(x, j, view), view));
            match next {
                Some(j) => from = j,
                None => return if goes_on { all.and(Unknown) } else { all },
            }
        }
    }

    /// `φ̂` at `i` in the segment that reaches from `i` to the first position that `ends` it. An empty segment counts as true.
    fn body(&self, f: &Expr, i: usize, ends: impl Fn(usize) -> Truth, view: View) -> Truth {
        let ends = |j: usize| view.has(j).and(ends(j));
        let empty = if i < view.upto() { ends(i) } else { False };
        // What lies before the first position that may end it is in the segment for sure, what lies before the first that does perhaps.
        let sure = (i..view.upto()).find(|&j| ends(j) != False);
        let end = (i..view.upto()).find(|&j| ends(j) == True);
        let whole = end.map_or(view, |end| view.until(end));
        // Where it is not empty, `i` belongs to it.
        let sure = sure.map_or(whole.sure, |j| j.min(whole.sure).max(i + 1));
        if empty == True { True } else { empty.or(self.hat(f, i, View { sure, ..whole })) }
    }

    /// The first position of `[from, hi)` with X.
    fn first(&self, x: &Expr, from: usize, view: View) -> First {
        self.first_with(from, view, |j| self.truth(x, j, view))
    }

    fn first_with(&self, from: usize, view: View, holds: impl Fn(usize) -> Truth) -> First {
        for j in from..view.upto() {
            match view.has(j).and(holds(j)) {
                True => return First::At(j),
                False => {}
                Unknown => return First::NotKnown,
            }
        }
        match view.end {
            End::Open => First::NotKnown,
            End::At(_) | End::Cut => First::Nowhere,
        }
    }
}
