//! Vacuity: at which positions scopes are looked at, and where they are entered.

use lapwing_engine::program::{Bit, Bound, Context, ContextKind, FutureKind, Look, LookKind};

use super::expr::bound;
use super::formula::{GroupLowering, WHOLE};
use super::replay::survey;
use crate::checked::{Expr, Kind, Scope};

impl GroupLowering {
    /// Lowers what counts the entries of each scope and `whenever` of a property. Returns how many there are; they are numbered in
    /// the order of the text. The formula itself has been lowered before.
    pub fn looks(&mut self, property: usize, formula: &Expr) -> usize {
        let scopes = count_scopes(formula);
        if scopes > 0 {
            let first = self.look(WHOLE, LookKind::First, None);
            Walk { group: self, property, next: 0 }.of(formula, WHOLE, first);
        }
        if shows_late(formula) {
            // Counters of comparisons were given out when the formula was lowered: all of it is there already.
            let mut none = u32::MAX / 2;
            let mut lowering = self.expressions.resume(&mut none);
            let survey = survey(property, formula, &mut lowering);
            self.expressions = lowering.rest();
            self.future(WHOLE, FutureKind::Survey(survey));
        }
        scopes
    }

    fn look(&mut self, context: u32, kind: LookKind, counts: Option<(usize, usize)>) -> u32 {
        let look = Look { context, awaits: self.awaits(context), kind, counts };
        let found = self.looks.iter().position(|l| *l == look);
        found.unwrap_or_else(|| {
            self.looks.push(look);
            self.looks.len() - 1
        }) as u32
    }

    /// The contexts of `until` and `before` from a context outwards.
    fn awaits(&self, mut context: u32) -> Vec<u32> {
        let mut awaits = Vec::new();
        while context != WHOLE {
            let Context { parent, kind } = self.contexts[context as usize];
            if let ContextKind::Until { .. } = kind {
                awaits.push(context);
            }
            context = parent;
        }
        awaits
    }

    /// The register of a state formula.
    fn bit_of(&mut self, e: &Expr) -> Bit {
        // Counters of comparisons were given out when the formula was lowered: all of it is there already.
        let mut none = u32::MAX / 2;
        let mut lowering = self.expressions.resume(&mut none);
        let bit = lowering.formula(e);
        self.expressions = lowering.rest();
        bit
    }
}

fn count_scopes(e: &Expr) -> usize {
    let own = matches!(e.kind, Kind::Scope(..) | Kind::AfterUntil(..));
    usize::from(own) + e.children().into_iter().map(count_scopes).sum::<usize>()
}

/// Whether only the end of the trace says at which positions some scope is looked at: one below the left operand of `until`, or in or beside
/// a scope that opens or closes on a formula about the future. Until then its entries are taken to be those wherever it may be looked at.
fn shows_late(e: &Expr) -> bool {
    let here = match &e.kind {
        Kind::Until(_, left, _) => count_scopes(left) > 0,
        Kind::Scope(_, x, body) => x.has_future() && count_scopes(x) + count_scopes(body) > 0,
        Kind::AfterUntil(x, y, body) => {
            (x.has_future() || y.has_future()) && [x, y, body].into_iter().any(|e| count_scopes(e) > 0)
        }
        _ => false,
    };
    here || e.children().into_iter().any(shows_late)
}

/// A walk through a formula, from the outside in.
struct Walk<'g> {
    group: &'g mut GroupLowering,
    property: usize,
    /// The number of the next scope.
    next: usize,
}

