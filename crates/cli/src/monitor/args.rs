//! The arguments of `monitor`.

use std::path::PathBuf;

use clap::{Args, ColorChoice, ValueEnum};
use lapwing::live::ClockChoice;

use crate::args::{Format, Reading};
use crate::graph::Choice;

/// Arguments of `monitor`.
#[derive(Debug, Args)]
#[command(after_help = "\
No ROS has to be installed: topics and their types are asked of the robot. What a specification may do to the robot, by `on violation` and
`guard`, is said before it starts.

  lapwing monitor robot.rv --ros2                    domain of ROS_DOMAIN_ID, else 0
  lapwing monitor robot.rv --ros2 --domain 7
  lapwing monitor robot.rv --ros1                    the master at ROS_MASTER_URI
  lapwing monitor robot.rv --ros2 --record run.mcap  and later: lapwing check robot.rv run.mcap
  lapwing monitor robot.rv --ros2 --serve 8080       a page that shows how things stand, and /metrics for Prometheus
  lapwing monitor robot.rv --ros2 --dry-run          reactions are only told

Ctrl-C and SIGTERM end it with a report; SIGHUP reads the specifications again.

Exit codes: 0 every property `satisfied` or `holds`; 1 at least one `violated` or `unmet`; 2 the command line or a specification is
wrong; 3 none failed, but one is `inconclusive`.")]
pub struct Monitor {
    /// Specifications (*.rv)
    #[arg(required = true, value_name = "SPEC.rv")]
    pub specs: Vec<String>,
    /// Which graph
    #[command(flatten)]
    pub graph: Choice,
    /// What Lapwing is called on the graph
    #[arg(long, value_name = "NAME", default_value = "lapwing")]
    pub node: String,
    /// How to report
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: Format,
    /// How to show what happens, where standard output is a terminal
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub view: Look,
    /// End at the first violation
    #[arg(long)]
    pub until_first_violation: bool,
    /// Say by how much each property missed changing its verdict
    #[arg(long)]
    pub margins: bool,
    /// How much is judged at once
    #[command(flatten)]
    pub limits: crate::args::Limits,
    /// Record what was seen: checking that file gives the same verdicts
    #[arg(long, value_name = "FILE.mcap")]
    pub record: Option<PathBuf>,
    /// Write a page with charts of what happened at the end, for a browser
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
    /// Write a folder for each violation at the end that shows and replays it, into this one; it is cut from the recording
    #[arg(long, value_name = "DIR", requires = "record")]
    pub capsules: Option<PathBuf>,
    /// Show how things stand on a page, and as metrics, at this port or address; this machine only unless the address says otherwise
    #[arg(long, value_name = "[ADDRESS:]PORT")]
    pub serve: Option<String>,
    /// Show what happens to Foxglove, by its WebSocket protocol, at this port or address; this machine only unless the address says otherwise
    #[cfg(feature = "foxglove")]
    #[arg(long, value_name = "[ADDRESS:]PORT")]
    pub foxglove: Option<String>,
    /// Only say what reactions and guards would do
    #[arg(long)]
    pub dry_run: bool,
    /// The only topics and services that reactions and guards may touch (repeatable)
    #[arg(long, value_name = "NAME")]
    pub allow: Vec<String>,
    /// Publish nothing of Lapwing's own on the graph, neither /diagnostics nor ~/verdicts
    #[arg(long)]
    pub no_diagnostics: bool,
    /// Which clock stamps: `auto` takes /clock where somebody publishes it
    #[arg(long, value_name = "CLOCK", default_value = "auto")]
    pub clock: ClockName,
    /// Say nothing of what is well: only violations
    #[arg(short, long)]
    pub quiet: bool,
    /// Whether to colour
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub color: ColorChoice,
    /// How messages are read
    #[command(flatten)]
    pub reading: Reading,
}

/// How what happens is shown.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Look {
    /// A screen on a terminal, else lines
    Auto,
    /// Lines
    Lines,
    /// A screen
    Screen,
}

/// The names of clocks.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum ClockName {
    /// Simulated time if somebody publishes it within a second, else the wall clock
    Auto,
    /// The wall clock
    Wall,
    /// Simulated time: nothing counts before the first /clock
    Sim,
}

impl From<ClockName> for ClockChoice {
    fn from(name: ClockName) -> ClockChoice {
        match name {
            ClockName::Auto => ClockChoice::Auto,
            ClockName::Wall => ClockChoice::Wall,
            ClockName::Sim => ClockChoice::Simulated,
        }
    }
}
