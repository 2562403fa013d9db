//! What a recording carries, in the terms of the check.

use std::path::Path;

use lapwing_check::{TraceShape, TraceTopic};
use lapwing_record::{Format, OpenError, Recording};

use crate::spec::Spec;

/// Opens a recording. It has to tell all of its topics beforehand where a property stands for each of them.
pub(crate) fn open(specs: &[Spec], trace: &Path, how: &lapwing_record::Options) -> Result<Recording, OpenError> {
    let mut how = how.clone();
    if specs.iter().any(Spec::runs_over_topics) {
        how.look_ahead = u64::MAX;
    }
    lapwing_record::open(trace, how)
}

/// Whether nothing can be judged before the end of a recording: a stream, of which a specification has to know all topics.
pub fn waits_for_end(specs: &[Spec], trace: &Path) -> bool {
    let is_stream = trace == Path::new("-") || trace.metadata().is_ok_and(|about| !about.is_file() && !about.is_dir());
    is_stream && specs.iter().any(Spec::runs_over_topics)
}

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
        events: recording.events().iter().map(|e| e.to_string()).collect(),
        ..TraceShape::default()
    }
}

/// A topic's name with its leading slash.
fn absolute(name: &str) -> String {
    if name.starts_with('/') { name.to_owned() } else { format!("/{name}") }
}
