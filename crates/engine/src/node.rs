//! Expressions without a memory: evaluated from the inputs and the registers.

use core::cell::Cell;

use alloc::boxed::Box;
use lapwing_stream::{Duration, Value};
use serde::{Deserialize, Serialize};

use crate::functions::{compare, greatest, least, numeric};
use crate::inputs::Inputs;
use crate::pack::packed;
use crate::program::{Arith, Bit, Compare, Func, Node, NodeId, Positions};

/// What evaluation needs to see.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub at: &'a Positions,
    pub inputs: &'a Inputs,
    /// The truth values and other values that the code has computed so far.
    pub bits: &'a [u64],
    pub values: &'a [Value],
    /// The values of the slices of this instance; `None` stands for all values that have not been seen.
    pub params: &'a [Option<Value>],
    pub now: i64,
    pub notes: &'a Notes,
    /// For a machine: how often each slot had a value when it sampled last.
    pub seen: &'a [u64],
}

/// What evaluation remarks on the way.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Notes {
    /// How often a comparison met a NaN, by counter.
    pub nans: Box<[Cell<u64>]>,
    /// Whether one did at the latest instant.
    pub met_nan: Cell<bool>,
    /// Whether a value was of another kind than was needed.
    pub fault: Cell<bool>,
    /// The first signal of which that is known, until somebody asks.
    pub culprit: Cell<Option<usize>>,
}

packed!(Notes { nans, met_nan, fault } without { culprit });

impl Notes {
    /// Nothing to remark.
    pub fn new(counters: usize) -> Notes {
        Notes { nans: alloc::vec![Cell::new(0); counters].into(), ..Notes::default() }
    }
}

/// A value, borrowed where it is not a scalar.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Val<'a> {
    None,
    Bool(bool),
    Num(f64),
    Str(&'a str),
    Ref(&'a Value),
}

/// What an array has beyond its end, and `lookup` for a name that is not there.
const NOTHING: Val<'static> = Val::Num(f64::NAN);

impl<'a> From<&'a Value> for Val<'a> {
    fn from(value: &'a Value) -> Val<'a> {
        match value {
            Value::Missing => Val::None,
            Value::Bool(b) => Val::Bool(*b),
            Value::Num(x) => Val::Num(*x),
            Value::Str(s) => Val::Str(s),
            other => Val::Ref(other),
        }
    }
}

impl Val<'_> {
    /// Stores it in a register, in the register's own buffers.
    pub fn store(self, into: &mut Value) {
        match self {
            Val::None => *into = Value::Missing,
            Val::Bool(b) => *into = Value::Bool(b),
            Val::Num(x) => *into = Value::Num(x),
            Val::Str(s) => match into {
                Value::Str(to) => {
                    to.clear();
                    to.push_str(s);
                }
                _ => *into = Value::Str(s.into()),
            },
            Val::Ref(v) => into.clone_from(v),
        }
    }
}

/// The variables of enclosing quantifiers, the innermost first.
#[derive(Clone, Copy)]
struct Vars<'a> {
    value: Val<'a>,
    outer: Option<&'a Vars<'a>>,
}

impl<'a> View<'a> {
    /// The truth of a formula.
    #[inline]
    pub fn bool(&self, bit: Bit) -> bool {
        bit.of(self.bits)
    }

    /// The truth of an expression; what has no value is false.
    #[inline]
    pub fn holds(&self, id: NodeId) -> bool {
        self.truth(id, None)
    }

    /// The truth of a signal, a number being true, where that is asked for, when neither zero nor NaN.
    #[inline]
    pub fn slot(&self, slot: usize, truth: bool) -> bool {
        match &self.inputs.slots[slot] {
            Value::Bool(b) => *b,
            Value::Num(x) if truth => *x != 0.0 && !x.is_nan(),
            Value::Missing => false,
            _ => self.fault(Some(slot), false),
        }
    }

    /// A number; what has no value is NaN.
    #[inline]
    pub fn num(&self, id: NodeId) -> f64 {
        self.number(id, None)
    }

