//! The tree of a package, as written: nothing is resolved yet, and every node knows its place.
//!
//! Programs may build trees as well as the parser does: all is plain data, the place of a node without a text is
//! [`Span::default`], and [`crate::print`] writes a tree as text. A declaration of several things
//! (`data int x, y`) is several declarations here.

mod build;
mod expr;

pub use expr::{BinaryOp, Expr, ExprKind, Literal, Stmt, StmtKind, UnaryOp};
use lapwing_diag::Span;

/// A name and its place.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Name {
    /// The name.
    pub text: String,
    /// Its place.
    pub span: Span,
}

/// Names joined by dots, at least one: a type of a package, a port of a component, a variable of a port.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Path {
    /// The names.
    pub parts: Vec<Name>,
}

/// A package: one file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Package {
    /// Comments in front of it, each a line.
    pub notes: Vec<String>,
    /// `@cpp(include="f.hpp")`, for compilers.
    pub annotations: Vec<Annotation>,
    /// Its name.
    pub name: Path,
    /// The packages whose declarations it may name.
    pub uses: Vec<Path>,
    /// What it declares, in order.
    pub decls: Vec<Decl>,
}

/// `@cpp(include="f.hpp", src)`: a remark for a compiler. The engine heeds none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Annotation {
    /// Whom it is for.
    pub name: Name,
    /// Keys with their values.
    pub entries: Vec<(Name, Option<AnnotationValue>)>,
}

/// The value of a key of an annotation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AnnotationValue {
    /// A word.
    Word(String),
    /// A text.
    Text(String),
}

/// A declaration of a package.
#[derive(Clone, Debug, PartialEq)]
pub struct Decl {
    /// Comments in front of it, each a line.
    pub notes: Vec<String>,
    /// Remarks for compilers.
    pub annotations: Vec<Annotation>,
    /// What is declared.
    pub kind: DeclKind,
    /// From its first token to its last.
    pub span: Span,
}

/// The kinds of declarations.
#[derive(Clone, Debug, PartialEq)]
pub enum DeclKind {
    /// `const data int N = 3`
    Const(ConstData),
    /// `extern data type frame refine blob as "Frame"`
    ExternType(ExternType),
    /// `extern function int next(int)`
    ExternFunction(ExternFunction),
    /// `extern operator bool ==(frame, frame)`
    ExternOperator(ExternOperator),
    /// `port type Pose(float x, float y)`
    Port(PortType),
    /// `connector type …`
    Connector(ConnectorType),
    /// `atom type …`
    Atom(AtomType),
    /// `compound type …`
    Compound(CompoundType),
}

/// A constant of the package.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstData {
    /// Its type.
    pub ty: Path,
    /// Its name.
    pub name: Name,
    /// Its value.
    pub value: Expr,
}

/// A type that the language does not look into.
#[derive(Clone, Debug, PartialEq)]
pub struct ExternType {
    /// Its name.
    pub name: Name,
    /// Types as which it can be used.
    pub refines: Vec<Path>,
    /// What a compiler calls it.
    pub backend: Option<String>,
}

/// A parameter of a type or function.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Whether it may only be read.
    pub is_const: bool,
    /// Its type.
    pub ty: Path,
    /// Its name; functions may leave it out.
    pub name: Option<Name>,
}

/// A function that the surroundings provide.
#[derive(Clone, Debug, PartialEq)]
pub struct ExternFunction {
    /// What it gives, if anything.
    pub result: Option<Path>,
    /// Its name.
    pub name: Name,
    /// What it takes.
    pub params: Vec<Param>,
}

/// An operator on external types that the surroundings provide.
#[derive(Clone, Debug, PartialEq)]
pub struct ExternOperator {
    /// What it gives.
    pub result: Path,
    /// As written: `==`, `+`.
    pub operator: String,
    /// Its place.
    pub span: Span,
    /// What it takes: one or two.
    pub params: Vec<Param>,
}

