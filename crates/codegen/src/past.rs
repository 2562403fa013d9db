//! Operators with a memory, and those without: the code that runs at every position, each step a variable.
//!
//! What has a bound that begins where it stands needs one stamp. A bound with a lower end needs the stamps that have not reached it, but
//! not all: of three of them the middle one says nothing where the other two already cover every moment that it covers. With bounds
//! `[a, b]` two neighbours but one are more than `b − a` apart then, so that their number is known beforehand.

use lapwing_engine::program::{Bit, Bound, NodeId, Op, Positions, Window};

use crate::code::{Block, Expr, Helper, Ty, Unit, call, elem, field, local, since};
use crate::frequency;
use crate::interface::Kind;
use crate::ring::Ring;
use crate::scene::Scene;
use crate::value::{View, bit};

/// The operators of a group or a machine, as they are written down.
pub(crate) struct Past<'a> {
    pub scene: &'a Scene<'a>,
    pub at: &'a Positions,
    /// What its fields begin with.
    pub prefix: String,
    pub machine: Option<usize>,
    pub capacity: usize,
    /// Whether the instant is a position: where it is not, only what looks back takes it in.
    pub running: Expr,
    /// The fields that say that a queue was too short.
    pub overflows: Vec<String>,
}

/// Whether some positions are looked at before they begin: by `@`, `delta` and `rate`.
pub(crate) fn looks_back(at: &Positions) -> bool {
    at.ops.iter().any(|op| matches!(op, Op::Lookback(..) | Op::Delta(_) | Op::Rate(_)))
}

