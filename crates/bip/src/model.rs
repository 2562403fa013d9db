//! A model: instances instead of types, moves instead of connectors, nothing left to resolve.
//!
//! It is immutable, and several engines may run it. A [`Move`] is what an engine can do: an interaction, a port of an atom that
//! is not exported, or an external port with an event. Moves are numbered in this order. Behind them come inner moves, which nobody makes: what
//! connectors can do that a compound exports. Outside of it only the largest of these are seen.

use crate::code::{Base, Bool, Memory};
use crate::host::Signature;
use crate::template;
use crate::value::Type;
use std::ops::Range;

/// A model that can be run.
#[derive(Debug)]
pub struct Model {
    pub(crate) extern_types: Vec<String>,
    pub(crate) functions: Vec<Signature>,
    pub(crate) atom_types: Vec<template::Atom>,
    pub(crate) connector_types: Vec<template::Connector>,
    pub(crate) atoms: Vec<Atom>,
    pub(crate) ports: Vec<Port>,
    pub(crate) connectors: Vec<Connector>,
    pub(crate) moves: Vec<Move>,
    /// The first move that is no interaction, and the first that is an external port.
    pub(crate) first_internal: u32,
    pub(crate) first_external: u32,
    /// The first inner move.
    pub(crate) first_inner: u32,
    pub(crate) rules: Vec<Rule>,
    /// Whether rules can put something above itself, so that states have to be looked at.
    pub(crate) may_cycle: bool,
    /// Parameters are in it; variables have no values yet.
    pub(crate) memory: Memory,
}

/// An atom.
#[derive(Clone, Debug)]
pub struct Atom {
    /// From the root: `ROOT.laser.timer`.
    pub path: String,
    pub(crate) ty: u32,
    pub(crate) base: Base,
    /// The number of its first port; the others follow.
    pub(crate) first_port: u32,
    /// Moves whose code reads what its ports show.
    pub(crate) coded: Box<[u32]>,
}

/// A port of an atom.
#[derive(Clone, Debug)]
pub(crate) struct Port {
    pub atom: u32,
    /// Its number among the ports of the atom.
    pub index: u32,
    /// Moves that it takes part in.
    pub moves: Box<[u32]>,
}

/// A connector that is no part of another.
#[derive(Clone, Debug)]
pub(crate) struct Connector {
    pub path: String,
    /// What its ports are bound to, as written.
    pub labels: Box<[String]>,
    pub moves: Range<u32>,
}

/// Something that an engine can do.
#[derive(Clone, Debug)]
pub(crate) struct Move {
    /// The connector, of an interaction.
    pub connector: u32,
    /// The ports of atoms that take part, in ascending order.
    pub leaves: Box<[u32]>,
    /// The code of connectors, those that others are made of first.
    pub nodes: Box<[Node]>,
    /// What takes part, as the connector sees it: the number of the label, and whose variables are shown.
    pub parts: Box<[(u32, Part)]>,
    /// Whether another move may go first although both could be made.
    pub has_rivals: bool,
    /// Inner moves that are larger than what takes part in this one out of a compound: where they are possible, this one is not seen.
    pub larger: Box<[u32]>,
}

impl Move {
    /// What ports of atoms can do without a connector.
    pub fn of_ports(leaves: Box<[u32]>) -> Move {
        let (nodes, parts, larger) = (Box::default(), Box::default(), Box::default());
        Move { connector: u32::MAX, leaves, nodes, parts, has_rivals: false, larger }
    }
}

/// Whose variables are shown.
#[derive(Clone, Debug)]
pub(crate) enum Part {
    /// Those of a port of an atom.
    Port(u32),
    /// Those that a connector exports: name, type and place.
    Shown(Box<[(String, Type, u32)]>),
}

/// The code of a connector in a move.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub ty: u32,
    pub action: u32,
    pub cells: Box<[u32]>,
    pub objects: Box<[u32]>,
}