/// A type of ports: what a port shows of its component.
#[derive(Clone, Debug, PartialEq)]
pub struct PortType {
    /// Its name.
    pub name: Name,
    /// The variables that are seen through it.
    pub params: Vec<Param>,
}

/// A type of connectors.
#[derive(Clone, Debug, PartialEq)]
pub struct ConnectorType {
    /// Its name.
    pub name: Name,
    /// The ports that it connects: type and name.
    pub ports: Vec<(Path, Name)>,
    /// Variables of its own.
    pub data: Vec<Data>,
    /// The port through which it can be connected in its turn.
    pub export: Option<Port>,
    /// Which sets of ports interact.
    pub define: Vec<PortExpr>,
    /// `resume sync`: when the components may go on; the engine reads it and makes nothing of it.
    pub resume: Option<Name>,
    /// What single interactions do.
    pub interactions: Vec<Interaction>,
}

/// A part of `define`: `p`, `p'`, `(p q)'`.
#[derive(Clone, Debug, PartialEq)]
pub struct PortExpr {
    /// What it consists of.
    pub kind: PortExprKind,
    /// Whether it may begin an interaction that others need not join.
    pub is_trigger: bool,
}

/// The kinds of parts of `define`.
#[derive(Clone, Debug, PartialEq)]
pub enum PortExprKind {
    /// One port.
    Port(Name),
    /// Several in brackets.
    Group(Vec<PortExpr>),
}

/// `on p q provided (…) up { … } down { … }`: what an interaction does.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Interaction {
    /// Comments in front of it, each a line.
    pub notes: Vec<String>,
    /// The ports that take part, and no others.
    pub ports: Vec<Name>,
    /// When it may happen.
    pub guard: Option<Expr>,
    /// What is computed before it is chosen: variables of the connector.
    pub up: Vec<Stmt>,
    /// What is done when it happens: variables of the ports.
    pub down: Vec<Stmt>,
    /// From `on` to the last token.
    pub span: Span,
}

/// A variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Data {
    /// Comments in front of it, each a line.
    pub notes: Vec<String>,
    /// Whether a compound may export it further.
    pub is_exported: bool,
    /// Its type.
    pub ty: Path,
    /// Its name.
    pub name: Name,
    /// Its first value; zero, false or empty where there is none.
    pub value: Option<Expr>,
}

/// A port with the variables that it shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Port {
    /// Its type.
    pub ty: Path,
    /// Its name.
    pub name: Name,
    /// Variables, one for each parameter of the type.
    pub args: Vec<Name>,
}

/// A type of atoms: a Petri net with data and clocks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AtomType {
    /// Its name.
    pub name: Name,
    /// Constants that each instance is given.
    pub params: Vec<Param>,
    /// Its variables.
    pub data: Vec<Data>,
    /// Its clocks.
    pub clocks: Vec<Clock>,
    /// Its ports.
    pub ports: Vec<AtomPort>,
    /// Its external ports.
    pub externals: Vec<ExternPort>,
    /// Its places.
    pub places: Vec<Name>,
    /// How it begins.
    pub initial: Initial,
    /// Its transitions, internal ones among them.
    pub transitions: Vec<Transition>,
    /// Its invariants.
    pub invariants: Vec<Invariant>,
    /// Its priorities.
    pub priorities: Vec<AtomPriority>,
}

/// A clock.
#[derive(Clone, Debug, PartialEq)]
pub struct Clock {
    /// Its name.
    pub name: Name,
    /// What its numbers count.
    pub unit: TimeUnit,
}

/// A port of an atom, or several that are seen as one from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct AtomPort {
    /// Comments in front of it, each a line.
    pub notes: Vec<String>,
    /// Whether it is seen from outside.
    pub is_exported: bool,
    /// The ports, all of one type. Several only where `merged` says as what they are seen.
    pub ports: Vec<Port>,
    /// The name by which it is seen from outside, where it has another one there.
    pub merged: Option<Name>,
}

