//! The value of an expression without memory, from the values of the signals at one moment: what a report shows.
//!
//! It repeats nothing of the engine's but the combination of what the engine computes: functions and comparisons are its own.

use lapwing_check::checked::{Arith, Compare, Connective, Expr, Func, Kind};
use lapwing_check::compile;
use lapwing_engine::{compare, numeric, program};
use lapwing_stream::Value;

/// The values of signals at one moment, by number.
pub(crate) trait Moment {
    /// The value of a signal, [`Value::Missing`] where it has none.
    fn value(&self, input: usize) -> &Value;
}

/// Whether [`eval`] can say what an expression is worth.
pub(crate) fn is_plain(e: &Expr) -> bool {
    let own = match &e.kind {
        Kind::Num(_) | Kind::Bool(_) | Kind::Str(_) | Kind::Input(_) => true,
        Kind::Field(..) | Kind::Index(..) | Kind::Truth(_) | Kind::Neg(_) | Kind::Not(_) => true,
        Kind::Arith(..) | Kind::Compare { .. } | Kind::Connective(..) => true,
        Kind::Call(func, _) => {
            engine_func(*func).is_some() || matches!(func, Func::Len | Func::MinOf | Func::MaxOf | Func::IsNan)
        }
        _ => false,
    };
    own && e.children().into_iter().all(is_plain)
}

/// The value of an expression; `None` where a signal in it has none, or where it is not plain.
pub(crate) fn eval(e: &Expr, at: &dyn Moment) -> Option<Value> {
    match &e.kind {
        Kind::Num(x) => Some(Value::Num(*x)),
        Kind::Bool(b) => Some(Value::Bool(*b)),
        Kind::Str(s) => Some(Value::Str(s.clone())),
        Kind::Input(i) => Some(at.value(*i)).filter(|v| **v != Value::Missing).cloned(),
        Kind::Field(of, name) => eval(of, at)?.field(name).cloned(),
        Kind::Index(of, index) => element(eval(of, at)?, *index),
        Kind::Truth(of) => truth(&eval(of, at)?).map(Value::Bool),
        Kind::Neg(of) => number(of, at).map(|x| Value::Num(-x)),
        Kind::Not(of) => condition(of, at).map(|b| Value::Bool(!b)),
        Kind::Arith(op, l, r) => Some(Value::Num(arith(*op, number(l, at)?, number(r, at)?))),
        Kind::Compare { op, margin, left, right } => {
            comparison(*op, margin.as_deref(), left, right, at).map(Value::Bool)
        }
        Kind::Connective(op, l, r) => connective(*op, condition(l, at), condition(r, at)).map(Value::Bool),
        Kind::Call(func, args) => call(*func, args, at),
        _ => None,
    }
}

/// The truth of a condition.
pub(crate) fn condition(e: &Expr, at: &dyn Moment) -> Option<bool> {
    truth(&eval(e, at)?)
}

fn truth(value: &Value) -> Option<bool> {
    match value {
        Value::Bool(b) => Some(*b),
        Value::Num(x) => Some(*x != 0.0 && !x.is_nan()),
        _ => None,
    }
}

fn number(e: &Expr, at: &dyn Moment) -> Option<f64> {
    match eval(e, at)? {
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

fn comparison(op: Compare, margin: Option<&Expr>, left: &Expr, right: &Expr, at: &dyn Moment) -> Option<bool> {
    let margin = margin.map_or(Some(0.0), |m| number(m, at))?;
    match (eval(left, at)?, eval(right, at)?) {
        (Value::Num(a), Value::Num(b)) => Some(compare(compile::compare(op), a, b, margin)),
        (a, b) => match op {
            Compare::Eq => Some(a == b),
            Compare::Ne => Some(a != b),
            _ => None,
        },
    }
}

fn call(func: Func, args: &[Expr], at: &dyn Moment) -> Option<Value> {
    if let Some(func) = engine_func(func) {
        let args = args.iter().map(|a| number(a, at)).collect::<Option<Vec<_>>>()?;
        return Some(Value::Num(numeric(func, &args)));
    }
    match (func, eval(args.first()?, at)?) {
        (Func::IsNan, Value::Num(x)) => Some(Value::Bool(x.is_nan())),
        (Func::Len, Value::Nums(xs)) => Some(Value::Num(xs.len() as f64)),
        (Func::Len, Value::List(xs)) => Some(Value::Num(xs.len() as f64)),
        (Func::Len, Value::Str(s)) => Some(Value::Num(s.chars().count() as f64)),
        (Func::MinOf, Value::Nums(xs)) => Some(Value::Num(numeric(program::Func::Min, &xs))),
        (Func::MaxOf, Value::Nums(xs)) => Some(Value::Num(numeric(program::Func::Max, &xs))),
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
mod tests {
    use super::*;
    use lapwing_check::checked::Body;

    struct Values(Vec<Value>);

    impl Moment for Values {
        fn value(&self, input: usize) -> &Value {
            self.0.get(input).unwrap_or(&Value::Missing)
        }
    }

    /// A condition over the columns `a` and `b`, which it names in this order.
    fn condition_of(text: &str) -> Expr {
        let spec = crate::Spec::parse("t.rv", &format!("never {text}\n"), &|_| None).unwrap();
        let columns = vec!["a".to_owned(), "b".to_owned()];
        let shape = lapwing_check::TraceShape { columns, schemaless: true, ..Default::default() };
        let Body::Formula(formula) = spec.against(&shape).spec.properties.remove(0).body else {
            panic!("{text} is no formula")
        };
        let Kind::Always(_, not) = formula.kind else { panic!("{text} is not judged always") };
        let Kind::Not(condition) = not.kind else { panic!("{text} is not negated") };
        *condition
    }

    #[test]
    fn conditions_are_true_false_or_unknown() {
        let at = Values(vec![Value::Num(3.0), Value::Num(-4.0)]);
        for text in [
            "a > 2 and b < 0",
            "norm(a, b) == 5",
            "a - abs(b) =={0.1} -1",
            "a < 0 implies b > 0",
            "not (a < b) iff a > b",
        ] {
            assert_eq!(condition(&condition_of(text), &at), Some(true), "{text}");
        }
        let unknown = Values(vec![Value::Num(3.0)]);
        assert_eq!(condition(&condition_of("a > 2 or a > b"), &unknown), Some(true));
        assert_eq!(condition(&condition_of("a > 2 and (a + 0 > 0 implies a > 0)"), &unknown), Some(true));
    }

    #[test]
    fn what_has_a_memory_is_not_plain() {
        assert!(is_plain(&condition_of("max(a, b) > 2")));
        assert!(!is_plain(&condition_of("delta(a) > b")));
        assert!(!is_plain(&condition_of("previously a > b")));
    }
}
