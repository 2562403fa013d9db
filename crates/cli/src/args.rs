//! The arguments of every command, with the help that teaches them.

use std::path::PathBuf;

use clap::{Args, ColorChoice, Parser, Subcommand, ValueEnum};
use lapwing_stream::Duration;

/// Says what must be true of a robot, and when it was not.
#[derive(Debug, Parser)]
#[command(name = "lapwing", version, about, long_about = LONG_ABOUT, after_help = AFTER_HELP, subcommand_required = true, arg_required_else_help = true)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

const LONG_ABOUT: &str = "\
Lapwing checks recordings of robots against specifications.

A specification is a text file that ends in .rv and says what must be true, for example

    decl speed /odom Odometry.twist.twist.linear.x
    never speed > 2.0 m/s

A recording is an MCAP file, a rosbag2 folder, a ROS 1 bag, a CSV file or NDJSON. Nothing has to be installed besides Lapwing, and
recordings bring the definitions of their messages along.";

const AFTER_HELP: &str = "\
Where to begin:
  lapwing demo                        see violations found on the built-in robots
  lapwing new run.mcap -o robot.rv    a specification to start from, with the topics of your recording
  lapwing check robot.rv run.mcap     check it
  lapwing monitor robot.rv --ros2     watch a robot that runs
  lapwing explain robot.rv run.mcap   what each property means, needs and costs

Exit codes: 0 all well; 1 a property failed; 2 the command line or a specification is wrong; 3 none failed, but something could not be
judged or read.";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Runs the built-in robots, and finds what they do wrong, in a folder to play with
    Demo(Demo),
    /// Checks recordings against specifications
    Check(Check),
    /// Watches a robot that runs
    Monitor(crate::monitor::args::Monitor),
    /// Runs the built-in simulator, into a file or straight into a check
    Sim(crate::sim::Sim),
    /// Checks the capsule of a violation again, to the same verdict
    Replay(Replay),
    /// Says how often each property would have fired, and which thresholds fit
    Backtest(crate::backtest::Backtest),
    /// Reads GenoM3 components: checks them, draws them, writes them as models
    Genom(crate::genom::Genom),
    /// Runs models in RT-BIP
    Bip(crate::bip::Bip),
    /// Writes a specification from a monitor of JavaMOP or a state diagram of Mermaid or SCXML
    Import(crate::import::Import),
    /// Writes monitors as source text, for machines without room for Lapwing
    Codegen(crate::codegen::Codegen),
    /// Says what a specification, or a diagnostic code, means
    Explain(Explain),
    /// Lays specifications out canonically, in place
    Fmt(Fmt),
    /// Writes a specification to start from
    New(New),
}

/// Arguments of `demo`.
#[derive(Debug, Args)]
#[command(after_help = "\
A car does not see a stop sign, and a robot gets stuck on the way into its dock: both are simulated, recorded and checked. Specifications and
recordings are written to DIR, so that you can change them. It exits with 0 although violations are shown: showing them is what it is for.")]
pub struct Demo {
    /// The folder to write to
    #[arg(default_value = "lapwing-demo")]
    pub dir: PathBuf,
    /// Whether to colour
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub color: ColorChoice,
}

/// Arguments of `check`.
#[derive(Debug, Args)]
#[command(after_help = "\
Arguments that end in .rv are specifications, the others are recordings: files, patterns such as 'runs/**/*.mcap', folders of
recordings, and - for NDJSON or CSV on standard input. Every specification is checked on every recording.

  lapwing check robot.rv run.mcap
  lapwing check robot.rv safety.rv runs/ --format junit > report.xml
  producer | lapwing check robot.rv - --format ndjson
  lapwing check robot.rv runs/ --margins    which run came closest to failing, and by how much
  lapwing check robot.rv run.mcap --report run.html    a page with charts, for a browser

