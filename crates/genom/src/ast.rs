//! The tree of a specification: what was written, with places, before any name has been looked up.

use lapwing_diag::Span;

/// A name and where it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ident {
    /// The name.
    pub name: String,
    /// Where it stands.
    pub span: Span,
}

/// `a::b` or `::a::b`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScopedName {
    /// Whether it begins with `::`.
    pub absolute: bool,
    /// Its parts, at least one.
    pub parts: Vec<Ident>,
}

impl ScopedName {
    /// Where it stands.
    pub fn span(&self) -> Span {
        let first = self.parts.first().map(|p| p.span).unwrap_or_default();
        match self.parts.last() {
            Some(last) if last.span.file == first.file => first.to(last.span),
            _ => first,
        }
    }

    /// As it is written.
    pub fn text(&self) -> String {
        let parts: Vec<&str> = self.parts.iter().map(|p| p.name.as_str()).collect();
        format!("{}{}", if self.absolute { "::" } else { "" }, parts.join("::"))
    }
}

/// What stands at the top of a specification, or in a module.
#[derive(Clone, Debug)]
pub enum Item {
    /// `module m { … };`
    Module {
        /// Its name.
        name: Ident,
        /// What is in it.
        items: Vec<Item>,
    },
    /// A declaration of the interface definition language.
    Decl(Decl),
    /// `component` or `interface`.
    Body(Body),
    /// `#pragma …`, by its text.
    Pragma(Ident),
}

/// A declaration that may stand anywhere.
#[derive(Clone, Debug)]
pub enum Decl {
    /// `module m { … };` inside of a component.
    Module(Ident, Vec<Decl>),
    /// `const type name = value;`
    Const(Type, Ident, Expr),
    /// `typedef type a, b[2];`
    Typedef(Type, Vec<Declarator>),
    /// `struct s { … };` and its kind, or a forward declaration of one.
    Type(Type),
    /// `native n;`
    Native(Ident),
    /// `exception a, b { … };`
    Exception(Vec<(Ident, Vec<Member>)>),
}

/// A type as it is written.
#[derive(Clone, Debug)]
pub struct Type {
    /// What kind.
    pub kind: TypeKind,
    /// Where it stands.
    pub span: Span,
}

/// Kinds of types.
#[derive(Clone, Debug)]
pub enum TypeKind {
    /// A type of the language.
    Basic(Basic),
    /// `string` or `string<n>`.
    Text(Option<Box<Expr>>),
    /// `sequence<t>` or `sequence<t, n>`.
    Sequence(Box<Type>, Option<Box<Expr>>),
    /// `optional<t>`.
    Optional(Box<Type>),
    /// `fixed<digits, scale>`.
    Fixed(Option<Box<(Expr, Expr)>>),
    /// A type by its name.
    Named(ScopedName),
    /// `struct s { … }`.
    Struct(Ident, Vec<Member>),
    /// `union u switch (t) { … }`.
    Union(Ident, Box<Type>, Vec<Case>),
    /// `enum e { a, b }`.
    Enum(Ident, Vec<Ident>),
    /// `struct s;` or `union u;`: declared here, defined elsewhere.
    Forward(Ident, bool),
}

/// The types of the language that have no parts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Basic {
    Boolean,
    Short,
    UnsignedShort,
    Long,
    UnsignedLong,
    LongLong,
    UnsignedLongLong,
    Float,
    Double,
    Char,
    WideChar,
    Octet,
    Any,
}

/// `type a, b[2];` in a structure.
#[derive(Clone, Debug)]
pub struct Member {
    /// The type of all of them.
    pub ty: Type,
    /// Their names.
    pub declarators: Vec<Declarator>,
}

/// A name, and the lengths of the arrays that it is.
#[derive(Clone, Debug)]
pub struct Declarator {
    /// The name.
    pub name: Ident,
    /// From the outermost array inwards.
    pub lengths: Vec<Expr>,
}

/// A branch of a union.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its values; `None` is `default`.
    pub labels: Vec<Option<Expr>>,
    /// The type.
    pub ty: Type,
    /// The name.
    pub declarator: Declarator,
}

/// A constant expression.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What kind.
    pub kind: ExprKind,
    /// Where it stands.
    pub span: Span,
}

