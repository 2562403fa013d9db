//! The automata of a system, move by move. It knows variables, locations and clocks; what a codel is and what becomes of a request is the
//! business of who asks for the moves.
//!
//! Eager edges are taken before time passes. Where several automata could move, the one moves that has been where it is for longest: who
//! waits for a lock longest gets it.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};
use std::sync::Arc;

use lapwing_genom::automata::{Action, Automaton, Class, ClockGuard, Edge, LocId, Part, System, VarId};
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

/// What of the automata never changes.
struct Wiring {
    system: Arc<System>,
    /// By automaton and location: the edges that lead away.
    outgoing: Vec<Vec<Vec<usize>>>,
    /// By automaton and location: those of them that wait for a time, and how long in nanoseconds.
    timed: Vec<Vec<Vec<(usize, u64)>>>,
    /// By variable: the automata of which a guard reads it.
    readers: Vec<Vec<usize>>,
    /// By automaton and edge: the variables that it may write.
    writes: Vec<Vec<Vec<VarId>>>,
}

pub(crate) struct Machine {
    wiring: Wiring,
    state: State,
}

/// How things stand.
struct State {
    values: Vec<i64>,
    /// What variables were before a move.
    before: Vec<i64>,
    at: Vec<LocId>,
    since: Vec<Time>,
    /// The number of each automaton's present stay.
    stay: Vec<u64>,
    stays: u64,
    calling: Vec<Option<Calling>>,
    /// What may be able to move, by how long it has been where it is. An entry of a stay that is over says nothing.
    restless: BinaryHeap<Reverse<(u64, usize)>>,
    /// By automaton: whether it is among those with its present stay.
    is_restless: Vec<bool>,
    timers: BinaryHeap<Timer>,
}

impl Wiring {
    fn new(system: Arc<System>) -> Wiring {
        let automata = &system.automata;
        let outgoing = automata.iter().map(|a| {
            let from = |location| (0..a.edges.len()).filter(move |e| a.edges[*e].from == LocId(location)).collect();
            (0..a.locations.len()).map(from).collect()
        });
        let outgoing: Vec<Vec<Vec<usize>>> = outgoing.collect();
        let exact = |a: &Automaton, edge: usize| match a.edges.get(edge)?.clock? {
            ClockGuard::Exactly(ns) => Some((edge, ns)),
            ClockGuard::Positive => None,
        };
        let timed = automata.iter().zip(&outgoing).map(|(a, from)| {
            from.iter().map(|edges| edges.iter().filter_map(|edge| exact(a, *edge)).collect()).collect()
        });
        let timed = timed.collect();
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
        Wiring {
            timed,
            readers: readers.into_iter().map(|r| r.into_iter().collect()).collect(),
            writes: automata.iter().map(|a| a.edges.iter().map(writes).collect()).collect(),
            outgoing,
            system,
        }
    }

    fn edge(&self, automaton: usize, edge: usize) -> Option<&Edge> {
        self.system.automata.get(automaton)?.edges.get(edge)
    }

    /// The edges that lead away from a location.
    fn outgoing(&self, automaton: usize, from: LocId) -> &[usize] {
        self.outgoing.get(automaton).and_then(|o| o.get(from.0)).map_or(&[], Vec::as_slice)
    }
}

impl Machine {
    /// Everything where it begins, at time 0.
    pub fn new(system: Arc<System>) -> Machine {
        let wiring = Wiring::new(system);
        let (automata, variables) = (wiring.system.automata.len(), &wiring.system.variables);
        let mut state = State {
            values: variables.iter().map(|v| v.initial).collect(),
            before: Vec::new(),
            at: vec![LocId(0); automata],
            since: vec![Time(0); automata],
            stay: vec![0; automata],
            stays: 0,
            calling: vec![None; automata],
            restless: BinaryHeap::new(),
            is_restless: vec![false; automata],
            timers: BinaryHeap::new(),
        };
        (0..automata).for_each(|automaton| state.arrive(&wiring, automaton));
        Machine { wiring, state }
    }

    /// An edge by its number.
    pub fn edge(&self, automaton: usize, edge: usize) -> Option<&Edge> {
        self.wiring.edge(automaton, edge)
    }

    /// What can be done before time passes; `None` where nothing can.
    pub fn next(&mut self, now: Time) -> Option<Move> {
        let Machine { wiring, state } = self;
        while let Some(Reverse((stay, automaton))) = state.restless.pop() {
            // An automaton that has gone elsewhere since is there again, with the stay of that place.
            if state.stay.get(automaton) != Some(&stay) {
                continue;
            }
            if let Some(is_restless) = state.is_restless.get_mut(automaton) {
                *is_restless = false;
            }
            if let Some(found) = state.look(wiring, automaton, now) {
                return Some(found);
            }
        }
        None
    }

    /// When time alone moves something.
    pub fn next_timer(&self) -> Option<Time> {
        self.state.timers.peek().map(|Reverse((at, ..))| Time(*at))
    }

    /// What waits for a time, each with its automaton; of a stay that is over there may be more.
    pub fn timers(&self) -> impl Iterator<Item = (Time, usize)> {
        self.state.timers.iter().map(|Reverse((at, _, automaton, _))| (Time(*at), *automaton))
    }

