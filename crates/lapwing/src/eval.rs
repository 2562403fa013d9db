//! The value of an expression at one moment, for a report.
//!
//! It repeats nothing of the engine's but the combination of what the engine computes: functions and comparisons are its own. What
//! an operator over the past is worth is computed from the instants that are kept ([`memory`]): nothing is computed for it while all is well.

mod memory;

use lapwing_check::checked::{Arith, Compare, Connective, Expr, Func, Kind};
use lapwing_check::compile;
use lapwing_engine::{compare, numeric, program};
use lapwing_stream::Value;

pub(crate) use crate::moment::Moment;

/// The value of an expression; `None` where it has none or where it is not known.
pub(crate) fn eval(e: &Expr, at: &dyn Moment) -> Option<Value> {
    value(e, at, &[])
}

/// The truth of a condition.
pub(crate) fn condition(e: &Expr, at: &dyn Moment) -> Option<bool> {
    truth(&eval(e, at)?)
}

/// `vars` are the values of the variables of enclosing quantifiers, the innermost last.
fn value(e: &Expr, at: &dyn Moment, vars: &[Value]) -> Option<Value> {
    let num = |e: &Expr| number(e, at, vars);
    let cond = |e: &Expr| truth(&value(e, at, vars)?);
    match &e.kind {
        Kind::Num(x) => Some(Value::Num(*x)),
        Kind::Bool(b) => Some(Value::Bool(*b)),
        Kind::Str(s) => Some(Value::Str(s.clone())),
        Kind::Input(i) => Some(at.value(*i)).filter(|v| **v != Value::Missing).cloned(),
        Kind::Event(event) => Some(Value::Bool(at.event(*event).is_some())),
        Kind::EventField { event, field } => at.event(*event)?.get(*field).cloned(),
        Kind::InState { machine, state } => Some(Value::Bool(at.state(*machine) == *state)),
        Kind::Param(number) => at.param(*number).cloned(),
        Kind::Var(level) => vars.iter().rev().nth(*level).cloned(),
        Kind::Field(of, name) => value(of, at, vars)?.field(name).cloned(),
        Kind::Index(of, index) => element(value(of, at, vars)?, *index),
        Kind::Truth(of) => cond(of).map(Value::Bool),
        Kind::Neg(of) => num(of).map(|x| Value::Num(-x)),
        Kind::Not(of) => cond(of).map(|b| Value::Bool(!b)),
        Kind::Arith(op, l, r) => Some(Value::Num(arith(*op, num(l)?, num(r)?))),
        Kind::Compare { op, margin, left, right } => {
            comparison(*op, margin.as_deref(), left, right, at, vars).map(Value::Bool)
        }
        Kind::Connective(op, l, r) => connective(*op, cond(l), cond(r)).map(Value::Bool),
        Kind::Call(func, args) => call(*func, args, at, vars),
        Kind::Quantified { all, array, body } => quantified(*all, array, body, at, vars).map(Value::Bool),
        Kind::Age(topic) => Some(Value::Num(at.point()?.time.since(at.last(*topic)?).seconds())),
        Kind::Fresh(topic) => Some(Value::Bool(at.is_fresh(*topic))),
        Kind::Frequency(topic, window) => {
            let messages = at.messages_after(*topic, at.point()?.time - *window)?;
            Some(Value::Num(messages as f64 / window.seconds()))
        }
        _ => memory::value(e, &at.point()?, vars),
    }
}

fn truth(value: &Value) -> Option<bool> {
    match value {
        Value::Bool(b) => Some(*b),
        Value::Num(x) => Some(*x != 0.0 && !x.is_nan()),
        _ => None,
    }
}

fn number(e: &Expr, at: &dyn Moment, vars: &[Value]) -> Option<f64> {
    match value(e, at, vars)? {
        Value::Num(x) => Some(x),
        _ => None,
    }
}

fn element(value: Value, index: usize) -> Option<Value> {
    match value {
        Value::Nums(xs) => xs.get(index).copied().map(Value::Num),
        Value::List(xs) => xs.into_iter().nth(index),
        _ => None,
    }
}

fn arith(op: Arith, a: f64, b: f64) -> f64 {
    match op {
        Arith::Add => a + b,
        Arith::Sub => a - b,
        Arith::Mul => a * b,
        Arith::Div => a / b,
    }
}

