//! What of the automata never changes, laid out to be looked at often: numbers in a row, each automaton's after that of the one before.
//!
//! PERF: where a task sleeps for milliseconds the next turn finds nothing of this in the processor's caches, so that what a move costs is how much memory it
//! touches (`examples/navigation/examples/speed.rs`).

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use lapwing_genom::automata::{Action, Automaton, Class, ClockGuard, Cond, Edge, LocId, Part, System, VarId};
use lapwing_genom::model::CodelId;

/// Some that follow each other in one of the tables.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct Row {
    start: u32,
    end: u32,
}

impl Row {
    /// These of a table.
    pub fn of<T>(self, table: &[T]) -> &[T] {
        table.get(self.start as usize..self.end as usize).unwrap_or(&[])
    }

    pub fn is_empty(self) -> bool {
        self.start == self.end
    }

    /// Puts some behind what is in a table.
    fn add<T>(table: &mut Vec<T>, all: impl IntoIterator<Item = T>) -> Row {
        let start = small(table.len());
        table.extend(all);
        Row { start, end: small(table.len()) }
    }
}

/// A number in a table. None of them is so long that it would not fit: a table of a task has no more than 128 cells, and files are limited.
fn small(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

pub(super) struct Wiring {
    pub system: Arc<System>,
    /// By automaton: where its places and its edges begin in the tables.
    first: Vec<(usize, usize)>,
    places: Vec<Place>,
    ways: Vec<Way>,
    /// Numbers of edges.
    pub outgoing: Vec<usize>,
    pub steps: Vec<Step>,
    /// Edges that wait for a time, and how long in nanoseconds.
    pub timed: Vec<(usize, u64)>,
    /// By variable: who hopes for something of it.
    hopes: Vec<Row>,
    all_hopes: Vec<Hope>,
    code: Code,
}

/// A location.
#[derive(Clone, Copy)]
pub(super) struct Place {
    /// The edges that lead away.
    pub outgoing: Row,
    /// What can be done as soon as a guard holds.
    pub steps: Row,
    pub timed: Row,
    /// Whether a control task has a codel to call here, or could take a request.
    pub is_busy: bool,
    /// The codel of a control task.
    pub codel: Option<CodelId>,
    /// Whether it could take a request.
    pub listens: bool,
}

/// An edge that is taken, or whose codel is called, as soon as its guard holds.
#[derive(Clone, Copy)]
pub(super) struct Step {
    pub edge: usize,
    pub guard: Guard,
    pub codel: Option<CodelId>,
}

/// An edge: what it does, and what that means.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    pub component: usize,
    pub from: LocId,
    pub to: LocId,
    /// It is one of an activity.
    pub is_activity: bool,
    /// A turn of a task begins with it.
    pub is_turn: bool,
    /// A control task is done with a request.
    pub concludes: bool,
    pub is_refusal: bool,
    pub(super) resets: bool,
    ops: Row,
}

/// Automata that may move where a variable has a value.
struct Hope {
    /// Which; any where none is said.
    wanted: Option<i64>,
    automaton: usize,
    /// Where they have to be: of the locations from this one on, those whose bits are set.
    from: usize,
    at: u64,
}

/// A condition: what must hold of single variables, of what else one alternative each must, and what is more intricate.
#[derive(Clone, Copy)]
pub(super) struct Guard {
    tests: Row,
    choices: Row,
    others: Row,
    /// Whether there are only tests.
    is_plain: bool,
}

/// Conditions and what edges do.
#[derive(Default)]
struct Code {
    tests: Vec<Test>,
    /// Alternatives, each a single test.
    choices: Vec<Row>,
    others: Vec<Cond>,
    guards: Vec<Guard>,
    ops: Vec<Op>,
}

/// What must hold of a variable.
#[derive(Clone, Copy)]
enum Test {
    Is(u32, i64),
    Not(u32, i64),
    Less(u32, i64),
}

/// A step of what an edge does.
#[derive(Clone, Copy)]
enum Op {
    Set(u32, i64),
    Add(u32, i64),
    /// The next so many are left out unless a guard holds, by its number.
    If(u32, u32),
    /// The next so many are left out.
    Skip(u32),
}

impl Code {
    fn guard(&mut self, cond: &Cond) -> Guard {
        let (mut tests, mut choices, mut others) = (Vec::new(), Vec::new(), Vec::new());
        let mut left = vec![cond];
        while let Some(cond) = left.pop() {
            match cond {
                Cond::All(parts) => left.extend(parts.iter().rev()),
                Cond::Any(parts) => match parts.iter().map(Test::of).collect::<Option<Vec<Test>>>() {
                    Some(alternatives) => choices.push(Row::add(&mut self.tests, alternatives)),
                    None => others.push(cond.clone()),
                },
                single => tests.extend(Test::of(single)),
            }
        }
        Guard {
            is_plain: choices.is_empty() && others.is_empty(),
            tests: Row::add(&mut self.tests, tests),
            choices: Row::add(&mut self.choices, choices),
            others: Row::add(&mut self.others, others),
        }
    }

