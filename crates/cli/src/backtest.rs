//! `lapwing backtest`: how often each property would have fired, and which thresholds fit.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ColorChoice, ValueEnum};
use lapwing::tune::{Tunable, search};
use lapwing::{Options, Report, Session, Spec};
use lapwing_react::Standing;
use lapwing_react::backtest::{Backtest as Account, Mark, Tried, Tuned, json, text};

use crate::args::Reading;
use crate::complain::{Complaint, say, styles};
use crate::exit::Exit;
use crate::onlooker::Onlooker;
use crate::words::{is_spec, recordings, specs};
use crate::{interrupt, jobs};

/// Arguments of `backtest`.
#[derive(Debug, Args)]
#[command(after_help = "\
Recordings of runs that went well are marked by --good, those in which something went wrong by --bad: files, patterns in quotes, or folders.
They need not be given twice. A recording in a folder named `good` or `bad` is marked by that.

  lapwing backtest robot.rv runs/                                        how often would each property have fired?
  lapwing backtest robot.rv --good 'ok/*' --bad 'faulty/*' --tune gap    the smallest `gap = 100 ms` without a false alarm

Exit codes: 0 done; 1 no value of the tuned name fits; 2 the command line or a specification is wrong; 3 a recording could not be read
whole.")]
pub struct Backtest {
    /// Specifications (*.rv) and recordings
    #[arg(required = true, value_name = "SPEC.rv... TRACE...")]
    pub words: Vec<String>,
    /// Recordings in which the robot did what it should: an alarm there is a false one (repeatable)
    #[arg(long, value_name = "TRACE")]
    pub good: Vec<String>,
    /// Recordings in which something went wrong that must be caught (repeatable)
    #[arg(long, value_name = "TRACE")]
    pub bad: Vec<String>,
    /// A number or duration that the specification gives this name: find the smallest value without an alarm on what is good while all that is
    /// bad is caught
    #[arg(long, value_name = "NAME")]
    pub tune: Option<String>,
    /// How to report
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: Format,
    /// How many recordings to read at once [default: one per core]
    #[arg(short, long, value_name = "N")]
    pub jobs: Option<std::num::NonZeroUsize>,
    /// Whether to colour
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub color: ColorChoice,
    /// How recordings are read
    #[command(flatten)]
    pub reading: Reading,
}

/// The formats of a backtest.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Format {
    /// For people
    Text,
    /// One object
    Json,
}

/// Runs the command.
pub fn run(backtest: &Backtest) -> Result<Exit, Complaint> {
    let (stdout, stderr) = styles(backtest.color);
    let (spec_words, traces): (Vec<String>, Vec<String>) = backtest.words.iter().cloned().partition(|w| is_spec(w));
    if spec_words.is_empty() {
        return Err(Complaint::new("no specification is given: one of the arguments must end in .rv"));
    }
    let specs = specs(&spec_words.iter().map(PathBuf::from).collect::<Vec<_>>(), &backtest.reading.msgs, stderr)?;
    let runs = marked(&traces, &backtest.good, &backtest.bad)?;
    let bench = Bench {
        runs: &runs,
        options: Options { recording: backtest.reading.options(), margins: true, ..Options::default() },
        threads: jobs::threads(backtest.jobs),
    };
    interrupt::listen();
    let mut account = Account::default();
    let reports = bench.reports(&specs, &bench.options);
    for (run, report) in runs.iter().zip(&reports) {
        account.add(report, run.mark);
    }
    if let Some(name) = &backtest.tune {
        account.tuned = tune(&bench, &account, &specs, name)?;
    }
    let shown = match backtest.format {
        Format::Text => text(&account, stdout),
        Format::Json => json(&account),
    };
    // Where nobody reads it there is nothing to be done.
    drop(io::stdout().write_all(shown.as_bytes()));
    let is_whole = reports.len() == runs.len() && reports.iter().all(|r| r.gaps.is_empty()) && !interrupt::was_heard();
    let fits = account.tuned.as_ref().is_none_or(|tuned| tuned.fits.is_some());
    Ok(match (fits, is_whole) {
        (false, _) => Exit::Failed,
        (true, whole) => Exit::of(Standing::Good, whole),
    })
}

/// A recording, and what is known of it.
#[derive(Clone)]
struct Run {
    trace: PathBuf,
    mark: Mark,
}

/// The recordings that words name, each once; those marked good and bad need no other mention.
fn marked(traces: &[String], good: &[String], bad: &[String]) -> Result<Vec<Run>, Complaint> {
    if traces.iter().chain(good).chain(bad).any(|t| t == "-") {
        return Err(Complaint::new("standard input cannot be read several times: save it to a file first"));
    }
    let of = |words: &[String]| if words.is_empty() { Ok(Vec::new()) } else { recordings(words) };
    let (plain, good, bad) = (of(traces)?, of(good)?, of(bad)?);
    if let Some(both) = good.iter().find(|trace| bad.contains(trace)) {
        return Err(Complaint::new(format!("{}: it is marked good and bad", both.display())));
    }
    let mut runs: Vec<Run> = Vec::new();
    for trace in plain.iter().chain(&good).chain(&bad) {
        if runs.iter().any(|r| r.trace == *trace) {
            continue;
        }
        let mark = match () {
            () if good.contains(trace) => Mark::Good,
            () if bad.contains(trace) => Mark::Bad,
            () => by_folder(trace),
        };
        runs.push(Run { trace: trace.clone(), mark });
    }
    if runs.is_empty() {
        return Err(Complaint::new("no recording is given"));
    }
    Ok(runs)
}

