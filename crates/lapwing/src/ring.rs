//! What the latest instants looked like.

use lapwing_stream::{Time, Value};

use crate::moment::{Kept, Moment};

/// How many instants are kept at least, and at most.
const INSTANTS: std::ops::Range<usize> = 1024..65_536;

/// The ring does not grow beyond this, in bytes.
const BYTES: usize = 4 << 20;

/// The longest array that is kept: a laser scan is, a picture is not.
const LONGEST: usize = 512;

/// What the latest instants looked like, as far as someone wants to know. Once it is full it allocates no more.
#[derive(Debug)]
pub(crate) struct Ring {
    kept: Kept,
    /// How far back it reaches where it may, in nanoseconds.
    reach: i64,
    capacity: usize,
    /// Whether there is no memory for more.
    is_full: bool,
    times: Vec<Time>,
    /// Of one instant after the other: the kept signals, then events, then machines.
    values: Vec<Value>,
    /// Of one instant after the other, for each kept topic: the stamp of its last message, and whether it came then.
    stamps: Vec<(Option<Time>, bool)>,
    /// Where the oldest is, once all places are taken.
    oldest: usize,
    /// Whether an instant has made room for a later one.
    has_lost: bool,
}

/// An instant of a [`Ring`].
#[derive(Clone, Copy)]
pub(crate) struct Instant<'r> {
    ring: &'r Ring,
    at: usize,
}

impl Ring {
    /// Keeps what `kept` names; of so many nanoseconds, where the instants are few enough for that.
    pub fn new(kept: Kept, reach: i64) -> Ring {
        Ring {
            kept,
            reach,
            capacity: INSTANTS.start,
            is_full: false,
            times: Vec::new(),
            values: Vec::new(),
            stamps: Vec::new(),
            oldest: 0,
            has_lost: false,
        }
    }

    /// An instant is over.
    pub fn push(&mut self, time: Time, from: &impl Moment) {
        if self.times.len() == self.capacity && self.should_grow(time) {
            self.grow();
        }
        let at = match self.times.len() < self.capacity {
            true => {
                self.times.push(time);
                self.values.resize_with(self.times.len() * self.width(), Value::default);
                self.stamps.resize(self.times.len() * self.kept.topics.len(), (None, false));
                self.times.len() - 1
            }
            false => {
                let at = self.oldest;
                self.times[at] = time;
                self.oldest = (self.oldest + 1) % self.capacity;
                self.has_lost = true;
                at
            }
        };
        self.store(at, from);
    }

    fn store(&mut self, at: usize, from: &impl Moment) {
        let Kept { inputs, events, machines, topics } = &self.kept;
        let width = inputs.len() + events.len() + machines.len();
        let mut places = self.values[at * width..].iter_mut();
        for (&input, to) in inputs.iter().zip(&mut places) {
            keep(to, from.value(input));
        }
        for (&event, to) in events.iter().zip(&mut places) {
            keep_event(to, from.event(event));
        }
        for (&machine, to) in machines.iter().zip(&mut places) {
            *to = from.state(machine).map_or(Value::Missing, |state| Value::Num(state as f64));
        }
        for (&topic, to) in topics.iter().zip(&mut self.stamps[at * topics.len()..]) {
            *to = (from.last(topic), from.is_fresh(topic));
        }
    }

    fn width(&self) -> usize {
        self.kept.inputs.len() + self.kept.events.len() + self.kept.machines.len()
    }

    /// Whether what would make room is still within reach, and there is memory for more.
    fn should_grow(&mut self, now: Time) -> bool {
        let is_near = self.times.get(self.oldest).is_some_and(|t| now.since(*t).nanos() <= self.reach);
        if is_near && !self.is_full {
            self.is_full = self.capacity * 2 > INSTANTS.end || self.bytes() * 2 > BYTES;
        }
        is_near && !self.is_full
    }