    fn actions(&mut self, all: &[Action]) -> Vec<Op> {
        let mut ops = Vec::new();
        for action in all {
            match action {
                Action::Set(var, value) => ops.push(Op::Set(small(var.0), *value)),
                Action::Add(var, by) => ops.push(Op::Add(small(var.0), *by)),
                Action::If(cond, then, otherwise) => {
                    let guard = self.guard(cond);
                    let number = small(self.guards.len());
                    self.guards.push(guard);
                    let (mut then, otherwise) = (self.actions(then), self.actions(otherwise));
                    if !otherwise.is_empty() {
                        then.push(Op::Skip(small(otherwise.len())));
                    }
                    ops.push(Op::If(number, small(then.len())));
                    ops.extend(then.into_iter().chain(otherwise));
                }
            }
        }
        ops
    }

    fn holds(&self, guard: &Guard, values: &[i64]) -> bool {
        let is_so = |test: &Test| test.holds(values);
        if !guard.tests.of(&self.tests).iter().all(is_so) {
            return false;
        }
        guard.is_plain || self.rest_holds(guard, values)
    }

    fn rest_holds(&self, guard: &Guard, values: &[i64]) -> bool {
        let is_so = |test: &Test| test.holds(values);
        guard.choices.of(&self.choices).iter().all(|one| one.of(&self.tests).iter().any(is_so))
            && guard.others.of(&self.others).iter().all(|cond| cond.holds(values))
    }
}

impl Test {
    /// A condition that is a single test.
    fn of(cond: &Cond) -> Option<Test> {
        match *cond {
            Cond::Is(var, value) => Some(Test::Is(small(var.0), value)),
            Cond::Not(var, value) => Some(Test::Not(small(var.0), value)),
            Cond::Less(var, value) => Some(Test::Less(small(var.0), value)),
            Cond::All(_) | Cond::Any(_) => None,
        }
    }

    fn holds(self, values: &[i64]) -> bool {
        let value = |var: u32| values.get(var as usize).copied().unwrap_or(0);
        match self {
            Test::Is(var, wanted) => value(var) == wanted,
            Test::Not(var, other) => value(var) != other,
            Test::Less(var, bound) => value(var) < bound,
        }
    }
}

impl Wiring {
    pub fn new(system: Arc<System>) -> Wiring {
        let mut wiring = Wiring {
            first: Vec::new(),
            places: Vec::new(),
            ways: Vec::new(),
            outgoing: Vec::new(),
            steps: Vec::new(),
            timed: Vec::new(),
            hopes: Vec::new(),
            all_hopes: Vec::new(),
            code: Code::default(),
            system: system.clone(),
        };
        // By variable: for each value that somebody hopes for, who is where.
        let mut hoped = vec![BTreeMap::new(); system.variables.len()];
        for (number, automaton) in system.automata.iter().enumerate() {
            wiring.first.push((wiring.places.len(), wiring.ways.len()));
            for at in 0..automaton.locations.len() {
                wiring.place(automaton, LocId(at));
            }
            automaton.edges.iter().for_each(|edge| wiring.way(automaton, edge));
            for edge in automaton.edges.iter().filter(|edge| is_spontaneous(edge)) {
                hopes(&edge.guard, &mut |var, value| {
                    if let Some(of_var) = hoped.get_mut(var.0) {
                        let places: &mut BTreeSet<usize> = of_var.entry((value, number)).or_default();
                        places.insert(edge.from.0);
                    }
                });
            }
        }
        for of_var in hoped {
            let hopes =
                of_var.into_iter().flat_map(|((wanted, automaton), places)| Hope::all(wanted, automaton, &places));
            let row = Row::add(&mut wiring.all_hopes, hopes);
            wiring.hopes.push(row);
        }
        wiring
    }

    fn place(&mut self, automaton: &Automaton, at: LocId) {
        let edges = || automaton.edges.iter().enumerate().filter(|(_, edge)| edge.from == at);
        let timed = |(number, edge): (usize, &Edge)| match edge.clock? {
            ClockGuard::Exactly(ns) => Some((number, ns)),
            ClockGuard::Positive => None,
        };
        let code = &mut self.code;
        let steps = edges().filter(|(_, edge)| is_spontaneous(edge)).map(|(number, edge)| Step {
            edge: number,
            guard: code.guard(&edge.guard),
            codel: edge.call.as_ref().map(|call| call.codel),
        });
        let is_control = automaton.part == Part::Control;
        let codel = automaton.locations.get(at.0).and_then(|l| l.codel).filter(|_| is_control);
        let listens = is_control && edges().any(|(_, edge)| edge.class == Class::Request);
        self.places.push(Place {
            steps: Row::add(&mut self.steps, steps),
            outgoing: Row::add(&mut self.outgoing, edges().map(|(number, _)| number)),
            timed: Row::add(&mut self.timed, edges().filter_map(timed)),
            is_busy: codel.is_some() || listens,
            codel,
            listens,
        });
    }

