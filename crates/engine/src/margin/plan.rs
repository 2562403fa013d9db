//! What a margin is computed from: code for formulas without future operators, run at every position, and a tree for the rest,
//! evaluated once the trace is over. Plain data; numbers index the vectors beside them.

use alloc::boxed::Box;
use alloc::vec::Vec;

use lapwing_stream::Duration;
use serde::{Deserialize, Serialize};

use crate::program::{Bit, Bound, Compare, NodeId};

/// The margin of one property.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The property.
    pub property: usize,
    /// The code, in the order of evaluation: each step fills the register of its own number.
    pub ops: Vec<Op>,
    /// Registers whose least value over all positions counts: what must hold throughout needs no memory.
    pub least: Vec<Reg>,
    /// What is kept of every position.
    pub columns: Vec<Column>,
    /// The other obligations, over the columns.
    pub duties: Vec<Duty>,
}

/// The number of a register: that of the step that fills it.
pub type Reg = u32;

/// A step of the code.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Op {
    /// How far a comparison is from changing; where a side is no number, by its truth.
    Distance {
        op: Compare,
        margin: Option<NodeId>,
        left: NodeId,
        right: NodeId,
        holds: NodeId,
    },
    /// An expression that is true or false, by nothing.
    Holds(NodeId),
    Not(Reg),
    And(Reg, Reg),
    Or(Reg, Reg),
    Previously(Reg),
    Becomes(Reg),
    Once(Bound, Reg),
    /// left since right
    Since(Bound, Reg, Reg),
    Held(Duration, Reg),
    /// The margin so many instants ago.
    Lookback(Reg, usize),
}

/// What is kept of every position.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub enum Column {
    /// A margin.
    Margin(Reg),
    /// A truth value, as ±∞.
    Truth(Bit),
}

/// A formula over columns. An `x` or `y` that opens or closes segments is over truth values alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Term {
    Column(usize),
    Not(Box<Term>),
    And(Box<Term>, Box<Term>),
    Or(Box<Term>, Box<Term>),
    Iff(Box<Term>, Box<Term>),
    Next(Box<Term>),
    Eventually(Bound, Box<Term>),
    Until(Bound, Box<Term>, Box<Term>),
    After {
        x: Box<Term>,
        body: Box<Term>,
    },
    /// `comes` is X again, by its margin.
    UntilScope {
        x: Box<Term>,
        comes: Box<Term>,
        body: Box<Term>,
    },
    Before {
        x: Box<Term>,
        body: Box<Term>,
    },
    While {
        x: Box<Term>,
        body: Box<Term>,
    },
    AfterUntil {
        x: Box<Term>,
        y: Box<Term>,
        body: Box<Term>,
    },
}

/// Obligations in a segment; the margin of a property is the least of theirs. An `x` or `y` is a column of truth values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Duty {
    /// One at each position at this distance from the first.
    Each(Bound, Term),
    /// One at the first position.
    Once(Term),
    /// Those of a body from the first X on.
    After { x: usize, body: Vec<Duty> },
    /// Those of a body up to the first X; with `weak` none of them can fail unless X comes.
    UpTo { x: usize, weak: bool, body: Vec<Duty> },
    /// Those of a body in every maximal run of X.
    While { x: usize, body: Vec<Duty> },
    /// Those of a body from an X to the next Y, again and again.
    AfterUntil { x: usize, y: usize, body: Vec<Duty> },
}
