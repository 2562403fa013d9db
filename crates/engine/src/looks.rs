//! How often scopes are entered, for vacuity: at which positions they are looked at, and what they see there.

use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::future::{Decided, Segment};
use crate::node::View;
use crate::pack::packed;
use crate::past::once;
use crate::program::{Bound, Look, LookKind};
use crate::runs::Runs;
use crate::times::Pos;

/// Whether a scope is looked at, and how often it was entered.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct LookState {
    /// Whether the latest position is looked at.
    pub now: bool,
    /// Whether a position before is looked at that has not had its X.
    pending: bool,
    /// What it saw at the position before.
    before: bool,
    /// Stamps of positions that are looked at, before and after the lower end of a bound.
    queue: VecDeque<i64>,
    reached: Option<i64>,
    /// Positions that are looked at and where the future formula is unknown.
    asked: Runs,
    /// Whether nobody wants to know any more what the future formula is.
    is_off: bool,
    /// Whether the latest position left all of the above as it was.
    #[serde(skip)]
    pub is_still: bool,
    /// Entries: inside the innermost context that awaits its X, inside the next, …, and last those that count.
    pub counts: Box<[u64]>,
}

packed!(LookState { now, pending, before, queue, reached, asked, is_off, counts, is_still });

impl LookState {
    pub fn new(look: &Look) -> LookState {
        LookState { counts: alloc::vec![0; look.awaits.len() + 1].into(), ..LookState::default() }
    }

    /// How many runs of positions wait for the future formula.
    pub fn runs(&self) -> usize {
        self.asked.len()
    }

    /// Asks no more.
    pub fn let_go(&mut self) {
        self.is_off = true;
        self.asked = Runs::default();
    }

    /// The graph decided something.
    pub fn decide(&mut self, look: &Look, decided: &[Vec<Decided>]) {
        let LookKind::Proves { formula, .. } = look.kind else { return };
        for d in &decided[formula.id as usize] {
            let holds = d.value != formula.negated;
            let count = &mut self.counts[0];
            self.asked.take(d.from, d.to, |a, b| *count += if holds { b - a + 1 } else { 0 });
        }
    }

    pub fn step(&mut self, look: &Look, n: Pos, segments: &[Segment], looks: &[LookState], view: &View<'_>) {
        let segment = &segments[look.context as usize];
        if segment.closes || segment.first {
            (self.pending, self.before, self.reached) = (false, false, None);
            self.queue.clear();
        }
        for (i, &context) in look.awaits.iter().enumerate() {
            let awaited = &segments[context as usize];
            if awaited.closes {
                let entries = core::mem::take(&mut self.counts[i]);
                self.counts[i + 1] += if awaited.closed_by_own { entries } else { 0 };
            }
        }
        let was = (self.now, self.pending, self.before);
        self.now = segment.active && self.sees(look, n, segment, looks, view);
        self.is_still = was == (self.now, self.pending, self.before);
        self.counts[0] += u64::from(self.now);
    }

    fn sees(&mut self, look: &Look, n: Pos, segment: &Segment, looks: &[LookState], view: &View<'_>) -> bool {
        let at = |of: u32| looks[of as usize].now;
        match look.kind {
            LookKind::First => segment.first,
            LookKind::Within(bound) => {
                bound == Bound::ALL || bound.contains(view.now.saturating_sub(segment.start_stamp))
            }
            LookKind::Same { of } => at(of),
            LookKind::Proves { of, .. } => {
                if at(of) && !self.is_off {
                    self.asked.push(n);
                }
                false
            }
            LookKind::Where { of, x } => at(of) && view.bool(x),
            LookKind::Unless { of, x } => at(of) && !view.bool(x),
            LookKind::Next { of } => core::mem::replace(&mut self.before, at(of)),
            LookKind::From { of, bound } => once(&bound, at(of), view.now, &mut self.queue, &mut self.reached),
            LookKind::FirstWith { of, x } => {
                self.pending |= at(of);
                let here = self.pending && view.bool(x);
                self.pending &= !here;
                here
            }
            LookKind::Opens { of, x, y } => {
                self.before |= at(of);
                self.pending |= at(of);
                let (opens, closes) = (self.pending && view.bool(x), view.bool(y));
                // A close, also at the opening position, lets the search go on.
                self.pending = (self.pending && !opens) || (closes && self.before);
                opens
            }
            LookKind::Runs { of, x } => {
                self.pending |= at(of);
                let here = view.bool(x);
                let was_here = core::mem::replace(&mut self.before, here);
                here && (at(of) || (self.pending && !was_here))
            }
        }
    }
}
