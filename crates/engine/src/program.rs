//! The program: what a checked specification compiles to. Plain data, immutable once built; numbers index the vectors beside them.

use alloc::string::String;
use alloc::vec::Vec;

use lapwing_stream::{Duration, Value};

use crate::margin::plan::Plan;

/// Where instants come from.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Clock {
    /// Every sample that is read.
    #[default]
    Events,
    /// So many a second, from the first sample on.
    Rate(u32),
}

/// A compiled specification.
#[derive(Clone, Debug, Default)]
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
    pub columns: Vec<(usize, usize)>,
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
#[derive(Clone, Debug, Default)]
pub struct Slot {
    /// Its value before the first sample.
    pub default: Option<Value>,
}

/// A topic.
#[derive(Clone, Debug, Default)]
pub struct Topic {
    /// For every wanted field, the slots that it fills.
    pub fields: Vec<Vec<usize>>,
    /// The objects that its messages move.
    pub objects: Vec<usize>,
    /// The events that its messages may be.
    pub events: Vec<usize>,
    /// The longest window in which its messages are counted.
    pub window: Option<Duration>,
}

/// An object of the ground truth and the slots that its parts fill: position 3, quaternion 4 (x, y, z, w), linear 3, angular 3.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its name.
    pub name: String,
    /// Where it comes from.
    pub source: ObjectSource,
    /// The slots of its thirteen parts, where they are read.
    pub slots: [Option<usize>; 13],
}

/// Where an object's ground truth comes from: numbers of wanted fields.
#[derive(Clone, Debug)]
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
#[derive(Clone, Debug, Default)]
pub struct Event {
    /// For a message event, the wanted field of its topic that each of its fields is; else they come with the event.
    pub from_message: Option<Vec<usize>>,
    /// How many fields are read of it.
    pub fields: usize,
    /// The condition on its fields, over expressions of its own.
    pub when: Option<(Positions, NodeId)>,
}

/// The positions of a machine or of properties, and what is computed at them.
#[derive(Clone, Debug, Default)]
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
}

/// What a start waits for.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Read {
    /// A value of a slot.
    Slot(usize),
    /// A message of a topic.
    Topic(usize),
}

/// After a message of the topic, the value of a comparison of its age differs from before at these distances, each at least a
/// nanosecond, increasing.
#[derive(Clone, Debug, PartialEq)]
pub struct AgeFlips {
    /// The topic.
    pub topic: usize,
    /// The distances from its latest message.
    pub after: Vec<Duration>,
}

/// `for each k of EVENT.field`.
#[derive(Clone, Debug)]
pub struct Slice {
    /// The event whose values make instances.
    pub event: usize,
    /// The number of the field among the event's.
    pub field: usize,
    /// The events that have this field, and its number among theirs: under an instance another value hides the event.
    pub hides: Vec<(usize, usize)>,
}

/// The number of a node.
pub type NodeId = u32;
/// The number of a register: that of the operator that fills it.
pub type RegId = u32;

/// The truth value in a register, or its negation.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct Bit(u32);

impl Bit {
    /// The truth value in a register.
    pub fn new(register: RegId) -> Bit {
        Bit(register << 1)
    }

    /// The register.
    #[inline]
    pub fn register(self) -> usize {
        (self.0 >> 1) as usize
    }

    /// Whether the negation is meant.
    #[inline]
    pub fn is_negated(self) -> bool {
        self.0 & 1 == 1
    }
}

impl core::ops::Not for Bit {
    type Output = Bit;
    fn not(self) -> Bit {
        Bit(self.0 ^ 1)
    }
}

