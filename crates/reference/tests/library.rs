//! The shipped patterns mean what they say: each is compared with its published formula, which stands above it, or with its words.

mod ltl;

use lapwing_check::checked::Spec;
use lapwing_check::{LIBRARIES, TraceShape, check, load};
use lapwing_diag::SourceMap;
use lapwing_reference::{Arrival, Trace, evaluate};
use lapwing_stream::{Time, Value};
use ltl::{Ltl, Row};

/// The seconds that every argument that is a duration stands for.
const WITHIN: i64 = 2;

/// A pattern: its name, parameters and formula.
struct Pattern {
    library: &'static str,
    name: &'static str,
    params: Vec<&'static str>,
    formula: Option<&'static str>,
    /// Whether it asks for the next instant: then the end of a trace leaves it unknown.
    asks_next: bool,
}

impl Pattern {
    fn conditions(&self) -> Vec<&'static str> {
        self.params.iter().copied().filter(|p| !is_duration(p)).collect()
    }

    /// A property that uses it, of columns with the names of its parameters.
    fn spec(&self) -> Spec {
        let arguments: Vec<String> =
            self.params.iter().map(|p| if is_duration(p) { format!("{WITHIN} s") } else { (*p).to_owned() }).collect();
        let text = format!("use {}\nproperty x: {}({})\n", self.library, self.name, arguments.join(", "));
        let mut sources = SourceMap::default();
        let file = sources.add("case.rv", text.clone());
        let loaded = load(&mut sources, lapwing_syntax::parse(file, &text).file, &|_| None);
        let columns = self.conditions().into_iter().map(str::to_owned).collect();
        let checked =
            check(&sources, &loaded, Some(&TraceShape { columns, schemaless: true, ..TraceShape::default() }));
        assert!(checked.diagnostics.is_empty(), "{}: {:?}", self.name, checked.diagnostics);
        checked.spec
    }
}

fn is_duration(param: &str) -> bool {
    ["d", "limit"].contains(&param)
}

/// The patterns of a library.
fn patterns(library: &'static str) -> Vec<Pattern> {
    let all = LIBRARIES.iter().filter(|l| l.name == library).flat_map(|l| l.patterns());
    let one = |pattern: lapwing_check::ShippedPattern| Pattern {
        library,
        name: pattern.name,
        params: pattern
            .call
            .trim_end_matches(')')
            .split_once('(')
            .map_or(Vec::new(), |(_, params)| params.split(", ").collect()),
        formula: pattern.formula,
        asks_next: pattern.body.iter().any(|line| line.contains("next ")),
    };
    all.map(one).collect()
}

/// Pseudo-random numbers: the same traces every time.
struct Rng(u64);

impl Rng {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn in_a_hundred(&mut self, share: u64) -> bool {
        self.next() % 100 < share
    }

    /// A trace of up to ten instants a second apart, and much later a last one. What is true is true for a while.
    fn trace(&mut self, width: usize, end: End) -> Vec<Row> {
        let length = 1 + self.next() % 9;
        let shares: Vec<(u64, u64)> = (0..width)
            .map(|_| ([10, 30, 50, 85][self.next() as usize % 4], [0, 0, 60][self.next() as usize % 3]))
            .collect();
        let mut rows: Vec<Row> = Vec::new();
        for time in (0..length as i64).chain([1000]) {
            let before = rows.last().map_or(vec![false; width], |row| row.props.clone());
            let one = |(&(share, sticks), before): (&(u64, u64), bool)| {
                if self.in_a_hundred(sticks) { before } else { self.in_a_hundred(share) }
            };
            let props: Vec<bool> = match end {
                End::Quiet if time == 1000 => vec![false; width],
                End::Same if time == 1000 => before,
                _ => shares.iter().zip(before).map(one).collect(),
            };
            rows.push(Row { time, props });
        }
        rows
    }
}

/// What the last instant of a trace is like.
#[derive(Clone, Copy)]
enum End {
    Any,
    /// Nothing is true, so that no formula asks for the instant after it.
    Quiet,
    /// Nothing begins, so that no entering of a place asks for the instant after it.
    Same,
}

/// Whether the pattern is satisfied on a trace.
fn succeeds(spec: &Spec, params: &[&str], rows: &[Row]) -> bool {
    let sample = |row: &Row| {
        let value =
            |column: &String| Value::Bool(params.iter().position(|p| p == column).is_some_and(|at| row.props[at]));
        (Time(row.time * 1_000_000_000), Arrival::Row { cells: spec.columns.iter().map(value).collect() })
    };
    let trace = Trace { samples: rows.iter().map(sample).collect(), ..Trace::default() };
    evaluate(spec, &trace)[0].verdict.is_success()
}

fn show(rows: &[Row]) -> String {
    rows.iter()
        .map(|r| format!("{:>5} {:?}\n", r.time, r.props.iter().map(|p| u8::from(*p)).collect::<Vec<_>>()))
        .collect()
}

