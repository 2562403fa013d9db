//! Obligations: which are open, which failed, and the episodes that failures make.

use alloc::vec::Vec;

use lapwing_stream::Time;
use serde::{Deserialize, Serialize};

use crate::future::{Decided, Segment};
use crate::node::View;
use crate::outcome::Episode;
use crate::pack::packed;
use crate::program::{At, Context, ContextKind, Judged, Tracker};
use crate::runs::Runs;
use crate::standing::GivenUp;
use crate::times::{Pos, Times};

/// The obligations of one conjunct.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct TrackerState {
    pub open: Runs,
    pub met: u64,
    pub failed: u64,
    /// Whether, were the trace all, an open obligation would be missed: since when.
    pub unmet_since: Option<i64>,
    /// Episodes that a further failure may still join.
    live: Vec<Live>,
    /// Scratch: the runs that fail in this pass.
    taken: Vec<(Pos, Pos)>,
    /// Episodes that are over.
    pub done: Vec<Episode>,
    /// Why nothing is judged any more, where that is so: see [`TrackerState::given_up`].
    is_spoilt: bool,
    is_overflowed: bool,
}

packed!(TrackerState { open, met, failed, unmet_since, live, done, is_spoilt, is_overflowed } without { taken });

/// An episode in the making.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Live {
    from: Pos,
    to: Pos,
    /// The position of the obligation that failed first.
    first: Pos,
    episode: Episode,
}

packed!(Live { from, to, first, episode });

impl TrackerState {
    /// Takes a new position in. Tells `begins` where the obligations began whose failures begin an episode.
    pub fn position(
        &mut self,
        tracker: &Tracker,
        n: Pos,
        segment: &Segment,
        view: &View<'_>,
        decided: &[Vec<Decided>],
        times: &Times,
        mut begins: impl FnMut(Pos),
    ) {
        if segment.active && self.given_up().is_none() && is_obliged(tracker, segment, view.now) {
            match tracker.formula {
                Judged::State(formula) => {
                    if self.judge(view.bool(formula), n, view.now) {
                        begins(n);
                    }
                    return;
                }
                Judged::Future(_) => self.open.push(n),
            }
        }
        self.decide(tracker, decided, view.now, times, begins);
        if !self.live.is_empty() {
            self.seal(n);
        }
    }

    /// An obligation that begins and ends at the newest position. Returns whether it failed and begins an episode.
    #[inline]
    pub fn judge(&mut self, holds: bool, n: Pos, now: i64) -> bool {
        if self.given_up().is_some() {
            return false;
        }
        let mut begins = false;
        if holds {
            self.met += 1;
        } else {
            begins = self.fail((n, n), now, now);
        }
        if !self.live.is_empty() {
            self.seal(n);
        }
        begins
    }

    /// The same at the positions `from..=to`, the last with the stamp `last`, which fared as the one before them did.
    pub fn judge_rest(&mut self, holds: bool, (from, to): (Pos, Pos), last: i64) {
        if self.given_up().is_some() {
            return;
        }
        if holds {
            self.met += to - from + 1;
        } else {
            self.fail((from, to), last, last);
        }
    }

    /// Ends obligations whose formula was decided in this pass, at this time. Tells `begins` where those began whose failures begin an episode.
    pub fn decide(
        &mut self,
        tracker: &Tracker,
        decided: &[Vec<Decided>],
        at: i64,
        times: &Times,
        mut begins: impl FnMut(Pos),
    ) {
        let Judged::Future(formula) = tracker.formula else { return };
        let TrackerState { open, met, taken, .. } = self;
        for d in &decided[formula.id as usize] {
            if d.value != formula.negated {
                open.take(d.from, d.to, |a, b| *met += b - a + 1);
            } else {
                open.take(d.from, d.to, |a, b| taken.push((a, b)));
            }
        }
        for i in 0..self.taken.len() {
            let (from, to) = self.taken[i];
            if self.fail((from, to), times.at(from), at) {
                begins(from);
            }
        }
        self.taken.clear();
    }

    /// What would be missed if the trace were all: the nodes have decided that now.
    pub fn end(&mut self, tracker: &Tracker, decided: &[Vec<Decided>], times: &Times) {
        let Judged::Future(formula) = tracker.formula else { return };
        for d in decided[formula.id as usize].iter().filter(|d| d.value == formula.negated) {
            if let Some(k) = self.open.at_or_after(d.from).filter(|&k| k <= d.to) {
                let since = times.at(k);
                self.unmet_since = Some(self.unmet_since.map_or(since, |s| s.min(since)));
            }
        }
    }

