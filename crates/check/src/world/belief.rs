//! What a robot believes of itself, and how far that is from the truth.

use lapwing_diag::{Code, Diagnostic};
use lapwing_stream::Type;
use lapwing_syntax::ast::{Belief, Ident};

use crate::checked::Func;
use crate::context::{Cx, Env};
use crate::place::Place;
use crate::term::{Shape, Term, angle};

use super::{Motion, POSITION, Use, body_parts, compound, differences, norm, parts};

/// Reads the topics of all models, and checks the fields that they name.
pub(crate) fn declare_models(cx: &mut Cx) {
    let env = Env::default();
    for ((object, _), belief) in cx.names.beliefs.clone() {
        let label = format!("{object}.believed.{}", belief.quantity.name);
        let place = place(cx, &env, belief, label, belief.topic.span);
        if let Some(place) = place.filter(|_| cx.schemaless()) {
            place.declare_topic(cx, &belief.topic);
        }
    }
}

/// `X.believed.position`, and what is below it.
pub(super) fn believed(cx: &mut Cx, env: &Env, of: Use, rest: &[Ident]) -> Option<Term> {
    let (quantity, below) = rest.split_first()?;
    let Some(belief) = find(cx, env, of, &quantity.name) else { return unmodelled(cx, of) };
    let label = format!("{}.believed.{}", of.object, quantity.name);
    let Some(place) = place(cx, env, belief, label, of.span) else { return Some(Term::poison(of.span)) };
    if below.is_empty() && quantity.name != "position" && has_parts(&place) {
        return whole(cx, env, of, &quantity.name, place);
    }
    let term = Term::Place(Box::new(place));
    Some(below.iter().fold(term, |term, name| term.field(cx, env, name)).at(of.span))
}

/// The norm of the ground truth minus the modelled position.
pub(super) fn localization_error(cx: &mut Cx, env: &Env, of: Use) -> Option<Term> {
    let Some(belief) = find(cx, env, of, "position") else { return unmodelled(cx, of) };
    let truth = parts::vector(cx, env, of, POSITION)?;
    Some(error(cx, env, of, belief, truth))
}

/// The norm of the true velocity minus the modelled one, both in the robot's own frame.
pub(super) fn velocity_error(cx: &mut Cx, env: &Env, of: Use) -> Option<Term> {
    let Some(belief) = find(cx, env, of, "velocity") else { return unmodelled(cx, of) };
    let truth = body_parts(cx, env, of, Motion::Linear)?;
    Some(error(cx, env, of, belief, truth))
}

fn error(cx: &mut Cx, env: &Env, of: Use, belief: &Belief, truth: Vec<crate::checked::Expr>) -> Term {
    let label = format!("{}.believed.{}", of.object, belief.quantity.name);
    let believed = place(cx, env, belief, label, of.span).map(|p| linear_part(cx, env, p));
    let Some(believed) = believed.and_then(|p| Term::Place(Box::new(p)).parts(cx, env, Shape::Vector)) else {
        return Term::poison(of.span);
    };
    Term::Expr(norm(differences(truth, believed, of.span), of.span))
}

/// Without a model a column may still have the answer; where there are no columns that has been reported.
fn unmodelled(cx: &Cx, of: Use) -> Option<Term> {
    cx.has_schemas().then(|| Term::poison(of.span))
}

/// What the model says of a quantity. Nothing is said where a column could still have the answer.
fn find<'a>(cx: &mut Cx<'a>, env: &Env, of: Use, quantity: &str) -> Option<&'a Belief> {
    let key = (of.object, quantity);
    let found = cx.names.beliefs.iter().find(|(k, _)| **k == key).map(|(_, belief)| *belief);
    if found.is_none() && cx.has_schemas() {
        let message =
            format!("unknown name `{}`: nothing says what {} believes of its {quantity}", of.label, of.object);
        let example = match quantity {
            "velocity" => "velocity /odom Odometry.twist.twist.linear",
            _ => "position /odom Odometry.pose.pose.position",
        };
        let diagnostic = Diagnostic::new(Code::UnknownName, of.span, message)
            .label("no `model` declares it")
            .help(format!("say where it comes from: `model {}: {example} ;`", of.object));
        cx.report(env, diagnostic);
    }
    found
}

/// The place that a line of a model names.
fn place(cx: &mut Cx, env: &Env, belief: &Belief, label: String, span: lapwing_diag::Span) -> Option<Place> {
    let (root, ty, known) = cx.declared_root(env, &belief.topic, &belief.ty);
    let place = Place { root, path: Vec::new(), label: String::new(), ty, known, default: None, stale: None, span };
    let mut place = place.follow(cx, env, &belief.ty.path)?;
    place.label = label;
    Some(place)
}

/// A velocity may be modelled by a whole Twist.
fn linear_part(cx: &mut Cx, env: &Env, place: Place) -> Place {
    let is_twist = match &place.ty {
        Type::Message(schema) => schema.field("linear").is_some(),
        _ => place.known.message == Some("Twist"),
    };
    let linear = Ident { name: "linear".to_owned(), span: place.span };
    if is_twist { place.field(cx, env, &linear).unwrap_or(place) } else { place }
}

fn has_parts(place: &Place) -> bool {
    match &place.ty {
        Type::Message(_) => true,
        Type::Any => place.known.message.is_some(),
        _ => false,
    }
}

/// A believed velocity or orientation as a whole: its norm or its yaw where one number is wanted.
fn whole(cx: &mut Cx, env: &Env, of: Use, quantity: &str, place: Place) -> Option<Term> {
    let shape = if quantity == "orientation" { Shape::Rotation } else { Shape::Vector };
    let place = linear_part(cx, env, place);
    let Some(parts) = Term::Place(Box::new(place)).parts(cx, env, shape) else { return Some(Term::poison(of.span)) };
    let scalar = match shape {
        Shape::Rotation => angle(Func::Yaw, parts.clone(), of.span),
        Shape::Vector => norm(parts.clone(), of.span),
    };
    Some(compound(shape, parts, Some(scalar), of))
}
