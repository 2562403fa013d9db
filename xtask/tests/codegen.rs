//! Generated monitors, in Rust and in C, say what the engine says: on the suite, and on specifications and traces at random. More of them:
//! `cargo run -p xtask -- codegen`.

use xtask::codegen::{Case, Count, Target, Theme, agree, handed, of_suite};

const HERE: [Target; 2] = [Target::Rust, Target::C];

/// Compares in batches that a compiler takes well.
fn compare(cases: &[Case], targets: &[Target]) -> Count {
    let mut count = Count::default();
    let mut wrong = Vec::new();
    for batch in cases.chunks(200) {
        let folder = tempfile::tempdir().expect("a folder to compile in");
        let (batch, differ) = agree(batch, targets, folder.path()).expect("monitors that compile and run");
        count.compared += batch.compared;
        count.refused += batch.refused;
        count.unfit += batch.unfit;
        wrong.extend(differ);
    }
    let first: Vec<&String> = wrong.iter().take(4).collect();
    assert!(wrong.is_empty(), "{} differ of {count:?}:\n{first:#?}", wrong.len());
    count
}

#[test]
fn they_agree_on_the_suite() {
    let folder = tempfile::tempdir().expect("a folder to write traces to");
    let all = of_suite(folder.path()).expect("pages that can be read");
    let count = compare(&all, &HERE);
    println!("of the suite: {count:?}");
    assert!(count.compared >= 675, "{count:?}");
}

/// How many specifications at random are compared.
const CASES: u64 = 240;

#[test]
fn they_agree_on_specifications_at_random() {
    let all: Vec<Case> = (1..=CASES).filter_map(Case::at_random).collect();
    let count = compare(&all, &HERE);
    println!("at random: {count:?}");
    assert!(count.compared >= 2 * CASES as usize, "{count:?}");
}

/// How many cases of each theme are compared.
const OF_A_THEME: u64 = 20;

#[test]
fn they_agree_on_what_is_handed_over_as_a_whole() {
    let folder = tempfile::tempdir().expect("a folder to write traces to");
    let of = |theme| (1..=OF_A_THEME).map(move |seed| (theme, seed));
    let all = Theme::ALL.into_iter().flat_map(of);
    let all: Vec<Case> = all.map(|(theme, seed)| handed(theme, seed, folder.path()).expect("a case")).collect();
    let count = compare(&all, &HERE);
    println!("handed over: {count:?}");
    assert_eq!((count.refused, count.unfit), (0, 0), "{count:?}");
}
