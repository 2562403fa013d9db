//! Models in RT-BIP with what a run has besides the components: monitors that watch them and react, and a client that makes requests.
//!
//! A monitor is an atom that joins what it watches by broadcast, so that it hinders nothing, and is ready for it wherever it is. A violation is
//! an eager move of its own that goes before whatever it watches, and what is then asked for is kept in a second atom until the control task can take
//! it: it cannot be missed, and goes before the requests of others. These are the two holes of the monitor of Foughali et al. (MEMOCODE 2020, section
//! IV-B), whose report has to wait for who answers it, and whose end is lost where it comes with the timeout.

mod client;
mod formula;
mod guard;
mod letters;
mod past;
mod ring;

use std::collections::{BTreeMap, BTreeSet};

use lapwing_bip::ast::{
    Component, CompoundType, Connector, Decl, DeclKind, Package, Path, PortExpr, PortExprKind, Priority, Side,
};
use lapwing_diag::Span;
use lapwing_genom::automata::{Automaton, Edge, Part, System};
use lapwing_genom::emit::{bip_name, parts};

pub use client::with_requests;
pub use guard::with_monitors;

/// A model that is being added to.
struct Draft<'d> {
    package: Package,
    system: &'d System,
    /// Connector types that have been declared.
    shapes: BTreeSet<String>,
    /// For each edge that somebody watches: the ports of those who do.
    watchers: BTreeMap<(usize, usize), Vec<Path>>,
    /// Connectors by which an edge is taken besides its own: requests that reactions make.
    besides: Vec<((usize, usize), String)>,
    /// By monitor: the connectors that go before whatever it watches.
    firsts: BTreeMap<String, Vec<String>>,
}

