//! What happens, for Foxglove and for whatever else speaks its WebSocket protocol: verdicts as they are found, diagnostics, and the signals that
//! properties read. All of it is JSON; clients subscribe to topics, and there is nothing else that they can do.

use std::collections::{BTreeMap, BTreeSet};
use std::net::SocketAddr;
use std::sync::Arc;

use foxglove::{Context, FoxgloveError, PartialMetadata, RawChannel, Schema, WebSocketServerHandle};
use lapwing::live::{PropertyView, TrackView, View};
use lapwing_react::history::Shape;
use lapwing_react::{Event, Role};
use lapwing_stream::Time;
use serde_json::{Value, json};

use super::audience::Audience;
use super::serve::address;
use crate::complain::Complaint;

/// So many signals have a topic.
const MOST_SIGNALS: usize = 200;

/// So many messages wait for a client that does not keep up; then the oldest are dropped.
const BACKLOG: usize = 1024;

/// Diagnostics once a second, as on a graph, in nanoseconds.
const EVERY: i64 = 1_000_000_000;

/// The schema of anything: which keys there are depends on the kind of event.
const ANY: &str = "{\"type\":\"object\"}";

/// That of the message which diagnostics panels know.
const DIAGNOSTICS: &str = r#"{"type":"object","properties":{
"header":{"type":"object","properties":{"stamp":{"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}}}},
"status":{"type":"array","items":{"type":"object","properties":{"level":{"type":"integer"},"name":{"type":"string"},"message":{"type":"string"},
"hardware_id":{"type":"string"},"values":{"type":"array","items":{"type":"object","properties":{"key":{"type":"string"},"value":{"type":"string"}}}}}}}}}"#;

/// A signal: a number, a state, or that something happened.
const SIGNAL: &str = r#"{"type":"object","properties":{"value":{"type":"number"},"state":{"type":"string"},"happened":{"type":"boolean"}}}"#;

/// Shows what happens to the clients of a WebSocket server.
pub struct Foxglove {
    context: Arc<Context>,
    server: WebSocketServerHandle,
    address: SocketAddr,
    verdicts: Arc<RawChannel>,
    diagnostics: Arc<RawChannel>,
    signals: BTreeMap<(usize, usize, usize), Arc<RawChannel>>,
    topics: BTreeSet<String>,
    /// What time it was when somebody looked last, and when diagnostics were sent.
    now: Time,
    told: Option<Time>,
}

impl Foxglove {
    /// Serves at a port of this machine, or at an address.
    pub fn start(at: &str) -> Result<Foxglove, Complaint> {
        let wrong = |why: String| {
            Complaint::new(format!("--foxglove {at}: {why}"))
                .help("write a port (8765), or an address and a port (127.0.0.1:8765)")
        };
        let address = address(at).map_err(wrong)?;
        let context = Context::new();
        let make = || -> Result<_, FoxgloveError> {
            let verdicts = channel(&context, "/lapwing/verdicts", "lapwing.Event", ANY)?;
            let diagnostics = channel(&context, "/diagnostics", "diagnostic_msgs/DiagnosticArray", DIAGNOSTICS)?;
            let server = context.websocket_server().name("Lapwing").message_backlog_size(BACKLOG);
            let server = server.bind(address.ip().to_string(), address.port()).start_blocking()?;
            Ok((verdicts, diagnostics, server))
        };
        let (verdicts, diagnostics, server) = make().map_err(|e| wrong(e.to_string()))?;
        Ok(Foxglove {
            address: SocketAddr::new(address.ip(), server.port()),
            context,
            server,
            verdicts,
            diagnostics,
            signals: BTreeMap::new(),
            topics: BTreeSet::new(),
            now: Time(0),
            told: None,
        })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    fn signal(&mut self, fresh: &TrackView) {
        if !self.signals.contains_key(&fresh.id) {
            if self.signals.len() >= MOST_SIGNALS {
                return;
            }
            let topic = self.topic(&fresh.track.name, fresh.id);
            let Ok(made) = channel(&self.context, &topic, "lapwing.Signal", SIGNAL) else { return };
            self.topics.insert(topic);
            self.signals.insert(fresh.id, made);
        }
        let Some(channel) = self.signals.get(&fresh.id) else { return };
        match &fresh.track.shape {
            Shape::Curve(points) => points.iter().for_each(|(at, x)| send(channel, *at, &json!({ "value": x }))),
            Shape::Steps { changes, labels } => changes.iter().for_each(|(at, state)| {
                send(channel, *at, &json!({ "state": state.and_then(|n| labels.get(n)) }));
            }),
            Shape::Ticks(times) => times.iter().for_each(|at| send(channel, *at, &json!({ "happened": true }))),
        }
    }

    /// The topic of a signal. Where two specifications give two signals one name, the later has its number beside it.
    fn topic(&self, name: &str, (spec, monitor, track): (usize, usize, usize)) -> String {
        let plain = format!("/lapwing/signals/{name}");
        if self.topics.contains(&plain) { format!("{plain} ({spec}.{monitor}.{track})") } else { plain }
    }
}

impl Audience for Foxglove {
    fn begin(&mut self) {
        std::mem::take(&mut self.signals).values().for_each(|channel| channel.close());
        self.topics.clear();
        self.told = None;
        // What clients have is of another run.
        self.server.clear_session(None);
    }

    fn event(&mut self, event: Event<'_>, json: &str) {
        let at = match event {
            Event::Violation { violation, .. } => violation.failed,
            Event::Warning(warning) => warning.at.unwrap_or(self.now),
            Event::Start(_) | Event::Verdict(_) | Event::End(_) => self.now,
        };
        self.verdicts.log_with_meta(json.trim_end().as_bytes(), stamped(at));
    }

    fn look(&mut self, view: &View) {
        self.now = view.now;
        view.tracks.iter().for_each(|track| self.signal(track));
        if self.told.is_none_or(|told| view.now < told || view.now.since(told).nanos() >= EVERY) {
            self.told = Some(view.now);
            let status: Vec<Value> = view.properties.iter().map(|property| status(property, &view.source)).collect();
            let (sec, nsec) = (view.now.0.div_euclid(1_000_000_000), view.now.0.rem_euclid(1_000_000_000));
            let header = json!({ "stamp": { "sec": sec, "nsec": nsec } });
            send(&self.diagnostics, view.now, &json!({ "header": header, "status": status }));
        }
    }
}

fn channel(
    context: &Arc<Context>,
    topic: &str,
    name: &str,
    schema: &'static str,
) -> Result<Arc<RawChannel>, FoxgloveError> {
    let schema = Schema::new(name, "jsonschema", schema.as_bytes());
    context.channel_builder(topic).message_encoding("json").schema(schema).build_raw()
}

fn send(channel: &RawChannel, at: Time, message: &Value) {
    if channel.has_sinks() {
        channel.log_with_meta(message.to_string().as_bytes(), stamped(at));
    }
}

fn stamped(at: Time) -> PartialMetadata {
    PartialMetadata { log_time: Some(u64::try_from(at.0).unwrap_or_default()) }
}

/// How a property stands, as a `diagnostic_msgs/DiagnosticStatus`.
fn status(property: &PropertyView, source: &str) -> Value {
    let (level, message) = property.diagnosis();
    let values = property.values.iter().filter(|reading| reading.role == Role::Value);
    let values = values.map(|r| json!({ "key": r.name, "value": lapwing_react::shown::value(&r.value) }));
    json!({
        "level": level,
        "name": format!("lapwing: {}", property.name),
        "message": message,
        "hardware_id": source,
        "values": values.collect::<Vec<_>>(),
    })
}
