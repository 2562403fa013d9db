//! The signals that are wanted of rows: which value a name goes to, and names that are wanted more than once.

use std::collections::BTreeMap;

use lapwing_stream::{Name, Value};

/// The signals that are wanted of rows, the k-th as the k-th value.
#[derive(Debug, Default)]
pub(super) struct Signals {
    names: Vec<Name>,
    slots: BTreeMap<Name, usize>,
    /// Values that are wanted once more, and where.
    copies: Vec<(usize, usize)>,
}

impl Signals {
    pub fn new(names: &[Name]) -> Signals {
        let mut signals = Signals { names: names.to_vec(), ..Signals::default() };
        for (slot, name) in names.iter().enumerate() {
            let first = *signals.slots.entry(name.clone()).or_insert(slot);
            if first < slot {
                signals.copies.push((first, slot));
            }
        }
        signals
    }

    /// As they were wanted.
    pub fn names(&self) -> &[Name] {
        &self.names
    }

    /// The value that a name goes to, unless nobody wants it.
    pub fn slot(&self, name: &str) -> Option<usize> {
        self.slots.get(name).copied()
    }

    /// As many values as there are signals, all missing.
    pub fn blank(&self) -> Vec<Value> {
        let mut values = Vec::new();
        values.resize_with(self.names.len(), Value::default);
        values
    }

    /// Puts the values that are wanted more than once where else they are wanted.
    #[inline]
    pub fn copy(&self, values: &mut [Value]) {
        for &(from, to) in &self.copies {
            if let Ok([from, to]) = values.get_disjoint_mut([from, to]) {
                to.clone_from(from);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_is_wanted_twice_is_read_once() {
        let signals = Signals::new(&["a", "b", "a"].map(Name::from));
        assert_eq!(["a", "b", "c"].map(|name| signals.slot(name)), [Some(0), Some(1), None]);
        let mut values = signals.blank();
        values[0] = Value::Num(3.0);
        signals.copy(&mut values);
        assert_eq!(values, [Value::Num(3.0), Value::Missing, Value::Num(3.0)]);
    }
}
