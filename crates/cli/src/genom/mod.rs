//! `lapwing genom`: GenoM3 components checked, drawn, written as models for other tools, and run.

mod run;

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::PathBuf;
use std::sync::Arc;

use clap::{Args, ColorChoice, Subcommand, ValueEnum};
use lapwing_components::{Signals, Types, model};
use lapwing_diag::{Style, render};
use lapwing_draw::{Picture, draw};
use lapwing_genom::automata::{self, Settings, System};
use lapwing_genom::emit::{self, Input};
use lapwing_genom::model::{Component, ServiceKind};
use lapwing_genom::mutex::{Mutex, Rules};
use lapwing_genom::{Disk, Loaded, Options, graph, load};

use crate::complain::{Complaint, say, styles};
use crate::exit::Exit;
use crate::words::specs;

/// Arguments of `genom`.
#[derive(Debug, Args)]
#[command(after_help = "\
  lapwing genom check robot.gen -I idl           what is wrong with the components
  lapwing genom graph robot.gen --format svg     who writes what for whom, and every state machine
  lapwing genom bip robot.gen > robot.bip        the components as timed automata in RT-BIP
  lapwing genom uppaal robot.gen > robot.xml     the same for UPPAAL
  lapwing genom run robot.gen --spec robot.rv --requests mission.txt    runs them, watched

docs/genom.md says what is read and what is written. Exit codes: 0 the components can be used; 2 they cannot.")]
pub struct Genom {
    /// What to do with them.
    #[command(subcommand)]
    pub action: Action,
}

/// What to do with components.
#[derive(Debug, Subcommand)]
pub enum Action {
    /// Says what is wrong with the components, and what is in them
    Check(Reading),
    /// Draws components, ports, tasks and activities
    Graph(GraphArguments),
    /// Writes them as timed automata in RT-BIP
    Bip(BipArguments),
    /// Writes them as timed automata for UPPAAL
    Uppaal(ModelArguments),
    /// Writes the headers and the glue with which codels in C are compiled
    Headers(HeadersArguments),
    /// Calls codels of a library for another process: `run --isolate` starts it
    #[command(hide = true)]
    Serve {
        /// The library
        library: PathBuf,
        /// The component
        component: String,
    },
    /// Runs them: their automata call codels, or only take the time that these may take
    Run(run::RunArguments),
}

/// Which specifications to read, and how.
#[derive(Debug, Args)]
pub struct Reading {
    /// Specifications, read as one text in this order
    #[arg(required = true, value_name = "FILE.gen")]
    pub files: Vec<PathBuf>,
    /// A folder in which included files are looked for (repeatable)
    #[arg(short = 'I', value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// A macro: NAME or NAME=VALUE (repeatable)
    #[arg(short = 'D', value_name = "NAME[=VALUE]")]
    pub defines: Vec<String>,
    /// A file of execution times: lines such as `ImuDriver.Measure.start = 1.5 ms`
    #[arg(long, value_name = "FILE")]
    pub wcet: Option<PathBuf>,
    /// A file that says which port reads which: lines such as `POM.Imu ImuDriver.Imu`
    #[arg(long, value_name = "FILE")]
    pub ports: Option<PathBuf>,
    /// Whether to colour
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub color: ColorChoice,
}

/// Arguments of `graph`.
#[derive(Debug, Args)]
pub struct GraphArguments {
    /// What to read.
    #[command(flatten)]
    pub reading: Reading,
    /// How to draw it
    #[arg(long, value_name = "FORMAT", default_value = "dot")]
    pub format: Format,
    /// Draw the timed automata that the components come to, and not the components
    #[arg(long)]
    pub automata: bool,
    /// How many instances of an activity there can be
    #[arg(long, value_name = "N", default_value_t = Settings::default().instances)]
    pub instances: usize,
}

/// The formats of pictures.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Format {
    /// For Graphviz
    Dot,
    /// For Mermaid
    Mermaid,
    /// To be looked at as it is
    Svg,
}

/// Arguments of what writes a model.
#[derive(Debug, Args)]
pub struct ModelArguments {
    /// What to read.
    #[command(flatten)]
    pub reading: Reading,
    /// How many instances of an activity there can be
    #[arg(long, value_name = "N", default_value_t = Settings::default().instances)]
    pub instances: usize,
    /// Let codels that only read a port run at the same time; GenoM3 does not
    #[arg(long)]
    pub readers_share: bool,
}

