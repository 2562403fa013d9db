//! The command: plays a match, or makes the tables and the drawing of the README.

use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
use soccer::fault::Fault;
use soccer::figures::{self, Player};
use soccer::game::{Game, spec};
use soccer::{costs, page, watch};

/// A Lego robot plays soccer, and is watched by monitors that it knows nothing of.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Play a match, and tell what happened
    Play(Play),
    /// Play all matches of the thesis, and compare the sequences of events with those that it prints
    Figures {
        /// What chance follows
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Measure what monitoring costs: code size, and time at each place where the thesis measured
    Costs(Costs),
    /// List what can go wrong
    Faults,
}

#[derive(Args)]
struct Play {
    /// What chance follows
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// What goes wrong: see `soccer faults`
    #[arg(long)]
    fault: Option<Fault>,
    /// Answer violations of this property alone, as if no other were watched
    #[arg(long, value_name = "PROPERTY")]
    only: Option<String>,
    /// Write what the robot's program said, for `lapwing check soccer.rv FILE`: as MCAP by the name `.mcap`, else as NDJSON
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Write a page that shows the match
    #[arg(long, value_name = "FILE.html")]
    page: Option<PathBuf>,
    /// Tell it as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
struct Costs {
    /// How many matches to play in each way
    #[arg(long, default_value_t = 20)]
    matches: u64,
    /// Write the distributions as box plots
    #[arg(long, value_name = "FILE.html")]
    page: Option<PathBuf>,
    /// Do not build the robot's program to compare its sizes
    #[arg(long)]
    no_sizes: bool,
    /// Measure one way here, and print its times in nanoseconds as JSON
    #[arg(long, hide = true)]
    way: Option<String>,
}

fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Play(options) => play(&options),
        Command::Figures { seed } => figures(seed),
        Command::Costs(options) => costs(&options),
        Command::Faults => {
            let lines: Vec<String> = Fault::ALL.iter().map(|f| format!("{:<24}{}", f.name(), f.what())).collect();
            print(&(lines.join("\n") + "\n"))
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("soccer: {why}");
            ExitCode::from(2)
        }
    }
}

fn play(options: &Play) -> Result<(), String> {
    let game = Game { seed: options.seed, fault: options.fault, only: options.only.clone() };
    let spec = spec().map_err(|e| e.to_string())?;
    if let Some(only) =
        game.only.as_deref().filter(|only| spec.alone().spec.properties.iter().all(|p| p.name != **only))
    {
        return Err(format!("soccer.rv has no property `{only}`"));
    }
    let played = game.play().map_err(|e| e.to_string())?;
    let write =
        |path: &PathBuf, text: String| std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()));
    if let Some(path) = &options.record {
        let meaning = &spec.alone().spec;
        match path.extension().is_some_and(|extension| extension == "mcap") {
            true => write_mcap(path, &played.log, meaning).map_err(|e| format!("{}: {e}", path.display()))?,
            false => write(path, watch::ndjson(&played.log, meaning))?,
        }
    }
    if let Some(path) = &options.page {
        write(path, page::html(&played.account).map_err(|e| e.to_string())?)?;
    }
    match options.json {
        true => print(&(serde_json::to_string(&played.account).map_err(|e| e.to_string())? + "\n")),
        false => print(&figures::told(&played.account)),
    }
}

fn write_mcap(path: &Path, log: &[watch::Entry], meaning: &lapwing_check::checked::Spec) -> Result<(), Box<dyn Error>> {
    Ok(watch::mcap(log, meaning, BufWriter::new(File::create(path)?))?)
}

fn figures(seed: u64) -> Result<(), String> {
    let spec = spec().map_err(|e| e.to_string())?;
    let me = std::env::current_exe().map_err(|e| e.to_string())?;
    let compared = figures::compare(&spec.alone().spec, &Player::new(me, seed))?;
    print(&figures::tables(&compared))
}

fn costs(options: &Costs) -> Result<(), String> {
    if let Some(way) = &options.way {
        let times = costs::play(&costs::Way::named(way)?, options.matches)?;
        return print(&(serde_json::to_string(&times).map_err(|e| e.to_string())? + "\n"));
    }
    let me = std::env::current_exe().map_err(|e| e.to_string())?;
    let measured = costs::measure(&me, options.matches)?;
    if let Some(path) = &options.page {
        std::fs::write(path, costs::html(&measured)).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    print(&costs::tables(&measured))?;
    if options.no_sizes { Ok(()) } else { print(&costs::size::table(&costs::size::measure()?)) }
}

/// Who reads may stop reading.
fn print(text: &str) -> Result<(), String> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(e.to_string()),
        _ => Ok(()),
    }
}
