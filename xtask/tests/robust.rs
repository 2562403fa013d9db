//! Hostile input does no harm: what the fuzzer found stays found, and bytes at random, the same on every run, find nothing new.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use lapwing_engine::program::Clock;
use lapwing_engine::{Ending, Program, State};
use lapwing_stream::{Sample, Time, What};
use xtask::robust::{TARGETS, Target, target};

/// No input may take longer, whatever the machine is doing besides.
const PATIENCE: Duration = Duration::from_secs(20);

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The files of a folder that belong to a target, by name.
fn inputs(folder: &str, target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = root().join(folder).join(target);
    let files = fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path());
    let mut all: Vec<_> = files.map(|p| (p.display().to_string(), fs::read(&p).expect("an input"))).collect();
    all.sort();
    all
}

/// Whether an input does no harm, and how it did.
fn survives(target: Target, name: &str, input: &[u8]) -> Result<(), String> {
    let start = Instant::now();
    let shown = || input.iter().map(|b| format!("{b:02x}")).collect::<String>();
    if catch_unwind(AssertUnwindSafe(|| target(input))).is_err() {
        return Err(format!("{name} panics on {}", shown()));
    }
    match start.elapsed() {
        time if time > PATIENCE => Err(format!("{name} takes {time:?} on {}", shown())),
        _ => Ok(()),
    }
}

fn all_survive(inputs: impl Iterator<Item = (Target, String, Vec<u8>)>) {
    let harm: Vec<String> = inputs.filter_map(|(target, name, input)| survives(target, &name, &input).err()).collect();
    assert!(harm.is_empty(), "{} inputs do harm:\n{}", harm.len(), harm.join("\n"));
}

#[test]
fn what_was_found_stays_found() {
    let of = |(name, target): &(&str, Target)| {
        let target = *target;
        inputs("fuzz/regressions", name).into_iter().map(move |(path, input)| (target, path, input))
    };
    all_survive(TARGETS.iter().flat_map(of));
}

#[test]
fn what_led_the_fuzzer_on_does_no_harm() {
    for (name, target) in TARGETS {
        let corpus = inputs("corpus/hostile", name);
        assert!(corpus.len() >= 8, "corpus/hostile/{name} has {} files", corpus.len());
        all_survive(corpus.into_iter().map(|(path, input)| (*target, path, input)));
    }
}

#[test]
fn every_target_has_seeds_which_do_no_harm() {
    for (name, target) in TARGETS {
        let seeds = inputs("fuzz/seeds", name);
        assert!(!seeds.is_empty(), "fuzz/seeds/{name} has no files");
        all_survive(seeds.into_iter().map(|(path, input)| (*target, path, input)));
    }
}

/// A small generator of pseudo-random numbers (xorshift).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n.max(1) as u64) as usize
    }

    fn bytes(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.below(256) as u8).collect()
    }

    /// An input with a few bytes changed, left out, doubled or taken from another.
    fn mutated(&mut self, input: &[u8], other: &[u8]) -> Vec<u8> {
        let mut bytes = input.to_vec();
        for _ in 0..1 + self.below(5) {
            let (from, length) = (self.below(bytes.len()), 1 + self.below(24));
            let to = (from + length).min(bytes.len());
            match self.below(5) {
                _ if bytes.is_empty() => bytes = self.bytes(4),
                0 => bytes[from] = self.below(256) as u8,
                1 => bytes[from] ^= 1 << self.below(8),
                2 => drop(bytes.drain(from..to)),
                3 => bytes.extend_from_within(from..to),
                _ => {
                    let taken = self.below(other.len());
                    let taken = &other[taken..(taken + length).min(other.len())];
                    drop(bytes.splice(from..from, taken.iter().copied()));
                }
            }
        }
        bytes
    }
}

/// Mutations of the seeds of a target.
fn mutations_survive(name: &'static str, rounds: usize) {
    let seeds = inputs("fuzz/seeds", name);
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let pick = |random: &mut Random| seeds[random.below(seeds.len())].1.clone();
    let inputs = (0..rounds).map(|_| {
        let (one, other) = (pick(&mut random), pick(&mut random));
        (target(name), name.to_owned(), random.mutated(&one, &other))
    });
    all_survive(inputs);
}

#[test]
fn mutated_specifications() {
    mutations_survive("parse", 400);
    mutations_survive("format", 200);
    mutations_survive("check", 400);
}

#[test]
fn mutated_recordings() {
    for name in ["mcap", "bag", "db3", "csv", "ndjson"] {
        mutations_survive(name, 250);
    }
}

#[test]
fn mutated_definitions_and_messages() {
    mutations_survive("definition", 1500);
}

#[test]
fn mutated_models() {
    mutations_survive("bip", 600);
}

#[test]
fn mutated_imports() {
    mutations_survive("import", 800);
}

#[test]
fn mutated_requests_and_answers_of_codels() {
    mutations_survive("requests", 500);
    mutations_survive("wire", 1500);
}

#[test]
fn samples_that_lie() {
    let mut random = Random(7);
    all_survive((0..600).map(|n: u64| {
        let mut input = n.to_be_bytes().to_vec();
        input.extend(random.bytes(160));
        (target("step"), "step".to_owned(), input)
    }));
}

#[test]
fn a_rate_comes_to_an_end_at_the_end_of_time() {
    let program = Program { clock: Clock::Rate(10), ..Program::default() };
    for first in [i64::MIN, 0, i64::MAX - 1, i64::MAX] {
        let mut state = State::new(&program);
        for time in [first, i64::MAX] {
            state.feed(&program, Sample { time: Time(time), what: What::Row { cells: &[] } }, &mut ());
            state.next_deadline(&program);
        }
        state.finish(&program, &Ending::default(), &mut ());
    }
}
