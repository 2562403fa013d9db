//! The instances that `for each` makes of a property: what they are called, and what tells them apart.

use lapwing_stream::Value;

/// What tells an instance from all others.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Instance {
    property: usize,
    suffix: String,
}

impl Instance {
    /// The instance of a property with those values of its slices.
    pub fn of(property: usize, values: &[Value]) -> Instance {
        Instance { property, suffix: suffix(values) }
    }

    /// The same, as the engine tells of it while it runs.
    pub fn running(property: usize, values: &[Option<Value>]) -> Instance {
        Instance { property, suffix: suffix(values.iter().flatten()) }
    }
}

/// What an instance is called: the name of the property, and the values of its slices.
pub(crate) fn name(property: &str, values: &[Value]) -> String {
    property.to_owned() + &suffix(values)
}

fn suffix<'v>(values: impl IntoIterator<Item = &'v Value>) -> String {
    let part = |value: &Value| match value {
        Value::Str(s) => format!("[{s}]"),
        Value::Num(x) => format!("[{x}]"),
        Value::Bool(b) => format!("[{b}]"),
        other => format!("[{}]", other.kind()),
    };
    values.into_iter().map(part).collect()
}
