//! What the latest instants looked like: of each instant only what it changed.

use std::collections::VecDeque;

use lapwing_stream::{Sample, Time, Value, What};

use crate::moment::{Kept, Moment};

/// How many instants are kept at least, and at most.
const INSTANTS: std::ops::Range<usize> = 1024..65_536;

/// The ring does not grow beyond this, in bytes.
const BYTES: usize = 4 << 20;

/// The longest array that is kept: a laser scan is, a picture is not.
const LONGEST: usize = 512;

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
    /// For each kept signal its group, and its place there.
    places: Vec<(usize, usize)>,
    /// For each kept event, the fields of its occurrences.
    events: Vec<Strip<Vec<Value>>>,
    /// For each kept machine, the states that it went to.
    machines: Vec<Strip<Option<usize>>>,
    /// For each kept topic, the stamps of its messages.
    topics: Vec<Strip<Time>>,
    /// What the engine takes in, and when.
    arrival: Option<(Time, Source)>,
}

/// Signals that get their values together.
#[derive(Debug)]
struct Group {
    source: Source,
    inputs: Vec<usize>,
    /// Whether something has come since the latest row.
    is_due: bool,
    /// From which instant on each row counts.
    from: VecDeque<u64>,
    /// The values of one row after the other.
    values: VecDeque<Value>,
}

/// What changes now and then: rows, each with the number of the instant from which on it counts.
#[derive(Debug)]
struct Strip<T> {
    rows: VecDeque<(u64, T)>,
}

/// An instant of a [`Ring`].
#[derive(Clone, Copy)]
pub(crate) struct Instant<'r> {
    ring: &'r Ring,
    number: u64,
}

impl Group {
    fn new(source: Source) -> Group {
        Group { source, inputs: Vec::new(), is_due: true, from: VecDeque::new(), values: VecDeque::new() }
    }

    /// Adds a row, in the buffers of one that no instant from `oldest` on needs.
    fn push(&mut self, number: u64, oldest: u64, moment: &impl Moment) {
        let is_past = self.from.get(1).is_some_and(|next| *next <= oldest);
        if is_past {
            self.from.pop_front();
        }
        self.from.push_back(number);
        for &input in &self.inputs {
            let spare = if is_past { self.values.pop_front() } else { None };
            let mut value = spare.unwrap_or_default();
            keep(&mut value, moment.value(input));
            self.values.push_back(value);
        }
    }

    /// The value at a place in the row that counts at an instant.
    fn at(&self, number: u64, place: usize) -> Option<&Value> {
        let row = self.from.partition_point(|from| *from <= number).checked_sub(1)?;
        self.values.get(row * self.inputs.len() + place)
    }

    fn clear(&mut self) {
        self.from.clear();
        self.values.clear();
        self.is_due = true;
    }
}

impl<T: Default> Strip<T> {
    fn new() -> Strip<T> {
        Strip { rows: VecDeque::new() }
    }

    /// Adds a row, in the buffers of one that no instant from `oldest` on needs.
    fn push(&mut self, number: u64, oldest: u64, fill: impl FnOnce(&mut T)) {
        let is_past = self.rows.get(1).is_some_and(|(next, _)| *next <= oldest);
        let spare = if is_past { self.rows.pop_front() } else { None };
        let mut row = spare.map(|(_, row)| row).unwrap_or_default();
        fill(&mut row);
        self.rows.push_back((number, row));
    }

    /// The row that counts at an instant, and from when on.
    fn at(&self, number: u64) -> Option<&(u64, T)> {
        let after = self.rows.partition_point(|(from, _)| *from <= number);
        self.rows.get(after.checked_sub(1)?)
    }