    /// Takes an edge whose time has come by `now`, at its own time. `None` where there is none.
    pub fn tick(&mut self, now: Time) -> Option<(Time, Move)> {
        let Machine { wiring, state } = self;
        while let Some(Reverse((at, stay, automaton, edge))) = state.timers.peek().copied().filter(|t| t.0.0 <= now.0) {
            state.timers.pop();
            if state.stay.get(automaton) == Some(&stay) {
                let changes = state.take(wiring, automaton, edge, Time(at));
                return Some((Time(at), Move::Taken { automaton, edge, changes }));
            }
        }
        None
    }

    /// A codel has returned: `branch` is the place of what it answered among what its call can return, `refuses` whether a codel of the control
    /// task did.
    pub fn complete(&mut self, automaton: usize, branch: usize, refuses: bool, now: Time) -> Option<Move> {
        let Machine { wiring, state } = self;
        let calling = state.calling.get_mut(automaton)?.take()?;
        let edge = match calling {
            Calling::On(edge) => {
                let var = wiring.edge(automaton, edge)?.call.as_ref()?.result.as_ref().map(|(var, _)| *var);
                if let Some(var) = var {
                    state.store(wiring, var, branch as i64);
                }
                edge
            }
            Calling::Here => {
                let leads = |e: &&usize| {
                    wiring
                        .edge(automaton, **e)
                        .is_some_and(|e| e.clock == Some(ClockGuard::Positive) && e.is_refusal == refuses)
                };
                *wiring.outgoing(automaton, state.location(automaton)).iter().find(leads)?
            }
        };
        let changes = state.take(wiring, automaton, edge, now);
        Some(Move::Taken { automaton, edge, changes })
    }

    /// Offers a request for a service to a control task that listens.
    pub fn offer(&mut self, automaton: usize, service: ServiceId, now: Time) -> Offer {
        let Machine { wiring, state } = self;
        let edges = wiring.outgoing(automaton, state.location(automaton)).iter();
        let mut edges = edges.filter_map(|number| Some((*number, wiring.edge(automaton, *number)?)));
        let Some((number, edge)) = edges.find(|(_, edge)| edge.request == Some(service)) else { return Offer::Unknown };
        if !edge.guard.holds(&state.values) {
            return Offer::Disallowed;
        }
        let changes = state.take(wiring, automaton, number, now);
        Offer::Taken { edge: number, changes }
    }

    /// A control task may have something to listen to.
    pub fn rouse(&mut self, automaton: usize) {
        self.state.rouse(automaton);
    }
}

impl State {
    fn value(&self, var: VarId) -> i64 {
        self.values.get(var.0).copied().unwrap_or(0)
    }

    fn location(&self, automaton: usize) -> LocId {
        self.at.get(automaton).copied().unwrap_or(LocId(0))
    }

    fn rouse(&mut self, automaton: usize) {
        if let (Some(stay), Some(is_restless)) = (self.stay.get(automaton), self.is_restless.get_mut(automaton))
            && !std::mem::replace(is_restless, true)
        {
            self.restless.push(Reverse((*stay, automaton)));
        }
    }

    /// What one automaton can do.
    fn look(&mut self, wiring: &Wiring, automaton: usize, now: Time) -> Option<Move> {
        let from = self.location(automaton);
        let declared = wiring.system.automata.get(automaton)?;
        let mut listens = false;
        for number in wiring.outgoing(automaton, from) {
            let Some(edge) = declared.edges.get(*number) else { continue };
            listens |= edge.class == Class::Request;
            if !edge.eager || edge.clock.is_some() || !edge.guard.holds(&self.values) {
                continue;
            }
            match &edge.call {
                None => {
                    let (edge, changes) = (*number, self.take(wiring, automaton, *number, now));
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

    fn take(&mut self, wiring: &Wiring, automaton: usize, number: usize, now: Time) -> Vec<Change> {
        let Some(edge) = wiring.edge(automaton, number) else { return Vec::new() };
        let written = wiring.writes.get(automaton).and_then(|w| w.get(number)).map_or(&[][..], Vec::as_slice);
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
                self.disturb(wiring, *var);
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
        self.arrive(wiring, automaton);
        changes
    }

    /// A new stay begins: what waits for a time in it is noted.
    fn arrive(&mut self, wiring: &Wiring, automaton: usize) {
        let Some(stay) = self.stay.get_mut(automaton) else { return };
        self.stays += 1;
        *stay = self.stays;
        if let Some(is_restless) = self.is_restless.get_mut(automaton) {
            *is_restless = false;
        }
        self.rouse(automaton);
        let (at, since) = (self.location(automaton), self.since.get(automaton).copied().unwrap_or(Time(0)));
        for (edge, ns) in wiring.timed.get(automaton).and_then(|t| t.get(at.0)).into_iter().flatten() {
            let due = since.0.saturating_add_unsigned(*ns);
            self.timers.push(Reverse((due, self.stays, automaton, *edge)));
        }
    }

    fn store(&mut self, wiring: &Wiring, var: VarId, value: i64) {
        if let Some(place) = self.values.get_mut(var.0) {
            *place = value;
        }
        self.disturb(wiring, var);
    }

    /// Those who read a variable may be able to move.
    fn disturb(&mut self, wiring: &Wiring, var: VarId) {
        for automaton in wiring.readers.get(var.0).into_iter().flatten() {
            self.rouse(*automaton);
        }
    }
}
