//! Values by name: the cells of a row, the fields of an event.

use std::borrow::Cow;

use lapwing_stream::{Name, Value};

use crate::path::{Path, ways};

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

    /// The first value of exactly that name.
    pub fn get(&self, name: &str) -> Option<&'a Value> {
        self.iter().find(|(n, _)| ***n == *name).map(|(_, value)| value)
    }

    /// The signals in it: an object is its fields, by names with dots.
    pub fn signals(&self, each: &mut dyn FnMut(&str, &'a Value)) {
        self.iter().for_each(|(name, value)| fields(name, value, each));
    }

    /// All, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (&'a Name, &'a Value)> + use<'a> {
        self.names.iter().zip(self.values)
    }
}

/// The name of a signal, which may lead into the value of another name: `o.p.x` is the value of exactly that name, else `x` of `o.p`, else
/// `p.x` of `o`.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    name: Name,
    /// The other names that lead to it, and the ways from there.
    ways: Vec<(Name, Path)>,
}

impl Signal {
    /// The signal of that name.
    pub fn new(name: &str) -> Signal {
        let ways = ways(name).map(|(key, way)| (Name::from(key), way)).collect();
        Signal { name: name.into(), ways }
    }

    /// Its value in a row or an event.
    pub fn find_in<'a>(&self, cells: Cells<'a>) -> Option<Cow<'a, Value>> {
        let whole = cells.get(&self.name).map(Cow::Borrowed);
        whole.or_else(|| self.ways.iter().find_map(|(key, way)| way.find_in(cells.get(key)?)))
    }
}

/// A value, or the fields of an object. A reader has bounded how deep they lie.
pub(crate) fn fields<'a>(name: &str, value: &'a Value, each: &mut dyn FnMut(&str, &'a Value)) {
    match value {
        Value::Record(inner) if !inner.is_empty() => {
            inner.iter().for_each(|(field, value)| fields(&format!("{name}.{field}"), value, each));
        }
        value => each(name, value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_key_goes_before() {
        let record = |x: f64| Value::Record(vec![("x".into(), Value::Num(x)), ("y".into(), Value::Nums(vec![x]))]);
        let names = ["o", "o.x", "p", "p"].map(Name::from);
        let values = [record(1.0), Value::Num(2.0), Value::Num(3.0), record(4.0)];
        let cells = Cells::new(&names, &values);
        let of = |name: &str| Signal::new(name).find_in(cells).map(Cow::into_owned);
        assert_eq!([of("o.x"), of("o.y[0]")], [Some(Value::Num(2.0)), Some(Value::Num(1.0))]);
        assert_eq!([of("p"), of("p.x"), of("o.z"), of("q.x")], [Some(Value::Num(3.0)), None, None, None]);
        let mut signals = Vec::new();
        cells.signals(&mut |name, _| signals.push(name.to_owned()));
        assert_eq!(signals, ["o.x", "o.y", "o.x", "p", "p.x", "p.y"]);
    }
}
