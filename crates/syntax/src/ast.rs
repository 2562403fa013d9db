//! The syntax tree of a specification, as written: nothing is resolved yet, and every node knows its place.

use lapwing_diag::Span;
use lapwing_stream::Duration;

/// A whole file: its statements in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct File {
    /// The statements.
    pub items: Vec<Item>,
}

/// One statement. `span` runs from its first token to its last: the source text of a property is what it covers.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// What it says.
    pub kind: ItemKind,
    /// Where it stands.
    pub span: Span,
}

/// The kinds of statements.
#[derive(Clone, Debug, PartialEq)]
pub enum ItemKind {
    /// `__rate__ = 30`, `clock events`
    Setting(Setting),
    /// `decl NAME /topic Type.field.path …`
    Decl(Decl),
    /// `model NAME: … ;`
    Model(Model),
    /// `world OBJECT …`
    World(World),
    /// `event NAME = …`
    Event(EventDecl),
    /// `machine NAME { … }`
    Machine(Machine),
    /// `pattern NAME(a, b): FORMULA`
    Pattern(Pattern),
    /// `use std.robot`, `use "mine.rv"`
    Use(Use),
    /// `on violation of NAME { … }`
    Reaction(Reaction),
    /// `guard /a from /b by NAME else drop`
    Guard(Guard),
    /// `property NAME: …`, `NAME: …` or a bare formula
    Property(Property),
    /// `NAME = …`: a named expression or a named formula; which one shows only when it is resolved
    Definition(Definition),
}

/// A name and its place. A name in backquotes is stored without them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ident {
    /// The name.
    pub name: String,
    /// Its place.
    pub span: Span,
}

/// A topic as written, with its leading slash or without (`cmd_vel_original`). In `topics /{r}/odom` it holds `{r}`; a per-object
/// `world * topics /{name}/gt` holds `{name}`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topic {
    /// As written.
    pub name: String,
    /// Its place.
    pub span: Span,
}

impl Topic {
    /// The name with its leading slash.
    pub fn absolute(&self) -> String {
        if self.name.starts_with('/') { self.name.clone() } else { format!("/{}", self.name) }
    }
}

/// A message type as written, with or without its package, followed by a path of fields: `geometry_msgs/Twist.linear.x`, `Vector3.linear.x`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TypePath {
    /// `geometry_msgs`, where given.
    pub package: Option<Ident>,
    /// `Twist`.
    pub name: Ident,
    /// `linear`, `x`; indices as [`PathPart::Index`].
    pub path: Vec<PathPart>,
    /// The whole.
    pub span: Span,
}

/// One step into a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PathPart {
    /// `.x`
    Field(Ident),
    /// `[3]`
    Index(usize, Span),
}

/// A setting of the file.
#[derive(Clone, Debug, PartialEq)]
pub enum Setting {
    /// `__rate__ = 30`, in Hz
    Rate(Number),
    /// `__timeout__ = 100`, in seconds (a duration is taken as well)
    Timeout(Number),
    /// `__margin__ = 0.01`
    Margin(Number),
    /// `clock events`
    ClockEvents,
}

/// A literal number as it stands in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// Its value, in the unit that follows it.
    pub value: f64,
    /// As written, without the unit: durations are computed from it exactly.
    pub text: String,
    /// The unit, where one follows.
    pub unit: Option<Unit>,
    /// The number and its unit.
    pub span: Span,
}

/// The units that may follow a literal.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Unit {
    Ns,
    Us,
    Ms,
    S,
    Min,
    H,
    Mm,
    Cm,
    M,
    Km,
    MPerS,
    MPerS2,
    Rad,
    RadPerS,
    Deg,
    DegPerS,
    Hz,
}

/// `decl estop /estop Bool.data default false stale after 2 s`
#[derive(Clone, Debug, PartialEq)]
pub struct Decl {
    /// The signal's name.
    pub name: Ident,
    /// The topic.
    pub topic: Topic,
    /// The type and the field.
    pub ty: TypePath,
    /// A value before the first message.
    pub default: Option<Expr>,
    /// Silence for longer makes what reads it inconclusive.
    pub stale: Option<Dur>,
}

