//! The checked specification: every name resolved, every expression typed, patterns expanded, `for each` over lists and topics
//! unrolled. It is what the reference evaluates and what the compiler turns into a program.
//!
//! A specification is checked twice with the same code: once alone, for what no trace can cure, and once for every trace, whose
//! topics and types are then known. What is wrong with one trace only lands in [`Property::problem`].

mod reaction;

use std::fmt;

use lapwing_diag::Span;
use lapwing_stream::{Duration, Type, Value};

pub use reaction::{Action, Guard, Message, Reaction};

/// A specification, ready to be evaluated.
#[derive(Clone, Debug, Default)]
pub struct Spec {
    /// Which instants there are.
    pub clock: Clock,
    /// How far from the first message on the trace is looked at.
    pub timeout: Option<Duration>,
    /// The topics that are read: declared, or named by a property, a machine or a reaction.
    pub topics: Vec<Topic>,
    /// The columns that are read, of rows of CSV and NDJSON.
    pub columns: Vec<String>,
    /// The signals: what expressions read.
    pub inputs: Vec<Input>,
    /// The objects of the ground truth.
    pub objects: Vec<Object>,
    /// The events.
    pub events: Vec<Event>,
    /// The state diagrams, each after those that it reads.
    pub machines: Vec<Machine>,
    /// The properties, in the order of the text; a machine is a property of its name.
    pub properties: Vec<Property>,
    /// What is to be done on a violation: reported by `check`, carried out live.
    pub reactions: Vec<Reaction>,
}

/// Where instants come from.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Clock {
    /// Each message, event or row that is read.
    #[default]
    Events,
    /// So many a second.
    Rate(u32),
}

/// A topic that the specification reads.
#[derive(Clone, Debug, PartialEq)]
pub struct Topic {
    /// Its absolute name.
    pub name: String,
    /// Its full type, once resolved: `nav_msgs/Odometry`.
    pub type_name: Option<String>,
    /// The fields that are wanted of its messages; a sample carries one value for each.
    pub fields: Vec<Path>,
    /// The place that first named it.
    pub span: Span,
}

/// A way into a value. The empty path is the whole.
pub type Path = Vec<Step>;

/// One step of a [`Path`].
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Step {
    /// Into a field.
    Field(String),
    /// Into an array.
    Index(usize),
}

/// A part of something as it is written, `/odom.pose.pose.position.x` or `gaps[0]`; without a name for the whole, the path alone.
pub fn part(whole: &str, path: &[Step]) -> String {
    let mut name = whole.to_owned();
    for step in path {
        match step {
            Step::Field(field) if name.is_empty() => name.push_str(field),
            Step::Field(field) => name.extend([".", field]),
            Step::Index(index) => name.push_str(&format!("[{index}]")),
        }
    }
    name
}

/// A signal: it has a value from its first sample on, and keeps it until replaced.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// How reports call it: as the specification writes it.
    pub label: String,
    /// Where its values come from.
    pub source: InputSource,
    /// The type of its values; [`Type::Any`] where only a value can tell.
    pub ty: Type,
    /// Its physical dimension.
    pub dim: Dim,
    /// Its value before the first sample; with one it is always defined.
    pub default: Option<Value>,
    /// Silence for longer makes what reads it inconclusive.
    pub stale: Option<Duration>,
}

/// Where the values of an [`Input`] come from.
#[derive(Clone, Debug, PartialEq)]
pub enum InputSource {
    /// A wanted field of a topic: `topics[topic].fields[field]`.
    Field { topic: usize, field: usize },
    /// A wanted column: `columns[_]`.
    Column(usize),
    /// Part of the ground truth of an object.
    World { object: usize, part: Part },
}

/// The parts of an object's ground truth, in the world frame but for the last six. They are undefined until the source has delivered them.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Part {
    PositionX,
    PositionY,
    PositionZ,
    /// The orientation, a unit quaternion.
    QuaternionX,
    QuaternionY,
    QuaternionZ,
    QuaternionW,
    LinearX,
    LinearY,
    LinearZ,
    AngularX,
    AngularY,
    AngularZ,
    /// The velocity in the object's own frame: the latest, turned back by the latest orientation.
    BodyLinearX,
    BodyLinearY,
    BodyLinearZ,
    BodyAngularX,
    BodyAngularY,
    BodyAngularZ,
}