    /// The number that a signal has, where it is but that.
    #[inline]
    pub fn signal(&self, id: NodeId) -> Option<f64> {
        match self.node(id) {
            Node::Slot(s) if let Value::Num(x) = &self.inputs.slots[*s] => Some(*x),
            _ => None,
        }
    }

    /// A value of any kind.
    pub fn value(&self, id: NodeId) -> Val<'a> {
        self.val(id, None)
    }

    fn node(&self, id: NodeId) -> &'a Node {
        &self.at.nodes[id as usize]
    }

    #[inline]
    fn truth(&self, id: NodeId, vars: Option<&Vars<'_>>) -> bool {
        match self.node(id) {
            Node::Bit(bit) => self.bool(*bit),
            Node::Bool(b) => *b,
            Node::Not(a) => !self.truth(*a, vars),
            // Both sides are always evaluated: a NaN on the right counts even where the left decides.
            Node::And(a, b) => self.truth(*a, vars) & self.truth(*b, vars),
            Node::Or(a, b) => self.truth(*a, vars) | self.truth(*b, vars),
            Node::Iff(a, b) => self.truth(*a, vars) == self.truth(*b, vars),
            Node::Compare { op, margin, left, right, counter } => {
                let (a, b) = (self.number(*left, vars), self.number(*right, vars));
                let m = margin.map_or(0.0, |m| self.number(m, vars));
                self.count_nan(*counter, a, b);
                compare(*op, a, b, m) && (!(a.is_nan() | b.is_nan()) || (self.is_there(*left) && self.is_there(*right)))
            }
            Node::Event(e) => self.occurs(*e).is_some(),
            Node::InState { machine, .. } if self.inputs.lost.get(*machine) == Some(&true) => {
                self.fault(self.signal_in(id), false)
            }
            Node::InState { machine, state } => self.inputs.machines.get(*machine) == Some(state),
            Node::Fresh(t) => self.inputs.topics.get(*t).is_some_and(|t| t.fresh),
            Node::Updated(slots) => slots.iter().any(|&s| self.inputs.versions.get(s) > self.seen.get(s)),
            _ => match self.val(id, vars) {
                Val::Bool(b) => b,
                Val::None => false,
                _ => self.fault(self.signal_in(id), false),
            },
        }
    }

    // PERF: what most numbers are takes no call.
    #[inline(always)]
    fn number(&self, id: NodeId, vars: Option<&Vars<'_>>) -> f64 {
        match self.node(id) {
            Node::Num(x) => *x,
            Node::Slot(s) if let Value::Num(x) = &self.inputs.slots[*s] => *x,
            node => self.reckon(node, id, vars),
        }
    }

    #[inline(never)]
    fn reckon(&self, node: &Node, id: NodeId, vars: Option<&Vars<'_>>) -> f64 {
        match node {
            Node::Num(x) => *x,
            Node::Slot(s) => match &self.inputs.slots[*s] {
                Value::Num(x) => *x,
                Value::Missing => f64::NAN,
                _ => self.fault(self.signal_in(id), f64::NAN),
            },
            Node::Reg(r) if let Value::Num(x) = &self.values[*r as usize] => *x,
            Node::Call(func, args) if func.is_numeric() => self.calculate(*func, args, vars),
            Node::Neg(a) => -self.number(*a, vars),
            Node::Arith(op, a, b) => {
                let (a, b) = (self.number(*a, vars), self.number(*b, vars));
                match op {
                    Arith::Add => a + b,
                    Arith::Sub => a - b,
                    Arith::Mul => a * b,
                    Arith::Div => a / b,
                }
            }
            Node::Age(t) => match self.inputs.topics.get(*t).and_then(|t| t.last) {
                Some(last) => Duration::from_nanos(self.now.saturating_sub(last)).seconds(),
                None => f64::NAN,
            },
            Node::Frequency(t, window) => self.frequency(*t, *window),
            _ => match self.val(id, vars) {
                Val::Num(x) => x,
                Val::None => f64::NAN,
                _ => self.fault(self.signal_in(id), f64::NAN),
            },
        }
    }

    fn val<'b>(&self, id: NodeId, vars: Option<&Vars<'b>>) -> Val<'b>
    where
        'a: 'b,
    {
        match self.node(id) {
            Node::Slot(s) => self.inputs.value(*s).into(),
            Node::Reg(r) => (&self.values[*r as usize]).into(),
            Node::Str(s) => Val::Str(s),
            Node::EventField { event, field } => {
                self.occurs(*event).and_then(|fields| fields.get(*field)).map_or(Val::None, Val::from)
            }
            Node::Param(slice) => match self.params.get(*slice) {
                Some(Some(value)) => value.into(),
                _ => Val::None,
            },
            Node::Var(depth) => nth_var(vars, *depth),
            Node::Field(of, name) => match self.val(*of, vars) {
                Val::Ref(v) => v.field(name).map_or(NOTHING, Val::from),
                Val::None => Val::None,
                _ => self.fault(self.signal_in(*of), Val::None),
            },
            Node::Index(of, i) => match self.val(*of, vars) {
                Val::Ref(array) => element(array, *i),
                Val::None => Val::None,
                _ => self.fault(self.signal_in(*of), Val::None),
            },
            Node::Truth(of) => match self.val(*of, vars) {
                Val::Num(x) => Val::Bool(x != 0.0 && !x.is_nan()),
                Val::Bool(b) => Val::Bool(b),
                Val::None => Val::Bool(false),
                _ => self.fault(self.signal_in(*of), Val::Bool(false)),
            },
            Node::CompareAny { op, margin, left, right, counter } => {
                let (a, b) = (self.val(*left, vars), self.val(*right, vars));
                let m = margin.map_or(0.0, |m| self.number(m, vars));
                Val::Bool(self.compare_any(id, *op, (a, b), m, *counter))
            }
            Node::Call(func, args) => self.call(id, *func, args, vars),
            Node::Any { array, body } => Val::Bool(self.any(*array, *body, vars)),
            Node::Num(_) | Node::Neg(_) | Node::Arith(..) | Node::Age(_) | Node::Frequency(..) => {
                Val::Num(self.number(id, vars))
            }
            Node::Bit(_)
            | Node::Bool(_)
            | Node::Not(_)
            | Node::And(..)
            | Node::Or(..)
            | Node::Iff(..)
            | Node::Compare { .. } => Val::Bool(self.truth(id, vars)),
            Node::Event(_) | Node::InState { .. } | Node::Fresh(_) | Node::Updated(_) => {
                Val::Bool(self.truth(id, vars))
            }
        }
    }

    /// Whether an expression has a value at all, be it NaN: what reads a field of an event that does not occur has none.
    pub fn is_there(&self, id: NodeId) -> bool {
        match self.node(id) {
            Node::Slot(_) | Node::Reg(_) | Node::EventField { .. } | Node::Param(_) => {
                !matches!(self.val(id, None), Val::None)
            }
            Node::Neg(of) | Node::Field(of, _) | Node::Index(of, _) => self.is_there(*of),
            Node::Arith(_, a, b) => self.is_there(*a) && self.is_there(*b),
            Node::Call(_, args) => args.iter().all(|&a| self.is_there(a)),
            _ => true,
        }
    }

    /// The same as [`View::occurrence`], where it can be told.
    pub fn occurs(&self, event: usize) -> Option<&'a [Value]> {
        match self.inputs.events.get(event) {
            Some(state) if state.is_unclear => self.fault(None, None),
            _ => self.occurrence(event),
        }
    }

    /// The last occurrence of an event at this instant that this instance sees.
    pub fn occurrence(&self, event: usize) -> Option<&'a [Value]> {
        let state = self.inputs.events.get(event)?;
        if self.params.is_empty() {
            return state.iter().next_back();
        }
        state.iter().rev().find(|fields| self.sees(event, fields))
    }

    /// Whether no slice hides this occurrence from this instance.
    fn sees(&self, event: usize, fields: &[Value]) -> bool {
        self.at.slices.iter().zip(self.params).all(|(slice, param)| {
            let hidden_by = slice.hides.iter().filter(|(e, _)| *e == event).filter_map(|(_, f)| fields.get(*f));
            hidden_by.filter(|v| **v != Value::Missing).all(|v| param.as_ref() == Some(v))
        })
    }

    fn frequency(&self, topic: usize, window: Duration) -> f64 {
        let Some(state) = self.inputs.topics.get(topic) else { return f64::NAN };
        let from = state.stamps.partition_point(|&t| t <= self.now.saturating_sub(window.nanos()));
        (state.stamps.len() - from) as f64 / window.seconds()
    }

    #[inline]
    fn count_nan(&self, counter: u32, a: f64, b: f64) {
        if a.is_nan() | b.is_nan()
            && let Some(count) = self.notes.nans.get(counter as usize)
        {
            count.set(count.get() + 1);
            self.notes.met_nan.set(true);
        }
    }

    fn compare_any(&self, id: NodeId, op: Compare, (a, b): (Val<'_>, Val<'_>), margin: f64, counter: u32) -> bool {
        let same = match (a, b) {
            (Val::Num(a), Val::Num(b)) => {
                self.count_nan(counter, a, b);
                return compare(op, a, b, margin);
            }
            (Val::Str(a), Val::Str(b)) => a == b,
            (Val::Bool(a), Val::Bool(b)) => a == b,
            (Val::None, _) | (_, Val::None) => return false,
            (Val::Num(x), Val::Str(_)) | (Val::Str(_), Val::Num(x)) if x.is_nan() => false,
            _ => return self.fault(self.signal_in(id), false),
        };
        match op {
            Compare::Eq => same,
            Compare::Ne => !same,
            _ => self.fault(self.signal_in(id), false),
        }
    }

    fn call<'b>(&self, id: NodeId, func: Func, args: &[NodeId], vars: Option<&Vars<'b>>) -> Val<'b>
    where
        'a: 'b,
    {
        let arg = |i: usize| args.get(i).map_or(Val::None, |&a| self.val(a, vars));
        match func {
            Func::IsNan => Val::Bool(args.first().is_none_or(|&a| self.number(a, vars).is_nan())),
            Func::Len => match arg(0) {
                Val::Str(s) => Val::Num(s.chars().count() as f64),
                Val::Ref(Value::Nums(v)) => Val::Num(v.len() as f64),
                Val::Ref(Value::List(v)) => Val::Num(v.len() as f64),
                Val::None => Val::Num(f64::NAN),
                _ => self.fault(self.signal_in(id), Val::Num(f64::NAN)),
            },
            Func::MinOf => Val::Num(self.fold(id, arg(0), |v| least(v.iter().copied()))),
            Func::MaxOf => Val::Num(self.fold(id, arg(0), |v| greatest(v.iter().copied()))),
            Func::Lookup => lookup(arg(0), arg(1), arg(2)).unwrap_or_else(|| self.fault(self.signal_in(id), Val::None)),
            Func::StartsWith => self.text(id, arg(0), arg(1), |a, b| a.starts_with(b)),
            Func::EndsWith => self.text(id, arg(0), arg(1), |a, b| a.ends_with(b)),
            Func::Contains => self.text(id, arg(0), arg(1), |a, b| a.contains(b)),
            _ => Val::Num(self.calculate(func, args, vars)),
        }
    }

    /// A function of numbers alone.
    fn calculate(&self, func: Func, args: &[NodeId], vars: Option<&Vars<'_>>) -> f64 {
        // The longest argument list of a numeric function is that of two quaternions; `min` and `max` may be longer.
        let mut few = [f64::NAN; 8];
        match args {
            [a] => numeric(func, &[self.number(*a, vars)]),
            _ if args.len() <= few.len() => {
                few.iter_mut().zip(args).for_each(|(x, &a)| *x = self.number(a, vars));
                numeric(func, &few[..args.len()])
            }
            _ => {
                let each = args.iter().map(|&a| self.number(a, vars));
                if func == Func::Min { least(each) } else { greatest(each) }
            }
        }
    }

    fn fold(&self, id: NodeId, array: Val<'_>, of: impl Fn(&[f64]) -> f64) -> f64 {
        match array {
            Val::Ref(Value::Nums(v)) => of(v),
            Val::Ref(Value::List(v)) if v.is_empty() => f64::NAN,
            Val::None => f64::NAN,
            _ => self.fault(self.signal_in(id), f64::NAN),
        }
    }

    fn text<'b>(&self, id: NodeId, a: Val<'_>, b: Val<'_>, of: impl Fn(&str, &str) -> bool) -> Val<'b> {
        match (a, b) {
            (Val::Str(a), Val::Str(b)) => Val::Bool(of(a, b)),
            (Val::None, _) | (_, Val::None) => Val::Bool(false),
            _ => self.fault(self.signal_in(id), Val::Bool(false)),
        }
    }

    /// Whether the body holds for an element; numbers that are NaN are none.
    fn any(&self, array: NodeId, body: NodeId, vars: Option<&Vars<'_>>) -> bool {
        let holds = |value: Val<'_>| self.truth(body, Some(&Vars { value, outer: vars.map(|v| v as _) }));
        match self.val(array, vars) {
            Val::Ref(Value::Nums(v)) => v.iter().any(|&x| !x.is_nan() && holds(Val::Num(x))),
            Val::Ref(Value::List(v)) => v.iter().any(|v| holds(v.into())),
            Val::None => false,
            _ => self.fault(self.signal_in(array), false),
        }
    }

    #[cold]
    fn fault<T>(&self, signal: Option<usize>, instead: T) -> T {
        self.notes.fault.set(true);
        self.notes.culprit.set(self.notes.culprit.get().or(signal));
        instead
    }

    /// The first signal that an expression reads.
    fn signal_in(&self, id: NodeId) -> Option<usize> {
        match self.node(id) {
            Node::Slot(slot) => Some(*slot),
            Node::Not(of) | Node::Neg(of) | Node::Truth(of) | Node::Field(of, _) | Node::Index(of, _) => {
                self.signal_in(*of)
            }
            Node::And(a, b) | Node::Or(a, b) | Node::Iff(a, b) | Node::Arith(_, a, b) => {
                self.signal_in(*a).or_else(|| self.signal_in(*b))
            }
            Node::Compare { left, right, .. } | Node::CompareAny { left, right, .. } => {
                self.signal_in(*left).or_else(|| self.signal_in(*right))
            }
            Node::Call(_, args) => args.iter().find_map(|&arg| self.signal_in(arg)),
            Node::Any { array, .. } => self.signal_in(*array),
            _ => None,
        }
    }
}

