//! The automata of a system, move by move. It knows variables, locations and clocks; what a codel is and what becomes of a request is the
//! business of who asks for the moves.
//!
//! Eager edges are taken before time passes. Where several automata could move, the one moves that has been where it is for longest: who
//! waits for a lock longest gets it.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};
use std::sync::Arc;

use lapwing_genom::automata::{Action, Class, ClockGuard, Edge, LocId, Part, System, VarId};
use lapwing_genom::model::{CodelId, ServiceId};
use lapwing_stream::Time;

/// A variable that has another value than before.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Change {
    pub var: VarId,
    pub before: i64,
    pub after: i64,
}

/// What the automata do next.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Move {
    /// An edge was taken.
    Taken { automaton: usize, edge: usize, changes: Vec<Change> },
    /// A codel is to be called; [`Machine::complete`] when it has returned.
    Begins { automaton: usize, codel: CodelId },
    /// A control task could take a request.
    Listens { automaton: usize },
}

/// What became of a request that was offered.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Offer {
    /// It was taken.
    Taken { edge: usize, changes: Vec<Change> },
    /// The service must wait for another's first success.
    Disallowed,
    /// The service does nothing, and so does a request for it.
    Unknown,
}

/// A codel that has been called.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Calling {
    /// On an edge, which is taken when it returns.
    On(usize),
    /// In a location of a control task, from which two edges may lead.
    Here,
}

/// An edge that waits for its time: when, which one, and the stay of the automaton in its location that it belongs to.
type Timer = Reverse<(i64, u64, usize, usize)>;

pub(crate) struct Machine {
    pub system: Arc<System>,
    /// By automaton and location.
    outgoing: Arc<[Vec<Vec<usize>>]>,
    /// By variable: the automata of which a guard reads it.
    readers: Vec<Vec<usize>>,
    /// By automaton and edge: the variables that it may write.
    writes: Arc<[Vec<Vec<VarId>>]>,
    values: Vec<i64>,
    /// What variables were before a move.
    before: Vec<i64>,
    at: Vec<LocId>,
    since: Vec<Time>,
    /// The number of each automaton's present stay.
    stay: Vec<u64>,
    stays: u64,
    calling: Vec<Option<Calling>>,
    /// What may be able to move, by how long it has been where it is.
    restless: BTreeSet<(u64, usize)>,
    timers: BinaryHeap<Timer>,
}

impl Machine {
    /// Everything where it begins, at time 0.
    pub fn new(system: Arc<System>) -> Machine {
        let automata = &system.automata;
        let outgoing = automata.iter().map(|a| {
            let from = |location| (0..a.edges.len()).filter(move |e| a.edges[*e].from == LocId(location)).collect();
            (0..a.locations.len()).map(from).collect()
        });
        let mut readers = vec![BTreeSet::new(); system.variables.len()];
        for (number, automaton) in automata.iter().enumerate() {
            automaton.edges.iter().for_each(|edge| {
                edge.guard.variables(&mut |var| {
                    readers.get_mut(var.0).map(|r: &mut BTreeSet<usize>| r.insert(number));
                })
            });
        }
        let writes = |edge: &Edge| {
            let mut all = Vec::new();
            edge.actions.iter().for_each(|action: &Action| action.writes(&mut |var| all.push(var)));
            all.sort_unstable();
            all.dedup();
            all
        };
        let mut machine = Machine {
            outgoing: outgoing.collect(),
            readers: readers.into_iter().map(|r| r.into_iter().collect()).collect(),
            writes: automata.iter().map(|a| a.edges.iter().map(writes).collect()).collect(),
            values: system.variables.iter().map(|v| v.initial).collect(),
            before: Vec::new(),
            at: vec![LocId(0); automata.len()],
            since: vec![Time(0); automata.len()],
            stay: vec![0; automata.len()],
            stays: 0,
            calling: vec![None; automata.len()],
            restless: BTreeSet::new(),
            timers: BinaryHeap::new(),
            system,
        };
        (0..machine.at.len()).for_each(|automaton| machine.arrive(automaton));
        machine
    }

