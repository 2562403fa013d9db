//! `lapwing genom run`: components run, with codels or without, watched by specifications.

use std::fs::File;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread;

use clap::Args;
use lapwing_components::{
    Client, Codels, Failure, Happening, Observer, Recorder, Run, Setup, Teller, Types, Watch, What, place, request,
    stamp,
};
use lapwing_diag::{SourceMap, Style};
use lapwing_genom::mutex::Rules;
use lapwing_genom::{Loaded, Model};
use lapwing_react::{Format, Standing, Tally, end, render};
use lapwing_stream::Duration;

use super::{ModelArguments, read};
use crate::complain::{Complaint, say, styles};
use crate::exit::Exit;
use crate::interrupt;
use crate::words::specs;

/// How long logical time goes on where nobody says.
const USUAL_NS: i64 = 10_000_000_000;

/// Arguments of `run`.
#[derive(Debug, Args)]
pub struct RunArguments {
    /// As for every model.
    #[command(flatten)]
    pub model: ModelArguments,
    /// A shared library with codels in C (repeatable): `lapwing genom headers` writes what they are compiled with
    #[arg(long, value_name = "LIB")]
    pub codels: Vec<PathBuf>,
    /// Call them in processes of their own, one for each component: one that crashes or hangs takes nothing along
    #[arg(long)]
    pub isolate: bool,
    /// A specification that watches the run, and whose reactions request services (repeatable)
    #[arg(long, value_name = "SPEC.rv")]
    pub spec: Vec<PathBuf>,
    /// Requests, one on each line: `@1s LaserDriver.SetDelay(delay=0.2)`; `-` is standard input, in real time as it comes
    #[arg(long, value_name = "FILE")]
    pub requests: Option<PathBuf>,
    /// Write the run down, as MCAP, or as NDJSON where the name ends in .ndjson; `lapwing check` judges it again
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
    /// Run by the machine's clock; else time is only counted
    #[arg(long)]
    pub real_time: bool,
    /// What chance depends on, in logical time
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// How long to run: 10s, 500ms; 10s where nothing is said, and in real time without end
    #[arg(long, value_name = "TIME", value_parser = crate::args::duration)]
    pub duration: Option<Duration>,
    /// After how long a codel that does not return counts as hung: in real time, and with --isolate always
    #[arg(long, value_name = "TIME", value_parser = crate::args::duration, default_value = "5s")]
    pub patience: Duration,
    /// In real time, let every task call its codels on a thread of its own, also those that return at once
    #[arg(long, requires = "real_time")]
    pub own_threads: bool,
    /// Tell of every codel and of everything that is written to a port
    #[arg(long)]
    pub verbose: bool,
    /// How to report what became of the properties
    #[arg(long, value_name = "FORMAT", default_value = "text")]
    pub format: crate::args::Format,
}

/// Runs the command.
pub fn run(arguments: &RunArguments) -> Result<Exit, Complaint> {
    let loaded = read(&arguments.model.reading)?;
    if loaded.model.components.is_empty() {
        return Err(Complaint::new("there is no component to run"));
    }
    let (stdout, stderr) = styles(arguments.model.reading.color);
    let usual = (!arguments.real_time).then_some(Duration::from_nanos(USUAL_NS));
    let setup = Setup {
        is_real: arguments.real_time,
        seed: arguments.seed,
        duration: arguments.duration.or(usual),
        instances: arguments.model.instances,
        rules: Rules { readers_share: arguments.model.readers_share },
        patience: arguments.patience,
        own_threads: arguments.own_threads,
    };
    let Loaded { model, sources, .. } = loaded;
    let model = Arc::new(model);
    let codels = codels(arguments, &model)?;
    let mut run = Run::new(model.clone(), setup, codels).map_err(|e| Complaint::new(e.to_string()))?;
    let specs = specs(&arguments.spec, &[], stderr)?;
    let has_specs = !specs.is_empty();
    let mut watch = Watch::new(specs, &run, stderr).map_err(|wrong| Complaint::rendered(wrong.0))?;
    if let Some(path) = &arguments.requests {
        ask(&mut run, path, arguments.real_time)?;
    }
    let recorder = arguments.record.as_deref().map(|path| Recorder::create(path, watch.signals()));
    let recorder = recorder.transpose().map_err(Complaint::new)?;
    if recorder.is_none() {
        watch.skip_unread();
    }
    interrupt::listen();
    if let Some(client) = run.client() {
        thread::spawn(move || stop_when_interrupted(&client));
    }
    let types = run.types().clone();
    let format: Format = arguments.format.into();
    let told = Told {
        model,
        types,
        sources,
        is_verbose: arguments.verbose,
        is_text: format == Format::Text,
        watch,
        recorder,
        failure: None,
    };
    let (run, told) = run.carry_out(told);
    told.conclude(&run, format, stdout, has_specs)
}

/// The codels of all libraries.
fn codels(arguments: &RunArguments, model: &Model) -> Result<Codels, Complaint> {
    let mut all = Codels::new();
    for path in &arguments.codels {
        let loaded = match arguments.isolate {
            true => isolated(path, model, arguments.patience),
            false => lapwing_codels::load(path, model),
        };
        all.join(loaded.map_err(|e| Complaint::new(e.to_string()))?);
    }
    Ok(all)
}

#[cfg(unix)]
fn isolated(path: &Path, model: &Model, patience: Duration) -> Result<Codels, lapwing_codels::LoadError> {
    let program = std::env::current_exe().map_err(|e| lapwing_codels::LoadError(e.to_string()))?;
    let isolation = lapwing_codels::Isolation {
        program,
        arguments: ["genom", "serve"].map(str::to_owned).to_vec(),
        patience: std::time::Duration::from_nanos(u64::try_from(patience.nanos()).unwrap_or(0)),
    };
    lapwing_codels::isolate(path, model, &isolation)
}

