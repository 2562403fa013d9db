//! Formulas: which obligations they put where, and the graph of future operators that decides them.

use lapwing_engine::margin::plan::Plan;
use lapwing_engine::program::{
    At, Bound, Context, ContextKind, Future, FutureKind, FutureRef, Group, Judged, Look, Positions, Tracker,
};

use super::expr::{Lowered, Lowering, bound, compare};
use super::replay::replay;
use crate::checked::{Connective, Expr, Kind, Scope, Window};
use crate::constant::constant;

/// A group, as its properties are lowered one after the other.
pub(crate) struct GroupLowering {
    pub(super) expressions: Lowered,
    pub(super) contexts: Vec<Context>,
    futures: Vec<Future>,
    trackers: Vec<Tracker>,
    pub(super) looks: Vec<Look>,
    pub(super) margins: Vec<Plan>,
}

/// The whole trace.
pub(super) const WHOLE: u32 = 0;

impl GroupLowering {
    pub fn new(positions: Positions) -> GroupLowering {
        GroupLowering {
            expressions: Lowered::new(positions),
            contexts: vec![Context { parent: WHOLE, kind: ContextKind::Whole }],
            futures: Vec::new(),
            trackers: Vec::new(),
            looks: Vec::new(),
            margins: Vec::new(),
        }
    }

    pub fn into_group(self) -> Group {
        Group {
            at: self.expressions.at,
            contexts: self.contexts,
            futures: self.futures,
            trackers: self.trackers,
            looks: self.looks,
            margins: self.margins,
            rests: false,
            idles: false,
            heard: 0,
        }
    }

    /// Whether its operators are many enough for a group: an engine that keeps account of each has a bit for sixty-four.
    pub fn is_full(&self) -> bool {
        self.expressions.at.ops.len() >= 40
    }

    /// Lowers the formula of a property. Returns the counters of its comparisons.
    pub fn property(&mut self, number: usize, formula: &Expr, counters: &mut u32) -> Vec<u32> {
        let lowering = self.expressions.resume(counters);
        let mut obligations = Obligations { group: self, lowering, property: number };
        obligations.of(formula, &Place { context: WHOLE, gates: Vec::new() });
        let used = obligations.lowering.used.iter().copied().collect();
        let ops: Vec<usize> = obligations.lowering.used_ops.iter().map(|&op| op as usize).collect();
        let rest = obligations.lowering.rest();
        self.expressions = rest;
        self.trackers.iter_mut().filter(|t| t.property == number).for_each(|t| t.ops.clone_from(&ops));
        used
    }

    /// The node of a formula in a context. Its comparisons count no NaN: they do where the property itself is lowered.
    pub(super) fn value_of(&mut self, formula: &Expr, context: u32) -> FutureRef {
        let mut none = u32::MAX / 2;
        let lowering = self.expressions.resume(&mut none);
        let mut obligations = Obligations { group: self, lowering, property: usize::MAX };
        let value = obligations.value(formula, context);
        let rest = obligations.lowering.rest();
        self.expressions = rest;
        value
    }

    /// The context, or the equal one that is there already.
    pub(super) fn context(&mut self, parent: u32, kind: ContextKind) -> u32 {
        let context = Context { parent, kind };
        let found = self.contexts.iter().position(|c| *c == context);
        found.unwrap_or_else(|| {
            self.contexts.push(context);
            self.contexts.len() - 1
        }) as u32
    }

    /// The node, or the equal one that is there already.
    pub(super) fn future(&mut self, context: u32, kind: FutureKind) -> FutureRef {
        let future = Future::new(context, kind);
        let found = self.futures.iter().position(|f| *f == future);
        let id = found.unwrap_or_else(|| {
            self.futures.push(future);
            self.futures.len() - 1
        });
        FutureRef { id: id as u32, negated: false }
    }
}

/// Where a formula stands that puts obligations.
#[derive(Clone)]
struct Place {
    /// The segments.
    context: u32,
    /// The contexts of the `before`s around it, the outermost first.
    gates: Vec<u32>,
}

/// The obligations of one property.
struct Obligations<'g, 'c> {
    group: &'g mut GroupLowering,
    lowering: Lowering<'c>,
    property: usize,
}

fn negated(f: FutureRef) -> FutureRef {
    FutureRef { negated: !f.negated, ..f }
}