/// An object of the ground truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its name, as ModelStates has it.
    pub name: String,
    /// Its source.
    pub source: ObjectSource,
}

/// Where an object's ground truth comes from. The numbers are topics and wanted fields of them.
#[derive(Clone, Debug, PartialEq)]
pub enum ObjectSource {
    /// Parallel arrays of gazebo_msgs/ModelStates; wanted fields `name`, `pose`, `twist`.
    ModelStates { topic: usize, name: usize, pose: usize, twist: usize },
    /// nav_msgs/Odometry: `pose.pose`, and `twist.twist`, which is in the body frame and is turned into the world's.
    Odometry { topic: usize, pose: usize, twist: usize },
    /// geometry_msgs/PoseStamped: `pose`; velocities are finite differences of consecutive messages.
    Pose { topic: usize, pose: usize },
    /// A chain of transforms from `/tf` and `/tf_static` (wanted field: `transforms`), the latest of each link; velocities are
    /// finite differences between the messages that moved a link of the chain.
    Tf { topics: Vec<(usize, usize)>, fixed: String, frame: String },
}

/// An event.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Its name.
    pub name: String,
    /// Where it comes from.
    pub source: EventSource,
    /// The fields that are read of it; [`Kind::EventField`] names one by its number.
    pub fields: Vec<EventField>,
    /// It occurs only when this holds, over its own fields.
    pub when: Option<Expr>,
}

/// A field of an event.
#[derive(Clone, Debug, PartialEq)]
pub struct EventField {
    /// The way to it.
    pub path: Path,
    /// For a message event: the number of that field in its topic's wanted fields.
    pub wanted: Option<usize>,
    /// Its type.
    pub ty: Type,
}

/// Where an [`Event`] comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum EventSource {
    /// An event of that name, from NDJSON or the API.
    Named,
    /// Every message of a topic.
    Message { topic: usize },
    /// A machine entered a state.
    Entered { machine: usize, state: usize },
    /// A machine left a state.
    Left { machine: usize, state: usize },
    /// A call, a return or a field's change of a running program: no recording has it.
    Point(Point),
    /// A service's half, a port or an activity of a component: no recording has it; the text says which.
    Program(String),
}

impl EventSource {
    /// The machine whose event it is.
    pub fn machine(&self) -> Option<usize> {
        match *self {
            EventSource::Entered { machine, .. } | EventSource::Left { machine, .. } => Some(machine),
            _ => None,
        }
    }
}

/// A point in the run of a program that can be seen from outside: AspectJ's join point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Point {
    /// What happens there.
    pub kind: PointKind,
    /// The function, `A::f`, or the field, `A.x`, by its segments; empty for any function.
    pub path: Vec<String>,
    /// Only while a call of this function is active.
    pub below: Option<Vec<String>>,
}

/// What happens at a [`Point`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum PointKind {
    /// A function is called.
    Call,
    /// A function returns.
    Return,
    /// A field gets a value.
    Set,
}

impl fmt::Display for Point {
    /// As it is written: `set SensorController.sonar below Kicker::ball_close`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (word, joint) = match self.kind {
            PointKind::Call => ("call", "::"),
            PointKind::Return => ("return", "::"),
            PointKind::Set => ("set", "."),
        };
        f.write_str(word)?;
        if !self.path.is_empty() {
            write!(f, " {}", self.path.join(joint))?;
        }
        self.below.as_ref().map_or(Ok(()), |below| write!(f, " below {}", below.join("::")))
    }
}

/// A state diagram.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// Its name.
    pub name: String,
    /// When it looks; `None`: at every position.
    pub sample: Option<Expr>,
    /// The state it stands in before the first sample.
    pub initial: usize,
    /// The states, in order of precedence.
    pub states: Vec<State>,
    /// Whether it keeps its state where no condition holds.
    pub else_stay: bool,
    /// The edges.
    pub edges: Vec<Edge>,
    /// What must be defined before it starts.
    pub reads: Vec<Read>,
    /// `Some` where it reads events alone: the events that make its positions.
    pub alphabet: Option<Vec<usize>>,
}

