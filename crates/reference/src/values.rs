//! Arithmetic, comparisons and functions of values (language reference, *Expressions*).
//!
//! [`Value::Missing`] is "no value": the field of an event that does not occur, an element that is not there. What is computed from
//! it is missing too, and every comparison with it is false. A value of the wrong kind is a [`Fault`].

use crate::world::{conjugate, turn};
use lapwing_check::checked::{Arith, Compare, Func};
use lapwing_stream::Value;
use std::f64::consts::PI;

/// Why an expression could not be computed: a value was not of the kind that it needs.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Fault(pub(crate) String);

pub(crate) type Computed<T> = Result<T, Fault>;

fn fault<T>(needed: &str, got: &Value) -> Computed<T> {
    Err(Fault(format!("{} stands where {needed} is needed", got.kind())))
}

/// The number, or `None` where there is no value.
pub(crate) fn number(v: &Value) -> Computed<Option<f64>> {
    match v {
        Value::Num(x) => Ok(Some(*x)),
        Value::Missing => Ok(None),
        other => fault("a number", other),
    }
}

/// The text, or `None` where there is no value.
fn text(v: &Value) -> Computed<Option<&str>> {
    match v {
        Value::Str(s) => Ok(Some(s)),
        Value::Missing => Ok(None),
        other => fault("a text", other),
    }
}

/// A condition: no value is false.
pub(crate) fn condition(v: &Value) -> Computed<bool> {
    match v {
        Value::Bool(b) => Ok(*b),
        Value::Missing => Ok(false),
        other => fault("a condition", other),
    }
}

/// A value of unknown type as a condition: a number is true when neither zero nor NaN.
pub(crate) fn truth(v: &Value) -> Computed<bool> {
    match v {
        Value::Num(x) => Ok(*x != 0.0 && !x.is_nan()),
        other => condition(other),
    }
}

/// The elements of an array, or `None` where there is no value.
pub(crate) fn elements(v: &Value) -> Computed<Option<Vec<Value>>> {
    match v {
        Value::Nums(list) => Ok(Some(list.iter().map(|x| Value::Num(*x)).collect())),
        Value::List(list) => Ok(Some(list.clone())),
        Value::Missing => Ok(None),
        other => fault("an array", other),
    }
}

/// `+ - * /`; a division by zero is infinite or NaN.
pub(crate) fn arithmetic(op: Arith, left: &Value, right: &Value) -> Computed<Value> {
    let (Some(a), Some(b)) = (number(left)?, number(right)?) else { return Ok(Value::Missing) };
    Ok(Value::Num(match op {
        Arith::Add => a + b,
        Arith::Sub => a - b,
        Arith::Mul => a * b,
        Arith::Div => a / b,
    }))
}

/// A comparison. Margins do not apply to texts and booleans.
pub(crate) fn compare(op: Compare, margin: &Value, left: &Value, right: &Value) -> Computed<bool> {
    match (left, right) {
        (Value::Missing, _) | (_, Value::Missing) => Ok(false),
        (Value::Num(a), Value::Num(b)) => Ok(number(margin)?.is_some_and(|m| compare_numbers(op, m, *a, *b))),
        _ if std::mem::discriminant(left) != std::mem::discriminant(right) => {
            Err(Fault(format!("{} is compared with {}", left.kind(), right.kind())))
        }
        _ => match op {
            Compare::Eq => Ok(left == right),
            Compare::Ne => Ok(left != right),
            _ => fault("a number", left),
        },
    }
}

/// NaN makes every comparison false but `!=`; equal infinities are equal, whatever the margin.
pub(crate) fn compare_numbers(op: Compare, m: f64, a: f64, b: f64) -> bool {
    let same_infinity = a.is_infinite() && a == b;
    match op {
        Compare::Eq => same_infinity || (a - b).abs() <= m,
        Compare::Ne => !compare_numbers(Compare::Eq, m, a, b),
        Compare::Lt => a < b + m,
        Compare::Le => same_infinity || a <= b + m,
        Compare::Gt => a > b - m,
        Compare::Ge => same_infinity || a >= b - m,
    }
}

/// What stands where an element is absent: NaN among numbers, else nothing.
pub(crate) fn absent(of_numbers: bool) -> Value {
    if of_numbers { Value::Num(f64::NAN) } else { Value::Missing }
}

/// `array[at]`
pub(crate) fn index(array: &Value, at: usize, of_numbers: bool) -> Computed<Value> {
    let of_numbers = of_numbers || matches!(array, Value::Nums(_));
    let list = elements(array)?;
    Ok(list.map_or(Value::Missing, |list| list.get(at).cloned().unwrap_or(absent(of_numbers))))
}

