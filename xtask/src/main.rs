//! `cargo run --release -p xtask -- agree --random 20000 [--seed N]`: whether engine and reference say the same.
//!
//! `cargo run --release -p xtask -- big [--gigabytes 2]`: whether memory stays where it is however long a recording is.
//!
//! `cargo run -p xtask -- codegen --random 2000 [--seed N]`: whether generated monitors say what the engine says.
//!
//! `cargo run -p xtask -- code-size`: how much of a small machine generated monitors take.

use std::path::Path;
use std::process::{Command, ExitCode};
use std::{env, fs, io};

use clap::{Parser, Subcommand};
use xtask::big::{Comparison, Kind, SPEC};
use xtask::codegen::{Case, Target, Theme, beyond, handed, of_suite};
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
    /// Check big recordings of every format, and fail where memory grows with their length.
    Big {
        /// How long the longest are, in thousand million bytes.
        #[arg(long, default_value_t = 2.0)]
        gigabytes: f64,
    },
    /// Compare generated monitors with the engine on specifications and traces at random.
    Codegen {
        /// How many cases.
        #[arg(long, default_value_t = 2_000)]
        random: u64,
        /// The seed of the first; the others follow it.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Only in C, which compiles in a tenth of the time.
        #[arg(long)]
        c: bool,
        /// Instead say which properties of the suite are refused, and why.
        #[arg(long)]
        refused: bool,
    },
    /// Compile the soccer robot's monitors for a Cortex-M3, and say how large they are.
    CodeSize,
}

fn main() -> ExitCode {
    match Arguments::parse().chore {
        Chore::Agree { random, seed, show } => agree(random, seed, show),
        Chore::Big { gigabytes } => big(gigabytes).unwrap_or_else(|error| {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }),
        Chore::Codegen { refused: true, .. } => refused().unwrap_or_else(|error| {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }),
        Chore::Codegen { random, seed, c, .. } => codegen(random, seed, c).unwrap_or_else(|error| {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }),
        Chore::CodeSize => code_size().unwrap_or_else(|error| {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }),
    }
}

fn refused() -> Result<ExitCode, String> {
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    for case in of_suite(folder.path())? {
        for (name, why) in beyond(&case) {
            println!("{}\n{name}: {why}\n", case.label);
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn codegen(random: u64, seed: u64, c: bool) -> Result<ExitCode, String> {
    let targets: &[Target] = if c { &[Target::C] } else { &[Target::Rust, Target::C] };
    let seeds: Vec<u64> = (seed..seed.saturating_add(random)).collect();
    let (mut compared, mut refused) = (0, 0);
    for seeds in seeds.chunks(200) {
        let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
        let mut cases: Vec<_> = seeds.iter().filter_map(|&seed| Case::at_random(seed)).collect();
        // To every four of these one of what is handed over as a whole.
        for (&seed, theme) in seeds.iter().step_by(4).zip(Theme::ALL.into_iter().cycle()) {
            cases.push(handed(theme, seed, folder.path())?);
        }
        let (count, wrong) = xtask::codegen::agree(&cases, targets, folder.path())?;
        if let Some(first) = wrong.first() {
            return Err(format!("{} differ\n{first}", wrong.len()));
        }
        (compared, refused) = (compared + count.compared, refused + count.refused);
    }
    println!("{compared} properties agree, {refused} are not generated");
    Ok(ExitCode::SUCCESS)
}

fn code_size() -> Result<ExitCode, String> {
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    println!("| property | code, bytes | memory, bytes |\n| --- | ---: | ---: |");
    for size in xtask::codegen::cortex::sizes(folder.path())? {
        println!("| {} | {} | {} |", size.name, size.code, size.memory);
    }
    Ok(ExitCode::SUCCESS)
}

/// Each format in a temporary folder, checked by the tool that was built beside this program.
fn big(gigabytes: f64) -> io::Result<ExitCode> {
    let lapwing = env::current_exe()?.with_file_name("lapwing");
    if !lapwing.is_file() {
        return Err(io::Error::other(format!("{} is not there: cargo build --release", lapwing.display())));
    }
    let folder = tempfile::tempdir()?;
    let spec = folder.path().join("big.rv");
    fs::write(&spec, SPEC)?;
    let mut code = ExitCode::SUCCESS;
    for kind in Kind::ALL {
        let check = |path: &Path| {
            let mut command = Command::new(&lapwing);
            command.arg("check").arg(&spec).arg(path);
            command
        };
        let comparison = Comparison::new(kind, folder.path(), (gigabytes * 1e9) as u64, &check)?;
        println!("{comparison}");
        if !comparison.is_fine() {
            code = ExitCode::FAILURE;
        }
    }
    Ok(code)
}

fn agree(random: u64, seed: u64, show: usize) -> ExitCode {
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
