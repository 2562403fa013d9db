//! The automata of a system, move by move. It knows variables, locations and clocks; what a codel is and what becomes of a request is the
//! business of who asks for the moves.
//!
//! Eager edges are taken before time passes. Where several automata could move, the one moves that has been where it is for longest: who
//! waits for a lock longest gets it.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};
use std::sync::Arc;

use lapwing_genom::automata::{Action, Automaton, Class, ClockGuard, Cond, Edge, LocId, Part, System, VarId};
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

/// What of the automata never changes.
struct Wiring {
    system: Arc<System>,
    /// By automaton and location.
    places: Vec<Vec<Place>>,
    /// By variable: the automata that can move as soon as it has a value, or any, if all else is as they want it.
    readers: Vec<Vec<(Option<i64>, usize)>>,
    /// By automaton and edge: the variables that it may write.
    writes: Vec<Vec<Vec<VarId>>>,
}

/// A location.
struct Place {
    /// The edges that lead away.
    outgoing: Vec<usize>,
    /// What can be done as soon as a guard holds.
    steps: Vec<Step>,
    /// The edges that wait for a time, and how long in nanoseconds.
    timed: Vec<(usize, u64)>,
    /// The variables on which that depends, and what each has to become: a value, or any.
    hopes: Vec<(VarId, Option<i64>)>,
    /// Whether a control task has a codel to call here, or could take a request.
    is_busy: bool,
}

/// An edge that is taken, or whose codel is called, as soon as its guard holds.
struct Step {
    edge: usize,
    guard: Guard,
    codel: Option<CodelId>,
}

/// A condition, laid out to be looked at often: what must hold of single variables, and what else must.
struct Guard {
    tests: Box<[Test]>,
    others: Box<[Cond]>,
}

/// What must hold of a variable.
#[derive(Clone, Copy)]
enum Test {
    Is(VarId, i64),
    Not(VarId, i64),
    Less(VarId, i64),
}

impl Guard {
    fn new(cond: &Cond) -> Guard {
        let (mut tests, mut others) = (Vec::new(), Vec::new());
        let mut left = vec![cond];
        while let Some(cond) = left.pop() {
            match cond {
                Cond::Is(var, value) => tests.push(Test::Is(*var, *value)),
                Cond::Not(var, value) => tests.push(Test::Not(*var, *value)),
                Cond::Less(var, value) => tests.push(Test::Less(*var, *value)),
                Cond::All(parts) => left.extend(parts.iter().rev()),
                Cond::Any(_) => others.push(cond.clone()),
            }
        }
        Guard { tests: tests.into(), others: others.into() }
    }

    fn holds(&self, values: &[i64]) -> bool {
        let value = |var: VarId| values.get(var.0).copied().unwrap_or(0);
        let is_so = |test: &Test| match *test {
            Test::Is(var, wanted) => value(var) == wanted,
            Test::Not(var, other) => value(var) != other,
            Test::Less(var, bound) => value(var) < bound,
        };
        self.tests.iter().all(is_so) && self.others.iter().all(|cond| cond.holds(values))
    }
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
    /// What the last move has changed.
    changes: Vec<Change>,
    at: Vec<LocId>,
    since: Vec<Time>,
    /// The number of each automaton's present stay.
    stay: Vec<u64>,
    stays: u64,
    calling: Vec<Option<Calling>>,
    /// What may be able to move, by its stay: mostly one or two. An entry of a stay that is over says nothing.
    restless: Vec<(u64, usize)>,
    /// By automaton: whether it is among those with its present stay.
    is_restless: Vec<bool>,
    timers: BinaryHeap<Timer>,
}

