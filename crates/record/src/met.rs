//! What a recording turned out to carry.

use crate::format::Channel;

/// The names of what a recording carries, as far as it was read and as far as they were noticed: for who asked for what is not there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Met {
    /// Columns, and the signals of rows that were not wanted.
    pub signals: Vec<String>,
    /// Topics, as recorded.
    pub topics: Vec<String>,
    /// Events.
    pub events: Vec<String>,
    /// Fields of messages, where only the messages tell them.
    pub fields: Vec<MetField>,
}

/// A field of the messages of a topic.
#[derive(Clone, Debug, PartialEq)]
pub struct MetField {
    /// The topic, as recorded.
    pub topic: String,
    /// The type, as [`normal_name`](crate::normal_name) spells it; empty where none is recorded.
    pub type_name: String,
    /// The way to the field, with points.
    pub path: String,
}

impl Met {
    /// The topics of channels.
    pub(crate) fn of(channels: &[Channel]) -> Met {
        Met { topics: channels.iter().map(|c| c.topic.to_string()).collect(), ..Met::default() }
    }
}
