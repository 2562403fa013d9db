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
