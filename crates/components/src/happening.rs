//! What happens in a run, one thing after the other.

use std::fmt;
use std::sync::Arc;

use lapwing_diag::{SourceMap, Span};
use lapwing_genom::model::{CodelId, Model, PortId, ServiceId, TaskId};
use lapwing_stream::{Duration, Time};

use crate::codel::Trouble;
use crate::datum::Datum;

/// Something that happened.
#[derive(Clone, PartialEq, Debug)]
pub struct Happening {
    /// When, counted from the beginning of the run.
    pub time: Time,
    /// What.
    pub what: What,
}

/// A service of a component, by their numbers.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Whose {
    /// The component.
    pub component: usize,
    /// The service.
    pub service: ServiceId,
}

/// The kinds of what happens. `id` is the number of a request, `whose` the service, `values` those of its parameters.
#[derive(Clone, PartialEq, Debug)]
#[allow(missing_docs)]
pub enum What {
    /// Somebody asked for a service.
    Requested { id: u64, whose: Whose, values: Vec<Datum>, by: Option<String> },
    /// The control task accepted a request, or refused it: by an exception of `validate`, or because of `disallowed` or `too_many_activities`.
    Replied { id: u64, whose: Whose, refused: Option<String>, instance: Option<usize> },
    /// An activity began: its first codel is next.
    Started { whose: Whose, instance: usize, values: Vec<Datum> },
    /// An activity is to stop.
    Interrupted { whose: Whose, instance: usize },
    /// An activity ended.
    Ended { whose: Whose, instance: usize, outcome: Outcome },
    /// The client was told what became of its request, with the values of all parameters.
    Reported { id: u64, whose: Whose, outcome: Outcome, values: Vec<Datum> },
    /// A codel was called.
    Called { component: usize, codel: CodelId },
    /// A codel returned.
    Returned { component: usize, codel: CodelId, answer: Arc<str>, took: Duration },
    /// A codel wrote to a port.
    Written { component: usize, port: PortId, name: Option<String>, value: Datum },
    /// A codel took longer than it may.
    Overrun { component: usize, codel: CodelId, took: Duration, wcet: Duration },
    /// A period began while the one before had not been looked at: a turn of the task was left out.
    Missed { component: usize, task: TaskId },
    /// A turn of a task began so much after its period had.
    Late { component: usize, task: TaskId, by: Duration },
    /// A codel could not be run to its end: the run is over.
    Failed(Box<Failure>),
    /// The time that somebody wanted to be woken at.
    Woken,
    /// The run is over.
    Over,
}

/// How a service ended.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Outcome {
    /// By itself.
    Done,
    /// It was interrupted.
    Interrupted,
    /// A codel threw this exception.
    Exception(String),
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Outcome::Done => f.write_str("done"),
            Outcome::Interrupted => f.write_str("interrupted"),
            Outcome::Exception(name) => write!(f, "{name}"),
        }
    }
}

/// A codel that could not be run to its end.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Failure {
    /// The component, by its number.
    pub component: usize,
    /// The codel.
    pub codel: CodelId,
    /// What happened.
    pub trouble: Trouble,
}

/// A codel in words: `SafetyPilot.StopIfObstacle.stop`, its function, and where the specification has it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CodelPlace {
    /// The component, the activity or function, and the state.
    pub name: String,
    /// The function.
    pub function: String,
    /// The file and the line: `safety_pilot.gen:34`.
    pub place: String,
}

/// Where a codel stands.
pub fn place(model: &Model, sources: &SourceMap, component: usize, codel: CodelId) -> CodelPlace {
    let declared = model.components.get(component);
    let found = declared.and_then(|c| Some((c, c.codels.get(codel.0)?)));
    match found {
        Some((component, codel)) => CodelPlace {
            name: format!("{}.{}", component.name, component.codel_name(codel)),
            function: codel.function.clone(),
            place: line(sources, codel.span),
        },
        None => CodelPlace { name: "?".to_owned(), function: "?".to_owned(), place: "?".to_owned() },
    }
}

/// File and line of a place in a specification.
pub fn line(sources: &SourceMap, span: Span) -> String {
    let name = sources.name(span.file);
    let short = name.rsplit('/').next().unwrap_or(name);
    format!("{short}:{}", sources.position(span).0)
}
