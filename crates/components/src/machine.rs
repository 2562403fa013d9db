//! The automata of a system, move by move. It knows variables, locations and clocks; what a codel is and what becomes of a request is the
//! business of who asks for the moves.
//!
//! Eager edges are taken before time passes. Where several automata could move, the one moves that has been where it is for longest: who
//! waits for a lock longest gets it.

mod wiring;

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use lapwing_genom::automata::{ClockGuard, LocId, System, VarId};
use lapwing_genom::model::{CodelId, ServiceId};
use lapwing_stream::Time;

pub(crate) use wiring::Way;
use wiring::Wiring;

/// A variable that has another value than before.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Change {
    pub var: VarId,
    pub before: i64,
    pub after: i64,
}

/// What the automata do next.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Move {
    /// An edge was taken; [`Machine::take_changes`] has what it changed.
    Taken { automaton: usize, edge: usize },
    /// A codel is to be called; [`Machine::complete`] when it has returned.
    Begins { automaton: usize, codel: CodelId },
    /// A control task could take a request.
    Listens { automaton: usize },
}

/// What became of a request that was offered.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Offer {
    /// It was taken, by this edge.
    Taken(usize),
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
    wiring: Wiring,
    state: State,
}

/// How things stand.
struct State {
    values: Vec<i64>,
    /// What the last move has changed.
    changes: Vec<Change>,
    automata: Vec<Stay>,
    stays: u64,
    /// What may be able to move, by its stay: mostly one or two. An entry of a stay that is over says nothing.
    restless: Vec<(u64, usize)>,
    timers: BinaryHeap<Timer>,
}

/// Where an automaton is.
#[derive(Clone)]
struct Stay {
    at: LocId,
    /// When its clock was set.
    since: Time,
    /// The number of its present stay.
    number: u64,
    calling: Option<Calling>,
    /// Whether it is among the restless with this stay.
    is_restless: bool,
}

impl Machine {
    /// Everything where it begins, at time 0.
    pub fn new(system: Arc<System>) -> Machine {
        let wiring = Wiring::new(system);
        let (automata, variables) = (wiring.system.automata.len(), &wiring.system.variables);
        let mut state = State {
            values: variables.iter().map(|v| v.initial).collect(),
            changes: Vec::new(),
            automata: vec![
                Stay { at: LocId(0), since: Time(0), number: 0, calling: None, is_restless: false };
                automata
            ],
            stays: 0,
            restless: Vec::new(),
            timers: BinaryHeap::new(),
        };
        (0..automata).for_each(|automaton| state.arrive(&wiring, automaton));
        Machine { wiring, state }
    }

    /// An edge by its number.
    pub fn way(&self, automaton: usize, edge: usize) -> Option<Way> {
        self.wiring.way_of(automaton, edge)
    }

    /// What can be done before time passes; `None` where nothing can.
    pub fn next(&mut self, now: Time) -> Option<Move> {
        let Machine { wiring, state } = self;
        while let Some((stay, automaton)) = state.longest() {
            // An automaton that has gone elsewhere since is there again, with the stay of that place.
            let Some(own) = state.automata.get_mut(automaton).filter(|own| own.number == stay) else { continue };
            own.is_restless = false;
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
            if state.automata.get(automaton).is_some_and(|own| own.number == stay) {
                state.take(wiring, automaton, edge, Time(at));
                return Some((Time(at), Move::Taken { automaton, edge }));
            }
        }
        None
    }

    /// A codel has returned: `branch` is the place of what it answered among what its call can return, `refuses` whether a codel of the control
    /// task did.
    pub fn complete(&mut self, automaton: usize, branch: usize, refuses: bool, now: Time) -> Option<Move> {
        let Machine { wiring, state } = self;
        let calling = state.automata.get_mut(automaton)?.calling.take()?;
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
                *wiring.outgoing_of(automaton, state.location(automaton)).iter().find(leads)?
            }
        };
        state.take(wiring, automaton, edge, now);
        Some(Move::Taken { automaton, edge })
    }

    /// Offers a request for a service to a control task that listens.
    pub fn offer(&mut self, automaton: usize, service: ServiceId, now: Time) -> Offer {
        let Machine { wiring, state } = self;
        let edges = wiring.outgoing_of(automaton, state.location(automaton)).iter();
        let mut edges = edges.filter_map(|number| Some((*number, wiring.edge(automaton, *number)?)));
        let Some((number, edge)) = edges.find(|(_, edge)| edge.request == Some(service)) else { return Offer::Unknown };
        if !edge.guard.holds(&state.values) {
            return Offer::Disallowed;
        }
        state.take(wiring, automaton, number, now);
        Offer::Taken(number)
    }

    /// What the last move has changed; [`Machine::give_back`] takes the list again, so that there is one for all moves.
    pub fn take_changes(&mut self) -> Vec<Change> {
        std::mem::take(&mut self.state.changes)
    }

    pub fn give_back(&mut self, changes: Vec<Change>) {
        self.state.changes = changes;
    }

    /// A control task may have something to listen to.
    pub fn rouse(&mut self, automaton: usize) {
        self.state.rouse(automaton);
    }
}