/// Compares a pattern with what it should say, on many traces that come out both ways.
fn compare(pattern: &Pattern, end: End, holds: impl Fn(&[Row]) -> bool) {
    let (spec, params) = (pattern.spec(), pattern.conditions());
    let mut rng = Rng(0x9e37_79b9_7f4a_7c15);
    let mut both = [0, 0];
    for tried in 1..40_000 {
        let rows = rng.trace(params.len(), end);
        let (said, meant) = (succeeds(&spec, &params, &rows), holds(&rows));
        assert_eq!(said, meant, "{}({})\n{}", pattern.name, params.join(", "), show(&rows));
        both[usize::from(meant)] += 1;
        if tried > 400 && both.iter().all(|n| *n >= 5) {
            return;
        }
    }
    panic!("{}: it came out {both:?}", pattern.name);
}

#[test]
fn patterns_with_a_formula_mean_it() {
    let mut count = 0;
    for pattern in ["std.dwyer", "std.mission"].into_iter().flat_map(patterns) {
        // Those with bounds are looked at below, in all their scopes.
        let Some(formula) = pattern.formula.filter(|f| !f.contains("within")) else { continue };
        let end = match formula.contains(" o ") || formula.contains("(o ") {
            false => End::Any,
            true if pattern.library == "std.mission" && !pattern.asks_next => End::Same,
            true => End::Quiet,
        };
        let formula = Ltl::parse(formula, &pattern.conditions(), WITHIN);
        compare(&pattern, end, |rows| formula.holds(rows, 0));
        count += 1;
    }
    assert!(count > 85, "{count}");
}

/// The pieces of a trace in which a pattern is looked at.
fn scopes(name: &str, params: &[&str], rows: &[Row]) -> Vec<(usize, usize)> {
    let is = |prop: &str, k: usize| params.iter().position(|p| *p == prop).is_some_and(|at| rows[k].props[at]);
    let next = |prop: &str, from: usize| (from..rows.len()).find(|&k| is(prop, k));
    if name.ends_with("_before") {
        return next("r", 0).map(|r| (0, r)).into_iter().collect();
    }
    if name.ends_with("_after") {
        return next("q", 0).map(|q| (q, rows.len())).into_iter().collect();
    }
    if !name.ends_with("_between") && !name.ends_with("_after_until") {
        return vec![(0, rows.len())];
    }
    let (mut found, mut from) = (Vec::new(), 0);
    while let Some(q) = next("q", from) {
        let r = next("r", q);
        if r.is_some() || name.ends_with("_after_until") {
            found.push((q, r.unwrap_or(rows.len())));
        }
        from = r.map_or(rows.len(), |r| r + 1);
    }
    found
}

/// What the words of the real-time patterns demand of one piece.
fn in_time(name: &str, params: &[&str], rows: &[Row], (lo, hi): (usize, usize)) -> bool {
    let is = |prop: &str, k: usize| params.iter().position(|p| *p == prop).is_some_and(|at| rows[k].props[at]);
    let near = |k: usize, j: usize| rows[j].time - rows[k].time <= WITHIN;
    let begins = |k: usize| k > lo && is("p", k) && !is("p", k - 1);
    // Some instant of the piece lies further off than the bound, and up to it nothing changed.
    let lasts =
        |k: usize, value: bool| (k..hi).find(|&j| !near(k, j)).is_some_and(|j| (k..j).all(|i| is("p", i) == value));
    let each = |demand: &dyn Fn(usize) -> bool| (lo..hi).all(demand);
    match name {
        _ if name.starts_with("minimum_duration") => {
            each(&|k| !begins(k) || (k..hi).all(|j| !near(k, j) || is("p", j)))
        }
        _ if name.starts_with("maximum_duration") => each(&|k| !begins(k) || !lasts(k, true)),
        _ if name.starts_with("bounded_recurrence") => each(&|k| !lasts(k, false)),
        _ if name.starts_with("bounded_response") => {
            each(&|k| !is("p", k) || (k..hi).any(|j| near(k, j) && is("s", j)))
        }
        _ => each(&|k| !is("p", k) || (k..hi).all(|j| !near(k, j) || is("s", j))),
    }
}

#[test]
fn real_time_patterns_mean_what_they_say_in_every_scope() {
    let families =
        ["minimum_duration", "maximum_duration", "bounded_recurrence", "bounded_response", "bounded_invariance"];
    let timed: Vec<Pattern> =
        patterns("std.dwyer").into_iter().filter(|p| families.iter().any(|f| p.name.starts_with(f))).collect();
    assert_eq!(timed.len(), 25);
    for pattern in timed {
        let params = pattern.conditions();
        compare(&pattern, End::Quiet, |rows| {
            scopes(pattern.name, &params, rows).into_iter().all(|piece| in_time(pattern.name, &params, rows, piece))
        });
    }
}
