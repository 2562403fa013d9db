//! Statements: assignments, calls, choices.

use super::{Parse, Parser};
use crate::ast::{Expr, ExprKind, Stmt, StmtKind};

impl Parser<'_> {
    /// `{ … }`, as after `do`, `up` and `down`.
    pub(super) fn block(&mut self) -> Parse<Vec<Stmt>> {
        self.require("{")?;
        let body = self.statements(&["}"])?;
        self.require("}")?;
        Ok(body)
    }

    fn statements(&mut self, ends: &[&str]) -> Parse<Vec<Stmt>> {
        let mut body = Vec::new();
        while !self.is_any(ends) && !self.at_end() {
            if !self.take(";") {
                body.push(self.nested(Self::statement)?);
            }
        }
        Ok(body)
    }

    fn statement(&mut self) -> Parse<Stmt> {
        let start = self.span();
        let kind = match self.peek(0) {
            "if" => self.choice()?,
            // The older `reset c` is `c = 0`.
            "reset" if !self.is_ahead(1, "=") && !self.is_ahead(1, "(") && !self.is_ahead(1, ".") => {
                self.advance();
                let clock = self.name("a clock")?;
                StmtKind::Assign(clock.into(), Expr::int(0))
            }
            _ => self.simple()?,
        };
        let span = start.to(self.last_span());
        if !matches!(kind, StmtKind::If(..)) {
            self.require(";")?;
        }
        Ok(Stmt { kind, span })
    }

    fn simple(&mut self) -> Parse<StmtKind> {
        let target = self.path("a statement")?;
        if self.take("'") {
            self.require("=")?;
            let Some(clock) = target.parts.into_iter().next_back() else { return self.missing("a clock") };
            return Ok(StmtKind::Rate(clock, self.expr()?));
        }
        if self.is("(") {
            let Some(name) = target.parts.into_iter().next_back() else { return self.missing("a function") };
            return Ok(StmtKind::Call(name, self.bracketed(Self::expr)?));
        }
        // The paper's figures write `:=`.
        self.take(":");
        if self.require("=").is_err() {
            return Err(super::Reported(()));
        }
        let value = self.expr()?;
        if let ExprKind::Path(path) = &value.kind
            && self.is("'")
        {
            let clock = path.text();
            return self.missing(&format!("`;`: the rate of `{clock}` is set and not read, and `;`"));
        }
        Ok(StmtKind::Assign(target, value))
    }

    fn choice(&mut self) -> Parse<StmtKind> {
        self.require("if")?;
        let condition = self.condition()?;
        self.require("then")?;
        let then = self.statements(&["else", "fi"])?;
        let otherwise = if self.take("else") { self.statements(&["fi"])? } else { Vec::new() };
        self.require("fi")?;
        Ok(StmtKind::If(condition, then, otherwise))
    }
}
