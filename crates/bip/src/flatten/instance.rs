//! Instances: a tree of compounds, and atoms in a row.

use super::{Builder, Flat, limit, too_large};
use crate::check::Nobody;
use crate::code::{Base, Context, Expr, Memory};
use crate::model::{Atom, Port};
use crate::template::{Frame, Kind, Source};
use crate::value::{Type, Value};
use lapwing_diag::{Code, Diagnostic, Span};
use std::ops::Range;

/// A compound with what is in it.
pub(super) struct Tree {
    /// Its number among all instances.
    pub id: usize,
    pub path: String,
    pub ty: u32,
    pub children: Vec<Child>,
    /// The values of its parameters.
    pub args: Vec<Value>,
    /// For each of its connectors the moves that it can make, where it is no part of another.
    pub moves: Vec<Option<Range<u32>>>,
}

/// A component of a compound.
pub(super) enum Child {
    Atom(u32),
    Compound(Box<Tree>),
}

impl Builder<'_> {
    /// A compound with all that is in it.
    pub(super) fn instantiate(&mut self, ty: u32, path: &str, args: Vec<Value>) -> Flat<Tree> {
        let library = self.library;
        let mut tree =
            Tree { id: self.instances, path: path.to_owned(), ty, children: Vec::new(), args, moves: Vec::new() };
        let Some(compound) = library.compounds.get(ty as usize) else { return Ok(tree) };
        for component in &compound.components {
            self.instances += 1;
            if self.instances > limit::INSTANCES {
                return too_large(compound.span, format!("the model has more than {} components", limit::INSTANCES));
            }
            let path = format!("{path}.{}", component.name);
            let args = arguments(&compound.frame, &tree.args, &component.args, component.span)?;
            let child = match component.kind {
                Kind::Atom(ty) => Child::Atom(self.atom(ty, path, &args, component.span)?),
                Kind::Compound(ty) => Child::Compound(Box::new(self.instantiate(ty, &path, args)?)),
            };
            tree.children.push(child);
        }
        Ok(tree)
    }

    fn atom(&mut self, ty: u32, path: String, args: &[Value], span: Span) -> Flat<u32> {
        let Some(atom) = self.library.atoms.get(ty as usize) else { return Ok(u32::MAX) };
        let (first_port, id) = (self.ports.len() as u32, self.atoms.len() as u32);
        if self.ports.len() + atom.ports.len() > limit::PORTS {
            return too_large(span, format!("the model has more than {} ports", limit::PORTS));
        }
        let base = Base {
            cells: self.memory.cells.len() as u32,
            objects: self.memory.objects.len() as u32,
            clocks: self.memory.clocks.len() as u32,
        };
        // Parameters are the first variables of the frame.
        for (place, var) in atom.frame.vars.iter().enumerate() {
            let value = args.get(place).cloned().unwrap_or_else(|| var.ty.zero());
            self.memory.allocate(var.ty, &value);
        }
        self.memory.clocks.extend(atom.clocks.iter().map(|_| crate::code::Clock::default()));
        let port = |index| Port { atom: id, index, moves: Box::default() };
        self.ports.extend((0..atom.ports.len() as u32).map(port));
        self.atoms.push(Atom { path, ty, base, first_port, coded: Box::default() });
        Ok(id)
    }

    /// Ports of atoms or connectors that stand behind a port of a component.
    pub(super) fn behind<'t>(&self, child: &'t Child, port: &str) -> Vec<Behind<'t>> {
        match child {
            Child::Atom(id) => {
                let Some(atom) = self.atoms.get(*id as usize) else { return Vec::new() };
                let exports = self.library.atoms.get(atom.ty as usize).map_or(&[][..], |a| a.exports.as_slice());
                let export = exports.iter().find(|e| e.name == port);
                export.into_iter().flat_map(|e| &e.ports).map(|p| Behind::Port(atom.first_port + p)).collect()
            }
            Child::Compound(tree) => {
                let exports = self.library.compounds.get(tree.ty as usize).map_or(&[][..], |c| c.exports.as_slice());
                let sources = exports.iter().find(|(name, ..)| name == port).map_or(&[][..], |(_, _, s)| s.as_slice());
                sources.iter().flat_map(|source| self.sources(tree, source)).collect()
            }
        }
    }

    /// What a port of a connector is bound to.
    pub(super) fn sources<'t>(&self, tree: &'t Tree, source: &Source) -> Vec<Behind<'t>> {
        match source {
            Source::Connector(index) => vec![Behind::Connector(tree, *index)],
            Source::Component(index, port) => {
                tree.children.get(*index as usize).map_or_else(Vec::new, |child| self.behind(child, port))
            }
        }
    }

    /// Where an exported variable of a component lies.
    pub(super) fn exported(&self, child: &Child, name: &str) -> Option<(Type, u32)> {
        match child {
            Child::Atom(id) => {
                let atom = self.atoms.get(*id as usize)?;
                let vars = &self.library.atoms.get(atom.ty as usize)?.exported_data;
                let var = vars.iter().find(|v| v.name == name)?;
                let base = if var.ty.is_plain() { atom.base.cells } else { atom.base.objects };
                Some((var.ty, base + var.slot))
            }
            Child::Compound(tree) => {
                let exports = &self.library.compounds.get(tree.ty as usize)?.exported_data;
                let (_, _, component, inner) = exports.iter().find(|(n, ..)| n == name)?;
                self.exported(tree.children.get(*component as usize)?, inner)
            }
        }
    }
}

/// What stands behind a port.
#[derive(Clone, Copy)]
pub(super) enum Behind<'t> {
    /// A port of an atom.
    Port(u32),
    /// A connector of a compound, through the port that it exports.
    Connector(&'t Tree, u32),
}

/// The values that a component is given.
fn arguments(frame: &Frame, own: &[Value], args: &[Expr], span: Span) -> Flat<Vec<Value>> {
    let mut memory = Memory::default();
    for (var, value) in frame.vars.iter().zip(own) {
        memory.allocate(var.ty, value);
    }
    let mut cx = Context { memory: &mut memory, host: &mut Nobody, atom: None, now: 0 };
    let values = args.iter().map(|arg| arg.eval(Base::default(), &mut cx));
    values.collect::<Result<_, _>>().map_err(|trap| {
        let message = format!("the arguments of this component cannot be computed: {}", trap.what);
        Box::new(Diagnostic::new(Code::BipConst, span, message))
    })
}
