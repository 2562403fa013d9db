//! Groups with segments or future operators, while nothing happens to them.
//!
//! Where a position left everything as it was, with no segment beginning or ending at it, the next one does the same if no operator changes:
//! its obligations are met where they arise, scopes are entered as they were, and what is open stays open until its bound is over. Such
//! positions are only counted, and made up for when something is due again.

use crate::group::Core;
use crate::program::{At, Bound, ContextKind, FutureKind, Group, Judged, LookKind};
use crate::times::Pos;

impl Group {
    /// Whether it may idle at all: nothing in it depends on how long its segments have lasted, or runs at every position.
    pub(crate) fn may_idle(&self) -> bool {
        let untimed = self.at.alphabet.is_none();
        let is_wired = self.at.wiring.as_ref().is_some_and(|wiring| wiring.restless == 0);
        let steady = self.trackers.iter().all(|t| matches!(t.at, At::First | At::All));
        !self.is_plain() && untimed && is_wired && steady && self.looks_stand_still() && self.futures_stand_still()
    }

    /// The operators whose truth values anything above them asks for, as bits: while these stay, a position does what the one before it did.
    pub(crate) fn heard(&self) -> u64 {
        let trackers = self.trackers.iter().filter_map(|tracker| match tracker.formula {
            Judged::State(formula) => Some(formula),
            Judged::Future(_) => None,
        });
        let contexts = self.contexts.iter().flat_map(|context| match context.kind {
            ContextKind::Whole => [None, None],
            ContextKind::After { x } | ContextKind::Until { x, .. } | ContextKind::While { x } => [Some(x), None],
            ContextKind::AfterUntil { x, y } => [Some(x), Some(y)],
        });
        let looks = self.looks.iter().flat_map(|look| match look.kind {
            LookKind::Where { x, .. }
            | LookKind::Unless { x, .. }
            | LookKind::FirstWith { x, .. }
            | LookKind::Runs { x, .. } => [Some(x), None],
            LookKind::Opens { x, y, .. } => [Some(x), Some(y)],
            LookKind::Within(_)
            | LookKind::First
            | LookKind::From { .. }
            | LookKind::Next { .. }
            | LookKind::Same { .. }
            | LookKind::Proves { .. } => [None, None],
        });
        let futures = self.futures.iter().flat_map(|future| match future.kind {
            FutureKind::State(of) => [Some(of), None, future.asked],
            FutureKind::Until(_, left, right) => [Some(left), Some(right), future.asked],
            // What else there is stands on nodes, or does not idle.
            _ => [None, None, future.asked],
        });
        let all = trackers.chain(contexts.flatten()).chain(looks.flatten()).chain(futures.flatten());
        all.fold(0, |heard, bit| heard | 1_u64.checked_shl(bit.register() as u32).unwrap_or(0))
    }

    fn looks_stand_still(&self) -> bool {
        self.looks.iter().all(|look| match look.kind {
            LookKind::Within(bound) | LookKind::From { bound, .. } => bound == Bound::ALL,
            LookKind::Proves { .. } => false,
            _ => true,
        })
    }

    fn futures_stand_still(&self) -> bool {
        self.futures.iter().all(|future| {
            let kind = &future.kind;
            matches!(
                kind,
                FutureKind::State(_) | FutureKind::And(..) | FutureKind::Eventually(..) | FutureKind::Until(..)
            )
        })
    }
}

impl Core {
    /// Whether position `n`, at `now`, left everything as it was: it met its own obligations at once, and decided nothing else.
    pub(crate) fn is_still(&self, plan: &Group, n: Pos, now: i64) -> bool {
        self.margins.is_none()
            && self.graph.segments.iter().all(|segment| !segment.first && !segment.closes)
            && self.trackers.iter().all(|tracker| !tracker.missed_at(n))
            && self.looks.iter().all(|look| look.is_still)
            && self.graph.is_still(&plan.futures, n)
            // Which of several positions with one stamp an obligation began at is told: those are counted one by one.
            && self.trackers.iter().filter_map(|tracker| tracker.open.last()).all(|open| self.times.at(open) < now)
    }

    /// Counts the instants before the one with that number that were not looked at, the last of them at `last`. They take no numbers as positions:
    /// nothing is open at them, and the position that began to idle parts what is open before them from what comes after.
    #[inline(never)]
    pub(crate) fn make_up_idle(&mut self, plan: &Group, number: u64, last: i64) {
        self.idles = false;
        let missed = number.saturating_sub(self.stepped);
        if missed == 0 {
            return;
        }
        self.stepped = number;
        self.positions += missed;
        self.walk.pass_over(last);
        for (state, tracker) in self.trackers.iter_mut().zip(&plan.trackers) {
            if tracker.at == At::All
                && self.graph.segments[tracker.context as usize].active
                && state.given_up().is_none()
            {
                state.met += missed;
            }
        }
        for look in &mut *self.looks {
            look.counts[0] += if look.now { missed } else { 0 };
        }
    }
}
