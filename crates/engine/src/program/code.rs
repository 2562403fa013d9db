//! The code that runs at every position: operators over registers, and the expressions inside them.

use alloc::string::String;
use alloc::vec::Vec;

use lapwing_stream::Duration;
use serde::{Deserialize, Serialize};

/// The number of a node.
pub type NodeId = u32;
/// The number of a register: that of the operator that fills it.
pub type RegId = u32;

/// The truth value in a register, or its negation.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug, Serialize, Deserialize)]
pub struct Bit(u32);

impl Bit {
    /// The truth value in a register.
    pub fn new(register: RegId) -> Bit {
        Bit(register << 1)
    }

    /// The register.
    #[inline]
    pub fn register(self) -> usize {
        (self.0 >> 1) as usize
    }

    /// Whether the negation is meant.
    #[inline]
    pub fn is_negated(self) -> bool {
        self.0 & 1 == 1
    }

    /// The truth value, from those of all registers, sixty-four a word.
    #[inline]
    pub(crate) fn of(self, words: &[u64]) -> bool {
        self.in_word(words[self.register() >> 6])
    }

    /// The truth value, from the word that its register is in.
    #[inline]
    pub(crate) fn in_word(self, word: u64) -> bool {
        (word.wrapping_shr(self.0 >> 1) ^ u64::from(self.0)) & 1 == 1
    }
}

impl core::ops::Not for Bit {
    type Output = Bit;
    fn not(self) -> Bit {
        Bit(self.0 ^ 1)
    }
}

/// An expression without memory of its own. What it stands on has a smaller number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Node {
    Num(f64),
    Bool(bool),
    Str(String),
    /// The latest value of a signal.
    Slot(usize),
    /// The value that an operator computed.
    Reg(RegId),
    /// The truth value of a formula.
    Bit(Bit),
    /// Whether an event occurs at this instant.
    Event(usize),
    /// A field of it.
    EventField {
        event: usize,
        field: usize,
    },
    /// Whether a machine stands in a state (`None`: undefined).
    InState {
        machine: usize,
        state: Option<usize>,
    },
    /// Whether one of the slots got a value since the machine sampled last.
    Updated(Vec<usize>),
    /// The value of a slice.
    Param(usize),
    /// The variable of the so-many-th enclosing quantifier.
    Var(usize),
    Field(NodeId, String),
    Index(NodeId, usize),
    /// A number as a condition: neither zero nor NaN.
    Truth(NodeId),
    Neg(NodeId),
    Arith(Arith, NodeId, NodeId),
    /// Of numbers; `counter` counts those that met a NaN.
    Compare {
        op: Compare,
        margin: Option<NodeId>,
        left: NodeId,
        right: NodeId,
        counter: u32,
    },
    /// Of values whose kind only shows at run time, and of texts and booleans.
    CompareAny {
        op: Compare,
        margin: Option<NodeId>,
        left: NodeId,
        right: NodeId,
        counter: u32,
    },
    Not(NodeId),
    And(NodeId, NodeId),
    Or(NodeId, NodeId),
    Iff(NodeId, NodeId),
    Call(Func, Vec<NodeId>),
    Any {
        array: NodeId,
        body: NodeId,
    },
    Age(usize),
    Frequency(usize, Duration),
    Fresh(usize),
}

/// Arithmetic.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Arith {
    Add,
    Sub,
    Mul,
    Div,
}

/// Comparisons.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Compare {
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
}

/// Functions of values; what each computes stands beside it in `functions`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Func {
    Abs,
    Sign,
    Min,
    Max,
    Sqrt,
    Sin,
    Cos,
    Atan2,
    Norm,
    Roll,
    Pitch,
    Yaw,
    AngleDiff,
    AngleBetween,
    IntoBody,
    Deg,
    Rad,
    IsNan,
    Len,
    MinOf,
    MaxOf,
    Lookup,
    StartsWith,
    EndsWith,
    Contains,
}

impl Func {
    /// Whether it makes a number of numbers alone.
    pub fn is_numeric(self) -> bool {
        use Func::*;
        !matches!(self, IsNan | Len | MinOf | MaxOf | Lookup | StartsWith | EndsWith | Contains)
    }
}

/// A time bound: positions at a distance from `lo` to `hi`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Bound {
    pub lo: i64,
    pub lo_closed: bool,
    /// `i64::MAX` for none.
    pub hi: i64,
    pub hi_closed: bool,
}

impl Bound {
    /// No bound.
    pub const ALL: Bound = Bound { lo: 0, lo_closed: true, hi: i64::MAX, hi_closed: true };

    /// Whether there is an upper end.
    pub fn has_end(&self) -> bool {
        self.hi != i64::MAX
    }

    /// For a bound that begins at no distance: the greatest distance within, in whole nanoseconds.
    pub fn from_here(&self) -> Option<i64> {
        let begins_here = self.lo == 0 && self.lo_closed;
        let greatest = if self.hi_closed { Some(self.hi) } else { self.hi.checked_sub(1).filter(|&hi| hi >= 0) };
        if begins_here { greatest } else { None }
    }

    /// Whether a distance has reached the lower end.
    #[inline]
    pub fn begun(&self, distance: i64) -> bool {
        distance > self.lo || (self.lo_closed && distance == self.lo)
    }

    /// Whether a distance has not passed the upper end.
    #[inline]
    pub fn not_over(&self, distance: i64) -> bool {
        distance < self.hi || (self.hi_closed && distance == self.hi)
    }

    /// Whether a distance lies within.
    #[inline]
    pub fn contains(&self, distance: i64) -> bool {
        self.begun(distance) && self.not_over(distance)
    }
}

/// A step of the code that runs at every position: it fills the register of its own number from those before.
///
/// Formulas are flat code over truth values, so that each is computed once however many properties share it; only what stands inside
/// a comparison or a function is a tree of [`Node`]s.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Op {
    /// The truth of a signal: a boolean, or (`truth`) a number that is neither zero nor NaN.
    Slot {
        slot: usize,
        truth: bool,
    },
    /// Whether an event occurs at this instant.
    Event(usize),
    /// The truth of an expression.
    Holds(NodeId),
    And(Bit, Bit),
    Iff(Bit, Bit),
    Previously(Bit),
    Becomes(Bit),
    Once(Bound, Bit),
    /// left since right
    Since(Bound, Bit, Bit),
    /// `once` whose bound begins where it stands: at most so many nanoseconds ago.
    OnceWithin(i64, Bit),
    /// `left since right` whose bound begins where it stands.
    SinceWithin(i64, Bit, Bit),
    Held(Duration, Bit),
    /// At how many positions of the window it held.
    Count(Bit, Duration),
    /// The expression's value so many instants ago.
    Lookback(NodeId, usize),
    /// The expression minus its value an instant ago.
    Delta(NodeId),
    /// That, over the seconds since then.
    Rate(NodeId),
    Window(Window, NodeId, Duration),
}

/// Windows over the past.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Window {
    Min,
    Max,
    Mean,
}
