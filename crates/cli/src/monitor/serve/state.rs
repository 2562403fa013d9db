//! How things stand and went lately, as JSON for the page.

use lapwing::live::{PropertyView, View};
use lapwing_react::Role;
use lapwing_react::shown::cell;
use lapwing_stream::Time;
use serde_json::{Map, Value, json};

use super::board::Posted;
use super::past::{Id, Layout, Line, Past, Point, REACH, origin, seconds};

/// What is new since a revision of a run; everything, where that is not known here any more.
pub fn json(posted: &Posted, known: Option<(u64, u64)>) -> String {
    let (past, view) = (&posted.past, &posted.view);
    let since = known.filter(|(run, since)| *run == past.run && *since <= past.revision).map_or(0, |(_, since)| since);
    let origin = origin(view);
    let mut state = head(view, past, origin);
    state["since"] = json!(since);
    state["properties"] = properties(view, past, since, origin);
    state["tracks"] = tracks(past, since, origin);
    let events = posted.events.iter().filter(|(revision, _)| *revision > since);
    state["events"] = events.map(|(_, event)| placed(event, origin)).collect();
    state.to_string()
}

fn head(view: &View, past: &Past, origin: Time) -> Value {
    let topics = view.topics.iter().map(|topic| {
        json!({
            "name": topic.name, "type": topic.type_name, "messages": topic.messages, "rate": topic.rate,
            "publishers": topic.publishers, "causes": topic.causes,
        })
    });
    let judged = &view.figures.judged;
    let ms = |share: f64| judged.quantile(share).map(|d| d.as_secs_f64() * 1e3);
    json!({
        "run": past.run,
        "revision": past.revision,
        "source": view.source,
        "origin_ns": origin.0,
        "began_ns": view.began.0,
        "now_ns": view.now.0,
        "now": seconds(view.now, origin),
        "began": seconds(view.began, origin),
        "reach": REACH as f64 / 1e9,
        "topics": topics.collect::<Vec<_>>(),
        "messages": view.figures.messages,
        "lost": view.figures.lost,
        "latency_ms": { "p50": ms(0.5), "p99": ms(0.99) },
    })
}

/// The properties; what does not change of them is told once.
fn properties(view: &View, past: &Past, since: u64, origin: Time) -> Value {
    let is_new = since < past.laid_out;
    let all = view.properties.iter().enumerate().map(|(number, property)| {
        let changes = past.lanes.get(number).into_iter().flat_map(|lane| &lane.changes);
        let changes = changes.filter(|(revision, ..)| *revision > since);
        let mut object = now(property);
        object["changes"] = changes.map(|(_, at, kind)| json!([seconds(*at, origin), kind])).collect();
        let diagram = past.lanes.get(number).and_then(|lane| lane.diagram.as_ref());
        if let Some((_, graph)) = diagram.filter(|(revision, _)| is_new || *revision > since) {
            object["diagram"] = json!(lapwing_page::diagram(graph, number));
        }
        if let (true, Value::Object(object)) = (is_new, &mut object) {
            object.extend(fixed(property, past.layout().get(number)));
        }
        object
    });
    all.collect()
}

fn now(property: &PropertyView) -> Value {
    let values = property.values.iter().filter(|r| r.role == Role::Value);
    json!({
        "state": property.state.word(), "cause": property.cause, "violations": property.violations,
        "latest_ns": property.latest.map(|at| at.0), "margin": property.margin.filter(|m| m.is_finite()),
        "values": values.map(|r| json!([r.name, cell(&r.value)])).collect::<Vec<_>>(),
    })
}

fn fixed(property: &PropertyView, layout: Option<&Layout>) -> Map<String, Value> {
    let mut object = Map::new();
    object.insert("name".to_owned(), json!(property.name));
    object.insert("file".to_owned(), json!(property.file));
    object.insert("line".to_owned(), json!(property.line));
    object.insert("text".to_owned(), json!(property.text));
    let ids = |ids: &[Id]| ids.iter().map(|id| name(*id)).collect::<Vec<_>>();
    let plots = layout.into_iter().flat_map(|layout| &layout.plots).map(|(tracks, limits)| {
        let limits: Vec<Value> = limits.iter().map(|limit| json!([limit.value, limit.text])).collect();
        json!({ "tracks": ids(tracks), "limits": limits })
    });
    object.insert("plots".to_owned(), plots.collect());
    object.insert("lanes".to_owned(), json!(layout.map(|layout| ids(&layout.lanes)).unwrap_or_default()));
    object
}

/// What is new of the signals; of one of which nothing is new there is nothing.
fn tracks(past: &Past, since: u64, origin: Time) -> Value {
    let fresh = past.tracks.iter().filter_map(|(id, line)| {
        let points = line.points.iter().filter(|(revision, ..)| *revision > since);
        let points: Vec<Value> = points.map(|(_, at, point)| json!([seconds(*at, origin), value(point)])).collect();
        (!points.is_empty())
            .then(|| (name(*id), json!({ "name": line.name, "unit": line.unit, "kind": kind(line), "points": points })))
    });
    Value::Object(fresh.collect())
}

fn name((spec, monitor, track): Id) -> String {
    format!("{spec}.{monitor}.{track}")
}

fn kind(line: &Line) -> &'static str {
    match line.points.back() {
        Some((_, _, Point::State(_))) => "steps",
        Some((_, _, Point::Tick)) => "ticks",
        Some((_, _, Point::Number(_))) | None => "curve",
    }
}

fn value(point: &Point) -> Value {
    match point {
        // A gap is null, as JSON has no NaN.
        Point::Number(x) => json!(x),
        Point::State(state) => json!(state),
        Point::Tick => json!(true),
    }
}

/// An event with its time in seconds: JavaScript's numbers do not hold a calendar's nanoseconds.
fn placed(event: &Value, origin: Time) -> Value {
    let mut event = event.clone();
    for (ns, at) in [("failed_ns", "failed"), ("began_ns", "began"), ("time_ns", "at")] {
        if let Some(time) = event.get(ns).and_then(Value::as_i64) {
            event[at] = json!(seconds(Time(time), origin));
        }
    }
    event
}