impl Walk<'_> {
    /// A formula in a context, looked at where `look` says.
    fn of(&mut self, f: &Expr, context: u32, look: u32) {
        if count_scopes(f) == 0 {
            return;
        }
        match &f.kind {
            Kind::Always(b, of) | Kind::Eventually(b, of) => {
                let within = self.from(context, look, bound(b));
                self.of(of, context, within);
            }
            Kind::Next(of) => {
                let next = self.group.look(context, LookKind::Next { of: look }, None);
                self.of(of, context, next);
            }
            Kind::Until(b, l, r) => {
                let all = self.from(context, look, Bound::ALL);
                self.of(l, context, all);
                let within = self.from(context, look, bound(b));
                self.of(r, context, within);
            }
            Kind::Scope(scope, x, body) => self.scope(*scope, x, body, context, look),
            Kind::AfterUntil(x, y, body) => self.after_until(x, y, body, context, look),
            _ => f.children().into_iter().for_each(|c| self.of(c, context, look)),
        }
    }

    /// The positions at such distances from those of a look.
    fn from(&mut self, context: u32, look: u32, bound: Bound) -> u32 {
        let kind = match self.group.looks[look as usize].kind {
            LookKind::First => LookKind::Within(bound),
            LookKind::Within(Bound::ALL) if bound == Bound::ALL => return look,
            _ => LookKind::From { of: look, bound },
        };
        self.group.look(context, kind, None)
    }

    fn number(&mut self) -> Option<(usize, usize)> {
        self.next += 1;
        Some((self.property, self.next - 1))
    }

    fn scope(&mut self, scope: Scope, x: &Expr, body: &Expr, context: u32, look: u32) {
        let counts = self.number();
        let all = self.from(context, look, Bound::ALL);
        self.of(x, context, all);
        if x.has_future() {
            self.proves(x, counts, context, all);
            return self.of(body, context, all);
        }
        let x = self.group.bit_of(x);
        match scope {
            Scope::Whenever => {
                let entered = self.group.look(context, LookKind::Where { of: all, x }, counts);
                self.of(body, context, entered);
            }
            Scope::After => {
                let entered = self.group.look(context, LookKind::FirstWith { of: look, x }, counts);
                self.inside(body, context, ContextKind::After { x }, entered);
            }
            Scope::Until | Scope::Before => {
                self.group.look(context, LookKind::FirstWith { of: look, x }, counts);
                let begins = self.group.look(context, LookKind::Unless { of: look, x }, None);
                self.inside(body, context, ContextKind::Until { x, again: true }, begins);
            }
            Scope::While => {
                let entered = self.group.look(context, LookKind::Runs { of: look, x }, counts);
                self.inside(body, context, ContextKind::While { x }, entered);
            }
        }
    }

    /// A scope that opens on a future formula: where it opens shows only later, so each position at which the formula turns out to
    /// hold counts as an entry, and what stands inside counts as looked at wherever the scope is.
    fn proves(&mut self, x: &Expr, counts: Option<(usize, usize)>, context: u32, all: u32) {
        let formula = self.group.value_of(x, context);
        self.group.look(context, LookKind::Proves { of: all, formula }, counts);
    }

    fn after_until(&mut self, x: &Expr, y: &Expr, body: &Expr, context: u32, look: u32) {
        let counts = self.number();
        let all = self.from(context, look, Bound::ALL);
        self.of(x, context, all);
        self.of(y, context, all);
        if x.has_future() || y.has_future() {
            self.proves(x, counts, context, all);
            return self.of(body, context, all);
        }
        let (x, y) = (self.group.bit_of(x), self.group.bit_of(y));
        let entered = self.group.look(context, LookKind::Opens { of: look, x, y }, counts);
        self.inside(body, context, ContextKind::AfterUntil { x, y }, entered);
    }

    /// A body, in the segments of an inner context, looked at where its scope is entered.
    fn inside(&mut self, body: &Expr, context: u32, kind: ContextKind, entered: u32) {
        if count_scopes(body) == 0 {
            // Numbers go on in the order of the text all the same: there are none here.
            return;
        }
        let inner = self.group.context(context, kind);
        let look = self.group.look(inner, LookKind::Same { of: entered }, None);
        self.of(body, inner, look);
    }
}
