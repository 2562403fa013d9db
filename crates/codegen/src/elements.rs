//! What is said of an element of an array.

use lapwing_check::checked::{self, Arith, Connective, Func, Kind};
use lapwing_engine::program::Compare;
use lapwing_stream::Type;

use crate::code::{Expr, Helper, call, local};
use crate::value::compare;

/// What is said of an element, called `x`, where it depends on nothing else.
pub(crate) fn of_element(e: &checked::Expr) -> Option<Expr> {
    Some(match &e.kind {
        Kind::Num(x) => Expr::Float(*x),
        Kind::Bool(b) => Expr::Bool(*b),
        Kind::Var(0) => local("x"),
        Kind::Neg(of) => Expr::Neg(Box::new(of_element(of)?)),
        Kind::Arith(op, l, r) => {
            let (l, r) = (of_element(l)?, of_element(r)?);
            match op {
                Arith::Add => l + r,
                Arith::Sub => l - r,
                Arith::Mul => l.mul(r),
                Arith::Div => l.div(r),
            }
        }
        Kind::Compare { op, margin, left, right } => {
            // An element is a number; of a truth value or a text it is not known whether it is one.
            let is_number = |e: &checked::Expr| matches!((&e.kind, &e.ty), (Kind::Var(0), _) | (_, Type::Num { .. }));
            if !is_number(left) || !is_number(right) {
                return None;
            }
            let margin = match margin {
                Some(margin) => Some(of_element(margin)?),
                None => None,
            };
            compare(operator(*op), of_element(left)?, of_element(right)?, margin)
        }
        Kind::Call(Func::Abs, args) => call(Helper::Abs, vec![of_element(args.first()?)?]),
        Kind::Not(of) => !of_element(of)?,
        Kind::Connective(op, l, r) => {
            let (l, r) = (of_element(l)?, of_element(r)?);
            match op {
                Connective::And => l & r,
                Connective::Or => l | r,
                Connective::Implies => !l | r,
                Connective::Iff => l.same(r),
            }
        }
        _ => return None,
    })
}

fn operator(op: checked::Compare) -> Compare {
    match op {
        checked::Compare::Eq => Compare::Eq,
        checked::Compare::Ne => Compare::Ne,
        checked::Compare::Lt => Compare::Lt,
        checked::Compare::Le => Compare::Le,
        checked::Compare::Gt => Compare::Gt,
        checked::Compare::Ge => Compare::Ge,
    }
}

/// What is said of any element, or of all, where it compares them with one value: the least or the greatest element tells.
pub(crate) fn by_extreme(is_all: bool, array: &checked::Expr, body: &checked::Expr) -> Option<Kind> {
    let Kind::Compare { op, margin, left, right } = &body.kind else { return None };
    if !margin.as_ref().is_none_or(|m| matches!(m.kind, Kind::Num(m) if m.is_finite())) {
        return None;
    }
    let is_left = left.kind == Kind::Var(0);
    let other = if is_left { right } else { left };
    if (!is_left && right.kind != Kind::Var(0)) || has_variable(other) {
        return None;
    }
    let is_below = match op {
        checked::Compare::Lt | checked::Compare::Le => is_left,
        checked::Compare::Gt | checked::Compare::Ge => !is_left,
        checked::Compare::Eq | checked::Compare::Ne => return None,
    };
    let func = if is_below == is_all { Func::MaxOf } else { Func::MinOf };
    let number = Type::Num { float: true };
    let extreme =
        checked::Expr { kind: Kind::Call(func, vec![array.clone()]), ty: number, dim: other.dim, span: array.span };
    let mut tells = body.clone();
    if let Kind::Compare { left, right, .. } = &mut tells.kind {
        **(if is_left { left } else { right }) = extreme.clone();
    }
    if !is_all {
        return Some(tells.kind);
    }
    // All of no elements are anything.
    let mut is_empty = body.clone();
    is_empty.kind = Kind::Call(Func::IsNan, vec![extreme]);
    Some(Kind::Connective(Connective::Or, Box::new(is_empty), Box::new(tells)))
}

fn has_variable(e: &checked::Expr) -> bool {
    matches!(e.kind, Kind::Var(_)) || e.children().into_iter().any(has_variable)
}
