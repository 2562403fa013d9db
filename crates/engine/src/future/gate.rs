//! What fails under a `before X` is told only when X comes.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::{Decided, Moment, Operand, Pass};
use crate::pack::packed;
use crate::runs::Runs;

/// Positions found false that wait for X.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct State {
    failed: Runs,
}

packed!(State { failed });

impl State {
    pub fn runs(&self) -> usize {
        self.failed.len()
    }
}

pub(crate) fn step(state: &mut State, before: u32, body: Operand<'_>, pass: &Pass<'_>, out: &mut Vec<Decided>) {
    for d in body.iter() {
        if d.value {
            out.push(d);
        } else {
            state.failed.insert(d.from, d.to);
        }
    }
    if pass.closes(before) {
        let came = pass.segments[before as usize].closed_by_own;
        state.failed.drain(|from, to| out.push(Decided { from, to, value: !came }));
    }
    if let Moment::End { .. } = pass.moment {
        out.extend(state.failed.iter().map(|(from, to)| Decided { from, to, value: true }));
    }
}
