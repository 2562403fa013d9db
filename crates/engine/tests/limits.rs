//! What happens when more obligations are open than a program allows, and where time itself ends.

mod support;

use lapwing_engine::{Ending, Outcome, Program, State};
use lapwing_stream::{Sample, Time, Value, Verdict, What};

fn program(text: &str, open_limit: usize) -> Program {
    Program { open_limit, ..support::program(text, &["p", "q"]) }
}

/// p every other second, q never but where `q` says; so every promise of a q is a run of its own.
fn outcome(program: &Program, q: impl Fn(i64) -> bool) -> Outcome {
    let mut state = State::new(program);
    for t in 0..100 {
        let cells = [Value::Bool(t % 2 == 0), Value::Bool(q(t))];
        state.feed(program, Sample { time: Time(t * 1_000_000_000), what: What::Row { cells: &cells } }, &mut ());
    }
    state.finish(program, &Ending::default(), &mut ()).remove(0)
}

#[test]
fn too_many_open_runs_make_a_property_inconclusive() {
    let text = "whenever p, eventually q\n";
    assert_eq!(outcome(&program(text, 1000), |_| false).verdict, Verdict::Unmet);
    let few = outcome(&program(text, 10), |_| false);
    assert_eq!(few.verdict, Verdict::Inconclusive);
    assert_eq!(few.cause.as_deref(), Some("more than 10 runs of obligations were open at once"));
}

/// What comes of a formula over p and q at these nanoseconds.
fn verdict(text: &str, rows: &[(i64, bool, bool)]) -> Verdict {
    let program = program(text, 1000);
    let mut state = State::new(&program);
    for &(at, p, q) in rows {
        let cells = [Value::Bool(p), Value::Bool(q)];
        state.feed(&program, Sample { time: Time(at), what: What::Row { cells: &cells } }, &mut ());
    }
    state.finish(&program, &Ending::default(), &mut ()).remove(0).verdict
}

#[test]
fn a_past_without_a_bound_reaches_from_the_end_of_time_to_its_beginning() {
    let rows = [(i64::MIN + 1, false, true), (0, false, false), (i64::MAX, true, false)];
    assert_eq!(verdict("p implies once q\n", &rows), Verdict::Holds);
    assert_eq!(verdict("p implies (not p since q)\n", &rows), Verdict::Violated);
}

#[test]
fn a_bound_runs_out_over_a_silence_longer_than_half_of_time() {
    // The same move has been made before, after a silence that was short.
    let rows = [
        (i64::MIN + 1, false, true),
        (i64::MIN + 2, true, false),
        (i64::MIN + 3, false, true),
        (i64::MAX, true, false),
    ];
    assert_eq!(verdict("p implies once within 1 s q\n", &rows[..3]), Verdict::Holds);
    assert_eq!(verdict("p implies once within 1 s q\n", &rows), Verdict::Violated);
}

/// An `until` of future formulas is evaluated anew at every instant, each part once at each position: a thousand of them are little work.
#[test]
fn formulas_that_are_evaluated_anew_are_not_given_up_early() {
    let formulas = [
        "(whenever p, p) until q",
        "(p until q) until q",
        "(always p) until q",
        "p until (eventually q)",
        "(next p) until q",
        "(eventually within 2 s p) until q",
    ];
    for formula in formulas {
        let program = support::program(&format!("a: {formula}\n"), &["p", "q"]);
        let mut state = State::new(&program);
        for step in 0..1_000 {
            let cells = [Value::Bool(true), Value::Bool(false)];
            let sample = Sample { time: Time(step * 100_000_000), what: What::Row { cells: &cells } };
            state.feed(&program, sample, &mut ());
        }
        let outcome = &state.finish(&program, &Ending::default(), &mut ())[0];
        assert_eq!((outcome.verdict, outcome.open), (Verdict::Unmet, 1), "{formula}: {:?}", outcome.cause);
    }
}

/// Each property has its own limit: those that share positions and operators with one that is given up are judged as they would be alone.
#[test]
fn who_has_too_much_open_is_given_up_alone() {
    let text = "whenever p, eventually q\nwhenever p, eventually within 1 s q\nalways (p or eventually within 9 s q)\n";
    let program = program(text, 10);
    let mut state = State::new(&program);
    for t in 0..100 {
        let cells = [Value::Bool(t % 2 == 0), Value::Bool(false)];
        state.feed(&program, Sample { time: Time(t * 1_000_000_000), what: What::Row { cells: &cells } }, &mut ());
    }
    let spread: Vec<bool> = (0..3).map(|number| state.standing(&program, number).given_up.is_some()).collect();
    assert_eq!(spread, [true, false, false]);
    let outcomes = state.finish(&program, &Ending::default(), &mut ());
    let judged: Vec<(Verdict, u64)> = outcomes.iter().map(|o| (o.verdict, o.failed)).collect();
    assert_eq!(judged, [(Verdict::Inconclusive, 0), (Verdict::Violated, 49), (Verdict::Violated, 45)]);
}
