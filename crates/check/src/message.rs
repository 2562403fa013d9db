//! Messages written out, as reactions publish them: each field by the definition of its message.

use std::sync::Arc;

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_stream::{Schema, Type, Value};
use lapwing_syntax::ast::{Expr, Ident, Literal, Topic, TypePath};

use crate::checked::{self, Dim};
use crate::constant::constant_value;
use crate::context::{Cx, Env};
use crate::definitions::Half;
use crate::messages::{self, Known};
use crate::place::{describe, field_type};
use crate::reaction::type_name;
use crate::trace::{TraceShape, is_type, plain_type};
use crate::world;
use lapwing_diag::suggest;

/// Reads and checks a message of the type `ty` that goes to a topic or a service.
pub(crate) fn read(
    cx: &mut Cx,
    env: &Env,
    to: &Topic,
    ty: &TypePath,
    half: Half,
    message: &Literal,
) -> checked::Message {
    if half == Half::Whole {
        same_type(cx, env, to, ty);
    }
    let schema = definition(cx, env, ty, half);
    let package = ty.package.as_ref().map(|p| p.name.as_str());
    let known = Known { dim: Dim::UNKNOWN, message: messages::known_type(package, &ty.name.name) };
    let full = schema.as_ref().and_then(|schema| half.of(&schema.name)).map(str::to_owned);
    let value = literal(cx, env, message, &schema.map_or(Type::Any, Type::Message), known);
    let written = type_name(ty);
    checked::Message { to: to.absolute(), type_name: full.unwrap_or_else(|| written.clone()), written, value }
}

/// A topic carries messages of one type.
fn same_type(cx: &mut Cx, env: &Env, to: &Topic, ty: &TypePath) {
    let Some(there) = cx.trace.and_then(|t| t.topic(&to.absolute())) else { return };
    let package = ty.package.as_ref().map(|p| p.name.as_str());
    if there.type_name.is_empty() || is_type(package, &ty.name.name, &there.type_name) {
        return;
    }
    let full = plain_type(&there.type_name);
    let here = cx.trace.map_or("", TraceShape::here);
    let message = format!("{} is a {full} {here}, not a {}", there.name, type_name(ty));
    let diagnostic = Diagnostic::new(Code::TopicType, ty.span, message).label("who listens there would not understand");
    cx.report(env, diagnostic.help(format!("write `{full}`, and the fields that this type has")));
}

/// The definition of a type: the trace's own, else one that is known without it.
fn definition(cx: &mut Cx, env: &Env, ty: &TypePath, half: Half) -> Option<Arc<Schema>> {
    let package = ty.package.as_ref().map(|p| p.name.as_str());
    if half == Half::Whole {
        let schemas = cx.trace.iter().flat_map(|t| &t.topics).filter_map(|t| t.schema.as_ref());
        let found = schemas.filter_map(|s| world::find_schema(s, &ty.name.name, 0));
        if let Some(schema) = found.into_iter().find(|s| is_type(package, &ty.name.name, &s.name)) {
            return Some(schema.clone());
        }
    }
    match cx.definitions.of(ty, half).as_slice() {
        [only] => Some((*only).clone()),
        [] => {
            // A package that is not known may come with a recording.
            if cx.trace.is_some() || package.is_some_and(|p| cx.definitions.knows_package(p)) {
                unknown_type(cx, env, ty, half);
            }
            None
        }
        several => {
            let names: Vec<String> = several.iter().map(|s| half.of(&s.name).unwrap_or(&s.name).to_owned()).collect();
            let message = format!("several packages have a message `{}`", ty.name.name);
            let diagnostic = Diagnostic::new(Code::UnknownType, ty.span, message)
                .label("its fields are not checked")
                .help(format!("write one of {}", suggest::listed(names.iter().map(String::as_str))));
            cx.report(env, diagnostic);
            None
        }
    }
}

fn unknown_type(cx: &mut Cx, env: &Env, ty: &TypePath, half: Half) {
    let name = type_name(ty);
    let guess = match ty.package {
        Some(_) => suggest::nearest(&name, cx.definitions.names(half)),
        None => suggest::nearest(&name, cx.definitions.names(half).filter_map(|full| full.rsplit('/').next())),
    };
    let message = format!("no definition of {name} is known{}", suggest::or_else(guess));
    let mut diagnostic = Diagnostic::new(Code::UnknownType, ty.span, message).label("its fields are not checked").help(
        "known are the common packages of ROS, those of --msgs DIR, and the types of the topics in the recording",
    );
    if let Some(guess) = guess {
        diagnostic = diagnostic.fix(ty.span, guess);
    }
    cx.report(env, diagnostic);
}

