//! Expressions: flat nodes, equal ones shared, and the operators with a memory behind registers.

use std::collections::{BTreeMap, BTreeSet};

use lapwing_engine::program::{self as engine, Bit, Node, NodeId, Op, Positions, RegId};
use lapwing_stream::Type;

use crate::checked::{self, Connective, Expr, Kind};

/// The expressions of one set of positions, as they are lowered.
pub(crate) struct Lowering<'c> {
    at: Positions,
    nodes: BTreeMap<String, NodeId>,
    ops: BTreeMap<String, u32>,
    counters: &'c mut u32,
    /// The counters of the comparisons lowered so far, equal ones included.
    pub used: BTreeSet<u32>,
    /// The registers of the operators lowered so far, those included that were there already.
    pub used_ops: BTreeSet<RegId>,
}

/// A [`Lowering`] at rest, between properties.
#[derive(Default)]
pub(crate) struct Lowered {
    pub at: Positions,
    nodes: BTreeMap<String, NodeId>,
    ops: BTreeMap<String, u32>,
}

impl Lowered {
    pub fn new(at: Positions) -> Lowered {
        Lowered { at, ..Lowered::default() }
    }

    /// Goes on lowering, taking further counters from `counters`.
    pub fn resume<'c>(&mut self, counters: &'c mut u32) -> Lowering<'c> {
        let Lowered { at, nodes, ops } = std::mem::take(self);
        Lowering { at, nodes, ops, counters, used: BTreeSet::new(), used_ops: BTreeSet::new() }
    }
}

pub(crate) fn bound(b: &checked::Bound) -> engine::Bound {
    engine::Bound {
        lo: b.lo.nanos(),
        lo_closed: b.lo_closed,
        hi: b.hi.map_or(i64::MAX, |hi| hi.nanos()),
        hi_closed: b.hi_closed || b.hi.is_none(),
    }
}

