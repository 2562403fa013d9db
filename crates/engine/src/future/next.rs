//! `next`: the operand at the position after, in the same segment.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::{Decided, Operand, Pass};
use crate::pack::packed;
use crate::runs::Runs;
use crate::times::Pos;

/// The undecided positions.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct State {
    open: Runs,
}

packed!(State { open });

impl State {
    pub fn runs(&self) -> usize {
        self.open.len()
    }
}

pub(crate) fn step(state: &mut State, context: u32, operand: Operand<'_>, pass: &Pass<'_>, out: &mut Vec<Decided>) {
    for d in operand.iter() {
        if let Some(to) = d.to.checked_sub(1) {
            // The position before a segment's first belongs to no segment or to one that has closed: it is not open.
            let from: Pos = d.from.saturating_sub(1);
            state.open.take(from, to, |from, to| out.push(Decided { from, to, value: d.value }));
        }
    }
    if let Some(n) = pass.position(context) {
        state.open.push(n);
    }
    if pass.closes(context) {
        state.open.drain(|from, to| out.push(Decided { from, to, value: false }));
    }
}