/// What the nearest folder of that name says.
fn by_folder(trace: &Path) -> Mark {
    let folders = trace.ancestors().skip(1).filter_map(|folder| folder.file_name()?.to_str());
    let mut marks = folders.filter_map(|name| match name {
        "good" => Some(Mark::Good),
        "bad" => Some(Mark::Bad),
        _ => None,
    });
    marks.next().unwrap_or_default()
}

/// Recordings, and how they are read.
struct Bench<'b> {
    runs: &'b [Run],
    options: Options,
    threads: usize,
}

impl Bench<'_> {
    /// What is said of each recording. Several specifications read it once.
    fn reports(&self, specs: &[Spec], options: &Options) -> Vec<Report> {
        let one = |number: usize| {
            let trace = &self.runs[number].trace;
            match Session::open(specs, trace, options) {
                Ok(session) => session.run(&mut Onlooker::default()),
                Err(why) => lapwing::unopened(specs, trace, &why, &mut ()),
            }
        };
        jobs::spread(self.runs.len(), self.threads, one).into_iter().map(|(_, report)| report).collect()
    }

    /// What each value of a name does to the recordings, judged by the properties on those lines.
    fn judge(
        &self,
        spec: &Spec,
        tunable: &Tunable,
        lines: &[usize],
        values: &[f64],
    ) -> Result<Vec<Tried>, Interrupted> {
        let label = |k: usize| format!("{}, value {k}", spec.name());
        let variants: Vec<Option<Spec>> =
            values.iter().enumerate().map(|(k, v)| tunable.with(spec, *v, &label(k)).ok()).collect();
        let usable: Vec<Spec> = variants.iter().flatten().cloned().collect();
        let options = Options { margins: false, ..self.options.clone() };
        let reports = self.reports(&usable, &options);
        // What was not read would count as neither an alarm nor a miss.
        if interrupt::is_stopped() {
            return Err(Interrupted);
        }
        let fires = |report: &Report, label: &str| {
            report.properties.iter().any(|p| p.file == label && p.has_failed() && lines.contains(&p.line))
        };
        let one = |(k, value): (usize, &f64)| {
            // A value that the specification cannot have fits nothing.
            let cannot = variants.get(k).is_none_or(Option::is_none);
            let fired: Vec<(Mark, bool)> =
                self.runs.iter().zip(&reports).map(|(run, report)| (run.mark, fires(report, &label(k)))).collect();
            let count =
                |wanted: (Mark, bool)| fired.iter().filter(|f| cannot && f.0 == wanted.0 || **f == wanted).count();
            Tried { value: *value, false_alarms: count((Mark::Good, true)), missed: count((Mark::Bad, false)) }
        };
        Ok(values.iter().enumerate().map(one).collect())
    }
}

/// The user ended a search, which therefore has no result.
struct Interrupted;

/// Searches for the values of a name that fit the marked recordings; `None` where the user ended the search.
fn tune(bench: &Bench<'_>, account: &Account, specs: &[Spec], name: &str) -> Result<Option<Tuned>, Complaint> {
    let [spec] = specs else {
        return Err(Complaint::new("--tune takes one specification: the one in which the name stands"));
    };
    let marked = (account.marked(Mark::Good), account.marked(Mark::Bad));
    if marked == (0, 0) {
        return Err(Complaint::new("--tune needs to know which recordings are good and which are bad")
            .help("mark them: --good 'ok/*' --bad 'faulty/*', or put them into folders named good and bad"));
    }
    let tunable = Tunable::find(spec, name).map_err(Complaint::new)?;
    let lines = tunable.lines(spec);
    let properties: Vec<String> =
        account.properties.iter().filter(|p| lines.contains(&p.line)).map(|p| p.name.clone()).collect();
    if properties.is_empty() {
        return Err(Complaint::new(format!("no property depends on `{name}`")));
    }
    if marked.0 == 0 || marked.1 == 0 {
        let (which, what) = if marked.0 == 0 { ("good", "large") } else { ("bad", "small") };
        say(&format!("warning: no recording is marked {which}: nothing says that a value is too {what}\n"));
    }
    let runs: Vec<Run> = bench.runs.iter().filter(|run| run.mark != Mark::Unmarked).cloned().collect();
    let bench = Bench { runs: &runs, options: bench.options.clone(), threads: bench.threads };
    let Ok(found) = search(tunable.value, |values| bench.judge(spec, &tunable, &lines, values)) else {
        return Ok(None);
    };
    // The first round has the value that stands there.
    let current = found.tried.iter().copied().find(|t| t.value == tunable.value).unwrap_or_default();
    let values = found.tried.iter().map(|t| t.value);
    let searched = (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max));
    Ok(Some(Tuned {
        name: name.to_owned(),
        unit: tunable.unit.clone(),
        current,
        fits: found.fits,
        searched,
        tried: found.tried,
        properties,
        marked,
    }))
}
