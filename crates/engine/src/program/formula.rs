//! Formulas about the future: the segments they stand in, the graph that decides them, the obligations that wait for it.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::Positions;
use super::code::{Bit, Bound};
use crate::margin::plan::Plan;

/// Properties with the same positions.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Group {
    /// Their positions and expressions.
    pub at: Positions,
    /// The segments in which formulas stand; 0 is the whole trace.
    pub contexts: Vec<Context>,
    /// The future operators; each stands on those before it.
    pub futures: Vec<Future>,
    /// Where obligations arise.
    pub trackers: Vec<Tracker>,
    /// How often scopes are entered.
    pub looks: Vec<Look>,
    /// The margins of its properties, of those that have one.
    pub margins: Vec<Plan>,
    /// Whether its positions need only be counted while none of its signals changes, until a bound runs out. [`Program::link`](super::Program::link)
    /// fills it.
    #[serde(skip)]
    pub rests: bool,
    /// Whether, else, its positions need only be counted as long as nothing changes and nothing is open.
    /// [`Program::link`](super::Program::link) fills it.
    #[serde(skip)]
    pub idles: bool,
    /// The operators whose truth values obligations, segments and looks stand on, as bits, where it rests or idles.
    /// [`Program::link`](super::Program::link) fills it.
    #[serde(skip)]
    pub heard: u64,
}

impl Group {
    /// Whether all its obligations are state formulas at positions of the whole trace, and no scope is counted.
    pub fn is_plain(&self) -> bool {
        self.futures.is_empty() && self.contexts.len() == 1 && self.looks.is_empty()
    }
}

/// The number of a context.
pub type ContextId = u32;
/// A future node, perhaps negated.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
pub struct FutureRef {
    /// Its number.
    pub id: u32,
    /// Whether its negation is meant.
    pub negated: bool,
}

/// A kind of segments, inside those of its parent.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
pub struct Context {
    /// The context around it; itself for the whole trace.
    pub parent: ContextId,
    /// How its segments lie in the parent's.
    pub kind: ContextKind,
}

/// How segments lie in those of the parent.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum ContextKind {
    /// The whole trace.
    Whole,
    /// From the first position with X on.
    After { x: Bit },
    /// Up to the first position with X; `again` where formulas are asked at later positions too: then from each X to the next.
    Until { x: Bit, again: bool },
    /// From an X to the next Y.
    AfterUntil { x: Bit, y: Bit },
    /// Every maximal run of positions with X.
    While { x: Bit },
}

/// A node of the graph of future operators: at each position of its context it becomes true or false, at once or later.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Future {
    /// The segments in which it stands.
    pub context: ContextId,
    /// What it is.
    pub kind: FutureKind,
    /// Where somebody asks for its value: at the positions where this holds; everywhere where it is none.
    /// [`Program::link`](super::Program::link) fills it.
    #[serde(skip)]
    pub asked: Option<Bit>,
}

impl Future {
    /// A node whose value is asked for everywhere.
    pub fn new(context: ContextId, kind: FutureKind) -> Future {
        Future { context, kind, asked: None }
    }
}

/// The kinds of future nodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum FutureKind {
    /// Known at once.
    State(Bit),
    And(FutureRef, FutureRef),
    Eventually(Bound, FutureRef),
    Next(FutureRef),
    /// Both operands known at once.
    Until(Bound, Bit, Bit),
    /// `after X, body`
    After {
        x: Bit,
        body: FutureRef,
        inner: ContextId,
    },
    /// `until X, body`, and `before X, body` with `weak`
    UntilScope {
        weak: bool,
        x: Bit,
        body: FutureRef,
        inner: ContextId,
    },
    /// `after_until` and `while`: the body, in every segment of the inner context, at the first X at or after the position.
    Each {
        x: Bit,
        body: FutureRef,
        inner: ContextId,
    },
    /// What is false inside segments of a `before`, told only when its X comes; where it does not, true.
    Gate {
        body: FutureRef,
        before: ContextId,
    },
    /// A formula beyond the operators above (a scope that opens or closes on a future formula, an `until` of future formulas):
    /// evaluated anew from the values of its parts whenever something is new.
    Replay(Replay),
    /// No formula: it counts how often the scopes of a property are entered, where that shows only when the trace is over.
    Survey(Survey),
}

