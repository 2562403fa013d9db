//! The memory of `once` and `since` whose bounds begin where they stand: when the operand of each held last.

use alloc::boxed::Box;

use serde::{Deserialize, Serialize};

use crate::pack::packed;

/// No stamp.
pub(crate) const NEVER: i64 = i64::MIN;

/// When operands held last, by the numbers of their operators.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Latest {
    /// The latest stamp at which the operand held, [`NEVER`] for none. Where it still holds, the stamp is that of the position before,
    /// and is noted when it ceases to.
    pub stamps: Box<[i64]>,
    /// The operators whose operand held at the position before, sixty-four a word.
    pub holding: Box<[u64]>,
}

packed!(Latest { stamps, holding });

impl Latest {
    /// Nothing has held yet.
    pub fn new(ops: usize) -> Latest {
        Latest { stamps: alloc::vec![NEVER; ops].into(), holding: alloc::vec![0; ops.div_ceil(64).max(1)].into() }
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
        let over = over(most);
        let is = (*stamp != NEVER) & !has_run_out(now, *stamp, over);
        if is {
            *alarm = (*alarm).min(runs_out(*stamp, over));
        }
        is
    }
}

/// The distance at which a bound of at most so many nanoseconds has run out. [`i64::MAX`] is no bound: no two stamps lie [`u64::MAX`] apart.
pub(crate) fn over(most: i64) -> u64 {
    if most == i64::MAX { u64::MAX } else { most.cast_unsigned() + 1 }
}

/// Whether a stamp, which is not later than `now`, lies that far back. A distance fits without a sign.
#[inline]
pub(crate) fn has_run_out(now: i64, stamp: i64, over: u64) -> bool {
    now.wrapping_sub(stamp).cast_unsigned() >= over
}

/// Before this time a stamp does not lie that far back; from then on that has to be looked at.
#[inline]
pub(crate) fn runs_out(stamp: i64, over: u64) -> i64 {
    stamp.saturating_add_unsigned(over)
}
