//! Operators with a memory: lookback, windows and the past temporal operators. Each keeps constant state or a queue that every
//! position enters and leaves once, so that the cost of a step does not grow with a bound.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use lapwing_stream::Value;

use crate::inputs::Inputs;
use crate::node::{Notes, View};
use crate::program::{Bit, Bound, NodeId, Op, Positions, Window};

/// The memory of one operator.
#[derive(Clone, Debug)]
pub(crate) enum Memory {
    None,
    /// The latest values, a ring: `at` is the oldest.
    Ring {
        values: Vec<Value>,
        at: usize,
    },
    /// The value before, and its stamp.
    Before {
        value: Option<f64>,
        stamp: Option<i64>,
    },
    /// A truth value before.
    Last(bool),
    /// Stamps at which the operand held: those that have not reached the lower end of the bound, and the latest that has.
    Held {
        pending: VecDeque<i64>,
        reached: Option<i64>,
    },
    /// The latest stamp at which the operand held, [`NEVER`] for none.
    Latest(i64),
    /// The stamp at which the operand began to hold without a break, and the last at which it did not.
    Since {
        since: Option<i64>,
        broken: Option<i64>,
    },
    /// The values in a window; for a minimum or maximum only those that may still become it.
    Window(VecDeque<(i64, f64)>),
    /// The stamps in a window at which the operand held.
    Stamps(VecDeque<i64>),
}

/// Longer ago than any bound reaches, and far enough from the end of time to count from.
const NEVER: i64 = i64::MIN;

impl Memory {
    /// The memory of an operator that has seen nothing.
    pub fn new(op: &Op) -> Memory {
        match op {
            Op::Lookback(_, n) => Memory::Ring { values: alloc::vec![Value::Missing; *n], at: 0 },
            Op::Delta(_) | Op::Rate(_) => Memory::Before { value: None, stamp: None },
            Op::Previously(_) | Op::Becomes(_) => Memory::Last(false),
            Op::Once(..) | Op::Since(..) => Memory::Held { pending: VecDeque::new(), reached: None },
            Op::OnceWithin(..) | Op::SinceWithin(..) => Memory::Latest(NEVER),
            Op::Held(..) => Memory::Since { since: None, broken: None },
            Op::Window(..) => Memory::Window(VecDeque::new()),
            Op::Count(..) => Memory::Stamps(VecDeque::new()),
            Op::Slot { .. } | Op::Holds(_) | Op::And(..) | Op::Iff(..) => Memory::None,
        }
    }
}

/// The registers that the code fills: of each operator a truth value or another value.
#[derive(Clone, Debug, Default)]
pub(crate) struct Registers {
    pub bits: Vec<bool>,
    pub values: Vec<Value>,
}

impl Registers {
    pub fn new(ops: usize) -> Registers {
        Registers { bits: alloc::vec![false; ops], values: alloc::vec![Value::Missing; ops] }
    }

    #[inline]
    fn bit(&self, bit: Bit) -> bool {
        self.bits[bit.register()] != bit.is_negated()
    }
}

/// What the code sees besides its registers.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub at: &'a Positions,
    pub inputs: &'a Inputs,
    pub params: &'a [Option<Value>],
    pub now: i64,
    pub notes: &'a Notes,
    pub seen: &'a [u64],
}