/// A function of values. `of_numbers` says that the result's type is a number.
pub(crate) fn call(func: Func, args: &[Value], of_numbers: bool) -> Computed<Value> {
    match func {
        Func::Len => len(&args[0]),
        Func::MinOf => fold_array(&args[0], f64::min),
        Func::MaxOf => fold_array(&args[0], f64::max),
        Func::Lookup => lookup(&args[0], &args[1], &args[2], of_numbers),
        Func::StartsWith => of_texts(args, |t, part| t.starts_with(part)),
        Func::EndsWith => of_texts(args, |t, part| t.ends_with(part)),
        Func::Contains => of_texts(args, |t, part| t.contains(part)),
        Func::IsNan => Ok(number(&args[0])?.map_or(Value::Missing, |x| Value::Bool(x.is_nan()))),
        _ => {
            let numbers: Option<Vec<f64>> = args.iter().map(number).collect::<Computed<_>>()?;
            Ok(numbers.map_or(Value::Missing, |x| Value::Num(of_numbers_only(func, &x))))
        }
    }
}

/// The functions that take numbers and give a number.
fn of_numbers_only(func: Func, x: &[f64]) -> f64 {
    match func {
        Func::Abs => x[0].abs(),
        Func::Sign if x[0] == 0.0 || x[0].is_nan() => x[0],
        Func::Sign => x[0].signum(),
        Func::Min => fold(x, f64::min),
        Func::Max => fold(x, f64::max),
        Func::Sqrt => libm::sqrt(x[0]),
        Func::Sin => libm::sin(x[0]),
        Func::Cos => libm::cos(x[0]),
        Func::Atan2 => libm::atan2(x[0], x[1]),
        Func::Norm => libm::sqrt(x.iter().fold(0.0, |sum, a| sum + a * a)),
        Func::Roll => roll(x[0], x[1], x[2], x[3]),
        Func::Pitch => pitch(x[0], x[1], x[2], x[3]),
        Func::Yaw => yaw(x[0], x[1], x[2], x[3]),
        Func::AngleDiff => wrap(x[0] - x[1]),
        Func::AngleBetween => angle_between([x[0], x[1], x[2], x[3]], [x[4], x[5], x[6], x[7]]),
        Func::IntoBody => {
            let turned = turn(conjugate([x[4], x[5], x[6], x[7]]), [x[1], x[2], x[3]]);
            turned.get(x[0] as usize).copied().unwrap_or(f64::NAN)
        }
        Func::Deg => x[0] * (180.0 / PI),
        Func::Rad => x[0] * (PI / 180.0),
        // Those that take anything else, which `call` has seen to.
        Func::IsNan | Func::Len | Func::MinOf | Func::MaxOf | Func::Lookup => f64::NAN,
        Func::StartsWith | Func::EndsWith | Func::Contains => f64::NAN,
    }
}

/// The least or the greatest of those that are not NaN; NaN where there is none.
pub(crate) fn fold(numbers: &[f64], pick: fn(f64, f64) -> f64) -> f64 {
    numbers.iter().copied().filter(|x| !x.is_nan()).reduce(pick).unwrap_or(f64::NAN)
}

fn fold_array(array: &Value, pick: fn(f64, f64) -> f64) -> Computed<Value> {
    let Some(list) = elements(array)? else { return Ok(Value::Missing) };
    let numbers: Vec<Option<f64>> = list.iter().map(number).collect::<Computed<_>>()?;
    Ok(Value::Num(fold(&numbers.into_iter().flatten().collect::<Vec<_>>(), pick)))
}

fn len(v: &Value) -> Computed<Value> {
    match v {
        Value::Str(s) => Ok(Value::Num(s.chars().count() as f64)),
        other => Ok(elements(other)?.map_or(Value::Missing, |list| Value::Num(list.len() as f64))),
    }
}

fn lookup(names: &Value, values: &Value, name: &Value, of_numbers: bool) -> Computed<Value> {
    let (Some(names), Some(_), Some(name)) = (elements(names)?, elements(values)?, text(name)?) else {
        return Ok(Value::Missing);
    };
    match names.iter().position(|n| matches!(n, Value::Str(s) if s == name)) {
        Some(at) => index(values, at, of_numbers),
        None => Ok(absent(of_numbers || matches!(values, Value::Nums(_)))),
    }
}

fn of_texts(args: &[Value], test: fn(&str, &str) -> bool) -> Computed<Value> {
    let (Some(a), Some(b)) = (text(&args[0])?, text(&args[1])?) else { return Ok(Value::Missing) };
    Ok(Value::Bool(test(a, b)))
}

fn roll(x: f64, y: f64, z: f64, w: f64) -> f64 {
    libm::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
}

fn pitch(x: f64, y: f64, z: f64, w: f64) -> f64 {
    libm::asin((2.0 * (w * y - z * x)).clamp(-1.0, 1.0))
}

fn yaw(x: f64, y: f64, z: f64, w: f64) -> f64 {
    libm::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
}

