//! Expressions without a memory, as expressions of the intermediate form.

use lapwing_engine::program::{Arith, Bit, Compare, Func, Node, NodeId, Op, Positions, Read};

use crate::code::{Expr, Helper, Ty, call, field, local, since};
use crate::frequency::frequency;
use crate::geometry::{inverse, norm, rotated};
use crate::intake::heard;
use crate::interface::{From, Kind};
use crate::kinds::Kinds;
use crate::scene::Scene;

/// The value of an expression.
#[derive(Clone, Debug)]
pub(crate) struct Val {
    pub kind: Kind,
    pub is: Expr,
    /// Whether there is a value at all; where there is none, a number is NaN, and a truth value false.
    pub there: Expr,
}

/// What evaluation needs to know.
pub(crate) struct View<'a> {
    pub scene: &'a Scene<'a>,
    pub at: &'a Positions,
    /// The number of the machine whose conditions these are.
    pub machine: Option<usize>,
    /// Whether a signal may be looked at before it had a value.
    pub is_early: bool,
}

/// A register's truth value, or its negation.
pub(crate) fn bit(bit: Bit) -> Expr {
    let is = local(format!("b{}", bit.register()));
    if bit.is_negated() { !is } else { is }
}

const NAN: Expr = Expr::Float(f64::NAN);

