//! The values of variables, and their types.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// A value.
#[derive(Clone, Debug, Default)]
pub enum Value {
    /// Of a variable of an external type to which nothing has been assigned yet.
    #[default]
    Unset,
    /// `bool`
    Bool(bool),
    /// `int`: 64 bits.
    Int(i64),
    /// `float`: a double.
    Float(f64),
    /// `string`
    Text(Arc<str>),
    /// Of an external type: what it is only the host knows.
    Opaque(Opaque),
}

/// Something of the host's that a model passes around.
#[derive(Clone)]
pub struct Opaque(pub Arc<dyn Any + Send + Sync>);

impl fmt::Debug for Opaque {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Opaque")
    }
}

impl Value {
    /// A value of the host's own kind.
    pub fn opaque<T: Any + Send + Sync>(value: T) -> Value {
        Value::Opaque(Opaque(Arc::new(value)))
    }

    /// What [`Value::opaque`] was given.
    pub fn as_opaque<T: Any>(&self) -> Option<&T> {
        match self {
            Value::Opaque(Opaque(any)) => any.downcast_ref(),
            _ => None,
        }
    }

    /// The number, of an `int`.
    pub fn as_int(&self) -> Option<i64> {
        match self {
            Value::Int(value) => Some(*value),
            _ => None,
        }
    }

    /// The number, of a `float` or an `int`.
    pub fn as_float(&self) -> Option<f64> {
        match self {
            Value::Float(value) => Some(*value),
            Value::Int(value) => Some(*value as f64),
            _ => None,
        }
    }

    /// The truth value, of a `bool`.
    pub fn as_bool(&self) -> Option<bool> {
        match self {
            Value::Bool(value) => Some(*value),
            _ => None,
        }
    }

    /// The text, of a `string`.
    pub fn as_text(&self) -> Option<&str> {
        match self {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Unset => f.write_str("?"),
            Value::Bool(value) => value.fmt(f),
            Value::Int(value) => value.fmt(f),
            Value::Float(value) => value.fmt(f),
            Value::Text(text) => f.write_str(text),
            Value::Opaque(_) => f.write_str("…"),
        }
    }
}

impl PartialEq for Value {
    /// Values of the host are equal where they are one and the same.
    fn eq(&self, other: &Value) -> bool {
        match (self, other) {
            (Value::Unset, Value::Unset) => true,
            (Value::Bool(a), Value::Bool(b)) => a == b,
            (Value::Int(a), Value::Int(b)) => a == b,
            (Value::Float(a), Value::Float(b)) => a == b,
            (Value::Text(a), Value::Text(b)) => a == b,
            (Value::Opaque(a), Value::Opaque(b)) => Arc::ptr_eq(&a.0, &b.0),
            _ => false,
        }
    }
}

/// The type of a variable.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, PartialOrd, Ord)]
pub enum Type {
    /// `bool`
    Bool,
    /// `int`
    Int,
    /// `float`
    Float,
    /// `string`
    Text,
    /// The external type of that number in [`crate::Model::extern_types`].
    Extern(u32),
}

impl Type {
    /// The value of a variable that is given none.
    pub fn zero(self) -> Value {
        match self {
            Type::Bool => Value::Bool(false),
            Type::Int => Value::Int(0),
            Type::Float => Value::Float(0.0),
            Type::Text => Value::Text("".into()),
            Type::Extern(_) => Value::Unset,
        }
    }

    /// Whether values of the type live in the plain cells of a [`crate::code::Memory`], not among its objects.
    pub(crate) fn is_plain(self) -> bool {
        matches!(self, Type::Bool | Type::Int | Type::Float)
    }
}
