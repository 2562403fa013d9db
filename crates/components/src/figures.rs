//! How a run went, in numbers.

use std::collections::BTreeMap;

use lapwing_genom::model::{CodelId, TaskId};
use lapwing_stream::Duration;

/// How often, and how badly at worst.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Count {
    /// How often.
    pub times: u64,
    /// The worst.
    pub worst: Duration,
}

impl Count {
    fn add(&mut self, by: Duration) {
        self.times += 1;
        self.worst = self.worst.max(by);
    }
}

/// How a run went.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Figures {
    /// How many codels were called.
    pub calls: u64,
    /// How many edges of automata were taken.
    pub moves: u64,
    /// How often each task had a turn.
    pub turns: BTreeMap<(usize, TaskId), u64>,
    /// Turns that were left out.
    pub missed: BTreeMap<(usize, TaskId), u64>,
    /// Turns that began after their periods.
    pub late: BTreeMap<(usize, TaskId), Count>,
    /// Codels that took longer than they may, and how long.
    pub overruns: BTreeMap<(usize, CodelId), Count>,
    /// How long each codel took.
    pub took: BTreeMap<(usize, CodelId), Count>,
}

impl Figures {
    pub(crate) fn turn(&mut self, task: (usize, TaskId)) {
        *self.turns.entry(task).or_default() += 1;
    }

    pub(crate) fn miss(&mut self, task: (usize, TaskId)) {
        *self.missed.entry(task).or_default() += 1;
    }

    pub(crate) fn delay(&mut self, task: (usize, TaskId), by: Duration) {
        self.late.entry(task).or_default().add(by);
    }

    pub(crate) fn overrun(&mut self, codel: (usize, CodelId), took: Duration) {
        self.overruns.entry(codel).or_default().add(took);
    }

    pub(crate) fn return_of(&mut self, codel: (usize, CodelId), took: Duration) {
        self.calls += 1;
        self.took.entry(codel).or_default().add(took);
    }

    /// How many turns were left out, of all tasks.
    pub fn all_missed(&self) -> u64 {
        self.missed.values().sum()
    }
}