/// A port that the surroundings trigger.
#[derive(Clone, Debug, PartialEq)]
pub struct ExternPort {
    /// Comments in front of it, each a line.
    pub notes: Vec<String>,
    /// The port.
    pub port: Port,
    /// What a compiler calls its class.
    pub backend: Option<String>,
    /// What becomes of an event for which the atom does not wait.
    pub policy: EventPolicy,
}

/// What becomes of an event for which the atom does not wait.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EventPolicy {
    /// It is kept until the atom waits for it.
    #[default]
    Remember,
    /// It is dropped.
    Ignore,
    /// It ends the run.
    Error,
}

/// The initial places, and what is done first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Initial {
    /// The places that are marked.
    pub places: Vec<Name>,
    /// What is done.
    pub body: Vec<Stmt>,
    /// When it must have been done.
    pub resume: Option<Resume>,
    /// From `initial` to the last token.
    pub span: Span,
}

/// `resume (…)`: the atom is stable again only when its action has been carried out, which has to happen while this holds. Without a
/// condition any time will do.
#[derive(Clone, Debug, PartialEq)]
pub struct Resume {
    /// The condition.
    pub guard: Option<Expr>,
    /// Its place.
    pub span: Span,
}

/// A transition.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Transition {
    /// Comments in front of it, each a line.
    pub notes: Vec<String>,
    /// The port that it is offered through; none for an internal one.
    pub port: Option<Name>,
    /// The places that it empties.
    pub from: Vec<Name>,
    /// The places that it marks.
    pub to: Vec<Name>,
    /// When it may be taken.
    pub guard: Option<Expr>,
    /// How pressing it is; lazy where nothing is said.
    pub urgency: Option<Urgency>,
    /// What it does.
    pub body: Vec<Stmt>,
    /// When it must have been done.
    pub resume: Option<Resume>,
    /// From `on` or `internal` to the last token.
    pub span: Span,
}

/// How pressing a transition is, in ascending order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Urgency {
    /// Time may pass beyond its guard.
    #[default]
    Lazy,
    /// Time may not pass the end of its guard.
    Delayable,
    /// Time may not pass while its guard holds.
    Eager,
}

/// `invariant i at p provided (…)`: what holds while the atom is there.
#[derive(Clone, Debug, PartialEq)]
pub struct Invariant {
    /// Comments in front of it, each a line.
    pub notes: Vec<String>,
    /// Its name.
    pub name: Name,
    /// The places that must all be marked; anywhere where there are none.
    pub places: Vec<Name>,
    /// What holds.
    pub guard: Expr,
    /// From `invariant` to the last token.
    pub span: Span,
}

/// `priority r low < high provided (…)` within an atom.
#[derive(Clone, Debug, PartialEq)]
pub struct AtomPriority {
    /// Comments in front of it, each a line.
    pub notes: Vec<String>,
    /// Its name.
    pub name: Name,
    /// The port that yields; all others where there is none.
    pub low: Option<Name>,
    /// The port that goes first; all others where there is none.
    pub high: Option<Name>,
    /// When it holds.
    pub guard: Option<Expr>,
    /// From `priority` to the last token.
    pub span: Span,
}

/// A type of compounds: components, and what connects them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CompoundType {
    /// Its name.
    pub name: Name,
    /// Constants that each instance is given.
    pub params: Vec<Param>,
    /// The components.
    pub components: Vec<Component>,
    /// The connectors.
    pub connectors: Vec<Connector>,
    /// The priorities.
    pub priorities: Vec<Priority>,
    /// What is seen from outside.
    pub exports: Vec<Export>,
}

/// `component T c(1, 2)`
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// Comments in front of it, each a line.
    pub notes: Vec<String>,
    /// An atom or a compound.
    pub ty: Path,
    /// Its name.
    pub name: Name,
    /// A value for each parameter of the type.
    pub args: Vec<Expr>,
}

/// `connector T c(A.p, B.q)`
#[derive(Clone, Debug, PartialEq)]
pub struct Connector {
    /// Comments in front of it, each a line.
    pub notes: Vec<String>,
    /// Its type.
    pub ty: Path,
    /// Its name.
    pub name: Name,
    /// A port for each port of the type.
    pub ports: Vec<Path>,
}

