//! `cargo run --release -p lapwing-benches [steps]`: ratios against hand-written loops, measured in one run.
//!
//! Absolute times are for orientation only: the machine is shared, so a ratio is taken from alternating runs, and the least of each
//! side counts.

mod program;
mod robot;
mod timescales;

use std::time::{Duration, Instant};

use lapwing_engine::{Ending, Program, State};
use lapwing_stream::Verdict;
use program::Cell;
use timescales::{Property, Row};

/// How often each side runs.
const ROUNDS: usize = 5;

fn main() {
    let steps = std::env::args().nth(1).and_then(|s| s.parse().ok()).unwrap_or(300_000);
    let only = std::env::args().nth(2).unwrap_or_default();
    println!("{steps} steps: nanoseconds a step by hand and by the engine, and their ratio\n");
    timescales(steps, &only);
    robots_log(steps, &only);
}

/// W1: satisfied, and hard to predict.
fn timescales(steps: usize, only: &str) {
    println!(
        "{:<12} {:>6}   {:>8} {:>8} {:>6}   {:>8} {:>8} {:>6}",
        "W1", "bound", "sat hand", "engine", "ratio", "rnd hand", "engine", "ratio"
    );
    for property in Property::ALL.into_iter().filter(|p| format!("{p:?}").contains(only)) {
        for bound in [10, 100, 1000, 10_000] {
            let sat = compare(property, bound, &property.satisfying(bound, steps));
            let rnd = compare(property, bound, &timescales::random(steps));
            println!("{:<12} {bound:>6}   {sat}   {rnd}", format!("{property:?}"));
        }
    }
}

/// W2: four questions alone and together, and a hundred.
fn robots_log(steps: usize, only: &str) {
    println!("\n{:<19}   {:>8} {:>8} {:>6}", "W2", "hand", "engine", "ratio");
    let rows = robot::log(steps);
    let mut sets: Vec<(String, Vec<robot::Question>)> =
        robot::FOUR.into_iter().map(|q| (format!("{q:?}"), vec![q])).collect();
    sets.push(("Four".to_owned(), robot::FOUR.to_vec()));
    sets.push(("Hundred".to_owned(), robot::hundred()));
    for (name, questions) in sets.iter().filter(|(name, _)| name.contains(only)) {
        println!("{name:<19}   {}", ask(questions, &rows));
    }
}

fn ask(questions: &[robot::Question], rows: &[robot::Row]) -> Timing {
    let formulas: Vec<String> = questions.iter().map(|q| q.formula()).collect();
    let program = program::of(robot::COLUMNS, &formulas);
    let by_hand = || {
        let mut hands: Vec<robot::ByHand> = questions.iter().map(|q| q.by_hand()).collect();
        for (t, row) in rows.iter().enumerate() {
            hands.iter_mut().for_each(|hand| hand.step(t as i64, row));
        }
        hands.iter().map(|hand| hand.bad).sum()
    };
    time(&program, rows, by_hand)
}

/// Nanoseconds a step.
struct Timing {
    hand: f64,
    engine: f64,
}

impl std::fmt::Display for Timing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:>8.1} {:>8.1} {:>6.1}", self.hand, self.engine, self.engine / self.hand)
    }
}

fn compare(property: Property, bound: u32, rows: &[Row]) -> Timing {
    let program = program::of(timescales::COLUMNS, &[property.formula(bound)]);
    time(&program, rows, || property.by_hand(bound, std::hint::black_box(rows)))
}

/// Times the engine against a loop that gives how many steps fail; both must say the same.
fn time<C: Cell + Default, const N: usize>(program: &Program, rows: &[[C; N]], by_hand: impl Fn() -> u64) -> Timing {
    let per_step = |d: Duration| d.as_secs_f64() * 1e9 / rows.len() as f64;
    let mut best = Timing { hand: f64::INFINITY, engine: f64::INFINITY };
    for _ in 0..ROUNDS {
        let start = Instant::now();
        let bad = std::hint::black_box(by_hand());
        best.hand = best.hand.min(per_step(start.elapsed()));
        let mut state = State::new(program);
        let start = Instant::now();
        program::feed(&mut state, program, std::hint::black_box(rows));
        best.engine = best.engine.min(per_step(start.elapsed()));
        let outcomes = state.finish(program, &Ending::default(), &mut ());
        let failed: u64 = outcomes.iter().map(|outcome| outcome.failed).sum();
        assert_eq!(failed, bad, "the engine and the loop by hand disagree");
        assert_eq!(outcomes.iter().any(|outcome| outcome.verdict == Verdict::Violated), bad > 0);
    }
    best
}
