//! One thing that arrives from a connector.

use crate::{Time, Value};

/// Something that arrived, with its stamp. The numbers in it are those of the checked specification that reads it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample<'a> {
    /// When.
    pub time: Time,
    /// What.
    pub what: What<'a>,
}

/// The kinds of things that arrive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What<'a> {
    /// A message of a topic that the specification reads; one value per field that it wants of the topic, in its order.
    Message { topic: usize, values: &'a [Value] },
    /// A row: one cell per column that the specification wants, in its order.
    Row { cells: &'a [Value] },
    /// An event that the specification declares; one value per field that it wants of the event, in its order.
    Event { event: usize, values: &'a [Value] },
    /// A message that the specification does not read: only its time matters.
    Other,
}