impl Wiring {
    fn new(system: Arc<System>) -> Wiring {
        let automata = &system.automata;
        let places = automata.iter().map(|a| (0..a.locations.len()).map(|at| Place::new(a, LocId(at))).collect());
        let mut readers = vec![BTreeSet::new(); system.variables.len()];
        for (number, automaton) in automata.iter().enumerate() {
            for edge in automaton.edges.iter().filter(|e| is_spontaneous(e)) {
                hopes(&edge.guard, &mut |var, value| {
                    readers.get_mut(var.0).map(|r: &mut BTreeSet<_>| r.insert((value, number)));
                });
            }
        }
        let writes = |edge: &Edge| {
            let mut all = Vec::new();
            edge.actions.iter().for_each(|action: &Action| action.writes(&mut |var| all.push(var)));
            all.sort_unstable();
            all.dedup();
            all
        };
        Wiring {
            places: places.collect(),
            readers: readers.into_iter().map(|r| r.into_iter().collect()).collect(),
            writes: automata.iter().map(|a| a.edges.iter().map(writes).collect()).collect(),
            system,
        }
    }

    fn edge(&self, automaton: usize, edge: usize) -> Option<&Edge> {
        self.system.automata.get(automaton)?.edges.get(edge)
    }

    fn place(&self, automaton: usize, at: LocId) -> Option<&Place> {
        self.places.get(automaton)?.get(at.0)
    }

    /// The edges that lead away from a location.
    fn outgoing(&self, automaton: usize, from: LocId) -> &[usize] {
        self.place(automaton, from).map_or(&[], |place| &place.outgoing)
    }
}

impl Place {
    fn new(automaton: &Automaton, at: LocId) -> Place {
        let edges = || automaton.edges.iter().enumerate().filter(|(_, edge)| edge.from == at);
        let step = |(number, edge): (usize, &Edge)| Step {
            edge: number,
            guard: Guard::new(&edge.guard),
            codel: edge.call.as_ref().map(|call| call.codel),
        };
        let timed = |(number, edge): (usize, &Edge)| match edge.clock? {
            ClockGuard::Exactly(ns) => Some((number, ns)),
            ClockGuard::Positive => None,
        };
        let has_codel = automaton.locations.get(at.0).is_some_and(|l| l.codel.is_some());
        let listens = edges().any(|(_, edge)| edge.class == Class::Request);
        let mut hoped = BTreeSet::new();
        for (_, edge) in edges().filter(|(_, edge)| is_spontaneous(edge)) {
            hopes(&edge.guard, &mut |var, value| _ = hoped.insert((var, value)));
        }
        Place {
            hopes: hoped.into_iter().collect(),
            outgoing: edges().map(|(number, _)| number).collect(),
            steps: edges().filter(|(_, edge)| is_spontaneous(edge)).map(step).collect(),
            timed: edges().filter_map(timed).collect(),
            is_busy: automaton.part == Part::Control && (has_codel || listens),
        }
    }
}

/// Whether an edge is taken as soon as its guard holds.
fn is_spontaneous(edge: &Edge) -> bool {
    edge.eager && edge.clock.is_none()
}

