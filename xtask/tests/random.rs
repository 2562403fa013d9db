//! The engine equals the reference on specifications and traces at random. More of them: `cargo run --release -p xtask -- agree`.

use xtask::agree::{Drive, agree};
use xtask::codegen::{Theme, handed};
use xtask::random::{Told, run};

/// How many cases each of the tests below takes; they run side by side.
const CASES: u64 = 1500;

fn agree_from(first: u64) {
    let differed: Vec<String> = (first..first + CASES)
        .filter_map(|seed| match run(seed) {
            Told::Differed(how) => Some(how),
            Told::Agreed | Told::Refused => None,
        })
        .take(2)
        .collect();
    assert!(differed.is_empty(), "{}", differed.join("\n\n"));
}

#[test]
fn engine_and_reference_agree_on_the_first_cases() {
    agree_from(1);
}

#[test]
fn engine_and_reference_agree_on_cases_from_100_000_on() {
    agree_from(100_000);
}

#[test]
fn most_generated_specifications_check() {
    let refused = (1..=CASES).filter(|&seed| matches!(run(seed), Told::Refused)).count();
    assert!(refused < CASES as usize / 100, "{refused} of {CASES} were refused by the checker");
}

#[test]
fn engine_and_reference_agree_on_ground_truth() {
    let folder = tempfile::tempdir().expect("a folder to write traces to");
    for theme in Theme::GROUND_TRUTH {
        for seed in 1..=100 {
            let case = handed(theme, seed, folder.path()).expect("a case");
            if let Err(differ) = agree(&case.spec, &case.trace, &Drive::ALL) {
                panic!("{}\ndriven {:?}\n{differ}", case.label, differ.drive);
            }
        }
    }
}
