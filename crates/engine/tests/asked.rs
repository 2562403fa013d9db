//! Future operators are kept open only where somebody asks for them; what comes of it is what comes of asking everywhere.

mod support;

use lapwing_engine::{Program, State};
use lapwing_stream::{Sample, Time, Value, What};
use support::{program, run, toggling};

const SPECS: [&str; 7] = [
    "a: whenever p, eventually within 7 ms q\n",
    "a: whenever p, q until within 9 ms r\nb: whenever not p, always within 3 ms not q\n",
    "a: after r, whenever p, eventually within [2 ms, 5 ms] q\n",
    "a: after_until p, q, whenever r, eventually within 4 ms not p\n",
    "a: whenever p, eventually q\nb: eventually q\n",
    "a: whenever p, eventually within 5 ms (q and eventually within 3 ms r)\n",
    "a: before r, whenever p, always within (0 s, 4 ms] (q implies eventually within 2 ms not q)\n",
];

#[test]
fn what_nobody_asks_for_decides_nothing() {
    for (n, text) in SPECS.iter().enumerate() {
        let quick = program(text, &["p", "q", "r"]);
        let mut plain = quick.clone();
        let futures = plain.groups.iter_mut().flat_map(|group| &mut group.futures);
        let spared = futures.filter_map(|future| future.asked.take()).count();
        assert!(spared > 0, "{text}: everything is asked for everywhere");
        for seed in 0..20 {
            let rows = toggling(n as u64 * 1000 + seed, 4, 400);
            assert_eq!(run(&quick, &rows), run(&plain, &rows), "{text}, seed {seed}");
        }
    }
}

/// A request that never comes leaves nothing to wait for.
#[test]
fn nothing_is_due_where_nothing_is_asked() {
    let program: Program = program("a: whenever p, eventually within 1 s q\n", &["p", "q"]);
    let mut state = State::new(&program);
    let mut feed = |millis: i64, p: bool| {
        let cells = [Value::Bool(p), Value::Bool(false)];
        let sample = Sample { time: Time(millis * 1_000_000), what: What::Row { cells: &cells } };
        state.feed(&program, sample, &mut ());
        state.next_deadline(&program)
    };
    assert_eq!(feed(0, false), None);
    assert_eq!(feed(10, true), Some(Time(1_010_000_000)));
    assert_eq!(feed(20, false), Some(Time(1_010_000_000)));
}
