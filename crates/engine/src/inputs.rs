//! What the world looks like at an instant: the latest values, the events that occur, when topics last spoke, where machines stand.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use lapwing_stream::Value;

use crate::program::{Program, Read};

/// The latest of everything.
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    /// The signals' values; [`Value::Missing`] is undefined.
    pub(crate) slots: Vec<Value>,
    /// How often each signal got a value.
    pub(crate) versions: Vec<u64>,
    pub(crate) topics: Vec<TopicState>,
    pub(crate) events: Vec<EventState>,
    /// The state of each machine, `None` where it is undefined.
    pub(crate) machines: Vec<Option<usize>>,
}

/// What is known of a topic.
#[derive(Clone, Debug, Default)]
pub(crate) struct TopicState {
    /// The stamp of its last message.
    pub last: Option<i64>,
    /// Whether a message came at this instant (under a rate: since the instant before).
    pub fresh: bool,
    /// The stamps inside the longest window that is asked for.
    pub stamps: VecDeque<i64>,
}

/// The occurrences of an event at this instant; under a rate, since the instant before.
#[derive(Clone, Debug, Default)]
pub(crate) struct EventState {
    /// The fields of each occurrence; the first `count` are valid, the rest are buffers for later.
    pub occurrences: Vec<Vec<Value>>,
    pub count: usize,
}

impl EventState {
    /// The occurrences, in order.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &[Value]> {
        self.occurrences[..self.count].iter().map(Vec::as_slice)
    }

    /// Adds an occurrence, in the buffers of an earlier one.
    pub fn add<'a>(&mut self, fields: impl Iterator<Item = &'a Value>) {
        if self.count == self.occurrences.len() {
            self.occurrences.push(Vec::new());
        }
        let into = &mut self.occurrences[self.count];
        let mut n = 0;
        for value in fields {
            if n == into.len() {
                into.push(Value::Missing);
            }
            into[n].clone_from(value);
            n += 1;
        }
        into.truncate(n);
        self.count += 1;
    }
}

impl Inputs {
    /// Nothing has come yet: only defaults have values.
    pub(crate) fn new(program: &Program) -> Inputs {
        Inputs {
            slots: program.slots.iter().map(|s| s.default.clone().unwrap_or_default()).collect(),
            versions: alloc::vec![0; program.slots.len()],
            topics: alloc::vec![TopicState::default(); program.topics.len()],
            events: alloc::vec![EventState::default(); program.events.len()],
            machines: program.machines.iter().map(|m| Some(m.initial)).collect(),
        }
    }

    /// Stores a value; nothing is stored for a missing one.
    #[inline]
    pub(crate) fn set(&mut self, slot: usize, value: &Value) {
        if matches!(value, Value::Missing) {
            return;
        }
        if let (Some(to), Some(version)) = (self.slots.get_mut(slot), self.versions.get_mut(slot)) {
            to.clone_from(value);
            *version += 1;
        }
    }

    /// Whether a signal has a value, a topic a message.
    pub(crate) fn defined(&self, read: Read) -> bool {
        match read {
            Read::Slot(slot) => self.slots.get(slot).is_some_and(|v| !matches!(v, Value::Missing)),
            Read::Topic(topic) => self.topics.get(topic).is_some_and(|t| t.last.is_some()),
        }
    }

    /// The instant is over: its events are, too.
    pub(crate) fn end_instant(&mut self) {
        self.events.iter_mut().for_each(|e| e.count = 0);
        self.topics.iter_mut().for_each(|t| t.fresh = false);
    }

    /// The fields of an event's latest occurrence at this instant, where it occurs.
    pub fn event(&self, event: usize) -> Option<&[Value]> {
        self.events.get(event)?.iter().next_back()
    }

    /// The state in which a machine stands, `None` where it is undefined.
    pub fn state(&self, machine: usize) -> Option<usize> {
        self.machines.get(machine).copied().flatten()
    }

    /// The value of a signal, [`Value::Missing`] where it has none.
    pub fn value(&self, slot: usize) -> &Value {
        self.slots.get(slot).unwrap_or(&Value::Missing)
    }
}
