//! `cargo run --release -p lapwing-benches [steps]`: ratios against hand-written loops, measured in one run.
//!
//! Absolute times are for orientation only: the machine is shared, so a ratio is taken from alternating runs, and the least of each
//! side counts.

mod program;
mod timescales;

use std::time::{Duration, Instant};

use lapwing_engine::{Ending, State};
use lapwing_stream::Verdict;
use timescales::{Property, Row};

/// How often each side runs.
const ROUNDS: usize = 5;

fn main() {
    let steps = std::env::args().nth(1).and_then(|s| s.parse().ok()).unwrap_or(300_000);
    println!("W1, {steps} steps: nanoseconds a step by hand and by the engine, and their ratio\n");
    println!(
        "{:<12} {:>6}   {:>8} {:>8} {:>6}   {:>8} {:>8} {:>6}",
        "", "bound", "sat hand", "engine", "ratio", "rnd hand", "engine", "ratio"
    );
    let only = std::env::args().nth(2).unwrap_or_default();
    for property in Property::ALL.into_iter().filter(|p| format!("{p:?}").contains(&only)) {
        for bound in [10, 100, 1000, 10_000] {
            let sat = compare(property, bound, &property.satisfying(bound, steps));
            let rnd = compare(property, bound, &timescales::random(steps));
            println!(
                "{:<12} {bound:>6}   {:>8.1} {:>8.1} {:>6.1}   {:>8.1} {:>8.1} {:>6.1}",
                format!("{property:?}"),
                sat.hand,
                sat.engine,
                sat.engine / sat.hand,
                rnd.hand,
                rnd.engine,
                rnd.engine / rnd.hand
            );
        }
    }
}

/// Nanoseconds a step.
struct Timing {
    hand: f64,
    engine: f64,
}

fn compare(property: Property, bound: u32, rows: &[Row]) -> Timing {
    let program = program::of(&property.formula(bound));
    let per_step = |d: Duration| d.as_secs_f64() * 1e9 / rows.len() as f64;
    let mut best = Timing { hand: f64::INFINITY, engine: f64::INFINITY };
    for _ in 0..ROUNDS {
        let start = Instant::now();
        let bad = std::hint::black_box(property.by_hand(bound, std::hint::black_box(rows)));
        best.hand = best.hand.min(per_step(start.elapsed()));
        let mut state = State::new(&program);
        let start = Instant::now();
        program::feed(&mut state, &program, std::hint::black_box(rows));
        best.engine = best.engine.min(per_step(start.elapsed()));
        let outcome = &state.finish(&program, &Ending::default(), &mut ())[0];
        assert_eq!(outcome.failed, bad, "{property:?} with bound {bound}: the engine and the loop by hand disagree");
        assert_eq!(outcome.verdict == Verdict::Violated, bad > 0);
    }
    best
}
