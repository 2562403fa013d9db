//! Shared variables as copies: BIP has none, so that every automaton that needs a variable holds one of its own (the paper's section III-B2).
//!
//! An edge that changes a variable takes all other holders along, and each of them does to its copies what the edge does to its own. For that a
//! holder needs whatever the change depends on, and so becomes a holder of that as well.

use std::collections::BTreeSet;

use crate::automata::{Action, Edge, System, VarId};

/// Who holds which variables.
#[derive(Clone, Debug)]
pub struct Sharing {
    held: Vec<BTreeSet<VarId>>,
}

impl Sharing {
    /// The least sets in which every automaton can do what it has to.
    pub fn of(system: &System) -> Sharing {
        let mut held: Vec<BTreeSet<VarId>> =
            system.automata.iter().map(|a| a.edges.iter().flat_map(mentioned).collect()).collect();
        // Each round may make a holder need more; there are only so many variables.
        loop {
            let mut needed: Vec<BTreeSet<VarId>> = vec![BTreeSet::new(); held.len()];
            for edge in system.automata.iter().flat_map(|a| &a.edges).filter(|e| !e.actions.is_empty()) {
                for (own, needed) in held.iter().zip(&mut needed) {
                    pruned(&edge.actions, own).iter().for_each(|action| action.reads(&mut |v| needed.extend([v])));
                }
            }
            let mut grown = false;
            for (own, needed) in held.iter_mut().zip(needed) {
                let before = own.len();
                own.extend(needed);
                grown |= own.len() > before;
            }
            if !grown {
                return Sharing { held };
            }
        }
    }

    /// The variables that an automaton, by its number, has a copy of.
    pub fn held(&self, automaton: usize) -> &BTreeSet<VarId> {
        static NONE: BTreeSet<VarId> = BTreeSet::new();
        self.held.get(automaton).unwrap_or(&NONE)
    }

    /// What each other automaton does to its copies when an edge of one is taken; those that hold nothing of it are left out.
    pub fn copies(&self, automaton: usize, edge: &Edge) -> Vec<(usize, Vec<Action>)> {
        let others =
            self.held.iter().enumerate().filter(|(number, _)| *number != automaton && !edge.actions.is_empty());
        others
            .map(|(number, own)| (number, pruned(&edge.actions, own)))
            .filter(|(_, actions)| !actions.is_empty())
            .collect()
    }
}

/// The variables that an edge speaks of.
fn mentioned(edge: &Edge) -> Vec<VarId> {
    let mut all = Vec::new();
    edge.guard.variables(&mut |v| all.push(v));
    for action in &edge.actions {
        action.reads(&mut |v| all.push(v));
        action.writes(&mut |v| all.push(v));
    }
    all.extend(edge.call.as_ref().and_then(|c| c.result.as_ref()).map(|(v, _)| *v));
    all
}

/// What actions do to some variables.
fn pruned(actions: &[Action], own: &BTreeSet<VarId>) -> Vec<Action> {
    let one = |action: &Action| match action {
        Action::Set(var, _) | Action::Add(var, _) => own.contains(var).then(|| action.clone()),
        Action::If(cond, then, otherwise) => {
            let (then, otherwise) = (pruned(then, own), pruned(otherwise, own));
            (!then.is_empty() || !otherwise.is_empty()).then(|| Action::If(cond.clone(), then, otherwise))
        }
    };
    actions.iter().filter_map(one).collect()
}
