//! World signals: positions, velocities, orientations and distances of the objects in the simulator's ground truth, and what a
//! robot's own belief differs from it.
//!
//! Every quantity is a formula over the parts of [`parts`]: where a part comes from, a topic or a column, is decided there alone.

mod belief;
mod parts;
mod source;

pub(crate) use belief::declare_models;
pub(crate) use source::{DEFAULT_TOPIC, declare_sources};

use std::sync::Arc;

use lapwing_diag::Span;
use lapwing_stream::{Schema, Type};
use lapwing_syntax::ast::Ident;

use crate::checked::{Arith, Dim, Expr, Func, Kind, Part};
use crate::context::{Cx, Env};
use crate::term::{Compound, Shape, Term, angle};

use parts::{quaternion, scalar_column, vector};

/// The quantities that an object can be asked for.
pub(crate) const QUANTITIES: &[&str] = &[
    "position",
    "position.x",
    "position.y",
    "position.z",
    "velocity",
    "velocity.x",
    "velocity.linear.x",
    "velocity.angular.z",
    "velocity.body.x",
    "orientation",
    "orientation.roll",
    "orientation.pitch",
    "orientation.yaw",
    "distance",
    "distanceZ",
    "orientation_between",
    "localization_error",
    "velocity_error",
    "believed.position",
];

const POSITION: [Part; 3] = [Part::PositionX, Part::PositionY, Part::PositionZ];
const LINEAR: [Part; 3] = [Part::LinearX, Part::LinearY, Part::LinearZ];
const ANGULAR: [Part; 3] = [Part::AngularX, Part::AngularY, Part::AngularZ];
const BODY_LINEAR: [Part; 3] = [Part::BodyLinearX, Part::BodyLinearY, Part::BodyLinearZ];
const BODY_ANGULAR: [Part; 3] = [Part::BodyAngularX, Part::BodyAngularY, Part::BodyAngularZ];

/// One use of a quantity: of what object, and where.
#[derive(Clone, Copy)]
struct Use<'u> {
    object: &'u str,
    label: &'u str,
    span: Span,
}

/// The quantity that a dotted name asks for; `None` where it asks for none, or the trace has not what it takes.
pub(crate) fn quantity(cx: &mut Cx, env: &Env, idents: &[Ident], span: Span) -> Option<Term> {
    let index = quantity_index(idents)?;
    // `odom.pose.pose.position` is a message that nobody has declared, and no object.
    let topic = format!("/{}", idents[0].name);
    if index > 1 && cx.trace.is_some_and(|t| t.topic(&topic).is_some()) {
        return None;
    }
    let joined = |idents: &[Ident]| idents.iter().map(|i| i.name.as_str()).collect::<Vec<_>>().join(".");
    let (object, label) = (joined(&idents[..index]), joined(idents));
    let of = Use { object: &object, label: &label, span };
    let rest: Vec<&str> = idents[index + 1..].iter().map(|i| i.name.as_str()).collect();
    match (idents[index].name.as_str(), rest.as_slice()) {
        ("position", rest) => linear(cx, env, of, POSITION, rest),
        ("velocity", rest) => velocity(cx, env, of, rest),
        ("orientation", rest) => orientation(cx, env, of, rest),
        ("distance", [_, ..]) => distance(cx, env, of, &rest.join("."), Extent::Flat),
        ("distanceZ", [_, ..]) => distance(cx, env, of, &rest.join("."), Extent::Spatial),
        ("orientation_between", [_, ..]) => between(cx, env, of, &rest.join(".")),
        ("localization_error", []) => belief::localization_error(cx, env, of),
        ("velocity_error", []) => belief::velocity_error(cx, env, of),
        ("believed", [_, ..]) => belief::believed(cx, env, of, &idents[index + 1..]),
        _ => None,
    }
}

/// Where the quantity stands in a dotted name.
fn quantity_index(idents: &[Ident]) -> Option<usize> {
    let is_quantity = |ident: &Ident| QUANTITIES.iter().any(|q| q.split('.').next() == Some(&ident.name));
    Some(idents.iter().skip(1).position(is_quantity)? + 1)
}