impl FutureKind {
    /// The nodes that it stands on.
    pub fn operands(&self) -> impl Iterator<Item = FutureRef> {
        let (one, other) = match self {
            FutureKind::And(l, r) => (Some(*l), Some(*r)),
            FutureKind::Eventually(_, of) | FutureKind::Next(of) => (Some(*of), None),
            FutureKind::After { body, .. }
            | FutureKind::UntilScope { body, .. }
            | FutureKind::Each { body, .. }
            | FutureKind::Gate { body, .. } => (Some(*body), None),
            FutureKind::State(_) | FutureKind::Until(..) | FutureKind::Replay(_) | FutureKind::Survey(_) => {
                (None, None)
            }
        };
        one.into_iter().chain(other)
    }
}

/// A formula evaluated from stored values: nodes by number, each standing on those before it; the last is the formula.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Replay {
    /// The formula.
    pub terms: Vec<Term>,
    /// The state formulas in it.
    pub leaves: Vec<Bit>,
}

/// A property's formula, and which of its terms are scopes, in the order of the text. `whenever X, φ` is the `always` of `not X or φ`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Survey {
    /// The property, a number of [`Program::properties`](super::Program::properties).
    pub property: usize,
    /// The formula.
    pub formula: Replay,
    /// The terms.
    pub scopes: Vec<usize>,
}

/// A term of a [`Replay`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Term {
    Leaf(usize),
    Not(usize),
    And(usize, usize),
    Or(usize, usize),
    Iff(usize, usize),
    Always(Bound, usize),
    Eventually(Bound, usize),
    Next(usize),
    Until(Bound, usize, usize),
    After(usize, usize),
    UntilScope(usize, usize),
    Before(usize, usize),
    AfterUntil(usize, usize, usize),
    While(usize, usize),
}

/// Where obligations arise, and what decides them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tracker {
    /// The property, a number of [`Program::properties`](super::Program::properties).
    pub property: usize,
    /// The segments.
    pub context: ContextId,
    /// At which positions of a segment.
    pub at: At,
    /// The formula that must become true.
    pub formula: Judged,
    /// Whether this obligation of a property that never has a position would be missed at the end.
    pub missed_if_empty: bool,
    /// The operators that its property stands on.
    pub ops: Vec<usize>,
}

/// What an obligation asks.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub enum Judged {
    /// A state formula, decided on the spot.
    State(Bit),
    /// A future formula.
    Future(FutureRef),
}

/// At which positions of its segments a tracker has obligations.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
pub enum At {
    /// The first.
    First,
    /// All.
    All,
    /// All at this distance from the first.
    Within(Bound),
}

impl At {
    /// All within a bound, which may be none.
    pub fn within(bound: Bound) -> At {
        if bound == Bound::ALL { At::All } else { At::Within(bound) }
    }
}

/// Where a scope is looked at, and whether it was entered there: what vacuity counts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Look {
    /// The segments in which it stands.
    pub context: ContextId,
    /// The contexts of `until` and `before` in which it stands, the innermost first: what is entered inside one counts once its X has
    /// come.
    pub awaits: Vec<ContextId>,
    /// What is looked at, from the looks before.
    pub kind: LookKind,
    /// The property and the number of its scope that this counts for.
    pub counts: Option<(usize, usize)>,
}

/// The ways a position comes to be looked at.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum LookKind {
    /// Every position of a segment at this distance from its first.
    Within(Bound),
    /// The first position of each segment.
    First,
    /// A position at this distance from one that is looked at.
    From { of: u32, bound: Bound },
    /// The position after one that is looked at.
    Next { of: u32 },
    /// One that is looked at, where X holds.
    Where { of: u32, x: Bit },
    /// One that is looked at, where X does not hold.
    Unless { of: u32, x: Bit },
    /// The first with X at or after one that is looked at.
    FirstWith { of: u32, x: Bit },
    /// The positions that open segments of `after_until` at or after one that is looked at; an empty one counts.
    Opens { of: u32, x: Bit, y: Bit },
    /// The first positions of runs of X at or after one that is looked at.
    Runs { of: u32, x: Bit },
    /// As another look, of an outer context.
    Same { of: u32 },
    /// One that is looked at, once the future formula turns out to hold there. It counts, but no look can stand on it.
    Proves { of: u32, formula: FutureRef },
}
