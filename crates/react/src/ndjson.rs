//! What happens, as lines of JSON.

use serde_json::{Map, Value, json};

use crate::event::Event;
use crate::json;
use crate::report::{Property, Report};

/// What happened with the recording `trace`, as one line with its newline.
pub fn line(trace: &str, event: Event<'_>) -> String {
    let mut object = Map::new();
    object.insert("type".to_owned(), json!(kind(event)));
    if let Event::Start(report) = event {
        extend(&mut object, only(json::report(report), &["lapwing", "spec"]));
    }
    object.insert("trace".to_owned(), json!(trace));
    extend(&mut object, content(event));
    format!("{}\n", Value::Object(object))
}

fn kind(event: Event<'_>) -> &'static str {
    match event {
        Event::Start(_) => "start",
        Event::Violation { .. } => "violation",
        Event::Warning(_) => "warning",
        Event::Verdict(_) => "verdict",
        Event::End(_) => "end",
    }
}

fn content(event: Event<'_>) -> Value {
    match event {
        Event::Start(report) => start(report),
        Event::Violation { property, violation } => {
            let mut object = identity(property);
            extend(&mut object, json::violation(violation));
            Value::Object(object)
        }
        Event::Warning(warning) => json::warning(warning),
        Event::Verdict(property) => json::property(property),
        Event::End(report) => only(json::report(report), &["start_ns", "end_ns", "instants", "topics", "gaps"]),
    }
}

/// What is known at the start: the counts of messages are not.
fn start(report: &Report) -> Value {
    let topics = report.topics.iter().map(|t| only(json::topic(t), &["name", "type"])).collect::<Vec<_>>();
    let properties = report.properties.iter().map(|p| Value::Object(identity(p))).collect::<Vec<_>>();
    json!({ "topics": topics, "properties": properties })
}

/// What tells a property from others.
fn identity(property: &Property) -> Map<String, Value> {
    match only(json::property(property), &["name", "file", "line", "text"]) {
        Value::Object(object) => object,
        _ => Map::new(),
    }
}

/// Some of the keys of an object.
fn only(object: Value, keys: &[&str]) -> Value {
    match object {
        Value::Object(object) => {
            Value::Object(object.into_iter().filter(|(k, _)| keys.contains(&k.as_str())).collect())
        }
        other => other,
    }
}

fn extend(object: &mut Map<String, Value>, with: Value) {
    if let Value::Object(with) = with {
        object.extend(with);
    }
}
