//! `lapwing sim`: the built-in simulator, into a file, straight into a check, or as a node of a live graph.

mod campaign;
mod live;
mod summary;

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::num::{NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};

use clap::{Args, ColorChoice};
use lapwing_sim::fault::{ALL, Order};
use lapwing_sim::scenario::{BUNDLED, similar};
use lapwing_sim::{Options, Scenario, record};
use lapwing_stream::Duration;

use crate::args::{Format, duration};
use crate::complain::{Complaint, say};
use crate::exit::Exit;
use crate::graph::Choice;

/// Arguments of `sim`.
#[derive(Debug, Args)]
#[command(after_help = "\
SCENARIO is the name of a scenario that comes with Lapwing, or a file that ends in .toml; docs/simulator.md says what may be in one. The same
scenario, seed and faults give the same run, to the bit.

  lapwing sim --list                                       what comes with Lapwing: scenarios and faults
  lapwing sim patrol -o run.mcap                           a recording, for Lapwing, Foxglove or rosbags
  lapwing sim patrol --fault frozen-scan@10..20            a scanner that is stuck for ten seconds
  lapwing sim stop-sign --check robot.rv                   no file: the run is checked while it goes on
  lapwing sim wander --runs 1000 --check robot.rv          a thousand runs, with the seeds 1 to 1000
  lapwing sim wander --runs 1000 --check robot.rv -o bad   and recordings of those that failed, in the folder `bad`
  lapwing sim docking --ros1                               in real time, as a node of ROS 1
  lapwing sim docking --ros2 --domain 42                   or of ROS 2
  lapwing sim docking --ros1 --outside                     whose base obeys what other nodes publish on /cmd_vel

Exit codes: without --check 0 when the run is written; with it those of `lapwing check`.")]
pub struct Sim {
    /// What to run: a name or a file (*.toml)
    #[arg(required_unless_present = "list")]
    pub scenario: Option<String>,
    /// List the scenarios and the faults that come with Lapwing
    #[arg(long)]
    pub list: bool,
    /// What chance depends on; of several runs, that of the first: the others follow it
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Something that goes wrong, of one robot (robot2:NAME) or of all, always or for a while, in seconds (repeatable)
    #[arg(long = "fault", value_name = "NAME[@FROM[..UNTIL]]")]
    pub faults: Vec<Order>,
    /// How long a run takes in simulated time [default: what the scenario says]
    #[arg(long, value_name = "DURATION", value_parser = duration)]
    pub duration: Option<Duration>,
    /// The recording to write [default: the scenario's name and .mcap]; of several runs, a folder for those that fail
    #[arg(short, long, value_name = "FILE.mcap")]
    pub output: Option<PathBuf>,
    /// Check the run against a specification (repeatable)
    #[arg(long, value_name = "SPEC.rv")]
    pub check: Vec<PathBuf>,
    /// How many runs
    #[arg(long, value_name = "N", default_value = "1", requires = "check")]
    pub runs: NonZeroU64,
    /// How many runs at once [default: one per core]
    #[arg(short, long, value_name = "N", requires = "check")]
    pub jobs: Option<NonZeroUsize>,
    /// How to report; as text, several runs are summed up by property
    #[arg(long, value_name = "FORMAT", default_value = "text", requires = "check")]
    pub format: Format,
    #[command(flatten)]
    pub graph: Choice,
    /// On a graph, robots obey the commands of other nodes on cmd_vel, and their programs speak on cmd_vel_original alone
    #[arg(long)]
    pub outside: bool,
    /// On a graph, so many times as fast as real time; /clock tells everybody
    #[arg(long, value_name = "TIMES", value_parser = speed)]
    pub speed: Option<f64>,
    /// Say nothing of what is well
    #[arg(short, long)]
    pub quiet: bool,
    /// Whether to colour
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub color: ColorChoice,
}

/// How many times as fast as real time.
fn speed(text: &str) -> Result<f64, String> {
    let times = text.trim_end_matches(['x', '×']).parse::<f64>().ok();
    times.filter(|times| (0.01..=1000.0).contains(times)).ok_or_else(|| "write a number from 0.01 to 1000".to_owned())
}

