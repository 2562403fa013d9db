//! Small worlds, whole: every temporal operator with every bound up to 3, on all boolean traces up to a length.

use lapwing_check::checked::*;
use lapwing_diag::Span;
use lapwing_reference::{Arrival, Trace};
use lapwing_stream::{Duration, Time, Type, Value};

/// A second.
const SECOND: i64 = 1_000_000_000;

fn expr(kind: Kind) -> Expr {
    Expr { kind, ty: Type::Bool, dim: Dim::default(), span: Span::default() }
}

fn b(e: Expr) -> Box<Expr> {
    Box::new(e)
}

/// The signals p and q.
pub fn p() -> Expr {
    expr(Kind::Input(0))
}

/// See [`p`].
pub fn q() -> Expr {
    expr(Kind::Input(1))
}

/// All bounds with ends up to 3 s, open and closed, and no bound.
pub fn bounds() -> Vec<Bound> {
    let seconds = |n: i64| Duration::from_nanos(n * SECOND);
    let mut all = vec![Bound::ALL];
    for hi in 0..=3 {
        for lo in 0..=hi {
            for (lo_closed, hi_closed) in [(true, true), (true, false), (false, true), (false, false)] {
                all.push(Bound { lo: seconds(lo), lo_closed, hi: Some(seconds(hi)), hi_closed });
            }
        }
    }
    all
}

/// Every operator over p and q, with every bound where it takes one.
pub fn operators() -> Vec<Expr> {
    let mut all = Vec::new();
    for bound in bounds() {
        all.extend([
            expr(Kind::Always(bound, b(p()))),
            expr(Kind::Eventually(bound, b(p()))),
            expr(Kind::Until(bound, b(p()), b(q()))),
            expr(Kind::Once(bound, b(p()))),
            expr(Kind::Historically(bound, b(p()))),
            expr(Kind::Since(bound, b(p()), b(q()))),
        ]);
    }
    for seconds in 0..=3 {
        all.push(expr(Kind::Held(Duration::from_nanos(seconds * SECOND), b(p()))));
    }
    all.extend([expr(Kind::Next(b(p()))), expr(Kind::Previously(b(p()))), expr(Kind::Becomes(b(p())))]);
    for scope in [Scope::After, Scope::Until, Scope::Before, Scope::While, Scope::Whenever] {
        all.push(expr(Kind::Scope(scope, b(p()), b(q()))));
    }
    all.push(expr(Kind::AfterUntil(b(p()), b(q()), b(expr(Kind::Not(b(p())))))));
    all
}

/// Ways to stand around an operator: alone, negated, under `always` with a condition, in each scope, beside another.
pub fn around(f: Expr) -> Vec<Expr> {
    let implied = expr(Kind::Connective(Connective::Implies, b(q()), b(f.clone())));
    let mut all = vec![f.clone(), expr(Kind::Not(b(f.clone()))), expr(Kind::Always(Bound::ALL, b(implied)))];
    if f.has_future() {
        for scope in [Scope::After, Scope::Until, Scope::Before, Scope::While, Scope::Whenever] {
            all.push(expr(Kind::Scope(scope, b(q()), b(f.clone()))));
        }
        all.push(expr(Kind::AfterUntil(b(q()), b(p()), b(f.clone()))));
        all.push(expr(Kind::Connective(Connective::And, b(f.clone()), b(q()))));
        all.push(expr(Kind::Connective(Connective::Or, b(expr(Kind::Next(b(q())))), b(f.clone()))));
        all.push(expr(Kind::Eventually(Bound::ALL, b(f.clone()))));
        all.push(expr(Kind::Until(Bound::ALL, b(f.clone()), b(q()))));
        all.push(expr(Kind::Scope(Scope::Until, b(f), b(q()))));
    }
    all
}

/// A specification of one formula over p and q.
pub fn spec(formula: Expr) -> Spec {
    let input = |label: &str, column| Input {
        label: label.into(),
        source: InputSource::Column(column),
        ty: Type::Bool,
        dim: Dim::default(),
        default: None,
        stale: None,
    };
    let read = |i| Read { what: ReadOf::Input(i), depth: 0 };
    Spec {
        columns: vec!["p".into(), "q".into()],
        inputs: vec![input("p", 0), input("q", 1)],
        properties: vec![Property {
            name: "holds".into(),
            span: Span::default(),
            line: 1,
            text: String::new(),
            body: Body::Formula(formula),
            reads: vec![read(0), read(1)],
            machines: Vec::new(),
            alphabet: None,
            slices: Vec::new(),
            problem: None,
        }],
        ..Spec::default()
    }
}

/// All traces of p and q of a length, a row every second.
pub fn traces(length: usize) -> impl Iterator<Item = Trace> {
    (0..1u64 << (2 * length)).map(move |bits| trace(length, bits))
}

/// The trace whose values are the bits of a number.
pub fn trace(length: usize, bits: u64) -> Trace {
    let row = |i: usize| {
        let bit = |n: usize| Value::Bool(bits >> (2 * i + n) & 1 == 1);
        (Time(i as i64 * SECOND), Arrival::Row { cells: vec![bit(0), bit(1)] })
    };
    Trace { samples: (0..length).map(row).collect(), ..Trace::default() }
}

/// A formula in a few words, for messages.
pub fn show(e: &Expr) -> String {
    format!("{:?}", e.kind)
        .replace(", ty: Bool, dim: Dim(None), span: Span { file: FileId(0), start: 0, end: 0 }", "")
        .replace("Expr { kind: ", "")
}