impl<'d> Draft<'d> {
    fn new(package: Package, system: &'d System) -> Draft<'d> {
        let shapes = package.decls.iter().filter_map(|decl| match &decl.kind {
            DeclKind::Connector(ty) => Some(ty.name.text.clone()),
            _ => None,
        });
        Draft {
            shapes: shapes.collect(),
            package,
            system,
            watchers: BTreeMap::new(),
            besides: Vec::new(),
            firsts: BTreeMap::new(),
        }
    }

    fn root(&mut self) -> Option<&mut CompoundType> {
        self.package.decls.iter_mut().rev().find_map(|decl| match &mut decl.kind {
            DeclKind::Compound(root) if root.name.text == "Root" => Some(root),
            _ => None,
        })
    }

    /// Adds a declaration before the root.
    fn declare(&mut self, decl: Decl) {
        let last = self.package.decls.len().saturating_sub(1);
        self.package.decls.insert(last, decl);
    }

    /// Adds an instance of an atom type to the root.
    fn component(&mut self, ty: &str, name: &str) {
        let component = Component { notes: Vec::new(), ty: ty.into(), name: name.into(), args: Vec::new() };
        if let Some(root) = self.root() {
            root.components.push(component);
        }
    }

    /// A connector type in which all take part or none.
    fn rendezvous(&mut self, size: usize) -> String {
        let name = parts::rendezvous_name(size);
        self.shape(&name, || parts::rendezvous(size));
        name
    }

    /// A connector type in which the first `size` take part together, and others join them. These join all at once: a monitor is always ready,
    /// and each by itself would make twice as many interactions.
    fn broadcast(&mut self, size: usize, others: usize) -> String {
        let name = format!("Watched{size}_{others}");
        self.shape(&name, || {
            let together = |from: usize, to: usize, is_trigger: bool| {
                let one = |number| PortExpr::synchron(parts::port_of(number));
                match (from == to, is_trigger) {
                    (true, true) => PortExpr::trigger(parts::port_of(from)),
                    (true, false) => one(from),
                    (false, _) => PortExpr { kind: PortExprKind::Group((from..=to).map(one).collect()), is_trigger },
                }
            };
            let all = vec![together(1, size, true), together(size + 1, size + others, false)];
            parts::connector_type(&name, size + others, all)
        });
        name
    }

    /// Declares a connector type, unless it is there.
    fn shape(&mut self, name: &str, declared: impl FnOnce() -> Decl) {
        if self.shapes.insert(name.to_owned()) {
            // Types stand before the atoms, so that the text reads from the top.
            let at = self.package.decls.iter().position(|d| matches!(d.kind, DeclKind::Atom(_)));
            self.package.decls.insert(at.unwrap_or(self.package.decls.len()), declared());
        }
    }

    fn connect(&mut self, name: &str, ports: Vec<Path>, note: String) {
        let ty = self.rendezvous(ports.len());
        let connector = Connector { notes: vec![note], ty: ty.into(), name: name.into(), ports };
        if let Some(root) = self.root() {
            root.connectors.push(connector);
        }
    }

    fn priority(&mut self, name: String, low: &str, high: &str) {
        let side = |name: &str| Side::Connector(name.into());
        let (low, high) = (side(low), side(high));
        let priority = Priority { notes: Vec::new(), name: name.into(), low, high, guard: None, span: Span::default() };
        if let Some(root) = self.root() {
            root.priorities.push(priority);
        }
    }

    /// Somebody watches an edge through a port.
    fn watch(&mut self, automaton: usize, edge: usize, port: Path) {
        self.watchers.entry((automaton, edge)).or_default().push(port);
    }

    /// A request is also taken by another connector than its own.
    fn beside(&mut self, automaton: usize, request: &Edge, connector: &str) {
        let edges = self.system.automata.get(automaton).map_or(&[][..], |a| &a.edges);
        if let Some(edge) = edges.iter().position(|edge| edge.request == request.request) {
            self.besides.push(((automaton, edge), connector.to_owned()));
        }
    }

    /// The automaton of a component's control task.
    fn control(&self, component: usize) -> Option<(usize, &'d Automaton)> {
        let is_it = |a: &Automaton| a.part == Part::Control && a.component == component;
        self.system.automata.iter().enumerate().find(|(_, a)| is_it(a))
    }

    /// Joins those who watch to what they watch, and gives the model.
    fn finish(mut self) -> Package {
        let watchers = std::mem::take(&mut self.watchers);
        let besides = std::mem::take(&mut self.besides);
        for ((automaton, edge), ports) in watchers {
            let Some(declared) = self.system.automata.get(automaton) else { continue };
            let Some(taken) = declared.edges.get(edge) else { continue };
            let name = parts::connector(declared, &taken.name);
            if self.connector(&name).is_none() {
                self.export(declared, &taken.name);
                let own = parts::port_path(declared, &taken.name);
                self.connect(&name, vec![own], "It is watched.".to_owned());
            }
            self.join(&name, &ports);
            for (_, other) in besides.iter().filter(|(at, _)| *at == (automaton, edge)) {
                self.join(other, &ports);
                self.go_first(other, &ports);
            }
        }
        // A connector may be gone because nobody makes the request that it was for.
        if let Some(root) = self.root() {
            let names: BTreeSet<String> = root.connectors.iter().map(|c| c.name.text.clone()).collect();
            let is_there = |side: &Side| matches!(side, Side::Connector(name) if names.contains(&name.text));
            root.priorities.retain(|p| is_there(&p.low) && is_there(&p.high));
        }
        self.package
    }

    fn connector(&mut self, name: &str) -> Option<&mut Connector> {
        self.root()?.connectors.iter_mut().find(|c| c.name.text == name)
    }

    /// Ports join a connector by broadcast.
    fn join(&mut self, name: &str, ports: &[Path]) {
        let Some(size) = self.connector(name).map(|connector| connector.ports.len()) else { return };
        let ty = self.broadcast(size, ports.len());
        if let Some(connector) = self.connector(name) {
            connector.ty = ty.into();
            connector.ports.extend(ports.iter().cloned());
        }
    }

    /// What the monitors of these ports do by themselves goes before a connector.
    fn go_first(&mut self, low: &str, ports: &[Path]) {
        for monitor in ports.iter().filter_map(|port| port.parts.first()).map(|name| name.text.clone()) {
            for (number, high) in self.firsts.get(&monitor).cloned().unwrap_or_default().iter().enumerate() {
                self.priority(format!("{low}_after_{monitor}_{}", number + 1), low, high);
            }
        }
    }

    /// The port of an edge is seen from outside.
    fn export(&mut self, automaton: &Automaton, edge: &str) {
        let (ty, wanted) = (parts::atom_type(automaton), bip_name(edge));
        let atoms = self.package.decls.iter_mut().filter_map(|decl| match &mut decl.kind {
            DeclKind::Atom(atom) if atom.name.text == ty => Some(atom),
            _ => None,
        });
        let ports = atoms.flat_map(|atom| &mut atom.ports);
        for port in ports.filter(|p| p.ports.iter().any(|p| p.name.text == wanted)) {
            port.is_exported = true;
        }
    }
}
