//! The log of a match: what the robot's program said, in order, and what was violated meanwhile. It can be written as NDJSON, which
//! `lapwing check` reads.

use std::fmt::Write as _;
use std::sync::{Arc, Mutex, PoisonError};

use lapwing_check::checked::{self, EventSource, PointKind};
use lapwing_stream::Value;

/// Something in the log.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// When, in nanoseconds since the kickoff.
    pub time: i64,
    /// What.
    pub what: What,
}

/// What the log has.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// A function was called.
    Call(String),
    /// A function returned, with that result where it has one.
    Return(String, Option<bool>),
    /// Fields got values.
    Set(Vec<(&'static str, Value)>),
    /// A property was violated.
    Violation(String),
}

/// A log that several can write to.
#[derive(Clone, Debug, Default)]
pub struct Log(Arc<Mutex<Vec<Entry>>>);

impl Log {
    /// Adds an entry.
    pub fn add(&self, time: i64, what: What) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(Entry { time, what });
    }

    /// What is in it so far.
    pub fn entries(&self) -> Vec<Entry> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl What {
    /// The events of a specification that this may be, by their numbers, with the value of the field `result`.
    pub fn events<'a>(&'a self, spec: &'a checked::Spec) -> impl Iterator<Item = (usize, Option<bool>)> + 'a {
        let (kind, name, result) = match self {
            What::Call(name) => (PointKind::Call, name.as_str(), None),
            What::Return(name, result) => (PointKind::Return, name.as_str(), *result),
            What::Set(_) | What::Violation(_) => (PointKind::Set, "", None),
        };
        let is_meant = move |event: &checked::Event| match &event.source {
            EventSource::Point(point) => point.kind == kind && point.path.join("::") == name,
            _ => false,
        };
        spec.events.iter().enumerate().filter(move |(_, e)| is_meant(e)).map(move |(number, _)| (number, result))
    }
}

/// The log as NDJSON: fields are signals, calls and returns are the events that the specification declares, and what was violated meanwhile is an
/// event `violated`, which no specification reads.
pub fn ndjson(entries: &[Entry], spec: &checked::Spec) -> String {
    let mut text = String::new();
    for Entry { time, what } in entries {
        // Writing to a text does not fail.
        if let What::Set(fields) = what {
            let values: Vec<String> =
                fields.iter().map(|(name, value)| format!("\"{name}\":{}", json(value))).collect();
            let _ = writeln!(text, "{{\"t_ns\":{time},\"values\":{{{}}}}}", values.join(","));
        }
        if let What::Violation(property) = what {
            let _ = writeln!(text, "{{\"t_ns\":{time},\"event\":\"violated\",\"property\":\"{property}\"}}");
        }
        for (event, result) in what.events(spec) {
            let name = spec.events.get(event).map_or("", |e| e.name.as_str());
            let result = result.map(|result| format!(",\"result\":{result}")).unwrap_or_default();
            let _ = writeln!(text, "{{\"t_ns\":{time},\"event\":\"{name}\"{result}}}");
        }
    }
    text
}

/// A value as Lapwing reads it: JSON, and the words for what is no number or infinite.
fn json(value: &Value) -> String {
    match value {
        Value::Bool(value) => value.to_string(),
        Value::Num(number) if number.is_nan() => "NaN".to_owned(),
        Value::Num(number) if number.is_infinite() => format!("{}Infinity", if *number < 0.0 { "-" } else { "" }),
        Value::Num(number) => number.to_string(),
        _ => "null".to_owned(),
    }
}
