//! `lapwing bip`: runs models in RT-BIP.

use std::cell::RefCell;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use clap::{Args, Subcommand, ValueEnum};
use lapwing_bip::ast::Package;
use lapwing_bip::{
    Bound, Detail, Ending, Log, Model, Monotonic, Options, Pace, Policy, Rules, Run, Schedule, Simulated, Sink, check,
    parse, standard,
};
use lapwing_diag::{Diagnostic, SourceMap, render};
use lapwing_stream::Duration;

use crate::args::duration;
use crate::complain::{Complaint, say, styles};
use crate::exit::Exit;

/// Arguments of `bip`.
#[derive(Debug, Args)]
pub struct Bip {
    /// What to do with a model
    #[command(subcommand)]
    pub command: BipCommand,
}

/// What can be done with a model.
#[derive(Debug, Subcommand)]
pub enum BipCommand {
    /// Runs a model, in simulated or in real time
    Run(RunModel),
}

/// Arguments of `bip run`.
#[derive(Debug, Args)]
#[command(after_help = "\
A model is a text in the language RT-BIP; docs/bip.md says how Lapwing understands it. Time is simulated unless --real-time is given: then the run
takes as long as it says, and actions that take too long are found.

  lapwing bip run model.bip                     what is possible in each state, and what chance chooses
  lapwing bip run model.bip --seed 7 --asap     the same on every machine, everything as soon as possible
  lapwing bip run model.bip --interactive       you choose; answers may come through a pipe
  lapwing bip run model.bip --real-time --on-violation warn

Exit codes: 0 the run came to an end; 1 a net is not deterministic; 2 a net is not 1-safe, or the command line or the model is wrong; 3 priorities
go in a circle; 4 those of an atom do; 5 an invariant is violated; 6 an event was not expected; 7 an action took too long; 8 a computation failed.")]
pub struct RunModel {
    /// The model (*.bip)
    #[arg(value_name = "FILE.bip")]
    pub file: PathBuf,
    /// The compound to begin with [default: the only one that no other uses, or Root]
    #[arg(long, value_name = "NAME")]
    pub root: Option<String>,
    /// Let time pass as it does outside
    #[arg(long)]
    pub real_time: bool,
    /// Make every step as soon as it is possible, not at a moment that is drawn
    #[arg(short, long)]
    pub asap: bool,
    /// Make the step that is possible first, not the one that is planned first
    #[arg(short, long)]
    pub first_enabled: bool,
    /// What chance depends on [default: the time of day]
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Stop after so many steps
    #[arg(short, long, value_name = "N")]
    pub limit: Option<u64>,
    /// Say only what goes wrong, and what the model prints
    #[arg(short, long)]
    pub silent: bool,
    /// Say what is possible in each state and what is chosen; this is the default
    #[arg(short, long, conflicts_with = "silent")]
    pub verbose: bool,
    /// Ask which step to make
    #[arg(short, long, conflicts_with = "silent")]
    pub interactive: bool,
    /// What to do when an action took longer than its `resume`, or a deadline was missed
    #[arg(long, value_name = "WHAT", default_value = "stop")]
    pub on_violation: OnViolation,
    /// By how much a deadline may be missed in real time without a word
    #[arg(long, value_name = "DURATION", default_value = "1ms", value_parser = duration)]
    pub tolerance: Duration,
    /// Do not look at deadlines in real time, only at `resume`
    #[arg(long)]
    pub relaxed: bool,
    /// Let smaller interactions of a connector happen although larger ones can (this is not BIP any more)
    #[arg(long)]
    pub disable_maximal_progress: bool,
    /// Where to look for packages that the model uses (repeatable)
    #[arg(short = 'I', value_name = "DIR")]
    pub include: Vec<PathBuf>,
}

/// What to do when time went on too far.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum OnViolation {
    /// Warn and go on
    Warn,
    /// Stop, with exit code 7
    Stop,
}

/// Runs the command.
pub fn run(bip: &Bip) -> Result<Exit, Complaint> {
    let BipCommand::Run(arguments) = &bip.command;
    let model = load(arguments)?;
    let sink: Sink<'_> = Rc::new(RefCell::new(BufWriter::new(io::stdout())));
    let pace = if arguments.real_time { Pace::RealTime } else { Pace::Simulated };
    let host = standard(&sink, pace).bind(&model.model).map_err(|found| model.complaint(&found))?;
    let detail = if arguments.silent { Detail::Silent } else { Detail::Verbose };
    let log = Log::new(sink, detail);
    let ending = match arguments.real_time {
        true => go(Run::new(options(arguments), Monotonic::start(), log), arguments, &model, host),
        false => go(Run::new(options(arguments), Simulated::default(), log), arguments, &model, host),
    };
    if let Ending::Fault(lapwing_bip::Fault::Computation { at, .. }) = &ending {
        let (line, column) = model.sources.position(*at);
        say(&format!("  at {}:{line}:{column}\n", model.sources.name(at.file)));
    }
    Ok(Exit::Bip(ending.code()))
}