impl<'a> View<'a> {
    fn kinds(&self) -> &'a Kinds {
        &self.scene.kinds
    }

    /// The truth of a signal.
    pub fn slot(&self, slot: usize) -> Expr {
        truth_of(&self.signal(slot))
    }

    fn signal(&self, slot: usize) -> Val {
        let kind = self.kinds().get(From::Input(slot));
        let there = if self.is_early { self.scene.is_known(slot) } else { Expr::Bool(true) };
        Val { kind, is: field(self.scene.slot_field(slot)), there }
    }

    /// Whether an event occurs.
    pub fn occurs(&self, event: usize) -> Expr {
        field(self.scene.event_field(event))
    }

    /// The truth of an expression; what has no value is false.
    pub fn truth(&self, node: NodeId) -> Expr {
        match &self.at.nodes[node as usize] {
            Node::Not(a) => !self.truth(*a),
            Node::And(a, b) => self.truth(*a) & self.truth(*b),
            Node::Or(a, b) => self.truth(*a) | self.truth(*b),
            Node::Iff(a, b) => self.truth(*a).same(self.truth(*b)),
            Node::Compare { op, margin, left, right, .. } => {
                let (a, b) = (self.number(*left), self.number(*right));
                let there = self.there(*left) & self.there(*right);
                let no_nan = !(call(Helper::IsNan, vec![a.clone()]) | call(Helper::IsNan, vec![b.clone()]));
                let is = compare(*op, a, b, margin.map(|m| self.number(m)));
                // Only `!=` is true of NaN.
                if *op == Compare::Ne && there != Expr::Bool(true) { is & (no_nan | there) } else { is }
            }
            Node::CompareAny { op, margin, left, right, .. } => {
                let (a, b) = (self.value(*left), self.value(*right));
                let there = a.there & b.there;
                there
                    & match a.kind {
                        Kind::Number => compare(*op, a.is, b.is, margin.map(|m| self.number(m))),
                        _ => match op {
                            Compare::Eq => a.is.same_as(b.is, a.kind),
                            _ => !a.is.same_as(b.is, a.kind),
                        },
                    }
            }
            _ => truth_of(&self.value(node)),
        }
    }

    /// A number; what has no value is NaN.
    pub fn number(&self, node: NodeId) -> Expr {
        self.value(node).is
    }

    /// A value of any kind. `there` is about the value itself: what is computed from nothing is NaN, which is a value.
    pub fn value(&self, node: NodeId) -> Val {
        let number = |is: Expr| Val { kind: Kind::Number, is, there: Expr::Bool(true) };
        let truth = |is: Expr| Val { kind: Kind::Truth, is, there: Expr::Bool(true) };
        match &self.at.nodes[node as usize] {
            Node::Num(x) => number(Expr::Float(*x)),
            Node::Bool(b) => truth(Expr::Bool(*b)),
            Node::Str(text) => Val { kind: Kind::Text, is: Expr::Int(self.scene.text(text)), there: Expr::Bool(true) },
            Node::Slot(slot) => self.signal(*slot),
            Node::Reg(register) => {
                let kind = match &self.at.ops[*register as usize] {
                    Op::Lookback(of, _) => self.value(*of).kind,
                    _ => Kind::Number,
                };
                let has_none = matches!(self.at.ops[*register as usize], Op::Lookback(..) | Op::Delta(_) | Op::Rate(_));
                let there = if has_none { local(format!("h{register}")) } else { Expr::Bool(true) };
                Val { kind, is: local(format!("v{register}")), there }
            }
            Node::EventField { event, field: f } => self.event_field(*event, *f),
            Node::Neg(a) => number(Expr::Neg(Box::new(self.number(*a)))),
            Node::Arith(op, a, b) => {
                let (a, b) = (self.number(*a), self.number(*b));
                number(match op {
                    Arith::Add => a + b,
                    Arith::Sub => a - b,
                    Arith::Mul => a.mul(b),
                    Arith::Div => a.div(b),
                })
            }
            Node::Call(Func::IsNan, args) => {
                truth(args.first().map_or(Expr::Bool(true), |&a| call(Helper::IsNan, vec![self.number(a)])))
            }
            Node::Call(func, args) => number(numeric(*func, args.iter().map(|&a| self.number(a)).collect())),
            Node::Truth(of) => truth(truth_of(&self.value(*of))),
            Node::Bit(of) => truth(bit(*of)),
            Node::Event(event) => truth(self.occurs(*event)),
            Node::InState { machine, state } => {
                truth(field(format!("m{machine}_state")).eq(self.scene.state_code(*machine, *state)))
            }
            Node::Age(topic) => {
                let (heard, has) = heard(self.scene, Read::Topic(*topic));
                let seconds = since(&local("now"), &field(heard)).cast(Ty::F64).div(1e9);
                number(field(has).choose(seconds, NAN))
            }
            Node::Fresh(topic) => truth(field(self.scene.topic_field(*topic))),
            Node::Updated(slots) => {
                let machine = self.machine.unwrap_or(0);
                let any = slots.iter().map(|s| field(format!("m{machine}_updated_{s}")));
                truth(any.fold(Expr::Bool(false), |a, b| a | b))
            }
            Node::Not(_)
            | Node::And(..)
            | Node::Or(..)
            | Node::Iff(..)
            | Node::Compare { .. }
            | Node::CompareAny { .. } => truth(self.truth(node)),
            Node::Frequency(topic, window) => number(frequency(self.scene, *topic, *window)),
            // Refused where the specification is looked through.
            Node::Param(_) | Node::Var(_) | Node::Field(..) | Node::Index(..) | Node::Any { .. } => number(NAN),
        }
    }

    fn event_field(&self, event: usize, f: usize) -> Val {
        let kind = self.kinds().get(From::EventField(event, f));
        let (occurs, name) = (field(self.scene.event_field(event)), self.scene.event_value(event, f));
        let is = field(&name);
        let is = match kind {
            Kind::Truth => occurs.clone() & is,
            Kind::Number => occurs.clone().choose(is, NAN),
            Kind::Text => is,
        };
        Val { kind, is, there: occurs & field(format!("{name}_there")) }
    }

    /// Whether an expression stands on values that are there, as `delta` and comparisons ask it.
    pub fn there(&self, node: NodeId) -> Expr {
        match &self.at.nodes[node as usize] {
            Node::Slot(_) | Node::Reg(_) | Node::EventField { .. } => self.value(node).there,
            Node::Neg(of) => self.there(*of),
            Node::Arith(_, a, b) => self.there(*a) & self.there(*b),
            Node::Call(_, args) => args.iter().fold(Expr::Bool(true), |all, &a| all & self.there(a)),
            _ => Expr::Bool(true),
        }
    }
}

impl Expr {
    /// Two truth values or two texts are the same.
    fn same_as(self, other: Expr, kind: Kind) -> Expr {
        if kind == Kind::Truth { self.same(other) } else { self.eq(other) }
    }
}

/// A value as a condition: a number is true when it is neither zero nor NaN.
fn truth_of(value: &Val) -> Expr {
    match value.kind {
        Kind::Truth => value.is.clone(),
        Kind::Number => value.is.clone().ne(0.0) & !call(Helper::IsNan, vec![value.is.clone()]),
        Kind::Text => Expr::Bool(false),
    }
}

