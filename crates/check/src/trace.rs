//! What a specification is checked against besides itself: the topics, types, columns and events of one trace.

use std::sync::Arc;

use lapwing_stream::Schema;

/// The topic by which a recording is known as one of a component system: it says when the system began and ended.
///
/// In such a trace the port `P` of the component `C` is the topic `/C/P`; what its activity or service `A` does is on topics of their own,
/// `/C/A/start`, `…/end`, `…/request`, `…/report`, and whether it runs on `/C/A/running`, a message with the field `data`.
pub const COMPONENTS: &str = "/lapwing/components";

/// The shape of a trace: what it carries, without its data.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TraceShape {
    /// Its topics.
    pub topics: Vec<TraceTopic>,
    /// Its columns: those of CSV, the names of NDJSON's `values`.
    pub columns: Vec<String>,
    /// Whether it is a trace without schemas, CSV or NDJSON, in which an undeclared name is a column.
    pub schemaless: bool,
    /// Whether further columns, topics and events may turn up later: NDJSON that is still growing.
    pub columns_open: bool,
    /// The names of its events.
    pub events: Vec<String>,
    /// Whether it is a running system and no recording: only there calls, returns and publishers can be seen.
    pub live: bool,
    /// The names of topics that are there as well but cannot be read: what a misspelt one may have been meant to be.
    pub unread: Vec<String>,
}

/// A topic of a trace.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceTopic {
    /// Its absolute name.
    pub name: String,
    /// Its full type: `nav_msgs/Odometry`; ROS 2's `nav_msgs/msg/Odometry` is taken as well.
    pub type_name: String,
    /// The definition of the type, where the trace carries one.
    pub schema: Option<Arc<Schema>>,
}

impl TraceShape {
    /// A running program that is watched from within: it has no topics, any name may be a value that it sets, any event may occur.
    pub fn program() -> TraceShape {
        TraceShape { schemaless: true, columns_open: true, live: true, ..TraceShape::default() }
    }

    /// Whether it is a running program.
    pub(crate) fn is_program(&self) -> bool {
        self.live && self.columns_open && self.topics.is_empty()
    }

    /// Whether it is a component system, or a recording of one.
    pub(crate) fn is_of_components(&self) -> bool {
        self.topic(COMPONENTS).is_some()
    }

    /// Where something is missing, in words.
    pub(crate) fn here(&self) -> &'static str {
        if self.live { "in this run" } else { "in this recording" }
    }

    /// Whose it is that is missing, in words.
    pub(crate) fn of_here(&self) -> &'static str {
        if self.live { "on the graph" } else { "of this recording" }
    }

    /// The names of all topics that are there.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.topics.iter().map(|t| t.name.as_str()).chain(self.unread.iter().map(String::as_str))
    }

    /// The topic of that name.
    pub fn topic(&self, name: &str) -> Option<&TraceTopic> {
        self.topics.iter().find(|t| t.name == name)
    }

    /// Whether there is a column of that name.
    pub fn has_column(&self, name: &str) -> bool {
        self.columns.iter().any(|c| c == name)
    }
}

/// A type's name without ROS 2's `msg`: `nav_msgs/msg/Odometry` is `nav_msgs/Odometry`.
pub(crate) fn plain_type(name: &str) -> String {
    name.replace("/msg/", "/")
}

/// Whether a type as a specification writes it, with or without its package, is the trace's `full` type.
pub(crate) fn is_type(package: Option<&str>, short: &str, full: &str) -> bool {
    let full = plain_type(full);
    match package {
        Some(package) => full == format!("{package}/{short}"),
        None => full.rsplit(['/', '.']).next() == Some(short),
    }
}