fn go<'r, W: lapwing_bip::World>(
    run: Run<'r, Bound<'r>, W>,
    arguments: &RunModel,
    model: &Loaded,
    host: Bound<'r>,
) -> Ending {
    let run = match arguments.on_violation {
        OnViolation::Warn => run.policy(Policy::Warn),
        OnViolation::Stop => run,
    };
    let run = if arguments.interactive { run.interactive(io::stdin().lock()) } else { run };
    run.run(Arc::clone(&model.model), host)
}

fn options(arguments: &RunModel) -> Options {
    let by_day = || SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    Options {
        schedule: Schedule { asap: arguments.asap, first_enabled: arguments.first_enabled },
        seed: arguments.seed.unwrap_or_else(by_day),
        limit: arguments.limit,
        rules: Rules { without_maximal_progress: arguments.disable_maximal_progress },
        tolerance: arguments.tolerance.nanos(),
        relaxed: arguments.relaxed,
    }
}

/// A model, with the texts that it was made from.
struct Loaded {
    sources: SourceMap,
    model: Arc<Model>,
}

impl Loaded {
    fn complaint(&self, found: &[Diagnostic]) -> Complaint {
        complaint(&self.sources, found)
    }
}

fn complaint(sources: &SourceMap, found: &[Diagnostic]) -> Complaint {
    let (_, style) = styles(clap::ColorChoice::Auto);
    Complaint::rendered(found.iter().map(|d| render(sources, d, style)).collect())
}

/// Reads a model with the packages that it uses.
fn load(arguments: &RunModel) -> Result<Loaded, Complaint> {
    let mut sources = SourceMap::default();
    let mut found = Vec::new();
    let main = read(&arguments.file, &mut sources, &mut found)
        .map_err(|e| Complaint::new(format!("{}: {e}", arguments.file.display())))?;
    let used = packages(arguments, &main, &mut sources, &mut found)?;
    let checked = check(&main, &used);
    found.extend(checked.diagnostics.iter().cloned());
    if lapwing_diag::has_errors(&found) {
        return Err(complaint(&sources, &found));
    }
    complaint(&sources, &found).tell();
    match checked.model(arguments.root.as_deref()) {
        Ok(model) => Ok(Loaded { sources, model: Arc::new(model) }),
        Err(found) => Err(match found.as_slice() {
            // What is wrong with the command line has no place in the text.
            [one] if one.code == lapwing_diag::Code::BipRoot => {
                one.help.iter().fold(Complaint::new(one.message.clone()), |complaint, help| complaint.help(help))
            }
            found => complaint(&sources, found),
        }),
    }
}

fn read(path: &Path, sources: &mut SourceMap, found: &mut Vec<Diagnostic>) -> io::Result<Package> {
    let text = lapwing_diag::read_text(path)?;
    let file = sources.add(path.to_string_lossy(), text.as_str());
    let parsed = parse(file, &text);
    found.extend(parsed.diagnostics);
    Ok(parsed.package)
}

/// The packages that a package uses, and those that they use. What is not found is left out: the check says so.
fn packages(
    arguments: &RunModel,
    main: &Package,
    sources: &mut SourceMap,
    found: &mut Vec<Diagnostic>,
) -> Result<Vec<Package>, Complaint> {
    let beside = arguments.file.parent().map_or(PathBuf::new(), Path::to_path_buf);
    let folders: Vec<&Path> = std::iter::once(&beside).chain(&arguments.include).map(PathBuf::as_path).collect();
    let mut names: Vec<String> = main.uses.iter().map(|p| p.text()).collect();
    let mut packages: Vec<Package> = Vec::new();
    let mut next = 0;
    while let Some(name) = names.get(next).cloned() {
        next += 1;
        let last = name.rsplit('.').next().unwrap_or(&name).to_owned();
        let files = [format!("{}.bip", name.replace('.', "/")), format!("{last}.bip")];
        let path = folders.iter().flat_map(|f| files.iter().map(|file| f.join(file))).find(|path| path.is_file());
        let Some(path) = path else { continue };
        let package = read(&path, sources, found).map_err(|e| Complaint::new(format!("{}: {e}", path.display())))?;
        let more: Vec<String> = package.uses.iter().map(|p| p.text()).filter(|n| !names.contains(n)).collect();
        names.extend(more);
        packages.push(package);
    }
    // Packages that others use come before them.
    packages.reverse();
    Ok(packages)
}
