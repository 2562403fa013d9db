//! Puts what was seen in the order of header stamps, as far as a window reaches: by the same rule as a recording is read by.

use std::collections::BTreeMap;

use lapwing_record::{HeaderStamp, Options, TimeSource};
use lapwing_stream::{Duration, Time};

use super::course::{Seen, Sight};
use crate::status::Status;

/// What was seen and waits for what may have an earlier stamp.
pub(crate) struct Order {
    window: Duration,
    most: usize,
    /// Of each stream, where its messages have a header.
    stamps: BTreeMap<u32, Option<HeaderStamp>>,
    /// By stamp, then by arrival.
    held: BTreeMap<(Time, u64), Sight>,
    arrived: u64,
    /// The newest stamp since the last jump.
    newest: Option<Time>,
    /// What came after a jump back, while what came before it is let go.
    after_jump: Option<Sight>,
    /// The end of the run: it comes last.
    end: Option<Sight>,
}

impl Order {
    /// Where messages count by their headers.
    pub fn wanted(options: &Options) -> Option<Order> {
        (options.time == TimeSource::Header).then(|| Order {
            window: options.reorder,
            most: options.limits.held.max(1),
            stamps: BTreeMap::new(),
            held: BTreeMap::new(),
            arrived: 0,
            newest: None,
            after_jump: None,
            end: None,
        })
    }

    /// Takes in what was seen; whatever can go has been popped.
    pub fn push(&mut self, mut sight: Sight) {
        match &sight.what {
            Seen::Offered { stream, channel, .. } => {
                self.stamps.insert(*stream, channel.ty.as_ref().ok().and_then(HeaderStamp::new));
            }
            Seen::Message { stream, payload } => {
                let stamp = self.stamps.get_mut(stream).and_then(Option::as_mut);
                sight.at = stamp.and_then(|stamp| stamp.read(payload)).unwrap_or(sight.at);
            }
            Seen::Status(Status::Ended(_)) => {
                self.end = Some(sight);
                return;
            }
            Seen::Status(_) => {}
        }
        if self.newest.is_some_and(|newest| sight.at < newest - self.window) {
            self.after_jump = Some(sight);
            return;
        }
        self.hold(sight);
    }

    fn hold(&mut self, sight: Sight) {
        self.newest = Some(self.newest.map_or(sight.at, |newest| newest.max(sight.at)));
        self.arrived += 1;
        self.held.insert((sight.at, self.arrived), sight);
    }

    /// The next that may go.
    pub fn pop(&mut self) -> Option<Sight> {
        let (first, _) = *self.held.keys().next().unwrap_or(&(Time(i64::MAX), 0));
        let is_due = self.newest.is_some_and(|newest| first < newest - self.window) || self.held.len() >= self.most;
        if (is_due || self.after_jump.is_some())
            && let Some((_, sight)) = self.held.pop_first()
        {
            return Some(sight);
        }
        let sight = self.after_jump.take()?;
        self.newest = None;
        self.hold(sight);
        None
    }

    /// The next, when no more come. The end is not before anything else.
    pub fn drain(&mut self) -> Option<Sight> {
        if let Some((_, sight)) = self.held.pop_first() {
            self.newest = Some(self.newest.map_or(sight.at, |newest| newest.max(sight.at)));
            return Some(sight);
        }
        if let Some(sight) = self.after_jump.take() {
            self.newest = Some(sight.at);
            return Some(sight);
        }
        let end = self.end.take()?;
        Some(Sight { at: end.at.max(self.newest.unwrap_or(end.at)), ..end })
    }
}
