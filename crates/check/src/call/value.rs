//! Functions of numbers, texts and arrays.

use lapwing_diag::{Code, Diagnostic};
use lapwing_stream::Type;
use lapwing_syntax::ast::{self, ExprKind};

use crate::checked::{Dim, Expr, Func, Kind};
use crate::context::{Cx, Env, Var, poison};
use crate::expr::{is_float, plain};
use crate::messages::{self, Known};
use crate::place::describe;
use crate::term::{Term, angle};

use super::{Call, number};

/// `abs`
pub(super) fn same_dim(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let args = one(cx, env, call)?;
    let (float, dim) = (is_float(&args[0]), args[0].dim);
    Some(number(Func::Abs, args, float, dim, call.span))
}

/// `sign`, `sin`, `cos`
pub(super) fn plain_number(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let args = one(cx, env, call)?;
    let func = match call.name {
        "sign" => Func::Sign,
        "sin" => Func::Sin,
        _ => Func::Cos,
    };
    if func != Func::Sign {
        wants_angle(cx, env, &args[0]);
    }
    Some(number(func, args, func != Func::Sign, Dim::PLAIN, call.span))
}

/// `sqrt`
pub(super) fn sqrt(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let args = one(cx, env, call)?;
    let dim = args[0].dim.root();
    Some(number(Func::Sqrt, args, true, dim, call.span))
}

/// `deg`
pub(super) fn deg(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let args = one(cx, env, call)?;
    wants_angle(cx, env, &args[0]);
    Some(number(Func::Deg, args, true, Dim::UNKNOWN, call.span))
}

/// `rad`
pub(super) fn rad(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    Some(number(Func::Rad, one(cx, env, call)?, true, Dim::ANGLE, call.span))
}

/// `isnan`
pub(super) fn isnan(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let args = one(cx, env, call)?;
    Some(Term::Expr(plain(Kind::Call(Func::IsNan, args), Type::Bool, call.span)))
}

/// `atan2`
pub(super) fn atan2(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let args = two(cx, env, call)?;
    cx.agree(env, &args[0], &args[1], "the sides of one angle");
    Some(Term::Expr(angle(Func::Atan2, args, call.span)))
}

/// `angle_diff`
pub(super) fn angle_diff(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let args = two(cx, env, call)?;
    args.iter().for_each(|a| wants_angle(cx, env, a));
    Some(Term::Expr(angle(Func::AngleDiff, args, call.span)))
}

/// `min` and `max`, of numbers or of an array
pub(super) fn extreme(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let min = call.name == "min";
    let (of_numbers, of_array) = if min { (Func::Min, Func::MinOf) } else { (Func::Max, Func::MaxOf) };
    if let [arg] = call.args {
        let value = cx.lower(env, arg).value(cx, env);
        let dim = value.dim;
        return match &value.ty {
            Type::Array(inner) if !matches!(**inner, Type::Num { .. } | Type::Any) => {
                wrong_type(cx, env, &value, "an array of numbers");
                Some(Term::poison(call.span))
            }
            Type::Array(inner) => {
                let float = **inner == Type::Num { float: true };
                Some(number(of_array, vec![value], float, dim, call.span))
            }
            Type::Any => Some(number(of_array, vec![value], false, dim, call.span)),
            _ => {
                let value = Term::Expr(value).number(cx, env);
                let float = is_float(&value);
                Some(number(of_numbers, vec![value], float, dim, call.span))
            }
        };
    }
    if call.args.is_empty() {
        return None;
    }
    let args = cx.numbers(env, call.args);
    let dim = args.windows(2).fold(args[0].dim, |dim, pair| dim.or(cx.agree(env, &pair[0], &pair[1], "compared")));
    let float = args.iter().any(is_float);
    Some(number(of_numbers, args, float, dim, call.span))
}

/// `len`
pub(super) fn len(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [arg] = call.args else { return None };
    let value = cx.lower(env, arg).value(cx, env);
    if !matches!(value.ty, Type::Array(_) | Type::Str | Type::Any) {
        wrong_type(cx, env, &value, "an array or a text");
    }
    Some(number(Func::Len, vec![value], false, Dim::PLAIN, call.span))
}

