//! Finite automata over events, and the state diagrams that stand for them.
//!
//! What a handler waits for becomes an illegal move. Each event that leads on is a drawn edge, those that stay included. Behind all other states
//! stands one with a condition, which holds at every event of the alphabet and to which nothing is drawn: where no edge leads on, that one is entered, and
//! entering it is the violation. `reset` puts the diagram back to its beginning, as `__RESET` does.

use std::collections::{BTreeMap, BTreeSet};

use crate::expr;
use crate::names::Taken;
use crate::sheet::{Edge, Machine, State};

/// More states than this are not written.
pub(super) const MOST_STATES: usize = 64;

/// A complete automaton; it begins in state 0.
#[derive(Clone, Debug)]
pub(super) struct Automaton {
    /// The names of the states.
    pub states: Vec<String>,
    /// Where each state goes by each letter.
    pub next: Vec<Vec<usize>>,
}

impl Automaton {
    /// The state diagram that is violated when one of `targets` is entered; each letter is any of some events.
    pub(super) fn machine(
        &self,
        name: String,
        targets: &BTreeSet<usize>,
        target: &str,
        letters: &[Vec<String>],
    ) -> Machine {
        let reached = self.reached(targets);
        let mut taken = Taken::default();
        let target = taken.take(target);
        let start = taken.take(self.states.first().map_or("start", String::as_str));
        // The beginning is its own state: nothing has been entered before the first event.
        let names: BTreeMap<usize, String> =
            reached.iter().map(|&s| (s, if s == 0 { start.clone() } else { taken.take(&self.states[s]) })).collect();
        let mut edges = Vec::new();
        let from_start = (!reached.contains(&0)).then_some((0, &start));
        for (state, from) in from_start.into_iter().chain(names.iter().map(|(s, n)| (*s, n))) {
            for (letter, events) in letters.iter().enumerate() {
                let Some(to) = self.next.get(state).and_then(|n| n.get(letter)).and_then(|to| names.get(to)) else {
                    continue;
                };
                let edge = |on: &String| Edge { from: from.clone(), to: to.clone(), on: Some(on.clone()), when: None };
                edges.extend(events.iter().map(edge));
            }
        }
        let mut states: Vec<State> = Vec::new();
        let bare = |name: &String| State { name: name.clone(), ..State::default() };
        states.push(bare(&start));
        states.extend(names.values().filter(|n| **n != start).map(bare));
        let events: Vec<String> = letters.concat();
        states.push(State { name: target, when: expr::any(&events), ..State::default() });
        Machine { name, initial: start, states, edges, ..Machine::default() }
    }

    /// The states that are reached without passing a target.
    fn reached(&self, targets: &BTreeSet<usize>) -> BTreeSet<usize> {
        let mut reached = BTreeSet::new();
        let mut open = vec![0];
        while let Some(state) = open.pop() {
            for &next in self.next.get(state).into_iter().flatten() {
                if !targets.contains(&next) && reached.insert(next) {
                    open.push(next);
                }
            }
        }
        if !targets.contains(&0) {
            reached.insert(0);
        }
        reached
    }

    /// Whether the automaton, once in a target, stays in targets.
    pub(super) fn keeps(&self, targets: &BTreeSet<usize>) -> bool {
        targets.iter().all(|t| self.next.get(*t).into_iter().flatten().all(|n| targets.contains(n)))
    }
}
