//! The log of a match: what the robot's program said, in order, and what was violated meanwhile. It can be written as NDJSON or as
//! MCAP, both of which `lapwing check` reads.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{Seek, Write};
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

/// What is written of an entry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Line {
    /// Signals got values: a JSON object of them.
    Values(String),
    /// An event, and a JSON object of its fields.
    Event(String, String),
}

/// What is written of a log, with the times: fields are signals, calls and returns are the events that the specification declares, and what was violated
/// meanwhile is an event `violated`, which no specification reads.
pub fn lines<'a>(entries: &'a [Entry], spec: &'a checked::Spec) -> impl Iterator<Item = (i64, Line)> + 'a {
    entries.iter().flat_map(move |Entry { time, what }| {
        let own = match what {
            What::Set(fields) => {
                let values: Vec<String> =
                    fields.iter().map(|(name, value)| format!("\"{name}\":{}", json(value))).collect();
                Some(Line::Values(format!("{{{}}}", values.join(","))))
            }
            What::Violation(property) => {
                Some(Line::Event("violated".to_owned(), format!("{{\"property\":\"{property}\"}}")))
            }
            What::Call(_) | What::Return(..) => None,
        };
        let events = what.events(spec).map(|(event, result)| {
            let name = spec.events.get(event).map_or("", |e| e.name.as_str());
            let result = result.map(|result| format!("\"result\":{result}")).unwrap_or_default();
            Line::Event(name.to_owned(), format!("{{{result}}}"))
        });
        own.into_iter().chain(events).map(|line| (*time, line))
    })
}

/// The log as NDJSON.
pub fn ndjson(entries: &[Entry], spec: &checked::Spec) -> String {
    let mut text = String::new();
    for (time, line) in lines(entries, spec) {
        // Writing to a text does not fail.
        let _ = match line {
            Line::Values(values) => writeln!(text, "{{\"t_ns\":{time},\"values\":{values}}}"),
            Line::Event(name, fields) if fields == "{}" => writeln!(text, "{{\"t_ns\":{time},\"event\":\"{name}\"}}"),
            Line::Event(name, fields) => writeln!(text, "{{\"t_ns\":{time},\"event\":\"{name}\",{}", &fields[1..]),
        };
    }
    text
}

/// The log as MCAP: what NDJSON has as lines are messages of JSON, on the topics that `lapwing check` reads as such, and that viewers can plot.
pub fn mcap(entries: &[Entry], spec: &checked::Spec, to: impl Write + Seek) -> mcap::McapResult<()> {
    let mut writer = mcap::WriteOptions::new().library("soccer").create(to)?;
    let mut channels: BTreeMap<String, u16> = BTreeMap::new();
    for (sequence, (time, line)) in (0_u32..).zip(lines(entries, spec)) {
        let (topic, data) = match line {
            Line::Values(values) => ("/lapwing/rows".to_owned(), values),
            Line::Event(name, fields) => (format!("/lapwing/events/{name}"), fields),
        };
        let channel_id = match channels.get(&topic) {
            Some(known) => *known,
            None => {
                let schema = writer.add_schema(&topic, "jsonschema", b"{\"type\":\"object\"}")?;
                let added = writer.add_channel(schema, &topic, "json", &BTreeMap::new())?;
                *channels.entry(topic).or_insert(added)
            }
        };
        let log_time = time.unsigned_abs();
        let header = mcap::records::MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, data.as_bytes())?;
    }
    writer.finish().map(|_| ())
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
