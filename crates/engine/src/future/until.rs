//! `until` between formulas that are known at once.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::{Decided, Moment, Pass, ends};
use crate::pack::packed;
use crate::program::{Bit, Bound, Future};
use crate::runs::Runs;
use crate::times::{Pos, Times};

/// The positions at and after which the left operand has held, and the right has not where they look.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct State {
    open: Runs,
}

packed!(State { open });

impl State {
    pub fn runs(&self) -> usize {
        self.open.len()
    }

    pub fn oldest(&self) -> Option<Pos> {
        self.open.first()
    }

    pub fn newest(&self) -> Option<Pos> {
        self.open.last()
    }

    pub fn deadline(&self, bound: &Bound, times: &Times) -> Option<(i64, bool)> {
        if !bound.has_end() {
            return None;
        }
        ends(bound, times.at(self.open.first()?))
    }
}

pub(crate) fn step(
    state: &mut State,
    node: &Future,
    bound: &Bound,
    (left, right): (Bit, Bit),
    pass: &Pass<'_>,
    out: &mut Vec<Decided>,
) {
    if let Some(n) = pass.asked(node) {
        state.open.push(n);
    }
    if let Some(n) = pass.position(node.context) {
        if pass.view.bool(right)
            && let Some((first, last)) = pass.looking_at(n, bound)
        {
            state.open.take(first, last, |from, to| out.push(Decided { from, to, value: true }));
        }
        if !pass.view.bool(left) {
            state.open.drain(|from, to| out.push(Decided { from, to, value: false }));
        }
    }
    match pass.moment {
        Moment::Deadline { at, closed } if bound.has_end() && bound.hi_closed == closed => {
            let beyond = pass.times.first_after(at.saturating_sub(bound.hi));
            if let Some(last) = beyond.checked_sub(1) {
                state.open.take(0, last, |from, to| out.push(Decided { from, to, value: false }));
            }
        }
        Moment::End { last } => {
            for k in state.open.iter().flat_map(|(a, b)| a..=b) {
                if !bound.has_end() || pass.times.at(k).saturating_add(bound.hi) <= last {
                    out.push(Decided { from: k, to: k, value: false });
                }
            }
        }
        _ if pass.closes(node.context) => state.open.drain(|from, to| out.push(Decided { from, to, value: false })),
        _ => {}
    }
}