/// An angle brought into `(-π, π]`.
fn wrap(angle: f64) -> f64 {
    let r = libm::fmod(angle + PI, 2.0 * PI);
    if r <= 0.0 { r + 2.0 * PI - PI } else { r - PI }
}

fn angle_between(p: [f64; 4], q: [f64; 4]) -> f64 {
    let length = |q: [f64; 4]| libm::sqrt(q.iter().map(|x| x * x).sum());
    let dot: f64 = p.iter().zip(q).map(|(a, b)| a * b).sum();
    let cosine = (dot / (length(p) * length(q))).abs();
    2.0 * libm::acos(if cosine > 1.0 { 1.0 } else { cosine })
}

#[cfg(test)]
mod tests {
    use super::*;
    use Compare::{Eq, Ge, Gt, Le, Lt, Ne};

    const INF: f64 = f64::INFINITY;

    #[test]
    fn margins_widen_every_comparison() {
        let holds = |op, a, b| compare_numbers(op, 0.5, a, b);
        assert!(holds(Eq, 1.5, 1.0) && !holds(Eq, 1.625, 1.0));
        assert!(holds(Ne, 1.625, 1.0) && !holds(Ne, 1.5, 1.0));
        assert!(holds(Lt, 1.25, 1.0) && !holds(Lt, 1.5, 1.0) && holds(Le, 1.5, 1.0));
        assert!(holds(Gt, 0.75, 1.0) && !holds(Gt, 0.5, 1.0) && holds(Ge, 0.5, 1.0));
    }

    #[test]
    fn nan_is_only_unequal() {
        for op in [Eq, Lt, Le, Gt, Ge] {
            assert!(!compare_numbers(op, 0.1, f64::NAN, 1.0), "{op:?}");
        }
        assert!(compare_numbers(Ne, 0.1, f64::NAN, 1.0));
    }

    #[test]
    fn equal_infinities_are_equal() {
        assert!(compare_numbers(Eq, 0.0, INF, INF) && !compare_numbers(Ne, 0.5, -INF, -INF));
        assert!(compare_numbers(Le, INF, -INF, -INF) && compare_numbers(Ge, 0.0, INF, INF));
        assert!(!compare_numbers(Eq, 1.0, INF, -INF));
    }

    #[test]
    fn what_is_missing_compares_false_and_spreads() {
        let zero = Value::Num(0.0);
        for op in [Eq, Ne, Lt, Le, Gt, Ge] {
            assert_eq!(compare(op, &zero, &Value::Missing, &zero), Ok(false));
        }
        assert_eq!(arithmetic(Arith::Add, &Value::Missing, &zero), Ok(Value::Missing));
        assert_eq!(condition(&Value::Missing), Ok(false));
    }

    #[test]
    fn kinds_do_not_mix() {
        let (one, word) = (Value::Num(1.0), Value::from("one"));
        assert!(compare(Eq, &one, &one, &word).is_err());
        assert!(compare(Lt, &one, &word, &word).is_err());
        assert!(arithmetic(Arith::Mul, &one, &word).is_err());
        assert!(truth(&word).is_err());
        assert_eq!(compare(Eq, &one, &word, &word), Ok(true));
    }

    #[test]
    fn angles_wrap_into_the_half_open_circle() {
        assert_eq!(wrap(PI), PI);
        assert_eq!(wrap(-PI), PI);
        assert!((wrap(3.0 * PI / 2.0) + PI / 2.0).abs() < 1e-12);
        assert!((yaw(0.0, 0.0, 1.0, 0.0) - PI).abs() < 1e-12);
        assert_eq!(angle_between([0.0, 0.0, 0.0, 2.0], [0.0, 0.0, 0.0, -1.0]), 0.0);
    }

    #[test]
    fn arrays_skip_nan_and_absent_names_give_nan() {
        let numbers = Value::Nums(vec![f64::NAN, 3.0, -1.0]);
        assert_eq!(call(Func::MinOf, std::slice::from_ref(&numbers), true), Ok(Value::Num(-1.0)));
        assert_eq!(call(Func::MaxOf, &[Value::Nums(vec![])], true).map(|v| truth(&v)), Ok(Ok(false)));
        let names = Value::List(vec!["a".into(), "b".into()]);
        assert_eq!(call(Func::Lookup, &[names.clone(), numbers.clone(), "b".into()], true), Ok(Value::Num(3.0)));
        assert!(matches!(call(Func::Lookup, &[names, numbers, "z".into()], true), Ok(Value::Num(x)) if x.is_nan()));
        assert_eq!(call(Func::Min, &[Value::Num(f64::NAN), Value::Num(2.0)], true), Ok(Value::Num(2.0)));
        assert_eq!(call(Func::Len, &["añb".into()], true), Ok(Value::Num(3.0)));
    }
}
