//! Functions of what has been.

use lapwing_stream::Type;

use crate::checked::{Dim, Expr, Kind, Window};
use crate::context::{Cx, Env};
use crate::expr::is_float;
use crate::term::Term;

use super::Call;

/// `delta`
pub(super) fn delta(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [of] = call.args else { return None };
    let of = cx.lower(env, of).number(cx, env);
    let (ty, dim) = (Type::Num { float: is_float(&of) }, of.dim);
    Some(Term::Expr(Expr { kind: Kind::Delta(Box::new(of)), ty, dim, span: call.span }))
}

/// `rate`
pub(super) fn rate(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [of] = call.args else { return None };
    let of = cx.lower(env, of).number(cx, env);
    let dim = of.dim.per(Dim::TIME);
    Some(Term::Expr(Expr { kind: Kind::Rate(Box::new(of)), ty: Type::Num { float: true }, dim, span: call.span }))
}

/// `min_over`, `max_over`, `mean_over`, `count`
pub(super) fn window(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [of, duration] = call.args else { return None };
    let window = match call.name {
        "min_over" => Window::Min,
        "max_over" => Window::Max,
        "mean_over" => Window::Mean,
        _ => Window::Count,
    };
    let of = match window {
        Window::Count => cx.formula_of(env, of),
        _ => cx.lower(env, of).number(cx, env),
    };
    let (float, dim) = match window {
        Window::Count => (false, Dim::PLAIN),
        Window::Mean => (true, of.dim),
        Window::Min | Window::Max => (is_float(&of), of.dim),
    };
    let duration = cx.duration_of(env, duration).unwrap_or_default();
    let kind = Kind::Window(window, Box::new(of), duration);
    Some(Term::Expr(Expr { kind, ty: Type::Num { float }, dim, span: call.span }))
}
