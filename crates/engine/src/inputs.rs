//! What the world looks like at an instant: the latest values, the events that occur, when topics last spoke, where machines stand.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use lapwing_stream::{Time, Value};
use serde::{Deserialize, Serialize};

use crate::program::{Column, Program, Read, Slot, Wake};
use crate::skim::Row;

/// The latest of everything.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Inputs {
    /// The signals' values; [`Value::Missing`] is undefined.
    pub(crate) slots: Vec<Value>,
    /// How often each signal got a value; empty where nothing asks for it.
    pub(crate) versions: Vec<u64>,
    /// Per group, what signals that changed since the group stepped last made due.
    pub(crate) due: Vec<Due>,
    /// Whether there may be any.
    pub(crate) woken: bool,
    /// For each signal the numbers among which it may change without anything turning on it. Empty where that is not known.
    #[serde(skip)]
    bands: Vec<Band>,
    /// The latest row, where all that fills signals is rows of truth values.
    #[serde(skip)]
    pub(crate) row: Row,
    /// Whether this instant has events or messages, which end with it.
    stirred: bool,
    pub(crate) topics: Vec<TopicState>,
    pub(crate) events: Vec<EventState>,
    /// The state of each machine, `None` where it is undefined.
    pub(crate) machines: Vec<Option<usize>>,
    /// Whether a machine met a value of another kind than it needs, so that nobody knows where it stands.
    pub(crate) lost: Vec<bool>,
}

/// Numbers from one on to another, which is not among them.
#[derive(Clone, Copy, Debug)]
struct Band {
    from: f64,
    to: f64,
}

impl Band {
    #[inline]
    fn holds(&self, x: f64) -> bool {
        self.from <= x && x < self.to
    }
}

impl Default for Band {
    /// No numbers.
    fn default() -> Band {
        Band { from: f64::INFINITY, to: f64::NEG_INFINITY }
    }
}

/// What changed signals made due in a group.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Due {
    /// The operators that read them, as bits.
    pub ops: u64,
    /// The letter that they make for the group's automaton, with [`Wake::NO_LETTER`] where they make none.
    pub letter: u32,
}

impl Due {
    /// What both of them make due.
    #[inline(always)]
    pub fn and(self, other: Due) -> Due {
        // What toggled twice is where it was; what has no letter stays so.
        let letter = (self.letter ^ other.letter) | ((self.letter | other.letter) & Wake::NO_LETTER);
        Due { ops: self.ops | other.ops, letter }
    }
}

/// What is known of a topic.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct TopicState {
    /// The stamp of its last message.
    pub last: Option<i64>,
    /// Whether a message came at this instant (under a rate: since the instant before).
    pub fresh: bool,
    /// The stamps inside the longest window that is asked for.
    pub stamps: VecDeque<i64>,
}

/// The occurrences of an event at this instant; under a rate, since the instant before.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct EventState {
    /// The fields of each occurrence; the first `count` are valid, the rest are buffers for later.
    pub occurrences: Vec<Vec<Value>>,
    pub count: usize,
    /// Whether a value in its condition was of another kind than was needed, so that nobody knows whether it occurs.
    pub is_unclear: bool,
}