#[cfg(not(unix))]
fn isolated(_: &Path, _: &Model, _: Duration) -> Result<Codels, lapwing_codels::LoadError> {
    Err(lapwing_codels::LoadError("codels can be isolated on Unix only".to_owned()))
}

fn stop_when_interrupted(client: &Client) {
    while !interrupt::is_stopped() {
        thread::sleep(std::time::Duration::from_millis(20));
    }
    client.stop();
}

/// Has the requests of a file made, or those that come on standard input.
fn ask(run: &mut Run, path: &Path, is_real: bool) -> Result<(), Complaint> {
    let (model, types) = (run.model().clone(), run.types().clone());
    if let (true, true, Some(client)) = (path == Path::new("-"), is_real, run.client()) {
        thread::spawn(move || listen(&client, &model, &types));
        return Ok(());
    }
    requests_of(path, &model, &types)?.into_iter().for_each(|(time, request)| run.schedule(time, request));
    Ok(())
}

/// The requests of a file, or of standard input.
pub fn requests_of(path: &Path, model: &Model, types: &Types) -> Result<Vec<request::Timed>, Complaint> {
    let text = match path == Path::new("-") {
        true => io::read_to_string(io::stdin()),
        false => lapwing_diag::read_text(path),
    };
    let text = text.map_err(|e| Complaint::new(format!("{} cannot be read: {e}", path.display())))?;
    request::file(model, types, &text).map_err(|errors| {
        let one = |e: &request::RequestError| format!("error: {}:{e}\n", path.display());
        Complaint::rendered(errors.iter().map(one).collect())
    })
}

/// Makes requests as their lines come; a time before one is passed over.
fn listen(client: &Client, model: &Model, types: &Types) {
    let mut lines = request::Lines::new(io::stdin().lock());
    while let Some((number, line)) = lines.next() {
        let read = line.and_then(|line| request::timed(model, types, &line, number));
        match read {
            Ok(Some((_, request))) => {
                if !client.request(request) {
                    return;
                }
            }
            Ok(None) => {}
            Err(error) => say(&format!("error: standard input:{error}\n")),
        }
    }
}

/// A run as it is told.
struct Told {
    model: Arc<Model>,
    types: Types,
    sources: SourceMap,
    is_verbose: bool,
    is_text: bool,
    watch: Watch,
    recorder: Option<Recorder<File>>,
    failure: Option<Failure>,
}

impl Observer for Told {
    fn see(&mut self, run: &mut Run, happening: &Happening) {
        let messages = self.watch.see(run, happening);
        if let Some(recorder) = &mut self.recorder
            && !recorder.write(happening.time, &messages)
        {
            run.stop();
        }
        let (model, types, sources) = (&self.model, &self.types, &self.sources);
        let teller = Teller { model, types, sources, is_verbose: self.is_verbose };
        let mut lines: Vec<String> = self.is_text.then(|| teller.line(happening)).flatten().into_iter().collect();
        while let Some(news) = self.watch.news() {
            let what = format!("violation {}: {}", news.property.name, news.property.text.trim());
            lines.push(format!("{} {}", stamp(happening.time), what.replace('\n', " ")));
        }
        if self.is_text && !lines.is_empty() && writeln!(io::stdout(), "{}", lines.join("\n")).is_err() {
            run.stop();
        }
        if let What::Failed(found) = &happening.what {
            self.failure = Some((**found).clone());
        }
        if interrupt::is_stopped() {
            run.stop();
        }
    }
}

impl Told {
    /// What is said at the end.
    fn conclude(mut self, run: &Run, format: Format, style: Style, has_specs: bool) -> Result<Exit, Complaint> {
        if let Some(recorder) = self.recorder.take() {
            recorder.finish().map_err(|e| Complaint::new(format!("the recording cannot be written: {e}")))?;
        }
        let gap = self.failure.as_ref().map(|failure| self.failed(failure));
        let mut text = if self.is_text { figures(run) } else { String::new() };
        let mut standing = Standing::Good;
        if has_specs {
            let report = self.watch.finish(gap.clone());
            let mut tally = Tally::default();
            tally.add(&report);
            text += format.begin();
            text += &render(&report, format, style);
            text += &end(&tally, format, style);
            standing = tally.standing();
        }
        drop(io::stdout().write_all(text.as_bytes()));
        if let Some(gap) = &gap {
            say(&format!("error: {gap}\n"));
            return Ok(Exit::Failed);
        }
        Ok(Exit::of(standing, true))
    }

    fn failed(&self, failure: &Failure) -> String {
        let codel = place(&self.model, &self.sources, failure.component, failure.codel);
        let (name, function, at) = (codel.name, codel.function, codel.place);
        format!("the codel `{function}` of {name} ({at}) could not be run: {}", failure.trouble)
    }
}

/// How a run went, in a few lines.
fn figures(run: &Run) -> String {
    let figures = run.figures();
    let turns: u64 = figures.turns.values().sum();
    let late: u64 = figures.late.values().map(|c| c.times).sum();
    let overruns: u64 = figures.overruns.values().map(|c| c.times).sum();
    format!(
        "{} s: {turns} turns of tasks, {} missed, {late} late; {} codels, {overruns} overran\n",
        run.now().seconds(),
        figures.all_missed(),
        figures.calls
    )
}
