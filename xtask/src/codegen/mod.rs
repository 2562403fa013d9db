//! Whether generated monitors say what the engine says: many of them in one program, which is compiled, and run on their traces.

pub mod cortex;
mod driver;
mod handed;
mod objects;
mod steps;
mod wholes;

use std::path::{Path, PathBuf};
use std::process::Command;

use lapwing_check::checked::Spec;
use lapwing_check::compile::compile;
use lapwing_codegen::{Generated, Interface, Language, Object, Options, Setter, generate, refusals};
use lapwing_reference::Trace;
use lapwing_stream::{Time, Verdict};

use crate::agree::{self, Drive};
use crate::suite::{cases, pages, runs};

/// A specification and a trace, and what to call them when something is wrong.
#[derive(Clone, Debug)]
pub struct Case {
    /// How to find it.
    pub label: String,
    /// Checked against the trace.
    pub spec: Spec,
    /// The trace.
    pub trace: Trace,
}

impl Case {
    /// The case of a seed, where the checker takes it.
    pub fn at_random(seed: u64) -> Option<Case> {
        let (spec, trace, text) = crate::random::checked_case(seed)?;
        Some(Case { label: format!("seed {seed}\n{text}\n{trace:?}"), spec, trace })
    }
}

/// A case at random of what is handed over as a whole.
pub use handed::{Theme, handed};

/// The cases of the suite on whose traces verdicts are expected; the traces are written to the folder.
pub fn of_suite(folder: &Path) -> Result<Vec<Case>, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../suite");
    let mut all = Vec::new();
    for page in pages(&root) {
        let text = std::fs::read_to_string(&page).map_err(|e| format!("{}: {e}", page.display()))?;
        for case in cases(&page.to_string_lossy(), &text) {
            let label = format!("{}:{}: {}\n{}", case.file, case.line, case.heading, case.spec);
            let runs = runs(&case, folder).into_iter();
            all.extend(runs.map(|(spec, trace)| Case { label: label.clone(), spec, trace }));
        }
    }
    Ok(all)
}

/// How many properties there were, and what became of them.
#[derive(Clone, Copy, Default, PartialEq, Eq, Debug)]
pub struct Count {
    /// Generated, run and compared.
    pub compared: usize,
    /// Refused: beyond what is generated.
    pub refused: usize,
    /// With a trace whose values are of other kinds than the specification takes them for.
    pub unfit: usize,
}

/// What is compared of a property.
#[derive(Clone, PartialEq, Debug)]
pub struct Said {
    verdict: Verdict,
    counts: (u64, u64, u64),
    /// When the obligation began that failed first, and when it failed.
    first: Option<(Time, Time)>,
}

/// A case that is run.
struct Run {
    label: String,
    generated: [(Language, Generated); 2],
    steps: Vec<String>,
    expected: Vec<(String, Said)>,
}

/// Where generated monitors run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Target {
    /// Rust, here.
    Rust,
    /// C, here.
    C,
    /// C, on an emulated Cortex-M3.
    Cortex,
}

impl Target {
    fn language(self) -> Language {
        if self == Target::Rust { Language::Rust } else { Language::C }
    }
}

/// Generates, compiles and runs the cases in a folder that is there. Gives how many properties were compared and what differs.
pub fn agree(cases: &[Case], targets: &[Target], folder: &Path) -> Result<(Count, Vec<String>), String> {
    let mut count = Count::default();
    let runs: Vec<Run> = cases.iter().filter_map(|case| prepare(case, &mut count)).collect();
    let mut wrong = Vec::new();
    for &target in targets {
        // A compiler alone does not find the crate `libm`.
        let has_libm = |run: &&Run| target != Target::Rust || !run.generated[0].1.interface.needs_libm.0;
        let runs: Vec<&Run> = runs.iter().filter(has_libm).collect();
        let script: String = runs.iter().enumerate().map(|(n, run)| steps::script(n, &run.steps)).collect();
        let of = |run: &Run| run.generated.iter().position(|(l, _)| *l == target.language());
        let monitors: Vec<&Generated> = runs.iter().filter_map(|r| Some(&r.generated[of(r)?].1)).collect();
        let (program, mut command) = build(target, &monitors, folder)?;
        let said = steps::outcomes(&run(&program, &mut command, &script)?)?;
        compare(target, &runs, &said, &mut wrong);
    }
    Ok((count, wrong))
}

/// The properties that can be generated, each tried alone.
pub fn within_scope(spec: &Spec) -> Vec<String> {
    let free = refusals(spec).into_iter().filter(|(_, why)| why.is_empty()).map(|(name, _)| name);
    free.filter(|name| generate(spec, "case.rv", &options(Language::C, 0, vec![name.clone()])).is_ok()).collect()
}

/// The properties of a case that are not compared, and why.
pub fn beyond(case: &Case) -> Vec<(String, String)> {
    let why = |name: &String| {
        let generated = generate(&case.spec, "case.rv", &options(Language::C, 0, vec![name.clone()]));
        match generated {
            Err(why) => Some(why.iter().map(|d| d.message.as_str()).collect::<Vec<_>>().join("; ")),
            Ok(it) if steps::of(&case.spec, &it.interface, &case.trace).is_none() => {
                Some("its trace has values of other kinds than it takes them for".to_owned())
            }
            Ok(_) => None,
        }
    };
    case.spec.properties.iter().filter_map(|p| Some((p.name.clone(), why(&p.name)?))).collect()
}