    /// The value of a variable.
    pub fn value(&self, var: VarId) -> i64 {
        self.values.get(var.0).copied().unwrap_or(0)
    }

    /// Where an automaton is.
    pub fn location(&self, automaton: usize) -> LocId {
        self.at.get(automaton).copied().unwrap_or(LocId(0))
    }

    /// An edge by its number.
    pub fn edge(&self, automaton: usize, edge: usize) -> Option<&Edge> {
        self.system.automata.get(automaton)?.edges.get(edge)
    }

    /// What can be done before time passes; `None` where nothing can.
    pub fn next(&mut self, now: Time) -> Option<Move> {
        while let Some((_, automaton)) = self.restless.pop_first() {
            if let Some(found) = self.look(automaton, now) {
                return Some(found);
            }
        }
        None
    }

    /// When time alone moves something.
    pub fn next_timer(&self) -> Option<Time> {
        self.timers.peek().map(|Reverse((at, ..))| Time(*at))
    }

    /// Takes an edge whose time has come by `now`, at its own time. `None` where there is none.
    pub fn tick(&mut self, now: Time) -> Option<(Time, Move)> {
        while let Some(Reverse((at, stay, automaton, edge))) = self.timers.peek().copied().filter(|t| t.0.0 <= now.0) {
            self.timers.pop();
            if self.stay.get(automaton) == Some(&stay) {
                let changes = self.take(automaton, edge, Time(at));
                return Some((Time(at), Move::Taken { automaton, edge, changes }));
            }
        }
        None
    }

    /// A codel has returned: `branch` is the place of what it answered among what its call can return, `refuses` whether a codel of the control
    /// task did.
    pub fn complete(&mut self, automaton: usize, branch: usize, refuses: bool, now: Time) -> Option<Move> {
        let calling = self.calling.get_mut(automaton)?.take()?;
        let edge = match calling {
            Calling::On(edge) => {
                let var = self.edge(automaton, edge)?.call.as_ref()?.result.as_ref().map(|(var, _)| *var);
                if let Some(var) = var {
                    self.store(var, branch as i64);
                }
                edge
            }
            Calling::Here => {
                let from = self.location(automaton);
                let leads = |e: &usize| {
                    self.edge(automaton, *e)
                        .is_some_and(|e| e.clock == Some(ClockGuard::Positive) && e.is_refusal == refuses)
                };
                *self.outgoing.get(automaton)?.get(from.0)?.iter().find(|e| leads(e))?
            }
        };
        let changes = self.take(automaton, edge, now);
        Some(Move::Taken { automaton, edge, changes })
    }

    /// Offers a request for a service to a control task that listens.
    pub fn offer(&mut self, automaton: usize, service: ServiceId, now: Time) -> Offer {
        let from = self.location(automaton);
        let outgoing = self.outgoing.get(automaton).and_then(|o| o.get(from.0));
        let is_it = |e: &&usize| self.edge(automaton, **e).is_some_and(|e| e.request == Some(service));
        let Some(edge) = outgoing.and_then(|o| o.iter().find(is_it)).copied() else { return Offer::Unknown };
        if !self.edge(automaton, edge).is_some_and(|e| e.guard.holds(&self.values)) {
            return Offer::Disallowed;
        }
        let changes = self.take(automaton, edge, now);
        Offer::Taken { edge, changes }
    }

    /// A control task may have something to listen to.
    pub fn rouse(&mut self, automaton: usize) {
        if let Some(stay) = self.stay.get(automaton) {
            self.restless.insert((*stay, automaton));
        }
    }

