//! What Lapwing says on the graph itself: `/diagnostics`, as every ROS tool reads it, and its own `~/verdicts`.

use lapwing_check::checked;
use lapwing_record::RawChannel;
use lapwing_ros::connector::{Connector, Encoding, PublisherId};
use lapwing_stream::{Name, Time, Value};

use super::reactions::{encoded, encoder};
use super::view::{PropertyView, View};
use lapwing_record::Encoder;

/// Where diagnostics go.
pub(crate) const DIAGNOSTICS: &str = "/diagnostics";

/// So often they are published, in nanoseconds: what aggregators expect.
const EVERY: i64 = 1_000_000_000;

/// Publishes how things stand.
pub(crate) struct Herald {
    diagnostics: (PublisherId, Encoder),
    verdicts: (PublisherId, Encoder),
    last: Option<Time>,
}

impl Herald {
    /// Makes the publishers. An error says why nothing will be said; `node` is the name of the node.
    pub fn new(node: &str, connector: &mut dyn Connector) -> Result<Herald, String> {
        let mut publish = |topic: &str, type_name: &str| -> Result<(PublisherId, Encoder), String> {
            let message = checked::Message {
                to: topic.to_owned(),
                type_name: type_name.to_owned(),
                written: type_name.to_owned(),
                value: Value::Missing,
            };
            let (channel, _): (RawChannel, _) = encoded(&message, connector)?;
            let publisher = connector.advertise(&channel, false).map_err(|e| e.to_string())?;
            let text = String::from_utf8_lossy(&channel.definition).into_owned();
            Ok((publisher, encoder(type_name, &text, connector.encoding())?))
        };
        Ok(Herald {
            diagnostics: publish(DIAGNOSTICS, "diagnostic_msgs/DiagnosticArray")?,
            verdicts: publish(&format!("/{}/verdicts", node.trim_matches('/')), "std_msgs/String")?,
            last: None,
        })
    }

    /// Whether diagnostics are due.
    pub fn is_due(&self, now: Time) -> bool {
        self.last.is_none_or(|last| now.since(last).nanos() >= EVERY)
    }

    /// Publishes how things stand.
    pub fn tell(&mut self, view: &View, now: Time, connector: &mut dyn Connector) -> Result<(), String> {
        self.last = Some(now);
        let is_ros1 = connector.encoding() == Encoding::Ros1;
        let status = view.properties.iter().map(|property| status(property, &view.source)).collect();
        let message =
            record([("header", record([("stamp", stamp(view.now, is_ros1))])), ("status", Value::List(status))]);
        let (publisher, encoder) = &self.diagnostics;
        let payload = encoder.encode(&message).map_err(|e| e.to_string())?;
        connector.publish(*publisher, &payload).map_err(|e| e.to_string())
    }

    /// Publishes a line of JSON about what happened.
    pub fn say(&mut self, line: &str, connector: &mut dyn Connector) -> Result<(), String> {
        let (publisher, encoder) = &self.verdicts;
        let payload = encoder.encode(&record([("data", line.trim_end().into())])).map_err(|e| e.to_string())?;
        connector.publish(*publisher, &payload).map_err(|e| e.to_string())
    }
}

/// A `diagnostic_msgs/DiagnosticStatus` of a property.
fn status(property: &PropertyView, source: &str) -> Value {
    let (level, message) = property.diagnosis();
    let pair = |key: &str, value: String| record([("key", key.into()), ("value", Value::Str(value))]);
    let mut values = vec![
        pair("property", property.text.clone()),
        pair("place", format!("{}:{}", property.file, property.line)),
        pair("violations", property.violations.to_string()),
    ];
    values.extend(property.margin.map(|margin| pair("margin", margin.to_string())));
    values.extend(property.values.iter().map(|r| pair(&r.name, lapwing_react::shown::value(&r.value))));
    record([
        ("level", Value::Num(f64::from(level))),
        ("name", Value::Str(format!("lapwing: {}", property.name))),
        ("message", Value::Str(message)),
        ("hardware_id", source.into()),
        ("values", Value::List(values)),
    ])
}

fn stamp(at: Time, is_ros1: bool) -> Value {
    let (seconds, nanos) = (at.0.div_euclid(1_000_000_000) as f64, at.0.rem_euclid(1_000_000_000) as f64);
    let [first, second] = if is_ros1 { ["secs", "nsecs"] } else { ["sec", "nanosec"] };
    record([(first, Value::Num(seconds)), (second, Value::Num(nanos))])
}

fn record<const N: usize>(fields: [(&str, Value); N]) -> Value {
    Value::Record(fields.into_iter().map(|(name, value)| (Name::from(name), value)).collect())
}
