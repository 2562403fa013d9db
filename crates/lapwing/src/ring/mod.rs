//! What the latest instants looked like: of each instant only what it changed.

mod rows;

use std::collections::VecDeque;

use lapwing_stream::{Sample, Time, Value, What};

use self::rows::{Strip, Table, bytes, fill};
use crate::moment::{Kept, Moment};

/// How many instants are kept at least, and at most.
const INSTANTS: std::ops::Range<usize> = 1024..65_536;

/// The ring does not grow beyond this, in bytes.
const BYTES: usize = 4 << 20;

/// What a signal may get a value from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// Messages of that topic.
    Topic(usize),
    /// Rows.
    Rows,
    /// Whatever comes.
    Any,
}

/// What the latest instants looked like, as far as someone wants to know. Once it is full it allocates no more.
#[derive(Debug)]
pub(crate) struct Ring {
    kept: Kept,
    /// How far back it reaches where it may, in nanoseconds.
    reach: i64,
    capacity: usize,
    /// Whether there is no memory for more.
    is_full: bool,
    times: VecDeque<Time>,
    /// The number of the oldest instant that is kept; they count from 0.
    oldest: u64,
    /// The signals, those that come together side by side.
    groups: Vec<Group>,
    /// The groups for which something has come since their latest row.
    due: Vec<usize>,
    /// The group of what may change whenever something comes.
    any: Option<usize>,
    /// The group that rows fill.
    rows: Option<usize>,
    /// For each topic the group that its messages fill.
    messages: Vec<Option<usize>>,
    /// For each kept signal its group, and its place there.
    places: Vec<(usize, usize)>,
    /// For each kept event, the fields of its occurrences.
    events: Vec<Strip<Vec<Value>>>,
    /// For each kept machine, the states that it went to.
    machines: Vec<Strip<Option<usize>>>,
    /// For each kept topic, the stamps of its messages.
    topics: Vec<Strip<Time>>,
    /// When what the engine takes in came, and the group that it is for.
    arrival: Option<(Time, usize)>,
}

/// Signals that get their values together, from the same source.
#[derive(Debug)]
struct Group {
    source: Source,
    /// Whether it is one of those for which something has come.
    is_due: bool,
    table: Table,
}

/// An instant of a [`Ring`].
#[derive(Clone, Copy)]
pub(crate) struct Instant<'r> {
    ring: &'r Ring,
    number: u64,
}

impl Ring {
    /// Keeps what `kept` names; of so many nanoseconds, where the instants are few enough for that. `source` says where each signal comes from.
    pub fn new(kept: Kept, reach: i64, source: impl Fn(usize) -> Source) -> Ring {
        let mut groups: Vec<Group> = Vec::new();
        let mut places = Vec::new();
        for &input in &kept.inputs {
            let source = source(input);
            let known = groups.iter().position(|g| g.source == source);
            let group = known.unwrap_or_else(|| {
                groups.push(Group { source, is_due: false, table: Table::new() });
                groups.len() - 1
            });
            places.push((group, groups[group].table.add(input)));
        }
        let filled = |source: Source| groups.iter().position(|group| group.source == source);
        let topics =
            groups.iter().filter_map(|g| if let Source::Topic(topic) = g.source { Some(topic + 1) } else { None });
        let messages = (0..topics.max().unwrap_or_default()).map(|topic| filled(Source::Topic(topic)));
        let mut ring = Ring {
            reach,
            capacity: INSTANTS.start,
            is_full: false,
            times: VecDeque::new(),
            oldest: 0,
            any: filled(Source::Any),
            rows: filled(Source::Rows),
            messages: messages.collect(),
            due: Vec::with_capacity(groups.len()),
            groups,
            places,
            events: kept.events.iter().map(|_| Strip::new()).collect(),
            machines: kept.machines.iter().map(|_| Strip::new()).collect(),
            topics: kept.topics.iter().map(|_| Strip::new()).collect(),
            kept,
            arrival: None,
        };
        ring.make_all_due();
        ring
    }

    /// The next instant is the first: it has everything.
    fn make_all_due(&mut self) {
        (0..self.groups.len()).for_each(|group| self.make_due(group));
    }

    fn make_due(&mut self, group: usize) {
        if let Some(Group { is_due, .. }) = self.groups.get_mut(group)
            && !std::mem::replace(is_due, true)
        {
            self.due.push(group);
        }
    }

    /// The engine takes a sample in. The instants before its stamp come before it.
    #[inline]
    pub fn arrive(&mut self, sample: &Sample<'_>) {
        self.settle(None);
        let group = match sample.what {
            What::Message { topic, .. } => self.messages.get(topic).copied().flatten(),
            What::Row { .. } => self.rows,
            What::Event { .. } | What::Other => return,
        };
        self.arrival = group.map(|group| (sample.time, group));
    }

    /// What arrived by then, or at all, has changed its signals.
    #[inline]
    pub fn settle(&mut self, by: Option<Time>) {
        if let Some((_, group)) = self.arrival.take_if(|(time, _)| by.is_none_or(|by| *time <= by)) {
            self.make_due(group);
        }
    }

