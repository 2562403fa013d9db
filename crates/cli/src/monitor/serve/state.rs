//! How things stand, as JSON for the page.

use lapwing::live::{PropertyView, View};
use lapwing_react::Role;
use lapwing_react::shown::cell;
use serde_json::{Value, json};

/// How things stand, with what happened last: lines of JSON.
pub fn json<'e>(view: &View, events: impl Iterator<Item = &'e str>) -> String {
    let events: Vec<Value> = events.filter_map(|line| serde_json::from_str(line).ok()).collect();
    let topics = view.topics.iter().map(|topic| {
        json!({
            "name": topic.name, "type": topic.type_name, "messages": topic.messages, "rate": topic.rate,
            "publishers": topic.publishers, "causes": topic.causes,
        })
    });
    let judged = &view.figures.judged;
    let ms = |share: f64| judged.quantile(share).map(|d| d.as_secs_f64() * 1e3);
    json!({
        "source": view.source,
        "began_ns": view.began.0,
        "now_ns": view.now.0,
        "properties": view.properties.iter().map(property).collect::<Vec<_>>(),
        "topics": topics.collect::<Vec<_>>(),
        "messages": view.figures.messages,
        "lost": view.figures.lost,
        "latency_ms": { "p50": ms(0.5), "p99": ms(0.99) },
        "events": events,
    })
    .to_string()
}

fn property(property: &PropertyView) -> Value {
    let values = property.values.iter().filter(|r| r.role == Role::Value);
    json!({
        "name": property.name, "file": property.file, "line": property.line, "text": property.text,
        "state": property.state.word(), "cause": property.cause, "violations": property.violations,
        "latest_ns": property.latest.map(|at| at.0), "margin": property.margin.filter(|m| m.is_finite()),
        "values": values.map(|r| json!([r.name, cell(&r.value)])).collect::<Vec<_>>(),
    })
}
