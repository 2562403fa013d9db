//! `cargo run --release -p xtask -- agree --random 20000 [--seed N]`: whether engine and reference say the same.

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use xtask::random::{Told, run};

/// Chores of the repository.
#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Compare engine and reference on specifications and traces at random.
    Agree {
        /// How many cases.
        #[arg(long, default_value_t = 20_000)]
        random: u64,
        /// The seed of the first; the others follow it.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Stop after so many differences.
        #[arg(long, default_value_t = 3)]
        show: usize,
    },
}

fn main() -> ExitCode {
    let Chore::Agree { random, seed, show } = Arguments::parse().chore;
    let (mut differences, mut refused) = (0, 0);
    for seed in seed..seed.saturating_add(random) {
        match run(seed) {
            Told::Agreed => {}
            Told::Refused => refused += 1,
            Told::Differed(how) => {
                println!("{how}\n");
                differences += 1;
            }
        }
        if differences == show {
            break;
        }
    }
    let stopped = if differences == show { ", then stopped" } else { "" };
    println!(
        "{random} cases from seed {seed} on: {differences} differences{stopped}; {refused} refused by the checker"
    );
    if differences == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
