//! The parts of an object's ground truth: from the columns of a trace that has them, else from the object's source.

use crate::checked::{Arith, Dim, Expr, Func, Input, InputSource, Kind, Part};
use crate::context::{Cx, Env};
use crate::term::Shape;

use super::{NUM, Use, source};

/// The three parts of a vector. In a trace of columns a missing `z` counts as zero where `x` is there.
pub(super) fn vector(cx: &mut Cx, env: &Env, of: Use, parts: [Part; 3]) -> Option<Vec<Expr>> {
    first_parts(cx, env, of, &parts)
}

/// The parts of a vector, or its first two.
pub(super) fn first_parts(cx: &mut Cx, env: &Env, of: Use, parts: &[Part]) -> Option<Vec<Expr>> {
    let mut found = Vec::new();
    for (index, &wanted) in parts.iter().enumerate() {
        let value = match part(cx, env, of, wanted) {
            Some(value) => value,
            None if index == 2 => {
                let mut zero = cx.assume_flat(env, &columns(of.object, wanted)[0], of.span);
                zero.dim = dim(wanted);
                zero
            }
            None => return None,
        };
        found.push(value);
    }
    Some(found)
}

/// One part.
pub(super) fn part(cx: &mut Cx, env: &Env, of: Use, part: Part) -> Option<Expr> {
    if let Some(found) = column_of(cx, of, part) {
        return Some(column(cx, &found, dim(part), of));
    }
    has_source(cx, of).then(|| delivered(cx, env, of, part))
}

/// The parts of a vector, where it is the object's source that says them all, and no column.
pub(super) fn of_source(cx: &mut Cx, env: &Env, of: Use, parts: [Part; 3]) -> Option<Vec<Expr>> {
    const OTHERS: [Part; 4] = [Part::LinearX, Part::AngularX, Part::QuaternionX, Part::QuaternionW];
    let is_told = has_source(cx, of) && OTHERS.into_iter().all(|other| column_of(cx, of, other).is_none());
    is_told.then(|| parts.into_iter().map(|part| delivered(cx, env, of, part)).collect())
}

/// The column of a trace that has a part.
fn column_of(cx: &Cx, of: Use, part: Part) -> Option<String> {
    let trace = cx.trace.filter(|trace| trace.schemaless)?;
    columns(of.object, part).into_iter().find(|name| trace.has_column(name))
}

/// Whether the object has a source, as far as that is known.
fn has_source(cx: &Cx, of: Use) -> bool {
    !cx.schemaless() || source::is_there(cx, of.object)
}

/// A part that the object's source delivers.
fn delivered(cx: &mut Cx, env: &Env, of: Use, part: Part) -> Expr {
    let object = source::object(cx, env, of.object, of.span);
    let source = InputSource::World { object, part };
    let label = columns(of.object, part).swap_remove(0);
    cx.input(Input { label, source, ty: NUM, dim: dim(part), default: None, stale: None }, of.span)
}

/// The quaternion of an object. Where a trace has only a column for the yaw, it is made from that.
pub(super) fn quaternion(cx: &mut Cx, env: &Env, of: Use) -> Option<Vec<Expr>> {
    const PARTS: [Part; 4] = [Part::QuaternionX, Part::QuaternionY, Part::QuaternionZ, Part::QuaternionW];
    let parts: Option<Vec<Expr>> = PARTS.into_iter().map(|p| part(cx, env, of, p)).collect();
    if parts.is_some() {
        return parts;
    }
    let yaw = scalar_column(cx, of, "orientation.yaw").or_else(|| scalar_column(cx, of, "orientation"))?;
    let number = |kind| Expr { kind, ty: NUM, dim: Dim::PLAIN, span: of.span };
    let half = number(Kind::Arith(Arith::Mul, Box::new(yaw), Box::new(number(Kind::Num(0.5)))));
    let zero = number(Kind::Num(0.0));
    let (sin, cos) = (Kind::Call(Func::Sin, vec![half.clone()]), Kind::Call(Func::Cos, vec![half]));
    Some(vec![zero.clone(), zero, number(sin), number(cos)])
}

/// The column of a trace that holds a quantity whole.
pub(super) fn scalar_column(cx: &mut Cx, of: Use, quantity: &str) -> Option<Expr> {
    let name = format!("{}.{quantity}", of.object);
    let there = cx.trace.is_some_and(|t| t.schemaless && t.has_column(&name));
    there.then(|| column(cx, &name, Dim::ANGLE, of))
}

fn column(cx: &mut Cx, name: &str, dim: Dim, of: Use) -> Expr {
    let source = InputSource::Column(cx.column(name));
    let input =
        Input { label: name.to_owned(), source, ty: lapwing_stream::Type::Any, dim, default: None, stale: None };
    cx.input(input, of.span)
}

/// The names that a column for a part may have; the first is what reports call it.
fn columns(object: &str, part: Part) -> Vec<String> {
    let (quantities, index): (&[&str], usize) = match part {
        Part::PositionX => (&["position"], 0),
        Part::PositionY => (&["position"], 1),
        Part::PositionZ => (&["position"], 2),
        Part::QuaternionX => (&["orientation"], 0),
        Part::QuaternionY => (&["orientation"], 1),
        Part::QuaternionZ => (&["orientation"], 2),
        Part::QuaternionW => (&["orientation"], 3),
        Part::LinearX => (&["velocity", "velocity.linear"], 0),
        Part::LinearY => (&["velocity", "velocity.linear"], 1),
        Part::LinearZ => (&["velocity", "velocity.linear"], 2),
        Part::AngularX => (&["velocity.angular"], 0),
        Part::AngularY => (&["velocity.angular"], 1),
        Part::AngularZ => (&["velocity.angular"], 2),
        Part::BodyLinearX => (&["velocity.body"], 0),
        Part::BodyLinearY => (&["velocity.body"], 1),
        Part::BodyLinearZ => (&["velocity.body"], 2),
        Part::BodyAngularX => (&["velocity.body.angular"], 0),
        Part::BodyAngularY => (&["velocity.body.angular"], 1),
        Part::BodyAngularZ => (&["velocity.body.angular"], 2),
    };
    let name = Shape::Rotation.names()[index];
    quantities.iter().map(|quantity| format!("{object}.{quantity}.{name}")).collect()
}

fn dim(part: Part) -> Dim {
    match part {
        Part::PositionX | Part::PositionY | Part::PositionZ => Dim::LENGTH,
        Part::QuaternionX | Part::QuaternionY | Part::QuaternionZ | Part::QuaternionW => Dim::PLAIN,
        Part::LinearX | Part::LinearY | Part::LinearZ => Dim::SPEED,
        Part::BodyLinearX | Part::BodyLinearY | Part::BodyLinearZ => Dim::SPEED,
        Part::AngularX | Part::AngularY | Part::AngularZ => Dim::TURNING,
        Part::BodyAngularX | Part::BodyAngularY | Part::BodyAngularZ => Dim::TURNING,
    }
}
