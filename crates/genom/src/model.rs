//! What a specification means, as plain data: every name is resolved, every time is in nanoseconds, and everything knows its place in the text.
//!
//! Things are named by their number in a list of the component that owns them: [`TaskId`], [`ServiceId`], [`PortId`], [`CodelId`].

use lapwing_diag::Span;

pub use crate::ast::{Basic, Direction, ServiceKind, Source};

/// The number of a type in [`Model::types`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct TypeId(pub usize);
/// The number of a task in its component.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct TaskId(pub usize);
/// The number of a service in its component.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct ServiceId(pub usize);
/// The number of a port in its component.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct PortId(pub usize);
/// The number of a codel in its component.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct CodelId(pub usize);

/// A set of components.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// All types that have a name.
    pub types: Vec<TypeDef>,
    /// All constants, in the order of the text.
    pub constants: Vec<Constant>,
    /// The components, in the order of their first opening.
    pub components: Vec<Component>,
    /// Which in-port reads which out-port.
    pub links: Vec<Link>,
}

/// An in-port and the out-port of another component that it reads.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Link {
    /// The component, by its number, and the port that reads.
    pub reader: (usize, PortId),
    /// The component and the port that writes.
    pub writer: (usize, PortId),
}

/// A type.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Type {
    /// Without parts.
    Basic(Basic),
    /// A text, of a greatest length.
    Text(Option<u64>),
    /// Any number of elements, up to a greatest one.
    Sequence(Box<Type>, Option<u64>),
    /// A value that may be missing.
    Optional(Box<Type>),
    /// A number with a fixed point: digits and scale.
    Fixed(Option<(u64, u64)>),
    /// A number of elements.
    Array(Box<Type>, u64),
    /// A type with a name.
    Named(TypeId),
}

/// A type with a name.
#[derive(Clone, Debug)]
pub struct TypeDef {
    /// The scopes that it is in, and its own name.
    pub path: Vec<String>,
    /// What it is.
    pub kind: TypeDefKind,
    /// Where it was declared.
    pub span: Span,
}

impl TypeDef {
    /// As a specification names it: `or::time::ts`.
    pub fn name(&self) -> String {
        self.path.join("::")
    }
}

/// Kinds of types with names.
#[derive(Clone, Debug)]
pub enum TypeDefKind {
    /// Members in their order.
    Struct(Vec<Field>),
    /// A member at a time.
    Union(Type, Vec<(Vec<Label>, Field)>),
    /// One of several names.
    Enum(Vec<String>),
    /// Another name for a type.
    Alias(Type),
    /// Something that only codels know.
    Native,
    /// What a codel may throw.
    Exception(Vec<Field>),
    /// Declared, and nowhere defined.
    Forward,
}

/// A value with a name.
#[derive(Clone, Debug)]
pub struct Constant {
    /// The scopes that it is in, and its own name.
    pub path: Vec<String>,
    /// Its type.
    pub ty: Type,
    /// What it is.
    pub value: Value,
}

/// The value for which a union has a member.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Label {
    /// An integer, a character, or 0 and 1 for false and true.
    Int(i128),
    /// A value of an enumeration.
    Name(String),
    /// All others.
    Default,
}

/// A member.
#[derive(Clone, Debug)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Its type.
    pub ty: Type,
    /// Where it was declared.
    pub span: Span,
}

/// A component.
#[derive(Clone, Debug, Default)]
pub struct Component {
    /// Its name.
    pub name: String,
    /// Where it was first opened.
    pub span: Span,
    /// What is said of it.
    pub doc: String,
    /// Its version; `0` where it has none.
    pub version: String,
    /// The language of its codels; `c` where it says none.
    pub lang: String,
    /// Whom to write to.
    pub email: String,
    /// Packages that it needs.
    pub requires: Vec<String>,
    /// Packages that its codels need.
    pub codels_requires: Vec<String>,
    /// The base clock's period in nanoseconds: that of which all periods and delays are multiples.
    pub clock_ns: Option<u64>,
    /// Its internal data, all of it a structure.
    pub ids: Option<TypeId>,
    /// Exceptions that any of its services may throw.
    pub throws: Vec<TypeId>,
    /// Its ports.
    pub ports: Vec<Port>,
    /// Its tasks.
    pub tasks: Vec<Task>,
    /// Its services.
    pub services: Vec<Service>,
    /// Services of others that its codels may call.
    pub remotes: Vec<Remote>,
    /// The codels of its tasks and services, those of tasks first; attributes are codels as well, of nobody's making.
    pub codels: Vec<Codel>,
}

