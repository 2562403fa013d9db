//! The bounded queue between the threads that receive and the one that judges.
//!
//! What comes in is stamped here, under the queue's lock, so that the order of stamps is the order in the queue, whatever thread it comes from. The clock is
//! the wall clock at the start and goes on monotonically from there: a wall clock that is set while a run lasts does not move it.
//!
//! Messages are bounded by bytes; where there is no room the newest is dropped, counted, and told as [`Happening::Lost`] as soon as
//! there is room again. Nothing else is ever dropped: there is little of it.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use lapwing_stream::Time;

use crate::connector::{Arrival, Happening, StreamId};

/// What a queue holds by itself: 256 MB.
pub const ROOM: usize = 256 << 20;

/// What an arrival takes beside its payload.
const OVERHEAD: usize = 96;

/// The two ends of a queue share it.
#[derive(Clone, Debug)]
pub struct Inbox {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    queue: Mutex<Queue>,
    filled: Condvar,
    clock: Clock,
    room: usize,
}

#[derive(Debug, Default)]
struct Queue {
    arrivals: VecDeque<Arrival>,
    bytes: usize,
    /// What was dropped and not told yet.
    lost: BTreeMap<StreamId, u64>,
}

impl Default for Inbox {
    fn default() -> Inbox {
        Inbox::new(ROOM)
    }
}

impl Inbox {
    /// A queue for so many bytes of messages.
    pub fn new(room: usize) -> Inbox {
        Inbox {
            shared: Arc::new(Shared { queue: Mutex::default(), filled: Condvar::new(), clock: Clock::new(), room }),
        }
    }

    /// Puts something in; it is stamped with the time of this call.
    pub fn push(&self, what: Happening) {
        let mut queue = self.lock();
        let at = self.shared.clock.now();
        queue.tell_losses(at, self.shared.room);
        queue.push(Arrival { at, what }, self.shared.room);
        drop(queue);
        self.shared.filled.notify_one();
    }

    /// Takes the next thing out, waiting for it no longer than that.
    pub fn pop(&self, patience: Duration) -> Option<Arrival> {
        let queue = self.lock();
        let is_idle = |queue: &mut Queue| queue.arrivals.is_empty() && queue.lost.is_empty();
        let waited = self.shared.filled.wait_timeout_while(queue, patience, is_idle);
        let (mut queue, _) = waited.unwrap_or_else(PoisonError::into_inner);
        if queue.arrivals.is_empty() {
            let at = self.shared.clock.now();
            queue.tell_losses(at, self.shared.room);
        }
        queue.pop()
    }

    /// The time on this queue's clock.
    pub fn now(&self) -> Time {
        self.shared.clock.now()
    }

    /// No later than the stamp of anything that will still come out: that of the first thing in the queue, or the time where it is empty.
    pub fn horizon(&self) -> Time {
        let queue = self.lock();
        // Read under the lock: what is pushed next is stamped after this.
        queue.arrivals.front().map_or_else(|| self.shared.clock.now(), |first| first.at)
    }

    /// A thread that panicked while it held the lock left the queue whole: every change of it is one push or one pop.
    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.shared.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Queue {
    fn push(&mut self, arrival: Arrival, room: usize) {
        let size = size(&arrival.what);
        match arrival.what {
            Happening::Message { stream, .. } if self.bytes.saturating_add(size) > room => {
                *self.lost.entry(stream).or_default() += 1;
            }
            _ => {
                self.bytes += size;
                self.arrivals.push_back(arrival);
            }
        }
    }

    /// Once half of the room is free again, what was dropped is told before anything that comes later: sooner, a flood would be told
    /// message by message.
    fn tell_losses(&mut self, at: Time, room: usize) {
        if self.lost.is_empty() || self.bytes > room / 2 {
            return;
        }
        for (stream, count) in std::mem::take(&mut self.lost) {
            self.push(Arrival { at, what: Happening::Lost { stream, count } }, room);
        }
    }

    fn pop(&mut self) -> Option<Arrival> {
        let arrival = self.arrivals.pop_front()?;
        self.bytes -= size(&arrival.what);
        Some(arrival)
    }
}

fn size(what: &Happening) -> usize {
    match what {
        Happening::Message { payload, .. } => payload.len() + OVERHEAD,
        _ => OVERHEAD,
    }
}

/// A clock that is right at its start and then never jumps.
#[derive(Clone, Copy, Debug)]
struct Clock {
    start: Instant,
    wall: i64,
}

impl Clock {
    fn new() -> Clock {
        let wall = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Clock { start: Instant::now(), wall: i64::try_from(wall.as_nanos()).unwrap_or(i64::MAX) }
    }

    fn now(&self) -> Time {
        let since = i64::try_from(self.start.elapsed().as_nanos()).unwrap_or(i64::MAX);
        Time(self.wall.saturating_add(since))
    }
}

#[cfg(test)]
mod tests {
    use bytes::Bytes;

    use super::*;

    const SOON: Duration = Duration::from_secs(5);

    fn message(stream: u32, bytes: usize) -> Happening {
        Happening::Message { stream: StreamId(stream), payload: Bytes::from(vec![0; bytes]) }
    }

    #[test]
    fn what_comes_out_is_in_the_order_of_its_stamps() {
        let inbox = Inbox::default();
        let threads: Vec<_> = (0..4)
            .map(|stream| {
                let inbox = inbox.clone();
                std::thread::spawn(move || (0..500).for_each(|_| inbox.push(message(stream, 8))))
            })
            .collect();
        let mut last = Time(0);
        for _ in 0..2000 {
            let arrival = inbox.pop(SOON).expect("2000 messages were pushed");
            assert!(last <= arrival.at);
            last = arrival.at;
        }
        threads.into_iter().for_each(|t| t.join().expect("pushing does not panic"));
        assert!(inbox.pop(Duration::ZERO).is_none());
    }

    #[test]
    fn what_does_not_fit_is_counted_and_told_before_what_comes_later() {
        let inbox = Inbox::new(1000);
        (0..5).for_each(|_| inbox.push(message(1, 300)));
        inbox.push(Happening::Note("still here".to_owned()));
        let mut seen = Vec::new();
        while let Some(arrival) = inbox.pop(Duration::ZERO) {
            seen.push(arrival.what);
        }
        let messages = seen.iter().filter(|w| matches!(w, Happening::Message { .. })).count();
        assert_eq!(messages, 2);
        assert!(seen.iter().any(|w| matches!(w, Happening::Lost { stream: StreamId(1), count: 3 })), "{seen:?}");
        assert!(seen.iter().any(|w| matches!(w, Happening::Note(_))));
    }
}
