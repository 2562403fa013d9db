//! All runs of a system in discrete time: slow, obvious code that shares nothing with what writes models.
#![allow(dead_code)]

use std::collections::{BTreeSet, VecDeque};

use lapwing_genom::automata::{ClockGuard, Edge, System};

/// A state: where each automaton is, its clock in units of time, and the variables.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct State {
    pub places: Vec<usize>,
    pub clocks: Vec<u64>,
    pub values: Vec<i64>,
}

/// A step: an edge of an automaton, or a unit of time.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Step {
    Edge(usize, usize),
    Time,
}

pub struct Explorer<'s> {
    system: &'s System,
    /// The unit of time: what divides all times.
    pub unit_ns: u64,
    /// Clocks above are alike: no guard tells them apart.
    cap: u64,
}

impl<'s> Explorer<'s> {
    pub fn new(system: &'s System) -> Explorer<'s> {
        let mut times: Vec<u64> = Vec::new();
        for automaton in &system.automata {
            times.extend(automaton.locations.iter().filter_map(|l| l.invariant_ns));
            times.extend(automaton.edges.iter().filter_map(|e| match e.clock {
                Some(ClockGuard::Exactly(ns)) => Some(ns),
                _ => None,
            }));
        }
        let unit_ns = times.iter().copied().reduce(|mut a, mut b| {
            while b != 0 {
                (a, b) = (b, a % b);
            }
            a
        });
        let unit_ns = unit_ns.unwrap_or(1_000_000);
        Explorer { system, unit_ns, cap: times.into_iter().max().unwrap_or(0) / unit_ns + 1 }
    }

    pub fn initial(&self) -> State {
        let count = self.system.automata.len();
        State {
            places: vec![0; count],
            clocks: vec![0; count],
            values: self.system.variables.iter().map(|v| v.initial).collect(),
        }
    }

    /// Whether an edge can be taken. A place's limit binds whoever enters it as well.
    fn is_enabled(&self, state: &State, automaton: usize, edge: &Edge) -> bool {
        let clock = state.clocks[automaton];
        let in_time = match edge.clock {
            None => true,
            Some(ClockGuard::Positive) => clock > 0,
            Some(ClockGuard::Exactly(ns)) => clock * self.unit_ns == ns,
        };
        edge.from.0 == state.places[automaton] && in_time && edge.guard.holds(&state.values)
    }

    fn time_may_pass(&self, state: &State) -> bool {
        self.system.automata.iter().enumerate().all(|(number, automaton)| {
            let limit = automaton.locations[state.places[number]].invariant_ns;
            let fits = limit.is_none_or(|ns| (state.clocks[number] + 1) * self.unit_ns <= ns);
            fits && !automaton.edges.iter().any(|e| e.eager && self.is_enabled(state, number, e))
        })
    }

    /// Everything that may happen in a state, and where it leads.
    pub fn steps(&self, state: &State) -> Vec<(Step, State)> {
        let mut all = Vec::new();
        for (number, automaton) in self.system.automata.iter().enumerate() {
            for (place, edge) in automaton.edges.iter().enumerate() {
                if self.is_enabled(state, number, edge) {
                    let mut next = state.clone();
                    next.places[number] = edge.to.0;
                    edge.actions.iter().for_each(|action| action.apply(&mut next.values));
                    if edge.resets {
                        next.clocks[number] = 0;
                    }
                    all.push((Step::Edge(number, place), next));
                }
            }
        }
        if self.time_may_pass(state) {
            let mut next = state.clone();
            next.clocks.iter_mut().for_each(|clock| *clock = (*clock + 1).min(self.cap));
            all.push((Step::Time, next));
        }
        all
    }

    pub fn is_stuck(&self, state: &State) -> bool {
        self.steps(state).is_empty()
    }

    /// All states that can be reached, the nearest first, but no more than `most`.
    pub fn all(&self, most: usize) -> Vec<State> {
        let mut seen = BTreeSet::from([self.initial()]);
        let mut waiting = VecDeque::from([self.initial()]);
        let mut states = Vec::new();
        while let Some(state) = waiting.pop_front() {
            for (_, next) in self.steps(&state) {
                if seen.len() < most && seen.insert(next.clone()) {
                    waiting.push_back(next);
                }
            }
            states.push(state);
        }
        states
    }

    pub fn shown(&self, state: &State) -> String {
        let places = self.system.automata.iter().zip(&state.places).zip(&state.clocks);
        let places = places.map(|((a, place), clock)| format!("{}: {} x={clock}", a.name, a.locations[*place].name));
        let values = self.system.variables.iter().zip(&state.values).map(|(v, value)| format!("{}={value}", v.name));
        places.chain(values).collect::<Vec<_>>().join("\n")
    }
}
