//! A saved state goes on as the original would have, and only for its own program. That it does so at every instant of every case is held by
//! the literate tests and by the comparison with the reference, which save and resume before every sample.

mod support;

use lapwing_engine::saved::fingerprint;
use lapwing_engine::{Ending, NotLoaded, NotResumed, Program, State};
use lapwing_stream::{Sample, Time, Value, Verdict, What};

fn program(text: &str) -> Program {
    support::program(text, &["p", "q"])
}

fn feed(state: &mut State, program: &Program, seconds: i64, p: bool) {
    let cells = [Value::Bool(p), Value::Bool(false)];
    state.feed(program, Sample { time: Time(seconds * 1_000_000_000), what: What::Row { cells: &cells } }, &mut ());
}

#[test]
fn an_open_obligation_outlives_the_process() {
    let program = program("whenever p, eventually within 2 s q\n");
    let mut state = State::new(&program);
    feed(&mut state, &program, 0, true);
    let bytes = state.save(&program);
    drop(state);

    let mut state = State::resume(&program, &bytes).expect("its own bytes");
    feed(&mut state, &program, 5, false);
    let outcome = state.finish(&program, &Ending::default(), &mut ()).remove(0);
    assert_eq!(outcome.verdict, Verdict::Violated);
    assert_eq!((outcome.episodes[0].began, outcome.episodes[0].failed), (Time(0), Time(2_000_000_000)));
}

#[test]
fn bytes_of_something_else_are_refused() {
    let (one, other) = (program("never p\n"), program("never q\n"));
    let bytes = State::new(&one).save(&one);
    let resumed = |program: &Program, bytes: &[u8]| State::resume(program, bytes).map(|_| ());
    assert_eq!(resumed(&one, &bytes), Ok(()));
    assert_eq!(resumed(&other, &bytes), Err(NotResumed::OtherProgram));
    assert_eq!(resumed(&one, b"something else entirely"), Err(NotResumed::Unknown));
    assert_eq!(resumed(&one, &[]), Err(NotResumed::Unknown));
    for cut in 8..bytes.len() {
        assert_eq!(resumed(&one, &bytes[..cut]), Err(NotResumed::Damaged), "cut at {cut}");
    }
    for at in 24..bytes.len() {
        let mut altered = bytes.clone();
        altered[at] ^= 0x10;
        assert_eq!(resumed(&one, &altered), Err(NotResumed::Damaged), "altered at {at}");
    }
}

#[test]
fn a_program_is_the_same_once_it_is_loaded() {
    let text = "whenever becomes p, eventually within 2 s q\nalways once within 3 s (p or delta(x) < 2)\nnever p and held for 1 s q\n";
    let program = support::program(text, &["p", "q", "x"]);
    let bytes = program.save();
    let loaded = Program::load(&bytes).expect("its own bytes");
    assert_eq!(fingerprint(&loaded), fingerprint(&program));
    assert_eq!(loaded.save(), bytes);
    let loads = |bytes: &[u8]| Program::load(bytes).map(|_| ());
    assert_eq!(loads(b"something else entirely"), Err(NotLoaded::Unknown));
    for cut in 8..bytes.len() {
        assert_eq!(loads(&bytes[..cut]), Err(NotLoaded::Damaged), "cut at {cut}");
    }
    for at in 16..bytes.len() {
        let mut altered = bytes.clone();
        altered[at] ^= 0x10;
        assert_eq!(loads(&altered), Err(NotLoaded::Damaged), "altered at {at}");
    }
}
