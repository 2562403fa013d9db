//! The memory of `once` and `since` whose bounds begin where they stand: when the operand of each held last.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

/// No stamp.
pub(crate) const NEVER: i64 = i64::MIN;

/// When operands held last, by the numbers of their operators.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Latest {
    /// The latest stamp at which the operand held, [`NEVER`] for none. Where it still holds, the stamp is that of the position before,
    /// and is noted when it ceases to.
    pub stamps: Vec<i64>,
    /// The operators whose operand held at the position before, sixty-four a word.
    pub holding: Vec<u64>,
}

impl Latest {
    /// Nothing has held yet.
    pub fn new(ops: usize) -> Latest {
        Latest { stamps: alloc::vec![NEVER; ops], holding: alloc::vec![0; ops.div_ceil(64).max(1)] }
    }

    /// The `i`-th operator forgets what has been.
    #[inline]
    pub fn forget(&mut self, i: usize) {
        self.stamps[i] = NEVER;
        self.holding[i >> 6] &= !(1 << (i & 63));
    }

    /// A position at `now`, at which the operand of the `i`-th operator holds or not: whether it does, or did at most so long ago. Brings
    /// `alarm` forward to when that runs out.
    #[inline]
    pub fn note(&mut self, i: usize, holds: bool, times: (i64, Option<i64>), most: i64, alarm: &mut i64) -> bool {
        let (now, before) = times;
        let (stamp, word) = (&mut self.stamps[i], &mut self.holding[i >> 6]);
        if (*word >> (i & 63)) & 1 == 1
            && let Some(before) = before
        {
            *stamp = before;
        }
        *word = (*word & !(1 << (i & 63))) | (u64::from(holds) << (i & 63));
        if holds {
            *stamp = now;
            return true;
        }
        let is = (*stamp != NEVER) & is_within(now, *stamp, most);
        if is {
            *alarm = (*alarm).min(runs_out(*stamp, most));
        }
        is
    }
}

/// Whether a stamp, which is not later than `now`, lies at most so far back; [`i64::MAX`] is no bound. The distance fits without a sign.
#[inline]
fn is_within(now: i64, stamp: i64, most: i64) -> bool {
    (now.wrapping_sub(stamp).cast_unsigned() <= most.cast_unsigned()) | (most == i64::MAX)
}

/// Before this time a stamp lies at most so far back; from then on that has to be looked at.
#[inline]
fn runs_out(stamp: i64, most: i64) -> i64 {
    stamp.saturating_add(most).saturating_add(1)
}