impl Machine {
    /// Its conditions: when it samples, then those of its states, then those of its edges.
    pub fn conditions(&self) -> impl Iterator<Item = &Expr> {
        let states = self.states.iter().filter_map(|s| s.when.as_ref());
        self.sample.iter().chain(states).chain(self.edges.iter().filter_map(|e| e.when.as_ref()))
    }
}

/// A state of a [`Machine`].
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Its name.
    pub name: String,
    /// Its condition.
    pub when: Option<Expr>,
    /// The event that enters it.
    pub on: Option<usize>,
    /// The longest stay.
    pub at_most: Option<Duration>,
    /// The shortest stay.
    pub at_least: Option<Duration>,
}

/// An edge of a [`Machine`].
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// From this state.
    pub from: usize,
    /// To this one.
    pub to: usize,
    /// Only at an instant at which this event occurs.
    pub on: Option<usize>,
    /// Only where this holds.
    pub when: Option<Expr>,
}

/// Something that must be defined before a property starts, as many positions back as it is looked at.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct Read {
    /// What.
    pub what: ReadOf,
    /// How many instants back: the sum of the depths of `@`, `delta` and `rate` above it, the greatest over all its uses.
    pub depth: usize,
}

/// What a [`Read`] needs.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum ReadOf {
    /// A value of this input.
    Input(usize),
    /// A message of this topic (`age`, `frequency`, `fresh`).
    Topic(usize),
}

/// A property, one instance of it where it stood under `for each` over a list or topics.
#[derive(Clone, Debug, PartialEq)]
pub struct Property {
    /// Its name, with its instance: `calm`, `line 12`, `line 4[robot1]`.
    pub name: String,
    /// The whole statement in the source.
    pub span: Span,
    /// The line of its first token, from 1.
    pub line: usize,
    /// Its source text: comments and outer blanks removed, newlines kept.
    pub text: String,
    /// What is judged.
    pub body: Body,
    /// What must be defined before it starts; machines that it reads by state add theirs.
    pub reads: Vec<Read>,
    /// The machines whose state it reads: their signals are among `reads`, their instants of `age` are its own too.
    pub machines: Vec<usize>,
    /// `Some` where it is over events alone: it steps only where one of these occurs.
    pub alphabet: Option<Vec<usize>>,
    /// `for each k of EVENT.field`, outermost first: one instance per value seen.
    pub slices: Vec<Slice>,
    /// Why it cannot be judged on this trace: it is inconclusive from the start.
    pub problem: Option<String>,
}

/// What a property is about.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// A formula as written, without the implicit `always` of the top.
    Formula(Expr),
    /// The moves of a machine.
    Machine(usize),
    /// Nothing that could be evaluated: see [`Property::problem`].
    None,
}

/// `for each k of EVENT.field`: [`Kind::Param`] with the slice's number is the value. Under it an event of the formula that has a
/// field of that name with another value does not occur.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// The event whose values make instances.
    pub event: usize,
    /// The field's path.
    pub field: Path,
    /// For each event of the formula: the number of that field among its [`Event::fields`], where it has it.
    pub fields: Vec<(usize, usize)>,
}

/// A physical dimension: exponents of length, time and angle; `None` where it is not known.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Dim(pub Option<[i8; 3]>);

/// A typed expression or formula.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: Kind,
    /// The type of its value: formulas are [`Type::Bool`].
    pub ty: Type,
    /// The dimension of its value; of a comparison, that of its operands.
    pub dim: Dim,
    /// Its place in the source; after a pattern's expansion, the place of the use.
    pub span: Span,
}