    fn bytes(&self) -> usize {
        let fixed = self.stamps.len() * size_of::<(Option<Time>, bool)>() + self.times.len() * size_of::<Time>();
        fixed + self.values.iter().map(bytes).sum::<usize>()
    }

    fn grow(&mut self) {
        let width = self.width();
        self.times.rotate_left(self.oldest);
        self.values.rotate_left(self.oldest * width);
        self.stamps.rotate_left(self.oldest * self.kept.topics.len());
        self.oldest = 0;
        self.capacity *= 2;
    }

    /// Time jumped: what was before is no history of what comes.
    pub fn clear(&mut self) {
        self.times.clear();
        self.values.clear();
        self.stamps.clear();
        self.oldest = 0;
        self.has_lost = false;
    }

    /// How many instants there are.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Whether the oldest is the first that there was.
    pub fn is_whole(&self) -> bool {
        !self.has_lost
    }

    /// The instants, from the oldest to the latest.
    pub fn instants(&self) -> impl DoubleEndedIterator<Item = Instant<'_>> {
        let count = self.times.len();
        (0..count).map(move |n| Instant { ring: self, at: (self.oldest + n) % count })
    }

    /// The last instant at or before that time.
    pub fn last_until(&self, time: Time) -> Option<Instant<'_>> {
        let count = self.times.len();
        let in_order = |n: usize| (self.oldest + n) % count;
        let (mut low, mut high) = (0, count);
        while low < high {
            let middle = (low + high) / 2;
            match self.times[in_order(middle)] <= time {
                true => low = middle + 1,
                false => high = middle,
            }
        }
        let last = low.checked_sub(1)?;
        Some(Instant { ring: self, at: in_order(last) })
    }

    fn cell(&self, at: usize, place: usize) -> &Value {
        self.values.get(at * self.width() + place).unwrap_or(&Value::Missing)
    }
}

fn keep(to: &mut Value, from: &Value) {
    match from {
        Value::Num(_) | Value::Bool(_) | Value::Str(_) => to.clone_from(from),
        Value::Nums(xs) if xs.len() <= LONGEST => to.clone_from(from),
        _ => *to = Value::Missing,
    }
}

/// Stores whether an event occurs and, where it does, its fields, in the buffers of an earlier occurrence.
fn keep_event(to: &mut Value, from: Option<&[Value]>) {
    if !matches!(to, Value::List(_)) {
        *to = Value::List(vec![Value::Bool(false)]);
    }
    let Value::List(list) = to else { return };
    list.truncate(1 + from.map_or(usize::MAX - 1, <[Value]>::len));
    list[0] = Value::Bool(from.is_some());
    for (k, field) in from.into_iter().flatten().enumerate() {
        match list.get_mut(k + 1) {
            Some(to) => keep(to, field),
            None => {
                let mut kept = Value::Missing;
                keep(&mut kept, field);
                list.push(kept);
            }
        }
    }
}

fn bytes(value: &Value) -> usize {
    let more = match value {
        Value::Str(s) => s.capacity(),
        Value::Nums(xs) => xs.capacity() * size_of::<f64>(),
        Value::List(xs) => xs.iter().map(bytes).sum(),
        _ => 0,
    };
    size_of::<Value>() + more
}

impl Instant<'_> {
    /// When it was.
    pub fn time(&self) -> Time {
        self.ring.times[self.at]
    }

    /// Its number, 0 the oldest.
    pub fn number(&self) -> usize {
        (self.at + self.ring.len() - self.ring.oldest) % self.ring.len()
    }
}