    fn way(&mut self, automaton: &Automaton, edge: &Edge) {
        let ops = self.code.actions(&edge.actions);
        let row = Row::add(&mut self.code.ops, ops);
        let leads_to = |name: &str| automaton.locations.get(edge.to.0).is_some_and(|l| l.name == name);
        self.ways.push(Way {
            component: automaton.component,
            from: edge.from,
            to: edge.to,
            is_activity: automaton.part == Part::Activity,
            is_turn: automaton.part == Part::Manager && edge.from != edge.to && edge.from == LocId(0),
            concludes: automaton.part == Part::Control && edge.class != Class::Request && leads_to("finish"),
            is_refusal: edge.is_refusal,
            resets: edge.resets,
            ops: row,
        });
    }

    /// An edge as the automata have it.
    pub fn edge(&self, automaton: usize, edge: usize) -> Option<&Edge> {
        self.system.automata.get(automaton)?.edges.get(edge)
    }

    /// An edge by its number.
    pub fn way_of(&self, automaton: usize, edge: usize) -> Option<Way> {
        let (_, first) = *self.first.get(automaton)?;
        self.ways.get(first + edge).copied()
    }

    pub fn place_of(&self, automaton: usize, at: LocId) -> Option<&Place> {
        let (first, _) = *self.first.get(automaton)?;
        self.places.get(first + at.0)
    }

    /// The edges that lead away from a location.
    pub fn outgoing_of(&self, automaton: usize, from: LocId) -> &[usize] {
        self.place_of(automaton, from).map_or(&[], |place| place.outgoing.of(&self.outgoing))
    }

    pub fn holds(&self, guard: &Guard, values: &[i64]) -> bool {
        self.code.holds(guard, values)
    }

    /// Does what an edge does. Tells before a variable gets another value which one, and the value that it had.
    pub fn carry_out(&self, way: &Way, values: &mut [i64], mut tell: impl FnMut(VarId, i64)) {
        let mut ops = way.ops.of(&self.code.ops);
        while let Some((op, rest)) = ops.split_first() {
            ops = rest;
            let left_out = match *op {
                Op::Set(var, value) => {
                    put(values, var, value, &mut tell);
                    continue;
                }
                Op::Add(var, by) => {
                    let value = values.get(var as usize).copied().unwrap_or(0) + by;
                    put(values, var, value, &mut tell);
                    continue;
                }
                Op::Skip(count) => count,
                Op::If(guard, count) => {
                    let guard = self.code.guards.get(guard as usize);
                    if guard.is_some_and(|guard| self.code.holds(guard, values)) { 0 } else { count }
                }
            };
            ops = ops.get(left_out as usize..).unwrap_or(&[]);
        }
    }

    /// Who may be able to move because a variable has a value, if they are in one of these places.
    pub fn hopeful(&self, var: VarId, value: i64) -> impl Iterator<Item = (usize, Stand)> {
        let all = self.hopes.get(var.0).copied().unwrap_or_default().of(&self.all_hopes);
        let hopeful = all.iter().filter(move |hope| hope.wanted.is_none_or(|wanted| wanted == value));
        hopeful.map(|hope| (hope.automaton, Stand { from: hope.from, at: hope.at }))
    }
}

/// Some locations of an automaton.
#[derive(Clone, Copy)]
pub(super) struct Stand {
    from: usize,
    at: u64,
}

impl Stand {
    pub fn has(self, at: LocId) -> bool {
        let bit = at.0.checked_sub(self.from).filter(|bit| *bit < 64);
        bit.is_some_and(|bit| self.at >> bit & 1 == 1)
    }
}

impl Hope {
    /// One for every sixty-four locations.
    fn all(wanted: Option<i64>, automaton: usize, places: &BTreeSet<usize>) -> Vec<Hope> {
        let mut all = BTreeMap::new();
        for place in places {
            *all.entry(place - place % 64).or_insert(0) |= 1_u64 << (place % 64);
        }
        all.into_iter().map(|(from, at)| Hope { wanted, automaton, from, at }).collect()
    }
}

/// Gives a variable a value.
fn put(values: &mut [i64], var: u32, value: i64, tell: &mut impl FnMut(VarId, i64)) {
    let var = var as usize;
    if let Some(place) = values.get_mut(var).filter(|place| **place != value) {
        tell(VarId(var), *place);
        *place = value;
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
