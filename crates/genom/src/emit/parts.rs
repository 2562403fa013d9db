//! Pieces of RT-BIP models, for [`super::bip`] and for who adds to what that makes: how automata and edges are called there, ports, connector types.

use lapwing_bip::ast::{AtomPort, ConnectorType, Decl, DeclKind, Name, Path, Port, PortExpr};

use super::names;
use crate::automata::Automaton;

/// The type of ports that pass nothing on.
pub const BASIC: &str = "Basic";

/// What the atom type of an automaton is called.
pub fn atom_type(automaton: &Automaton) -> String {
    format!("{}_type", automaton.name)
}

/// What the connector of an edge is called: of one that does something to others, or is a request.
pub fn connector(automaton: &Automaton, edge: &str) -> String {
    format!("{}_{edge}", automaton.name)
}

/// The port of an edge, or of another part of an automaton, as connectors name it.
pub fn port_path(automaton: &Automaton, port: &str) -> Path {
    Path { parts: vec![names::bip(&automaton.name).into(), names::bip(port).into()] }
}

/// The declaration of a port of an atom.
pub fn port(name: &str, is_exported: bool, notes: Vec<String>) -> AtomPort {
    let port = Port { ty: BASIC.into(), name: names::bip(name).into(), args: Vec::new() };
    AtomPort { notes, is_exported, ports: vec![port], merged: None }
}

/// A declaration with a comment.
pub fn noted(kind: DeclKind, note: &str) -> Decl {
    Decl { notes: vec![note.to_owned()], ..Decl::from(kind) }
}

/// What the connector type is called in which all of a number of ports take part or none.
pub fn rendezvous_name(size: usize) -> String {
    format!("Rendezvous{size}")
}

/// That connector type.
pub fn rendezvous(size: usize) -> Decl {
    let define = (1..=size).map(|number| PortExpr::synchron(port_of(number))).collect();
    connector_type(&rendezvous_name(size), size, define)
}

/// A connector type over so many ports, `p1`, `p2` and so on, that passes nothing on.
pub fn connector_type(name: &str, size: usize, define: Vec<PortExpr>) -> Decl {
    let ports = (1..=size).map(|number| (Path::from(BASIC), Name::from(port_of(number)))).collect();
    DeclKind::Connector(ConnectorType {
        name: name.into(),
        ports,
        data: Vec::new(),
        export: None,
        define,
        resume: None,
        interactions: Vec::new(),
    })
    .into()
}

/// A port of a connector type, by its number from 1.
pub fn port_of(number: usize) -> String {
    format!("p{number}")
}