/// The kinds of expressions. `never` has become `always not`, `A !={m} B` stays a comparison.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A number, in SI units (seconds, metres, radians).
    Num(f64),
    /// A truth value.
    Bool(bool),
    /// A text.
    Str(String),
    /// The latest value of a signal.
    Input(usize),
    /// Whether an event occurs at this instant.
    Event(usize),
    /// A field of an event at an instant at which it occurs; elsewhere every comparison with it is false.
    EventField { event: usize, field: usize },
    /// Whether a machine stands in a state; `None` is `undefined`.
    InState { machine: usize, state: Option<usize> },
    /// Whether the signal got a value since this machine's last sample.
    Updated(Vec<usize>),
    /// The value of a slice.
    Param(usize),
    /// The variable of the so-many-th enclosing `any`/`all`, 0 the innermost.
    Var(usize),
    /// A field of a message.
    Field(Box<Expr>, String),
    /// An element of an array; NaN, or nothing, where it is out of range.
    Index(Box<Expr>, usize),
    /// A value of unknown type used as a condition: a number is true when neither zero nor NaN, a text is a fault.
    Truth(Box<Expr>),
    /// `-e`
    Neg(Box<Expr>),
    /// `+ - * /`
    Arith(Arith, Box<Expr>, Box<Expr>),
    /// A comparison, the margin zero where absent.
    Compare { op: Compare, margin: Option<Box<Expr>>, left: Box<Expr>, right: Box<Expr> },
    /// `not`
    Not(Box<Expr>),
    /// `and or implies iff`
    Connective(Connective, Box<Expr>, Box<Expr>),
    /// A function of values.
    Call(Func, Vec<Expr>),
    /// `any(array, v => body)` and `all`
    Quantified { all: bool, array: Box<Expr>, body: Box<Expr> },
    /// `@{e, -n}`
    Lookback(Box<Expr>, usize),
    /// `delta(e)`
    Delta(Box<Expr>),
    /// `rate(e)`
    Rate(Box<Expr>),
    /// `min_over(e, d)` and its like
    Window(Window, Box<Expr>, Duration),
    /// `age(/topic)`, seconds
    Age(usize),
    /// `frequency(/topic, d)`, Hz
    Frequency(usize, Duration),
    /// `fresh(/topic)`
    Fresh(usize),
    /// A past operator without operand beside: `previously`, `becomes`
    Previously(Box<Expr>),
    /// `becomes φ`
    Becomes(Box<Expr>),
    /// `once`
    Once(Bound, Box<Expr>),
    /// `historically`
    Historically(Bound, Box<Expr>),
    /// `left since right`
    Since(Bound, Box<Expr>, Box<Expr>),
    /// `held for d φ`
    Held(Duration, Box<Expr>),
    /// `always`
    Always(Bound, Box<Expr>),
    /// `eventually`
    Eventually(Bound, Box<Expr>),
    /// `next`
    Next(Box<Expr>),
    /// `left until right`
    Until(Bound, Box<Expr>, Box<Expr>),
    /// `after X, φ`, `until X, φ`, `before X, φ`, `while X, φ`, `whenever X, φ`
    Scope(Scope, Box<Expr>, Box<Expr>),
    /// `after_until X, Y, φ`
    AfterUntil(Box<Expr>, Box<Expr>, Box<Expr>),
}

/// A time bound: the positions at a distance from `lo` to `hi` are looked at.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Bound {
    /// The lower end.
    pub lo: Duration,
    /// Whether it is in.
    pub lo_closed: bool,
    /// The upper end, `None` where there is none.
    pub hi: Option<Duration>,
    /// Whether it is in.
    pub hi_closed: bool,
}

impl Bound {
    /// No bound at all.
    pub const ALL: Bound = Bound { lo: Duration::ZERO, lo_closed: true, hi: None, hi_closed: true };

    /// Whether a position at this distance is looked at.
    pub fn contains(&self, distance: Duration) -> bool {
        let after_lo = if self.lo_closed { distance >= self.lo } else { distance > self.lo };
        let before_hi = match self.hi {
            None => true,
            Some(hi) if self.hi_closed => distance <= hi,
            Some(hi) => distance < hi,
        };
        after_lo && before_hi
    }
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

impl Compare {
    /// The comparison with its sides exchanged.
    pub fn mirrored(self) -> Compare {
        match self {
            Compare::Lt => Compare::Gt,
            Compare::Le => Compare::Ge,
            Compare::Gt => Compare::Lt,
            Compare::Ge => Compare::Le,
            same => same,
        }
    }
}

/// Connectives.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Connective {
    And,
    Or,
    Implies,
    Iff,
}

/// Scopes of two parts.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Scope {
    After,
    Until,
    Before,
    While,
    Whenever,
}

/// Windows over the past.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Window {
    Min,
    Max,
    Mean,
    Count,
}