/// Kinds of constant expressions.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// `12`, `0x1f`, `017`.
    Int(u64),
    /// `1.5`.
    Float(f64),
    /// `TRUE` or `FALSE`.
    Bool(bool),
    /// `"text"`.
    Text(String),
    /// `'c'`.
    Char(char),
    /// A constant or an enumerator.
    Name(ScopedName),
    /// `-x`, `+x`, `~x`.
    Unary(char, Box<Expr>),
    /// Two operands and what joins them: `|`, `^`, `&`, `<<`, `>>`, `+`, `-`, `*`, `/`, `%`.
    Binary(&'static str, Box<Expr>, Box<Expr>),
}

/// A component or an interface, or a part of one: they may be opened again.
#[derive(Clone, Debug)]
pub struct Body {
    /// Whether it is an interface.
    pub is_interface: bool,
    /// Its name.
    pub name: Ident,
    /// What is in it.
    pub exports: Vec<Export>,
}

/// What stands in a component.
#[derive(Clone, Debug)]
pub enum Export {
    /// A declaration of the interface definition language.
    Decl(Decl),
    /// A property of the component.
    Property(Property),
    /// `ids { … };`
    Ids(Ident, Vec<Member>),
    /// `task t { … };`
    Task(Task),
    /// `port in type p;`
    Port(Port),
    /// `attribute`, `function` or `activity`.
    Service(Service),
}

/// A task.
#[derive(Clone, Debug)]
pub struct Task {
    /// Its name.
    pub name: Ident,
    /// What is said of it.
    pub properties: Vec<Property>,
}

/// A port.
#[derive(Clone, Debug)]
pub struct Port {
    /// Its name.
    pub name: Ident,
    /// Whether it is many ports under one name.
    pub multiple: bool,
    /// Whether the component writes it.
    pub is_out: bool,
    /// What flows through it.
    pub ty: Type,
    /// What is said of it.
    pub properties: Vec<Property>,
}

/// The kinds of services.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ServiceKind {
    /// Reads or writes internal data.
    Attribute,
    /// Runs at once, in the control task.
    Function,
    /// Runs for a while, in a task.
    Activity,
}

impl ServiceKind {
    /// The word that declares it.
    pub fn word(self) -> &'static str {
        match self {
            ServiceKind::Attribute => "attribute",
            ServiceKind::Function => "function",
            ServiceKind::Activity => "activity",
        }
    }
}

/// A service.
#[derive(Clone, Debug)]
pub struct Service {
    /// Which kind.
    pub kind: ServiceKind,
    /// Its name.
    pub name: Ident,
    /// The parameters of an attribute.
    pub members: Vec<AttributeParameter>,
    /// The parameters of a function or an activity.
    pub parameters: Vec<Parameter>,
    /// What is said of it.
    pub properties: Vec<Property>,
}

/// A direction.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Direction {
    /// Only read.
    In,
    /// Only written.
    Out,
    /// Both.
    InOut,
}

impl Direction {
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Direction::In => "in",
            Direction::Out => "out",
            Direction::InOut => "inout",
        }
    }

    /// Seen from the other side.
    pub fn inverted(self) -> Direction {
        match self {
            Direction::In => Direction::Out,
            Direction::Out => Direction::In,
            Direction::InOut => Direction::InOut,
        }
    }
}

/// A parameter that is a part of the internal data.
#[derive(Clone, Debug)]
pub struct AttributeParameter {
    /// Seen from the client.
    pub direction: Direction,
    /// Which part.
    pub path: Path,
    /// Its default, and what is said of it.
    pub init: Option<Init>,
}

/// A parameter with a type of its own.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Seen from the service.
    pub direction: Direction,
    /// Its type.
    pub ty: Type,
    /// Its name.
    pub declarator: Declarator,
    /// Its default, and what is said of it.
    pub init: Option<Init>,
}

/// `a.b[2].c::name`, or `::name` for all internal data.
#[derive(Clone, Debug)]
pub struct Path {
    /// What it begins with; `None` where it is all internal data.
    pub base: Option<Ident>,
    /// The way from there.
    pub steps: Vec<Step>,
    /// The name that the codel knows it by, where it is given another.
    pub renamed: Option<Ident>,
    /// Where it stands.
    pub span: Span,
}

