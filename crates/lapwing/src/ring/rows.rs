//! Rows of a [`Ring`](super::Ring): what changes now and then, each row with the number of the instant from which on it counts.

use std::collections::VecDeque;

use lapwing_stream::Value;

/// The longest array that is kept: a laser scan is, a picture is not.
pub(super) const LONGEST: usize = 512;

/// Rows of signals that get their values together.
#[derive(Debug)]
pub(super) struct Table {
    inputs: Vec<usize>,
    /// Where the buffer begins that has the values of each row.
    rows: Strip<usize>,
    /// The values, one buffer after the other.
    // PERF: they stay where they are: a number that takes the place of another is all that a row costs.
    values: Vec<Value>,
}

impl Table {
    pub fn new() -> Table {
        Table { inputs: Vec::new(), rows: Strip::new(), values: Vec::new() }
    }

    /// Adds a signal, while there are no rows. Gives its place in them.
    pub fn add(&mut self, input: usize) -> usize {
        self.inputs.push(input);
        self.inputs.len() - 1
    }

    /// Adds a row, in the buffer of one that no instant from `oldest` on needs.
    pub fn push<'v>(&mut self, number: u64, oldest: u64, value: impl Fn(usize) -> &'v Value) {
        let start = match self.rows.spare(oldest) {
            Some(start) => {
                let buffer = self.values.iter_mut().skip(start);
                buffer.zip(&self.inputs).for_each(|(to, &input)| keep(to, value(input)));
                start
            }
            None => {
                self.values.extend(self.inputs.iter().map(|&input| kept(value(input))));
                self.values.len() - self.inputs.len()
            }
        };
        self.rows.add(number, start);
    }

    /// The value at a place in the row that counts at an instant.
    pub fn at(&self, number: u64, place: usize) -> Option<&Value> {
        let (_, start) = self.rows.at(number)?;
        self.values.get(start + place)
    }

    pub fn clear(&mut self) {
        self.rows.clear();
        self.values.clear();
    }

    /// The memory that the rows take.
    pub fn bytes(&self) -> usize {
        self.rows.bytes(|_| 0) + self.values.iter().map(bytes).sum::<usize>()
    }
}

/// What changes now and then.
#[derive(Debug)]
pub(super) struct Strip<T> {
    rows: VecDeque<(u64, T)>,
}

impl<T: Default> Strip<T> {
    pub fn new() -> Strip<T> {
        Strip { rows: VecDeque::new() }
    }

    /// Adds a row, in the buffers of one that no instant from `oldest` on needs.
    pub fn push(&mut self, number: u64, oldest: u64, fill: impl FnOnce(&mut T)) {
        let mut row = self.spare(oldest).unwrap_or_default();
        fill(&mut row);
        self.add(number, row);
    }

    /// Takes out the oldest row, where no instant from `oldest` on needs it.
    fn spare(&mut self, oldest: u64) -> Option<T> {
        let is_past = self.rows.get(1).is_some_and(|(next, _)| *next <= oldest);
        if is_past { self.rows.pop_front().map(|(_, row)| row) } else { None }
    }

    fn add(&mut self, number: u64, row: T) {
        self.rows.push_back((number, row));
    }

    /// The row that counts at an instant, and from when on.
    pub fn at(&self, number: u64) -> Option<&(u64, T)> {
        let after = self.rows.partition_point(|(from, _)| *from <= number);
        self.rows.get(after.checked_sub(1)?)
    }

    /// The row that was added last.
    pub fn last(&self) -> Option<&T> {
        self.rows.back().map(|(_, row)| row)
    }

    pub fn clear(&mut self) {
        self.rows.clear();
    }

    /// The memory that the rows take, `more` beside each of them.
    pub fn bytes(&self, more: impl Fn(&T) -> usize) -> usize {
        self.rows.iter().map(|(_, row)| size_of::<(u64, T)>() + more(row)).sum()
    }
}

/// Stores values in the buffers of earlier ones.
pub(super) fn fill<'v>(row: &mut Vec<Value>, values: impl ExactSizeIterator<Item = &'v Value>) {
    row.resize_with(values.len(), Value::default);
    row.iter_mut().zip(values).for_each(|(to, from)| keep(to, from));
}

fn kept(value: &Value) -> Value {
    let mut kept = Value::Missing;
    keep(&mut kept, value);
    kept
}

#[inline]
fn keep(to: &mut Value, from: &Value) {
    match from {
        Value::Num(_) | Value::Bool(_) | Value::Str(_) => to.clone_from(from),
        Value::Nums(xs) if xs.len() <= LONGEST => to.clone_from(from),
        _ => *to = Value::Missing,
    }
}

/// The memory that a value takes.
pub(super) fn bytes(value: &Value) -> usize {
    let more = match value {
        Value::Str(s) => s.capacity(),
        Value::Nums(xs) => xs.capacity() * size_of::<f64>(),
        _ => 0,
    };
    size_of::<Value>() + more
}