impl State {
    fn location(&self, automaton: usize) -> LocId {
        self.automata.get(automaton).map_or(LocId(0), |own| own.at)
    }

    fn rouse(&mut self, automaton: usize) {
        if let Some(own) = self.automata.get_mut(automaton)
            && !std::mem::replace(&mut own.is_restless, true)
        {
            self.restless.push((own.number, automaton));
        }
    }

    /// Takes out who has been where it is for longest, of those that may be able to move.
    fn longest(&mut self) -> Option<(u64, usize)> {
        let first = self.restless.iter().enumerate().min_by_key(|(_, entry)| **entry);
        let place = first.map(|(place, _)| place)?;
        Some(self.restless.swap_remove(place))
    }

    /// What one automaton can do.
    fn look(&mut self, wiring: &Wiring, automaton: usize, now: Time) -> Option<Move> {
        let place = wiring.place_of(automaton, self.location(automaton))?;
        for step in place.steps.of(&wiring.steps) {
            if !wiring.holds(&step.guard, &self.values) {
                continue;
            }
            match step.codel {
                None => {
                    self.take(wiring, automaton, step.edge, now);
                    return Some(Move::Taken { automaton, edge: step.edge });
                }
                Some(codel) => {
                    if self.begin(wiring, automaton, Calling::On(step.edge)) {
                        return Some(Move::Begins { automaton, codel });
                    }
                }
            }
        }
        if let Some(codel) = place.codel
            && self.begin(wiring, automaton, Calling::Here)
        {
            return Some(Move::Begins { automaton, codel });
        }
        place.listens.then_some(Move::Listens { automaton })
    }

    /// Notes an automaton that has come somewhere, if there is anything to do.
    fn ready(&mut self, wiring: &Wiring, automaton: usize) {
        let place = wiring.place_of(automaton, self.location(automaton));
        if place.is_some_and(|place| place.is_busy || !place.steps.is_empty()) {
            self.rouse(automaton);
        }
    }

    /// Notes a call, unless one is under way. The automaton may have other edges meanwhile.
    fn begin(&mut self, wiring: &Wiring, automaton: usize, calling: Calling) -> bool {
        let Some(own) = self.automata.get_mut(automaton).filter(|own| own.calling.is_none()) else { return false };
        own.calling = Some(calling);
        self.ready(wiring, automaton);
        true
    }

    fn take(&mut self, wiring: &Wiring, automaton: usize, number: usize, now: Time) {
        let State { values, changes, .. } = self;
        changes.clear();
        let Some(way) = wiring.way_of(automaton, number) else { return };
        wiring.carry_out(&way, values, |var, before| {
            if changes.iter().all(|change| change.var != var) {
                changes.push(Change { var, before, after: before });
            }
        });
        for change in changes.iter_mut() {
            change.after = values.get(change.var.0).copied().unwrap_or(change.before);
        }
        changes.retain(|change| change.after != change.before);
        if changes.len() > 1 {
            changes.sort_unstable_by_key(|change| change.var);
        }
        for place in 0..self.changes.len() {
            if let Some(Change { var, after, .. }) = self.changes.get(place).copied() {
                self.disturb(wiring, var, after);
            }
        }
        let Some(own) = self.automata.get_mut(automaton) else { return };
        if way.resets {
            own.since = now;
        }
        if way.from == way.to && !way.resets {
            return self.ready(wiring, automaton);
        }
        own.at = way.to;
        self.arrive(wiring, automaton);
    }

    /// A new stay begins: what waits for a time in it is noted.
    fn arrive(&mut self, wiring: &Wiring, automaton: usize) {
        let Some(own) = self.automata.get_mut(automaton) else { return };
        self.stays += 1;
        (own.number, own.is_restless) = (self.stays, false);
        let (at, since) = (own.at, own.since);
        self.ready(wiring, automaton);
        for (edge, ns) in wiring.place_of(automaton, at).map_or(&[][..], |place| place.timed.of(&wiring.timed)) {
            let due = since.0.saturating_add_unsigned(*ns);
            self.timers.push(Reverse((due, self.stays, automaton, *edge)));
        }
    }

    fn store(&mut self, wiring: &Wiring, var: VarId, value: i64) {
        if let Some(place) = self.values.get_mut(var.0) {
            *place = value;
        }
        self.disturb(wiring, var, value);
    }

    /// Notes those who are where a variable with this value may let them move.
    fn disturb(&mut self, wiring: &Wiring, var: VarId, value: i64) {
        for (automaton, places) in wiring.hopeful(var, value) {
            if self.automata.get(automaton).is_some_and(|own| !own.is_restless && places.has(own.at)) {
                self.rouse(automaton);
            }
        }
    }
}
