//! Margins: a property's formula once more, as code and terms over numbers instead of truth values.

use lapwing_engine::margin::plan::{Column, Duty, Op, Plan, Reg, Term};
use lapwing_engine::program::Bound;
use lapwing_stream::Type;

use super::expr::{Lowering, bound, compare};
use super::formula::GroupLowering;
use crate::checked::{Connective, Expr, Kind, Scope};

impl GroupLowering {
    /// Lowers the margin of a property, where it has one: not where operands of different dimensions are compared, since what is
    /// compared with what could not be compared with the rest. The formula itself has been lowered before.
    pub fn margin(&mut self, property: usize, formula: &Expr, counters: &mut u32) {
        if !is_of_one_dimension(formula) {
            return;
        }
        let lowering = self.expressions.resume(counters);
        let plan = Plan { property, ops: Vec::new(), least: Vec::new(), columns: Vec::new(), duties: Vec::new() };
        let mut margin = Margin { lowering, plan };
        let is_whole = margin.top(formula).is_some();
        let Margin { lowering, plan } = margin;
        self.expressions = lowering.rest();
        self.margins.extend(is_whole.then_some(plan));
    }
}

/// Whether the operands of all comparisons have one dimension, as far as dimensions are known.
fn is_of_one_dimension(formula: &Expr) -> bool {
    let mut found = None;
    let mut is_one = true;
    super::below(formula, &mut |e| {
        if let Kind::Compare { left, .. } = &e.kind
            && !matches!(left.ty, Type::Bool | Type::Str)
            && let Some(dimension) = e.dim.0
        {
            is_one &= *found.get_or_insert(dimension) == dimension;
        }
    });
    is_one
}

/// What the terms of a formula stand on.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Over {
    Margins,
    Truth,
}

/// A margin as it is lowered. What cannot be lowered (a scope that opens on a formula inside which another opens on a future
/// formula) has none.
struct Margin<'c> {
    lowering: Lowering<'c>,
    plan: Plan,
}

fn not(term: Term) -> Term {
    match term {
        Term::Not(of) => *of,
        other => Term::Not(Box::new(other)),
    }
}

fn or(l: Term, r: Term) -> Term {
    Term::Or(Box::new(l), Box::new(r))
}

fn eventually(bound: Bound, of: Term) -> Term {
    Term::Eventually(bound, Box::new(of))
}

fn always(bound: Bound, of: Term) -> Term {
    not(eventually(bound, not(of)))
}

