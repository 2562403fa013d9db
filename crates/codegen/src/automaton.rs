//! The automaton of a formula: its states are what may be left of it, its moves decision trees over what a position shows.
//!
//! All obligations of one tracker in one state fare alike from there on. So where no bound is in the formula, a count for each state and
//! the oldest beginning are all that has to be remembered, however many obligations are open. Where there are bounds an obligation has
//! clocks besides ([`clock`](crate::clock)), and a move says what becomes of them.

use std::collections::BTreeMap;

use crate::clock::{BEGUN, Clock, MOST, NOW};
use crate::formula::{Beyond, Ref, Table};
use crate::residual::{Atom, End, Rest, Test};

/// What becomes of an obligation.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Fate {
    Met,
    Failed,
    /// It goes on.
    Open(Target),
}

/// A state to go to, and where each of its clocks comes from: one of the state before, of the same age or younger, or [`NOW`]. What it has
/// no clock for is [`BEGUN`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct Target {
    pub state: usize,
    pub clocks: [Clock; MOST],
}

/// A decision tree.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Tree {
    To(Fate),
    If(Test, Box<Tree>, Box<Tree>),
}

/// A state.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub moves: Tree,
    /// Where the segment closes.
    pub closes_met: bool,
    /// Whether it would be missed, were the trace all.
    pub is_missed: bool,
    /// Of each clock, the bound that ends first, and what then becomes of it.
    pub deadlines: Vec<(End, Fate)>,
    /// How many clocks it has beside [`BEGUN`].
    pub clocks: usize,
    /// Whether it matters when the obligation began.
    pub asks_begin: bool,
}

/// The automaton of a formula.
#[derive(Clone, Debug)]
pub(crate) struct Automaton {
    /// Where an obligation begins.
    pub begin: Tree,
    pub states: Vec<State>,
}

/// More states, or more branches in all, make no monitor for a small machine.
const STATES: usize = 60;
const BRANCHES: usize = 2_000;
/// What is left of a formula never has more atoms.
const ATOMS: usize = 100;

impl Automaton {
    pub fn of(table: &Table, root: Ref) -> Result<Automaton, Beyond> {
        let mut build = Build { table, numbers: BTreeMap::new(), rests: Vec::new(), branches: 0, now: BEGUN };
        let begin = build.tree(&Rest::Open(Atom::Next(root), false), &mut Vec::new())?;
        build.now = NOW;
        let mut states = Vec::new();
        while let Some(rest) = build.rests.get(states.len()).cloned() {
            let moves = build.tree(&rest, &mut Vec::new())?;
            let mut deadlines = Vec::new();
            for end in table.ends(&rest) {
                deadlines.push((end, build.fate(table.expire(&rest, end))?));
            }
            states.push(State {
                moves,
                closes_met: table.close(&rest),
                is_missed: table.end(&rest) == Some(false),
                deadlines,
                clocks: rest.clocks().len(),
                asks_begin: rest.asks_begin(),
            });
        }
        Ok(Automaton { begin, states })
    }

    /// Whether a bound decides anything.
    pub fn is_timed(&self) -> bool {
        self.states.iter().any(|s| !s.deadlines.is_empty() || s.moves.asks_time())
    }

    /// How many clocks an obligation needs beside the one that began with it.
    pub fn clocks(&self) -> usize {
        self.states.iter().map(|s| s.clocks).max().unwrap_or(0)
    }

    /// The fate of what stays in a state as it is.
    pub fn stays(&self, state: usize) -> Fate {
        let mut clocks = [BEGUN; MOST];
        let own = self.states.get(state).map_or(0, |s| s.clocks);
        clocks.iter_mut().zip(1..).take(own).for_each(|(clock, own)| *clock = own);
        Fate::Open(Target { state, clocks })
    }
}

impl Tree {
    /// Whether the time since the beginning matters.
    pub fn asks_time(&self) -> bool {
        match self {
            Tree::To(_) => false,
            Tree::If(test, a, b) => matches!(test, Test::Begun(..)) || a.asks_time() || b.asks_time(),
        }
    }
}

struct Build<'t> {
    table: &'t Table,
    numbers: BTreeMap<Rest, usize>,
    rests: Vec<Rest>,
    branches: usize,
    /// What a clock that begins now is called afterwards, where it is none of its own.
    now: Clock,
}

impl Build<'_> {
    /// The moves of a state, some tests being answered.
    fn tree(&mut self, rest: &Rest, known: &mut Vec<(Test, bool)>) -> Result<Tree, Beyond> {
        let mut answers = |test: Test| known.iter().find(|(t, _)| *t == test).map(|(_, is)| *is).ok_or(test);
        let test = match self.table.progress(rest, &mut answers) {
            Ok(rest) => return Ok(Tree::To(self.fate(rest)?)),
            Err(test) => test,
        };
        self.branches += 1;
        if self.branches > BRANCHES {
            return Err(Beyond::TooLarge);
        }
        let mut way = |build: &mut Self, is: bool| {
            known.push((test, is));
            let tree = build.tree(rest, known);
            known.pop();
            tree
        };
        let (yes, no) = (way(self, true)?, way(self, false)?);
        Ok(if yes == no { yes } else { Tree::If(test, Box::new(yes), Box::new(no)) })
    }

    fn fate(&mut self, rest: Rest) -> Result<Fate, Beyond> {
        match rest {
            Rest::Known(true) => Ok(Fate::Met),
            Rest::Known(false) => Ok(Fate::Failed),
            rest => {
                let rest = if self.now == NOW { rest } else { rest.by(&|_| self.now) };
                let used = rest.clocks();
                let mut clocks = [BEGUN; MOST];
                if used.len() > MOST {
                    return Err(Beyond::LateBound);
                }
                clocks.iter_mut().zip(&used).for_each(|(clock, from)| *clock = *from);
                let place = |clock| used.iter().position(|c| *c == clock).and_then(|at| Clock::try_from(at + 1).ok());
                Ok(Fate::Open(Target { state: self.number(rest.by(&|clock| place(clock).unwrap_or(BEGUN)))?, clocks }))
            }
        }
    }
    fn number(&mut self, rest: Rest) -> Result<usize, Beyond> {
        let next = self.rests.len();
        let number = match self.numbers.get(&rest) {
            Some(&number) => number,
            None if next >= STATES || rest.size() > ATOMS => return Err(Beyond::TooLarge),
            None => {
                self.numbers.insert(rest.clone(), next);
                self.rests.push(rest);
                next
            }
        };
        Ok(number)
    }
}