    /// Obligations at `from..=to`, the first of which began at `began`, failed. Returns whether they begin an episode.
    fn fail(&mut self, (from, to): (Pos, Pos), began: i64, at: i64) -> bool {
        self.failed += to - from + 1;
        let mut new = Live {
            from,
            to,
            first: from,
            episode: Episode { failed: Time(at), began: Time(began), until: Time(at), count: to - from + 1 },
        };
        let mut continues = false;
        self.live.retain(|old| {
            let touches = old.to + 1 == new.from || new.to + 1 == old.from;
            if touches {
                new.absorb(old);
                continues = true;
            }
            !touches
        });
        self.live.push(new);
        !continues
    }

    /// Episodes that nothing open can join any more are over; `n` is the newest position.
    fn seal(&mut self, n: Pos) {
        let frontier = self.open.first().unwrap_or(n + 1);
        let done = &mut self.done;
        self.live.retain(|l| {
            let over = l.to + 1 < frontier;
            if over {
                done.push(l.episode);
            }
            !over
        });
    }

    /// Whether the obligation of the newest position, `n`, has failed.
    pub fn missed_at(&self, n: Pos) -> bool {
        self.live.iter().any(|live| live.to == n)
    }

    /// What is open is given up, and whatever fails from here on is another episode. What was counted stands.
    pub fn start_afresh(&mut self) {
        self.open.clear();
        self.seal_all();
        self.unmet_since = None;
    }

    /// Why nothing is judged any more. Failures that were counted stand.
    #[inline]
    pub fn given_up(&self) -> Option<GivenUp> {
        match (self.is_spoilt, self.is_overflowed) {
            (true, _) => Some(GivenUp::Spoilt),
            (false, true) => Some(GivenUp::Overflowed),
            (false, false) => None,
        }
    }

    /// What is open can no longer be judged, nor what comes.
    pub fn give_up(&mut self, why: GivenUp) {
        match why {
            GivenUp::Spoilt => self.is_spoilt = true,
            GivenUp::Overflowed => self.is_overflowed = true,
        }
        self.open.clear();
        self.seal_all();
    }

    /// All segments closed, or the trace ended: all episodes are over.
    pub fn seal_all(&mut self) {
        let done = &mut self.done;
        self.live.drain(..).for_each(|l| done.push(l.episode));
    }

    /// A segment of this tracker closed: the next one's failures are another episode.
    pub fn segment_closed(&mut self) {
        if self.open.is_empty() {
            self.seal_all();
        }
    }
}

impl Live {
    /// Joins a neighbouring episode: the one that failed first gives the beginning.
    fn absorb(&mut self, other: &Live) {
        if (other.episode.failed, other.first) < (self.episode.failed, self.first) {
            (self.first, self.episode.began, self.episode.failed) =
                (other.first, other.episode.began, other.episode.failed);
        }
        self.episode.until = self.episode.until.max(other.episode.until);
        self.episode.count += other.episode.count;
        (self.from, self.to) = (self.from.min(other.from), self.to.max(other.to));
    }
}

/// Whether an active position of a segment has an obligation.
#[inline]
pub(crate) fn is_obliged(tracker: &Tracker, segment: &Segment, now: i64) -> bool {
    match tracker.at {
        At::First => segment.first,
        At::All => true,
        At::Within(bound) => bound.contains(now.saturating_sub(segment.start_stamp)),
    }
}

/// Whether an obligation may still be added, time having come to `now`.
pub(crate) fn can_add(tracker: &Tracker, contexts: &[Context], segments: &[Segment], now: i64) -> bool {
    let (open, new) = prospects(tracker.context, contexts, segments);
    match tracker.at {
        At::First => new,
        At::All => new || open,
        At::Within(bound) => {
            let segment = &segments[tracker.context as usize];
            new || (open && (!bound.has_end() || bound.not_over(now.saturating_sub(segment.start_stamp))))
        }
    }
}

/// Whether a context has a segment open, and whether it can have a new one.
fn prospects(context: u32, contexts: &[Context], segments: &[Segment]) -> (bool, bool) {
    let segment = &segments[context as usize];
    let (open, new) = match contexts[context as usize].kind {
        ContextKind::Whole => return (true, !segment.open),
        _ => prospects(contexts[context as usize].parent, contexts, segments),
    };
    match contexts[context as usize].kind {
        ContextKind::Whole => (true, false),
        ContextKind::After { .. } => (segment.open, new || (open && !segment.spent)),
        ContextKind::Until { again, .. } => (segment.open, new || (open && again)),
        ContextKind::AfterUntil { .. } | ContextKind::While { .. } => (segment.open, open || new),
    }
}