    /// The row that was added last.
    fn last(&self) -> Option<&T> {
        self.rows.back().map(|(_, row)| row)
    }
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
                groups.push(Group::new(source));
                groups.len() - 1
            });
            places.push((group, groups[group].inputs.len()));
            groups[group].inputs.push(input);
        }
        Ring {
            reach,
            capacity: INSTANTS.start,
            is_full: false,
            times: VecDeque::new(),
            oldest: 0,
            groups,
            places,
            events: kept.events.iter().map(|_| Strip::new()).collect(),
            machines: kept.machines.iter().map(|_| Strip::new()).collect(),
            topics: kept.topics.iter().map(|_| Strip::new()).collect(),
            kept,
            arrival: None,
        }
    }

    /// The engine takes a sample in. The instants before its stamp come before it.
    #[inline]
    pub fn arrive(&mut self, sample: &Sample<'_>) {
        self.settle(None);
        self.arrival = match sample.what {
            What::Message { topic, .. } => Some((sample.time, Source::Topic(topic))),
            What::Row { .. } => Some((sample.time, Source::Rows)),
            What::Event { .. } | What::Other => None,
        };
    }

    /// What arrived by then has changed its signals.
    fn settle(&mut self, by: Option<Time>) {
        let Some((_, source)) = self.arrival.take_if(|(time, _)| by.is_none_or(|by| *time <= by)) else { return };
        self.groups.iter_mut().for_each(|group| group.is_due |= group.source == source);
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
        for group in &mut self.groups {
            if std::mem::take(&mut group.is_due) || group.source == Source::Any {
                group.push(number, oldest, from);
            }
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
    fn should_grow(&mut self, now: Time) -> bool {
        let is_near = self.times.front().is_some_and(|oldest| now.since(*oldest).nanos() <= self.reach);
        if is_near && !self.is_full {
            self.is_full = self.capacity * 2 > INSTANTS.end || self.bytes() * 2 > BYTES;
        }
        is_near && !self.is_full
    }

    fn bytes(&self) -> usize {
        let row = |(_, row): &(u64, Vec<Value>)| size_of::<(u64, Vec<Value>)>() + row.iter().map(bytes).sum::<usize>();
        let rows = self.events.iter().flat_map(|strip| &strip.rows);
        let signals = self.groups.iter().flat_map(|group| &group.values).map(bytes).sum::<usize>();
        let starts = self.groups.iter().map(|group| group.from.len() * size_of::<u64>()).sum::<usize>();
        let stamps: usize = self.topics.iter().map(|strip| strip.rows.len() * size_of::<(u64, Time)>()).sum();
        let states: usize =
            self.machines.iter().map(|strip| strip.rows.len() * size_of::<(u64, Option<usize>)>()).sum();
        self.times.len() * size_of::<Time>() + signals + starts + rows.map(row).sum::<usize>() + stamps + states
    }

    /// Time jumped: what was before is no history of what comes.
    pub fn clear(&mut self) {
        self.times.clear();
        self.oldest = 0;
        self.groups.iter_mut().for_each(Group::clear);
        self.events.iter_mut().for_each(|strip| strip.rows.clear());
        self.machines.iter_mut().for_each(|strip| strip.rows.clear());
        self.topics.iter_mut().for_each(|strip| strip.rows.clear());
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

/// Stores values in the buffers of earlier ones.
fn fill<'v>(row: &mut Vec<Value>, values: impl ExactSizeIterator<Item = &'v Value>) {
    row.resize_with(values.len(), Value::default);
    row.iter_mut().zip(values).for_each(|(to, from)| keep(to, from));
}

#[inline]
fn keep(to: &mut Value, from: &Value) {
    match from {
        Value::Num(_) | Value::Bool(_) | Value::Str(_) => to.clone_from(from),
        Value::Nums(xs) if xs.len() <= LONGEST => to.clone_from(from),
        _ => *to = Value::Missing,
    }
}

fn bytes(value: &Value) -> usize {
    let more = match value {
        Value::Str(s) => s.capacity(),
        Value::Nums(xs) => xs.capacity() * size_of::<f64>(),
        _ => 0,
    };
    size_of::<Value>() + more
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
            groups.get(group)?.at(self.number, place)
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
