//! The instances of a group by the value of their first slice, so that an event costs those that see it and no others.

use alloc::vec::Vec;
use core::cmp::Ordering;

use lapwing_stream::Value;

use crate::group::Core;

/// Numbers of instances. It follows from them, and is worked out anew where it is missing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Index {
    /// Those whose value has an order, by it.
    ordered: Vec<usize>,
    /// All others: the templates of instances to come, and those of values that equal nothing or have parts.
    others: Vec<usize>,
}

impl Index {
    /// Takes in the instances that were added since it was asked last.
    #[inline]
    pub fn catch_up(&mut self, cores: &[Core]) {
        let known = self.ordered.len() + self.others.len();
        if known < cores.len() {
            self.take_in(known, cores);
        }
    }

    fn take_in(&mut self, known: usize, cores: &[Core]) {
        let is_ordered = |number: &usize| value(cores, *number).is_some_and(has_order);
        let (new, others): (Vec<_>, Vec<_>) = (known..cores.len()).partition(is_ordered);
        self.others.extend(others);
        if let [number] = new[..] {
            let at = self.ordered.partition_point(|&other| compare(cores, other, number).is_lt());
            self.ordered.insert(at, number);
        } else if !new.is_empty() {
            self.ordered.extend(new);
            self.ordered.sort_by(|&a, &b| compare(cores, a, b));
        }
    }

    /// The instances with that value; nothing where it has no order.
    pub fn with(&self, cores: &[Core], wanted: &Value) -> Option<&[usize]> {
        if !has_order(wanted) {
            return None;
        }
        let order = |number: usize| value(cores, number).map_or(Ordering::Less, |value| order(value, wanted));
        let from = self.ordered.partition_point(|&number| order(number).is_lt());
        let rest = self.ordered.get(from..).unwrap_or_default();
        rest.get(..rest.partition_point(|&number| order(number).is_eq()))
    }

    /// Those that no value finds.
    pub fn others(&self) -> &[usize] {
        &self.others
    }
}

/// The value of an instance's first slice.
fn value(cores: &[Core], number: usize) -> Option<&Value> {
    cores.get(number)?.key.first()?.as_ref()
}

/// By value; instances with the same one in the order in which they came.
fn compare(cores: &[Core], a: usize, b: usize) -> Ordering {
    let by_value = value(cores, a).zip(value(cores, b)).map_or(Ordering::Equal, |(a, b)| order(a, b));
    by_value.then(a.cmp(&b))
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
