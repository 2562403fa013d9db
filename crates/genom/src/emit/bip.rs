//! RT-BIP, in the style of the paper: copies of variables, and a rendezvous for each edge that changes some (sections III-B2 and III-B4).
//!
//! Each automaton is an atom with the same locations, edges, guards, invariants and clock. An edge that changes a variable which others hold is
//! exported, and joined with a loop on every location of each other holder. The loops are neither guarded nor eager, so that they neither
//! hinder nor hurry; two edges that do the same to the copies of an automaton use one loop of it.

use std::collections::BTreeMap;

use lapwing_bip::ast::{
    AtomPort, AtomType, BinaryOp, Clock, Component, CompoundType, Connector, Data, Decl, DeclKind, Expr,
    ExternFunction, Initial, Invariant, Name, Package, Path, PortType, Resume, Stmt, TimeUnit, Transition, UnaryOp,
    Urgency,
};

use super::parts::{BASIC, atom_type, connector, noted, port, port_path, rendezvous, rendezvous_name};
use super::{Input, Sharing, names};
use crate::automata::{Action, Automaton, Class, ClockGuard, Cond, Edge, LocId, Part, System, VarId};

/// The package: a port type, connector types, an atom type for each automaton, and the compound `Root`.
pub fn bip(input: Input<'_>) -> Package {
    let mut writer = Writer { input, system: input.system, sharing: Sharing::of(input.system), copies: Vec::new() };
    writer.copies = vec![BTreeMap::new(); input.system.automata.len()];
    writer.package()
}

/// The loops of an automaton: what they do, and their names.
type Copies = BTreeMap<String, (String, Vec<Action>, Vec<String>)>;

struct Writer<'a> {
    input: Input<'a>,
    system: &'a System,
    sharing: Sharing,
    copies: Vec<Copies>,
}