/// A port.
#[derive(Clone, Debug)]
pub struct Port {
    /// Its name.
    pub name: String,
    /// Whether it is many ports under one name.
    pub multiple: bool,
    /// Whether the component writes it.
    pub is_out: bool,
    /// What flows through it.
    pub ty: Type,
    /// What is said of it.
    pub doc: String,
    /// Where it was declared.
    pub span: Span,
}

/// A task: a thread that runs activities.
#[derive(Clone, Debug)]
pub struct Task {
    /// Its name.
    pub name: String,
    /// Where it was declared.
    pub span: Span,
    /// What is said of it.
    pub doc: String,
    /// How often it runs; a task without a period waits for events.
    pub period_ns: Option<u64>,
    /// How much after the beginning of a period.
    pub delay_ns: Option<u64>,
    /// Its priority.
    pub priority: Option<u64>,
    /// Whether it asks for real-time scheduling.
    pub real_time: bool,
    /// The size of its stack in bytes.
    pub stack: Option<u64>,
    /// What its codels may throw.
    pub throws: Vec<TypeId>,
    /// The codels of its permanent activity.
    pub codels: Vec<CodelId>,
}

/// A service.
#[derive(Clone, Debug)]
pub struct Service {
    /// Its name.
    pub name: String,
    /// Which kind.
    pub kind: ServiceKind,
    /// Where it was declared.
    pub span: Span,
    /// What is said of it.
    pub doc: String,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// Data of its own.
    pub locals: Vec<Field>,
    /// The task that runs it, where it is an activity.
    pub task: Option<TaskId>,
    /// The codel that may refuse a request.
    pub validate: Option<CodelId>,
    /// Its other codels.
    pub codels: Vec<CodelId>,
    /// What its codels may throw.
    pub throws: Vec<TypeId>,
    /// Services that it interrupts.
    pub interrupts: Vec<ServiceId>,
    /// Services before the first success of which it is refused.
    pub after: Vec<ServiceId>,
    /// Services that are refused before its own first success.
    pub before: Vec<ServiceId>,
}

/// A parameter of a service.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Seen from the service; of an attribute, seen from the client.
    pub direction: Direction,
    /// Its type, where it could be resolved.
    pub ty: Option<Type>,
    /// What it is where a request does not say.
    pub default: Option<Value>,
    /// Where it was declared.
    pub span: Span,
}

/// A default value.
#[derive(Clone, PartialEq, Debug)]
pub enum Value {
    /// A whole number.
    Int(i128),
    /// A number.
    Float(f64),
    /// True or false.
    Bool(bool),
    /// A text.
    Text(String),
    /// A value of an enumeration.
    Name(String),
    /// Values of some members or elements.
    Parts(Vec<(Step, Value)>),
}

/// A service of another component.
#[derive(Clone, Debug)]
pub struct Remote {
    /// Its name.
    pub name: String,
    /// The interface that it comes from.
    pub interface: String,
    /// Where that one declared it.
    pub span: Span,
}

/// One step into a value.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Step {
    /// A member.
    Member(String),
    /// An element.
    Element(u64),
}

/// A codel: a function that does a piece of work without waiting.
#[derive(Clone, Debug)]
pub struct Codel {
    /// The function that is called; of an attribute, its name.
    pub function: String,
    /// Where it stands.
    pub span: Span,
    /// Whose it is.
    pub owner: Owner,
    /// When it is called.
    pub role: Role,
    /// What it is given.
    pub parameters: Vec<CodelParameter>,
    /// Its worst case execution time.
    pub wcet_ns: Option<u64>,
    /// Whether the task does not wait for it.
    pub is_async: bool,
}

/// Whose a codel is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Owner {
    /// A task: it belongs to its permanent activity.
    Task(TaskId),
    /// A service.
    Service(ServiceId),
}

/// When a codel is called.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Role {
    /// A state of a state machine.
    State {
        /// The events upon which it is called; the first names the state.
        triggers: Vec<String>,
        /// What it may return.
        yields: Vec<Transition>,
    },
    /// The work of a function or an attribute.
    Simple,
    /// Before a service is accepted.
    Validate,
    /// An attribute's own reading and writing.
    Attribute,
}

/// What a codel may return.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Transition {
    /// Whether it waits for the next period.
    pub pause: bool,
    /// The event.
    pub event: String,
    /// Where it leads.
    pub to: Target,
    /// Where it stands.
    pub span: Span,
}

/// Where a transition leads.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Target {
    /// A codel of the same state machine.
    Codel(CodelId),
    /// The end.
    Ether,
}