/// Tells what may make a condition hold: of those that must all hold, one comes last.
fn hopes(guard: &Cond, tell: &mut impl FnMut(VarId, Option<i64>)) {
    match guard {
        Cond::Is(var, value) => tell(*var, Some(*value)),
        Cond::Not(var, _) | Cond::Less(var, _) => tell(*var, None),
        Cond::All(parts) | Cond::Any(parts) => parts.iter().for_each(|part| hopes(part, tell)),
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
            changes: Vec::new(),
            at: vec![LocId(0); automata],
            since: vec![Time(0); automata],
            stay: vec![0; automata],
            stays: 0,
            calling: vec![None; automata],
            restless: Vec::new(),
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
        while let Some((stay, automaton)) = state.longest() {
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
        state.take(wiring, automaton, edge, now);
        Some(Move::Taken { automaton, edge })
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
            self.restless.push((*stay, automaton));
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
        let from = self.location(automaton);
        let place = wiring.place(automaton, from)?;
        for step in &place.steps {
            if !step.guard.holds(&self.values) {
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
        if !place.is_busy {
            return None;
        }
        let declared = wiring.system.automata.get(automaton)?;
        if let Some(codel) = declared.locations.get(from.0)?.codel
            && self.begin(wiring, automaton, Calling::Here)
        {
            return Some(Move::Begins { automaton, codel });
        }
        let mut edges = place.outgoing.iter().filter_map(|number| declared.edges.get(*number));
        edges.any(|edge| edge.class == Class::Request).then_some(Move::Listens { automaton })
    }

    /// Notes an automaton that has come somewhere, if there is anything to do.
    fn ready(&mut self, wiring: &Wiring, automaton: usize) {
        let place = wiring.place(automaton, self.location(automaton));
        if place.is_some_and(|place| place.is_busy || !place.steps.is_empty()) {
            self.rouse(automaton);
        }
    }

    /// Notes a call, unless one is under way. The automaton may have other edges meanwhile.
    fn begin(&mut self, wiring: &Wiring, automaton: usize, calling: Calling) -> bool {
        let Some(place) = self.calling.get_mut(automaton).filter(|c| c.is_none()) else { return false };
        *place = Some(calling);
        self.ready(wiring, automaton);
        true
    }

    fn take(&mut self, wiring: &Wiring, automaton: usize, number: usize, now: Time) {
        self.changes.clear();
        let Some(edge) = wiring.edge(automaton, number) else { return };
        let written = wiring.writes.get(automaton).and_then(|w| w.get(number)).map_or(&[][..], Vec::as_slice);
        // PERF: the same list for every move (`examples/rate.rs`).
        let mut before = std::mem::take(&mut self.before);
        before.clear();
        before.extend(written.iter().map(|var| self.value(*var)));
        edge.actions.iter().for_each(|action| action.apply(&mut self.values));
        for (var, before) in written.iter().zip(&before) {
            let after = self.value(*var);
            if after != *before {
                self.changes.push(Change { var: *var, before: *before, after });
                self.disturb(wiring, *var, after);
            }
        }
        self.before = before;
        if edge.resets
            && let Some(since) = self.since.get_mut(automaton)
        {
            *since = now;
        }
        if edge.from == edge.to && !edge.resets {
            return self.ready(wiring, automaton);
        }
        if let Some(at) = self.at.get_mut(automaton) {
            *at = edge.to;
        }
        self.arrive(wiring, automaton);
    }

    /// A new stay begins: what waits for a time in it is noted.
    fn arrive(&mut self, wiring: &Wiring, automaton: usize) {
        let Some(stay) = self.stay.get_mut(automaton) else { return };
        self.stays += 1;
        *stay = self.stays;
        if let Some(is_restless) = self.is_restless.get_mut(automaton) {
            *is_restless = false;
        }
        let stay = self.stays;
        self.ready(wiring, automaton);
        let (at, since) = (self.location(automaton), self.since.get(automaton).copied().unwrap_or(Time(0)));
        for (edge, ns) in wiring.place(automaton, at).map_or(&[][..], |place| &place.timed) {
            let due = since.0.saturating_add_unsigned(*ns);
            self.timers.push(Reverse((due, stay, automaton, *edge)));
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
        // PERF: of those who read a variable few wait for this value, where they are (`examples/navigation/examples/speed.rs`).
        let is_value = |wanted: Option<i64>| wanted.is_none_or(|wanted| wanted == value);
        for (wanted, automaton) in wiring.readers.get(var.0).into_iter().flatten() {
            if !is_value(*wanted) || self.is_restless.get(*automaton) == Some(&true) {
                continue;
            }
            let place = wiring.place(*automaton, self.location(*automaton));
            if place.is_some_and(|place| place.hopes.iter().any(|hope| hope.0 == var && is_value(hope.1))) {
                self.rouse(*automaton);
            }
        }
    }
}
