//! Margins: only where they are asked for, without an influence on anything else, within their memory, and over pieces of a trace.

mod support;

use lapwing_engine::{Ending, Outcome, Program, State};
use lapwing_stream::{Sample, Time, Value, What};

const MS: i64 = 1_000_000;

fn program(text: &str) -> Program {
    support::program(text, &["x"])
}

/// The outcomes on rows of x.
fn outcomes(program: &Program, mut state: State, rows: &[(i64, f64)]) -> Vec<Outcome> {
    for (time, x) in rows {
        let cells = [Value::Num(*x)];
        state.feed(program, Sample { time: Time(*time), what: What::Row { cells: &cells } }, &mut ());
    }
    state.finish(program, &Ending::default(), &mut ())
}

fn margins(program: &Program, rows: &[(i64, f64)]) -> Vec<Option<f64>> {
    outcomes(program, State::with_margins(program), rows).iter().map(|o| o.margin).collect()
}

const ROWS: [(i64, f64); 5] = [(0, 1.5), (100 * MS, 2.5), (200 * MS, 1.0), (300 * MS, 0.5), (400 * MS, 0.75)];

#[test]
fn nobody_pays_who_does_not_ask() {
    let program = program("never x > 2\nwhenever x > 2, eventually within 0.2 s x < 1\nalways once within 1 s x > 1\n");
    let plain = outcomes(&program, State::new(&program), &ROWS);
    assert!(plain.iter().all(|o| o.margin.is_none()));
    let mut measured = outcomes(&program, State::with_margins(&program), &ROWS);
    assert_eq!(measured.iter().map(|o| o.margin).collect::<Vec<_>>(), [Some(-0.5), Some(0.5), Some(0.5)]);
    measured.iter_mut().for_each(|o| o.margin = None);
    assert_eq!(measured, plain);
}

#[test]
fn what_needs_too_much_memory_has_none() {
    let mut program = program("never x > 2\nwhenever x > 2, eventually within 0.2 s x < 1\n");
    program.margin_limit = 4;
    let outcomes = outcomes(&program, State::with_margins(&program), &ROWS);
    let said: Vec<_> = outcomes.iter().map(|o| (o.margin, o.margin_gave_up)).collect();
    // What must hold throughout needs none.
    assert_eq!(said, [(Some(-0.5), false), (None, true)]);
}

#[test]
fn the_worst_of_the_pieces_between_jumps_of_time() {
    let program = program("always x < 2\nafter x > 1, eventually x < 0.5\n");
    let rows = [(500 * MS, 1.75), (600 * MS, 0.25), (0, 1.5), (100 * MS, 0.125)];
    assert_eq!(margins(&program, &rows), [Some(0.25), Some(0.25)]);
}

#[test]
fn unbounded_operators_over_the_past_and_the_future() {
    let text = "always (x > 0 since x < 2)\nx < 3 until x < 1\nnever previously x > 2\nalways x < 2.25 or held for 0.1 s x > 0\n";
    assert_eq!(margins(&program(text), &ROWS), [Some(0.5), Some(0.5), Some(-0.5), Some(0.75)]);
}
