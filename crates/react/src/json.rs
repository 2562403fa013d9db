//! Reports as JSON. Names and order of the keys are a contract: others read them.

use lapwing_stream::Value as Sampled;
use serde_json::{Map, Value, json};

use crate::report::{Property, Reading, Report, Row, Topic, Violation, Warning};

/// The version of the format.
const VERSION: u32 = 1;

/// A report as an object.
pub(crate) fn report(report: &Report) -> Value {
    json!({
        "lapwing": VERSION,
        "spec": report.specs,
        "trace": report.trace,
        "start_ns": report.span.map(|(start, _)| start.0),
        "end_ns": report.span.map(|(_, end)| end.0),
        "instants": report.instants,
        "topics": report.topics.iter().map(topic).collect::<Vec<_>>(),
        "properties": report.properties.iter().map(property).collect::<Vec<_>>(),
        "warnings": report.warnings.iter().map(warning).collect::<Vec<_>>(),
        "gaps": report.gaps,
    })
}

/// The object of a property.
pub(crate) fn property(property: &Property) -> Value {
    let obligations = property.obligations;
    json!({
        "name": property.name,
        "file": property.file,
        "line": property.line,
        "text": property.text,
        "verdict": property.verdict.word(),
        "cause": property.cause,
        "vacuous": property.vacuous,
        "obligations": { "met": obligations.met, "failed": obligations.failed, "open": obligations.open },
        "margin": property.margin.map(number),
        "violations": property.violations.iter().map(violation).collect::<Vec<_>>(),
        "nans": property.nans,
    })
}

/// The object of a violation.
pub(crate) fn violation(violation: &Violation) -> Value {
    let mut object = json!({
        "began_ns": violation.began.0,
        "failed_ns": violation.failed.0,
        "until_ns": violation.until.0,
        "count": violation.count,
        "values": violation.values.as_deref().map(readings),
        "began_values": violation.began_values.as_deref().map(readings),
    });
    if let Some(object) = object.as_object_mut() {
        if let Some(values) = violation.values.as_deref().filter(|_| !violation.history.is_empty()) {
            let rows = violation.history.iter().map(|row| history(values, row)).collect();
            object.insert("history".to_owned(), Value::Array(rows));
        }
        object.extend(violation.why.iter().map(|why| ("why".to_owned(), json!(why))));
    }
    object
}

/// The values at a moment before a violation, under the names that they have at the violation.
fn history(names: &[Reading], row: &Row) -> Value {
    let values = names.iter().zip(&row.values).map(|(r, v)| (r.name.clone(), value(v)));
    json!({ "time_ns": row.time.0, "values": Value::Object(values.collect::<Map<_, _>>()) })
}

/// The object of a topic.
pub(crate) fn topic(topic: &Topic) -> Value {
    json!({ "name": topic.name, "type": topic.type_name, "messages": topic.messages, "unseen": topic.unseen })
}

/// The object of a warning.
pub(crate) fn warning(warning: &Warning) -> Value {
    let place = warning.place.as_ref();
    let mut object = json!({
        "code": warning.code,
        "message": warning.message,
        "file": place.map(|(file, ..)| file),
        "line": place.map(|(_, line, _)| line),
    });
    if let (Some(object), Some(at)) = (object.as_object_mut(), warning.at) {
        object.insert("time_ns".to_owned(), json!(at.0));
    }
    object
}

fn readings(readings: &[Reading]) -> Value {
    let entries = readings.iter().map(|r| (r.name.clone(), value(&r.value)));
    Value::Object(entries.collect::<Map<_, _>>())
}

/// A value as it was sampled.
fn value(sampled: &Sampled) -> Value {
    match sampled {
        Sampled::Missing => Value::Null,
        Sampled::Bool(b) => json!(b),
        Sampled::Num(x) => number(*x),
        Sampled::Str(s) => json!(s),
        Sampled::Nums(xs) => xs.iter().map(|x| number(*x)).collect(),
        Sampled::List(xs) => xs.iter().map(value).collect(),
        Sampled::Record(fields) => Value::Object(fields.iter().map(|(n, v)| (n.to_string(), value(v))).collect()),
    }
}

/// A number; JSON has none for NaN and the infinities, so they are strings, spelt as Protobuf's JSON spells them.
pub(crate) fn number(x: f64) -> Value {
    match x {
        x if x.is_nan() => json!("NaN"),
        f64::INFINITY => json!("Infinity"),
        f64::NEG_INFINITY => json!("-Infinity"),
        x => json!(x),
    }
}