impl<'a> Scene<'a> {
    pub fn view(&self, registers: &'a Registers) -> View<'a> {
        let Scene { at, inputs, params, now, notes, seen } = *self;
        View { at, inputs, bits: &registers.bits, values: &registers.values, params, now, notes, seen }
    }
}

/// Before the first instant a signal has its default: what looks back further than there are instants finds that.
pub(crate) fn prime(scene: &Scene<'_>, memories: &mut [Memory], registers: &mut Registers) {
    for (i, op) in scene.at.ops.iter().enumerate() {
        let view = scene.view(registers);
        match (op, &mut memories[i]) {
            (Op::Lookback(node, _), Memory::Ring { values, .. }) => {
                values.iter_mut().for_each(|v| view.value(*node).store(v))
            }
            (Op::Delta(node) | Op::Rate(node), Memory::Before { value, .. }) => *value = number(&view, *node),
            _ => {}
        }
        step(i, op, &mut memories[i], scene, false, registers);
        if let Memory::Before { stamp, .. } = &mut memories[i] {
            *stamp = None;
        }
    }
}

/// Runs the code at a position: every operator's register gets its value, and its memory takes the position in.
///
/// `running` is false before position 0, where the instants are looked at only so that `@`, `delta` and `rate` can look back to
/// them: the past of a property begins at its position 0, so the other operators see nothing there and remember nothing.
#[inline]
pub(crate) fn run(scene: &Scene<'_>, memories: &mut [Memory], running: bool, registers: &mut Registers) {
    for (i, (op, memory)) in scene.at.ops.iter().zip(memories).enumerate() {
        step(i, op, memory, scene, running, registers);
    }
}

// PERF: what only reads bits does so without building a view; that is nearly all of the code of a logical formula.
#[inline(always)]
fn step(i: usize, op: &Op, memory: &mut Memory, scene: &Scene<'_>, running: bool, registers: &mut Registers) {
    let now = scene.now;
    let bit = match op {
        Op::Slot { slot, truth } => match (&scene.inputs.slots[*slot], truth) {
            (Value::Bool(b), _) => *b,
            _ => scene.view(registers).slot(*slot, *truth),
        },
        Op::And(a, b) => registers.bit(*a) & registers.bit(*b),
        Op::OnceWithin(most, of) if running => {
            let Memory::Latest(latest) = memory else { return };
            if registers.bit(*of) {
                *latest = now;
            }
            *latest != NEVER && now.saturating_sub(*latest) <= *most
        }
        Op::SinceWithin(most, left, right) if running => {
            let Memory::Latest(latest) = memory else { return };
            if !registers.bit(*left) {
                *latest = NEVER;
            }
            if registers.bit(*right) {
                *latest = now;
            }
            *latest != NEVER && now.saturating_sub(*latest) <= *most
        }
        _ => return step_other(i, op, memory, scene, running, registers),
    };
    registers.bits[i] = bit;
}

/// The operators that are rarer, or cost more than the call.
fn step_other(i: usize, op: &Op, memory: &mut Memory, scene: &Scene<'_>, running: bool, registers: &mut Registers) {
    let now = scene.now;
    let bit = match (op, memory) {
        (Op::Iff(a, b), _) => registers.bit(*a) == registers.bit(*b),
        (Op::Holds(node), _) => scene.view(registers).holds(*node),
        (Op::Lookback(..) | Op::Delta(_) | Op::Rate(_) | Op::Window(..) | Op::Count(..), memory) => {
            return value(i, op, memory, scene, running, registers);
        }
        _ if !running => false,
        (Op::Previously(of), Memory::Last(last)) => core::mem::replace(last, registers.bit(*of)),
        (Op::Becomes(of), Memory::Last(last)) => {
            let holds = registers.bit(*of);
            let before = core::mem::replace(last, holds);
            holds && !before
        }
        (Op::Once(bound, of), Memory::Held { pending, reached }) => {
            once(bound, registers.bit(*of), now, pending, reached)
        }
        (Op::Since(bound, left, right), Memory::Held { pending, reached }) => {
            if !registers.bit(*left) {
                pending.clear();
                *reached = None;
            }
            once(bound, registers.bit(*right), now, pending, reached)
        }
        (Op::Held(duration, of), Memory::Since { since, broken }) => {
            let from = now.saturating_sub(duration.nanos());
            if registers.bit(*of) {
                since.get_or_insert(now);
            } else {
                (*since, *broken) = (None, Some(now));
            }
            // A position with the very stamp at which the window begins lies inside it.
            since.is_some_and(|s| s <= from) && broken.is_none_or(|b| b < from)
        }
        _ => false,
    };
    registers.bits[i] = bit;
}

/// An operator whose result is no truth value.
fn value(i: usize, op: &Op, memory: &mut Memory, scene: &Scene<'_>, running: bool, registers: &mut Registers) {
    let mut out = core::mem::take(&mut registers.values[i]);
    let view = scene.view(registers);
    match op {
        Op::Window(..) | Op::Count(..) => over_window(op, memory, &view, running, &mut out),
        _ => look_back(op, memory, &view, &mut out),
    }
    registers.values[i] = out;
}

/// A number, where there is one.
fn number(view: &View<'_>, node: NodeId) -> Option<f64> {
    view.is_there(node).then(|| view.num(node))
}

fn difference(now: Option<f64>, before: Option<f64>) -> Option<f64> {
    Some(now? - before?)
}

/// The operators that look to earlier instants, before position 0 as well.
fn look_back(op: &Op, memory: &mut Memory, view: &View<'_>, out: &mut Value) {
    match (op, memory) {
        (Op::Lookback(node, _), Memory::Ring { values, at }) => {
            if let Some(oldest) = values.get_mut(*at) {
                core::mem::swap(oldest, out);
                view.value(*node).store(oldest);
                *at = (*at + 1) % values.len();
            } else {
                view.value(*node).store(out);
            }
        }
        (Op::Delta(node), Memory::Before { value, .. }) => {
            let now = number(view, *node);
            *out = difference(now, *value).map_or(Value::Missing, Value::Num);
            *value = now;
        }
        (Op::Rate(node), Memory::Before { value, stamp }) => {
            let now = number(view, *node);
            let nanos = stamp.map_or(0, |stamp| view.now.saturating_sub(stamp));
            let rate = |difference: f64| if nanos == 0 { f64::NAN } else { difference / (nanos as f64 / 1e9) };
            *out = difference(now, *value).map_or(Value::Missing, |d| Value::Num(rate(d)));
            (*value, *stamp) = (now, Some(view.now));
        }
        _ => *out = Value::Missing,
    }
}

/// Whether the operand held at a distance within the bound; it holds now or not.
#[inline]
pub(crate) fn once(
    bound: &Bound,
    holds: bool,
    now: i64,
    pending: &mut VecDeque<i64>,
    reached: &mut Option<i64>,
) -> bool {
    if bound.begun(0) {
        if holds {
            *reached = Some(now);
        }
    } else {
        if holds {
            pending.push_back(now);
        }
        while let Some(&stamp) = pending.front() {
            if !bound.begun(now.saturating_sub(stamp)) {
                break;
            }
            *reached = Some(stamp);
            pending.pop_front();
        }
    }
    reached.is_some_and(|stamp| bound.not_over(now.saturating_sub(stamp)))
}

/// The operators over a window of positions. Before position 0 there are none.
fn over_window(op: &Op, memory: &mut Memory, view: &View<'_>, running: bool, out: &mut Value) {
    let number = match (op, memory) {
        (Op::Count(of, duration), Memory::Stamps(stamps)) => {
            let from = view.now.saturating_sub(duration.nanos());
            while stamps.front().is_some_and(|&stamp| stamp < from) {
                stamps.pop_front();
            }
            if running && view.bool(*of) {
                stamps.push_back(view.now);
            }
            stamps.len() as f64
        }
        (Op::Window(window, node, duration), Memory::Window(values)) if running => {
            let from = view.now.saturating_sub(duration.nanos());
            while values.front().is_some_and(|&(stamp, _)| stamp < from) {
                values.pop_front();
            }
            let value = view.num(*node);
            extreme_or_mean(*window, view.now, value, values)
        }
        _ => f64::NAN,
    };
    *out = Value::Num(number);
}

fn extreme_or_mean(window: Window, now: i64, value: f64, values: &mut VecDeque<(i64, f64)>) -> f64 {
    match window {
        _ if value.is_nan() => {}
        Window::Mean => values.push_back((now, value)),
        Window::Min => push_monotone(values, now, value, |old| old >= value),
        Window::Max => push_monotone(values, now, value, |old| old <= value),
    }
    match window {
        // The sum is taken anew each time, oldest first: a running sum would drift with what has left the window.
        Window::Mean if !values.is_empty() => values.iter().fold(0.0, |sum, (_, x)| sum + x) / values.len() as f64,
        Window::Mean => f64::NAN,
        Window::Min | Window::Max => values.front().map_or(f64::NAN, |v| v.1),
    }
}

/// Adds a value after dropping those that it outdoes: they cannot become the extreme again.
fn push_monotone(values: &mut VecDeque<(i64, f64)>, now: i64, value: f64, outdone: impl Fn(f64) -> bool) {
    while values.back().is_some_and(|&(_, old)| outdone(old)) {
        values.pop_back();
    }
    values.push_back((now, value));
}