impl Obligations<'_, '_> {
    /// What a formula puts at the top of a trace, or as the body of a scope at the first position of each segment.
    fn of(&mut self, f: &Expr, place: &Place) {
        match &f.kind {
            _ if !f.has_future() => self.put(f, place, At::All, false),
            Kind::Always(b, body) => self.put_split(body, place, At::within(bound(b))),
            Kind::Scope(Scope::Whenever, x, body) => self.whenever(x, body, place),
            Kind::Connective(Connective::And, l, r) => {
                for part in [l, r] {
                    if part.has_future() {
                        self.of(part, place);
                    } else {
                        self.put(part, place, At::First, is_missed_on_nothing(part));
                    }
                }
            }
            Kind::Scope(scope, x, body) if !x.has_future() => self.scope(*scope, x, body, place),
            Kind::AfterUntil(x, y, body) if !x.has_future() && !y.has_future() => {
                let (x, y) = (self.lowering.formula(x), self.lowering.formula(y));
                let context = self.group.context(place.context, ContextKind::AfterUntil { x, y });
                self.of(body, &Place { context, gates: place.gates.clone() });
            }
            _ => self.put(f, place, At::First, is_missed_on_nothing(f)),
        }
    }

    fn scope(&mut self, scope: Scope, x: &Expr, body: &Expr, place: &Place) {
        let node = self.lowering.formula(x);
        let kind = match scope {
            Scope::After => ContextKind::After { x: node },
            Scope::Until | Scope::Before => ContextKind::Until { x: node, again: false },
            Scope::While | Scope::Whenever => ContextKind::While { x: node },
        };
        let context = self.group.context(place.context, kind);
        let mut inner = Place { context, gates: place.gates.clone() };
        match scope {
            Scope::Before => inner.gates.push(context),
            Scope::Until => {
                let comes = self.group.future(place.context, FutureKind::State(node));
                let comes = self.group.future(place.context, FutureKind::Eventually(Bound::ALL, comes));
                self.track(comes, place, At::First, true);
            }
            _ => {}
        }
        self.of(body, &inner);
    }

    /// `whenever X, body` is `always (X implies body)`.
    fn whenever(&mut self, x: &Expr, body: &Expr, place: &Place) {
        if !x.has_future() && !body.has_future() && place.gates.is_empty() {
            let (x, body) = (self.lowering.formula(x), self.lowering.formula(body));
            let fails = self.lowering.and(x, !body);
            self.push(place, At::All, Judged::State(!fails), false);
            return;
        }
        let x = self.value(x, place.context);
        let body = self.value(body, place.context);
        let fails = self.and(place.context, x, negated(body));
        self.track(negated(fails), place, At::All, false);
    }

    /// Directly under `always`, a conjunction with a future operator splits.
    fn put_split(&mut self, body: &Expr, place: &Place, at: At) {
        match &body.kind {
            Kind::Connective(Connective::And, l, r) if body.has_future() => {
                self.put_split(l, place, at);
                self.put_split(r, place, at);
            }
            _ => self.put(body, place, at, false),
        }
    }

    /// One obligation per position of `at`.
    fn put(&mut self, f: &Expr, place: &Place, at: At, missed: bool) {
        if !f.has_future() && place.gates.is_empty() {
            let node = self.lowering.formula(f);
            self.push(place, at, Judged::State(node), missed);
        } else {
            let value = self.value(f, place.context);
            self.track(value, place, at, missed);
        }
    }

    /// The same for a formula in the graph, behind the gates around it.
    fn track(&mut self, mut value: FutureRef, place: &Place, at: At, missed: bool) {
        for &before in place.gates.iter().rev() {
            value = self.group.future(place.context, FutureKind::Gate { body: value, before });
        }
        self.push(place, at, Judged::Future(value), missed);
    }

    fn push(&mut self, place: &Place, at: At, formula: Judged, missed: bool) {
        self.group.trackers.push(Tracker {
            property: self.property,
            context: place.context,
            at,
            formula,
            missed_if_empty: missed && place.context == WHOLE,
            ops: Vec::new(),
        });
    }

