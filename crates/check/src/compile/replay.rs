//! Formulas that are evaluated anew from stored values: see the engine's `Replay`.

use lapwing_engine::program::{Bound, Replay, Term};

use super::expr::{Lowering, bound};
use crate::checked::{Connective, Expr, Kind, Scope};

/// Lowers a formula and its state formulas.
pub(crate) fn replay(formula: &Expr, lowering: &mut Lowering<'_>) -> Replay {
    let mut replay = Replay { terms: Vec::new(), leaves: Vec::new() };
    term(formula, lowering, &mut replay);
    replay
}

fn term(e: &Expr, lowering: &mut Lowering<'_>, into: &mut Replay) -> usize {
    let term = if e.has_future() {
        future(e, lowering, into)
    } else {
        into.leaves.push(lowering.formula(e));
        Term::Leaf(into.leaves.len() - 1)
    };
    into.terms.push(term);
    into.terms.len() - 1
}

/// The body of a scope: `always`, where it has no future operator.
fn body(e: &Expr, lowering: &mut Lowering<'_>, into: &mut Replay) -> usize {
    let inner = term(e, lowering, into);
    if e.has_future() {
        return inner;
    }
    into.terms.push(Term::Always(Bound::ALL, inner));
    into.terms.len() - 1
}

fn future(e: &Expr, lowering: &mut Lowering<'_>, into: &mut Replay) -> Term {
    let mut of = |e: &Expr| term(e, lowering, into);
    match &e.kind {
        Kind::Not(f) => Term::Not(of(f)),
        Kind::Connective(op, l, r) => {
            let (l, r) = (of(l), of(r));
            match op {
                Connective::And => Term::And(l, r),
                Connective::Or => Term::Or(l, r),
                Connective::Iff => Term::Iff(l, r),
                Connective::Implies => {
                    into.terms.push(Term::Not(l));
                    Term::Or(into.terms.len() - 1, r)
                }
            }
        }
        Kind::Always(b, f) => Term::Always(bound(b), of(f)),
        Kind::Eventually(b, f) => Term::Eventually(bound(b), of(f)),
        Kind::Next(f) => Term::Next(of(f)),
        Kind::Until(b, l, r) => Term::Until(bound(b), of(l), of(r)),
        Kind::Scope(Scope::Whenever, x, f) => {
            let (x, f) = (of(x), of(f));
            into.terms.push(Term::Not(x));
            into.terms.push(Term::Or(into.terms.len() - 1, f));
            Term::Always(Bound::ALL, into.terms.len() - 1)
        }
        Kind::Scope(scope, x, f) => {
            let x = of(x);
            let f = body(f, lowering, into);
            match scope {
                Scope::After => Term::After(x, f),
                Scope::Until => Term::UntilScope(x, f),
                Scope::Before => Term::Before(x, f),
                Scope::While | Scope::Whenever => Term::While(x, f),
            }
        }
        Kind::AfterUntil(x, y, f) => {
            let (x, y) = (of(x), of(y));
            let f = body(f, lowering, into);
            Term::AfterUntil(x, y, f)
        }
        _ => {
            into.leaves.push(lowering.formula(e));
            Term::Leaf(into.leaves.len() - 1)
        }
    }
}
