//! The automaton of a formula: its states are what may be left of it, its moves decision trees over what a position shows.
//!
//! All obligations of one tracker in one state fare alike from there on. So where no bound is in the formula, a count for each state and
//! the oldest beginning are all that has to be remembered, however many obligations are open.

use std::collections::BTreeMap;

use crate::formula::{Beyond, Ref, Table};
use crate::residual::{Atom, Rest, Test};

/// What becomes of an obligation.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Fate {
    Met,
    Failed,
    /// It is in the state of that number.
    Open(usize),
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
    /// The bound that ends first, whether that end is in, and what then becomes of it.
    pub deadline: Option<(i64, bool, Fate)>,
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
        if !table.is_bounded_at_begin(root) {
            return Err(Beyond::LateBound);
        }
        let mut build = Build { table, numbers: BTreeMap::new(), rests: Vec::new(), branches: 0 };
        let begin = build.tree(&Rest::Open(Atom::Next(root), false), &mut Vec::new())?;
        let mut states = Vec::new();
        while let Some(rest) = build.rests.get(states.len()).cloned() {
            let moves = build.tree(&rest, &mut Vec::new())?;
            let deadline = match table.deadline(&rest) {
                Some(over) => Some((over.0, over.1, build.fate(table.expire(&rest, over))?)),
                None => None,
            };
            let is_missed = table.end(&rest) == Some(false);
            states.push(State { moves, closes_met: table.close(&rest), is_missed, deadline });
        }
        Ok(Automaton { begin, states })
    }

    /// Whether a bound decides anything.
    pub fn is_timed(&self) -> bool {
        self.states.iter().any(|s| s.deadline.is_some() || s.moves.asks_time())
    }
}

impl Tree {
    /// Whether the time since the beginning matters.
    pub fn asks_time(&self) -> bool {
        match self {
            Tree::To(_) => false,
            Tree::If(test, a, b) => matches!(test, Test::Begun(_)) || a.asks_time() || b.asks_time(),
        }
    }
}

struct Build<'t> {
    table: &'t Table,
    numbers: BTreeMap<Rest, usize>,
    rests: Vec<Rest>,
    branches: usize,
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
                let next = self.rests.len();
                if next >= STATES || rest.size() > ATOMS {
                    return Err(Beyond::TooLarge);
                }
                let number = *self.numbers.entry(rest.clone()).or_insert(next);
                if number == next {
                    self.rests.push(rest);
                }
                Ok(Fate::Open(number))
            }
        }
    }
}
