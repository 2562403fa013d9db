//! The signals that are wanted of rows: which value a name goes to, and names that are wanted more than once.

use std::collections::BTreeMap;

use lapwing_stream::{Name, Value};

use crate::path::{Path, ways};

/// The signals that are wanted of rows, the k-th as the k-th value.
#[derive(Debug, Default)]
pub(super) struct Signals {
    names: Vec<Name>,
    keys: BTreeMap<Name, Key>,
    /// Values that are wanted once more, and where.
    copies: Vec<(usize, usize)>,
}

/// A name whose value is wanted, or something inside it.
#[derive(Debug, Default)]
pub(super) struct Key {
    /// Its number, from 0.
    pub number: usize,
    /// Where the whole of it goes, if it is wanted.
    pub whole: Option<usize>,
    /// What is wanted of it where it is an object or an array, and where that goes.
    pub inside: Vec<(Path, usize)>,
}

impl Signals {
    pub fn new(names: &[Name]) -> Signals {
        let mut signals = Signals { names: names.to_vec(), ..Signals::default() };
        for (slot, name) in names.iter().enumerate() {
            let first = *signals.key(name).whole.get_or_insert(slot);
            if first < slot {
                signals.copies.push((first, slot));
                continue;
            }
            ways(name).for_each(|(key, way)| signals.key(key).inside.push((way, slot)));
        }
        signals
    }

    /// The key of that name, which is added where it is new.
    fn key(&mut self, name: &str) -> &mut Key {
        let number = self.keys.len();
        self.keys.entry(name.into()).or_insert_with(|| Key { number, ..Key::default() })
    }

    /// How many keys there are.
    pub fn keys(&self) -> usize {
        self.keys.len()
    }

    /// What is wanted of the value of a name.
    pub fn wanted(&self, name: &str) -> Option<&Key> {
        self.keys.get(name)
    }

    /// As they were wanted.
    pub fn names(&self) -> &[Name] {
        &self.names
    }

    /// Where the whole value of a name goes, unless nobody wants it.
    pub fn slot(&self, name: &str) -> Option<usize> {
        self.keys.get(name)?.whole
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