    /// An instant is over.
    pub fn push(&mut self, time: Time, from: &impl Moment) {
        self.settle(Some(time));
        if self.times.len() == self.capacity {
            match self.should_grow(time) {
                true => self.capacity *= 2,
                false => {
                    self.times.pop_front();
                    self.oldest += 1;
                }
            }
        }
        let number = self.oldest + self.times.len() as u64;
        self.times.push_back(time);
        self.store(number, from);
    }

    fn store(&mut self, number: u64, from: &impl Moment) {
        let oldest = self.oldest;
        self.any.into_iter().for_each(|any| self.make_due(any));
        for group in self.due.drain(..) {
            let Group { is_due, table, .. } = &mut self.groups[group];
            *is_due = false;
            table.push(number, oldest, |input| from.value(input));
        }
        for (&event, rows) in self.kept.events.iter().zip(&mut self.events) {
            if let Some(fields) = from.event(event) {
                rows.push(number, oldest, |row| fill(row, fields.iter()));
            }
        }
        for (&machine, states) in self.kept.machines.iter().zip(&mut self.machines) {
            let state = from.state(machine);
            if states.last() != Some(&state) {
                states.push(number, oldest, |row| *row = state);
            }
        }
        for (&topic, stamps) in self.kept.topics.iter().zip(&mut self.topics) {
            if let (true, Some(last)) = (from.is_fresh(topic), from.last(topic)) {
                stamps.push(number, oldest, |row| *row = last);
            }
        }
    }

    /// Whether what would make room is still within reach, and there is memory for more.
    #[inline]
    fn should_grow(&mut self, now: Time) -> bool {
        let is_near = self.times.front().is_some_and(|oldest| now.since(*oldest).nanos() <= self.reach);
        is_near && self.has_room()
    }

    /// Whether there is memory for twice as much.
    #[inline(never)]
    fn has_room(&mut self) -> bool {
        self.is_full = self.is_full || self.capacity * 2 > INSTANTS.end || self.bytes() * 2 > BYTES;
        !self.is_full
    }

    fn bytes(&self) -> usize {
        let signals: usize = self.groups.iter().map(|group| group.table.bytes()).sum();
        let events: usize = self.events.iter().map(|e| e.bytes(|row| row.iter().map(bytes).sum())).sum();
        let stamps: usize = self.topics.iter().map(|topic| topic.bytes(|_| 0)).sum();
        let states: usize = self.machines.iter().map(|machine| machine.bytes(|_| 0)).sum();
        self.times.len() * size_of::<Time>() + signals + events + stamps + states
    }

    /// Time jumped: what was before is no history of what comes.
    pub fn clear(&mut self) {
        self.times.clear();
        self.oldest = 0;
        self.groups.iter_mut().for_each(|group| group.table.clear());
        self.make_all_due();
        self.events.iter_mut().for_each(Strip::clear);
        self.machines.iter_mut().for_each(Strip::clear);
        self.topics.iter_mut().for_each(Strip::clear);
    }

    /// Whether the oldest is the first that there was.
    pub fn is_whole(&self) -> bool {
        self.oldest == 0
    }

    /// The instants, from the oldest to the latest.
    pub fn instants(&self) -> impl DoubleEndedIterator<Item = Instant<'_>> {
        (self.oldest..self.oldest + self.times.len() as u64).map(|number| Instant { ring: self, number })
    }

    /// The instants at or before that time, from the last back.
    pub fn back_from(&self, time: Time) -> impl Iterator<Item = Instant<'_>> {
        let count = self.times.partition_point(|t| *t <= time) as u64;
        (self.oldest..self.oldest + count).rev().map(|number| Instant { ring: self, number })
    }
}

impl Instant<'_> {
    /// When it was.
    pub fn time(&self) -> Time {
        self.ring.times.get(self.number()).copied().unwrap_or_default()
    }

    /// Its number, 0 the oldest.
    pub fn number(&self) -> usize {
        (self.number - self.ring.oldest) as usize
    }
}

impl Moment for Instant<'_> {
    fn value(&self, input: usize) -> &Value {
        let Ring { kept, places, groups, .. } = self.ring;
        let found = kept.inputs.binary_search(&input).ok().and_then(|kept| {
            let (group, place) = *places.get(kept)?;
            groups.get(group)?.table.at(self.number, place)
        });
        found.unwrap_or(&Value::Missing)
    }

    fn event(&self, event: usize) -> Option<&[Value]> {
        let place = self.ring.kept.events.binary_search(&event).ok()?;
        let (number, fields) = self.ring.events.get(place)?.at(self.number)?;
        (*number == self.number).then_some(fields)
    }

    fn state(&self, machine: usize) -> Option<usize> {
        let place = self.ring.kept.machines.binary_search(&machine).ok()?;
        self.ring.machines.get(place)?.at(self.number)?.1
    }

    fn last(&self, topic: usize) -> Option<Time> {
        let place = self.ring.kept.topics.binary_search(&topic).ok()?;
        self.ring.topics.get(place)?.at(self.number).map(|(_, stamp)| *stamp)
    }

    fn is_fresh(&self, topic: usize) -> bool {
        let place = self.ring.kept.topics.binary_search(&topic).ok();
        let latest = place.and_then(|place| self.ring.topics.get(place)?.at(self.number));
        latest.is_some_and(|(number, _)| *number == self.number)
    }
}

