//! Groups with segments or future operators idle while nothing happens to them; what comes of it is what comes of stepping them.

mod support;

use lapwing_stream::Value;
use support::{chance, clock, program, run};

const SPECS: [&str; 9] = [
    "a: whenever p, eventually within 7 ms q\n",
    "a: after r, whenever p, eventually within 9 ms q\nb: after r, always p or q\n",
    "a: after_until p, q, always r\nb: after_until p, q, eventually r\n",
    "a: while p, whenever q, eventually within 5 ms r\n",
    "a: until r, whenever p, q until within 9 ms r\n",
    "a: whenever p, whenever q, eventually within 4 ms r\nb: whenever r, always within 3 ms (p or q)\n",
    "a: whenever once within 20 ms p, eventually within 6 ms q\n",
    "a: after_until p, q, after r, never p and q and r\n",
    "_rate_ = 800\na: whenever p, eventually within 7 ms q\nb: while q, always p or r\n",
];

/// Three columns that change rarely.
fn rows(seed: u64) -> Vec<(i64, [Value; 3])> {
    let (mut next, mut clock) = (chance(seed), clock(seed));
    let mut row = [false; 3];
    let step = |_| {
        row = row.map(|is| if next() % 16 == 0 { !is } else { is });
        (clock(), row.map(Value::Bool))
    };
    (0..600).map(step).collect()
}

#[test]
fn idling_changes_nothing() {
    for (n, text) in SPECS.iter().enumerate() {
        let quick = program(text, &["p", "q", "r"]);
        assert!(quick.groups.iter().any(|group| group.idles), "{text} never idles");
        let mut plain = quick.clone();
        plain.groups.iter_mut().for_each(|group| group.idles = false);
        for seed in 0..30 {
            let rows = rows(n as u64 * 1000 + seed);
            assert_eq!(run(&quick, &rows), run(&plain, &rows), "{text}, seed {seed}");
        }
    }
}
