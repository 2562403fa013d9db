//! Rows of truth values are taken in by a way of their own; what comes of it is what comes of the ordinary way.

mod support;

use lapwing_stream::Value;
use support::{chance, clock, program, run};

const FORMULAS: [&str; 11] = [
    "once within 10 ms p",
    "r implies historically within 10 ms not p",
    "(r and not q and once q) implies ((once within 7 ms (p or q)) since q)",
    "(p since within 5 ms q) or not r",
    "once within 0 ms p",
    "p iff q",
    "once p",
    "p and (once within 3 ms q) and not (q since within 30 ms r)",
    "q or once within [3 ms, 9 ms] p",
    "(not p since within [2 ms, 12 ms] q) iff previously r",
    "held for 6 ms (p or q) implies not (becomes(r) and once within 4 ms p)",
];

/// Three columns of a trace that is hard to predict: truth values, now and then none.
fn rows(seed: u64) -> Vec<(i64, [Value; 3])> {
    let (mut next, mut row) = (chance(seed), [false; 3]);
    let mut clock = clock(seed);
    let step = |_| {
        row = row.map(|is| if next() % 3 == 0 { !is } else { is });
        let missing = if next() % 40 == 0 { next() as usize % 3 } else { 3 };
        (clock(), std::array::from_fn(|i| if i == missing { Value::Missing } else { Value::Bool(row[i]) }))
    };
    (0..600).map(step).collect()
}

#[test]
fn rows_of_truth_values_fare_as_any_others() {
    for (n, formula) in FORMULAS.iter().enumerate() {
        let quick = program(&format!("holds: {formula}\n"), &["p", "q", "r"]);
        assert!(quick.skim.is_some(), "{formula} does not rest");
        let mut plain = quick.clone();
        plain.skim = None;
        for seed in 0..20 {
            let rows = rows(n as u64 * 1000 + seed);
            assert_eq!(run(&quick, &rows), run(&plain, &rows), "{formula}, seed {seed}");
        }
    }
}