Exit codes: 0 every property `satisfied` or `holds`; 1 at least one `violated` or `unmet`; 2 the command line or a specification is
wrong; 3 none failed, but one is `inconclusive`, or a recording could not be read whole.")]
pub struct Check {
    /// Specifications (*.rv) and recordings
    #[arg(required = true, value_name = "SPEC.rv... TRACE...")]
    pub words: Vec<String>,
    /// How to report
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: Format,
    /// Stop reading a recording at its first violation
    #[arg(long)]
    pub until_first_violation: bool,
    /// Say by how much each property missed changing its verdict
    ///
    /// Where the speed reaches 1.8, `never speed > 2.0` holds with a margin of 0.2; where it reaches 2.31, it fails with -0.31. What is just
    /// true or false counts as ±∞. A property that compares metres here and radians there has no margin. It takes time and memory.
    #[arg(long)]
    pub margins: bool,
    /// How much is judged at once
    #[command(flatten)]
    pub limits: Limits,
    /// Write a page with charts of what happened, for a browser
    ///
    /// One HTML file with everything in it: it needs no network and no other file. It implies --margins.
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,
    /// Write a folder for each violation that shows and replays it, into this one
    ///
    /// A capsule holds the recording from 5 s before the violation's beginning to 2 s after its failure, the specification, the verdict and an
    /// explanation. `lapwing replay` checks it again.
    #[arg(long, value_name = "DIR")]
    pub capsules: Option<PathBuf>,
    /// How many recordings to check at once [default: one per core]
    #[arg(short, long, value_name = "N")]
    pub jobs: Option<std::num::NonZeroUsize>,
    /// Only the K-th of every N recordings, as in 2/8: to share work between machines
    #[arg(long, value_name = "K/N")]
    pub shard: Option<Shard>,
    /// Say nothing of what is well: no progress, no warnings
    #[arg(short, long)]
    pub quiet: bool,
    /// Whether to colour
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub color: ColorChoice,
    /// How recordings are read
    #[command(flatten)]
    pub reading: Reading,
}

/// How much is judged at once.
#[derive(Clone, Copy, Debug, Args)]
pub struct Limits {
    /// How many runs of obligations a property may have open before it is given up as inconclusive [default: 65536]
    ///
    /// `whenever p, eventually q` opens one wherever p begins to hold, and keeps it until q comes.
    #[arg(long, value_name = "N")]
    pub open_limit: Option<std::num::NonZeroUsize>,
}

/// How recordings are read.
#[derive(Debug, Args)]
pub struct Reading {
    /// Which stamp is the time of a message: when it was recorded, or that of its header
    #[arg(long, value_name = "STAMP", default_value = "log")]
    pub time: Stamp,
    /// With --time header: how far apart messages may be and still be put in order
    #[arg(long, value_name = "DURATION", default_value = "1s", value_parser = duration)]
    pub reorder: Duration,
    /// A folder of message definitions, for recordings that do not bring their own and for messages that reactions write (repeatable)
    #[arg(long, value_name = "DIR")]
    pub msgs: Vec<PathBuf>,
}

/// Arguments of `replay`.
#[derive(Debug, Args)]
#[command(after_help = "\
A capsule is a folder that `lapwing check --capsules DIR` writes for each violation: the part of the recording around it, the
specification and the verdict. It can be sent to whoever shall look at it.

  lapwing check robot.rv run.mcap --capsules capsules/
  lapwing replay capsules/line-12-1

Exit codes: 1 the same violation, with the same beginning and failure; 3 it cannot be reproduced from the capsule; 2 it is no capsule.")]
pub struct Replay {
    /// The folder of a capsule
    pub capsule: PathBuf,
    /// Whether to colour
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub color: ColorChoice,
}

/// Arguments of `explain`.
#[derive(Debug, Args)]
#[command(after_help = "\
  lapwing explain robot.rv              each property in words, what it reads, what it costs
  lapwing explain robot.rv run.mcap     the same, with the types of that recording
  lapwing explain unknown-field         what a diagnostic code means
  lapwing explain robot.rv --format mermaid")]
pub struct Explain {
    /// A specification (*.rv), a pattern library (std.robot) or one of its patterns (std.robot.tracks), or a diagnostic code
    #[arg(value_name = "SPEC.rv | std.LIBRARY | CODE")]
    pub what: String,
    /// A recording to resolve types with
    pub trace: Option<String>,
    /// How to show it
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: Picture,
    /// How the recording is read
    #[command(flatten)]
    pub reading: Reading,
}

/// Arguments of `fmt`.
#[derive(Debug, Args)]
#[command(after_help = "\
Line breaks and comments stay as they are; blanks and indentation change. Formatting what has been formatted changes nothing.
With - standard input is formatted to standard output.")]
pub struct Fmt {
    /// Specifications, or -
    #[arg(required = true, value_name = "SPEC.rv")]
    pub specs: Vec<String>,
    /// Change nothing; exit with 1 where something would change
    #[arg(long)]
    pub check: bool,
}