/// A parameter of a codel.
#[derive(Clone, Debug)]
pub struct CodelParameter {
    /// Its name for the codel.
    pub name: String,
    /// Which way it goes.
    pub direction: Direction,
    /// What it is.
    pub object: Object,
    /// Where it stands.
    pub span: Span,
}

/// What a parameter of a codel is.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Object {
    /// A part of the internal data; no steps are all of it.
    Ids(Vec<Step>),
    /// A parameter or local of the service, and the way into it.
    Local(String, Vec<Step>),
    /// A port.
    Port(PortId),
    /// A service of another component, by its number in [`Component::remotes`].
    Remote(usize),
    /// Something that could not be found because a file is missing.
    Unknown,
}

impl Model {
    /// The port in which what a port shows is kept: of one that reads another, that one, else itself.
    pub fn origin(&self, port: (usize, PortId)) -> (usize, PortId) {
        self.links.iter().find(|link| link.reader == port).map_or(port, |link| link.writer)
    }
}

impl Type {
    /// What it is behind its other names, among these types.
    pub fn behind<'t>(&'t self, types: &'t [TypeDef]) -> &'t Type {
        let mut ty = self;
        // A name is declared after what it stands for, so that this ends; the bound only holds it to that.
        for _ in 0..=types.len() {
            let Type::Named(id) = ty else { return ty };
            let Some(TypeDefKind::Alias(inner)) = types.get(id.0).map(|t| &t.kind) else { return ty };
            ty = inner;
        }
        ty
    }
}

impl Component {
    /// The service by that name.
    pub fn service(&self, name: &str) -> Option<ServiceId> {
        self.services.iter().position(|s| s.name == name).map(ServiceId)
    }

    /// The codels with their numbers.
    pub fn codels(&self) -> impl Iterator<Item = (CodelId, &Codel)> {
        self.codels.iter().enumerate().map(|(n, codel)| (CodelId(n), codel))
    }

    /// The service that something belongs to; none for what is a task's.
    pub fn service_of(&self, owner: Owner) -> Option<&Service> {
        match owner {
            Owner::Service(service) => self.services.get(service.0),
            Owner::Task(_) => None,
        }
    }

    /// The task that runs a codel; none for those of the control task.
    pub fn task_of(&self, codel: &Codel) -> Option<TaskId> {
        match codel.owner {
            Owner::Task(task) => Some(task),
            Owner::Service(service) if codel.is_state() => self.services.get(service.0)?.task,
            Owner::Service(_) => None,
        }
    }

    /// The activities that a task runs, in the order of their declaration.
    pub fn activities(&self, task: TaskId) -> impl Iterator<Item = ServiceId> {
        let of_task = move |service: &Service| service.kind == ServiceKind::Activity && service.task == Some(task);
        self.services.iter().enumerate().filter(move |(_, s)| of_task(s)).map(|(n, _)| ServiceId(n))
    }

    /// What a codel is called in messages and models: the state of its activity, or its function.
    pub fn codel_name(&self, codel: &Codel) -> String {
        let owner = match codel.owner {
            Owner::Task(task) => self.tasks.get(task.0).map(|t| &t.name),
            Owner::Service(service) => self.services.get(service.0).map(|s| &s.name),
        };
        let owner = owner.map_or("?", String::as_str);
        match &codel.role {
            Role::Attribute => owner.to_owned(),
            _ => format!("{owner}.{}", codel.label()),
        }
    }
}

impl Codel {
    /// Whether it is a state of a state machine.
    pub fn is_state(&self) -> bool {
        matches!(self.role, Role::State { .. })
    }

    /// Its state's name, or what it does for its service.
    pub fn label(&self) -> &str {
        match &self.role {
            Role::State { triggers, .. } => triggers.first().map_or(&*self.function, String::as_str),
            Role::Simple => "codel",
            Role::Validate => "validate",
            Role::Attribute => "attribute",
        }
    }

    /// The events upon which it is called.
    pub fn triggers(&self) -> &[String] {
        match &self.role {
            Role::State { triggers, .. } => triggers,
            _ => &[],
        }
    }

    /// What it may return.
    pub fn yields(&self) -> &[Transition] {
        match &self.role {
            Role::State { yields, .. } => yields,
            _ => &[],
        }
    }
}

impl Transition {
    /// As a specification writes it: `main` or `pause::main`.
    pub fn text(&self) -> String {
        format!("{}{}", if self.pause { "pause::" } else { "" }, self.event)
    }
}