#[cfg(test)]
mod tests {
    use super::rows::LONGEST;
    use super::*;
    use crate::moment::Fixed;

    fn moment(k: i64) -> Fixed {
        let values = vec![Value::Num(k as f64), Value::Num(-1.0), Value::Bool(k % 2 == 0)];
        let kick = (k % 3 == 0).then(|| vec![Value::Num(k as f64)]);
        let topics = vec![(Some(Time(k - k % 4)), k % 4 == 0)];
        Fixed { values, events: vec![kick], states: vec![(k % 5 != 0).then_some(1)], topics }
    }

    fn kept() -> Kept {
        Kept { inputs: vec![0, 2], events: vec![0], machines: vec![0], topics: vec![0] }
    }

    /// Signal 0 comes with rows, and signal 2 whenever something does.
    fn source(input: usize) -> Source {
        if input == 0 { Source::Rows } else { Source::Any }
    }

    /// A row came, and the instant after it is over.
    fn row(ring: &mut Ring, k: i64) {
        ring.arrive(&Sample { time: Time(k), what: What::Row { cells: &[] } });
        ring.push(Time(k), &moment(k));
    }

    #[test]
    fn what_nothing_came_for_stays_as_it_was() {
        let mut ring = Ring::new(kept(), 0, source);
        row(&mut ring, 1);
        for k in 2..1500 {
            ring.arrive(&Sample { time: Time(k), what: What::Other });
            ring.push(Time(k), &moment(k));
        }
        // The sample is later than the instant that it makes the engine step through, and has changed nothing then.
        ring.arrive(&Sample { time: Time(1600), what: What::Row { cells: &[] } });
        ring.push(Time(1550), &moment(1550));
        ring.push(Time(1600), &moment(1600));
        let of = |time| ring.back_from(Time(time)).next().map(|instant| instant.value(0).clone());
        assert_eq!([of(1), of(1550), of(1600)], [None, Some(Value::Num(1.0)), Some(Value::Num(1600.0))]);
    }

    #[test]
    fn the_latest_instants_are_kept_in_order() {
        let mut ring = Ring::new(kept(), 0, source);
        let count = INSTANTS.start as i64 + 10;
        (0..count).for_each(|k| row(&mut ring, k));
        let times: Vec<i64> = ring.instants().map(|i| i.time().0).collect();
        assert_eq!(times, (10..count).collect::<Vec<_>>());
        assert!(!ring.is_whole());
        let until = |k| ring.back_from(Time(k)).next().map(|i| i.time().0);
        assert_eq!([until(9), until(10), until(700), until(i64::MAX)], [None, Some(10), Some(700), Some(count - 1)]);
        for instant in ring.instants() {
            let (k, wanted) = (instant.time().0, moment(instant.time().0));
            assert_eq!([0, 1, 2].map(|i| instant.value(i)), [&wanted.values[0], &Value::Missing, &wanted.values[2]]);
            assert_eq!(instant.event(0), wanted.event(0), "{k}");
            assert_eq!((instant.state(0), instant.state(1)), (wanted.state(0), None));
            assert_eq!((instant.last(0), instant.is_fresh(0)), wanted.topics[0]);
        }
        ring.clear();
        assert_eq!((ring.instants().count(), ring.is_whole()), (0, true));
    }

    #[test]
    fn what_is_within_reach_is_kept_where_there_is_room() {
        let mut ring = Ring::new(kept(), 3000, source);
        (0..10_000).for_each(|k| row(&mut ring, k));
        let first = ring.instants().next().map(|i| i.time().0);
        assert!(first.is_some_and(|first| (5000..=7000).contains(&first)), "{first:?}");
        assert_eq!(ring.instants().map(|i| i.value(0).clone()).next_back(), Some(Value::Num(9999.0)));
        let in_order = ring.instants().zip(ring.instants().skip(1)).all(|(a, b)| b.time().0 == a.time().0 + 1);
        assert!(in_order);
        let mut endless = Ring::new(kept(), i64::MAX, source);
        (0..200_000).for_each(|k| row(&mut endless, k));
        assert!(endless.times.len() <= INSTANTS.end && endless.bytes() <= BYTES, "{}", endless.bytes());
    }

    #[test]
    fn pictures_are_not_kept() {
        let mut ring = Ring::new(Kept { inputs: vec![0], ..Kept::default() }, 0, |_| Source::Any);
        for length in [LONGEST, LONGEST + 1] {
            let scan = Value::Nums(vec![0.0; length]);
            ring.push(Time(0), &Fixed { values: vec![scan], ..Fixed::default() });
        }
        let kept: Vec<bool> = ring.instants().map(|i| *i.value(0) != Value::Missing).collect();
        assert_eq!(kept, [true, false]);
    }
}