/// Arguments of `bip`.
#[derive(Debug, Args)]
pub struct BipArguments {
    /// As for every model.
    #[command(flatten)]
    pub model: ModelArguments,
    /// Call the codels as external functions, and let what they return decide; else they only take time
    #[arg(long)]
    pub runtime: bool,
    /// Let called codels throw exceptions, which end their activities and services; only with --runtime
    #[arg(long, requires = "runtime")]
    pub exceptions: bool,
    /// A specification whose properties become monitors in the model, and whose reactions make requests
    #[arg(long, value_name = "SPEC.rv")]
    pub spec: Vec<PathBuf>,
    /// Requests, one on each line with its time, `@1s LaserDriver.Acquire()`: a client makes them, and nobody else makes any
    #[arg(long, value_name = "FILE")]
    pub requests: Option<PathBuf>,
}

/// Arguments of `headers`.
#[derive(Debug, Args)]
pub struct HeadersArguments {
    /// What to read.
    #[command(flatten)]
    pub reading: Reading,
    /// The folder to write to
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// Runs the command.
pub fn run(arguments: &Genom) -> Result<Exit, Complaint> {
    let text = match &arguments.action {
        Action::Run(arguments) => return run::run(arguments),
        Action::Serve { library, component } => return Ok(serve(library, component)),
        Action::Headers(arguments) => headers(arguments)?,
        Action::Check(reading) => summary(&read(reading)?),
        Action::Graph(arguments) => picture(arguments)?,
        Action::Bip(arguments) => {
            let loaded = read(&arguments.model.reading)?;
            bip(arguments, loaded)?
        }
        Action::Uppaal(arguments) => {
            let loaded = read(&arguments.reading)?;
            let system = system(&loaded, arguments, false, false)?;
            emit::uppaal(Input { system: &system, sources: &loaded.sources })
        }
    };
    // Where nobody reads it there is nothing to be done.
    drop(io::stdout().write_all(text.as_bytes()));
    Ok(Exit::Good)
}

/// The components in RT-BIP, with the monitors and the client that are asked for.
fn bip(arguments: &BipArguments, loaded: Loaded) -> Result<String, Complaint> {
    let system = system(&loaded, &arguments.model, arguments.runtime, arguments.exceptions)?;
    let mut package = emit::bip(Input { system: &system, sources: &loaded.sources });
    let model = Arc::new(loaded.model);
    let (_, style) = styles(arguments.model.reading.color);
    if arguments.requests.is_none() && arguments.spec.is_empty() {
        // The automata alone know no types.
        return Ok(lapwing_bip::print(&package));
    }
    let types = Types::new(&model).map_err(Complaint::new)?;
    if let Some(path) = &arguments.requests {
        let requests = run::requests_of(path, &model, &types)?;
        package = model::with_requests(package, &system, &model, &requests);
    }
    if !arguments.spec.is_empty() {
        let signals = Signals::new(&model, &types);
        for spec in &specs(&arguments.spec, &[], style)? {
            let with = model::with_monitors(package, &system, &model, spec, &signals, style);
            package = with.map_err(|wrong| Complaint::rendered(wrong.0))?;
        }
    }
    Ok(lapwing_bip::print(&package))
}

/// Writes what C codels are compiled with, and says how.
fn headers(arguments: &HeadersArguments) -> Result<String, Complaint> {
    let loaded = read(&arguments.reading)?;
    let files = emit::c_files(&loaded.model).map_err(|e| Complaint::new(e.to_string()))?;
    let folder = &arguments.output;
    let cannot = |e: io::Error| Complaint::new(format!("{} cannot be written: {e}", folder.display()));
    std::fs::create_dir_all(folder).map_err(cannot)?;
    for file in &files {
        std::fs::write(folder.join(&file.name), &file.text).map_err(cannot)?;
    }
    let mut text = format!("wrote {} files to {}\n", files.len(), folder.display());
    for glue in files.iter().filter(|f| f.name.ends_with("_glue.c")) {
        let name = glue.name.trim_end_matches("_glue.c");
        let folder = folder.display();
        let _ = writeln!(
            text,
            "{name}: gcc -shared -fPIC -I {folder} -o lib{name}.so {folder}/{} YOUR_CODELS.c, where these include \"ac{name}.h\"",
            glue.name
        );
    }
    Ok(text)
}

#[cfg(unix)]
fn serve(library: &std::path::Path, component: &str) -> Exit {
    if lapwing_codels::serve(library, component) { Exit::Good } else { Exit::Wrong }
}

#[cfg(not(unix))]
fn serve(_: &std::path::Path, _: &str) -> Exit {
    Exit::Wrong
}

/// Reads specifications; what is wrong with them is said, and ends the command where they cannot be used.
fn read(reading: &Reading) -> Result<Loaded, Complaint> {
    let options = Options {
        folders: reading.folders.clone(),
        defines: reading.defines.clone(),
        wcet: reading.wcet.clone(),
        ports: reading.ports.clone(),
    };
    let loaded = load(&Disk, &reading.files, &options)
        .map_err(|(path, error)| Complaint::new(format!("{} cannot be read: {error}", path.display())))?;
    let (_, style) = styles(reading.color);
    let said = rendered(&loaded, style);
    if loaded.has_errors() {
        return Err(Complaint::rendered(said));
    }
    say(&said);
    Ok(loaded)
}

fn rendered(loaded: &Loaded, style: Style) -> String {
    loaded.diagnostics.iter().map(|d| render(&loaded.sources, d, style)).collect()
}

/// A line for each component.
fn summary(loaded: &Loaded) -> String {
    let mutex = Mutex::symmetric(&loaded.model, Rules::default());
    let mut out = String::new();
    for (number, component) in loaded.model.components.iter().enumerate() {
        let services = |kind: ServiceKind| component.services.iter().filter(|s| s.kind == kind).count();
        let codels = component.codels.iter().filter(|c| c.role != lapwing_genom::model::Role::Attribute).count();
        let exclude = component.codels().filter(|(id, _)| mutex.is_unsafe((number, *id))).count();
        let parts = [
            counted(component.tasks.len(), "task", "tasks"),
            counted(services(ServiceKind::Activity), "activity", "activities"),
            counted(services(ServiceKind::Function), "function", "functions"),
            counted(services(ServiceKind::Attribute), "attribute", "attributes"),
            counted(component.ports.len(), "port", "ports"),
            counted(codels, "codel", "codels"),
        ];
        let _ = writeln!(
            out,
            "{}: {}; {} must wait for others",
            named(component),
            parts.join(", "),
            counted(exclude, "codel or attribute", "codels and attributes")
        );
    }
    let links = loaded.model.links.len();
    if links > 0 {
        let _ = writeln!(out, "{} linked", counted(links, "port is", "ports are"));
    }
    if loaded.model.components.is_empty() {
        out += "there is no component\n";
    }
    out
}

fn named(component: &Component) -> String {
    format!("{} {}", component.name, component.version)
}

fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

fn picture(arguments: &GraphArguments) -> Result<String, Complaint> {
    let loaded = read(&arguments.reading)?;
    let name = arguments.reading.files.first().map(|f| f.display().to_string()).unwrap_or_default();
    let picture = match arguments.format {
        Format::Dot => Picture::Dot,
        Format::Mermaid => Picture::Mermaid,
        Format::Svg => Picture::Svg,
    };
    let graphs = match arguments.automata {
        true => {
            let system = built(&loaded, Settings { instances: arguments.instances, ..Settings::default() })?;
            emit::automata_graphs(Input { system: &system, sources: &loaded.sources })
        }
        false => graph::graphs(&loaded.model),
    };
    Ok(draw(&name, &graphs, picture))
}

fn system(loaded: &Loaded, arguments: &ModelArguments, runtime: bool, exceptions: bool) -> Result<System, Complaint> {
    if loaded.model.components.is_empty() {
        let complaint = Complaint::new("there is no component to make a model of");
        return Err(complaint.help("interfaces and types alone do nothing: give the file that says `component`"));
    }
    let settings = Settings {
        instances: arguments.instances,
        rules: Rules { readers_share: arguments.readers_share },
        runtime,
        exceptions,
    };
    built(loaded, settings)
}

fn built(loaded: &Loaded, settings: Settings) -> Result<System, Complaint> {
    let help = "fewer instances make a smaller model: --instances 1";
    automata::build(&loaded.model, settings).map_err(|e| Complaint::new(e.to_string()).help(help))
}