impl Writer<'_> {
    fn package(&mut self) -> Package {
        let connectors = self.connectors();
        let mut decls = vec![noted(
            DeclKind::Port(PortType { name: BASIC.into(), params: Vec::new() }),
            "A port that passes nothing on.",
        )];
        let mut sizes: Vec<usize> = connectors.iter().map(|c| c.ports.len()).collect();
        sizes.sort_unstable();
        sizes.dedup();
        decls.extend(sizes.into_iter().map(rendezvous));
        decls.extend(self.functions());
        for (number, automaton) in self.system.automata.iter().enumerate() {
            let note = format!("{}: {}", self.input.line(automaton.span), what(automaton));
            decls.push(noted(DeclKind::Atom(self.atom(number, automaton)), &note));
        }
        let components = self.system.automata.iter().map(|automaton| Component {
            notes: Vec::new(),
            ty: atom_type(automaton).into(),
            name: names::bip(&automaton.name).into(),
            args: Vec::new(),
        });
        let root = CompoundType {
            name: "Root".into(),
            components: components.collect(),
            connectors,
            ..CompoundType::default()
        };
        decls.push(DeclKind::Compound(root).into());
        Package {
            notes: vec![
                format!("GenoM3 components {} as timed automata in RT-BIP.", self.system.name.replace('_', ", ")),
                "Made by a program. Comments name the lines of the specifications.".to_owned(),
            ],
            name: names::bip(&self.system.name).into(),
            decls,
            ..Package::default()
        }
    }

    /// A connector for each edge that changes what others hold, and one for each request, which somebody outside makes.
    fn connectors(&mut self) -> Vec<Connector> {
        let mut connectors = Vec::new();
        for (number, automaton) in self.system.automata.iter().enumerate() {
            for edge in &automaton.edges {
                let copies = self.sharing.copies(number, edge);
                if copies.is_empty() && edge.class != Class::Request {
                    continue;
                }
                let mut ports = vec![port_path(automaton, &edge.name)];
                for (other, actions) in copies {
                    let name = self.copy(other, actions, format!("{}.{}", automaton.name, edge.name));
                    ports.extend(self.system.automata.get(other).map(|automaton| port_path(automaton, &name)));
                }
                connectors.push(Connector {
                    notes: vec![format!("{}: {}", self.input.line(edge.span), class(edge.class))],
                    ty: rendezvous_name(ports.len()).into(),
                    name: connector(automaton, &edge.name).into(),
                    ports,
                });
            }
        }
        connectors
    }

    /// The loop of an automaton that does this to its copies.
    fn copy(&mut self, automaton: usize, actions: Vec<Action>, origin: String) -> String {
        let key = format!("{actions:?}");
        let Some(copies) = self.copies.get_mut(automaton) else { return String::new() };
        let number = copies.len() + 1;
        let (name, _, origins) = copies.entry(key).or_insert_with(|| (format!("copy_{number}"), actions, Vec::new()));
        origins.push(origin);
        name.clone()
    }

    /// The functions that are called, one for each codel's function of each component.
    fn functions(&self) -> Vec<Decl> {
        let mut all: BTreeMap<String, bool> = BTreeMap::new();
        for automaton in &self.system.automata {
            for edge in &automaton.edges {
                if let Some(call) = &edge.call {
                    *all.entry(function(automaton, edge)).or_default() |= call.result.is_some();
                }
            }
        }
        let one = |(name, has_result): (String, bool)| {
            let result = has_result.then(|| Path::from("int"));
            DeclKind::ExternFunction(ExternFunction { result, name: name.into(), params: Vec::new() }).into()
        };
        all.into_iter().map(one).collect()
    }

    fn atom(&self, number: usize, automaton: &Automaton) -> AtomType {
        let held = self.sharing.held(number);
        let copies = self.ordered(number);
        let unit = unit(automaton);
        let exported: Vec<bool> = automaton
            .edges
            .iter()
            .map(|e| e.class == Class::Request || !self.sharing.copies(number, e).is_empty())
            .collect();
        let mut ports: Vec<AtomPort> =
            automaton.edges.iter().zip(&exported).map(|(e, exported)| port(&e.name, *exported, Vec::new())).collect();
        ports.extend(copies.iter().map(|(name, _, origins)| port(name, true, vec![copied(origins)])));
        let mut transitions: Vec<Transition> =
            automaton.edges.iter().map(|e| self.transition(automaton, e, unit)).collect();
        for (name, actions, _) in &copies {
            let body: Vec<Stmt> = actions.iter().map(|a| self.stmt(a)).collect();
            transitions.extend(automaton.locations.iter().map(|location| {
                let place: Name = names::bip(&location.name).into();
                Transition {
                    port: Some(name.clone().into()),
                    from: vec![place.clone()],
                    to: vec![place],
                    body: body.clone(),
                    ..Transition::default()
                }
            }));
        }
        let invariants = automaton.locations.iter().filter_map(|location| {
            let guard = clock(BinaryOp::LessEqual, location.invariant_ns?, unit);
            let place: Name = names::bip(&location.name).into();
            let (name, notes) = (format!("in_{}", location.name).into(), vec![self.input.line(location.span)]);
            Some(Invariant { notes, name, places: vec![place], guard, span: Default::default() })
        });
        AtomType {
            name: atom_type(automaton).into(),
            data: held.iter().filter_map(|id| self.data(*id)).collect(),
            clocks: vec![Clock { name: "x".into(), unit }],
            ports,
            places: automaton.locations.iter().map(|l| names::bip(&l.name).into()).collect(),
            initial: Initial {
                places: automaton.locations.iter().take(1).map(|l| names::bip(&l.name).into()).collect(),
                body: held.iter().filter_map(|id| self.first(*id)).collect(),
                ..Initial::default()
            },
            transitions,
            invariants: invariants.collect(),
            ..AtomType::default()
        }
    }

    /// The loops of an automaton in the order of their numbers.
    fn ordered(&self, number: usize) -> Vec<&(String, Vec<Action>, Vec<String>)> {
        let mut all: Vec<_> = self.copies.get(number).into_iter().flat_map(BTreeMap::values).collect();
        all.sort_by_key(|(name, ..)| (name.len(), name.clone()));
        all
    }

    fn data(&self, id: VarId) -> Option<Data> {
        let variable = self.system.variables.get(id.0)?;
        let ty = if variable.is_bool { "bool" } else { "int" };
        Some(Data {
            notes: Vec::new(),
            is_exported: false,
            ty: ty.into(),
            name: variable.name.clone().into(),
            value: None,
        })
    }

    /// Gives a copy its first value, the same in every holder.
    fn first(&self, id: VarId) -> Option<Stmt> {
        let variable = self.system.variables.get(id.0)?;
        Some(Stmt::assign(variable.name.as_str(), self.value(id, variable.initial)))
    }

    fn transition(&self, automaton: &Automaton, edge: &Edge, unit: TimeUnit) -> Transition {
        let place =
            |id: LocId| automaton.locations.get(id.0).map(|l| Name::from(names::bip(&l.name))).into_iter().collect();
        let data = self.guard(&edge.guard);
        let time = edge.clock.map(|guard| match guard {
            ClockGuard::Positive => clock(BinaryOp::Greater, 0, unit),
            ClockGuard::Exactly(ns) => clock(BinaryOp::Equal, ns, unit),
        });
        let mut body = Vec::new();
        if let Some(call) = &edge.call {
            let name = function(automaton, edge);
            body.push(match &call.result {
                Some((var, _)) => Stmt::assign(self.name(*var), Expr::call(name, Vec::new())),
                None => Stmt::call(name, Vec::new()),
            });
        }
        body.extend(edge.actions.iter().map(|a| self.stmt(a)));
        if edge.resets {
            body.push(Stmt::assign("x", Expr::int(0)));
        }
        let mut notes = vec![format!("{}: {}", self.input.line(edge.span), class(edge.class))];
        if let Some((_, events)) = edge.call.as_ref().and_then(|c| c.result.as_ref()) {
            let events: Vec<String> = events.iter().enumerate().map(|(n, event)| format!("{n} for {event}")).collect();
            notes.push(format!("It returns {}.", events.join(", ")));
        }
        Transition {
            notes,
            port: Some(names::bip(&edge.name).into()),
            from: place(edge.from),
            to: place(edge.to),
            guard: Expr::all(data.into_iter().chain(time)),
            urgency: edge.eager.then_some(Urgency::Eager),
            body,
            resume: edge.call.as_ref().map(|call| Resume {
                guard: call.wcet_ns.map(|ns| clock(BinaryOp::LessEqual, ns, unit)),
                span: Default::default(),
            }),
            ..Transition::default()
        }
    }

    fn name(&self, id: VarId) -> &str {
        self.system.variables.get(id.0).map_or("", |v| v.name.as_str())
    }

    fn value(&self, id: VarId, value: i64) -> Expr {
        match self.system.variables.get(id.0) {
            Some(variable) if variable.is_bool => Expr::bool(value != 0),
            _ => Expr::int(value),
        }
    }

    /// A condition; `None` where it always holds.
    fn guard(&self, cond: &Cond) -> Option<Expr> {
        match cond {
            Cond::All(parts) => Expr::all(parts.iter().filter_map(|p| self.guard(p))),
            other => Some(self.cond(other)),
        }
    }

    fn cond(&self, cond: &Cond) -> Expr {
        let compared = |op: BinaryOp, var: VarId, value: i64| {
            let name = Expr::path(self.name(var));
            let is_bool = self.system.variables.get(var.0).is_some_and(|v| v.is_bool);
            match (op, is_bool) {
                (BinaryOp::Equal, true) if value != 0 => name,
                (BinaryOp::Equal, true) => Expr::unary(UnaryOp::Not, name),
                _ => Expr::binary(op, name, Expr::int(value)),
            }
        };
        match cond {
            Cond::Is(var, value) => compared(BinaryOp::Equal, *var, *value),
            Cond::Not(var, value) => compared(BinaryOp::NotEqual, *var, *value),
            Cond::Less(var, value) => compared(BinaryOp::Less, *var, *value),
            Cond::All(parts) => Expr::all(parts.iter().map(|p| self.cond(p))).unwrap_or(Expr::bool(true)),
            Cond::Any(parts) => {
                let any = parts.iter().map(|p| self.cond(p)).reduce(|a, b| Expr::binary(BinaryOp::Or, a, b));
                any.unwrap_or(Expr::bool(false))
            }
        }
    }

    fn stmt(&self, action: &Action) -> Stmt {
        match action {
            Action::Set(var, value) => Stmt::assign(self.name(*var), self.value(*var, *value)),
            Action::Add(var, value) => {
                let sum = Expr::binary(BinaryOp::Add, Expr::path(self.name(*var)), Expr::int(*value));
                Stmt::assign(self.name(*var), sum)
            }
            Action::If(cond, then, otherwise) => {
                let list = |actions: &[Action]| actions.iter().map(|a| self.stmt(a)).collect();
                // A branch must not be empty; where only the second does something, the condition is turned round.
                match then.is_empty() {
                    true => Stmt::choice(Expr::unary(UnaryOp::Not, self.cond(cond)), list(otherwise), Vec::new()),
                    false => Stmt::choice(self.cond(cond), list(then), list(otherwise)),
                }
            }
        }
    }
}