    /// What one automaton can do.
    fn look(&mut self, automaton: usize, now: Time) -> Option<Move> {
        let from = self.location(automaton);
        let here = self.system.clone();
        let declared = here.automata.get(automaton)?;
        let outgoing = self.outgoing.clone();
        let edges = outgoing.get(automaton)?.get(from.0)?;
        let mut listens = false;
        for number in edges {
            let Some(edge) = declared.edges.get(*number) else { continue };
            listens |= edge.class == Class::Request;
            if !edge.eager || edge.clock.is_some() || !edge.guard.holds(&self.values) {
                continue;
            }
            match &edge.call {
                None => {
                    let (edge, changes) = (*number, self.take(automaton, *number, now));
                    return Some(Move::Taken { automaton, edge, changes });
                }
                Some(call) => {
                    if self.begin(automaton, Calling::On(*number)) {
                        return Some(Move::Begins { automaton, codel: call.codel });
                    }
                }
            }
        }
        let codel = declared.locations.get(from.0)?.codel.filter(|_| declared.part == Part::Control);
        if let Some(codel) = codel
            && self.begin(automaton, Calling::Here)
        {
            return Some(Move::Begins { automaton, codel });
        }
        listens.then_some(Move::Listens { automaton })
    }

    /// Notes a call, unless one is under way. The automaton may have other edges meanwhile.
    fn begin(&mut self, automaton: usize, calling: Calling) -> bool {
        let Some(place) = self.calling.get_mut(automaton).filter(|c| c.is_none()) else { return false };
        *place = Some(calling);
        self.rouse(automaton);
        true
    }

    fn take(&mut self, automaton: usize, number: usize, now: Time) -> Vec<Change> {
        let here = self.system.clone();
        let Some(edge) = here.automata.get(automaton).and_then(|a| a.edges.get(number)) else { return Vec::new() };
        let writes = self.writes.clone();
        let written = writes.get(automaton).and_then(|w| w.get(number)).map_or(&[][..], Vec::as_slice);
        // PERF: the same list for every move (`examples/rate.rs`).
        let mut before = std::mem::take(&mut self.before);
        before.clear();
        before.extend(written.iter().map(|var| self.value(*var)));
        edge.actions.iter().for_each(|action| action.apply(&mut self.values));
        let mut changes = Vec::new();
        for (var, before) in written.iter().zip(&before) {
            let after = self.value(*var);
            if after != *before {
                changes.push(Change { var: *var, before: *before, after });
                self.disturb(*var);
            }
        }
        self.before = before;
        if edge.resets
            && let Some(since) = self.since.get_mut(automaton)
        {
            *since = now;
        }
        if edge.from == edge.to && !edge.resets {
            self.rouse(automaton);
            return changes;
        }
        if let Some(at) = self.at.get_mut(automaton) {
            *at = edge.to;
        }
        self.arrive(automaton);
        changes
    }

    /// A new stay begins: what waits for a time in it is noted.
    fn arrive(&mut self, automaton: usize) {
        let Some(stay) = self.stay.get_mut(automaton) else { return };
        self.restless.remove(&(*stay, automaton));
        self.stays += 1;
        *stay = self.stays;
        self.restless.insert((self.stays, automaton));
        let (at, since) = (self.location(automaton), self.since.get(automaton).copied().unwrap_or(Time(0)));
        for number in self.outgoing.get(automaton).and_then(|o| o.get(at.0)).into_iter().flatten() {
            if let Some(Some(ClockGuard::Exactly(ns))) = self.edge(automaton, *number).map(|e| e.clock) {
                let due = since.0.saturating_add_unsigned(ns);
                self.timers.push(Reverse((due, self.stays, automaton, *number)));
            }
        }
    }

    fn store(&mut self, var: VarId, value: i64) {
        if let Some(place) = self.values.get_mut(var.0) {
            *place = value;
        }
        self.disturb(var);
    }

    /// Those who read a variable may be able to move.
    fn disturb(&mut self, var: VarId) {
        for automaton in self.readers.get(var.0).into_iter().flatten() {
            if let Some(stay) = self.stay.get(*automaton) {
                self.restless.insert((*stay, *automaton));
            }
        }
    }
}