/// Functions of values.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Func {
    /// Absolute value.
    Abs,
    /// -1, 0 or 1; NaN of NaN.
    Sign,
    /// The least of the arguments that are not NaN; NaN where all are.
    Min,
    /// The greatest of the arguments that are not NaN.
    Max,
    /// Square root.
    Sqrt,
    /// Sine of radians.
    Sin,
    /// Cosine of radians.
    Cos,
    /// `atan2(y, x)`, radians.
    Atan2,
    /// Euclidean norm of the arguments: `sqrt(a*a + b*b + …)`, summed from the left.
    Norm,
    /// Roll of the quaternion `x, y, z, w`.
    Roll,
    /// Pitch.
    Pitch,
    /// Yaw.
    Yaw,
    /// `a - b` wrapped into `(-π, π]`.
    AngleDiff,
    /// The angle by which one quaternion must be turned to become the other: `x, y, z, w, x, y, z, w`.
    AngleBetween,
    /// Component `i` (0, 1, 2) of the vector `x, y, z` turned by the inverse of the quaternion `x, y, z, w`: `i, vector, quaternion`.
    IntoBody,
    /// Radians to degrees.
    Deg,
    /// Degrees to radians.
    Rad,
    /// Whether it is NaN.
    IsNan,
    /// The length of an array or a text (in characters).
    Len,
    /// The least element of an array, NaN skipped.
    MinOf,
    /// The greatest element of an array, NaN skipped.
    MaxOf,
    /// `lookup(names, values, name)`: the value beside the name; NaN, or nothing, where there is none.
    Lookup,
    /// `starts_with(text, beginning)`
    StartsWith,
    /// `ends_with(text, end)`
    EndsWith,
    /// `contains(text, part)`
    Contains,
}

/// The expressions directly below one of this kind, from left to right: borrowed as the kind is.
macro_rules! children {
    ($kind:expr, $iter:ident) => {
        match $kind {
            Kind::Num(_) | Kind::Bool(_) | Kind::Str(_) | Kind::Input(_) | Kind::Event(_) | Kind::EventField { .. } => {
                Vec::new()
            }
            Kind::InState { .. } | Kind::Updated(_) | Kind::Param(_) | Kind::Var(_) => Vec::new(),
            Kind::Age(_) | Kind::Frequency(..) | Kind::Fresh(_) => Vec::new(),
            Kind::Field(e, _) | Kind::Index(e, _) | Kind::Truth(e) | Kind::Neg(e) | Kind::Not(e) => vec![e],
            Kind::Lookback(e, _) | Kind::Delta(e) | Kind::Rate(e) | Kind::Window(_, e, _) => vec![e],
            Kind::Previously(e) | Kind::Becomes(e) | Kind::Once(_, e) | Kind::Historically(_, e) | Kind::Held(_, e) => {
                vec![e]
            }
            Kind::Always(_, e) | Kind::Eventually(_, e) | Kind::Next(e) => vec![e],
            Kind::Arith(_, l, r) | Kind::Connective(_, l, r) | Kind::Since(_, l, r) => vec![l, r],
            Kind::Until(_, l, r) | Kind::Scope(_, l, r) => vec![l, r],
            Kind::Quantified { array, body, .. } => vec![array, body],
            Kind::AfterUntil(x, y, f) => vec![x, y, f],
            Kind::Call(_, args) => args.$iter().collect(),
            Kind::Compare { margin, left, right, .. } => match margin {
                Some(m) => vec![left, m, right],
                None => vec![left, right],
            },
        }
    };
}

impl Expr {
    /// Whether a future operator occurs in it.
    pub fn has_future(&self) -> bool {
        let future = matches!(
            self.kind,
            Kind::Always(..)
                | Kind::Eventually(..)
                | Kind::Next(_)
                | Kind::Until(..)
                | Kind::Scope(..)
                | Kind::AfterUntil(..)
        );
        future || self.children().iter().any(|c| c.has_future())
    }

    /// The expressions directly below it, from left to right.
    pub fn children(&self) -> Vec<&Expr> {
        children!(&self.kind, iter)
    }

    /// See [`Expr::children`].
    pub fn children_mut(&mut self) -> Vec<&mut Expr> {
        children!(&mut self.kind, iter_mut)
    }
}
