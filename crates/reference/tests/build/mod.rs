//! Specifications and traces built by hand, for tests that do not want to depend on the parser.
#![allow(dead_code)]

use lapwing_check::checked::*;
use lapwing_diag::Span;
use lapwing_reference::{Arrival, Outcome, Trace, evaluate};
use lapwing_stream::{Duration, Time, Type, Value};

pub const MS: i64 = 1_000_000;
pub const S: i64 = 1_000_000_000;

fn expr(kind: Kind, ty: Type) -> Expr {
    Expr { kind, ty, dim: Dim(None), span: Span::default() }
}

pub fn boolean(kind: Kind) -> Expr {
    expr(kind, Type::Bool)
}

pub fn numeric(kind: Kind) -> Expr {
    expr(kind, Type::Num { float: true })
}

// Atoms. Columns 0 to 3 are the booleans p, q, r, s; column 4 is the number x.

pub fn p() -> Expr {
    boolean(Kind::Input(0))
}
pub fn q() -> Expr {
    boolean(Kind::Input(1))
}
pub fn r() -> Expr {
    boolean(Kind::Input(2))
}
pub fn s() -> Expr {
    boolean(Kind::Input(3))
}
pub fn x() -> Expr {
    numeric(Kind::Input(4))
}
pub fn num(n: f64) -> Expr {
    numeric(Kind::Num(n))
}
pub fn event(n: usize) -> Expr {
    boolean(Kind::Event(n))
}
pub fn field(event: usize, field: usize) -> Expr {
    numeric(Kind::EventField { event, field })
}
pub fn age(topic: usize) -> Expr {
    numeric(Kind::Age(topic))
}

// Expressions.

pub fn not(e: Expr) -> Expr {
    boolean(Kind::Not(Box::new(e)))
}
fn connect(op: Connective, a: Expr, b: Expr) -> Expr {
    boolean(Kind::Connective(op, Box::new(a), Box::new(b)))
}
pub fn and(a: Expr, b: Expr) -> Expr {
    connect(Connective::And, a, b)
}
pub fn or(a: Expr, b: Expr) -> Expr {
    connect(Connective::Or, a, b)
}
pub fn implies(a: Expr, b: Expr) -> Expr {
    connect(Connective::Implies, a, b)
}
pub fn compare(op: Compare, a: Expr, b: Expr) -> Expr {
    boolean(Kind::Compare { op, margin: None, left: Box::new(a), right: Box::new(b) })
}
pub fn lookback(e: Expr, n: usize) -> Expr {
    let ty = e.ty.clone();
    expr(Kind::Lookback(Box::new(e), n), ty)
}
pub fn window(w: Window, e: Expr, d: i64) -> Expr {
    numeric(Kind::Window(w, Box::new(e), Duration::from_nanos(d)))
}

// Bounds, in nanoseconds.

pub fn within(d: i64) -> Bound {
    Bound { hi: Some(Duration::from_nanos(d)), ..Bound::ALL }
}
pub fn from_to(lo: i64, hi: i64) -> Bound {
    Bound { lo: Duration::from_nanos(lo), ..within(hi) }
}
pub fn open(bound: Bound) -> Bound {
    Bound { hi_closed: false, ..bound }
}

// Past operators.

pub fn previously(e: Expr) -> Expr {
    boolean(Kind::Previously(Box::new(e)))
}
pub fn becomes(e: Expr) -> Expr {
    boolean(Kind::Becomes(Box::new(e)))
}
pub fn once(b: Bound, e: Expr) -> Expr {
    boolean(Kind::Once(b, Box::new(e)))
}
pub fn historically(b: Bound, e: Expr) -> Expr {
    boolean(Kind::Historically(b, Box::new(e)))
}
pub fn since(b: Bound, a: Expr, c: Expr) -> Expr {
    boolean(Kind::Since(b, Box::new(a), Box::new(c)))
}
pub fn held(d: i64, e: Expr) -> Expr {
    boolean(Kind::Held(Duration::from_nanos(d), Box::new(e)))
}

// Future operators.

pub fn always(e: Expr) -> Expr {
    always_in(Bound::ALL, e)
}
pub fn always_in(b: Bound, e: Expr) -> Expr {
    boolean(Kind::Always(b, Box::new(e)))
}
pub fn never(e: Expr) -> Expr {
    always(not(e))
}
pub fn eventually(e: Expr) -> Expr {
    eventually_in(Bound::ALL, e)
}
pub fn eventually_in(b: Bound, e: Expr) -> Expr {
    boolean(Kind::Eventually(b, Box::new(e)))
}
pub fn next(e: Expr) -> Expr {
    boolean(Kind::Next(Box::new(e)))
}
pub fn until(a: Expr, c: Expr) -> Expr {
    until_in(Bound::ALL, a, c)
}
pub fn until_in(b: Bound, a: Expr, c: Expr) -> Expr {
    boolean(Kind::Until(b, Box::new(a), Box::new(c)))
}
fn scope(kind: Scope, e: Expr, f: Expr) -> Expr {
    boolean(Kind::Scope(kind, Box::new(e), Box::new(f)))
}
pub fn after(e: Expr, f: Expr) -> Expr {
    scope(Scope::After, e, f)
}
pub fn until_scope(e: Expr, f: Expr) -> Expr {
    scope(Scope::Until, e, f)
}
pub fn before(e: Expr, f: Expr) -> Expr {
    scope(Scope::Before, e, f)
}
pub fn while_(e: Expr, f: Expr) -> Expr {
    scope(Scope::While, e, f)
}
pub fn whenever(e: Expr, f: Expr) -> Expr {
    scope(Scope::Whenever, e, f)
}
pub fn after_until(e: Expr, y: Expr, f: Expr) -> Expr {
    boolean(Kind::AfterUntil(Box::new(e), Box::new(y), Box::new(f)))
}