/// One step of a path.
#[derive(Clone, Debug)]
pub enum Step {
    /// `.member`
    Member(Ident),
    /// `[2]`
    Element(Expr),
}

/// A default value and the text that explains it.
#[derive(Clone, Debug)]
pub struct Init {
    /// Which member or element it is for, where it says so.
    pub target: Option<Step>,
    /// The value.
    pub value: InitValue,
    /// What is said of it.
    pub doc: Option<String>,
    /// Where it stands.
    pub span: Span,
}

/// A default value.
#[derive(Clone, Debug)]
pub enum InitValue {
    /// None, only a text.
    None,
    /// One value.
    Value(Expr),
    /// Values in braces.
    List(Vec<Init>),
}

/// What is said of a component, a task, a port or a service.
#[derive(Clone, Debug)]
pub struct Property {
    /// The word that it begins with.
    pub word: Ident,
    /// What it says.
    pub kind: PropertyKind,
}

/// Kinds of properties.
#[derive(Clone, Debug)]
pub enum PropertyKind {
    /// `doc`, `version`, `lang`, `email`.
    Text(TextProperty, String),
    /// `require`, or `codels-require` where the flag is set.
    Require(bool, Vec<String>),
    /// `clock-rate`, `period`, `delay`.
    Time(TimeProperty, Quantity),
    /// `provides`, `uses`, `extends`.
    Interfaces(Relation, Vec<Ident>),
    /// `priority`.
    Priority(Expr),
    /// `scheduling real-time`.
    RealTime,
    /// `stack`, with what its unit multiplies it by.
    Stack(Expr, u64),
    /// `throw`.
    Throws(Vec<ScopedName>),
    /// `task`.
    Task(Ident),
    /// `interrupt`, `before`, `after`.
    Services(Order, Vec<Ident>),
    /// `validate`.
    Validate(Codel),
    /// `local`.
    Local(Type, Vec<Declarator>),
    /// `codel`.
    Codel(Codel),
}

/// Properties that are texts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum TextProperty {
    Doc,
    Version,
    Lang,
    Email,
}

/// Properties that are times.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum TimeProperty {
    ClockRate,
    Period,
    Delay,
}

/// What a component has to do with an interface.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Relation {
    Provides,
    Uses,
    Extends,
}

/// What a service has to do with others.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub enum Order {
    Interrupts,
    Before,
    After,
}

/// A number and the unit of time that multiplies it.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// The number.
    pub value: Expr,
    /// Nanoseconds in one of its unit.
    pub unit_ns: u64,
    /// Where it stands.
    pub span: Span,
}

/// A codel.
#[derive(Clone, Debug)]
pub struct Codel {
    /// The function that is called.
    pub function: Ident,
    /// The events that it is called upon; empty where it has no states.
    pub triggers: Vec<Event>,
    /// What it is given.
    pub parameters: Vec<CodelParameter>,
    /// The events that it may return; empty where it has no states.
    pub yields: Vec<Event>,
    /// Its worst case execution time.
    pub wcet: Option<Quantity>,
    /// Whether the task does not wait for it.
    pub is_async: bool,
}

/// `name` or `pause::name`.
#[derive(Clone, Debug)]
pub struct Event {
    /// Whether it waits for the next period.
    pub pause: bool,
    /// The name.
    pub name: Ident,
}

/// A parameter of a codel.
#[derive(Clone, Debug)]
pub struct CodelParameter {
    /// Where it comes from, where that is said.
    pub source: Option<Source>,
    /// Which way it goes.
    pub direction: Direction,
    /// What it is.
    pub path: Path,
}

/// Where a parameter of a codel comes from.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Source {
    /// Internal data.
    Ids,
    /// A parameter of the service, or a `local` of it.
    Local,
    /// A port.
    Port,
    /// A service of another component.
    Remote,
}

impl Source {
    /// The word for it.
    pub fn word(self) -> &'static str {
        match self {
            Source::Ids => "ids",
            Source::Local => "local",
            Source::Port => "port",
            Source::Remote => "remote",
        }
    }
}