/// An expression without memory of its own. What it stands on has a smaller number.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum Node {
    Num(f64),
    Bool(bool),
    Str(String),
    /// The latest value of a signal.
    Slot(usize),
    /// The value that an operator computed.
    Reg(RegId),
    /// The truth value of a formula.
    Bit(Bit),
    /// Whether an event occurs at this instant.
    Event(usize),
    /// A field of it.
    EventField {
        event: usize,
        field: usize,
    },
    /// Whether a machine stands in a state (`None`: undefined).
    InState {
        machine: usize,
        state: Option<usize>,
    },
    /// Whether one of the slots got a value since the machine sampled last.
    Updated(Vec<usize>),
    /// The value of a slice.
    Param(usize),
    /// The variable of the so-many-th enclosing quantifier.
    Var(usize),
    Field(NodeId, String),
    Index(NodeId, usize),
    /// A number as a condition: neither zero nor NaN.
    Truth(NodeId),
    Neg(NodeId),
    Arith(Arith, NodeId, NodeId),
    /// Of numbers; `counter` counts those that met a NaN.
    Compare {
        op: Compare,
        margin: Option<NodeId>,
        left: NodeId,
        right: NodeId,
        counter: u32,
    },
    /// Of values whose kind only shows at run time, and of texts and booleans.
    CompareAny {
        op: Compare,
        margin: Option<NodeId>,
        left: NodeId,
        right: NodeId,
        counter: u32,
    },
    Not(NodeId),
    And(NodeId, NodeId),
    Or(NodeId, NodeId),
    Iff(NodeId, NodeId),
    Call(Func, Vec<NodeId>),
    Any {
        array: NodeId,
        body: NodeId,
    },
    Age(usize),
    Frequency(usize, Duration),
    Fresh(usize),
}

/// Arithmetic.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Arith {
    Add,
    Sub,
    Mul,
    Div,
}

/// Comparisons.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Compare {
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
}

/// Functions of values; what each computes stands beside it in `functions`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Func {
    Abs,
    Sign,
    Min,
    Max,
    Sqrt,
    Sin,
    Cos,
    Atan2,
    Norm,
    Roll,
    Pitch,
    Yaw,
    AngleDiff,
    AngleBetween,
    IntoBody,
    Deg,
    Rad,
    IsNan,
    Len,
    MinOf,
    MaxOf,
    Lookup,
    StartsWith,
    EndsWith,
    Contains,
}

/// A time bound: positions at a distance from `lo` to `hi`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub struct Bound {
    pub lo: i64,
    pub lo_closed: bool,
    /// `i64::MAX` for none.
    pub hi: i64,
    pub hi_closed: bool,
}

impl Bound {
    /// No bound.
    pub const ALL: Bound = Bound { lo: 0, lo_closed: true, hi: i64::MAX, hi_closed: true };

    /// Whether there is an upper end.
    pub fn has_end(&self) -> bool {
        self.hi != i64::MAX
    }

    /// For a bound that begins at no distance: the greatest distance within, in whole nanoseconds.
    pub fn from_here(&self) -> Option<i64> {
        let begins_here = self.lo == 0 && self.lo_closed;
        let greatest = if self.hi_closed { Some(self.hi) } else { self.hi.checked_sub(1).filter(|&hi| hi >= 0) };
        if begins_here { greatest } else { None }
    }

    /// Whether a distance has reached the lower end.
    #[inline]
    pub fn begun(&self, distance: i64) -> bool {
        distance > self.lo || (self.lo_closed && distance == self.lo)
    }

    /// Whether a distance has not passed the upper end.
    #[inline]
    pub fn not_over(&self, distance: i64) -> bool {
        distance < self.hi || (self.hi_closed && distance == self.hi)
    }

    /// Whether a distance lies within.
    #[inline]
    pub fn contains(&self, distance: i64) -> bool {
        self.begun(distance) && self.not_over(distance)
    }
}