/// `model robot1: position /odom Odometry.pose.pose.position ;`
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The object that is modelled.
    pub object: Ident,
    /// What it believes of itself.
    pub beliefs: Vec<Belief>,
}

/// One line of a `model`.
#[derive(Clone, Debug, PartialEq)]
pub struct Belief {
    /// `position`, `velocity`, `orientation`, …
    pub quantity: Ident,
    /// The topic.
    pub topic: Topic,
    /// The type and the field.
    pub ty: TypePath,
}

/// Where the ground truth of an object comes from. `object` is `None` for `world *`.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    /// The object, `None` for all.
    pub object: Option<Ident>,
    /// The source.
    pub source: WorldSource,
}

/// The kinds of ground truth.
#[derive(Clone, Debug, PartialEq)]
pub enum WorldSource {
    /// `world robot /gt/robot Odometry` and `world * topics /{name}/gt PoseStamped`
    Topic {
        /// The topic; with `{name}` in it where the object is `*`.
        topic: Topic,
        /// Odometry, PoseStamped, ModelStates.
        ty: TypePath,
    },
    /// `world robot tf map robot/base_link`: frames, no topics
    Tf {
        /// The ground-truth frame.
        fixed: Ident,
        /// The object's frame.
        frame: Ident,
    },
}

/// `event NAME = …` or `event NAME`
#[derive(Clone, Debug, PartialEq)]
pub struct EventDecl {
    /// Its name.
    pub name: Ident,
    /// Where it comes from; `None`: an event of that name from NDJSON or the API.
    pub source: Option<EventSource>,
    /// `when CONDITION`, over the event's fields.
    pub when: Option<Expr>,
    /// `below Kicker::ball_in_front`
    pub below: Option<CallPath>,
}

/// Where an event comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum EventSource {
    /// `call Kicker::play`
    Call(CallPath),
    /// `return Kicker::ready`
    Return(CallPath),
    /// `set SensorController.ball_dir_mod`
    Set(Vec<Ident>),
    /// `message /kick std_msgs/Bool`
    Message(Topic, Option<TypePath>),
    /// `request /set_mode`
    Request(Topic),
    /// `reply /set_mode`
    Reply(Topic),
    /// `write LaserDriver.Laser`
    Write(Vec<Ident>),
    /// `start | end | request | report Component.Activity`
    Activity(ActivityPhase, Vec<Ident>),
}

/// The moments of a GenoM3 activity.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum ActivityPhase {
    Start,
    End,
    Request,
    Report,
}

/// `Kicker::play`: segments joined by `::`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CallPath {
    /// The segments.
    pub segments: Vec<Ident>,
}

/// A state diagram.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// Its name.
    pub name: Ident,
    /// `sample when CONDITION`
    pub sample: Option<Expr>,
    /// `initial NAME`
    pub initial: Option<Ident>,
    /// The states in order of precedence.
    pub states: Vec<State>,
    /// `else stay`
    pub else_stay: bool,
    /// The edges; `a -> b | c` gives two.
    pub edges: Vec<Edge>,
}

/// `state goto_ball when …`, `state over on game_over`, `state docking at most 30 s`
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Its name.
    pub name: Ident,
    /// `when CONDITION`
    pub when: Option<Expr>,
    /// `on EVENT`
    pub on: Option<Ident>,
    /// `at most d`
    pub at_most: Option<Dur>,
    /// `at least d`
    pub at_least: Option<Dur>,
    /// The whole line.
    pub span: Span,
}

/// `a -> b on EVENT when CONDITION`
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// From.
    pub from: Ident,
    /// To.
    pub to: Ident,
    /// `on EVENT`
    pub on: Option<Ident>,
    /// `when CONDITION`
    pub when: Option<Expr>,
}

