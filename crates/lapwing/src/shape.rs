//! What a recording carries, in the terms of the check.

use lapwing_check::{TraceShape, TraceTopic};
use lapwing_record::{Format, Recording};

/// The shape of an opened recording.
pub(crate) fn of(recording: &Recording) -> TraceShape {
    let topics = recording.topics().iter().map(|topic| TraceTopic {
        name: absolute(&topic.name),
        type_name: topic.type_name.clone(),
        schema: topic.schema.as_ref().ok().cloned(),
    });
    TraceShape {
        topics: topics.collect(),
        columns: recording.columns().iter().map(|c| c.to_string()).collect(),
        schemaless: recording.is_schemaless(),
        columns_open: recording.format() == Format::Ndjson,
        events: Vec::new(),
        live: false,
    }
}

/// A topic's name with its leading slash.
fn absolute(name: &str) -> String {
    if name.starts_with('/') { name.to_owned() } else { format!("/{name}") }
}