/// What is written, as a value. What is wrong has none.
fn literal(cx: &mut Cx, env: &Env, written: &Literal, ty: &Type, known: Known) -> Value {
    match (written, ty) {
        (Literal::Record(fields, _), Type::Message(_) | Type::Any) => record(cx, env, fields, ty, known),
        (Literal::List(values, _), Type::Array(inner)) => list(cx, env, values, inner, known),
        (Literal::List(values, _), Type::Any) => list(cx, env, values, &Type::Any, known),
        (Literal::Value(expr), _) => value(cx, env, expr, ty, known),
        (Literal::Record(_, span), _) => wrong(cx, env, *span, "a message", ty),
        (Literal::List(_, span), _) => wrong(cx, env, *span, "an array", ty),
    }
}

fn list(cx: &mut Cx, env: &Env, values: &[Literal], ty: &Type, known: Known) -> Value {
    Value::List(values.iter().map(|value| literal(cx, env, value, ty, known)).collect())
}

fn record(cx: &mut Cx, env: &Env, fields: &[(Ident, Literal)], ty: &Type, known: Known) -> Value {
    let mut read = Vec::new();
    for (index, (name, value)) in fields.iter().enumerate() {
        if let Some((first, _)) = fields[..index].iter().find(|(n, _)| n.name == name.name) {
            let diagnostic =
                Diagnostic::new(Code::DuplicateName, name.span, format!("the field `{}` is given twice", name.name))
                    .label("once more here")
                    .also(first.span, "first here");
            cx.report(env, diagnostic);
        }
        let inner = field_type(cx, env, ty, name).unwrap_or(Type::Any);
        let value = literal(cx, env, value, &inner, messages::field(known.message, known.dim, &name.name));
        read.push((name.name.as_str().into(), value));
    }
    Value::Record(read)
}

/// A single value. It must be known beforehand, since a reaction has no time to wait for it.
fn value(cx: &mut Cx, env: &Env, expr: &Expr, ty: &Type, known: Known) -> Value {
    let (lowered, found) = cx.aside(|cx| cx.lower(env, expr).value(cx, env));
    if found.failed {
        return Value::Missing;
    }
    let Some(value) = constant_value(&lowered) else {
        let message = "what a reaction publishes must be known beforehand";
        let diagnostic = Diagnostic::new(Code::NotConstant, expr.span, message)
            .label("this is not constant")
            .help("a number, a truth value, a text, or a name that stands for one");
        cx.report(env, diagnostic);
        return Value::Missing;
    };
    match (&value, ty) {
        (_, Type::Any) | (Value::Bool(_), Type::Bool) | (Value::Str(_), Type::Str) => {}
        (Value::Num(x), Type::Num { float: false }) if x.fract() != 0.0 => {
            let diagnostic = Diagnostic::new(Code::TypeMismatch, expr.span, "a whole number is wanted here");
            cx.report(env, diagnostic.label("the field holds whole numbers only"));
        }
        (Value::Num(_), Type::Num { .. }) => {}
        _ => return wrong(cx, env, expr.span, value.kind(), ty),
    }
    if !lowered.dim.fits(known.dim) {
        let (given, wanted) = (lowered.dim.unit(), known.dim.unit());
        let diagnostic =
            Diagnostic::new(Code::DimensionMismatch, expr.span, format!("{given} stands where {wanted} is wanted"));
        cx.report(env, diagnostic.label(format!("in {given}")));
    }
    value
}

fn wrong(cx: &mut Cx, env: &Env, span: Span, given: &str, ty: &Type) -> Value {
    let message = format!("{given} stands where {} is wanted", describe(ty));
    let mut diagnostic = Diagnostic::new(Code::TypeMismatch, span, message).label("does not go with the field's type");
    if let Type::Message(schema) = ty {
        let fields = schema.fields.iter().map(|f| format!("{}: …", f.name)).collect::<Vec<_>>().join(", ");
        diagnostic = diagnostic.help(format!("a message is written in curly brackets: `{{ {fields} }}`"));
    }
    cx.report(env, diagnostic);
    Value::Missing
}
