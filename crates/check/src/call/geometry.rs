//! Functions of vectors and rotations: they take a message with such parts, or the parts one by one.

use lapwing_syntax::ast;

use crate::checked::{Dim, Expr, Func};
use crate::context::{Cx, Env};
use crate::term::{Shape, Term, angle};
use crate::world::differences;

use super::Call;

/// `norm`
pub(super) fn norm(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let parts = match call.args {
        [] => return None,
        [vector] => {
            let term = cx.lower(env, vector);
            match term.is_scalar(cx) {
                true => vec![term.number(cx, env)],
                false => parts(cx, env, &term, Shape::Vector)?,
            }
        }
        numbers => cx.numbers(env, numbers),
    };
    same_dimension(cx, env, &parts);
    Some(Term::Expr(crate::world::norm(parts, call.span)))
}

/// `distance`
pub(super) fn distance(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let (left, right) = match call.args {
        [left, right] => {
            let (left, right) = (cx.lower(env, left), cx.lower(env, right));
            (parts(cx, env, &left, Shape::Vector)?, parts(cx, env, &right, Shape::Vector)?)
        }
        numbers if numbers.len() == 4 || numbers.len() == 6 => {
            let (left, right) = numbers.split_at(numbers.len() / 2);
            (cx.numbers(env, left), cx.numbers(env, right))
        }
        _ => return None,
    };
    for (l, r) in left.iter().zip(&right) {
        cx.agree(env, l, r, "subtracted");
    }
    Some(Term::Expr(crate::world::norm(differences(left, right, call.span), call.span)))
}

/// `roll`, `pitch`, `yaw`
pub(super) fn turn(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let func = match call.name {
        "roll" => Func::Roll,
        "pitch" => Func::Pitch,
        _ => Func::Yaw,
    };
    let quaternion = match call.args {
        [rotation] => rotation_of(cx, env, rotation)?,
        numbers if numbers.len() == 4 => cx.numbers(env, numbers),
        _ => return None,
    };
    Some(Term::Expr(angle(func, quaternion, call.span)))
}

/// `angle_between`
pub(super) fn angle_between(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let quaternions = match call.args {
        [left, right] => [rotation_of(cx, env, left)?, rotation_of(cx, env, right)?].concat(),
        numbers if numbers.len() == 8 => cx.numbers(env, numbers),
        _ => return None,
    };
    Some(Term::Expr(angle(Func::AngleBetween, quaternions, call.span)))
}

fn rotation_of(cx: &mut Cx, env: &Env, arg: &ast::Expr) -> Option<Vec<Expr>> {
    let term = cx.lower(env, arg);
    parts(cx, env, &term, Shape::Rotation)
}

/// The parts of an argument. Where it has none that has been reported, and anything goes.
fn parts(cx: &mut Cx, env: &Env, term: &Term, shape: Shape) -> Option<Vec<Expr>> {
    let poison = || shape.names().iter().map(|_| crate::context::poison(term.span())).collect();
    Some(term.parts(cx, env, shape).unwrap_or_else(poison))
}

fn same_dimension(cx: &mut Cx, env: &Env, parts: &[Expr]) {
    let first = parts.iter().find(|p| p.dim != Dim::UNKNOWN);
    if let Some(first) = first {
        parts.iter().for_each(|part| _ = cx.agree(env, first, part, "the parts of one vector"));
    }
}
