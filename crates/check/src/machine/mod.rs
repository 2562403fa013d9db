//! State diagrams: in which order they move, what they are made of, and what expressions may say about them.

mod build;
mod says;

pub(crate) use build::{build_all, event_named};
pub(crate) use says::{entered_or_left, updated};

use std::collections::BTreeSet;

use lapwing_syntax::ast::{self, ItemKind};

use crate::context::Found;
use crate::graph::Graph;
use crate::names::Names;
use crate::reads::Uses;

/// The machines in the order in which they move, each after those that it reads.
#[derive(Clone, Debug, Default)]
pub(crate) struct MachineTable {
    entries: Vec<Entry>,
}

/// One machine, as others see it.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub name: String,
    /// The number of its statement.
    pub item: usize,
    /// Its states; one that is only named as the initial one comes first.
    pub states: Vec<String>,
    /// What it reads, once it has been built.
    pub uses: Uses,
    /// What was wrong with it.
    pub found: Found,
}

impl MachineTable {
    /// Puts the machines in order.
    pub fn new(names: &Names, graph: &Graph) -> MachineTable {
        let is_machine = |&i: &usize| matches!(names.items[i].item.kind, ItemKind::Machine(_));
        let counts = |i: &usize| match &names.items[*i].item.kind {
            ItemKind::Machine(m) => names.values.get(m.name.name.as_str()) == Some(i),
            _ => false,
        };
        let mut waiting: Vec<usize> = (0..names.items.len()).filter(counts).collect();
        let mut done = BTreeSet::new();
        let mut table = MachineTable::default();
        while !waiting.is_empty() {
            let ready = |&item: &usize| {
                graph.reach(item).iter().filter(|i| is_machine(i)).all(|m| *m == item || done.contains(m))
            };
            // None is ready where they go round in a circle, which has been reported.
            let next = waiting.iter().position(ready).unwrap_or(0);
            let item = waiting.remove(next);
            done.insert(item);
            if let ItemKind::Machine(machine) = &names.items[item].item.kind {
                table.entries.push(Entry::new(machine, item));
            }
        }
        table
    }

    /// The number of the machine of that name.
    pub fn index(&self, name: &str) -> Option<usize> {
        self.entries.iter().position(|e| e.name == name)
    }

    /// A machine by its number.
    pub fn get(&self, index: usize) -> Option<&Entry> {
        self.entries.get(index)
    }

    /// A machine by its number.
    pub fn get_mut(&mut self, index: usize) -> Option<&mut Entry> {
        self.entries.get_mut(index)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.entries.len()
    }
}

impl Entry {
    fn new(machine: &ast::Machine, item: usize) -> Entry {
        let declared = machine.states.iter().map(|s| s.name.name.clone());
        let initial = machine.initial.iter().map(|i| i.name.clone());
        let implicit = initial.filter(|i| !machine.states.iter().any(|s| s.name.name == *i));
        let states = implicit.chain(declared).collect();
        Entry { name: machine.name.name.clone(), item, states, uses: Uses::default(), found: Found::default() }
    }

    /// The number of the state of that name.
    pub fn state(&self, name: &str) -> Option<usize> {
        self.states.iter().position(|s| s == name)
    }
}