/// A step of the code that runs at every position: it fills the register of its own number from those before.
///
/// Formulas are flat code over truth values, so that each is computed once however many properties share it; only what stands inside
/// a comparison or a function is a tree of [`Node`]s.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum Op {
    /// The truth of a signal: a boolean, or (`truth`) a number that is neither zero nor NaN.
    Slot {
        slot: usize,
        truth: bool,
    },
    /// The truth of an expression.
    Holds(NodeId),
    And(Bit, Bit),
    Iff(Bit, Bit),
    Previously(Bit),
    Becomes(Bit),
    Once(Bound, Bit),
    /// left since right
    Since(Bound, Bit, Bit),
    /// `once` whose bound begins where it stands: at most so many nanoseconds ago.
    OnceWithin(i64, Bit),
    /// `left since right` whose bound begins where it stands.
    SinceWithin(i64, Bit, Bit),
    Held(Duration, Bit),
    /// At how many positions of the window it held.
    Count(Bit, Duration),
    /// The expression's value so many instants ago.
    Lookback(NodeId, usize),
    /// The expression minus its value an instant ago.
    Delta(NodeId),
    /// That, over the seconds since then.
    Rate(NodeId),
    Window(Window, NodeId, Duration),
}

/// Windows over the past.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Window {
    Min,
    Max,
    Mean,
}

/// Properties with the same positions.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// Their positions and expressions.
    pub at: Positions,
    /// The segments in which formulas stand; 0 is the whole trace.
    pub contexts: Vec<Context>,
    /// The future operators; each stands on those before it.
    pub futures: Vec<Future>,
    /// Where obligations arise.
    pub trackers: Vec<Tracker>,
    /// How often scopes are entered.
    pub looks: Vec<Look>,
    /// The margins of its properties, of those that have one.
    pub margins: Vec<Plan>,
}

impl Group {
    /// Whether all its obligations are state formulas at positions of the whole trace, and no scope is counted.
    pub fn is_plain(&self) -> bool {
        self.futures.is_empty() && self.contexts.len() == 1 && self.looks.is_empty()
    }
}

/// The number of a context.
pub type ContextId = u32;
/// A future node, perhaps negated.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct FutureRef {
    /// Its number.
    pub id: u32,
    /// Whether its negation is meant.
    pub negated: bool,
}

/// A kind of segments, inside those of its parent.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Context {
    /// The context around it; itself for the whole trace.
    pub parent: ContextId,
    /// How its segments lie in the parent's.
    pub kind: ContextKind,
}

/// How segments lie in those of the parent.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum ContextKind {
    /// The whole trace.
    Whole,
    /// From the first position with X on.
    After { x: Bit },
    /// Up to the first position with X; `again` where formulas are asked at later positions too: then from each X to the next.
    Until { x: Bit, again: bool },
    /// From an X to the next Y.
    AfterUntil { x: Bit, y: Bit },
    /// Every maximal run of positions with X.
    While { x: Bit },
}

/// A node of the graph of future operators: at each position of its context it becomes true or false, at once or later.
#[derive(Clone, Debug, PartialEq)]
pub struct Future {
    /// The segments in which it stands.
    pub context: ContextId,
    /// What it is.
    pub kind: FutureKind,
}

/// The kinds of future nodes.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum FutureKind {
    /// Known at once.
    State(Bit),
    And(FutureRef, FutureRef),
    Eventually(Bound, FutureRef),
    Next(FutureRef),
    /// Both operands known at once.
    Until(Bound, Bit, Bit),
    /// `after X, body`
    After {
        x: Bit,
        body: FutureRef,
        inner: ContextId,
    },
    /// `until X, body`, and `before X, body` with `weak`
    UntilScope {
        weak: bool,
        x: Bit,
        body: FutureRef,
        inner: ContextId,
    },
    /// `after_until` and `while`: the body, in every segment of the inner context, at the first X at or after the position.
    Each {
        x: Bit,
        body: FutureRef,
        inner: ContextId,
    },
    /// What is false inside segments of a `before`, told only when its X comes; where it does not, true.
    Gate {
        body: FutureRef,
        before: ContextId,
    },
    /// A formula beyond the operators above (a scope that opens or closes on a future formula, an `until` of future formulas):
    /// evaluated anew from the values of its parts whenever something is new.
    Replay(Replay),
}

