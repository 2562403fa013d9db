//! The values that the instances of a group stand for, and which instances see an event: so that it costs those that do, and no others.

use alloc::vec::Vec;
use core::cmp::Ordering;

use lapwing_stream::Value;
use serde::{Deserialize, Serialize};

/// The keys of instances, by their numbers: a value for each slice, `None` for every value not seen so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Keys {
    /// How many values a key has.
    width: usize,
    /// Key after key.
    values: Vec<Option<Value>>,
    /// For each of them, whether the slice's own event has had it.
    is_seen: Vec<bool>,
    /// The instances by the value of their first slice. It follows from the keys, and is worked out anew where it is missing.
    #[serde(skip)]
    index: Index,
}

impl Keys {
    /// None yet, of so many slices.
    pub fn new(width: usize) -> Keys {
        Keys { width, ..Keys::default() }
    }

    /// The key of an instance.
    pub fn of(&self, number: usize) -> &[Option<Value>] {
        self.values.get(self.range(number)).unwrap_or_default()
    }

    /// Gives the key of an instance away for as long as it is at work, and takes it back.
    #[inline]
    pub fn swap(&mut self, number: usize, with: &mut [Option<Value>]) {
        let range = self.range(number);
        let key = self.values.get_mut(range).unwrap_or_default();
        key.iter_mut().zip(with).for_each(|(mine, other)| core::mem::swap(mine, other));
    }

    /// Whether the slices' own events have had all values of it: it is an instance, and no template of instances to come.
    pub fn are_seen(&self, number: usize) -> bool {
        self.is_seen.get(self.range(number)).is_some_and(|seen| seen.iter().all(|seen| *seen))
    }

    /// Adds an instance: nothing but templates.
    pub fn add_template(&mut self) {
        self.values.extend(core::iter::repeat_n(None, self.width));
        self.is_seen.extend(core::iter::repeat_n(false, self.width));
    }

    /// Adds an instance: as that one is, but with that value of the `i`-th slice.
    pub fn add_like(&mut self, number: usize, i: usize, value: &Value) {
        let (range, from) = (self.range(number), self.values.len());
        self.values.extend_from_within(range.clone());
        self.is_seen.extend_from_within(range);
        if let Some(own) = self.values.get_mut(from + i) {
            *own = Some(value.clone());
        }
    }

    /// The slice's own event had that value of an instance. Returns whether it is one now, and was not before.
    pub fn mark(&mut self, number: usize, i: usize, value: &Value) -> bool {
        let at = number * self.width + i;
        if !self.has(number, i, value) || self.is_seen.get(at) != Some(&false) {
            return false;
        }
        self.is_seen[at] = true;
        self.are_seen(number)
    }

    /// Whether an instance has that value of the `i`-th slice.
    pub fn has(&self, number: usize, i: usize, value: &Value) -> bool {
        self.of(number).get(i).and_then(Option::as_ref) == Some(value)
    }

    /// Whether an instance stands for all values of the `i`-th slice that have not been seen.
    pub fn is_template(&self, number: usize, i: usize) -> bool {
        matches!(self.of(number).get(i), Some(None))
    }

    /// The instances with that value of the first slice; nothing where it has no order.
    pub fn with(&mut self, wanted: &Value) -> Option<&[u32]> {
        let Keys { width, values, index, .. } = self;
        let firsts = Firsts { width: *width, values };
        index.catch_up(&firsts);
        index.with(&firsts, wanted)
    }

    /// Those that no value of the first slice finds.
    pub fn others(&self) -> &[u32] {
        &self.index.others
    }

    fn range(&self, number: usize) -> core::ops::Range<usize> {
        number * self.width..(number + 1) * self.width
    }
}

/// The values of the first slices.
struct Firsts<'a> {
    width: usize,
    values: &'a [Option<Value>],
}

impl Firsts<'_> {
    fn count(&self) -> usize {
        self.values.len() / self.width.max(1)
    }

    fn value(&self, number: u32) -> Option<&Value> {
        self.values.get(number as usize * self.width)?.as_ref()
    }

    /// By value; instances with the same one in the order in which they came.
    fn compare(&self, a: u32, b: u32) -> Ordering {
        let by_value = self.value(a).zip(self.value(b)).map_or(Ordering::Equal, |(a, b)| order(a, b));
        by_value.then(a.cmp(&b))
    }
}

/// Numbers of instances.
#[derive(Clone, Debug, Default)]
struct Index {
    /// Those whose value has an order, by it.
    ordered: Vec<u32>,
    /// All others: the templates of instances to come, and those of values that equal nothing or have parts.
    others: Vec<u32>,
}

impl Index {
    /// Takes in the instances that were added since it was asked last.
    #[inline]
    fn catch_up(&mut self, firsts: &Firsts<'_>) {
        let known = self.ordered.len() + self.others.len();
        if known < firsts.count() {
            self.take_in(known, firsts);
        }
    }

    fn take_in(&mut self, known: usize, firsts: &Firsts<'_>) {
        let is_ordered = |number: &u32| firsts.value(*number).is_some_and(has_order);
        let (new, others): (Vec<u32>, Vec<u32>) = (known as u32..firsts.count() as u32).partition(is_ordered);
        self.others.extend(others);
        if let [number] = new[..] {
            let at = self.ordered.partition_point(|&other| firsts.compare(other, number).is_lt());
            self.ordered.insert(at, number);
        } else if !new.is_empty() {
            self.ordered.extend(new);
            self.ordered.sort_by(|&a, &b| firsts.compare(a, b));
        }
    }

    fn with(&self, firsts: &Firsts<'_>, wanted: &Value) -> Option<&[u32]> {
        if !has_order(wanted) {
            return None;
        }
        let order = |number: u32| firsts.value(number).map_or(Ordering::Less, |value| order(value, wanted));
        let from = self.ordered.partition_point(|&number| order(number).is_lt());
        let rest = self.ordered.get(from..).unwrap_or_default();
        // PERF: those of one value are few.
        rest.get(..rest.iter().take_while(|&&number| order(number).is_eq()).count())
    }
}

/// Whether a value equals itself and can be told from others at a glance.
fn has_order(value: &Value) -> bool {
    match value {
        Value::Bool(_) | Value::Str(_) => true,
        Value::Num(number) => !number.is_nan(),
        _ => false,
    }
}

/// An order of the values that have one, in which those are equal that are.
fn order(a: &Value, b: &Value) -> Ordering {
    let kind = |value: &Value| match value {
        Value::Bool(_) => 0,
        Value::Num(_) => 1,
        _ => 2,
    };
    match (a, b) {
        (Value::Bool(a), Value::Bool(b)) => a.cmp(b),
        (Value::Num(a), Value::Num(b)) => a.partial_cmp(b).unwrap_or(Ordering::Equal),
        (Value::Str(a), Value::Str(b)) => a.cmp(b),
        (a, b) => kind(a).cmp(&kind(b)),
    }
}