impl<'c> Lowering<'c> {
    pub fn new(counters: &'c mut u32) -> Lowering<'c> {
        Lowered::default().resume(counters)
    }

    pub fn rest(self) -> Lowered {
        Lowered { at: self.at, nodes: self.nodes, ops: self.ops }
    }

    pub fn into_positions(self) -> Positions {
        self.at
    }

    /// The node, or the equal one that is there already.
    fn node(&mut self, node: Node) -> NodeId {
        let key = format!("{node:?}");
        let next = self.at.nodes.len() as NodeId;
        let id = *self.nodes.entry(key).or_insert(next);
        if id == next {
            self.at.nodes.push(node);
        }
        id
    }

    /// The register of the operator, or of the equal one that is there already.
    fn op(&mut self, op: Op) -> RegId {
        let key = format!("{op:?}");
        let next = self.at.ops.len() as RegId;
        let register = *self.ops.entry(key).or_insert(next);
        if register == next {
            self.at.ops.push(op);
        }
        self.used_ops.insert(register);
        register
    }

    fn bit(&mut self, op: Op) -> Bit {
        Bit::new(self.op(op))
    }

    fn not(&mut self, of: NodeId) -> NodeId {
        match self.at.nodes[of as usize] {
            Node::Not(inner) => inner,
            Node::Bit(bit) => self.node(Node::Bit(!bit)),
            _ => self.node(Node::Not(of)),
        }
    }

    /// `l and r`, in one order whichever way they are written.
    pub fn and(&mut self, l: Bit, r: Bit) -> Bit {
        if l == r { l } else { self.bit(Op::And(l.min(r), l.max(r))) }
    }

    /// Lowers a formula without future operators.
    pub fn formula(&mut self, e: &Expr) -> Bit {
        let op = match &e.kind {
            Kind::Input(slot) => Op::Slot { slot: *slot, truth: false },
            Kind::Event(event) => Op::Event(*event),
            Kind::Truth(of) => match of.kind {
                Kind::Input(slot) => Op::Slot { slot, truth: true },
                _ => Op::Holds(self.expr(e)),
            },
            Kind::Not(of) => return !self.formula(of),
            Kind::Connective(op, l, r) => {
                let (l, r) = (self.formula(l), self.formula(r));
                return match op {
                    Connective::And => self.and(l, r),
                    Connective::Or => !self.and(!l, !r),
                    Connective::Implies => !self.and(l, !r),
                    Connective::Iff => self.bit(Op::Iff(l, r)),
                };
            }
            Kind::Previously(of) => Op::Previously(self.formula(of)),
            Kind::Becomes(of) => Op::Becomes(self.formula(of)),
            Kind::Held(duration, of) => Op::Held(*duration, self.formula(of)),
            Kind::Once(b, of) => once(b, self.formula(of)),
            Kind::Historically(b, of) => {
                let of = self.formula(of);
                return !self.bit(once(b, !of));
            }
            Kind::Since(b, l, r) => {
                let (b, l, r) = (bound(b), self.formula(l), self.formula(r));
                b.from_here().map_or(Op::Since(b, l, r), |most| Op::SinceWithin(most, l, r))
            }
            _ => Op::Holds(self.expr(e)),
        };
        self.bit(op)
    }

    /// Lowers an expression: what stands inside a comparison, a function, a quantifier.
    pub fn expr(&mut self, e: &Expr) -> NodeId {
        let node = match &e.kind {
            Kind::Num(x) => Node::Num(*x),
            Kind::Bool(b) => Node::Bool(*b),
            Kind::Str(s) => Node::Str(s.clone()),
            Kind::Input(i) => Node::Slot(*i),
            Kind::Event(event) => Node::Event(*event),
            Kind::EventField { event, field } => Node::EventField { event: *event, field: *field },
            Kind::InState { machine, state } => Node::InState { machine: *machine, state: *state },
            Kind::Updated(inputs) => Node::Updated(inputs.clone()),
            Kind::Param(slice) => Node::Param(*slice),
            Kind::Var(depth) => Node::Var(*depth),
            Kind::Age(topic) => Node::Age(*topic),
            Kind::Frequency(topic, window) => Node::Frequency(*topic, *window),
            Kind::Fresh(topic) => Node::Fresh(*topic),
            Kind::Field(of, name) => Node::Field(self.expr(of), name.clone()),
            Kind::Index(of, i) => Node::Index(self.expr(of), *i),
            Kind::Truth(of) => Node::Truth(self.expr(of)),
            Kind::Neg(of) => Node::Neg(self.expr(of)),
            Kind::Arith(op, l, r) => Node::Arith(arith(*op), self.expr(l), self.expr(r)),
            Kind::Compare { op, margin, left, right } => return self.compare(*op, margin.as_deref(), left, right),
            Kind::Not(of) => {
                let of = self.expr(of);
                return self.not(of);
            }
            Kind::Connective(op, l, r) => return self.connective(*op, l, r),
            Kind::Call(func, args) => Node::Call(self::func(*func), args.iter().map(|a| self.expr(a)).collect()),
            Kind::Quantified { all, array, body } => return self.quantified(*all, array, body),
            _ => return self.with_memory(e),
        };
        self.node(node)
    }

    fn with_memory(&mut self, e: &Expr) -> NodeId {
        let op = match &e.kind {
            Kind::Lookback(of, 0) => return self.expr(of),
            Kind::Lookback(of, depth) => Op::Lookback(self.expr(of), *depth),
            Kind::Delta(of) => Op::Delta(self.expr(of)),
            Kind::Rate(of) => Op::Rate(self.expr(of)),
            Kind::Window(checked::Window::Count, of, duration) => Op::Count(self.formula(of), *duration),
            Kind::Window(window, of, duration) => Op::Window(self::window(*window), self.expr(of), *duration),
            Kind::Previously(_)
            | Kind::Becomes(_)
            | Kind::Held(..)
            | Kind::Once(..)
            | Kind::Historically(..)
            | Kind::Since(..) => {
                let bit = self.formula(e);
                return self.node(Node::Bit(bit));
            }
            // The checker refuses future operators here; what it refused is not compiled.
            _ => return self.node(Node::Bool(false)),
        };
        let register = self.op(op);
        self.node(Node::Reg(register))
    }

    fn connective(&mut self, op: Connective, l: &Expr, r: &Expr) -> NodeId {
        let (l, r) = (self.expr(l), self.expr(r));
        let node = match op {
            Connective::And => Node::And(l, r),
            Connective::Or => Node::Or(l, r),
            Connective::Implies => {
                let not_l = self.not(l);
                Node::Or(not_l, r)
            }
            Connective::Iff => Node::Iff(l, r),
        };
        self.node(node)
    }

    fn compare(&mut self, op: checked::Compare, margin: Option<&Expr>, left: &Expr, right: &Expr) -> NodeId {
        let numeric = [left, right].iter().all(|e| matches!(e.ty, Type::Num { .. }));
        let (op, margin) = (self::compare(op), margin.map(|m| self.expr(m)));
        let (l, r) = (self.expr(left), self.expr(right));
        let counted = |counter| match numeric {
            true => Node::Compare { op, margin, left: l, right: r, counter },
            false => Node::CompareAny { op, margin, left: l, right: r, counter },
        };
        // Equal comparisons share their counter, so it is no part of what makes them equal.
        let key = format!("{:?}", counted(u32::MAX));
        let next = self.at.nodes.len() as NodeId;
        let mut node = *self.nodes.entry(key).or_insert(next);
        if node == next {
            self.at.nodes.push(counted(*self.counters));
            *self.counters += 1;
        }
        if let Node::Compare { counter, .. } | Node::CompareAny { counter, .. } = self.at.nodes[node as usize] {
            self.used.insert(counter);
        }
        // Where its event does not occur a comparison of a field is false, whatever it compares.
        for event in fields_of_events(left).into_iter().chain(fields_of_events(right)) {
            let occurs = self.node(Node::Event(event));
            node = self.node(Node::And(occurs, node));
        }
        node
    }

    fn quantified(&mut self, all: bool, array: &Expr, body: &Expr) -> NodeId {
        let events = fields_of_events(array);
        let (array, mut body) = (self.expr(array), self.expr(body));
        if !all {
            return self.node(Node::Any { array, body });
        }
        body = self.not(body);
        let any = self.node(Node::Any { array, body });
        // Where an event does not occur, nothing is so of its fields.
        let none = self.not(any);
        events.into_iter().fold(none, |all, event| {
            let occurs = self.node(Node::Event(event));
            self.node(Node::And(occurs, all))
        })
    }
}

/// `once`, in the form that its bound allows.
fn once(b: &checked::Bound, of: Bit) -> Op {
    let b = bound(b);
    b.from_here().map_or(Op::Once(b, of), |most| Op::OnceWithin(most, of))
}

/// The events whose fields an expression reads at the instant itself.
fn fields_of_events(e: &Expr) -> Vec<usize> {
    match &e.kind {
        Kind::EventField { event, .. } => vec![*event],
        Kind::Lookback(..) | Kind::Window(..) | Kind::Delta(_) | Kind::Rate(_) => Vec::new(),
        _ => e.children().into_iter().flat_map(fields_of_events).collect(),
    }
}

fn arith(op: checked::Arith) -> engine::Arith {
    match op {
        checked::Arith::Add => engine::Arith::Add,
        checked::Arith::Sub => engine::Arith::Sub,
        checked::Arith::Mul => engine::Arith::Mul,
        checked::Arith::Div => engine::Arith::Div,
    }
}

/// The engine's name of a comparison.
pub fn compare(op: checked::Compare) -> engine::Compare {
    match op {
        checked::Compare::Eq => engine::Compare::Eq,
        checked::Compare::Ne => engine::Compare::Ne,
        checked::Compare::Lt => engine::Compare::Lt,
        checked::Compare::Le => engine::Compare::Le,
        checked::Compare::Gt => engine::Compare::Gt,
        checked::Compare::Ge => engine::Compare::Ge,
    }
}

fn window(window: checked::Window) -> engine::Window {
    match window {
        checked::Window::Min => engine::Window::Min,
        checked::Window::Max => engine::Window::Max,
        checked::Window::Mean | checked::Window::Count => engine::Window::Mean,
    }
}

/// The engine's name of a function.
pub fn func(func: checked::Func) -> engine::Func {
    use checked::Func as From;
    use engine::Func as To;
    match func {
        From::Abs => To::Abs,
        From::Sign => To::Sign,
        From::Min => To::Min,
        From::Max => To::Max,
        From::Sqrt => To::Sqrt,
        From::Sin => To::Sin,
        From::Cos => To::Cos,
        From::Atan2 => To::Atan2,
        From::Norm => To::Norm,
        From::Roll => To::Roll,
        From::Pitch => To::Pitch,
        From::Yaw => To::Yaw,
        From::AngleDiff => To::AngleDiff,
        From::AngleBetween => To::AngleBetween,
        From::IntoBody => To::IntoBody,
        From::Deg => To::Deg,
        From::Rad => To::Rad,
        From::IsNan => To::IsNan,
        From::Len => To::Len,
        From::MinOf => To::MinOf,
        From::MaxOf => To::MaxOf,
        From::Lookup => To::Lookup,
        From::StartsWith => To::StartsWith,
        From::EndsWith => To::EndsWith,
        From::Contains => To::Contains,
    }
}