impl Moment for Instant<'_> {
    fn value(&self, input: usize) -> &Value {
        let place = self.ring.kept.inputs.binary_search(&input);
        place.map_or(&Value::Missing, |place| self.ring.cell(self.at, place))
    }

    fn event(&self, event: usize) -> Option<&[Value]> {
        let place = self.ring.kept.inputs.len() + self.ring.kept.events.binary_search(&event).ok()?;
        match self.ring.cell(self.at, place) {
            Value::List(list) => match list.split_first()? {
                (Value::Bool(true), fields) => Some(fields),
                _ => None,
            },
            _ => None,
        }
    }

    fn state(&self, machine: usize) -> Option<usize> {
        let kept = &self.ring.kept;
        let place = kept.inputs.len() + kept.events.len() + kept.machines.binary_search(&machine).ok()?;
        match self.ring.cell(self.at, place) {
            Value::Num(state) => Some(*state as usize),
            _ => None,
        }
    }

    fn last(&self, topic: usize) -> Option<Time> {
        let place = self.ring.kept.topics.binary_search(&topic).ok()?;
        self.ring.stamps.get(self.at * self.ring.kept.topics.len() + place)?.0
    }

    fn is_fresh(&self, topic: usize) -> bool {
        let place = self.ring.kept.topics.binary_search(&topic).ok();
        let stamp = place.and_then(|p| self.ring.stamps.get(self.at * self.ring.kept.topics.len() + p));
        stamp.is_some_and(|s| s.1)
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

    #[test]
    fn the_latest_instants_are_kept_in_order() {
        let mut ring = Ring::new(kept(), 0);
        let count = INSTANTS.start as i64 + 10;
        (0..count).for_each(|k| ring.push(Time(k), &moment(k)));
        let times: Vec<i64> = ring.instants().map(|i| i.time().0).collect();
        assert_eq!(times, (10..count).collect::<Vec<_>>());
        assert!(!ring.is_whole());
        let until = |k| ring.last_until(Time(k)).map(|i| i.time().0);
        assert_eq!([until(9), until(10), until(700), until(i64::MAX)], [None, Some(10), Some(700), Some(count - 1)]);
        for instant in ring.instants() {
            let (k, wanted) = (instant.time().0, moment(instant.time().0));
            assert_eq!([0, 1, 2].map(|i| instant.value(i)), [&wanted.values[0], &Value::Missing, &wanted.values[2]]);
            assert_eq!(instant.event(0), wanted.event(0), "{k}");
            assert_eq!((instant.state(0), instant.state(1)), (wanted.state(0), None));
            assert_eq!((instant.last(0), instant.is_fresh(0)), wanted.topics[0]);
        }
        ring.clear();
        assert_eq!((ring.len(), ring.is_whole()), (0, true));
    }

    #[test]
    fn what_is_within_reach_is_kept_where_there_is_room() {
        let mut ring = Ring::new(kept(), 3000);
        (0..10_000).for_each(|k| ring.push(Time(k), &moment(k)));
        let first = ring.instants().next().map(|i| i.time().0);
        assert!(first.is_some_and(|first| (5000..=7000).contains(&first)), "{first:?}");
        assert_eq!(ring.instants().map(|i| i.value(0).clone()).next_back(), Some(Value::Num(9999.0)));
        let in_order = ring.instants().zip(ring.instants().skip(1)).all(|(a, b)| b.time().0 == a.time().0 + 1);
        assert!(in_order);
        let mut endless = Ring::new(kept(), i64::MAX);
        (0..200_000).for_each(|k| endless.push(Time(k), &moment(k)));
        assert!(endless.len() <= INSTANTS.end && endless.bytes() <= BYTES, "{} {}", endless.len(), endless.bytes());
    }

    #[test]
    fn pictures_are_not_kept() {
        let mut ring = Ring::new(Kept { inputs: vec![0], ..Kept::default() }, 0);
        for length in [LONGEST, LONGEST + 1] {
            let scan = Value::Nums(vec![0.0; length]);
            ring.push(Time(0), &Fixed { values: vec![scan], ..Fixed::default() });
        }
        let kept: Vec<bool> = ring.instants().map(|i| *i.value(0) != Value::Missing).collect();
        assert_eq!(kept, [true, false]);
    }
}
