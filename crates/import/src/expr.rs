//! Formulas, made from nothing: the tree of the syntax, without places.

use lapwing_diag::Span;
use lapwing_syntax::ast::{Binary, Expr, ExprKind, Ident, Infix, Number, Prefix};

pub(crate) fn node(kind: ExprKind) -> Expr {
    Expr { kind, span: Span::default(), parens: false }
}

pub(crate) fn ident(name: &str) -> Ident {
    Ident { name: name.to_owned(), span: Span::default() }
}

pub(crate) fn name(name: &str) -> Expr {
    path(&[name])
}

pub(crate) fn path(names: &[&str]) -> Expr {
    node(ExprKind::Path(names.iter().map(|n| ident(n)).collect()))
}

pub(crate) fn boolean(value: bool) -> Expr {
    node(ExprKind::Bool(value))
}

pub(crate) fn text(value: &str) -> Expr {
    node(ExprKind::Str(value.to_owned()))
}

/// A number as it is written: digits, and perhaps a point between some.
pub(crate) fn number(text: &str) -> Expr {
    let value = text.parse().unwrap_or_default();
    node(ExprKind::Number(Number { value, text: text.to_owned(), unit: None, span: Span::default() }))
}

pub(crate) fn not(of: Expr) -> Expr {
    match of.kind {
        ExprKind::Not(inner) => *inner,
        kind => node(ExprKind::Not(Box::new(node(kind)))),
    }
}

pub(crate) fn negative(of: Expr) -> Expr {
    node(ExprKind::Neg(Box::new(of)))
}

pub(crate) fn binary(operator: Binary, left: Expr, right: Expr) -> Expr {
    node(ExprKind::Binary(operator, Box::new(left), Box::new(right)))
}

pub(crate) fn and(left: Expr, right: Expr) -> Expr {
    binary(Binary::And, left, right)
}

pub(crate) fn prefix(prefix: Prefix, of: Expr) -> Expr {
    node(ExprKind::Prefix(prefix, None, Box::new(of)))
}

pub(crate) fn infix(infix: Infix, left: Expr, right: Expr) -> Expr {
    node(ExprKind::Infix(infix, None, Box::new(left), Box::new(right)))
}

pub(crate) fn ltl(of: Expr) -> Expr {
    node(ExprKind::Ltl(Box::new(of)))
}

/// Any of the names; `None` where there is none.
pub(crate) fn any(names: &[String]) -> Option<Expr> {
    names.iter().map(|n| name(n)).reduce(|all, one| binary(Binary::Or, all, one))
}

/// All of the conditions; `None` where there is none.
pub(crate) fn all(conditions: impl IntoIterator<Item = Expr>) -> Option<Expr> {
    conditions.into_iter().reduce(and)
}
