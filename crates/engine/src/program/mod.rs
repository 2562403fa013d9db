//! The program: what a checked specification compiles to. Plain data, immutable once built; numbers index the vectors beside them.

mod asked;
mod code;
mod cuts;
mod formula;
mod skim;
mod wiring;

pub use code::*;
pub use cuts::Cut;
pub use formula::*;
pub use skim::Skim;
pub use wiring::*;

use alloc::string::String;
use alloc::vec::Vec;

use lapwing_stream::{Duration, Value};
use serde::{Deserialize, Serialize};

/// Where instants come from.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub enum Clock {
    /// Every sample that is read.
    #[default]
    Events,
    /// So many a second, from the first sample on.
    Rate(u32),
}

/// A compiled specification.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Program {
    /// Which instants there are.
    pub clock: Clock,
    /// Samples later than the first by more than this are as if they were not there.
    pub timeout: Option<Duration>,
    /// The signals.
    pub slots: Vec<Slot>,
    /// The topics.
    pub topics: Vec<Topic>,
    /// Which cell of a row fills which slot.
    pub columns: Vec<Column>,
    /// How rows of truth values are taken in at a glance, where that is possible. [`Program::link`] fills it.
    #[serde(skip)]
    pub skim: Option<Skim>,
    /// The objects of the ground truth.
    pub objects: Vec<Object>,
    /// The events.
    pub events: Vec<Event>,
    /// The machines, each after those that it reads.
    pub machines: Vec<Machine>,
    /// The properties, grouped by their positions.
    pub groups: Vec<Group>,
    /// What to call them, and in which order to report them.
    pub properties: Vec<Property>,
    /// How many runs of open obligations a property may have before it is inconclusive.
    pub open_limit: usize,
    /// How many values may be stored for the margin of a property; beyond that it has none.
    pub margin_limit: usize,
}

/// A signal.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Slot {
    /// Its value before the first sample.
    pub default: Option<Value>,
    /// What another value of it makes due. [`Program::link`] fills it.
    #[serde(skip)]
    pub wakes: Vec<Wake>,
    /// What any other number makes due, where it was a number: the rest of it is in `cuts`.
    #[serde(skip)]
    pub every: Vec<Wake>,
    /// What another number makes due only on the far side of a cut, in increasing order.
    #[serde(skip)]
    pub cuts: Vec<Cut>,
}

/// A cell of a row that fills a slot.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Column {
    /// The number of the cell.
    pub cell: usize,
    /// The slot.
    pub slot: usize,
}

/// A topic.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Topic {
    /// For every wanted field, the slots that it fills.
    pub fields: Vec<Vec<usize>>,
    /// The objects that its messages move.
    pub objects: Vec<usize>,
    /// The events that its messages may be.
    pub events: Vec<usize>,
    /// The longest window in which its messages are counted.
    pub window: Option<Duration>,
    /// What its messages make due whatever is in them. [`Program::link`] fills it.
    #[serde(skip)]
    pub wakes: Vec<Wake>,
}

/// An object of the ground truth.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Object {
    /// Its name.
    pub name: String,
    /// Where it comes from.
    pub source: ObjectSource,
    /// Those of its nineteen parts that are read, and the slots that they fill: position 3, quaternion 4 (x, y, z, w), linear 3, angular 3, and the
    /// velocities in its own frame, linear 3, angular 3.
    pub parts: Vec<(usize, usize)>,
}

/// Where an object's ground truth comes from: numbers of wanted fields.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum ObjectSource {
    ModelStates {
        name: usize,
        pose: usize,
        twist: usize,
    },
    Odometry {
        pose: usize,
        twist: usize,
    },
    Pose {
        pose: usize,
    },
    /// The field of the transforms, for each topic that carries them.
    Tf {
        topics: Vec<(usize, usize)>,
        fixed: String,
        frame: String,
    },
}

