//! `after_until` and `while` where they are asked at many positions.
//!
//! Asked at k, the body must hold, in every inner segment from k on, at the first X at or after k. So an X inside a segment matters
//! to the positions after the X before it; the first X of a segment matters to all positions before it as well.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::{Decided, Moment, Operand, Pass};
use crate::pack::packed;
use crate::program::Bit;
use crate::runs::Runs;
use crate::times::Pos;

/// Positions not found false, and the X's at which the body is unknown.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct State {
    open: Runs,
    /// `(from, x)`: the body at `x` matters to `from..=x`; increasing in `x`.
    asked: VecDeque<(Pos, Pos)>,
    /// The latest X.
    before: Pos,
}

packed!(State { open, asked, before });

impl State {
    pub fn runs(&self) -> usize {
        self.open.len() + self.asked.len()
    }

    fn body_decided(&mut self, d: Decided, out: &mut Vec<Decided>) {
        let first = self.asked.partition_point(|a| a.1 < d.from);
        let beyond = self.asked.partition_point(|a| a.1 <= d.to);
        for (from, x) in self.asked.drain(first..beyond) {
            if !d.value {
                self.open.take(from, x, |from, to| out.push(Decided { from, to, value: false }));
            }
        }
    }
}

pub(crate) fn step(
    state: &mut State,
    (context, inner): (u32, u32),
    x: Bit,
    body: Operand<'_>,
    pass: &Pass<'_>,
    out: &mut Vec<Decided>,
) {
    if let Some(n) = pass.position(context) {
        state.open.push(n);
        if pass.segments[inner as usize].active && pass.view.bool(x) {
            let from = if pass.segments[inner as usize].first { 0 } else { state.before + 1 };
            state.asked.push_back((from, n));
            state.before = n;
        }
    }
    body.iter().for_each(|d| state.body_decided(d, out));
    if pass.closes(context) {
        state.open.drain(|from, to| out.push(Decided { from, to, value: true }));
        state.asked.clear();
    }
    if let Moment::End { .. } = pass.moment {
        for k in state.open.iter().flat_map(|(a, b)| a..=b) {
            if !state.asked.iter().any(|&(from, x)| from <= k && k <= x) {
                out.push(Decided { from: k, to: k, value: true });
            }
        }
    }
}
