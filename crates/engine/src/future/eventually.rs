//! `eventually`, bounded or not. (`always` is its dual.)
//!
//! A position is true once a position that it looks at is, false once its bound is over, or its segment closed, and none is. Where
//! the operand is itself a future formula it may still be unknown when the bound is over. Such a late position waits until nothing that it
//! looks at is unknown any more; those that wait for the same run of unknown positions are neighbours and are passed over together, so that
//! the cost does not grow with the bound.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::{Decided, Moment, Operand, Pass, ends};
use crate::pack::packed;
use crate::program::{Bound, Future};
use crate::runs::Runs;
use crate::times::{Pos, Times};

/// The undecided positions, and where the operand is unknown.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct State {
    open: Runs,
    unknown: Runs,
    /// For open positions before this one the bound is over.
    late: Pos,
}

packed!(State { open, unknown, late });

impl State {
    pub fn runs(&self) -> usize {
        self.open.len() + self.unknown.len()
    }

    pub fn oldest(&self) -> Option<Pos> {
        match (self.open.first(), self.unknown.first()) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        }
    }

    pub fn newest(&self) -> Option<Pos> {
        self.open.last().max(self.unknown.last())
    }

    pub fn deadline(&self, bound: &Bound, times: &Times) -> Option<(i64, bool)> {
        if !bound.has_end() {
            return None;
        }
        ends(bound, times.at(self.open.at_or_after(self.late)?))
    }

    /// The operand is true at some positions.
    fn hit(&mut self, d: Decided, bound: &Bound, pass: &Pass<'_>, out: &mut Vec<Decided>) {
        let mut yes = |from, to| out.push(Decided { from, to, value: true });
        if *bound == Bound::ALL {
            self.open.take(0, d.to, yes);
            return;
        }
        for j in d.from..=d.to {
            if let Some((first, last)) = pass.looking_at(j, bound) {
                self.open.take(first, last, &mut yes);
            }
        }
    }

    /// The bound is over for positions before `late`: those that look at nothing unknown are false.
    fn become_late(&mut self, late: Pos, bound: &Bound, pass: &Pass<'_>, out: &mut Vec<Decided>) {
        let mut next = self.open.at_or_after(self.late);
        while let Some(k) = next.filter(|&k| k < late) {
            if self.awaited(k, bound, pass).is_none() {
                self.open.take(k, k, |from, to| out.push(Decided { from, to, value: false }));
            }
            next = self.open.at_or_after(k + 1);
        }
        self.late = self.late.max(late);
    }

    /// The operand is known at more positions: late positions that look at nothing unknown any more are false.
    fn give_up_late(&mut self, bound: &Bound, pass: &Pass<'_>, out: &mut Vec<Decided>) {
        let mut next = self.open.first();
        while let Some(k) = next.filter(|&k| k < self.late) {
            let mut beyond = k + 1;
            match self.awaited(k, bound, pass) {
                // Whoever looks at anything when it becomes late, and lies between two that wait for a run, waits for it, too.
                Some(last) => beyond = beyond.max(pass.looking_at(last, bound).map_or(0, |(_, to)| to + 1)),
                None => self.open.take(k, k, |from, to| out.push(Decided { from, to, value: false })),
            }
            next = self.open.at_or_after(beyond);
        }
    }

    /// The end of the first run of unknown positions that a position looks at, where there is one.
    fn awaited(&self, k: Pos, bound: &Bound, pass: &Pass<'_>) -> Option<Pos> {
        let (first, last) = pass.looked_at(k, bound);
        self.unknown.run_at_or_after(first).filter(|(from, _)| first <= last && *from <= last).map(|(_, to)| to)
    }

    /// The trace is all there is: open positions are false, but where the bound reaches beyond or the operand is unknown.
    fn end(&mut self, bound: &Bound, last: i64, pass: &Pass<'_>, out: &mut Vec<Decided>) {
        let runs: Vec<_> = self.open.iter().collect();
        for k in runs.into_iter().flat_map(|(a, b)| a..=b) {
            let reaches_beyond = bound.has_end() && pass.times.at(k).saturating_add(bound.hi) > last;
            let (from, to) = pass.looked_at(k, bound);
            if !reaches_beyond && (from > to || !self.unknown.meets(from, to)) {
                out.push(Decided { from: k, to: k, value: false });
            }
        }
    }
}

pub(crate) fn step(
    state: &mut State,
    node: &Future,
    bound: &Bound,
    operand: Operand<'_>,
    pass: &Pass<'_>,
    out: &mut Vec<Decided>,
) {
    if let Some(n) = pass.asked(node) {
        state.open.push(n);
    }
    if let Some(n) = pass.position(node.context) {
        state.unknown.push(n);
    }
    if let Moment::Deadline { at, closed } = pass.moment
        && bound.has_end()
        && bound.hi_closed == closed
    {
        state.become_late(pass.times.first_after(at.saturating_sub(bound.hi)), bound, pass, out);
    }
    let mut recheck = false;
    for d in operand.iter() {
        state.unknown.take(d.from, d.to, |_, _| ());
        if d.value {
            state.hit(d, bound, pass, out);
        } else {
            recheck = true;
        }
    }
    if recheck && state.open.first().is_some_and(|k| k < state.late) {
        state.give_up_late(bound, pass, out);
    }
    if pass.closes(node.context) {
        state.open.drain(|from, to| out.push(Decided { from, to, value: false }));
        state.unknown.clear();
    }
    if let Moment::End { last } = pass.moment {
        state.end(bound, last, pass, out);
    }
}
