//! A value as a message, a row or an event carries it.

use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

/// A name that many values share: that of a field.
pub type Name = Arc<str>;

/// One value. Every number is a double: integers of 64 bits are rounded to the nearest.
///
/// [`Clone::clone_from`] reuses the buffers that the target already has, so that a value of the same shape is stored without
/// allocating: the engine's promise rests on it.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// No value: an empty CSV cell, a field that the message lacks. What was there before stays.
    #[default]
    Missing,
    /// True or false.
    Bool(bool),
    /// A number.
    Num(f64),
    /// A text.
    Str(String),
    /// An array of numbers.
    Nums(Vec<f64>),
    /// An array of anything else.
    List(Vec<Value>),
    /// A message or a JSON object: its fields in order.
    Record(Vec<(Name, Value)>),
}

impl Value {
    /// The field of a record, where it has one of that name.
    pub fn field(&self, name: &str) -> Option<&Value> {
        match self {
            Value::Record(fields) => fields.iter().find(|(n, _)| &**n == name).map(|(_, v)| v),
            _ => None,
        }
    }

    /// What kind of value this is, in the words of a report.
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Missing => "nothing",
            Value::Bool(_) => "a boolean",
            Value::Num(_) => "a number",
            Value::Str(_) => "a text",
            Value::Nums(_) | Value::List(_) => "an array",
            Value::Record(_) => "a message",
        }
    }
}

impl Clone for Value {
    fn clone(&self) -> Value {
        match self {
            Value::Missing => Value::Missing,
            Value::Bool(b) => Value::Bool(*b),
            Value::Num(x) => Value::Num(*x),
            Value::Str(s) => Value::Str(s.clone()),
            Value::Nums(v) => Value::Nums(v.clone()),
            Value::List(v) => Value::List(v.clone()),
            Value::Record(v) => Value::Record(v.clone()),
        }
    }

    #[inline]
    fn clone_from(&mut self, source: &Value) {
        match (&mut *self, source) {
            // PERF: scalars of the same kind first; they are nearly all there is.
            (Value::Bool(to), Value::Bool(from)) => *to = *from,
            (Value::Num(to), Value::Num(from)) => *to = *from,
            _ => self.clone_buffers_from(source),
        }
    }
}

impl Value {
    fn clone_buffers_from(&mut self, source: &Value) {
        match (&mut *self, source) {
            (Value::Str(to), Value::Str(from)) => to.clone_from(from),
            (Value::Nums(to), Value::Nums(from)) => to.clone_from(from),
            (Value::List(to), Value::List(from)) => to.clone_from(from),
            (Value::Record(to), Value::Record(from)) => {
                to.truncate(from.len());
                for ((name, value), (n, v)) in to.iter_mut().zip(from) {
                    name.clone_from(n);
                    value.clone_from(v);
                }
                let have = to.len();
                to.extend(from[have..].iter().cloned());
            }
            (to, from) => *to = from.clone(),
        }
    }
}

impl From<f64> for Value {
    fn from(x: f64) -> Value {
        Value::Num(x)
    }
}

impl From<bool> for Value {
    fn from(b: bool) -> Value {
        Value::Bool(b)
    }
}

impl From<&str> for Value {
    fn from(s: &str) -> Value {
        Value::Str(s.into())
    }
}
