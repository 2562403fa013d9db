//! Operators with a memory: lookback, windows and the past temporal operators. Each keeps constant state or a queue that every
//! position enters and leaves once, so that the cost of a step does not grow with a bound.

use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::vec::Vec;

use lapwing_stream::Value;
use serde::{Deserialize, Serialize};

use crate::inputs::Inputs;
use crate::latest::Latest;
use crate::node::{Notes, View};
use crate::pack::{Pack, Packer, Unpacker, packed};
use crate::program::{Bit, Bound, NodeId, Op, Positions, Window};

/// The memory of one operator.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum Memory {
    None,
    /// The latest values, a ring: `at` is the oldest. So many of the latest positions had the same value as the one before.
    Ring {
        values: Vec<Value>,
        at: usize,
        settled: usize,
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

/// When an operator is due again that is due at the very next position. [`i64::MAX`] stands for an operator that only its operands make
/// due.
pub(crate) const NOW: i64 = i64::MIN;

impl Memory {
    /// The memory of an operator that has seen nothing.
    pub fn new(op: &Op) -> Memory {
        match op {
            Op::Lookback(_, n) => Memory::Ring { values: alloc::vec![Value::Missing; *n], at: 0, settled: 0 },
            Op::Delta(_) | Op::Rate(_) => Memory::Before { value: None, stamp: None },
            Op::Previously(_) | Op::Becomes(_) => Memory::Last(false),
            Op::Once(..) | Op::Since(..) => Memory::Held { pending: VecDeque::new(), reached: None },
            Op::Held(..) => Memory::Since { since: None, broken: None },
            Op::Window(..) => Memory::Window(VecDeque::new()),
            Op::Count(..) => Memory::Stamps(VecDeque::new()),
            // Those whose bounds begin where they stand have theirs in `Latest`.
            Op::OnceWithin(..) | Op::SinceWithin(..) => Memory::None,
            Op::Slot { .. } | Op::Event(_) | Op::Holds(_) | Op::And(..) | Op::Iff(..) => Memory::None,
        }
    }
}

/// What it is of, the program says.
impl Pack for Memory {
    fn pack(&self, to: &mut Packer) {
        match self {
            Memory::None => {}
            Memory::Ring { values, at, settled } => {
                values.pack(to);
                at.pack(to);
                settled.pack(to);
            }
            Memory::Before { value, stamp } => {
                value.pack(to);
                stamp.pack(to);
            }
            Memory::Last(last) => last.pack(to),
            Memory::Held { pending, reached } => {
                pending.pack(to);
                reached.pack(to);
            }
            Memory::Since { since, broken } => {
                since.pack(to);
                broken.pack(to);
            }
            Memory::Window(values) => values.pack(to),
            Memory::Stamps(stamps) => stamps.pack(to),
        }
    }

    fn unpack(&mut self, from: &mut Unpacker<'_>) {
        match self {
            Memory::None => {}
            Memory::Ring { values, at, settled } => {
                values.unpack(from);
                at.unpack(from);
                settled.unpack(from);
            }
            Memory::Before { value, stamp } => {
                value.unpack(from);
                stamp.unpack(from);
            }
            Memory::Last(last) => last.unpack(from),
            Memory::Held { pending, reached } => {
                pending.unpack(from);
                reached.unpack(from);
            }
            Memory::Since { since, broken } => {
                since.unpack(from);
                broken.unpack(from);
            }
            Memory::Window(values) => values.unpack(from),
            Memory::Stamps(stamps) => stamps.unpack(from),
        }
    }
}

/// What came of an operator at a position.
pub(crate) struct Stepped {
    /// Its truth value.
    pub holds: bool,
    /// When it is due although no operand changes: see [`NOW`].
    pub next: i64,
    /// Whether its result is no truth value, and may be another than before.
    pub has_moved: bool,
}

impl Stepped {
    pub fn truth((holds, next): (bool, i64)) -> Stepped {
        Stepped { holds, next, has_moved: false }
    }
}

/// The registers that the code fills: of each operator a truth value, sixty-four a word, or another value.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Registers {
    pub bits: Box<[u64]>,
    pub values: Box<[Value]>,
}

packed!(Registers { bits, values });

impl Registers {
    pub fn new(ops: usize) -> Registers {
        Registers {
            bits: alloc::vec![0; ops.div_ceil(64).max(1)].into(),
            values: alloc::vec![Value::Missing; ops].into(),
        }
    }

    #[inline]
    pub fn bit(&self, bit: Bit) -> bool {
        bit.of(&self.bits)
    }
}

