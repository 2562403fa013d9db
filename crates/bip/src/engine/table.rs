//! What an atom can do in a marking: worked out when it first gets there, then looked up.

use crate::ast::Urgency;
use crate::bits::Bits;
use crate::model::Model;
use crate::template::Atom;
use std::collections::HashMap;
use std::sync::Arc;

/// What a type of atoms can do in a marking, as far as the marking alone says it.
#[derive(Debug)]
pub(super) struct Table {
    /// The transitions whose places are marked.
    pub here: Box<[u32]>,
    /// Of these, by their places in `here`: those of ports that have a guard or are pressing.
    pub guarded: Box<[u32]>,
    /// Those without a port.
    pub internals: Box<[u32]>,
    /// Those of ports that are always possible and never pressing: port and place in `here`, in the order of ports.
    pub plain: Box<[(u32, u32)]>,
    pub plain_ports: Bits,
    /// A port that has two transitions which are always possible.
    pub clash: Option<u32>,
    /// Invariants that hold here.
    pub invariants: Box<[u32]>,
}

impl Table {
    fn new(ty: &Atom, marking: &Bits) -> Table {
        let possible = |t: &crate::template::Transition| t.from.iter().all(|place| marking.has(*place));
        let here: Vec<u32> = (0..).zip(&ty.transitions).filter(|(_, t)| possible(t)).map(|(id, _)| id).collect();
        let (mut guarded, mut internals, mut plain) = (Vec::new(), Vec::new(), Vec::new());
        for (at, transition) in (0..).zip(here.iter().filter_map(|id| ty.transitions.get(*id as usize))) {
            match transition.port {
                None => internals.push(at),
                Some(port) if transition.guard.is_none() && transition.urgency == Urgency::Lazy => {
                    plain.push((port, at))
                }
                Some(_) => guarded.push(at),
            }
        }
        plain.sort_unstable();
        let mut plain_ports = Bits::new(ty.ports.len());
        plain.iter().for_each(|(port, _)| plain_ports.add(*port));
        let twice = plain.windows(2).find(|pair| matches!(pair, [(a, _), (b, _)] if a == b));
        let clash = twice.and_then(|pair| pair.first()).map(|(port, _)| *port);
        let holds = |i: &crate::template::Invariant| i.places.iter().all(|place| marking.has(*place));
        let invariants = (0..).zip(&ty.invariants).filter(|(_, i)| holds(i)).map(|(id, _)| id).collect();
        Table {
            here: here.into(),
            guarded: guarded.into(),
            internals: internals.into(),
            plain: plain.into(),
            plain_ports,
            clash,
            invariants,
        }
    }

    /// The transition of a port that is always possible here.
    pub fn plain(&self, port: u32) -> Option<u32> {
        let at = self.plain.binary_search_by_key(&port, |(port, _)| *port).ok()?;
        self.plain.get(at).map(|(_, here)| *here)
    }
}

/// Tables that have been worked out, by types of atoms and markings.
#[derive(Debug, Default)]
pub(super) struct Tables {
    by_type: Vec<HashMap<Bits, Arc<Table>>>,
}

/// How many tables of a type are kept: a net with many tokens has more markings than anyone can keep.
const MAX_TABLES: usize = 1 << 14;

impl Tables {
    pub fn new(model: &Model) -> Tables {
        Tables { by_type: model.atom_types.iter().map(|_| HashMap::new()).collect() }
    }

    pub fn get(&mut self, ty: u32, atom: &Atom, marking: &Bits) -> Arc<Table> {
        let Some(known) = self.by_type.get_mut(ty as usize) else { return Arc::new(Table::new(atom, marking)) };
        if let Some(table) = known.get(marking) {
            return Arc::clone(table);
        }
        if known.len() >= MAX_TABLES {
            known.clear();
        }
        let table = Arc::new(Table::new(atom, marking));
        known.insert(marking.clone(), Arc::clone(&table));
        table
    }
}