fn options(language: Language, number: usize, properties: Vec<String>) -> Options {
    Options { language, name: format!("m{number}"), capacity: lapwing_codegen::CAPACITY, properties }
}

fn prepare(case: &Case, count: &mut Count) -> Option<Run> {
    let properties = within_scope(&case.spec);
    count.refused += case.spec.properties.len() - properties.len();
    if properties.is_empty() {
        return None;
    }
    let number = count.compared + count.unfit;
    let of = |language| {
        let generated = generate(&case.spec, "case.rv", &options(language, number, properties.clone())).ok()?;
        Some((language, generated))
    };
    let generated = [of(Language::Rust)?, of(Language::C)?];
    let Some(steps) = steps::of(&case.spec, &generated[0].1.interface, &case.trace) else {
        count.unfit += properties.len();
        return None;
    };
    count.compared += properties.len();
    let mut spec = case.spec.clone();
    spec.properties.retain(|p| properties.contains(&p.name));
    let trace = Trace { broke_off: None, lost: Vec::new(), ..case.trace.clone() };
    let expected = agree::engine(&compile(&spec), &trace, Drive::Plain).into_iter().map(expected).collect();
    Some(Run { label: case.label.clone(), generated, steps, expected })
}

fn expected(said: agree::Said) -> (String, Said) {
    let (met, failed, open) = said.counts;
    let counts = (met as u64, failed as u64, open as u64);
    let first = said.episodes.first().map(|e| (e.1, e.0));
    (said.name, Said { verdict: said.verdict, counts, first })
}

fn compare(target: Target, runs: &[&Run], said: &[Vec<Said>], wrong: &mut Vec<String>) {
    if said.len() != runs.len() {
        wrong.push(format!("{target:?}: {} of {} monitors said something", said.len(), runs.len()));
    }
    for (run, said) in runs.iter().zip(said) {
        for ((name, expected), said) in run.expected.iter().zip(said).filter(|((_, e), s)| e != *s) {
            wrong.push(format!("{target:?}: {}\n{name}: expected {expected:?}\n{name}: said     {said:?}", run.label));
        }
        if run.expected.len() != said.len() {
            wrong.push(format!("{target:?}: {}: {} outcomes of {}", run.label, said.len(), run.expected.len()));
        }
    }
}

/// Compiles monitors and a program that drives them. Gives the program, and what runs it.
fn build(target: Target, monitors: &[&Generated], folder: &Path) -> Result<(PathBuf, Command), String> {
    let program = match target {
        Target::Rust => {
            let (source, program) = (folder.join("monitors.rs"), folder.join("monitors_rust"));
            put(&source, &driver::rust(monitors))?;
            let arguments = ["--edition", "2024", "-C", "debuginfo=0", "-C", "overflow-checks=on", "-o"];
            compile_with(Command::new(rustc()).args(arguments).arg(&program).arg(&source))?;
            program
        }
        Target::C => {
            for (name, text) in monitors.iter().flat_map(|m| &m.files) {
                put(&folder.join(name), text)?;
            }
            let (source, program) = (folder.join("monitors.c"), folder.join("monitors_c"));
            put(&source, &driver::c(monitors))?;
            compile_with(Command::new("cc").args(C_FLAGS).arg("-o").arg(&program).arg(&source).arg("-lm"))?;
            program
        }
        Target::Cortex => {
            let program = cortex::build(monitors, folder)?;
            return Ok((program.clone(), cortex::emulator(&program)));
        }
    };
    Ok((program.clone(), Command::new(program)))
}

fn put(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}

/// How generated C must compile.
pub const C_FLAGS: [&str; 6] = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1"];

/// The compiler of Rust that builds this.
pub fn rustc() -> String {
    std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned())
}

/// Runs a compiler, and gives what it complains of.
pub fn compile_with(command: &mut Command) -> Result<(), String> {
    let output = command.output().map_err(|e| format!("{command:?}: {e}"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let start: String = said.chars().take(2_500).collect();
    if output.status.success() { Ok(()) } else { Err(format!("{command:?}\n{start}")) }
}

/// Runs a program on that input.
fn run(program: &Path, command: &mut Command, input: &str) -> Result<String, String> {
    let failed = |e: std::io::Error| format!("{}: {e}", program.display());
    let file = program.with_extension("in");
    std::fs::write(&file, input).map_err(failed)?;
    let output = command.stdin(std::fs::File::open(&file).map_err(failed)?).output().map_err(failed)?;
    if !output.status.success() {
        return Err(format!("{}: {}\n{}", program.display(), output.status, String::from_utf8_lossy(&output.stderr)));
    }
    String::from_utf8(output.stdout).map_err(|e| e.to_string())
}

/// The names of the members of an interface, in order.
pub fn members(interface: &Interface) -> impl Iterator<Item = (usize, &lapwing_codegen::Member)> {
    interface.members.iter().enumerate()
}

/// The functions of an interface that take objects, in order.
pub fn setters(interface: &Interface) -> impl Iterator<Item = (&Object, &Setter)> {
    interface.objects.iter().flat_map(|object| object.setters.iter().map(move |setter| (object, setter)))
}