/// An instant as the code of some positions sees it.
#[derive(Clone, Copy)]
pub(crate) struct Here<'a> {
    pub at: &'a Positions,
    pub inputs: &'a Inputs,
    pub now: i64,
    /// The values of the slices of this instance.
    pub params: &'a [Option<Value>],
    /// For a machine: how often each slot had a value when it sampled last.
    pub seen: &'a [u64],
}

impl Here<'_> {
    /// Whether an event occurs, where that is known and no slice hides an occurrence.
    #[inline]
    pub fn occurs(&self, event: usize) -> Option<bool> {
        let state = &self.inputs.events[event];
        (!state.is_unclear && self.at.slices.is_empty()).then_some(state.count > 0)
    }
}

/// What an operator sees besides the registers.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub here: Here<'a>,
    /// The stamp of the position before.
    pub before: Option<i64>,
    pub notes: &'a Notes,
}

impl<'a> Scene<'a> {
    /// When the `i`-th operator is due because an age in it passes a limit.
    #[inline]
    fn next_flip(&self, i: usize) -> i64 {
        let is_aged = self.here.at.wiring.as_ref().is_some_and(|wiring| wiring.aged.wrapping_shr(i as u32) & 1 == 1);
        if is_aged { self.next_age() } else { i64::MAX }
    }

    /// When an age passes a limit.
    fn next_age(&self) -> i64 {
        let Here { at, inputs, now, .. } = self.here;
        let flips = at.ages.iter().filter_map(|age| {
            let last = inputs.topics.get(age.topic)?.last?;
            age.after.iter().map(|after| last.saturating_add(after.nanos())).find(|flip| *flip > now)
        });
        flips.min().unwrap_or(i64::MAX)
    }

    #[inline]
    pub fn view<'b>(&self, bits: &'b [u64], values: &'b [Value]) -> View<'b>
    where
        'a: 'b,
    {
        let Here { at, inputs, params, now, seen } = self.here;
        View { at, inputs, bits, values, params, now, notes: self.notes, seen }
    }
}

/// Before the first instant a signal has its default: what looks back further than there are instants finds that.
pub(crate) fn prime(scene: &Scene<'_>, memories: &mut [Memory], registers: &mut Registers) {
    let Registers { bits, values } = registers;
    for (i, (op, memory)) in scene.here.at.ops.iter().zip(memories).enumerate() {
        let view = scene.view(bits, values);
        match (op, &mut *memory) {
            (Op::Lookback(node, _), Memory::Ring { values, .. }) => {
                values.iter_mut().for_each(|v| view.value(*node).store(v))
            }
            (Op::Delta(node) | Op::Rate(node), Memory::Before { value, .. }) => *value = number(&view, *node),
            _ => {}
        }
        let bit = look_at(i, op, memory, scene, bits, values);
        set(bits, i, bit);
        if let Memory::Before { stamp, .. } = memory {
            *stamp = None;
        }
    }
}

/// Runs the code at an instant before position 0, at which it looks only so that `@`, `delta` and `rate` can look back to it: the past of
/// a property begins at its position 0, so the other operators see nothing there and remember nothing.
pub(crate) fn look(scene: &Scene<'_>, memories: &mut [Memory], registers: &mut Registers) {
    let Registers { bits, values } = registers;
    for (i, (op, memory)) in scene.here.at.ops.iter().zip(memories).enumerate() {
        let bit = look_at(i, op, memory, scene, bits, values);
        set(bits, i, bit);
    }
}

fn look_at(i: usize, op: &Op, memory: &mut Memory, scene: &Scene<'_>, bits: &[u64], values: &mut [Value]) -> bool {
    match op {
        Op::Slot { .. } | Op::Event(_) | Op::Holds(_) | Op::And(..) | Op::Iff(..) => now(op, scene, bits, values),
        Op::Lookback(..) | Op::Delta(_) | Op::Rate(_) | Op::Window(..) | Op::Count(..) => {
            value(i, op, memory, scene, false, bits, values);
            false
        }
        _ => false,
    }
}

/// Sets a truth value.
#[inline]
pub(crate) fn set(bits: &mut [u64], i: usize, bit: bool) {
    let word = &mut bits[i >> 6];
    *word = (*word & !(1 << (i & 63))) | (u64::from(bit) << (i & 63));
}

/// Evaluates one of the operators that are nearly all of the code of a logical formula, from the signals and from truth values. Brings
/// `alarm` forward to when a bound of it runs out. Others are left to [`step`].
// PERF: without a scene, which would have to be put together for each.
#[inline]
pub(crate) fn quick(
    (i, op): (usize, &Op),
    latest: &mut Latest,
    here: &Here<'_>,
    before: Option<i64>,
    alarm: &mut i64,
    get: impl Fn(Bit) -> bool,
) -> Option<bool> {
    let times = (here.now, before);
    match op {
        Op::Slot { slot, .. } if let Value::Bool(is) = here.inputs.slots[*slot] => Some(is),
        Op::Event(event) => here.occurs(*event),
        Op::And(a, b) => Some(get(*a) & get(*b)),
        Op::OnceWithin(most, of) => Some(latest.note(i, get(*of), times, *most, alarm)),
        Op::SinceWithin(most, left, right) => {
            if !get(*left) {
                latest.forget(i);
            }
            Some(latest.note(i, get(*right), times, *most, alarm))
        }
        _ => None,
    }
}

