//! `after`, `until` and `before` where they are asked at many positions: below a connective, a bound, `next`.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::{Decided, Moment, Operand, Pass};
use crate::pack::packed;
use crate::program::Bit;
use crate::runs::Runs;
use crate::times::Pos;

/// Positions that wait for an X, and positions that have theirs and wait for the body at it.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct AfterState {
    waiting: Runs,
    /// `(from, to, x)`, increasing.
    placed: VecDeque<(Pos, Pos, Pos)>,
}

packed!(AfterState { waiting, placed });

impl AfterState {
    pub fn runs(&self) -> usize {
        self.waiting.len() + self.placed.len()
    }

    fn body_decided(&mut self, d: Decided, out: &mut Vec<Decided>) {
        let mut i = self.placed.partition_point(|p| p.2 < d.from);
        while let Some(&(from, to, x)) = self.placed.get(i) {
            if x > d.to {
                return;
            }
            out.push(Decided { from, to, value: d.value });
            self.placed.remove(i);
            i = i.min(self.placed.len());
        }
    }
}

/// `after X, body`: true where no X comes.
pub(crate) fn step_after(
    state: &mut AfterState,
    context: u32,
    x: Bit,
    body: Operand<'_>,
    pass: &Pass<'_>,
    out: &mut Vec<Decided>,
) {
    if let Some(n) = pass.position(context) {
        state.waiting.push(n);
        if pass.view.bool(x) {
            let placed = &mut state.placed;
            state.waiting.drain(|from, to| placed.push_back((from, to, n)));
        }
    }
    body.iter().for_each(|d| state.body_decided(d, out));
    if pass.closes(context) {
        state.waiting.drain(|from, to| out.push(Decided { from, to, value: true }));
        state.placed.clear();
    }
    if let Moment::End { .. } = pass.moment {
        out.extend(state.waiting.iter().map(|(from, to)| Decided { from, to, value: true }));
    }
}

/// Positions whose body is unknown, and positions whose body is known and that wait for X.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct UntilState {
    unknown: Runs,
    waiting: Runs,
}

packed!(UntilState { unknown, waiting });

impl UntilState {
    pub fn runs(&self) -> usize {
        self.unknown.len() + self.waiting.len()
    }
}

/// `until X, body`: X comes, and the body holds up to it. With `weak`, `before X, body`: X does not come, or the body holds.
///
/// A body that goes the way that X cannot change (false under `until`, true under `before`) decides; the other way waits for X.
pub(crate) fn step_until(
    state: &mut UntilState,
    context: u32,
    weak: bool,
    x: Bit,
    body: Operand<'_>,
    pass: &Pass<'_>,
    out: &mut Vec<Decided>,
) {
    let here = pass.position(context).map(|n| (n, pass.view.bool(x)));
    if let Some((n, false)) = here {
        state.unknown.push(n);
    }
    let UntilState { unknown, waiting } = state;
    for d in body.iter() {
        unknown.take(d.from, d.to, |from, to| {
            if d.value == weak {
                out.push(Decided { from, to, value: weak });
            } else {
                waiting.insert(from, to);
            }
        });
    }
    if let Some((n, true)) = here {
        waiting.drain(|from, to| out.push(Decided { from, to, value: !weak }));
        out.push(Decided { from: n, to: n, value: true });
    }
    if pass.closes(context) {
        waiting.drain(|from, to| out.push(Decided { from, to, value: weak }));
        unknown.drain(|from, to| out.push(Decided { from, to, value: weak }));
    }
    if let Moment::End { .. } = pass.moment {
        let left = waiting.iter().chain(unknown.iter());
        out.extend(left.map(|(from, to)| Decided { from, to, value: weak }));
    }
}
