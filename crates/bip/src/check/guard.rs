//! Guards: which conditions on clocks there are, and that they come to one window.

use super::expr::comparison;
use super::names::{Names, Symbol};
use super::{Check, Checker, constant::scaled};
use crate::ast::{self, BinaryOp, ExprKind, UnaryOp};
use crate::code::{Bool, Bound, Cmp, Expr, Guard, Slot};
use lapwing_diag::{Code, Diagnostic, Span};

/// Whether a condition or its opposite is asked for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sense {
    Plain,
    Negated,
}

impl Sense {
    fn flipped(self) -> Sense {
        if self == Sense::Plain { Sense::Negated } else { Sense::Plain }
    }
}

impl Checker<'_> {
    pub(super) fn guard(&mut self, names: &Names, expr: &ast::Expr) -> Check<Guard> {
        self.sensed(names, expr, Sense::Plain)
    }

    fn sensed(&mut self, names: &Names, expr: &ast::Expr, sense: Sense) -> Check<Guard> {
        if !reads_clock(names, expr) {
            let condition = self.bool(names, expr)?;
            return Ok(Guard::Data(if sense == Sense::Plain { condition } else { Bool::Not(Box::new(condition)) }));
        }
        match &expr.kind {
            ExprKind::Unary(UnaryOp::Not, inner) => self.sensed(names, inner, sense.flipped()),
            ExprKind::Binary(op @ (BinaryOp::And | BinaryOp::Or), left, right) => {
                let is_and = (*op == BinaryOp::And) == (sense == Sense::Plain);
                if is_and { self.both(names, [left, right], sense) } else { self.either(names, [left, right], sense) }
            }
            ExprKind::Binary(op, left, right) => match comparison(*op) {
                Some(cmp) => {
                    let cmp = if sense == Sense::Plain { cmp } else { cmp.negated() };
                    self.clock_comparison(names, cmp, left, right, expr.span)
                }
                None => self.bad_clock(expr.span),
            },
            _ => self.bad_clock(expr.span),
        }
    }

    fn both(&mut self, names: &Names, sides: [&ast::Expr; 2], sense: Sense) -> Check<Guard> {
        let mut parts = Vec::new();
        for side in sides {
            match self.sensed(names, side, sense)? {
                Guard::And(more) => parts.extend(more),
                one => parts.push(one),
            }
        }
        // What is cheap to refute comes first.
        parts.sort_by_key(|part| !matches!(part, Guard::Data(_)));
        Ok(Guard::And(parts))
    }

    fn either(&mut self, names: &Names, sides: [&ast::Expr; 2], sense: Sense) -> Check<Guard> {
        let [left, right] = sides;
        let (left, right) = (self.sensed(names, left, sense), self.sensed(names, right, sense));
        match (left?, right?) {
            (Guard::Data(condition), clock) | (clock, Guard::Data(condition)) => {
                Ok(Guard::Or(condition, Box::new(clock)))
            }
            _ => self
                .two_windows(sides[0].span.to(sides[1].span), "of two conditions on clocks not just one can be asked"),
        }
    }

    fn two_windows<T>(&mut self, span: Span, message: &str) -> Check<T> {
        let diagnostic = Diagnostic::new(Code::BipTwoWindows, span, message);
        Err(self.report(diagnostic.help("write two transitions, one with each condition")))
    }

    fn bad_clock<T>(&mut self, span: Span) -> Check<T> {
        let message = "a clock is only compared with a number";
        let diagnostic = Diagnostic::new(Code::BipClock, span, message);
        Err(self.report(diagnostic.help("as in `x <= 5`, `x > 1.5 && ready`")))
    }

    fn clock_comparison(
        &mut self,
        names: &Names,
        cmp: Cmp,
        left: &ast::Expr,
        right: &ast::Expr,
        span: Span,
    ) -> Check<Guard> {
        let (clock, cmp, bound) = match (clock_of(names, left), clock_of(names, right)) {
            (Some(clock), None) if !reads_clock(names, right) => (clock, cmp, right),
            (None, Some(clock)) if !reads_clock(names, left) => (clock, cmp.mirrored(), left),
            _ => return self.bad_clock(span),
        };
        if cmp == Cmp::NotEqual {
            return self.two_windows(span, "a clock differs from a number both before and after a moment");
        }
        let (slot, unit) = clock;
        Ok(Guard::Clock { clock: slot, cmp, bound: self.bound(names, bound, unit)? })
    }

    /// A number of units of so many nanoseconds.
    pub(super) fn bound(&mut self, names: &Names, expr: &ast::Expr, unit: i64) -> Check<Bound> {
        let value = self.expr(names, expr)?;
        if let Some(digits) = self.digits(expr) {
            return match scaled(&digits, unit) {
                Some(exact) => Ok(Bound::Exact(exact)),
                None => self.fail(Code::BadNumber, expr.span, "this is beyond all time"),
            };
        }
        match value {
            Expr::Int(value) => Ok(Bound::Int(value, unit)),
            Expr::Float(value) => Ok(Bound::Float(value, unit)),
            other => {
                let message = format!("a clock is a number, and this is of type {}", self.shown(other.ty()));
                self.fail(Code::BipType, expr.span, message)
            }
        }
    }
}

/// The clock that an expression is, with the length of its unit.
fn clock_of(names: &Names, expr: &ast::Expr) -> Option<(Slot, i64)> {
    match &expr.kind {
        ExprKind::Path(path) => match names.get(&path.text())? {
            Symbol::Clock { slot, unit } => Some((slot, unit)),
            Symbol::Var { .. } => None,
        },
        _ => None,
    }
}

/// Whether a clock occurs in an expression.
fn reads_clock(names: &Names, expr: &ast::Expr) -> bool {
    match &expr.kind {
        ExprKind::Literal(_) => false,
        ExprKind::Path(_) => clock_of(names, expr).is_some(),
        ExprKind::Call(_, args) => args.iter().any(|a| reads_clock(names, a)),
        ExprKind::Unary(_, inner) => reads_clock(names, inner),
        ExprKind::Binary(_, left, right) => reads_clock(names, left) || reads_clock(names, right),
    }
}