/// `pattern NAME(a, b): FORMULA`
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// Its name.
    pub name: Ident,
    /// Its parameters.
    pub params: Vec<Ident>,
    /// What it stands for.
    pub body: Expr,
}

/// `use std.robot` or `use "mine.rv"`
#[derive(Clone, Debug, PartialEq)]
pub enum Use {
    /// A shipped library.
    Library(Vec<Ident>),
    /// A file, relative to this one.
    File(String, Span),
}

/// `on violation of p at most every 1 s { … }`
#[derive(Clone, Debug, PartialEq)]
pub struct Reaction {
    /// The property.
    pub property: Ident,
    /// `at most every d`
    pub at_most_every: Option<Dur>,
    /// What to do, in order.
    pub actions: Vec<Action>,
}

/// What a reaction does.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// `publish /topic pkg/Type { … }`
    Publish(Topic, TypePath, Literal),
    /// `call /service pkg/Type { … }`
    Call(Topic, TypePath, Literal),
    /// `request Component.Activity`
    Request(Vec<Ident>),
    /// `run handler`
    Run(Ident),
    /// `reset`
    Reset(Span),
    /// `stop`
    Stop(Span),
}

/// A message written out: `{ linear: { x: 0.0 }, name: ["a"] }`
#[derive(Clone, Debug, PartialEq)]
pub enum Literal {
    /// A number, boolean, string or constant expression.
    Value(Box<Expr>),
    /// An array.
    List(Vec<Literal>, Span),
    /// A message.
    Record(Vec<(Ident, Literal)>, Span),
}

/// `guard /cmd_vel from /cmd_vel_raw by speed_limit else drop`
#[derive(Clone, Debug, PartialEq)]
pub struct Guard {
    /// Where messages go.
    pub to: Topic,
    /// Where they come from.
    pub from: Topic,
    /// While this property stands.
    pub property: Ident,
    /// Else: drop (`None`) or publish this instead.
    pub instead: Option<(TypePath, Literal)>,
    /// `fail open`; the default is `fail closed`.
    pub fail_open: bool,
}

/// `property NAME over (a, b): for each r in (…): FORMULA`; without a name it is called by its line.
#[derive(Clone, Debug, PartialEq)]
pub struct Property {
    /// Its name.
    pub name: Option<Ident>,
    /// `over (a, entered(m.s))`: names of events, and events of state diagrams.
    pub over: Option<Vec<Expr>>,
    /// The quantifiers, outermost first.
    pub each: Vec<ForEach>,
    /// The formula.
    pub body: Expr,
}

/// `NAME = …`
#[derive(Clone, Debug, PartialEq)]
pub struct Definition {
    /// The name.
    pub name: Ident,
    /// `for each` quantifiers, where the definition is a property.
    pub each: Vec<ForEach>,
    /// What it stands for.
    pub body: Expr,
}

/// `for each r in (robot1, robot2):`
#[derive(Clone, Debug, PartialEq)]
pub struct ForEach {
    /// The variable.
    pub var: Ident,
    /// Over what it runs.
    pub set: EachSet,
}

/// Over what a `for each` runs.
#[derive(Clone, Debug, PartialEq)]
pub enum EachSet {
    /// `in (robot1, robot2)`
    List(Vec<Ident>),
    /// `in topics /{r}/odom`
    Topics(Topic),
    /// `of EVENT.field` (`of call.robot` for a span's field)
    Values(Ident, Vec<Ident>),
}

/// An expression or a formula: one tree for both.
#[derive(Clone, Debug, PartialEq)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it stands, without brackets around it.
    pub span: Span,
    /// Whether it stood in brackets of its own: the lint on mixing `and` with `or` needs to know.
    pub parens: bool,
}

