//! Moves as the log shows them.

use super::{Engine, MoveId};
use crate::model::Part;
use std::fmt::Write as _;

impl<H> Engine<H> {
    /// A move with the values that its ports show: `ROOT.send: A.p(x=1;) B.q()`, `ROOT.A.p`.
    pub fn show_move(&self, id: MoveId) -> String {
        let mut shown = self.move_path(id);
        let Some(one) = self.model.moves.get(id.0 as usize) else { return shown };
        let Some(connector) = self.model.connectors.get(one.connector as usize) else { return shown };
        shown.push(':');
        for (label, part) in &one.parts {
            let label = connector.labels.get(*label as usize).map_or("", String::as_str);
            shown.push(' ');
            shown.push_str(label);
            self.write_part(&mut shown, part);
        }
        shown
    }

    /// The path of a move's connector, or of its port: `ROOT.send`, `ROOT.A.p`.
    pub fn move_path(&self, id: MoveId) -> String {
        let Some(one) = self.model.moves.get(id.0 as usize) else { return String::new() };
        match self.model.connectors.get(one.connector as usize) {
            Some(connector) => connector.path.clone(),
            None => one.leaves.first().map_or_else(String::new, |leaf| self.model.port_path(*leaf)),
        }
    }

    /// The ports of atoms that take part in a move: `ROOT.A.p`.
    pub fn participants(&self, id: MoveId) -> Vec<String> {
        let leaves = self.model.moves.get(id.0 as usize).map_or(&[][..], |m| &m.leaves);
        leaves.iter().map(|leaf| self.model.port_path(*leaf)).collect()
    }

    /// The atoms that take part in a move, by their numbers in [`Model::atoms`], and the ports through which they do.
    ///
    /// [`Model::atoms`]: crate::Model::atoms
    pub fn ports(&self, id: MoveId) -> impl Iterator<Item = (u32, &str)> {
        let leaves = self.model.moves.get(id.0 as usize).map_or(&[][..], |m| &m.leaves);
        leaves.iter().filter_map(|leaf| {
            let atom = self.model.ports.get(*leaf as usize)?.atom;
            Some((atom, self.model.port(*leaf)?.1.name.as_str()))
        })
    }

    /// What kind of thing a move is.
    pub(crate) fn kind(&self, id: MoveId) -> MoveKind {
        match id.0 {
            id if id < self.model.first_internal => MoveKind::Interaction,
            id if id < self.model.first_external => MoveKind::Internal,
            _ => MoveKind::External,
        }
    }

    fn write_part(&self, shown: &mut String, part: &Part) {
        shown.push('(');
        match part {
            Part::Port(leaf) => {
                if let Some((atom, port)) = self.model.port(*leaf) {
                    for var in &port.vars {
                        let base = if var.ty.is_plain() { atom.base.cells } else { atom.base.objects };
                        let _ = write!(shown, "{}={};", var.name, self.memory.get(var.ty, base + var.slot));
                    }
                }
            }
            Part::Shown(vars) => {
                for (name, ty, at) in vars {
                    let _ = write!(shown, "{name}={};", self.memory.get(*ty, *at));
                }
            }
        }
        shown.push(')');
    }
}

/// The kinds of moves, in the order of their numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum MoveKind {
    /// Of a connector.
    Interaction,
    /// Of a port that is not exported.
    Internal,
    /// Of an external port.
    External,
}
