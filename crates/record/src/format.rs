//! The formats of recordings. Each is a [`Source`]: it finds messages and leaves them undecoded.

pub(crate) mod bag;
pub(crate) mod compression;
pub(crate) mod csv;
mod fields;
pub(crate) mod input;
pub(crate) mod lines;
pub(crate) mod mcap;
pub(crate) mod messages;
pub(crate) mod metadata;
pub(crate) mod ndjson;
pub(crate) mod returns;
pub(crate) mod rosbag2;
mod signals;
pub(crate) mod sqlite;
pub(crate) mod stream;
pub(crate) mod times;
pub(crate) mod told;
pub(crate) mod types;

#[cfg(test)]
mod tests;

use std::fmt;
use std::sync::Arc;

use lapwing_stream::{Name, Time, Value};

use crate::cells::Cells;
use crate::decode::MessageType;
use crate::error::{Losses, Place, ReadError};
use crate::met::Met;
use crate::path::Path;

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
    /// No file: a program gives its messages one by one.
    Messages,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Format::Mcap => "MCAP",
            Format::Rosbag2 => "rosbag2",
            Format::Ros1Bag => "ROS 1 bag",
            Format::Csv => "CSV",
            Format::Ndjson => "NDJSON",
            Format::Messages => "a program's messages",
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
    /// What the recording says of its type, where its messages lie there as bytes.
    pub declared: Option<Arc<types::Declared>>,
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

    /// Whether it gives these fields of the messages of a channel by [`tell`](Source::tell), without bytes. Asked once for a channel.
    fn tells(&mut self, _channel: usize, _fields: &[Path]) -> bool {
        false
    }

    /// Overwrites values by the fields of the current message that its channel was asked for.
    fn tell(&mut self, _values: &mut [Value]) {}

    /// Of rows only these signals are wanted, in this order. Called before the first row is read, or not at all.
    fn choose(&mut self, _signals: &[Name]) {}

    /// Payloads are only asked for of messages of those channels. Called before the first message is read, or not at all.
    fn leave_out(&mut self, _is_wanted: &dyn Fn(&Channel) -> bool) {}

    /// The cells of the current row or the fields of the current event.
    fn cells(&self) -> Cells<'_> {
        Cells::default()
    }

    /// The name of the current event.
    fn event(&self) -> &str {
        ""
    }

    /// The names of the columns, where there are columns; else those of values, as far as they are known before the reading.
    fn columns(&self) -> &[Name] {
        &[]
    }

    /// What has come so far, by name.
    fn met(&self) -> Met {
        Met { signals: self.columns().iter().map(|name| name.to_string()).collect(), ..Met::of(self.channels()) }
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