/// The kinds of expressions.
#[derive(Clone, Debug, PartialEq)]
pub enum ExprKind {
    /// `2.0`, `2.0 m/s`, `100 ms`
    Number(Number),
    /// `"text"`
    Str(String),
    /// `true`, `false`
    Bool(bool),
    /// `robot.distance.stop_sign`: identifiers joined by dots, at least one.
    Path(Vec<Ident>),
    /// `/scan`, as an argument of a function
    Topic(Topic),
    /// `e.field` where `e` is not a plain path
    Field(Box<Expr>, Ident),
    /// `e[3]`
    Index(Box<Expr>, usize),
    /// `name(arg, …)`: a function or a pattern
    Call(Ident, Vec<Expr>),
    /// `v => v.name == "x"`
    Lambda(Ident, Box<Expr>),
    /// `@{e, -3}`; the number is the depth, here 3
    Lookback(Box<Expr>, usize),
    /// `-e`
    Neg(Box<Expr>),
    /// `not f`
    Not(Box<Expr>),
    /// Arithmetic, comparison or a connective.
    Binary(Binary, Box<Expr>, Box<Expr>),
    /// A comparison with a margin of its own: `A <{m} B`
    WithMargin(Binary, Box<Expr>, Box<Expr>, Box<Expr>),
    /// `always within 2 s f` and its like; only some take a bound
    Prefix(Prefix, Option<Bound>, Box<Expr>),
    /// `f until within 2 s g`, `f since g`
    Infix(Infix, Option<Bound>, Box<Expr>, Box<Expr>),
    /// `held for d f`
    Held(Dur, Box<Expr>),
    /// `after X, f` and its like
    Scope(Scope, Box<Expr>, Box<Expr>),
    /// `after_until X, Y, f`
    AfterUntil(Box<Expr>, Box<Expr>, Box<Expr>),
    /// `ltl(f)`, `f` having been read in the symbolic notation and turned into the nodes above
    Ltl(Box<Expr>),
    /// What could not be parsed; an error has been reported.
    Error,
}

impl Expr {
    /// The expressions directly below it, from left to right.
    pub fn children(&self) -> Vec<&Expr> {
        match &self.kind {
            ExprKind::Number(_) | ExprKind::Str(_) | ExprKind::Bool(_) | ExprKind::Path(_) => Vec::new(),
            ExprKind::Topic(_) | ExprKind::Error => Vec::new(),
            ExprKind::Field(e, _) | ExprKind::Index(e, _) | ExprKind::Lambda(_, e) | ExprKind::Lookback(e, _) => {
                vec![e]
            }
            ExprKind::Neg(e) | ExprKind::Not(e) | ExprKind::Ltl(e) => vec![e],
            ExprKind::Prefix(_, _, e) | ExprKind::Held(_, e) => vec![e],
            ExprKind::Binary(_, l, r) | ExprKind::Infix(_, _, l, r) | ExprKind::Scope(_, l, r) => vec![l, r],
            ExprKind::WithMargin(_, l, m, r) => vec![l, m, r],
            ExprKind::AfterUntil(x, y, f) => vec![x, y, f],
            ExprKind::Call(_, args) => args.iter().collect(),
        }
    }
}

/// Binary operators without time.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
    And,
    Or,
    Implies,
    Iff,
}

/// Temporal words before a formula.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Prefix {
    Always,
    Never,
    Eventually,
    Next,
    Previously,
    Once,
    Historically,
    Becomes,
}

/// Temporal words between formulas.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Infix {
    Until,
    Since,
}

/// The scopes of two parts. (`after_until` has three.)
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Scope {
    After,
    Until,
    Before,
    While,
    Whenever,
}

/// A duration, or the name of one.
#[derive(Clone, Debug, PartialEq)]
pub enum Dur {
    /// `100 ms`
    Literal(Duration, Span),
    /// A named expression or a pattern's parameter.
    Name(Ident),
}

/// A time bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// The lower end, `None` where it is zero by `within d`.
    pub lo: Option<Dur>,
    /// Whether the lower end itself is in.
    pub lo_closed: bool,
    /// The upper end.
    pub hi: Dur,
    /// Whether the upper end itself is in.
    pub hi_closed: bool,
    /// The whole bound.
    pub span: Span,
}