impl<'a> Past<'a> {
    fn view(&self) -> View<'a> {
        View { scene: self.scene, at: self.at, machine: self.machine, is_early: looks_back(self.at) }
    }

    fn name(&self, i: usize, what: &str) -> String {
        format!("{}_{what}{i}", self.prefix)
    }

    /// Runs the operators.
    pub fn run(&mut self, unit: &mut Unit, b: &mut Block) {
        let at = self.at;
        for ring in frequency::rings(self.scene, at, self.capacity) {
            ring.shorten(b);
            self.overflows.push(ring.full());
        }
        for (i, op) in at.ops.iter().enumerate() {
            self.op(unit, b, i, op);
        }
    }

    fn op(&mut self, unit: &mut Unit, b: &mut Block, i: usize, op: &Op) {
        let running = self.running.clone();
        let result = format!("b{i}");
        let view = self.view();
        let is = match op {
            Op::Slot { slot, .. } => view.slot(*slot),
            Op::Event(event) => view.occurs(*event),
            Op::Holds(node) => view.truth(*node),
            Op::And(l, r) => bit(*l) & bit(*r),
            Op::Iff(l, r) => bit(*l).same(bit(*r)),
            Op::Previously(of) | Op::Becomes(of) => {
                let last =
                    unit.field(&self.name(i, "last"), Ty::Bool, false.into(), "A truth value at the position before.");
                let was = match op {
                    Op::Becomes(_) => bit(*of) & !last.clone(),
                    _ => last.clone(),
                };
                b.bind(&result, Ty::Bool, running.clone() & was);
                return b.when(running.clone(), |b| b.set(&last, bit(*of)));
            }
            Op::OnceWithin(most, of) => return self.within(unit, b, i, *most, None, *of),
            Op::SinceWithin(most, l, r) => return self.within(unit, b, i, *most, Some(*l), *r),
            Op::Once(bound, of) => return self.delayed(unit, b, i, bound, None, *of),
            Op::Since(bound, l, r) => return self.delayed(unit, b, i, bound, Some(*l), *r),
            Op::Held(duration, of) => return self.held(unit, b, i, duration.nanos(), *of),
            Op::Count(of, duration) => return self.count(unit, b, i, *of, duration.nanos()),
            Op::Lookback(node, depth) => return self.look_back(unit, b, i, *node, *depth),
            Op::Delta(node) => return self.change(unit, b, i, *node, false),
            Op::Rate(node) => return self.change(unit, b, i, *node, true),
            Op::Window(window, node, duration) => {
                return self.window(unit, b, i, *window, *node, duration.nanos());
            }
        };
        b.bind(&result, Ty::Bool, is);
    }

    /// `once` and `since` whose bounds begin where they stand: the latest stamp says it all.
    fn within(&mut self, unit: &mut Unit, b: &mut Block, i: usize, most: i64, left: Option<Bit>, of: Bit) {
        let running = self.running.clone();
        let seen =
            unit.field(&self.name(i, "seen"), Ty::Bool, false.into(), "Whether an operand held that still counts.");
        let is_bounded = most != i64::MAX;
        let stamp = field(self.name(i, "at"));
        if is_bounded {
            unit.field(&self.name(i, "at"), Ty::I64, 0.into(), "When it held last.");
        }
        b.when(running.clone(), |b| match left {
            // PERF: values that are chosen, not ways that are gone: nobody can tell beforehand when the operand holds.
            None => {
                b.set(&seen, bit(of) | seen.clone());
                if is_bounded {
                    b.set(&stamp, bit(of).choose(local("now"), stamp.clone()));
                }
            }
            Some(left) => {
                b.when(!bit(left), |b| b.set(&seen, false));
                b.when(bit(of), |b| {
                    b.set(&seen, true);
                    if is_bounded {
                        b.set(&stamp, local("now"));
                    }
                });
            }
        });
        let is_in = if is_bounded { since(&local("now"), &stamp).le(most) } else { Expr::Bool(true) };
        b.bind(format!("b{i}"), Ty::Bool, running.clone() & seen & is_in);
    }

    /// `once` and `since` whose bounds begin later.
    fn delayed(&mut self, unit: &mut Unit, b: &mut Block, i: usize, bound: &Bound, left: Option<Bit>, of: Bit) {
        let running = self.running.clone();
        let (from, to) = whole(bound);
        let Some(to) = to.filter(|&to| from <= to) else {
            b.bind(format!("b{i}"), Ty::Bool, false.into());
            return;
        };
        let apart = to.saturating_sub(from).saturating_add(1);
        let wanted = usize::try_from(from / apart).unwrap_or(usize::MAX).saturating_mul(2).saturating_add(4);
        let ring = Ring::new(unit, self.name(i, "queue"), wanted.min(self.capacity.max(4)));
        if wanted > ring.len {
            self.overflow(unit, &ring);
        }
        let reached = unit.field(
            &self.name(i, "reached"),
            Ty::Bool,
            false.into(),
            "Whether a stamp has reached the bound's lower end.",
        );
        let stamp = unit.field(&self.name(i, "at"), Ty::I64, 0.into(), "The latest that has.");
        let now = local("now");
        b.when(running.clone(), |b| {
            if let Some(left) = left {
                b.when(!bit(left), |b| {
                    b.set(&ring.count(), 0);
                    b.set(&reached, false);
                });
            }
            b.when(bit(of), |b| {
                let before = since(&now, &ring.at(ring.count() - 2.into()));
                let covered = ring.count().ge(2) & if to == i64::MAX { Expr::Bool(true) } else { before.le(apart) };
                b.branch(
                    covered,
                    |b| b.set(&ring.at(ring.count() - 1.into()), now.clone()),
                    |b| ring.push(b, &now, wanted > ring.len),
                );
            });
            b.repeat(ring.count().gt(0) & since(&now, &ring.at(0.into())).ge(from), |b| {
                b.set(&reached, true);
                b.set(&stamp, ring.at(0.into()));
                ring.pop(b);
            });
        });
        let is_in = if to == i64::MAX { Expr::Bool(true) } else { since(&now, &stamp).le(to) };
        b.bind(format!("b{i}"), Ty::Bool, running.clone() & reached & is_in);
    }

    /// `held for`: since when it holds without a break, and beyond the last position at which it did not.
    fn held(&mut self, unit: &mut Unit, b: &mut Block, i: usize, duration: i64, of: Bit) {
        let running = self.running.clone();
        let holds =
            unit.field(&self.name(i, "holds"), Ty::Bool, false.into(), "Whether it held at the position before.");
        let from = unit.field(&self.name(i, "from"), Ty::I64, 0.into(), "From when on it has held without a break.");
        let (now, last) = (local("now"), field(format!("{}_last", self.prefix)));
        b.when(running.clone() & bit(of) & !holds.clone(), |b| {
            // A position with this very stamp at which it did not hold is in the window.
            let broken = field(format!("{}_walked", self.prefix)) & last.clone().eq(&now);
            b.set(&from, broken.choose(call(Helper::Later, vec![last.clone(), 1.into()]), now.clone()));
        });
        b.when(running.clone(), |b| b.set(&holds, bit(of)));
        let long = now.clone().ge(&from) & since(&now, &from).ge(duration);
        b.bind(format!("b{i}"), Ty::Bool, running.clone() & bit(of) & long);
    }

    /// At how many positions of a window it held.
    fn count(&mut self, unit: &mut Unit, b: &mut Block, i: usize, of: Bit, duration: i64) {
        let running = self.running.clone();
        let ring = Ring::new(unit, self.name(i, "queue"), self.capacity);
        self.overflow(unit, &ring);
        let now = local("now");
        b.repeat(ring.count().gt(0) & since(&now, &ring.at(0.into())).gt(duration), |b| ring.pop(b));
        b.when(running.clone() & bit(of), |b| ring.push(b, &now, true));
        b.bind(format!("v{i}"), Ty::F64, ring.count().cast(Ty::F64));
        b.bind(format!("b{i}"), Ty::Bool, false.into());
    }

    /// The value so many instants ago: a ring of exactly as many.
    fn look_back(&mut self, unit: &mut Unit, b: &mut Block, i: usize, node: NodeId, depth: usize) {
        let view = self.view();
        let value = view.value(node);
        let there = value.there;
        let (values, theres) = (self.name(i, "values"), self.name(i, "theres"));
        let (ty, initial) = (value.kind.ty(self.scene.codes), initial(value.kind));
        unit.array(&values, ty, depth, initial, "Earlier values.");
        unit.array(&theres, Ty::Bool, depth, false.into(), "Whether there was one.");
        let next = unit.field(&self.name(i, "next"), Ty::U32, 0.into(), "The oldest of them.");
        b.bind(format!("v{i}"), ty, elem(&values, next.clone()));
        b.bind(format!("h{i}"), Ty::Bool, elem(&theres, next.clone()));
        b.set(&elem(&values, next.clone()), value.is);
        b.set(&elem(&theres, next.clone()), there);
        b.set(&next, (next.clone() + 1.into()).eq(depth as i64).choose(0.into(), next.clone() + 1.into()));
        b.bind(format!("b{i}"), Ty::Bool, false.into());
    }

    /// `delta` and `rate`.
    fn change(&mut self, unit: &mut Unit, b: &mut Block, i: usize, node: NodeId, is_rate: bool) {
        let view = self.view();
        let before = unit.field(&self.name(i, "before"), Ty::F64, f64::NAN.into(), "The value an instant ago.");
        let had = unit.field(&self.name(i, "had"), Ty::Bool, false.into(), "Whether there was one.");
        let there = b.bind(format!("c{i}"), Ty::Bool, view.there(node));
        let value = b.bind(format!("x{i}"), Ty::F64, view.number(node));
        b.bind(format!("h{i}"), Ty::Bool, there.clone() & had.clone());
        let mut change = value.clone() - before.clone();
        if is_rate {
            let stamp = unit.field(&self.name(i, "at"), Ty::I64, 0.into(), "Its stamp.");
            let stamped = unit.field(&self.name(i, "stamped"), Ty::Bool, false.into(), "Whether it has one.");
            let now = local("now");
            let nanos = stamped.clone().choose(since(&now, &stamp), 0.into());
            let nanos = b.bind(format!("d{i}"), Ty::U64, nanos);
            change = nanos.clone().eq(0).choose(f64::NAN.into(), change.div(nanos.cast(Ty::F64).div(1e9)));
            b.bind(format!("v{i}"), Ty::F64, change);
            b.set(&stamp, now);
            b.set(&stamped, true);
        } else {
            b.bind(format!("v{i}"), Ty::F64, change);
        }
        b.set(&before, value);
        b.set(&had, there);
        b.bind(format!("b{i}"), Ty::Bool, false.into());
    }

    /// The least, greatest or mean value of a window.
    fn window(&mut self, unit: &mut Unit, b: &mut Block, i: usize, window: Window, node: NodeId, duration: i64) {
        let running = self.running.clone();
        let ring = Ring::new(unit, self.name(i, "queue"), self.capacity);
        self.overflow(unit, &ring);
        let values = self.name(i, "values");
        unit.array(&values, Ty::F64, ring.len, 0.0.into(), "The values at these stamps.");
        let value_at = |k: Expr| elem(&values, ring.index(k));
        let now = local("now");
        let out = b.var(format!("v{i}"), Ty::F64, f64::NAN.into());
        let value = self.view().number(node);
        b.when(running.clone(), |b| {
            b.repeat(ring.count().gt(0) & since(&now, &ring.at(0.into())).gt(duration), |b| ring.pop(b));
            let x = b.bind(format!("x{i}"), Ty::F64, value);
            b.when(!call(Helper::IsNan, vec![x.clone()]), |b| {
                // What a later value outdoes cannot become the extreme again.
                let newest = value_at(ring.count() - 1.into());
                match window {
                    Window::Min => {
                        b.repeat(ring.count().gt(0) & newest.ge(&x), |b| b.set(&ring.count(), ring.count() - 1.into()))
                    }
                    Window::Max => {
                        b.repeat(ring.count().gt(0) & newest.le(&x), |b| b.set(&ring.count(), ring.count() - 1.into()))
                    }
                    Window::Mean => {}
                }
                b.when(ring.count().lt(ring.len as i64), |b| b.set(&value_at(ring.count()), x.clone()));
                ring.push(b, &now, true);
            });
            b.when(ring.count().gt(0), |b| match window {
                Window::Min | Window::Max => b.set(&out, value_at(0.into())),
                // The sum is taken anew each time, oldest first: a running sum would drift.
                Window::Mean => {
                    let sum = b.var(format!("y{i}"), Ty::F64, 0.0.into());
                    b.each("k", ring.count(), |b| b.set(&sum, sum.clone() + value_at(local("k"))));
                    b.set(&out, sum.div(ring.count().cast(Ty::F64)));
                }
            });
        });
        b.bind(format!("b{i}"), Ty::Bool, false.into());
    }

    fn overflow(&mut self, unit: &mut Unit, ring: &Ring) {
        let name = ring.full();
        unit.field(&name, Ty::Bool, false.into(), "Whether more stamps were to be kept than there is room for.");
        self.overflows.push(name);
    }

    /// Before the first instant a signal has its default: what looks back further than there are instants finds that.
    pub fn prime(&self, b: &mut Block) {
        let mut ran = Unit::default();
        let mut past = Past { running: false.into(), overflows: Vec::new(), prefix: self.prefix.clone(), ..*self };
        for (i, op) in self.at.ops.iter().enumerate() {
            if let Op::Lookback(node, _) = op {
                let view = self.view();
                let value = view.value(*node);
                b.0.push(crate::code::Stmt::Fill(self.name(i, "theres"), value.there));
                b.0.push(crate::code::Stmt::Fill(self.name(i, "values"), value.is));
            }
            past.op(&mut ran, b, i, op);
            if let Op::Rate(_) = op {
                b.set(&field(self.name(i, "stamped")), false);
            }
        }
    }
}

/// A bound in whole nanoseconds, both ends in; `None` where it holds nothing.
pub(crate) fn whole(bound: &Bound) -> (i64, Option<i64>) {
    let from = bound.lo.saturating_add(i64::from(!bound.lo_closed));
    let to = match (bound.has_end(), bound.hi_closed) {
        (true, false) => bound.hi.checked_sub(1).filter(|&hi| hi >= 0),
        _ => Some(bound.hi),
    };
    (from, to)
}

fn initial(kind: Kind) -> Expr {
    match kind {
        Kind::Truth => false.into(),
        Kind::Number => f64::NAN.into(),
        Kind::Text => 0.into(),
    }
}