/// The function that an edge calls.
fn function(automaton: &Automaton, edge: &Edge) -> String {
    let location = automaton.locations.get(edge.from.0).map_or("", |l| l.name.as_str());
    format!("{}_call_{}", automaton.name, location.trim_end_matches("_exec"))
}

/// The coarsest unit in which all of an automaton's times are whole: a number with a fraction is not what it seems to the original compiler.
fn unit(automaton: &Automaton) -> TimeUnit {
    let invariants = automaton.locations.iter().filter_map(|l| l.invariant_ns);
    let guards = automaton.edges.iter().filter_map(|e| match e.clock {
        Some(ClockGuard::Exactly(ns)) => Some(ns),
        _ => None,
    });
    let calls = automaton.edges.iter().filter_map(|e| e.call.as_ref()?.wcet_ns);
    let times: Vec<u64> = invariants.chain(guards).chain(calls).collect();
    let fits = |unit: &TimeUnit| times.iter().all(|ns| ns.is_multiple_of(unit.nanoseconds().unsigned_abs()));
    let units = [TimeUnit::Millisecond, TimeUnit::Microsecond];
    units.into_iter().find(fits).unwrap_or(TimeUnit::Nanosecond)
}

fn clock(op: BinaryOp, ns: u64, unit: TimeUnit) -> Expr {
    let number = ns / unit.nanoseconds().unsigned_abs();
    Expr::binary(op, Expr::path("x"), Expr::int(i64::try_from(number).unwrap_or(i64::MAX)))
}

fn copied(origins: &[String]) -> String {
    const MOST: usize = 3;
    let shown = origins.get(..MOST).unwrap_or(origins).join(", ");
    let more = origins.len().saturating_sub(MOST);
    if more > 0 { format!("With {shown} and {more} more.") } else { format!("With {shown}.") }
}

pub(super) fn what(automaton: &Automaton) -> &'static str {
    match automaton.part {
        Part::Control => "the control task",
        Part::Timer => "the timer of a task",
        Part::Manager => "the manager of a task",
        Part::Permanent => "the permanent activity of a task",
        Part::Activity => "an instance of an activity",
    }
}

/// What an edge is for, in a few words.
pub(super) fn class(class: Class) -> &'static str {
    match class {
        Class::Pause => "pause",
        Class::Termination => "end",
        Class::Execution => "transition",
        Class::Start => "start",
        Class::Interruption => "interruption",
        Class::Mutex => "its locks are free",
        Class::Resume => "after a pause",
        Class::Call => "the codel is called",
        Class::Async => "beside the task",
        Class::Tick => "time",
        Class::Manage => "manager",
        Class::Request => "request",
        Class::Control => "control",
    }
}
