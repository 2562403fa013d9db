//! The formats of recordings. Each is a [`Source`]: it finds messages and leaves them undecoded.

pub(crate) mod bag;
pub(crate) mod compression;
pub(crate) mod csv;
mod fields;
pub(crate) mod input;
pub(crate) mod lines;
pub(crate) mod mcap;
pub(crate) mod metadata;
pub(crate) mod ndjson;
pub(crate) mod rosbag2;
pub(crate) mod sqlite;
pub(crate) mod types;

use std::fmt;
use std::sync::Arc;

use lapwing_stream::{Name, Time, Value};

use crate::decode::MessageType;
use crate::error::{Losses, Place, ReadError};

/// A format of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// MCAP.
    Mcap,
    /// rosbag2: a folder, or a bare SQLite file.
    Rosbag2,
    /// A ROS 1 bag, version 2.0.
    Ros1Bag,
    /// Rows of cells separated by commas.
    Csv,
    /// One JSON object a line.
    Ndjson,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Format::Mcap => "MCAP",
            Format::Rosbag2 => "rosbag2",
            Format::Ros1Bag => "ROS 1 bag",
            Format::Csv => "CSV",
            Format::Ndjson => "NDJSON",
        })
    }
}

/// One stream of messages in a recording: a topic and a type.
#[derive(Clone, Debug)]
pub(crate) struct Channel {
    pub topic: Arc<str>,
    /// As [`normal_name`](crate::normal_name) spells it; empty where none is known.
    pub type_name: String,
    /// How to decode it, or why that is not possible.
    pub ty: Result<MessageType, String>,
    /// Why there is no schema although it can be decoded.
    pub note: String,
    /// How many messages it has, where the recording says so or was read through.
    pub messages: Option<u64>,
}

/// What comes next in a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Head {
    /// A message of the channel of that index.
    Message(usize),
    /// A row of cells.
    Row,
    /// An event by its name.
    Event,
}

/// A recording that is read from its beginning to its end, in the order of the file.
pub(crate) trait Source: Send {
    /// The channels met so far; the list only grows.
    fn channels(&self) -> &[Channel];

    /// Goes to what comes next. Damage is noted as a loss and passed over where that is possible.
    fn advance(&mut self, losses: &mut Losses) -> Result<Option<(Time, Head)>, ReadError>;

    /// The bytes of the current message; an error says why this one cannot be had.
    fn payload(&mut self) -> Result<&[u8], String>;

    /// The cells of the current row or the fields of the current event.
    fn cells(&self) -> &[(Name, Value)] {
        &[]
    }

    /// The name of the current event.
    fn event(&self) -> &str {
        ""
    }

    /// The names of the columns, where there are columns.
    fn columns(&self) -> &[Name] {
        &[]
    }

    /// Where the current message is.
    fn place(&self) -> Place;

    /// Bytes read and bytes in all; these are 0 where that is not known.
    fn progress(&self) -> (u64, u64);
}

/// Nanoseconds as recorders write them, without a sign; what 63 bits cannot hold is the end of time.
pub(crate) fn stamp(nanos: u64) -> Time {
    Time(i64::try_from(nanos).unwrap_or(i64::MAX))
}