/// The dimension of a column that has the name of a quantity.
pub(crate) fn dim_of(idents: &[Ident]) -> Dim {
    let Some(index) = quantity_index(idents) else { return Dim::UNKNOWN };
    let turning = idents[index..].iter().any(|i| i.name == "angular");
    let component = idents.last().is_some_and(|i| Shape::Rotation.names().contains(&i.name.as_str()));
    match idents[index].name.as_str() {
        "velocity" if turning => Dim::TURNING,
        "velocity" | "velocity_error" => Dim::SPEED,
        "position" | "distance" | "distanceZ" | "localization_error" => Dim::LENGTH,
        "orientation" if component => Dim::PLAIN,
        "orientation" | "orientation_between" => Dim::ANGLE,
        _ => Dim::UNKNOWN,
    }
}

/// The columns that a quantity is computed from, in words.
pub(crate) fn parts_of(idents: &[Ident]) -> Option<String> {
    let index = quantity_index(idents)?;
    let joined = |idents: &[Ident]| idents.iter().map(|i| i.name.as_str()).collect::<Vec<_>>().join(".");
    let (object, rest) = (joined(&idents[..index]), &idents[index + 1..]);
    let other = joined(rest);
    Some(match idents[index].name.as_str() {
        "position" | "velocity" if rest.is_empty() => format!("`{0}.x`, `{0}.y`, `{0}.z`", joined(idents)),
        "distance" | "distanceZ" => format!("`{object}.position.x`, … and `{other}.position.x`, …"),
        "orientation" => format!("`{object}.orientation.x`, `.y`, `.z`, `.w`"),
        "localization_error" => format!("`{object}.position.x`, … and those of its model"),
        "velocity_error" => format!("`{object}.velocity.x`, …, `{object}.orientation` and those of its model"),
        _ => return None,
    })
}

/// Whether a distance has its third dimension.
#[derive(Clone, Copy, PartialEq)]
enum Extent {
    Flat,
    Spatial,
}

/// A vector: bare, or one part of it.
fn linear(cx: &mut Cx, env: &Env, of: Use, parts: [Part; 3], rest: &[&str]) -> Option<Term> {
    match rest {
        [] => {
            let parts = vector(cx, env, of, parts)?;
            let scalar = parts[0].dim.fits(Dim::SPEED).then(|| norm(parts.clone(), of.span));
            Some(compound(Shape::Vector, parts, scalar, of))
        }
        [name] => {
            let index = Shape::Vector.names().iter().position(|n| n == name)?;
            parts::part(cx, env, of, parts[index]).map(Term::Expr)
        }
        _ => None,
    }
}

fn velocity(cx: &mut Cx, env: &Env, of: Use, rest: &[&str]) -> Option<Term> {
    match rest {
        ["angular"] => {
            let parts = vector(cx, env, of, ANGULAR)?;
            let scalar = norm(parts.clone(), of.span);
            Some(compound(Shape::Vector, parts, Some(scalar), of))
        }
        ["angular", name] => linear(cx, env, of, ANGULAR, &[name]),
        ["body", "angular", rest @ ..] => in_body(cx, env, of, Motion::Angular, rest),
        ["body", "linear", rest @ ..] | ["body", rest @ ..] => in_body(cx, env, of, Motion::Linear, rest),
        ["linear", rest @ ..] | rest => linear(cx, env, of, LINEAR, rest),
    }
}

/// Which of an object's two velocities.
#[derive(Clone, Copy)]
enum Motion {
    Linear,
    Angular,
}

/// A velocity in the object's own frame.
fn in_body(cx: &mut Cx, env: &Env, of: Use, motion: Motion, rest: &[&str]) -> Option<Term> {
    let turned = body_parts(cx, env, of, motion)?;
    match rest {
        [] => {
            let scalar = norm(turned.clone(), of.span);
            Some(compound(Shape::Vector, turned, Some(scalar), of))
        }
        [name] => {
            let index = Shape::Vector.names().iter().position(|n| n == name)?;
            turned.get(index).cloned().map(Term::Expr)
        }
        _ => None,
    }
}