/// Runs the command.
pub fn run(sim: &Sim) -> Result<Exit, Complaint> {
    let Some(word) = sim.scenario.as_deref().filter(|_| !sim.list) else {
        // Where nobody reads the list there is nothing to be done.
        drop(io::stdout().write_all(list().as_bytes()));
        return Ok(Exit::Good);
    };
    let scenario = scenario(word)?;
    for order in &sim.faults {
        scenario.accepts(order).map_err(|e| Complaint::new(e.to_string()))?;
    }
    let is_live = sim.graph.ros1.is_some() || sim.graph.ros2;
    if is_live && !sim.check.is_empty() {
        let complaint = Complaint::new("a run on a live graph is not checked here");
        return Err(complaint.help(
            "`lapwing monitor` checks it, as it checks any robot; `-o FILE.mcap` records it for `lapwing check`",
        ));
    }
    if sim.outside && !is_live {
        return Err(Complaint::new("--outside needs a graph from which commands come: add --ros1 or --ros2"));
    }
    if sim.speed.is_some() && !is_live {
        return Err(Complaint::new(
            "without a graph a run is as fast as it can be: leave --speed out, or add --ros1 or --ros2",
        ));
    }
    if !sim.check.is_empty() {
        return campaign::run(sim, &scenario);
    }
    if let Some(graph) = sim.graph.join("/lapwing_sim")? {
        return live::run(sim, &scenario, graph);
    }
    let path = sim.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}.mcap", short(&scenario))));
    let count = write(&scenario, &options(sim, sim.seed), &path)?;
    if !sim.quiet {
        say(&format!("{}: {count} messages\n", path.display()));
    }
    Ok(Exit::Good)
}

/// How the run with that seed is to be done.
fn options(sim: &Sim, seed: u64) -> Options {
    Options { seed, faults: sim.faults.clone(), duration: sim.duration.map(Duration::seconds) }
}

/// Writes a run to a file.
pub fn write(scenario: &Scenario, options: &Options, path: &Path) -> Result<u64, Complaint> {
    let complain = |e: &dyn std::fmt::Display| Complaint::new(format!("{}: {e}", path.display()));
    let file = File::create(path).map_err(|e| complain(&e))?;
    record(scenario, options, BufWriter::new(file)).map_err(|e| complain(&e))
}

/// The scenario that a word names.
fn scenario(word: &str) -> Result<Scenario, Complaint> {
    if let Some(bundled) = Scenario::bundled(word) {
        return bundled.map_err(|e| Complaint::new(e.to_string()));
    }
    let path = Path::new(word);
    if path.exists() {
        return Scenario::load(path).map_err(|e| Complaint::rendered(format!("error: {e}\n")));
    }
    let complaint = Complaint::new(format!("{word}: there is no such scenario, and no such file"));
    Err(match similar(word, BUNDLED.iter().map(|(name, _)| *name)) {
        Some(name) => complaint.help(format!("did you mean `{name}`?")),
        None => complaint.help("`lapwing sim --list` says which come with Lapwing"),
    })
}

/// The name of a scenario without its folder and without `.toml`.
fn short(scenario: &Scenario) -> String {
    let name = Path::new(scenario.name());
    name.file_stem().map_or_else(|| scenario.name().to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// The scenarios and the faults that come with Lapwing.
fn list() -> String {
    let about = |name: &str| match Scenario::bundled(name) {
        Some(Ok(scenario)) => scenario.file().about.clone(),
        Some(Err(error)) => error.to_string(),
        None => String::new(),
    };
    let scenarios = BUNDLED.iter().map(|(name, _)| format!("  {name:<20} {}\n", about(name)));
    let faults = ALL.iter().map(|about| {
        let bug = if about.bug.is_empty() { String::new() } else { format!(" ({})", about.bug) };
        format!("  {:<20} {}{bug}\n", about.name, about.what)
    });
    format!("Scenarios:\n{}\nFaults:\n{}", scenarios.collect::<String>(), faults.collect::<String>())
}