impl EventState {
    /// The occurrences, in order.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &[Value]> {
        self.occurrences[..self.count].iter().map(Vec::as_slice)
    }

    /// Adds an occurrence, in the buffers of an earlier one.
    fn add<'a>(&mut self, fields: impl Iterator<Item = &'a Value>) {
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
            versions: alloc::vec![0; if program.counts_values() { program.slots.len() } else { 0 }],
            due: alloc::vec![Due::default(); program.groups.len()],
            woken: false,
            bands: alloc::vec![Band::default(); program.slots.len()],
            row: Row::NONE,
            stirred: false,
            topics: alloc::vec![TopicState::default(); program.topics.len()],
            events: alloc::vec![EventState::default(); program.events.len()],
            machines: program.machines.iter().map(|m| Some(m.initial)).collect(),
            lost: alloc::vec![false; program.machines.len()],
        }
    }

    /// Stores a value; nothing is stored for a missing one.
    #[inline]
    pub(crate) fn set(&mut self, program: &Program, slot: usize, value: &Value) {
        let (Some(to), Some(plan)) = (self.slots.get_mut(slot), program.slots.get(slot)) else { return };
        if !is_latest(to, value) {
            self.row = Row::NONE;
            self.change(plan, slot, value);
        }
        if let Some(version) = self.versions.get_mut(slot)
            && !matches!(value, Value::Missing)
        {
            *version += 1;
        }
    }

    /// Stores a number.
    #[inline]
    pub(crate) fn set_number(&mut self, program: &Program, slot: usize, x: f64) {
        match (self.slots.get_mut(slot), program.slots.get(slot)) {
            (Some(Value::Num(to)), Some(plan)) => {
                let was = core::mem::replace(to, x);
                if was.to_bits() != x.to_bits() {
                    self.row = Row::NONE;
                    self.change_number(plan, slot, was, x);
                }
                self.versions.get_mut(slot).into_iter().for_each(|version| *version += 1);
            }
            _ => self.set(program, slot, &Value::Num(x)),
        }
    }

    /// Stores the cells of a row.
    #[inline]
    pub(crate) fn set_row(&mut self, program: &Program, cells: &[Value]) {
        for column in &program.columns {
            if let (Some(to), Some(value)) = (self.slots.get(column.slot), cells.get(column.cell))
                && !is_latest(to, value)
                && let Some(plan) = program.slots.get(column.slot)
            {
                self.change(plan, column.slot, value);
            }
        }
        if !self.versions.is_empty() {
            self.count_row(&program.columns, cells);
        }
    }

    /// Stores another value, and makes due what turns on it.
    #[inline(always)]
    fn change(&mut self, plan: &Slot, slot: usize, value: &Value) {
        let to = &mut self.slots[slot];
        match (&mut *to, value) {
            (Value::Num(to), Value::Num(from)) => {
                let was = core::mem::replace(to, *from);
                self.change_number(plan, slot, was, *from);
            }
            _ => {
                self.woken = true;
                // The band was that of the number before.
                if let (Some(band), Value::Num(_)) = (self.bands.get_mut(slot), value) {
                    *band = Band::default();
                }
                let letters = replace(to, value);
                wake(&mut self.due, &plan.wakes, letters);
            }
        }
    }

    /// A number has become another: makes due what turns on it.
    #[inline(always)]
    fn change_number(&mut self, plan: &Slot, slot: usize, was: f64, is: f64) {
        if self.bands.get(slot).is_some_and(|band| band.holds(is)) {
            return;
        }
        if plan.cuts.is_empty() && !was.is_nan() && !is.is_nan() {
            self.woken |= !plan.every.is_empty();
            wake(&mut self.due, &plan.every, 0);
        } else {
            self.cross(plan, slot, was, is);
        }
    }

    /// A number became another, and left the band in which nothing turns on it.
    #[inline(never)]
    fn cross(&mut self, plan: &Slot, slot: usize, was: f64, is: f64) {
        let Slot { cuts, every, wakes, .. } = plan;
        let mut band = Band::default();
        if was.is_nan() || is.is_nan() {
            self.woken = true;
            wake(&mut self.due, wakes, Wake::NO_LETTER);
        } else {
            let below = |x: f64| cuts.partition_point(|cut| cut.at <= x);
            let (from, to) = (below(was), below(is));
            let crossed = &cuts[from.min(to)..from.max(to)];
            self.woken |= !(crossed.is_empty() && every.is_empty());
            crossed.iter().for_each(|cut| wake(&mut self.due, core::slice::from_ref(&cut.wake), 0));
            wake(&mut self.due, every, 0);
            if every.is_empty() {
                band.from = to.checked_sub(1).map_or(f64::NEG_INFINITY, |last| cuts[last].at);
                band.to = cuts.get(to).map_or(f64::INFINITY, |next| next.at);
            }
        }
        if self.bands.len() <= slot {
            self.bands.resize(self.slots.len(), Band::default());
        }
        self.bands[slot] = band;
    }

    fn count_row(&mut self, columns: &[Column], cells: &[Value]) {
        let is_there = |column: &&Column| cells.get(column.cell).is_some_and(|v| !matches!(v, Value::Missing));
        for column in columns.iter().filter(is_there) {
            if let Some(version) = self.versions.get_mut(column.slot) {
                *version += 1;
            }
        }
    }

    /// Whether a signal has a value, a topic a message.
    pub(crate) fn defined(&self, read: Read) -> bool {
        match read {
            Read::Slot(slot) => self.slots.get(slot).is_some_and(|v| !matches!(v, Value::Missing)),
            Read::Topic(topic) => self.topics.get(topic).is_some_and(|t| t.last.is_some()),
        }
    }

    /// A message came: at the end of the instant there is something to end.
    pub(crate) fn stir(&mut self, wakes: &[Wake]) {
        self.stirred = true;
        self.woken |= !wakes.is_empty();
        wake(&mut self.due, wakes, 0);
    }

    /// An event occurred.
    pub(crate) fn occur<'a>(&mut self, event: usize, fields: impl Iterator<Item = &'a Value>) {
        if let Some(state) = self.events.get_mut(event) {
            state.add(fields);
            self.stirred = true;
        }
    }

    /// The only group takes in what changed: gives what that made due.
    #[inline]
    pub(crate) fn settle(&mut self) -> Due {
        self.woken = false;
        self.due.first_mut().map(core::mem::take).unwrap_or_default()
    }

    /// The instant is over: its events are, too.
    #[inline]
    pub(crate) fn end_instant(&mut self) {
        if self.stirred {
            self.stirred = false;
            self.events.iter_mut().for_each(|e| (e.count, e.is_unclear) = (0, false));
            self.topics.iter_mut().for_each(|t| t.fresh = false);
        }
    }

    /// Whether nobody knows if an event occurs at this instant.
    pub(crate) fn is_unclear(&self, event: usize) -> bool {
        self.events.get(event).is_some_and(|e| e.is_unclear)
    }

    /// The fields of an event's latest occurrence at this instant, where it occurs.
    pub fn event(&self, event: usize) -> Option<&[Value]> {
        self.events.get(event)?.iter().next_back()
    }

    /// The state in which a machine stands, `None` where it is undefined.
    pub fn state(&self, machine: usize) -> Option<usize> {
        self.machines.get(machine).copied().flatten()
    }

    /// The stamp of a topic's last message.
    #[inline]
    pub fn last(&self, topic: usize) -> Option<Time> {
        self.topics.get(topic)?.last.map(Time)
    }

    /// Whether a message of a topic came at this instant; under a rate, since the instant before.
    #[inline]
    pub fn is_fresh(&self, topic: usize) -> bool {
        self.topics.get(topic).is_some_and(|t| t.fresh)
    }

    /// How many messages of a topic came after that time, as far back as the longest window that is asked for.
    pub fn messages_after(&self, topic: usize, time: Time) -> usize {
        let stamps = self.topics.get(topic).map(|t| &t.stamps);
        stamps.map_or(0, |stamps| stamps.len() - stamps.partition_point(|&t| t <= time.0))
    }

    /// The value of a signal, [`Value::Missing`] where it has none.
    pub fn value(&self, slot: usize) -> &Value {
        self.slots.get(slot).unwrap_or(&Value::Missing)
    }
}

/// Stores another value. Gives zero where a truth value toggled, and [`Wake::NO_LETTER`] else.
#[inline]
fn replace(to: &mut Value, value: &Value) -> u32 {
    match (&mut *to, value) {
        (Value::Bool(to), Value::Bool(from)) => {
            *to = *from;
            0
        }
        (to, from) => {
            to.clone_from(from);
            Wake::NO_LETTER
        }
    }
}

/// Makes due what reads a signal that changed.
#[inline]
fn wake(due: &mut [Due], wakes: &[Wake], letters: u32) {
    for wake in wakes {
        let due = &mut due[wake.group];
        *due = due.and(Due { ops: wake.ops, letter: wake.letter | letters });
    }
}

/// Whether a value is what is there already, or missing. Anything but a scalar is taken for something else.
// PERF: scalars of the same kind first, for they are nearly all there is.
#[inline]
fn is_latest(there: &Value, value: &Value) -> bool {
    match (there, value) {
        (Value::Bool(there), Value::Bool(value)) => there == value,
        (Value::Num(there), Value::Num(value)) => there.to_bits() == value.to_bits(),
        (_, value) => matches!(value, Value::Missing),
    }
}