/// A comparison with a margin; equal infinities are equal, NaN is only ever unequal.
pub(crate) fn compare(op: Compare, a: Expr, b: Expr, margin: Option<Expr>) -> Expr {
    let Some(m) = margin.filter(|m| *m != Expr::Float(0.0)) else {
        return match op {
            Compare::Lt => a.lt(b),
            Compare::Le => a.le(b),
            Compare::Gt => a.gt(b),
            Compare::Ge => a.ge(b),
            Compare::Eq => a.eq(b),
            Compare::Ne => a.ne(b),
        };
    };
    let same_infinity = |a: Expr, b: Expr| a.clone().eq(b) & call(Helper::Abs, vec![a]).eq(Expr::Float(f64::INFINITY));
    let near = |a: Expr, b: Expr, m: Expr| call(Helper::Abs, vec![a.clone() - b.clone()]).le(m) | same_infinity(a, b);
    // Infinities stay what they are beside a finite margin.
    let is_finite = matches!(m, Expr::Float(m) if m.is_finite());
    match op {
        Compare::Lt => a.lt(b + m),
        Compare::Le if is_finite => a.le(b + m),
        Compare::Le => a.clone().le(b.clone() + m) | same_infinity(a, b),
        Compare::Gt => a.gt(b - m),
        Compare::Ge if is_finite => a.ge(b - m),
        Compare::Ge => a.clone().ge(b.clone() - m) | same_infinity(a, b),
        Compare::Eq => near(a, b, m),
        Compare::Ne => !near(a, b, m),
    }
}

const PI: f64 = core::f64::consts::PI;

/// A function of numbers, with the very operations of the engine in their order.
fn numeric(func: Func, args: Vec<Expr>) -> Expr {
    let a = |i: usize| args.get(i).cloned().unwrap_or(NAN);
    let one = |helper: Helper| call(helper, vec![a(0)]);
    let num = Expr::Float;
    match func {
        Func::Abs => one(Helper::Abs),
        Func::Sign => one(Helper::Sign),
        Func::Sqrt => one(Helper::Sqrt),
        Func::Sin => one(Helper::Sin),
        Func::Cos => one(Helper::Cos),
        Func::Atan2 => call(Helper::Atan2, vec![a(0), a(1)]),
        Func::Min => fold(Helper::Least, args),
        Func::Max => fold(Helper::Greatest, args),
        Func::Norm => norm(&args),
        Func::IntoBody => {
            let turned = rotated(&[a(1), a(2), a(3)], &inverse([a(4), a(5), a(6), a(7)]), |_, e| e);
            let [x, y, z] = turned;
            match a(0) {
                Expr::Float(0.0) => x,
                Expr::Float(1.0) => y,
                _ => z,
            }
        }
        Func::Deg => a(0).mul(num(180.0)).div(num(PI)),
        Func::Rad => a(0).mul(num(PI)).div(num(180.0)),
        Func::Roll | Func::Yaw | Func::Pitch => {
            let (x, y, z, w) = (a(0), a(1), a(2), a(3));
            let twice = |e: Expr| num(2.0).mul(e);
            let products = |a: &Expr, b: &Expr, c: &Expr, d: &Expr| a.clone().mul(b.clone()) + c.clone().mul(d.clone());
            match func {
                Func::Roll => call(
                    Helper::Atan2,
                    vec![twice(products(&w, &x, &y, &z)), num(1.0) - twice(products(&x, &x, &y, &y))],
                ),
                Func::Yaw => call(
                    Helper::Atan2,
                    vec![twice(products(&w, &z, &x, &y)), num(1.0) - twice(products(&y, &y, &z, &z))],
                ),
                _ => {
                    let sine = twice(w.mul(y) - z.mul(x));
                    let clamped = sine.clone().gt(1.0).choose(num(1.0), sine.clone());
                    call(Helper::Asin, vec![sine.lt(num(-1.0)).choose(num(-1.0), clamped)])
                }
            }
        }
        Func::AngleDiff => {
            let turned = call(Helper::Fmod, vec![a(0) - a(1) + num(PI), num(2.0 * PI)]);
            turned.clone().le(0.0).choose(turned.clone() + num(2.0 * PI), turned) - num(PI)
        }
        Func::AngleBetween => {
            let (p, q) = ([a(0), a(1), a(2), a(3)], [a(4), a(5), a(6), a(7)]);
            let products = p.iter().zip(&q).map(|(a, b)| a.clone().mul(b.clone()));
            let dot = products.fold(num(0.0), |sum, e| sum + e).div(norm(&p).mul(norm(&q)));
            let size = call(Helper::Abs, vec![dot]);
            num(2.0).mul(call(Helper::Acos, vec![size.clone().lt(1.0).choose(size, num(1.0))]))
        }
        _ => NAN,
    }
}

fn fold(helper: Helper, args: Vec<Expr>) -> Expr {
    args.into_iter().reduce(|a, b| call(helper, vec![a, b])).unwrap_or(NAN)
}
