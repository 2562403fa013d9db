//! `cargo run -p navigation`: the mission as it should be, with a fault that the monitor answers, without a monitor, and with one that is too strict.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use navigation::{Mission, Went};

/// A robot that navigates, and a monitor that stops it.
#[derive(Debug, Parser)]
struct Arguments {
    /// Run by the machine's clock
    #[arg(long)]
    real_time: bool,
    /// What chance depends on
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// A folder for recordings of all runs
    #[arg(long)]
    record: Option<PathBuf>,
    /// Every line of the logs, not only those about what went wrong
    #[arg(long)]
    all: bool,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let file = |name: &str| Some(Path::new(env!("CARGO_MANIFEST_DIR")).join(name));
    let (good, strict) = (file("navigation.rv"), file("too_strict.rv"));
    let delay = Some((6.0, 3.0));
    let slow = file("small.wcet");
    let plain = Mission { is_real: arguments.real_time, seed: arguments.seed, ..Mission::default() };
    let runs = [
        ("100 ms, no fault", "healthy", Mission { spec: good.clone(), ..plain.clone() }),
        ("scans held back by 6 s from 3 s on, nobody watches", "unwatched", Mission { delay, ..plain.clone() }),
        (
            "scans held back by 6 s from 3 s on, 100 ms",
            "delayed",
            Mission { spec: good.clone(), delay, ..plain.clone() },
        ),
        ("40 ms, no fault", "strict", Mission { spec: strict, ..plain.clone() }),
        (
            "real time, execution times too small",
            "small-wcet",
            Mission { wcet: slow, is_real: true, seconds: 2.0, ..plain },
        ),
    ];
    if let Some(Err(why)) = arguments.record.as_ref().map(std::fs::create_dir_all) {
        eprintln!("error: the folder for recordings cannot be made: {why}");
        return ExitCode::FAILURE;
    }
    for (title, name, mission) in runs {
        println!("== {title}");
        let record = arguments.record.as_ref().map(|folder| folder.join(format!("{name}.mcap")));
        match (Mission { record, ..mission }).fly() {
            Ok(went) => tell(&went, arguments.all),
            Err(why) => {
                eprintln!("error: {why}");
                return ExitCode::FAILURE;
            }
        }
        println!();
    }
    ExitCode::SUCCESS
}

fn tell(went: &Went, all: bool) {
    let words = ["violation", "ZeroSpeed", "write", "by Scan_Fail", "interrupt", "overrun", "failure"];
    let is_told = |line: &&String| all || words.iter().any(|word| line.contains(word));
    let told: Vec<&String> = went.log.iter().filter(is_told).collect();
    let most = if all { told.len() } else { 12 };
    told.iter().take(most).for_each(|line| println!("{line}"));
    if told.len() > most {
        println!("        … and {} lines more", told.len() - most);
    }
    let goto = went.goto.as_ref().map_or_else(|| "goes on".to_owned(), |outcome| outcome.to_string());
    let bump = went.bump.map_or_else(|| "touched nothing".to_owned(), |at| format!("ran into something at {at:.2} s"));
    println!("GotoPosition: {goto}; the robot {bump}, and is at ({:.2}, {:.2})", went.pose.x, went.pose.y);
    println!("{} turns of tasks missed, {} codels overran", went.missed, went.overruns);
    for property in went.report.iter().flat_map(|r| &r.properties) {
        let count = property.violations.len();
        let plural = if count == 1 { "" } else { "s" };
        println!("{}: {} ({count} violation{plural})", property.name, property.verdict.word());
    }
}
