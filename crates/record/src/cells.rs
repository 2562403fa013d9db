//! Values by name: the cells of a row, the fields of an event.

use lapwing_stream::{Name, Value};

/// Values by name: the cells of a row, the fields of an event. There are as many names as values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cells<'a> {
    names: &'a [Name],
    values: &'a [Value],
}

impl<'a> Cells<'a> {
    /// The k-th value by the k-th name; what one of them has too many is left out.
    pub fn new(names: &'a [Name], values: &'a [Value]) -> Cells<'a> {
        let count = names.len().min(values.len());
        Cells { names: &names[..count], values: &values[..count] }
    }

    /// The names alone, in order.
    pub fn names(&self) -> &'a [Name] {
        self.names
    }

    /// The values alone, in order. [`Value::Missing`] is a cell without a new value.
    pub fn values(&self) -> &'a [Value] {
        self.values
    }

    /// The first value of that name.
    pub fn get(&self, name: &str) -> Option<&'a Value> {
        self.iter().find(|(n, _)| ***n == *name).map(|(_, value)| value)
    }

    /// All, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (&'a Name, &'a Value)> + use<'a> {
        self.names.iter().zip(self.values)
    }
}
