//! A recorded trace, owned, and its pieces between jumps of time (language reference, *Traces, instants, values*).

use lapwing_check::checked;
use lapwing_stream::{Sample, Time, Value, What};

/// A whole recording, its samples in the order of arrival.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// What arrived, and when.
    pub samples: Vec<(Time, Arrival)>,
    /// Why the recording ends before the run did: what would be `unmet` is `inconclusive` then.
    pub broke_off: Option<String>,
    /// Topics of which something was lost, with the reason: a success of what reads one is `inconclusive`.
    pub lost: Vec<(usize, String)>,
}

/// What arrived: [`What`] with values of its own.
#[derive(Clone, Debug, PartialEq)]
pub enum Arrival {
    /// A message; one value per wanted field of the topic.
    Message {
        /// The topic's number in the specification.
        topic: usize,
        /// The wanted fields.
        values: Vec<Value>,
    },
    /// A row; one cell per wanted column.
    Row {
        /// The cells.
        cells: Vec<Value>,
    },
    /// An event; one value per field of the event that is read.
    Event {
        /// The event's number in the specification.
        event: usize,
        /// The fields.
        values: Vec<Value>,
    },
    /// Something that the specification does not read.
    Other,
}

impl Arrival {
    /// Whether the specification reads it.
    pub fn is_read(&self) -> bool {
        !matches!(self, Arrival::Other)
    }

    /// The same, borrowed, as the engine takes it.
    pub fn what(&self) -> What<'_> {
        match self {
            Arrival::Message { topic, values } => What::Message { topic: *topic, values },
            Arrival::Row { cells } => What::Row { cells },
            Arrival::Event { event, values } => What::Event { event: *event, values },
            Arrival::Other => What::Other,
        }
    }
}

impl From<What<'_>> for Arrival {
    fn from(what: What<'_>) -> Arrival {
        match what {
            What::Message { topic, values } => Arrival::Message { topic, values: values.to_vec() },
            What::Row { cells } => Arrival::Row { cells: cells.to_vec() },
            What::Event { event, values } => Arrival::Event { event, values: values.to_vec() },
            What::Other => Arrival::Other,
        }
    }
}

impl Trace {
    /// Appends a sample.
    pub fn push(&mut self, sample: Sample<'_>) {
        self.samples.push((sample.time, sample.what.into()));
    }

    /// The samples, borrowed, as the engine takes them.
    pub fn iter(&self) -> impl Iterator<Item = Sample<'_>> {
        self.samples.iter().map(|(time, arrival)| Sample { time: *time, what: arrival.what() })
    }

    /// The stretches in which time never goes back, each cut at the timeout.
    pub(crate) fn pieces(&self, spec: &checked::Spec) -> Vec<Vec<(Time, Arrival)>> {
        let mut pieces: Vec<Vec<(Time, Arrival)>> = Vec::new();
        for sample in &self.samples {
            match pieces.last_mut() {
                Some(piece) if piece.last().is_some_and(|(before, _)| *before <= sample.0) => {
                    piece.push(sample.clone())
                }
                _ => pieces.push(vec![sample.clone()]),
            }
        }
        for piece in &mut pieces {
            if let (Some(timeout), Some(t0)) = (spec.timeout, first_read(piece)) {
                piece.retain(|(time, _)| *time <= t0 + timeout);
            }
        }
        pieces
    }
}

/// `t0`: the time of the first sample that the specification reads.
pub(crate) fn first_read(samples: &[(Time, Arrival)]) -> Option<Time> {
    samples.iter().find(|(_, arrival)| arrival.is_read()).map(|(time, _)| *time)
}
