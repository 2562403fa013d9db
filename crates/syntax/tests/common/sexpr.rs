//! Trees as text with every grouping visible: `(and a (not b))`.

use lapwing_syntax::ast::{Bound, Dur, Expr, ExprKind, Ident, Number};

/// The tree of an expression, places and brackets aside.
pub fn sexpr(expr: &Expr) -> String {
    match &expr.kind {
        ExprKind::Number(number) => shown_number(number),
        ExprKind::Str(text) => format!("{text:?}"),
        ExprKind::Bool(value) => value.to_string(),
        ExprKind::Path(names) => path(names),
        ExprKind::Topic(topic) => format!("(topic {})", topic.name),
        ExprKind::Field(value, name) => format!("(. {} {})", sexpr(value), name.name),
        ExprKind::Index(value, index) => format!("(at {} {index})", sexpr(value)),
        ExprKind::Call(function, arguments) => list(&format!("call {}", function.name), arguments.iter()),
        ExprKind::Lambda(variable, body) => format!("(fn {} {})", variable.name, sexpr(body)),
        ExprKind::Lookback(value, depth) => format!("(@{depth} {})", sexpr(value)),
        ExprKind::Neg(value) => format!("(neg {})", sexpr(value)),
        ExprKind::Not(operand) => format!("(not {})", sexpr(operand)),
        ExprKind::Binary(operator, left, right) => list(&lower(operator), [&**left, right].into_iter()),
        ExprKind::WithMargin(operator, left, margin, right) => {
            list(&format!("{}{{{}}}", lower(operator), sexpr(margin)), [&**left, right].into_iter())
        }
        ExprKind::Prefix(prefix, bound, body) => list(&(lower(prefix) + &shown_bound(bound)), std::iter::once(&**body)),
        ExprKind::Infix(infix, bound, left, right) => {
            list(&(lower(infix) + &shown_bound(bound)), [&**left, right].into_iter())
        }
        ExprKind::Held(duration, operand) => format!("(held {} {})", dur(duration), sexpr(operand)),
        ExprKind::Scope(scope, trigger, body) => list(&lower(scope), [&**trigger, body].into_iter()),
        ExprKind::AfterUntil(opening, closing, body) => list("after_until", [&**opening, closing, body].into_iter()),
        ExprKind::Ltl(formula) => format!("(ltl {})", sexpr(formula)),
        ExprKind::Error => "error".to_owned(),
    }
}

fn list<'a>(head: &str, parts: impl Iterator<Item = &'a Expr>) -> String {
    let parts: String = parts.map(|part| format!(" {}", sexpr(part))).collect();
    format!("({head}{parts})")
}

fn lower(operator: &impl std::fmt::Debug) -> String {
    format!("{operator:?}").to_lowercase()
}

fn path(names: &[Ident]) -> String {
    names.iter().map(|name| name.name.as_str()).collect::<Vec<_>>().join(".")
}

fn shown_number(number: &Number) -> String {
    format!("{}{}", number.text, number.unit.map_or("", |unit| unit.name()))
}

/// A duration: a literal in nanoseconds.
pub fn dur(duration: &Dur) -> String {
    match duration {
        Dur::Literal(duration, _) => format!("{}ns", duration.nanos()),
        Dur::Name(name) => name.name.clone(),
    }
}

fn shown_bound(bound: &Option<Bound>) -> String {
    let Some(bound) = bound else { return String::new() };
    let (open, close) = (if bound.lo_closed { '[' } else { '(' }, if bound.hi_closed { ']' } else { ')' });
    format!("{open}{},{}{close}", bound.lo.as_ref().map_or("0".to_owned(), dur), dur(&bound.hi))
}
