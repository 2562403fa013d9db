//! Checked types: what each declaration means, before there are instances.

use crate::ast::{EventPolicy, Urgency};
use crate::code::{Bool, Expr, Guard, Slot, Stmt};
use crate::host::Signature;
use crate::value::{Type, Value};
use lapwing_diag::Span;

/// All checked types of a package and of those that it uses.
#[derive(Clone, Debug, Default)]
pub(crate) struct Library {
    pub extern_types: Vec<ExternType>,
    pub functions: Vec<Signature>,
    pub port_types: Vec<PortType>,
    pub connectors: Vec<Connector>,
    pub atoms: Vec<Atom>,
    pub compounds: Vec<Compound>,
}

/// A type of the host's.
#[derive(Clone, Debug)]
pub(crate) struct ExternType {
    pub name: String,
    /// As which it can be used too.
    pub refines: Vec<Type>,
}

/// What ports of a type show.
#[derive(Clone, Debug)]
pub(crate) struct PortType {
    pub name: String,
    pub params: Vec<Shown>,
}

/// A variable that is seen through a port.
#[derive(Clone, Debug)]
pub(crate) struct Shown {
    pub name: String,
    pub ty: Type,
    pub is_const: bool,
}

/// A variable in a frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Var {
    pub name: String,
    pub ty: Type,
    pub slot: Slot,
}

/// The variables of a frame: how many there are of each kind.
#[derive(Clone, Debug, Default)]
pub(crate) struct Frame {
    pub vars: Vec<Var>,
    pub cells: u32,
    pub objects: u32,
}

impl Frame {
    /// A new variable.
    pub fn add(&mut self, name: &str, ty: Type) -> Slot {
        let count = if ty.is_plain() { &mut self.cells } else { &mut self.objects };
        let slot = *count;
        *count += 1;
        self.vars.push(Var { name: name.to_owned(), ty, slot });
        slot
    }
}

/// A type of connectors. Its frame holds its own variables, and behind them those of its ports.
#[derive(Clone, Debug)]
pub(crate) struct Connector {
    pub span: Span,
    /// Names and types of its ports.
    pub ports: Vec<(String, u32)>,
    pub frame: Frame,
    /// Its own variables: the first of the frame, with their first values.
    pub own: Vec<(Var, Value)>,
    /// For each port its variables.
    pub seen: Vec<Vec<Var>>,
    /// The type and the variables of the port through which it is connected in its turn.
    pub export: Option<(String, u32, Vec<Var>)>,
    /// The sets of ports that interact, with what is done then.
    pub sets: Vec<(Box<[u32]>, Option<u32>)>,
    pub actions: Vec<Action>,
}

/// What an interaction does.
#[derive(Clone, Debug)]
pub(crate) struct Action {
    pub guard: Option<Bool>,
    pub up: Vec<Stmt>,
    pub down: Vec<Stmt>,
}

/// A type of atoms. Its frame holds its parameters, and behind them its variables.
#[derive(Clone, Debug)]
pub(crate) struct Atom {
    pub span: Span,
    pub params: Vec<Var>,
    pub frame: Frame,
    /// Names of clocks.
    pub clocks: Vec<String>,
    /// Gives variables their first values.
    pub init: Vec<Stmt>,
    pub ports: Vec<Port>,
    pub exports: Vec<Exported>,
    /// Variables that compounds may export.
    pub exported_data: Vec<Var>,
    pub places: Vec<String>,
    pub initial: Box<[u32]>,
    pub begin: Vec<Stmt>,
    pub begin_resume: Option<Guard>,
    pub transitions: Vec<Transition>,
    pub invariants: Vec<Invariant>,
    pub priorities: Vec<AtomPriority>,
}

/// A port of an atom.
#[derive(Clone, Debug)]
pub(crate) struct Port {
    pub name: String,
    /// Names are those of the type's parameters.
    pub vars: Vec<Var>,
    pub is_exported: bool,
    /// Of an external port: what becomes of events that come early.
    pub external: Option<EventPolicy>,
}

/// A port as it is seen from outside: one of the atom, or one of several.
#[derive(Clone, Debug)]
pub(crate) struct Exported {
    pub name: String,
    pub port_type: u32,
    pub ports: Vec<u32>,
}

/// A transition.
#[derive(Clone, Debug)]
pub(crate) struct Transition {
    pub port: Option<u32>,
    pub from: Box<[u32]>,
    pub to: Box<[u32]>,
    /// None: always.
    pub guard: Option<Guard>,
    pub urgency: Urgency,
    pub body: Vec<Stmt>,
    pub resume: Option<Guard>,
}

/// An invariant of an atom.
#[derive(Clone, Debug)]
pub(crate) struct Invariant {
    pub name: String,
    pub places: Box<[u32]>,
    pub guard: Guard,
}

/// A priority within an atom; `None` is all others.
#[derive(Clone, Debug)]
pub(crate) struct AtomPriority {
    pub low: Option<u32>,
    pub high: Option<u32>,
    pub guard: Option<Bool>,
}

/// A type of compounds. Its frame holds its parameters.
#[derive(Clone, Debug)]
pub(crate) struct Compound {
    pub name: String,
    pub span: Span,
    pub frame: Frame,
    pub components: Vec<Component>,
    pub connectors: Vec<Connection>,
    pub priorities: Vec<Priority>,
    /// Name, type, and what is behind it.
    pub exports: Vec<(String, u32, Vec<Source>)>,
    /// Name, type, the component and its variable.
    pub exported_data: Vec<(String, Type, u32, String)>,
}

/// A component of a compound.
#[derive(Clone, Debug)]
pub(crate) struct Component {
    pub name: String,
    pub kind: Kind,
    pub args: Vec<Expr>,
    pub span: Span,
}

/// A type of components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Atom(u32),
    Compound(u32),
}

/// A connector of a compound.
#[derive(Clone, Debug)]
pub(crate) struct Connection {
    pub name: String,
    pub ty: u32,
    pub span: Span,
    /// What it connects, with the text that names it.
    pub ports: Vec<(Source, String)>,
}

/// What a port of a connector is bound to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// A port of a component.
    Component(u32, String),
    /// The exported port of a connector.
    Connector(u32),
}

/// A priority of a compound.
#[derive(Clone, Debug)]
pub(crate) struct Priority {
    pub low: Side,
    pub high: Side,
    pub guard: Option<PriorityGuard>,
}

/// When a priority holds: its frame holds the parameters of the compound, and behind them what components export.
#[derive(Clone, Debug)]
pub(crate) struct PriorityGuard {
    pub condition: Bool,
    /// Variables of components: which one, and its name there.
    pub seen: Vec<(Var, u32, String)>,
}

/// Interactions that a priority speaks of.
#[derive(Clone, Debug)]
pub(crate) enum Side {
    /// All of the compound.
    Any,
    /// Those of a connector.
    Connector(u32),
    /// The one of a connector between these of its ports.
    Interaction(u32, Box<[u32]>),
}