/// A formula evaluated from stored values: nodes by number, each standing on those before it; the last is the formula.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// The formula.
    pub terms: Vec<Term>,
    /// The state formulas in it.
    pub leaves: Vec<Bit>,
}

/// A term of a [`Replay`].
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum Term {
    Leaf(usize),
    Not(usize),
    And(usize, usize),
    Or(usize, usize),
    Iff(usize, usize),
    Always(Bound, usize),
    Eventually(Bound, usize),
    Next(usize),
    Until(Bound, usize, usize),
    After(usize, usize),
    UntilScope(usize, usize),
    Before(usize, usize),
    AfterUntil(usize, usize, usize),
    While(usize, usize),
}

/// Where obligations arise, and what decides them.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracker {
    /// The property, a number of [`Program::properties`].
    pub property: usize,
    /// The segments.
    pub context: ContextId,
    /// At which positions of a segment.
    pub at: At,
    /// The formula that must become true.
    pub formula: Judged,
    /// Whether this obligation of a property that never has a position would be missed at the end.
    pub missed_if_empty: bool,
}

/// What an obligation asks.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Judged {
    /// A state formula, decided on the spot.
    State(Bit),
    /// A future formula.
    Future(FutureRef),
}

/// At which positions of its segments a tracker has obligations.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum At {
    /// The first.
    First,
    /// All at this distance from the first.
    Within(Bound),
}

/// Where a scope is looked at, and whether it was entered there: what vacuity counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// The segments in which it stands.
    pub context: ContextId,
    /// The contexts of `until` and `before` in which it stands, the innermost first: what is entered inside one counts once its X has
    /// come.
    pub awaits: Vec<ContextId>,
    /// What is looked at, from the looks before.
    pub kind: LookKind,
    /// The property and the number of its scope that this counts for.
    pub counts: Option<(usize, usize)>,
}

/// The ways a position comes to be looked at.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum LookKind {
    /// Every position of a segment at this distance from its first.
    Within(Bound),
    /// The first position of each segment.
    First,
    /// A position at this distance from one that is looked at.
    From { of: u32, bound: Bound },
    /// The position after one that is looked at.
    Next { of: u32 },
    /// One that is looked at, where X holds.
    Where { of: u32, x: Bit },
    /// One that is looked at, where X does not hold.
    Unless { of: u32, x: Bit },
    /// The first with X at or after one that is looked at.
    FirstWith { of: u32, x: Bit },
    /// The positions that open segments of `after_until` at or after one that is looked at; an empty one counts.
    Opens { of: u32, x: Bit, y: Bit },
    /// The first positions of runs of X at or after one that is looked at.
    Runs { of: u32, x: Bit },
    /// As another look, of an outer context.
    Same { of: u32 },
    /// One that is looked at, once the future formula turns out to hold there. It counts, but no look can stand on it.
    Proves { of: u32, formula: FutureRef },
}

/// A machine.
#[derive(Clone, Debug, Default)]
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
#[derive(Clone, Debug, Default)]
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
#[derive(Clone, Debug, Default)]
#[allow(missing_docs)]
pub struct Edge {
    pub from: usize,
    pub to: usize,
    pub on: Option<usize>,
    pub when: Option<Bit>,
}

/// A property.
#[derive(Clone, Debug, Default)]
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
    /// What it waits for, in words: for each of [`Positions::reads`].
    pub waits_for: Vec<String>,
}

/// A silence that is too long.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Silence {
    /// Of what: a topic, or a signal that comes in rows.
    pub of: Read,
    /// What to call it.
    pub name: String,
    /// Longer than this.
    pub limit: Duration,
}

/// Who judges a property.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Judge {
    /// Nobody can.
    #[default]
    Nobody,
    /// A group.
    Group(usize),
    /// A machine.
    Machine(usize),
}
