//! How a property stands while the trace goes on: what a guard asks before it lets a message pass.

mod support;

use lapwing_engine::{Program, State};
use lapwing_stream::{Sample, Time, Value, What};

fn program(text: &str) -> Program {
    support::program(text, &["p", "q"])
}

/// The failures so far after each row of p and q, one a second.
fn failures(text: &str, rows: &[[f64; 2]]) -> Vec<u64> {
    let program = program(text);
    let mut state = State::new(&program);
    let mut failed = Vec::new();
    for (second, row) in rows.iter().enumerate() {
        let cells = row.map(|x| if x.is_nan() { Value::Missing } else { Value::Num(x) });
        let time = Time(second as i64 * 1_000_000_000);
        state.feed(&program, Sample { time, what: What::Row { cells: &cells } }, &mut ());
        failed.push(state.standing(&program, 0).failed);
    }
    failed
}

#[test]
fn every_instant_of_a_failure_counts_also_while_nothing_changes() {
    let rows = [[1.0, 0.0], [3.0, 0.0], [3.0, 0.0], [3.0, 0.0], [1.0, 0.0], [1.0, 0.0]];
    assert_eq!(failures("never p > 2.0\n", &rows), [0, 1, 2, 3, 3, 3]);
}

#[test]
fn a_missed_deadline_counts_once_time_is_beyond_it() {
    let rows = [[1.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 1.0]];
    assert_eq!(failures("whenever p > 0.5, eventually within 2 s q > 0.5\n", &rows), [0, 0, 0, 1, 1]);
}

#[test]
fn a_property_stands_nowhere_before_it_starts() {
    let program = program("never p + q > 2.0\n");
    let mut state = State::new(&program);
    let half = [Value::Num(1.0), Value::Missing];
    state.feed(&program, Sample { time: Time(0), what: What::Row { cells: &half } }, &mut ());
    assert!(!state.standing(&program, 0).started);
    let both = [Value::Num(1.0), Value::Num(0.5)];
    state.feed(&program, Sample { time: Time(1), what: What::Row { cells: &both } }, &mut ());
    assert!(state.standing(&program, 0).started && !state.standing(&program, 7).started);
}
