//! Rows of truth values are taken in by a way of their own; what comes of it is what comes of the ordinary way.

mod support;

use lapwing_engine::inputs::Inputs;
use lapwing_engine::{Ending, Output, Program, State};
use lapwing_stream::{Sample, Time, Value, What};
use support::program;

const FORMULAS: [&str; 8] = [
    "once within 10 ms p",
    "r implies historically within 10 ms not p",
    "(r and not q and once q) implies ((once within 7 ms (p or q)) since q)",
    "(p since within 5 ms q) or not r",
    "once within 0 ms p",
    "p iff q",
    "once p",
    "p and (once within 3 ms q) and not (q since within 30 ms r)",
];

/// Three columns of a trace that is hard to predict: truth values, now and then none, and a clock that stands still, goes on and leaps.
fn rows(seed: u64) -> Vec<(i64, [Value; 3])> {
    let mut chance = seed;
    let mut next = move || {
        chance = chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        chance >> 33
    };
    let (mut now, mut row) = (0, [false; 3]);
    let step = |_| {
        now += match next() % 20 {
            0..4 => 0,
            19 => 50_000_000,
            n => n as i64 * 250_000,
        };
        row = row.map(|is| if next() % 3 == 0 { !is } else { is });
        let missing = if next() % 40 == 0 { next() as usize % 3 } else { 3 };
        (now, std::array::from_fn(|i| if i == missing { Value::Missing } else { Value::Bool(row[i]) }))
    };
    (0..600).map(step).collect()
}

/// The alarms, in words, and the outcomes.
fn run(program: &Program, rows: &[(i64, [Value; 3])]) -> (Vec<String>, String) {
    let (mut state, mut told) = (State::new(program), Vec::new());
    for (n, (time, cells)) in rows.iter().enumerate() {
        let time = Time(*time);
        let mut tell = |inputs: &Inputs, output: Output<'_>| {
            let seen: Vec<_> = (0..program.slots.len()).map(|slot| inputs.value(slot).clone()).collect();
            told.push(format!("{output:?} {seen:?}"));
        };
        state.feed(program, Sample { time, what: What::Row { cells } }, &mut tell);
        if n % 100 == 99 {
            state = State::resume(program, &state.save(program)).unwrap_or_else(|e| panic!("{e}"));
            state.feed(program, Sample { time, what: What::Other }, &mut tell);
        }
    }
    let outcomes = state.finish(program, &Ending::default(), &mut ());
    (told, format!("{outcomes:?}"))
}

#[test]
fn rows_of_truth_values_fare_as_any_others() {
    for (n, formula) in FORMULAS.iter().enumerate() {
        let quick = program(&format!("holds: {formula}\n"), &["p", "q", "r"]);
        assert!(!quick.letters.is_empty(), "{formula} is no automaton over its columns");
        let mut plain = quick.clone();
        plain.letters.clear();
        for seed in 0..20 {
            let rows = rows(n as u64 * 1000 + seed);
            assert_eq!(run(&quick, &rows), run(&plain, &rows), "{formula}, seed {seed}");
        }
    }
}
