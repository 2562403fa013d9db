//! Statements: what may be written, and with what.

use super::names::{Access, Names, Symbol};
use super::{Check, Checker, constant::scaled};
use crate::ast::{self, ExprKind, StmtKind};
use crate::code::{Expr, FINE, Slot, Stmt};
use crate::value::Type;
use lapwing_diag::{Code, Diagnostic};

impl Checker<'_> {
    /// Statements in order; each that has a fault is reported.
    pub(super) fn body(&mut self, names: &Names, body: &[ast::Stmt]) -> Check<Vec<Stmt>> {
        let all: Vec<Check<Stmt>> = body.iter().map(|stmt| self.stmt(names, stmt)).collect();
        all.into_iter().collect()
    }

    fn stmt(&mut self, names: &Names, stmt: &ast::Stmt) -> Check<Stmt> {
        match &stmt.kind {
            StmtKind::Assign(target, value) => self.assign(names, target, value),
            StmtKind::Rate(clock, value) => self.rate(names, clock, value),
            StmtKind::Call(name, args) => self.call(names, name, args, stmt.span).map(Stmt::Call),
            StmtKind::If(condition, then, otherwise) => {
                let condition = self.bool(names, condition);
                let (then, otherwise) = (self.body(names, then), self.body(names, otherwise));
                Ok(Stmt::If(condition?, then?.into(), otherwise?.into()))
            }
        }
    }

    fn assign(&mut self, names: &Names, target: &ast::Path, value: &ast::Expr) -> Check<Stmt> {
        let text = target.text();
        match names.get(&text) {
            Some(Symbol::Clock { slot, unit }) => Ok(Stmt::Clock(slot, self.bound(names, value, unit)?)),
            Some(Symbol::Var { ty, slot, access: Access::Write }) => {
                Ok(store(ty, slot, self.expr_as(names, value, ty)?))
            }
            Some(Symbol::Var { access, .. }) => {
                let why = match access {
                    Access::Const => "it is declared as constant",
                    _ => "here it can only be read: `up` writes variables of the connector, `down` those of the ports",
                };
                let message = format!("`{text}` may not be written");
                Err(self.report(Diagnostic::new(Code::BipConst, target.span(), message).help(why)))
            }
            None if self.scope.constant(&text).is_some() => {
                self.fail(Code::BipConst, target.span(), format!("`{text}` is a constant"))
            }
            None => {
                let known: Vec<String> = names.all().map(str::to_owned).collect();
                self.unknown("variable", &text, target.span(), known.iter().map(String::as_str))
            }
        }
    }

    /// `x' = 2.0;`
    fn rate(&mut self, names: &Names, clock: &ast::Name, value: &ast::Expr) -> Check<Stmt> {
        let Some(Symbol::Clock { slot, .. }) = names.get(&clock.text) else {
            let message = format!("`{}` is no clock, and only clocks have a rate", clock.text);
            return self.fail(Code::BipClock, clock.span, message);
        };
        let exact = self.digits(value).and_then(|d| scaled(&d, 1));
        match exact.and_then(|e| i64::try_from(e).ok()).filter(|rate| (0..=1_000_000 * FINE as i64).contains(rate)) {
            Some(rate) => Ok(Stmt::Rate(slot, rate)),
            None => {
                let message = "the rate of a clock is a constant from 0 to 1000000";
                self.fail(Code::BipClock, value.span, message)
            }
        }
    }

    /// Whether an expression is a variable that may be written.
    pub(super) fn is_writable(&self, names: &Names, expr: &ast::Expr) -> bool {
        match &expr.kind {
            ExprKind::Path(path) => {
                matches!(names.get(&path.text()), Some(Symbol::Var { access: Access::Write, .. }))
            }
            _ => false,
        }
    }
}

/// A variable is given a value of its type.
pub(super) fn store(ty: Type, slot: Slot, value: Expr) -> Stmt {
    match (ty, value) {
        (_, Expr::Bool(value)) => Stmt::Bool(slot, value),
        (_, Expr::Int(value)) => Stmt::Int(slot, value),
        (_, Expr::Float(value)) => Stmt::Float(slot, value),
        (_, Expr::Object(_, value)) => Stmt::Object(slot, value),
    }
}