/// The operators without a memory.
fn now(op: &Op, scene: &Scene<'_>, bits: &[u64], values: &[Value]) -> bool {
    match op {
        Op::Slot { slot, truth } => scene.view(bits, values).slot(*slot, *truth),
        Op::Event(event) => scene.view(bits, values).occurs(*event).is_some(),
        Op::Holds(node) => scene.view(bits, values).holds(*node),
        Op::And(a, b) => a.of(bits) & b.of(bits),
        Op::Iff(a, b) => a.of(bits) == b.of(bits),
        _ => false,
    }
}

/// Evaluates the `i`-th operator at a position. Its memory takes in the position, and those since it was evaluated last, at which its
/// operands were as they were then.
pub(crate) fn step(
    i: usize,
    (memory, latest): (&mut Memory, &mut Latest),
    scene: &Scene<'_>,
    bits: &[u64],
    values: &mut [Value],
) -> Stepped {
    let op = &scene.here.at.ops[i];
    let mut alarm = i64::MAX;
    if let Some(known) = quick((i, op), latest, &scene.here, scene.before, &mut alarm, |of| of.of(bits)) {
        return Stepped::truth((known, alarm));
    }
    let known = delayed(op, memory, scene.here.now, |of| of.of(bits));
    known.unwrap_or_else(|| slow((i, op), memory, scene, bits, values))
}

/// Evaluates `once` and `since` with any bound; returns what [`step`] does.
#[inline]
pub(crate) fn delayed(op: &Op, memory: &mut Memory, now: i64, get: impl Fn(Bit) -> bool) -> Option<Stepped> {
    let stepped = match (op, memory) {
        (Op::Once(bound, of), Memory::Held { pending, reached }) => within(bound, get(*of), now, pending, reached),
        (Op::Since(bound, left, right), Memory::Held { pending, reached }) => {
            if !get(*left) {
                pending.clear();
                *reached = None;
            }
            within(bound, get(*right), now, pending, reached)
        }
        _ => return None,
    };
    Some(Stepped::truth(stepped))
}

/// Evaluates an operator that is neither [`quick`] nor [`delayed`]; returns what [`step`] does.
#[inline]
pub(crate) fn slow(
    (i, op): (usize, &Op),
    memory: &mut Memory,
    scene: &Scene<'_>,
    bits: &[u64],
    values: &mut [Value],
) -> Stepped {
    Stepped::truth(match (op, memory) {
        (Op::Holds(node), _) => expression((i, *node), scene, bits, values),
        (Op::Lookback(..) | Op::Delta(_) | Op::Rate(_) | Op::Window(..) | Op::Count(..), memory) => {
            let before = scalar(&values[i]);
            let has_settled = value(i, op, memory, scene, true, bits, values);
            let has_moved = before.is_none() || before != scalar(&values[i]);
            return Stepped { holds: false, next: if has_settled { scene.next_flip(i) } else { NOW }, has_moved };
        }
        (Op::Previously(of), Memory::Last(last)) => {
            let holds = of.of(bits);
            let before = core::mem::replace(last, holds);
            (before, if before == holds { i64::MAX } else { NOW })
        }
        (Op::Becomes(of), Memory::Last(last)) => {
            let holds = of.of(bits);
            let becomes = holds && !core::mem::replace(last, holds);
            *last = holds;
            (becomes, if becomes { NOW } else { i64::MAX })
        }
        (Op::Held(duration, of), Memory::Since { since, broken }) => {
            if of.of(bits) {
                held(duration.nanos(), scene, since, broken)
            } else {
                *since = None;
                (false, i64::MAX)
            }
        }
        (op, _) => (now(op, scene, bits, values), i64::MAX),
    })
}

/// Evaluates an expression that has no memory.
#[inline]
pub(crate) fn expression((i, node): (usize, NodeId), scene: &Scene<'_>, bits: &[u64], values: &[Value]) -> (bool, i64) {
    scene.notes.met_nan.set(false);
    let holds = scene.view(bits, values).holds(node);
    // Every NaN that a comparison meets is counted, at each position.
    (holds, if scene.notes.met_nan.get() { NOW } else { scene.next_flip(i) })
}