/// `lookup`
pub(super) fn lookup(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [names, values, name] = call.args else { return None };
    let names = array(cx, env, names);
    let values = array(cx, env, values);
    let name = text(cx, env, name);
    let ty = match &values.ty {
        Type::Array(inner) => (**inner).clone(),
        _ => Type::Any,
    };
    let dim = values.dim;
    let kind = Kind::Call(Func::Lookup, vec![names, values, name]);
    Some(Term::Expr(Expr { kind, ty, dim, span: call.span }))
}

/// `starts_with`, `ends_with`, `contains`
pub(super) fn text_test(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [whole, part] = call.args else { return None };
    let func = match call.name {
        "starts_with" => Func::StartsWith,
        "ends_with" => Func::EndsWith,
        _ => Func::Contains,
    };
    let args = vec![text(cx, env, whole), text(cx, env, part)];
    Some(Term::Expr(plain(Kind::Call(func, args), Type::Bool, call.span)))
}

/// `any` and `all`
pub(super) fn quantified(cx: &mut Cx, env: &Env, call: &Call) -> Option<Term> {
    let [of, ast::Expr { kind: ExprKind::Lambda(var, body), .. }] = call.args else { return None };
    let array = array(cx, env, of);
    let (ty, message) = match &array.ty {
        Type::Array(inner) => ((**inner).clone(), message_of(inner)),
        _ => (Type::Any, None),
    };
    let mut inner = env.deeper();
    let known = Known { dim: array.dim, message };
    inner.vars.push(Var { name: var.name.clone(), level: cx.lambdas, ty, known });
    cx.lambdas += 1;
    let body = cx.formula_of(&inner, body);
    cx.lambdas -= 1;
    let kind = Kind::Quantified { all: call.name == "all", array: Box::new(array), body: Box::new(body) };
    Some(Term::Expr(plain(kind, Type::Bool, call.span)))
}

fn message_of(ty: &Type) -> Option<&'static str> {
    let Type::Message(schema) = ty else { return None };
    let (package, short) = schema.name.split_once('/')?;
    messages::known_type(Some(package), short)
}

fn one(cx: &mut Cx, env: &Env, call: &Call) -> Option<Vec<Expr>> {
    (call.args.len() == 1).then(|| cx.numbers(env, call.args))
}

fn two(cx: &mut Cx, env: &Env, call: &Call) -> Option<Vec<Expr>> {
    (call.args.len() == 2).then(|| cx.numbers(env, call.args))
}

fn array(cx: &mut Cx, env: &Env, arg: &ast::Expr) -> Expr {
    let value = cx.lower(env, arg).value(cx, env);
    if matches!(value.ty, Type::Array(_) | Type::Any) {
        return value;
    }
    wrong_type(cx, env, &value, "an array");
    poison(value.span)
}

fn text(cx: &mut Cx, env: &Env, arg: &ast::Expr) -> Expr {
    let value = cx.lower(env, arg).value(cx, env);
    if !matches!(value.ty, Type::Str | Type::Any) {
        wrong_type(cx, env, &value, "a text");
    }
    value
}

fn wrong_type(cx: &mut Cx, env: &Env, value: &Expr, wanted: &str) {
    let message = format!("{} stands where {wanted} is wanted", describe(&value.ty));
    let diagnostic = Diagnostic::new(Code::TypeMismatch, value.span, message).label(format!("{wanted} is wanted here"));
    cx.report(env, diagnostic);
}

fn wants_angle(cx: &mut Cx, env: &Env, arg: &Expr) {
    if arg.dim.fits(Dim::ANGLE) {
        return;
    }
    let message = format!("an angle is wanted, not {}", arg.dim.unit());
    let diagnostic =
        Diagnostic::new(Code::DimensionMismatch, arg.span, message).label(format!("in {}", arg.dim.unit()));
    cx.report(env, diagnostic);
}
