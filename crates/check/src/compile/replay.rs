//! Formulas that are evaluated anew from stored values: see the engine's `Replay` and `Survey`.

use lapwing_engine::program::{Bound, Replay, Survey, Term};

use super::expr::{Lowering, bound};
use crate::checked::{Connective, Expr, Kind, Scope};

/// Lowers a formula and its state formulas.
pub(crate) fn replay(formula: &Expr, lowering: &mut Lowering<'_>) -> Replay {
    let mut terms = Terms::new(lowering);
    terms.term(formula);
    terms.formula
}

/// Lowers a property's formula and its state formulas, to count the entries of its scopes.
pub(crate) fn survey(property: usize, formula: &Expr, lowering: &mut Lowering<'_>) -> Survey {
    let mut terms = Terms::new(lowering);
    terms.term(formula);
    Survey { property, formula: terms.formula, scopes: terms.scopes }
}

/// A formula, as its terms are lowered one after the other.
struct Terms<'l, 'c> {
    lowering: &'l mut Lowering<'c>,
    formula: Replay,
    /// The terms that are scopes, in the order of the text.
    scopes: Vec<usize>,
}

impl<'l, 'c> Terms<'l, 'c> {
    fn new(lowering: &'l mut Lowering<'c>) -> Terms<'l, 'c> {
        Terms { lowering, formula: Replay { terms: Vec::new(), leaves: Vec::new() }, scopes: Vec::new() }
    }

    fn push(&mut self, term: Term) -> usize {
        self.formula.terms.push(term);
        self.formula.terms.len() - 1
    }

    fn term(&mut self, e: &Expr) -> usize {
        if !e.has_future() {
            return self.leaf(e);
        }
        match &e.kind {
            Kind::Scope(..) | Kind::AfterUntil(..) => {
                // A scope comes before those inside it, and its term after theirs.
                let number = self.scopes.len();
                self.scopes.push(0);
                let term = self.scope(e);
                self.scopes[number] = term;
                term
            }
            _ => self.operator(e),
        }
    }

    fn leaf(&mut self, e: &Expr) -> usize {
        let bit = self.lowering.formula(e);
        self.formula.leaves.push(bit);
        self.push(Term::Leaf(self.formula.leaves.len() - 1))
    }

    /// The body of a scope: `always`, where it has no future operator.
    fn body(&mut self, e: &Expr) -> usize {
        let inner = self.term(e);
        if e.has_future() { inner } else { self.push(Term::Always(Bound::ALL, inner)) }
    }

    fn operator(&mut self, e: &Expr) -> usize {
        let term = match &e.kind {
            Kind::Not(f) => Term::Not(self.term(f)),
            Kind::Connective(op, l, r) => {
                let (l, r) = (self.term(l), self.term(r));
                match op {
                    Connective::And => Term::And(l, r),
                    Connective::Or => Term::Or(l, r),
                    Connective::Iff => Term::Iff(l, r),
                    Connective::Implies => Term::Or(self.push(Term::Not(l)), r),
                }
            }
            Kind::Always(b, f) => Term::Always(bound(b), self.term(f)),
            Kind::Eventually(b, f) => Term::Eventually(bound(b), self.term(f)),
            Kind::Next(f) => Term::Next(self.term(f)),
            Kind::Until(b, l, r) => {
                let (l, r) = (self.term(l), self.term(r));
                Term::Until(bound(b), l, r)
            }
            _ => return self.leaf(e),
        };
        self.push(term)
    }

    fn scope(&mut self, e: &Expr) -> usize {
        let term = match &e.kind {
            Kind::Scope(Scope::Whenever, x, f) => {
                let (x, f) = (self.term(x), self.term(f));
                let not = self.push(Term::Not(x));
                Term::Always(Bound::ALL, self.push(Term::Or(not, f)))
            }
            Kind::Scope(scope, x, f) => {
                let (x, f) = (self.term(x), self.body(f));
                match scope {
                    Scope::After => Term::After(x, f),
                    Scope::Until => Term::UntilScope(x, f),
                    Scope::Before => Term::Before(x, f),
                    Scope::While | Scope::Whenever => Term::While(x, f),
                }
            }
            Kind::AfterUntil(x, y, f) => {
                let (x, y) = (self.term(x), self.term(y));
                Term::AfterUntil(x, y, self.body(f))
            }
            _ => return self.operator(e),
        };
        self.push(term)
    }
}