/// The three parts of a velocity in the object's own frame: those of its source, or those of columns, turned.
fn body_parts(cx: &mut Cx, env: &Env, of: Use, motion: Motion) -> Option<Vec<Expr>> {
    let (there, here) = match motion {
        Motion::Linear => (LINEAR, BODY_LINEAR),
        Motion::Angular => (ANGULAR, BODY_ANGULAR),
    };
    if let Some(parts) = parts::of_source(cx, env, of, here) {
        return Some(parts);
    }
    let world = vector(cx, env, of, there)?;
    let turn = quaternion(cx, env, of)?;
    let component = |index: usize| {
        let number = Expr { kind: Kind::Num(index as f64), ty: NUM, dim: Dim::PLAIN, span: of.span };
        let args = [vec![number], world.clone(), turn.clone()].concat();
        Expr { kind: Kind::Call(Func::IntoBody, args), ty: NUM, dim: world[0].dim, span: of.span }
    };
    Some((0..3).map(component).collect())
}

fn orientation(cx: &mut Cx, env: &Env, of: Use, rest: &[&str]) -> Option<Term> {
    if let ([] | ["yaw"], Some(yaw)) =
        (rest, scalar_column(cx, of, "orientation.yaw").or_else(|| scalar_column(cx, of, "orientation")))
    {
        let parts = quaternion(cx, env, of).unwrap_or_default();
        return Some(compound(Shape::Rotation, parts, Some(yaw), of));
    }
    let parts = match rest {
        [name @ ("x" | "y" | "z" | "w")] => {
            let index = Shape::Rotation.names().iter().position(|n| n == name)?;
            return quaternion(cx, env, of)?.get(index).cloned().map(Term::Expr);
        }
        _ => quaternion(cx, env, of)?,
    };
    let func = match rest {
        [] => {
            let yaw = angle(Func::Yaw, parts.clone(), of.span);
            return Some(compound(Shape::Rotation, parts, Some(yaw), of));
        }
        ["yaw"] => Func::Yaw,
        ["roll"] => Func::Roll,
        ["pitch"] => Func::Pitch,
        _ => return None,
    };
    Some(Term::Expr(angle(func, parts, of.span)))
}

fn distance(cx: &mut Cx, env: &Env, of: Use, other: &str, shape: Extent) -> Option<Term> {
    let count = if shape == Extent::Flat { 2 } else { 3 };
    let here = parts::first_parts(cx, env, of, &POSITION[..count])?;
    let there = parts::first_parts(cx, env, Use { object: other, ..of }, &POSITION[..count])?;
    Some(Term::Expr(norm(differences(here, there, of.span), of.span)))
}

fn between(cx: &mut Cx, env: &Env, of: Use, other: &str) -> Option<Term> {
    let here = quaternion(cx, env, of)?;
    let there = quaternion(cx, env, Use { object: other, ..of })?;
    Some(Term::Expr(angle(Func::AngleBetween, [here, there].concat(), of.span)))
}

const NUM: Type = Type::Num { float: true };

fn compound(shape: Shape, parts: Vec<Expr>, scalar: Option<Expr>, of: Use) -> Term {
    Term::Compound(Box::new(Compound { shape, parts, scalar, label: of.label.to_owned(), span: of.span }))
}

/// The length of a vector.
pub(crate) fn norm(parts: Vec<Expr>, span: Span) -> Expr {
    let dim = parts.iter().fold(Dim::UNKNOWN, |dim, p| dim.or(p.dim));
    Expr { kind: Kind::Call(Func::Norm, parts), ty: NUM, dim, span }
}

/// The differences of two vectors, part by part, as far as both go.
pub(crate) fn differences(left: Vec<Expr>, right: Vec<Expr>, span: Span) -> Vec<Expr> {
    let minus = |(l, r): (Expr, Expr)| {
        let dim = l.dim.or(r.dim);
        Expr { kind: Kind::Arith(Arith::Sub, Box::new(l), Box::new(r)), ty: NUM, dim, span }
    };
    left.into_iter().zip(right).map(minus).collect()
}

/// The definition of a message of that short name, inside `schema` or itself.
pub(crate) fn find_schema<'s>(schema: &'s Arc<Schema>, short: &str, depth: usize) -> Option<&'s Arc<Schema>> {
    if schema.name.rsplit(['/', '.']).next() == Some(short) {
        return Some(schema);
    }
    let inner = |ty: &'s Type| match ty {
        Type::Message(inner) => Some(inner),
        Type::Array(inner) => match &**inner {
            Type::Message(inner) => Some(inner),
            _ => None,
        },
        _ => None,
    };
    let deeper = schema.fields.iter().filter(|_| depth < 16).filter_map(|f| inner(&f.ty));
    deeper.into_iter().find_map(|inner| find_schema(inner, short, depth + 1))
}
