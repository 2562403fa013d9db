//! Puts messages in the order of their header stamps, as far as a window of time reaches.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use lapwing_stream::{Duration, Name, Time, Value};

/// A message, row or event that is held back.
#[derive(Debug, Default)]
pub(crate) struct Held {
    pub time: Time,
    pub kind: Kind,
    /// Of a message its fields, of a row or an event its cells.
    pub values: Vec<Value>,
    /// Those of the cells.
    pub names: Vec<Name>,
}

/// What is held back.
#[derive(Clone, Debug, Default)]
pub(crate) enum Kind {
    /// A message of that topic; `wanted` is which of the wanted topics it is.
    Message {
        topic: Arc<str>,
        wanted: Option<usize>,
    },
    #[default]
    Row,
    Event(String),
}

/// The messages held back, and those that may go.
#[derive(Debug)]
pub(crate) struct Reorder {
    window: Duration,
    limit: usize,
    /// The newest stamp since the last jump.
    newest: Option<Time>,
    /// By stamp, then by arrival; the last is where it lies in `store`.
    heap: BinaryHeap<Reverse<(Time, u64, usize)>>,
    store: Vec<Held>,
    free: Vec<usize>,
    arrived: u64,
    /// Everything goes, whatever its stamp: time jumped, or the recording ended.
    flushing: bool,
    /// What came after the jump, waiting until all before it is gone.
    after_jump: Option<usize>,
}

impl Reorder {
    pub fn new(window: Duration, limit: usize) -> Reorder {
        Reorder {
            window,
            limit: limit.max(1),
            newest: None,
            heap: BinaryHeap::new(),
            store: Vec::new(),
            free: Vec::new(),
            arrived: 0,
            flushing: false,
            after_jump: None,
        }
    }

    /// A place for one that arrives: an empty one, whose buffers may be reused.
    pub fn room(&mut self) -> (usize, &mut Held) {
        let at = self.free.pop().unwrap_or_else(|| {
            self.store.push(Held::default());
            self.store.len() - 1
        });
        (at, &mut self.store[at])
    }

    /// Takes in what was put into a place.
    pub fn push(&mut self, at: usize) {
        let time = self.store[at].time;
        if self.newest.is_some_and(|newest| time < newest - self.window) {
            self.flushing = true;
            self.after_jump = Some(at);
            return;
        }
        self.newest = Some(self.newest.map_or(time, |newest| newest.max(time)));
        self.arrived += 1;
        self.heap.push(Reverse((time, self.arrived, at)));
    }

    /// No more arrive.
    pub fn finish(&mut self) {
        self.flushing = true;
    }

    /// Whether some may go without another one arriving.
    pub fn is_waiting(&self) -> bool {
        self.flushing && !(self.heap.is_empty() && self.after_jump.is_none())
    }

    /// The next that may go, and whether it goes only because no more can be held.
    pub fn pop(&mut self) -> Option<(usize, bool)> {
        let full = self.heap.len() >= self.limit;
        let first = self.heap.peek().map(|Reverse((time, _, _))| *time);
        let due = first.is_some_and(|time| self.newest.is_some_and(|newest| time < newest - self.window));
        if due || full || self.flushing {
            if let Some(Reverse((_, _, at))) = self.heap.pop() {
                return Some((at, full && !due && !self.flushing));
            }
            if let Some(at) = self.after_jump.take() {
                self.flushing = false;
                self.newest = None;
                self.push(at);
            }
        }
        None
    }

    /// One that went.
    pub fn get(&self, at: usize) -> &Held {
        &self.store[at]
    }

    /// Its place may be used again.
    pub fn release(&mut self, at: usize) {
        self.free.push(at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(window: i64, limit: usize, times: &[i64]) -> Vec<i64> {
        let mut reorder = Reorder::new(Duration::from_nanos(window), limit);
        let mut out = Vec::new();
        let mut drain = |reorder: &mut Reorder| {
            while let Some((at, _)) = reorder.pop() {
                out.push(reorder.get(at).time.0);
                reorder.release(at);
            }
        };
        for time in times {
            let (at, held) = reorder.room();
            held.time = Time(*time);
            reorder.push(at);
            drain(&mut reorder);
        }
        reorder.finish();
        drain(&mut reorder);
        out
    }

    #[test]
    fn within_the_window_all_is_sorted() {
        assert_eq!(sorted(10, 100, &[5, 3, 8, 1, 20, 12, 30]), [1, 3, 5, 8, 12, 20, 30]);
        assert_eq!(sorted(10, 100, &[10, 0, 5]), [0, 5, 10]);
    }

    #[test]
    fn a_larger_step_back_is_a_jump() {
        assert_eq!(sorted(10, 100, &[100, 95, 20, 25, 22, 200]), [95, 100, 20, 22, 25, 200]);
        assert_eq!(sorted(0, 100, &[3, 2, 1]), [3, 2, 1]);
    }

    #[test]
    fn no_more_is_held_than_the_limit() {
        assert_eq!(sorted(1000, 3, &[5, 4, 3, 2, 1]), [3, 2, 1, 4, 5]);
    }
}
