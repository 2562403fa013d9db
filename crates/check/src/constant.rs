//! What an expression is worth before anything has been seen.

use lapwing_stream::Value;

use crate::checked::{Arith, Dim, Expr, Func, Kind};
use crate::compile;

/// The number that an expression always is, by the engine's own arithmetic.
pub(crate) fn constant(expr: &Expr) -> Option<f64> {
    Some(match &expr.kind {
        Kind::Num(x) => *x,
        Kind::Neg(e) => -constant(e)?,
        Kind::Arith(op, l, r) => {
            let (l, r) = (constant(l)?, constant(r)?);
            match op {
                Arith::Add => l + r,
                Arith::Sub => l - r,
                Arith::Mul => l * r,
                Arith::Div => l / r,
            }
        }
        Kind::Call(func, args)
            if !matches!(func, Func::Len | Func::Lookup | Func::MinOf | Func::MaxOf | Func::IsNan) =>
        {
            let args: Option<Vec<_>> = args.iter().map(constant).collect();
            lapwing_engine::numeric(compile::func(*func), &args?)
        }
        _ => return None,
    })
}

/// The value that an expression always has.
pub(crate) fn constant_value(expr: &Expr) -> Option<Value> {
    match &expr.kind {
        Kind::Bool(b) => Some(Value::Bool(*b)),
        Kind::Str(s) => Some(Value::Str(s.clone())),
        _ => constant(expr).map(Value::Num),
    }
}

/// Whether a time was written in it with its unit: `2 * 1 s` is a time, `2 * 1` is not.
pub(crate) fn says_seconds(expr: &Expr) -> bool {
    expr.dim == Dim::TIME || expr.children().into_iter().any(says_seconds)
}