/// A priority: the moves of `low` yield to those of `high`.
#[derive(Clone, Debug)]
pub(crate) struct Rule {
    pub low: Vec<Range<u32>>,
    pub high: Vec<Range<u32>>,
    /// With maximal progress, what is part of one that yields does so too, and it yields to larger ones as well: moves that are in `low` or
    /// part of one there, and moves that are in `high` or contain one there, whether those themselves are possible or not.
    pub within_low: Vec<Range<u32>>,
    pub around_high: Vec<Range<u32>>,
    pub guard: Option<RuleGuard>,
    /// Rules whose `within_low` has a move of this one's `around_high`.
    pub next: Vec<u32>,
}

impl Rule {
    /// The moves that yield, with or without maximal progress.
    pub fn yielding(&self, without_maximal_progress: bool) -> &[Range<u32>] {
        if without_maximal_progress { &self.low } else { &self.within_low }
    }

    /// The moves that go before them.
    pub fn preceding(&self, without_maximal_progress: bool) -> &[Range<u32>] {
        if without_maximal_progress { &self.high } else { &self.around_high }
    }
}

/// When a rule holds.
#[derive(Clone, Debug)]
pub(crate) struct RuleGuard {
    pub condition: Bool,
    pub cells: Box<[u32]>,
    pub objects: Box<[u32]>,
}

/// Whether ports, in ascending order, are all among others, of which there are more.
pub(crate) fn is_part(small: &[u32], large: &[u32]) -> bool {
    if small.len() >= large.len() {
        return false;
    }
    let mut rest = large.iter();
    small.iter().all(|leaf| rest.any(|other| other == leaf))
}

/// Whether a move is among several.
pub(crate) fn among(ranges: &[Range<u32>], id: u32) -> bool {
    ranges.iter().any(|r| r.contains(&id))
}

impl Model {
    /// The atoms, in the order of their declaration.
    pub fn atoms(&self) -> &[Atom] {
        &self.atoms
    }

    /// The external functions and operators that the model calls, by their numbers.
    pub fn functions(&self) -> &[Signature] {
        &self.functions
    }

    /// The names of external types, by their numbers.
    pub fn extern_types(&self) -> &[String] {
        &self.extern_types
    }

    /// How many interactions there are, possible or not.
    pub fn interactions(&self) -> usize {
        self.first_internal as usize
    }

    /// The number of the atom with that path: `ROOT.laser.timer`.
    pub fn atom(&self, path: &str) -> Option<u32> {
        self.atoms.iter().position(|a| a.path == path).map(|a| a as u32)
    }

    /// The external port of that name, for [`crate::Engine::notify`]: `ROOT.laser.done`.
    pub fn external(&self, path: &str) -> Option<External> {
        let (atom, port) = path.rsplit_once('.')?;
        let atom = self.atoms.get(self.atom(atom)? as usize)?;
        let ports = &self.atom_types.get(atom.ty as usize)?.ports;
        let index = ports.iter().position(|p| p.name == port && p.external.is_some())? as u32;
        let port = atom.first_port + index;
        let externals = self.moves.get(self.first_external as usize..self.first_inner as usize)?;
        let place = externals.iter().position(|m| *m.leaves == [port])?;
        Some(External(place as u32))
    }

    pub(crate) fn atom_type(&self, atom: &Atom) -> Option<&template::Atom> {
        self.atom_types.get(atom.ty as usize)
    }

    /// The template of a port, and the atom that has it.
    pub(crate) fn port(&self, id: u32) -> Option<(&Atom, &template::Port)> {
        let port = self.ports.get(id as usize)?;
        let atom = self.atoms.get(port.atom as usize)?;
        Some((atom, self.atom_type(atom)?.ports.get(port.index as usize)?))
    }

    /// The path of a port: `ROOT.A.p`.
    pub(crate) fn port_path(&self, id: u32) -> String {
        self.port(id).map_or_else(String::new, |(atom, port)| format!("{}.{}", atom.path, port.name))
    }
}

/// An external port of a model.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub struct External(pub(crate) u32);
