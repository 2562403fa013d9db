//! Conjunction: false as soon as one operand is, true when both are.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::{Decided, Operand, Pass};
use crate::pack::packed;
use crate::times::Pos;

/// Undecided positions that fare alike.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Run {
    from: Pos,
    to: Pos,
    /// Which operands are known to be true; never both.
    left: bool,
    right: bool,
}

/// The undecided positions.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct State {
    open: VecDeque<Run>,
}

packed!(State { open });
packed!(Run { from, to, left, right });

impl State {
    pub fn runs(&self) -> usize {
        self.open.len()
    }

    pub fn newest(&self) -> Option<Pos> {
        self.open.back().map(|run| run.to)
    }

    /// An operand became known for some positions.
    fn apply(&mut self, d: Decided, is_left: bool, out: &mut Vec<Decided>) {
        let mut i = self.open.partition_point(|r| r.to < d.from);
        while let Some(&run) = self.open.get(i) {
            if run.from > d.to {
                return;
            }
            let (from, to) = (run.from.max(d.from), run.to.min(d.to));
            if run.from < from {
                self.open[i].to = from - 1;
                i += 1;
                self.open.insert(i, Run { from, ..run });
            }
            if to < run.to {
                self.open[i].to = to;
                self.open.insert(i + 1, Run { from: to + 1, ..run });
            }
            let now =
                Run { from, to, left: run.left || (is_left && d.value), right: run.right || (!is_left && d.value) };
            if !d.value || (now.left && now.right) {
                out.push(Decided { from, to, value: d.value });
                self.open.remove(i);
            } else {
                self.open[i] = now;
                i += 1;
            }
        }
    }

    /// The newest position joins the run before it where both fare alike.
    fn join_newest(&mut self) {
        if let [.., a, b] = self.open.make_contiguous()
            && (a.to + 1, a.left, a.right) == (b.from, b.left, b.right)
        {
            a.to = b.to;
            self.open.pop_back();
        }
    }
}

pub(crate) fn step(
    state: &mut State,
    context: u32,
    left: Operand<'_>,
    right: Operand<'_>,
    pass: &Pass<'_>,
    out: &mut Vec<Decided>,
) {
    let new = pass.position(context);
    if let Some(n) = new {
        state.open.push_back(Run { from: n, to: n, left: false, right: false });
    }
    left.iter().for_each(|d| state.apply(d, true, out));
    right.iter().for_each(|d| state.apply(d, false, out));
    if new.is_some() {
        state.join_newest();
    }
    if pass.closes(context) {
        // The operands are decided when their segment closes, and so are we.
        debug_assert!(state.open.is_empty(), "a conjunction outlives its segment");
        state.open.clear();
    }
}