/// `priority r c:* < d: A.p, B.q provided (…)` among connectors.
#[derive(Clone, Debug, PartialEq)]
pub struct Priority {
    /// Comments in front of it, each a line.
    pub notes: Vec<String>,
    /// Its name.
    pub name: Name,
    /// The interactions that yield.
    pub low: Side,
    /// The interactions that go first.
    pub high: Side,
    /// When it holds.
    pub guard: Option<Expr>,
    /// From `priority` to the last token.
    pub span: Span,
}

/// The interactions that a priority speaks of.
#[derive(Clone, Debug, PartialEq)]
pub enum Side {
    /// `*:*`: all others.
    Any(Span),
    /// `c:*`: those of a connector.
    Connector(Name),
    /// `c: A.p, B.q`: the one between these ports.
    Interaction(Name, Vec<Path>),
}

/// `export port A.p as q`, `export data A.x as y`
#[derive(Clone, Debug, PartialEq)]
pub struct Export {
    /// Comments in front of it, each a line.
    pub notes: Vec<String>,
    /// Whether it is a variable and not a port.
    pub is_data: bool,
    /// What is exported; several ports are seen as one.
    pub what: Vec<Path>,
    /// The name by which it is seen from outside.
    pub name: Name,
}

/// What a clock counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeUnit {
    /// 1 ns.
    Nanosecond,
    /// 1 000 ns.
    Microsecond,
    /// 1 000 000 ns.
    Millisecond,
    /// 10⁹ ns: where nothing is said.
    #[default]
    Second,
    /// 60 s.
    Minute,
    /// 60 min.
    Hour,
    /// 24 h.
    Day,
}

impl TimeUnit {
    /// All units, the shortest first.
    pub const ALL: [TimeUnit; 7] = [
        TimeUnit::Nanosecond,
        TimeUnit::Microsecond,
        TimeUnit::Millisecond,
        TimeUnit::Second,
        TimeUnit::Minute,
        TimeUnit::Hour,
        TimeUnit::Day,
    ];

    /// As written.
    pub fn word(self) -> &'static str {
        match self {
            TimeUnit::Nanosecond => "nanosecond",
            TimeUnit::Microsecond => "microsecond",
            TimeUnit::Millisecond => "millisecond",
            TimeUnit::Second => "second",
            TimeUnit::Minute => "minute",
            TimeUnit::Hour => "hour",
            TimeUnit::Day => "day",
        }
    }

    /// Its length in nanoseconds.
    pub fn nanoseconds(self) -> i64 {
        match self {
            TimeUnit::Nanosecond => 1,
            TimeUnit::Microsecond => 1_000,
            TimeUnit::Millisecond => 1_000_000,
            TimeUnit::Second => 1_000_000_000,
            TimeUnit::Minute => 60_000_000_000,
            TimeUnit::Hour => 3_600_000_000_000,
            TimeUnit::Day => 86_400_000_000_000,
        }
    }
}

impl Urgency {
    /// As written.
    pub fn word(self) -> &'static str {
        match self {
            Urgency::Lazy => "lazy",
            Urgency::Delayable => "delayable",
            Urgency::Eager => "eager",
        }
    }
}

impl EventPolicy {
    /// As written.
    pub fn word(self) -> &'static str {
        match self {
            EventPolicy::Remember => "remember",
            EventPolicy::Ignore => "ignore",
            EventPolicy::Error => "error",
        }
    }
}

impl Path {
    /// The path as written.
    pub fn text(&self) -> String {
        let parts: Vec<&str> = self.parts.iter().map(|p| p.text.as_str()).collect();
        parts.join(".")
    }

    /// From its first name to its last.
    pub fn span(&self) -> Span {
        match (self.parts.first(), self.parts.last()) {
            (Some(first), Some(last)) => first.span.to(last.span),
            _ => Span::default(),
        }
    }
}