// Specifications.

/// A specification of the columns p, q, r, s, x, without properties.
pub fn columns() -> Spec {
    let input = |n: usize, name: &str| Input {
        label: name.into(),
        source: InputSource::Column(n),
        ty: Type::Any,
        dim: Dim(None),
        default: None,
        stale: None,
    };
    let names = ["p", "q", "r", "s", "x"];
    Spec {
        columns: names.map(String::from).to_vec(),
        inputs: names.iter().enumerate().map(|(n, name)| input(n, name)).collect(),
        ..Spec::default()
    }
}

pub fn topic(name: &str) -> Topic {
    Topic { name: name.into(), type_name: None, fields: vec![], span: Span::default() }
}

pub fn named_event(name: &str) -> Event {
    Event { name: name.into(), source: EventSource::Named, fields: vec![], when: None }
}

/// A property that reads all inputs that its formula names.
pub fn property(formula: Expr) -> Property {
    let mut reads = Vec::new();
    collect_reads(&formula, 0, &mut reads);
    reads.sort();
    reads.dedup();
    Property {
        name: "it".into(),
        span: Span::default(),
        line: 1,
        text: String::new(),
        body: Body::Formula(formula),
        reads,
        machines: vec![],
        alphabet: None,
        slices: vec![],
        problem: None,
    }
}

fn collect_reads(e: &Expr, depth: usize, reads: &mut Vec<Read>) {
    match e.kind {
        Kind::Input(n) => reads.push(Read { what: ReadOf::Input(n), depth }),
        Kind::Age(n) | Kind::Fresh(n) | Kind::Frequency(n, _) => reads.push(Read { what: ReadOf::Topic(n), depth }),
        _ => {}
    }
    let deeper = match e.kind {
        Kind::Lookback(_, n) => n,
        Kind::Delta(_) | Kind::Rate(_) => 1,
        _ => 0,
    };
    e.children().into_iter().for_each(|c| collect_reads(c, depth + deeper, reads));
}

/// A property over events alone.
pub fn over(alphabet: &[usize], formula: Expr) -> Property {
    Property { alphabet: Some(alphabet.to_vec()), ..property(formula) }
}

// Traces.

/// A row at a time: the letters name the booleans that are true.
pub fn row(time: i64, letters: &str) -> (Time, Arrival) {
    let mut cells: Vec<Value> = ["p", "q", "r", "s"].map(|n| Value::Bool(letters.contains(n))).to_vec();
    cells.push(Value::Missing);
    (Time(time), Arrival::Row { cells })
}

/// A row that says only what x is.
pub fn row_x(time: i64, x: impl Into<Value>) -> (Time, Arrival) {
    (Time(time), Arrival::Row { cells: vec![Value::Missing, Value::Missing, Value::Missing, Value::Missing, x.into()] })
}

pub fn other(time: i64) -> (Time, Arrival) {
    (Time(time), Arrival::Other)
}

pub fn message(time: i64, topic: usize) -> (Time, Arrival) {
    (Time(time), Arrival::Message { topic, values: vec![] })
}

pub fn occurs(time: i64, event: usize) -> (Time, Arrival) {
    (Time(time), Arrival::Event { event, values: vec![] })
}

pub fn occurs_with(time: i64, event: usize, value: impl Into<Value>) -> (Time, Arrival) {
    (Time(time), Arrival::Event { event, values: vec![value.into()] })
}

pub fn trace(samples: Vec<(Time, Arrival)>) -> Trace {
    Trace { samples, ..Trace::default() }
}

/// Rows a second apart from 0 s on, blanks between them: `"p pq - q"`.
pub fn rows(text: &str) -> Trace {
    trace(text.split_whitespace().enumerate().map(|(n, letters)| row(n as i64 * S, letters)).collect())
}

// Results.

/// Verdict, obligations met/failed/open, and episodes as `began>failed..until xcount` in seconds.
pub fn summary(outcome: &Outcome) -> String {
    let t = |time: Time| time.0 as f64 / 1e9;
    let mut text = format!("{} {}/{}/{}", outcome.verdict, outcome.met, outcome.failed, outcome.open);
    for e in &outcome.episodes {
        text.push_str(&format!(" {}>{}..{} x{}", t(e.began), t(e.failed), t(e.until), e.count));
    }
    text
}

/// Evaluates the properties of a specification.
pub fn outcomes(mut spec: Spec, properties: Vec<Property>, trace: &Trace) -> Vec<Outcome> {
    spec.properties = properties;
    evaluate(&spec, trace)
}

/// Evaluates one formula over the columns.
pub fn on(formula: Expr, trace: &Trace) -> Outcome {
    outcomes(columns(), vec![property(formula)], trace).remove(0)
}

/// Checks one formula on rows a second apart.
#[track_caller]
pub fn check(formula: Expr, text: &str, expected: &str) {
    assert_eq!(summary(&on(formula, &rows(text))), expected, "on {text:?}");
}