fn nth_var<'b>(vars: Option<&Vars<'b>>, depth: usize) -> Val<'b> {
    let mut at = vars;
    for _ in 0..depth {
        at = at.and_then(|v| v.outer);
    }
    at.map_or(Val::None, |v| v.value)
}

fn element(array: &Value, i: usize) -> Val<'_> {
    match array {
        Value::Nums(v) => v.get(i).map_or(NOTHING, |&x| Val::Num(x)),
        Value::List(v) => v.get(i).map_or(NOTHING, Val::from),
        _ => NOTHING,
    }
}

/// The value beside a name in parallel arrays; `None` where the arguments are of the wrong kinds.
fn lookup<'b>(names: Val<'b>, values: Val<'b>, name: Val<'_>) -> Option<Val<'b>> {
    match (names, values, name) {
        (Val::None, ..) | (_, Val::None, _) | (.., Val::None) => Some(Val::None),
        (Val::Ref(Value::List(names)), Val::Ref(values), Val::Str(name)) => {
            let i = names.iter().position(|n| matches!(n, Value::Str(s) if s == name));
            Some(i.map_or(NOTHING, |i| element(values, i)))
        }
        (Val::Ref(Value::Nums(names)), ..) if names.is_empty() => Some(NOTHING),
        _ => None,
    }
}