fn connective(op: Connective, l: Option<bool>, r: Option<bool>) -> Option<bool> {
    match (op, l, r) {
        (Connective::And, Some(false), _) | (Connective::And, _, Some(false)) => Some(false),
        (Connective::Or, Some(true), _) | (Connective::Or, _, Some(true)) => Some(true),
        (Connective::Implies, Some(false), _) | (Connective::Implies, _, Some(true)) => Some(true),
        (Connective::And | Connective::Or, Some(_), Some(r)) => Some(r),
        (Connective::Implies, Some(true), Some(r)) => Some(r),
        (Connective::Iff, Some(l), Some(r)) => Some(l == r),
        _ => None,
    }
}

/// A comparison; with a field of an event that does not occur every one is false.
fn comparison(
    op: Compare,
    margin: Option<&Expr>,
    left: &Expr,
    right: &Expr,
    at: &dyn Moment,
    vars: &[Value],
) -> Option<bool> {
    if [left, right].into_iter().any(|e| waits_for_event(e, at)) {
        return Some(false);
    }
    let margin = margin.map_or(Some(0.0), |m| number(m, at, vars))?;
    match (value(left, at, vars)?, value(right, at, vars)?) {
        (Value::Num(a), Value::Num(b)) => Some(compare(compile::compare(op), a, b, margin)),
        (a, b) => match op {
            Compare::Eq => Some(a == b),
            Compare::Ne => Some(a != b),
            _ => None,
        },
    }
}

/// Whether an expression reads a field of an event that does not occur.
fn waits_for_event(e: &Expr, at: &dyn Moment) -> bool {
    match &e.kind {
        Kind::EventField { event, .. } => at.event(*event).is_none(),
        Kind::Neg(_) | Kind::Field(..) | Kind::Index(..) | Kind::Arith(..) | Kind::Call(..) => {
            e.children().into_iter().any(|c| waits_for_event(c, at))
        }
        _ => false,
    }
}

fn quantified(all: bool, array: &Expr, body: &Expr, at: &dyn Moment, vars: &[Value]) -> Option<bool> {
    let elements = match value(array, at, vars)? {
        Value::Nums(xs) => xs.into_iter().filter(|x| !x.is_nan()).map(Value::Num).collect(),
        Value::List(xs) => xs,
        _ => return None,
    };
    let mut scope = vars.to_vec();
    for element in elements {
        scope.push(element);
        let holds = truth(&value(body, at, &scope)?)?;
        scope.pop();
        if holds != all {
            return Some(!all);
        }
    }
    Some(all)
}

fn call(func: Func, args: &[Expr], at: &dyn Moment, vars: &[Value]) -> Option<Value> {
    if let Some(func) = engine_func(func) {
        let args = args.iter().map(|a| number(a, at, vars)).collect::<Option<Vec<_>>>()?;
        return Some(Value::Num(numeric(func, &args)));
    }
    let mut values = args.iter().map(|a| value(a, at, vars));
    match (func, values.next()??) {
        (Func::IsNan, Value::Num(x)) => Some(Value::Bool(x.is_nan())),
        (Func::Len, Value::Nums(xs)) => Some(Value::Num(xs.len() as f64)),
        (Func::Len, Value::List(xs)) => Some(Value::Num(xs.len() as f64)),
        (Func::Len, Value::Str(s)) => Some(Value::Num(s.chars().count() as f64)),
        (Func::MinOf, Value::Nums(xs)) => Some(Value::Num(numeric(program::Func::Min, &xs))),
        (Func::MaxOf, Value::Nums(xs)) => Some(Value::Num(numeric(program::Func::Max, &xs))),
        (Func::StartsWith | Func::EndsWith | Func::Contains, Value::Str(text)) => match values.next()?? {
            Value::Str(part) => Some(Value::Bool(match func {
                Func::StartsWith => text.starts_with(&part),
                Func::EndsWith => text.ends_with(&part),
                _ => text.contains(&part),
            })),
            _ => None,
        },
        (Func::Lookup, Value::List(names)) => {
            let (list, name) = (values.next()??, values.next()??);
            element(list, names.iter().position(|n| *n == name)?)
        }
        _ => None,
    }
}

/// The engine's function of numbers; `None` for one of other values.
fn engine_func(func: Func) -> Option<program::Func> {
    let of_others = matches!(
        func,
        Func::IsNan
            | Func::Len
            | Func::MinOf
            | Func::MaxOf
            | Func::Lookup
            | Func::StartsWith
            | Func::EndsWith
            | Func::Contains
    );
    (!of_others).then(|| compile::func(func))
}

#[cfg(test)]
mod tests;
