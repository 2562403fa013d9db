//! Expressions and statements as text.

use super::Printer;
use crate::ast::{BinaryOp, Expr, ExprKind, Literal, Stmt, StmtKind};

/// An expression on one line.
pub(super) fn expr(expr: &Expr) -> String {
    let mut out = String::new();
    write(&mut out, expr, 0);
    out
}

/// What binds tighter than every operator with two operands.
const UNARY: u8 = 10;

/// Writes an expression, in brackets where it binds less tightly than its surroundings ask for.
fn write(out: &mut String, expr: &Expr, at_least: u8) {
    match &expr.kind {
        ExprKind::Literal(literal) => write_literal(out, literal, at_least),
        ExprKind::Path(path) => out.push_str(&path.text()),
        ExprKind::Call(name, args) => {
            out.push_str(&name.text);
            out.push('(');
            write_list(out, args);
            out.push(')');
        }
        ExprKind::Unary(op, operand) => bracketed(out, UNARY < at_least, |out| {
            out.push_str(op.symbol());
            // `--x` would be read as something else by who knows C.
            let doubled = matches!(operand.kind, ExprKind::Unary(..)) || is_negative(operand);
            write(out, operand, if doubled { UNARY + 1 } else { UNARY });
        }),
        ExprKind::Binary(op, left, right) => bracketed(out, op.precedence() < at_least, |out| {
            write(out, left, left_at_least(*op, left));
            out.push_str(&format!(" {} ", op.symbol()));
            write(out, right, op.precedence() + 1);
        }),
    }
}

/// Comparisons are not chained; everything else groups from the left.
fn left_at_least(op: BinaryOp, left: &Expr) -> u8 {
    let compares = |op: BinaryOp| matches!(op.precedence(), 6 | 7);
    match left.kind {
        ExprKind::Binary(inner, ..) if compares(op) && compares(inner) => op.precedence() + 1,
        // `a && b || c` is right, and clearer with brackets.
        ExprKind::Binary(BinaryOp::And, ..) if op == BinaryOp::Or => UNARY,
        _ => op.precedence(),
    }
}

fn is_negative(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Literal(Literal::Int(value)) => *value < 0,
        ExprKind::Literal(Literal::Real(text)) => text.starts_with('-'),
        _ => false,
    }
}

fn bracketed(out: &mut String, brackets: bool, what: impl FnOnce(&mut String)) {
    if brackets {
        out.push('(');
    }
    what(out);
    if brackets {
        out.push(')');
    }
}

fn write_literal(out: &mut String, literal: &Literal, at_least: u8) {
    match literal {
        Literal::Bool(value) => out.push_str(if *value { "true" } else { "false" }),
        // Its absolute value is no number of the language.
        Literal::Int(i64::MIN) => {
            let brackets = at_least > BinaryOp::Subtract.precedence();
            bracketed(out, brackets, |out| out.push_str(&format!("{} - 1", i64::MIN + 1)));
        }
        Literal::Int(value) => bracketed(out, *value < 0 && at_least > UNARY, |out| out.push_str(&value.to_string())),
        Literal::Real(text) => {
            bracketed(out, text.starts_with('-') && at_least > UNARY, |out| out.push_str(text));
        }
        Literal::Text(text) => out.push_str(&text_literal(text)),
    }
}

fn write_list(out: &mut String, exprs: &[Expr]) {
    for (place, expr) in exprs.iter().enumerate() {
        if place > 0 {
            out.push_str(", ");
        }
        write(out, expr, 0);
    }
}

/// Several expressions, each as text.
pub(super) fn exprs(exprs: &[Expr]) -> Vec<String> {
    exprs.iter().map(expr).collect()
}

/// A text in quotation marks, with escapes where it needs them.
pub(super) fn text_literal(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            '\r' => out.push_str("\\r"),
            c if c.is_ascii_control() => out.push_str(&format!("\\{:03o}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

impl Printer {
    /// `do { … }`: on one line where it holds one short statement, or nothing.
    pub(super) fn block(&mut self, word: &str, body: &[Stmt]) {
        match body {
            [] => self.line(&format!("{word} {{}}")),
            [one] if simple(one).is_some_and(|s| s.len() < super::WIDTH / 2) => {
                self.line(&format!("{word} {{ {} }}", simple(one).unwrap_or_default()));
            }
            body => {
                self.line(&format!("{word} {{"));
                self.inside(|p| p.statements(body));
                self.line("}");
            }
        }
    }

    fn statements(&mut self, body: &[Stmt]) {
        for stmt in body {
            match (&stmt.kind, simple(stmt)) {
                (StmtKind::If(condition, then, otherwise), _) => self.choice(condition, then, otherwise),
                (_, text) => self.line(&text.unwrap_or_default()),
            }
        }
    }

    fn choice(&mut self, condition: &Expr, then: &[Stmt], otherwise: &[Stmt]) {
        self.line(&format!("if ({}) then", expr(condition)));
        self.inside(|p| p.statements(then));
        if !otherwise.is_empty() {
            self.line("else");
            self.inside(|p| p.statements(otherwise));
        }
        self.line("fi");
    }
}

/// A statement on one line; `None` of an `if`.
fn simple(stmt: &Stmt) -> Option<String> {
    match &stmt.kind {
        StmtKind::Assign(target, value) => Some(format!("{} = {};", target.text(), expr(value))),
        StmtKind::Rate(clock, value) => Some(format!("{}' = {};", clock.text, expr(value))),
        StmtKind::Call(name, args) => Some(format!("{}({});", name.text, exprs(args).join(", "))),
        StmtKind::If(..) => None,
    }
}