impl Margin<'_> {
    /// A formula at the top of a trace: what must hold at every position is kept apart from the rest.
    fn top(&mut self, f: &Expr) -> Option<()> {
        match &f.kind {
            Kind::Always(b, body) if !body.has_future() && bound(b) == Bound::ALL => self.throughout(body),
            _ if !f.has_future() => self.throughout(f),
            Kind::Scope(Scope::Whenever, x, body) if !x.has_future() && !body.has_future() => {
                let (x, body) = (self.quantity(x), self.quantity(body));
                let least = self.implies(x, body);
                self.plan.least.push(least);
            }
            Kind::Connective(Connective::And, l, r) => {
                for part in [l, r] {
                    if part.has_future() {
                        self.top(part)?;
                    } else {
                        let once = Duty::Once(self.state(part, Over::Margins));
                        self.plan.duties.push(once);
                    }
                }
            }
            _ => {
                let duties = self.duties(f)?;
                self.plan.duties.extend(duties);
            }
        }
        Some(())
    }

    fn throughout(&mut self, f: &Expr) {
        let least = self.quantity(f);
        self.plan.least.push(least);
    }

    /// The obligations that a formula puts in a segment: see the lowering of formulas.
    fn duties(&mut self, f: &Expr) -> Option<Vec<Duty>> {
        let duty = match &f.kind {
            _ if !f.has_future() => Duty::Each(Bound::ALL, self.state(f, Over::Margins)),
            Kind::Always(b, body) => Duty::Each(bound(b), self.term(body, Over::Margins)?),
            Kind::Scope(Scope::Whenever, x, body) => {
                let (x, body) = (self.term(x, Over::Margins)?, self.term(body, Over::Margins)?);
                Duty::Each(Bound::ALL, or(not(x), body))
            }
            Kind::Connective(Connective::And, l, r) => {
                let mut duties = Vec::new();
                for part in [l, r] {
                    match part.has_future() {
                        true => duties.extend(self.duties(part)?),
                        false => duties.push(Duty::Once(self.state(part, Over::Margins))),
                    }
                }
                return Some(duties);
            }
            Kind::Scope(scope, x, body) if !x.has_future() => return self.scope_duties(*scope, x, body),
            Kind::AfterUntil(x, y, body) if !x.has_future() && !y.has_future() => {
                let (x, y) = (self.truth(x), self.truth(y));
                Duty::AfterUntil { x, y, body: self.duties(body)? }
            }
            _ => Duty::Once(self.term(f, Over::Margins)?),
        };
        Some(vec![duty])
    }

    fn scope_duties(&mut self, scope: Scope, x: &Expr, body: &Expr) -> Option<Vec<Duty>> {
        let mut duties = Vec::new();
        if scope == Scope::Until {
            duties.push(Duty::Once(eventually(Bound::ALL, self.state(x, Over::Margins))));
        }
        let x = self.truth(x);
        let body = self.duties(body)?;
        duties.push(match scope {
            Scope::After => Duty::After { x, body },
            Scope::Until => Duty::UpTo { x, weak: false, body },
            Scope::Before => Duty::UpTo { x, weak: true, body },
            Scope::While | Scope::Whenever => Duty::While { x, body },
        });
        Some(duties)
    }

    /// A formula as a term.
    fn term(&mut self, f: &Expr, over: Over) -> Option<Term> {
        if !f.has_future() {
            return Some(self.state(f, over));
        }
        Some(match &f.kind {
            Kind::Not(of) => not(self.term(of, over)?),
            Kind::Connective(op, l, r) => {
                let (l, r) = (self.term(l, over)?, self.term(r, over)?);
                match op {
                    Connective::And => Term::And(Box::new(l), Box::new(r)),
                    Connective::Or => or(l, r),
                    Connective::Implies => or(not(l), r),
                    Connective::Iff => Term::Iff(Box::new(l), Box::new(r)),
                }
            }
            Kind::Always(b, of) => always(bound(b), self.term(of, over)?),
            Kind::Eventually(b, of) => eventually(bound(b), self.term(of, over)?),
            Kind::Next(of) => Term::Next(self.boxed(of, over)?),
            Kind::Until(b, l, r) => Term::Until(bound(b), self.boxed(l, over)?, self.boxed(r, over)?),
            Kind::Scope(Scope::Whenever, x, body) => {
                let (x, body) = (self.term(x, over)?, self.term(body, over)?);
                always(Bound::ALL, or(not(x), body))
            }
            Kind::Scope(scope, x, body) => self.scope(*scope, x, body, over)?,
            Kind::AfterUntil(x, y, body) => {
                let (x, y) = (self.opening(x, over)?, self.opening(y, over)?);
                Term::AfterUntil { x, y, body: self.body(body, over)? }
            }
            _ => return None,
        })
    }

    fn boxed(&mut self, f: &Expr, over: Over) -> Option<Box<Term>> {
        self.term(f, over).map(Box::new)
    }

    fn scope(&mut self, scope: Scope, x: &Expr, body: &Expr, over: Over) -> Option<Term> {
        let comes = if scope == Scope::Until { Some(self.boxed(x, over)?) } else { None };
        let x = self.opening(x, over)?;
        let body = self.body(body, over)?;
        Some(match (scope, comes) {
            (Scope::Until, Some(comes)) => Term::UntilScope { x, comes, body },
            (Scope::Before, _) => Term::Before { x, body },
            (Scope::While, _) => Term::While { x, body },
            _ => Term::After { x, body },
        })
    }

    /// What opens or closes a scope. Among truth values it has to be known where: a future formula does not tell.
    fn opening(&mut self, x: &Expr, over: Over) -> Option<Box<Term>> {
        if over == Over::Truth && x.has_future() { None } else { self.boxed(x, Over::Truth) }
    }

    /// The body of a scope: `always`, where it has no future operator.
    fn body(&mut self, body: &Expr, over: Over) -> Option<Box<Term>> {
        let term = self.term(body, over)?;
        Some(Box::new(if body.has_future() { term } else { always(Bound::ALL, term) }))
    }

    /// A formula without future operators, as a column.
    fn state(&mut self, f: &Expr, over: Over) -> Term {
        let column = match over {
            Over::Margins => {
                let quantity = self.quantity(f);
                self.column(Column::Margin(quantity))
            }
            Over::Truth => self.truth(f),
        };
        Term::Column(column)
    }

    /// The column of the truth of a formula without future operators.
    fn truth(&mut self, f: &Expr) -> usize {
        let bit = self.lowering.formula(f);
        self.column(Column::Truth(bit))
    }

    /// The column, or the equal one that is there already.
    fn column(&mut self, column: Column) -> usize {
        let columns = &mut self.plan.columns;
        columns.iter().position(|c| *c == column).unwrap_or_else(|| {
            columns.push(column);
            columns.len() - 1
        })
    }

    /// The step of code, or the equal one that is there already.
    fn op(&mut self, op: Op) -> Reg {
        let ops = &mut self.plan.ops;
        let found = ops.iter().position(|o| *o == op);
        found.unwrap_or_else(|| {
            ops.push(op);
            ops.len() - 1
        }) as Reg
    }

    fn implies(&mut self, l: Reg, r: Reg) -> Reg {
        let not_l = self.op(Op::Not(l));
        self.op(Op::Or(not_l, r))
    }

    /// A formula without future operators, as code.
    fn quantity(&mut self, e: &Expr) -> Reg {
        let op = match &e.kind {
            Kind::Compare { op, margin, left, right } => {
                let margin = margin.as_ref().map(|m| self.lowering.expr(m));
                let (left, right) = (self.lowering.expr(left), self.lowering.expr(right));
                Op::Distance { op: compare(*op), margin, left, right, holds: self.lowering.expr(e) }
            }
            Kind::Not(of) => Op::Not(self.quantity(of)),
            Kind::Connective(op, l, r) => {
                let (l, r) = (self.quantity(l), self.quantity(r));
                match op {
                    Connective::And => Op::And(l, r),
                    Connective::Or => Op::Or(l, r),
                    Connective::Implies => return self.implies(l, r),
                    Connective::Iff => Op::And(self.implies(l, r), self.implies(r, l)),
                }
            }
            Kind::Lookback(of, 0) => return self.quantity(of),
            Kind::Lookback(of, depth) => Op::Lookback(self.quantity(of), *depth),
            Kind::Previously(of) => Op::Previously(self.quantity(of)),
            Kind::Becomes(of) => Op::Becomes(self.quantity(of)),
            Kind::Once(b, of) => Op::Once(bound(b), self.quantity(of)),
            Kind::Historically(b, of) => {
                let of = self.quantity(of);
                let fails = self.op(Op::Not(of));
                let once = self.op(Op::Once(bound(b), fails));
                Op::Not(once)
            }
            Kind::Since(b, l, r) => Op::Since(bound(b), self.quantity(l), self.quantity(r)),
            Kind::Held(duration, of) => Op::Held(*duration, self.quantity(of)),
            _ => Op::Holds(self.lowering.expr(e)),
        };
        self.op(op)
    }
}