/// `once` with any bound. While the operand holds, each position adds a stamp.
fn within(bound: &Bound, holds: bool, now: i64, pending: &mut VecDeque<i64>, reached: &mut Option<i64>) -> (bool, i64) {
    let is = once(bound, holds, now, pending, reached);
    if holds {
        return (is, NOW);
    }
    let mut next = i64::MAX;
    if let Some(stamp) = pending.front() {
        next = stamp.saturating_add(bound.lo).saturating_add(i64::from(!bound.lo_closed));
    }
    if let Some(stamp) = reached
        && is
        && bound.has_end()
    {
        next = next.min(stamp.saturating_add(bound.hi).saturating_add(i64::from(bound.hi_closed)));
    }
    (is, next)
}

/// `held for`, where the operand holds: for long enough, and before that not broken inside the window.
fn held(duration: i64, scene: &Scene<'_>, since: &mut Option<i64>, broken: &mut Option<i64>) -> (bool, i64) {
    let since = *since.get_or_insert_with(|| {
        // It did not hold at the position before, if there was one.
        *broken = scene.before;
        scene.here.now
    });
    // A position with the very stamp at which the window begins lies inside it.
    let unbroken = broken.map_or(i64::MIN, |stamp| stamp.saturating_add(1));
    let from = since.max(unbroken).saturating_add(duration);
    if scene.here.now >= from { (true, i64::MAX) } else { (false, from) }
}

/// An operator whose result is no truth value. Returns whether it stays what it is as long as what it looks back at does.
fn value(
    i: usize,
    op: &Op,
    memory: &mut Memory,
    scene: &Scene<'_>,
    running: bool,
    bits: &[u64],
    values: &mut [Value],
) -> bool {
    let mut out = core::mem::take(&mut values[i]);
    let view = scene.view(bits, values);
    let has_settled = match op {
        Op::Window(..) | Op::Count(..) => {
            over_window(op, memory, &view, running, &mut out);
            false
        }
        _ => look_back(op, memory, &view, &mut out),
    };
    values[i] = out;
    has_settled
}

/// What tells scalars apart, to the bit: their kind, and what they are. Other values are not looked into.
fn scalar(value: &Value) -> Option<(u8, u64)> {
    match value {
        Value::Missing => Some((0, 0)),
        Value::Bool(is) => Some((1, u64::from(*is))),
        Value::Num(x) => Some((2, x.to_bits())),
        _ => None,
    }
}

/// A number, where there is one.
#[inline]
fn number(view: &View<'_>, node: NodeId) -> Option<f64> {
    view.signal(node).or_else(|| view.is_there(node).then(|| view.num(node)))
}

/// Stores a number, most likely in the place of one.
#[inline]
fn put(into: &mut Value, number: Option<f64>) {
    match (into, number) {
        (Value::Num(there), Some(x)) => *there = x,
        (into, number) => *into = number.map_or(Value::Missing, Value::Num),
    }
}

fn difference(now: Option<f64>, before: Option<f64>) -> Option<f64> {
    Some(now? - before?)
}

/// The operators that look to earlier instants, before position 0 as well. Returns whether the result stays as long as the operand does.
fn look_back(op: &Op, memory: &mut Memory, view: &View<'_>, out: &mut Value) -> bool {
    match (op, memory) {
        (Op::Lookback(node, _), Memory::Ring { values, at, settled }) => {
            let depth = values.len();
            let newest = (*at + depth).checked_sub(1).and_then(|newest| values.get(newest % depth.max(1)));
            let before = newest.and_then(scalar);
            if let Some(oldest) = values.get_mut(*at) {
                core::mem::swap(oldest, out);
                view.value(*node).store(oldest);
                let is_same = before.is_some() && before == scalar(oldest);
                *settled = if is_same { settled.saturating_add(1) } else { 0 };
                *at = (*at + 1) % depth;
            } else {
                view.value(*node).store(out);
            }
            *settled >= depth
        }
        (Op::Delta(node), Memory::Before { value, .. }) => {
            let now = number(view, *node);
            put(out, difference(now, *value));
            let before = core::mem::replace(value, now);
            before.map(f64::to_bits) == now.map(f64::to_bits)
        }
        (Op::Rate(node), Memory::Before { value, stamp }) => {
            let now = number(view, *node);
            let nanos = stamp.map_or(0, |stamp| view.now.saturating_sub(stamp));
            let rate = |difference: f64| if nanos == 0 { f64::NAN } else { difference / (nanos as f64 / 1e9) };
            put(out, difference(now, *value).map(rate));
            (*value, *stamp) = (now, Some(view.now));
            // Where it stays, it is 0, but at a stamp that comes once more.
            false
        }
        _ => {
            *out = Value::Missing;
            false
        }
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
