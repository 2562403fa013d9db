//! Programs of a text over columns, traces by chance, and everything that comes of them.
#![allow(dead_code)] // No test needs all of it.

use lapwing_check::{TraceShape, check, compile::compile, load};
use lapwing_diag::SourceMap;
use lapwing_engine::inputs::Inputs;
use lapwing_engine::{Ending, Output, Program, State};
use lapwing_stream::{Sample, Time, Value, What};

/// The program of a specification over these columns.
pub fn program(text: &str, columns: &[&str]) -> Program {
    let columns = columns.iter().map(|column| column.to_string()).collect();
    program_over(text, &TraceShape { columns, schemaless: true, ..TraceShape::default() })
}

/// The program of a specification over a trace of that shape.
pub fn program_over(text: &str, shape: &TraceShape) -> Program {
    let mut sources = SourceMap::default();
    let file = sources.add("test.rv", text);
    let loaded = load(&mut sources, lapwing_syntax::parse(file, text).file, &|_| None);
    let checked = check(&sources, &loaded, Some(shape));
    assert!(!checked.has_errors(), "{text}: {:?}", checked.diagnostics);
    compile(&checked.spec)
}

/// Reproducible chance.
pub fn chance(seed: u64) -> impl FnMut() -> u64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        state >> 33
    }
}

/// Three columns of truth values, each of which toggles at one in so many rows.
pub fn toggling(seed: u64, one_in: u64, rows: usize) -> Vec<(i64, [Value; 3])> {
    let (mut next, mut clock) = (chance(seed), clock(seed));
    let mut row = [false; 3];
    let step = |_| {
        row = row.map(|is| is ^ next().is_multiple_of(one_in));
        (clock(), row.map(Value::Bool))
    };
    (0..rows).map(step).collect()
}

/// A clock that stands still, goes on and leaps.
pub fn clock(seed: u64) -> impl FnMut() -> i64 {
    let (mut next, mut now) = (chance(seed ^ 0x5eed), 0);
    move || {
        now += match next() % 20 {
            0..4 => 0,
            19 => 50_000_000,
            n => n as i64 * 250_000,
        };
        now
    }
}

/// All that is told, in words, with the signals then, and the outcomes; saved and resumed now and then.
pub fn run<const N: usize>(program: &Program, rows: &[(i64, [Value; N])]) -> (Vec<String>, String) {
    run_samples(program, rows.iter().map(|(time, cells)| (Time(*time), What::Row { cells })))
}

/// The same of samples of any kind.
pub fn run_samples<'s>(program: &Program, samples: impl Iterator<Item = (Time, What<'s>)>) -> (Vec<String>, String) {
    let (mut state, mut told) = (State::new(program), Vec::new());
    for (n, (time, what)) in samples.enumerate() {
        let mut tell = |inputs: &Inputs, output: Output<'_>| {
            let seen: Vec<_> = (0..program.slots.len()).map(|slot| inputs.value(slot).clone()).collect();
            told.push(format!("{output:?} {seen:?}"));
        };
        state.feed(program, Sample { time, what }, &mut tell);
        if n % 100 == 99 {
            state = State::resume(program, &state.save(program)).unwrap_or_else(|e| panic!("{e}"));
            state.feed(program, Sample { time, what: What::Other }, &mut tell);
        }
    }
    let outcomes = state.finish(program, &Ending::default(), &mut ());
    (told, format!("{outcomes:?}"))
}