/// Arguments of `new`.
#[derive(Debug, Args)]
#[command(after_help = "\
With a recording its topics are declared with their types, and a few properties stand ready, commented out.

  lapwing new run.mcap -o robot.rv")]
pub struct New {
    /// A recording whose topics to declare
    pub trace: Option<String>,
    /// The file to write; standard output without it
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// How the recording is read
    #[command(flatten)]
    pub reading: Reading,
}

/// The formats of reports.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Format {
    /// For people
    Text,
    /// An array with an object for each recording
    Json,
    /// One object per line, as things happen
    Ndjson,
    /// JUnit XML, for continuous integration
    Junit,
}

impl From<Format> for lapwing_react::Format {
    fn from(format: Format) -> lapwing_react::Format {
        match format {
            Format::Text => lapwing_react::Format::Text,
            Format::Json => lapwing_react::Format::Json,
            Format::Ndjson => lapwing_react::Format::Ndjson,
            Format::Junit => lapwing_react::Format::Junit,
        }
    }
}

/// The formats of explanations.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Picture {
    /// For people
    Text,
    /// State diagrams, and when each property puts which obligation, for Graphviz
    Dot,
    /// The same for Mermaid
    Mermaid,
    /// The same to be looked at as it is
    Svg,
}

/// Which stamp is the time of a message.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Stamp {
    /// When it was recorded
    Log,
    /// That of its header, where it has one
    Header,
}

/// The K-th of every N.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Shard {
    k: usize,
    n: usize,
}

impl Shard {
    /// Whether the recording with that number, from 0, is in it.
    pub fn has(self, number: usize) -> bool {
        number % self.n == self.k - 1
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Shard, String> {
        let wrong = || format!("`{text}` is no shard: write K/N with K from 1 to N, as in 2/8");
        let (k, n) = text.split_once('/').ok_or_else(wrong)?;
        let (k, n) = (k.parse().map_err(|_| wrong())?, n.parse().map_err(|_| wrong())?);
        if (1..=n).contains(&k) { Ok(Shard { k, n }) } else { Err(wrong()) }
    }
}

impl Reading {
    /// As the reader of recordings wants it.
    pub fn options(&self) -> lapwing_record::Options {
        lapwing_record::Options {
            time: match self.time {
                Stamp::Log => lapwing_record::TimeSource::Log,
                Stamp::Header => lapwing_record::TimeSource::Header,
            },
            reorder: self.reorder,
            msgs: self.msgs.clone(),
            ..lapwing_record::Options::default()
        }
    }
}

/// A duration as a specification writes it: `1s`, `250 ms`.
pub fn duration(text: &str) -> Result<Duration, String> {
    let wrong = || format!("`{text}` is no duration: write a number and one of ns, us, ms, s, min, h, as in 250ms");
    let split = text.find(|c: char| !c.is_ascii_digit() && c != '.').ok_or_else(wrong)?;
    let (number, unit) = text.split_at(split);
    let scale = match unit.trim() {
        "ns" => 1,
        "us" => 1_000,
        "ms" => 1_000_000,
        "s" => 1_000_000_000,
        "min" => 60_000_000_000,
        "h" => 3_600_000_000_000,
        _ => return Err(wrong()),
    };
    if number.parse::<f64>().is_err() {
        return Err(wrong());
    }
    lapwing_syntax::nanoseconds(number, scale).map(Duration::from_nanos).map_err(|_| wrong())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_and_shards_are_read() {
        assert_eq!(duration("250ms"), Ok(Duration::from_nanos(250_000_000)));
        assert_eq!(duration("1.5 s"), Ok(Duration::from_nanos(1_500_000_000)));
        assert!(["", "s", "1", "1 x", "1.2.3 s", "-1s"].iter().all(|t| duration(t).is_err()));
        let shard: Shard = "2/3".parse().unwrap();
        assert_eq!((0..6).filter(|i| shard.has(*i)).collect::<Vec<_>>(), [1, 4]);
        assert!(["0/3", "4/3", "1", "a/b", "1/0"].iter().all(|t| t.parse::<Shard>().is_err()));
    }

    #[test]
    fn the_command_line_is_well_formed() {
        use clap::CommandFactory;
        Arguments::command().debug_assert();
    }
}
