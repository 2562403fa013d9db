//! After warm-up a step does not allocate, whatever the specification, as long as nothing is violated.
//!
//! A failure is stored, which may allocate; so the trace here satisfies every property. And an obligation that stays open to the end
//! of the trace, such as that of a scope that may always open once more, is a run to be kept: here obligations end, or stay open side
//! by side.

use std::sync::Arc;

use allocation_counter::measure;
use lapwing_check::checked::{Spec, Step};
use lapwing_check::compile::compile;
use lapwing_check::{TraceShape, TraceTopic, check, load};
use lapwing_diag::SourceMap;
use lapwing_engine::{Ending, Program, State};
use lapwing_stream::{Field, Sample, Schema, Time, Type, Value, What};

/// After so many periods of the trace all buffers have their size: the longest bound is two seconds, a period half of one.
const WARM: usize = 12;
/// Over so many periods nothing is allocated.
const MEASURED: usize = 40;
/// Rows in a period; one every ten milliseconds.
const PERIOD: usize = 50;
const MS: i64 = 1_000_000;

/// What arrives, by name.
enum Arrival {
    Row(Vec<(&'static str, Value)>),
    Message(&'static str, Value),
    Event(&'static str, Vec<(&'static str, Value)>),
}

/// The k-th step of a trace that repeats itself: a row, and between it and the next what else there is.
fn step(k: usize) -> Vec<(i64, Arrival)> {
    let (at, n) = (k as i64 * 10 * MS, k % PERIOD);
    let flag = |name, is: bool| (name, Value::Bool(is));
    let x = 1.0 + (n % 9) as f64 / 10.0;
    let row = vec![
        flag("p", n == 0),
        flag("q", n == 20),
        flag("r", true),
        flag("s", (5..15).contains(&n)),
        flag("t", n == 10),
        ("x", Value::Num(x)),
        ("word", Value::from(["a", "a word of many more letters"][n % 2])),
    ];
    let mut all = vec![(at, Arrival::Row(row))];
    if n % 2 == 0 {
        all.push((at + MS, Arrival::Message("/m", Value::Num(x))));
    }
    if n % 5 == 0 {
        all.push((
            at + 2 * MS,
            Arrival::Message("/scan", Value::Nums((0..8 + n % 9).map(|i| 0.5 + i as f64).collect())),
        ));
        all.push((at + 3 * MS, Arrival::Message("/mode", Value::from(["auto", "automatic, more or less"][n / 5 % 2]))));
    }
    let robot = || ("robot", Value::from(["r1", "r2", "a robot with a long name"][n % 3]));
    if n % 10 == 3 {
        all.push((at + 4 * MS, Arrival::Event("kick", vec![("power", Value::Num(x)), robot()])));
        all.push((at + 5 * MS, Arrival::Event("drop", vec![robot()])));
    }
    if n % 10 == 7 {
        all.push((at + 4 * MS, Arrival::Event("tick", vec![])));
    }
    all
}

fn shape() -> TraceShape {
    let number = || Type::Num { float: true };
    let topic = |name: &str, full: &str, field: &str, ty: Type| {
        let fields = vec![Field { name: field.into(), ty }];
        let schema = Some(Arc::new(Schema { name: full.into(), fields, constants: vec![] }));
        TraceTopic { name: name.into(), type_name: full.into(), schema }
    };
    TraceShape {
        topics: vec![
            topic("/m", "std_msgs/Float64", "data", number()),
            topic("/scan", "sensor_msgs/LaserScan", "ranges", Type::Array(Box::new(number()))),
            topic("/mode", "std_msgs/String", "data", Type::Str),
        ],
        columns: ["p", "q", "r", "s", "t", "x", "word"].map(String::from).to_vec(),
        schemaless: true,
        events: ["kick", "drop", "tick"].map(String::from).to_vec(),
        ..TraceShape::default()
    }
}

const DECLARATIONS: &str = "decl m /m Float64.data\ndecl ranges /scan LaserScan.ranges\ndecl mode /mode String.data\n\
    event kick\nevent drop\nevent tick\n";

/// The checked specification of a text.
fn spec(text: &str) -> Spec {
    let mut sources = SourceMap::default();
    let text = format!("{DECLARATIONS}{text}\n");
    let file = sources.add("allocation.rv", text.clone());
    let parsed = lapwing_syntax::parse(file, &text);
    let loaded = load(&mut sources, parsed.file, &|_| None);
    let checked = check(&sources, &loaded, Some(&shape()));
    let found: Vec<_> = parsed.diagnostics.iter().chain(&checked.diagnostics).map(|d| &d.message).collect();
    assert!(!checked.has_errors() && !lapwing_diag::has_errors(&parsed.diagnostics), "{text}: {found:?}");
    checked.spec
}

/// A sample with values of its own.
struct Owned {
    time: i64,
    kind: Kind,
    values: Vec<Value>,
}

enum Kind {
    Row,
    Message(usize),
    Event(usize),
    Other,
}

impl Owned {
    /// What a specification gets of an arrival.
    fn of(time: i64, arrival: Arrival, spec: &Spec) -> Owned {
        let (kind, values) = match arrival {
            Arrival::Row(cells) => (Kind::Row, by_name(&spec.columns, &cells)),
            Arrival::Message(name, value) => match spec.topics.iter().position(|t| t.name == name) {
                Some(topic) => (Kind::Message(topic), vec![value; spec.topics[topic].fields.len()]),
                None => (Kind::Other, vec![]),
            },
            Arrival::Event(name, fields) => match spec.events.iter().position(|e| e.name == name) {
                Some(event) => {
                    let names: Vec<String> = spec.events[event].fields.iter().map(|f| first_name(&f.path)).collect();
                    (Kind::Event(event), by_name(&names, &fields))
                }
                None => (Kind::Other, vec![]),
            },
        };
        Owned { time, kind, values }
    }

    fn sample(&self) -> Sample<'_> {
        let values = &*self.values;
        let what = match self.kind {
            Kind::Row => What::Row { cells: values },
            Kind::Message(topic) => What::Message { topic, values },
            Kind::Event(event) => What::Event { event, values },
            Kind::Other => What::Other,
        };
        Sample { time: Time(self.time), what }
    }
}

/// The name that a path begins with.
fn first_name(path: &[Step]) -> String {
    match path.first() {
        Some(Step::Field(name)) => name.to_string(),
        _ => String::new(),
    }
}

fn by_name(wanted: &[String], cells: &[(&'static str, Value)]) -> Vec<Value> {
    let value = |name: &String| cells.iter().find(|(n, _)| n == name).map(|(_, v)| v.clone()).unwrap_or_default();
    wanted.iter().map(value).collect()
}

/// The steps of so many periods from the `from`-th on.
fn periods(spec: &Spec, from: usize, count: usize) -> Vec<Owned> {
    let steps = from * PERIOD..(from + count) * PERIOD;
    steps.flat_map(step).map(|(time, arrival)| Owned::of(time, arrival, spec)).collect()
}

fn feed(state: &mut State, program: &Program, samples: &[Owned]) {
    for sample in samples {
        state.feed(program, sample.sample(), &mut ());
        state.next_deadline(program);
    }
}

/// How often the steps after warm-up allocate; what the text says must hold, and start.
fn allocations(text: &str) -> u64 {
    let spec = spec(text);
    let program = compile(&spec);
    let (warm, measured) = (periods(&spec, 0, WARM), periods(&spec, WARM, MEASURED));
    let mut state = State::new(&program);
    feed(&mut state, &program, &warm);
    let found = measure(|| feed(&mut state, &program, &measured));
    for outcome in state.finish(&program, &Ending::default(), &mut ()) {
        assert!(outcome.failed == 0 && outcome.cause.is_none(), "{text}: {outcome:?}");
        assert!(!outcome.vacuous && outcome.positions > 0, "{text}: {outcome:?}");
    }
    found.count_total
}

/// None of the texts allocates.
fn none_of(texts: &[&str]) {
    let found: Vec<String> = texts
        .iter()
        .map(|text| (text, allocations(text)))
        .filter(|(_, count)| *count > 0)
        .map(|(text, count)| format!("{count} allocations in {} steps: {text}", MEASURED * PERIOD))
        .collect();
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

/// Each condition, in a property that holds whatever it is.
fn none_of_conditions(conditions: &[&str]) {
    let texts: Vec<String> = conditions.iter().map(|c| format!("always (({c}) or x > -100)")).collect();
    none_of(&texts.iter().map(String::as_str).collect::<Vec<_>>());
}

#[test]
fn the_counter_counts() {
    assert_eq!(measure(|| drop(std::hint::black_box(vec![1]))).count_total, 1);
}

#[test]
fn operators_over_the_past() {
    none_of_conditions(&[
        "previously p",
        "becomes p",
        "once p",
        "historically s",
        "p since q",
        "once within 100 ms p",
        "once within [20 ms, 100 ms] p",
        "once within (0 s, 50 ms] s",
        "once within [500 ms, 2 s] s",
        "historically within 100 ms s",
        "historically within [30 ms, 2 s] not p",
        "historically for 1 s (s or t)",
        "r since within 1 s q",
        "not s since within [100 ms, 1 s] q",
        "held for 50 ms s",
        "held for 0 s s",
        "previously previously becomes s",
        "once within 1 s (s since within 200 ms t)",
    ]);
}

#[test]
fn values_from_the_past() {
    none_of_conditions(&[
        "@{x, -3} > 1",
        "@{word, -2} == \"a\"",
        "@{mode, -1} == mode",
        "delta(x) > 0",
        "rate(x) > 0",
        "min_over(x, 1 s) > 1",
        "max_over(x, 1 s) > 1",
        "mean_over(x, 2 s) > 1",
        "count(s, 1 s) > 3",
        "delta(mean_over(x, 100 ms)) > 0",
        "min_over(delta(x), 500 ms) > 0",
    ]);
}

#[test]
fn texts_arrays_and_topics() {
    none_of_conditions(&[
        "word == \"a\"",
        "starts_with(mode, \"auto\") and contains(word, \"many\")",
        "min(ranges) > 0.1 and max(ranges) > 3 and len(ranges) > 2",
        "any(ranges, v => v > 1 and v < x)",
        "all(ranges, v => v > 0)",
        "@{min(ranges), -2} > 0.1",
        "ranges[3] > 1",
        "abs(x) + sqrt(x) * norm(x, m) > 1",
        "age(/m) > 0.015",
        "age(/scan) > 0.02 and age(/scan) < 0.04",
        "frequency(/m, 1 s) > 10",
        "fresh(/m)",
    ]);
}

#[test]
fn promises() {
    none_of(&[
        "whenever p, eventually q",
        "whenever p, eventually within 1 s q",
        "whenever p, eventually within [100 ms, 1 s] q",
        "whenever p, always within 50 ms x > 0",
        "whenever p, r until q",
        "whenever p, r until within 1 s q",
        "whenever p, next r",
        "whenever p, not (not r until q)",
        "whenever p, (eventually within 500 ms t and eventually within 500 ms q)",
        "whenever s, (eventually within 500 ms p or eventually within 1 s q)",
        "whenever p, eventually within 300 ms (t and eventually within 300 ms q)",
        "always (p implies eventually within (0 s, 1 s) q)",
        "always eventually p",
        "never always not p",
        "ltl([] (p => <> q))",
        "whenever held for 50 ms s, eventually within 1 s q",
    ]);
}

#[test]
fn scopes() {
    none_of(&[
        "after p, always r",
        "before q, r",
        "until q, r",
        "while s, r",
        "while s, eventually t",
        "after_until p, q, r",
        "after_until p, q, eventually t",
        "after_until p, q, (while s, eventually t)",
        "after_until p, q, (before t, r)",
        "after p, after_until p, q, whenever s, eventually within 500 ms (t or not s)",
        "whenever p, (before q, eventually t)",
        "whenever p, (until q, r)",
        "while not q, (while s, (r and eventually t))",
    ]);
}

/// Their obligations end soon: one that stays open keeps every position.
#[test]
fn formulas_that_are_replayed() {
    none_of(&[
        "whenever p, ((next r) until q)",
        "whenever p, (eventually within 300 ms q) until q",
        "while not q, (while (s and next s), r)",
    ]);
}

#[test]
fn machines_events_and_instances() {
    let machine = "machine m1 {\n initial rest\n state rest when not s\n state busy when s at most 1 s\n rest -> busy\n busy -> rest\n}\n";
    none_of(&[
        machine,
        &format!("{machine}whenever entered(m1.busy), eventually within 1 s left(m1.busy)"),
        &format!("{machine}always (m1 == busy implies x > 0)"),
        "whenever kick, kick.power < 5",
        "whenever kick, eventually within 100 ms drop",
        "property a over (kick, drop): always (kick implies next drop)",
        "property a over (kick, drop): for each k of kick.robot: always (kick implies next drop)",
        "for each k of kick.robot: whenever kick, eventually within 1 s drop",
        "event hit = message /m std_msgs/Float64 when data > 1\nwhenever hit, x > 0",
    ]);
}

#[test]
fn clocks() {
    none_of(&[
        "__rate__ = 30\nwhenever held for 50 ms s, eventually within 1 s (q or x > 0)",
        "__rate__ = 200\nalways (count(s, 1 s) > 2 or delta(x) > 0 or x > -100)",
        "__rate__ = 30\nwhenever kick, kick.power < 5",
        "__margin__ = 0.1\nwhenever age(/scan) > 0.02, eventually within 500 ms fresh(/scan)",
    ]);
}