/// An event.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Event {
    /// For a message event, the wanted field of its topic that each of its fields is; else they come with the event.
    pub from_message: Option<Vec<usize>>,
    /// How many fields are read of it.
    pub fields: usize,
    /// The condition on its fields, over expressions of its own.
    pub when: Option<(Positions, NodeId)>,
}

/// The positions of a machine or of properties, and what is computed at them.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Positions {
    /// What must be defined before position 0, and so many instants before it.
    pub reads: Vec<(Read, usize)>,
    /// `Some` where only instants with one of these events are positions.
    pub alphabet: Option<Vec<usize>>,
    /// The comparisons of ages that make instants of their own.
    pub ages: Vec<AgeFlips>,
    /// `for each k of EVENT.field`, outermost first.
    pub slices: Vec<Slice>,
    /// The expressions.
    pub nodes: Vec<Node>,
    /// The code, in the order of evaluation.
    pub ops: Vec<Op>,
    /// What makes each operator due, where that is kept account of. [`Program::link`] fills it.
    #[serde(skip)]
    pub wiring: Option<Wiring>,
}

/// What a start waits for.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
pub enum Read {
    /// A value of a slot.
    Slot(usize),
    /// A message of a topic.
    Topic(usize),
}

/// After a message of the topic, the value of a comparison of its age differs from before at these distances, each at least a
/// nanosecond, increasing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AgeFlips {
    /// The topic.
    pub topic: usize,
    /// The distances from its latest message.
    pub after: Vec<Duration>,
}

/// `for each k of EVENT.field`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Slice {
    /// The event whose values make instances.
    pub event: usize,
    /// The number of the field among the event's.
    pub field: usize,
    /// The events that have this field, and its number among theirs: under an instance another value hides the event.
    pub hides: Vec<(usize, usize)>,
}

/// A machine.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Machine {
    /// Its positions and expressions.
    pub at: Positions,
    /// When it looks.
    pub sample: Option<Bit>,
    /// The state before the first sample.
    pub initial: usize,
    /// The states in order of precedence.
    pub states: Vec<MachineState>,
    /// Whether it keeps its state where no condition holds.
    pub else_stay: bool,
    /// The edges.
    pub edges: Vec<Edge>,
    /// The property that it is.
    pub property: usize,
}

/// A state of a machine.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct MachineState {
    pub name: String,
    pub when: Option<Bit>,
    pub on: Option<usize>,
    pub at_most: Option<Duration>,
    pub at_least: Option<Duration>,
    /// The events of entering and leaving it, where something reads them.
    pub entered: Option<usize>,
    pub left: Option<usize>,
}

/// An edge of a machine.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Edge {
    pub from: usize,
    pub to: usize,
    pub on: Option<usize>,
    pub when: Option<Bit>,
}

/// A property.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Property {
    /// Its name.
    pub name: String,
    /// Who judges it.
    pub judge: Judge,
    /// The topics that it reads, in whatever way.
    pub topics: Vec<usize>,
    /// The silences that make it inconclusive.
    pub stale: Vec<Silence>,
    /// The counters of NaN operands that are its.
    pub counters: Vec<u32>,
    /// How many scopes and `whenever`s it has.
    pub scopes: usize,
    /// Why it cannot be judged at all.
    pub problem: Option<String>,
    /// What it waits for: for each of [`Positions::reads`].
    pub waits_for: Vec<Awaited>,
    /// The machines whose events make its positions: where one of them cannot be judged, neither can it.
    pub rests_on: Vec<usize>,
}

/// Something without which a property does not begin.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Awaited {
    /// What to call it.
    pub name: String,
    /// The topic whose messages bring it, where they do, and what to call it when messages came without it.
    pub in_messages: Option<(usize, String)>,
}

/// A silence that is too long.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Silence {
    /// Of what: a topic, or a signal that comes in rows.
    pub of: Read,
    /// What to call it.
    pub name: String,
    /// Longer than this.
    pub limit: Duration,
}

/// Who judges a property.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub enum Judge {
    /// Nobody can.
    #[default]
    Nobody,
    /// A group.
    Group(usize),
    /// A machine.
    Machine(usize),
}