    /// The node of a formula in a context.
    fn value(&mut self, f: &Expr, context: u32) -> FutureRef {
        if !f.has_future() {
            let node = self.lowering.formula(f);
            return self.group.future(context, FutureKind::State(node));
        }
        match &f.kind {
            Kind::Not(of) => negated(self.value(of, context)),
            Kind::Connective(op, l, r) => {
                let (l, r) = (self.value(l, context), self.value(r, context));
                self.connective(*op, context, l, r)
            }
            Kind::Always(b, of) => {
                let of = self.value(of, context);
                negated(self.eventually(context, bound(b), negated(of)))
            }
            Kind::Eventually(b, of) => {
                let of = self.value(of, context);
                self.eventually(context, bound(b), of)
            }
            Kind::Next(of) => {
                let of = self.value(of, context);
                self.group.future(context, FutureKind::Next(of))
            }
            Kind::Until(b, l, r) if !l.has_future() && !r.has_future() => {
                let (l, r) = (self.lowering.formula(l), self.lowering.formula(r));
                self.group.future(context, FutureKind::Until(bound(b), l, r))
            }
            Kind::Scope(Scope::Whenever, x, body) => {
                let (x, body) = (self.value(x, context), self.value(body, context));
                let fails = self.and(context, x, negated(body));
                negated(self.eventually(context, Bound::ALL, fails))
            }
            Kind::Scope(scope, x, body) if !x.has_future() => self.scope_value(*scope, x, body, context),
            Kind::AfterUntil(x, y, body) if !x.has_future() && !y.has_future() => {
                let (x, y) = (self.lowering.formula(x), self.lowering.formula(y));
                let inner = self.group.context(context, ContextKind::AfterUntil { x, y });
                let body = self.body(body, inner);
                self.group.future(context, FutureKind::Each { x, body, inner })
            }
            _ => {
                let formula = replay(f, &mut self.lowering);
                self.group.future(context, FutureKind::Replay(formula))
            }
        }
    }

    /// A scope below something that does not split.
    fn scope_value(&mut self, scope: Scope, x: &Expr, body: &Expr, context: u32) -> FutureRef {
        let x = self.lowering.formula(x);
        let kind = match scope {
            Scope::After => ContextKind::After { x },
            Scope::Until | Scope::Before => ContextKind::Until { x, again: true },
            Scope::While | Scope::Whenever => ContextKind::While { x },
        };
        let inner = self.group.context(context, kind);
        let body = self.body(body, inner);
        let kind = match scope {
            Scope::After => FutureKind::After { x, body, inner },
            Scope::Until => FutureKind::UntilScope { weak: false, x, body, inner },
            Scope::Before => FutureKind::UntilScope { weak: true, x, body, inner },
            Scope::While | Scope::Whenever => FutureKind::Each { x, body, inner },
        };
        self.group.future(context, kind)
    }

    /// The body of a scope: `always`, where it has no future operator.
    fn body(&mut self, body: &Expr, inner: u32) -> FutureRef {
        let value = self.value(body, inner);
        if body.has_future() { value } else { negated(self.eventually(inner, Bound::ALL, negated(value))) }
    }

    fn eventually(&mut self, context: u32, bound: Bound, of: FutureRef) -> FutureRef {
        self.group.future(context, FutureKind::Eventually(bound, of))
    }

    fn and(&mut self, context: u32, l: FutureRef, r: FutureRef) -> FutureRef {
        self.group.future(context, FutureKind::And(l, r))
    }

    fn connective(&mut self, op: Connective, context: u32, l: FutureRef, r: FutureRef) -> FutureRef {
        match op {
            Connective::And => self.and(context, l, r),
            Connective::Or => negated(self.and(context, negated(l), negated(r))),
            Connective::Implies => negated(self.and(context, l, negated(r))),
            Connective::Iff => {
                let one = negated(self.and(context, l, negated(r)));
                let other = negated(self.and(context, r, negated(l)));
                self.and(context, one, other)
            }
        }
    }
}

/// Whether a formula, asked of a trace without any position, wants something to happen.
fn is_missed_on_nothing(f: &Expr) -> bool {
    !holds_on_nothing(f)
}

fn holds_on_nothing(f: &Expr) -> bool {
    match &f.kind {
        Kind::Bool(b) => *b,
        Kind::Not(of) => !holds_on_nothing(of),
        Kind::Connective(op, l, r) => {
            let (l, r) = (holds_on_nothing(l), holds_on_nothing(r));
            match op {
                Connective::And => l && r,
                Connective::Or => l || r,
                Connective::Implies => !l || r,
                Connective::Iff => l == r,
            }
        }
        Kind::Always(..) | Kind::AfterUntil(..) | Kind::Historically(..) => true,
        Kind::Compare { op, margin, left, right } => {
            let margin = margin.as_deref().map_or(Some(0.0), constant);
            match (number_on_nothing(left), number_on_nothing(right), margin) {
                (Some(l), Some(r), Some(m)) => lapwing_engine::compare(compare(*op), l, r, m),
                _ => false,
            }
        }
        Kind::Scope(scope, ..) => *scope != Scope::Until,
        _ => false,
    }
}

/// The value of an expression that needs no position: windows are empty.
fn number_on_nothing(e: &Expr) -> Option<f64> {
    match &e.kind {
        Kind::Window(Window::Count, ..) => Some(0.0),
        Kind::Window(..) => Some(f64::NAN),
        _ => constant(e),
    }
}
