//! The specifications of `examples/turtlebot` on the simulator: every command in their headers is carried out, and what comes out makes the
//! table of the example's page.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use lapwing::{LIBRARIES, Library, Options, Session, Spec};
use lapwing_react::Property;
use lapwing_sim::fault::{ALL, Order};
use lapwing_sim::{Scenario, recording, run_name};
use lapwing_stream::Verdict;

/// What a property is called that is as the thesis has it: such a one may call a healthy robot faulty.
pub const AS_WRITTEN: &str = "as_written";
/// How a command in the header of a specification begins.
const COMMAND: &str = "#   lapwing sim ";

/// A run of a scenario, and what was said of it.
pub struct Run {
    /// The specification, from the folder of the example.
    pub spec: String,
    /// The scenario.
    pub scenario: String,
    /// The faults, as they were ordered.
    pub faults: Vec<String>,
    /// Its properties.
    pub properties: Vec<Property>,
}

impl Run {
    /// The properties that are meant to be right.
    pub fn right(&self) -> impl Iterator<Item = &Property> {
        self.properties.iter().filter(|p| p.name != AS_WRITTEN)
    }
}

/// All commands of all specifications in the folder, carried out.
pub fn runs(folder: &Path) -> Result<Vec<Run>, String> {
    let mut all = Vec::new();
    for spec in specs(folder)? {
        let path = folder.join(&spec);
        let text = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let parsed = [Spec::load(&path).map_err(|e| e.to_string())?];
        for command in text.lines().filter_map(|l| l.strip_prefix(COMMAND)) {
            all.push(run(command, &spec, &parsed)?);
        }
    }
    Ok(all)
}

/// The specifications below the folder, those of the thesis first.
fn specs(folder: &Path) -> Result<Vec<String>, String> {
    let mut found = Vec::new();
    for part in ["", "robust/"] {
        let entries = fs::read_dir(folder.join(part)).map_err(|e| format!("{}: {e}", folder.display()))?;
        let paths = entries.flatten().map(|e| e.path()).filter(|p: &PathBuf| p.extension().is_some_and(|x| x == "rv"));
        let mut names: Vec<String> =
            paths.filter_map(|p| Some(format!("{part}{}", p.file_name()?.to_string_lossy()))).collect();
        names.sort();
        found.extend(names);
    }
    Ok(found)
}

fn run(command: &str, spec: &str, parsed: &[Spec]) -> Result<Run, String> {
    let wrong = |what: &str| format!("{spec}: `lapwing sim {command}`: {what}");
    let mut words = command.split_whitespace();
    let name = words.next().unwrap_or_default();
    let scenario = Scenario::bundled(name).ok_or_else(|| wrong("no such scenario"))?.map_err(|e| e.to_string())?;
    let mut options = lapwing_sim::Options { seed: 1, ..Default::default() };
    let mut faults = Vec::new();
    while let Some(word) = words.next() {
        let value = words.next().ok_or_else(|| wrong("something is missing at its end"))?;
        match word {
            "--fault" => {
                options.faults.push(value.parse::<Order>().map_err(|e| wrong(&e.to_string()))?);
                faults.push(value.to_owned());
            }
            "--check" if value == spec => {}
            _ => return Err(wrong(&format!("`{word} {value}` is not expected"))),
        }
    }
    let recording = recording(&scenario, &options).map_err(|e| wrong(&e.to_string()))?;
    let report = Session::over(parsed, recording, &run_name(&scenario, 1), &Options::default()).run(&mut ());
    Ok(Run { spec: spec.to_owned(), scenario: name.to_owned(), faults, properties: report.properties })
}

/// What is wrong with what came out: a healthy robot that is called faulty, a faulty one that is not caught, a specification that is never
/// tried on both, a fault that is never tried.
pub fn surprises(runs: &[Run]) -> Vec<String> {
    let tried: Vec<&str> = runs.iter().flat_map(|r| &r.faults).filter_map(|f| fault_name(f)).collect();
    let untried = ALL.iter().filter(|a| !tried.contains(&a.name));
    let mut wrong: Vec<String> = untried.map(|a| format!("{}: is never tried", a.name)).collect();
    for run in runs {
        let what = format!("{}: {} {}", run.spec, run.scenario, run.faults.join(" "));
        // Where all there is is what the thesis has, that needs no correction.
        let judged: Vec<&Property> =
            if run.right().next().is_some() { run.right().collect() } else { run.properties.iter().collect() };
        if judged.is_empty() {
            wrong.push(format!("{what}: no property"));
        }
        let is_well = |p: &&&Property| p.verdict.is_success() && !p.vacuous;
        match run.faults.is_empty() {
            true => wrong
                .extend(judged.iter().filter(|p| !is_well(p)).map(|p| format!("{what}: {} is {}", p.name, p.verdict))),
            false if judged.iter().all(|p| p.verdict.is_success()) => wrong.push(format!("{what}: not caught")),
            false => {}
        }
        let others = runs.iter().filter(|r| r.spec == run.spec);
        if others.clone().all(|r| r.faults.is_empty()) || others.clone().all(|r| !r.faults.is_empty()) {
            wrong.push(format!("{}: is not tried on a healthy and on a faulty robot", run.spec));
        }
    }
    wrong
}

/// The bugs of which a faulty run is caught by such a property.
pub fn bugs(runs: &[Run], by: impl Fn(&Property) -> bool) -> Vec<&'static str> {
    let caught = runs.iter().filter(|r| r.right().any(|p| p.verdict == Verdict::Violated && by(p)));
    let names: Vec<&str> = caught.flat_map(|r| &r.faults).filter_map(|f| fault_name(f)).collect();
    ALL.iter().filter(|a| !a.bug.is_empty() && names.contains(&a.name)).map(|a| a.bug).collect()
}

/// The shipped pattern that a property is.
pub fn pattern(property: &Property) -> Option<&'static str> {
    let (_, formula) = property.text.split_once(": ")?;
    let mut patterns = LIBRARIES.iter().flat_map(Library::patterns).map(|pattern| pattern.name);
    patterns.find(|name| formula.strip_prefix(name).is_some_and(|rest| rest.starts_with('(')))
}

/// The name in an order: `frozen-scan` of `robot2:frozen-scan@10`.
fn fault_name(order: &str) -> Option<&str> {
    order.rsplit(':').next()?.split('@').next()
}

/// The table of the example's page.
pub fn table(runs: &[Run]) -> String {
    let mut text =
        String::from("| specification | scenario | fault | property | pattern | verdict | first failure |\n");
    text.push_str("| --- | --- | --- | --- | --- | --- | --- |\n");
    for run in runs {
        let fault = run.faults.iter().map(|f| format!("`{f}`")).collect::<Vec<_>>().join(" ");
        for property in &run.properties {
            let when = property.violations.first().map(|v| v.failed.to_string()).unwrap_or_default();
            let (spec, scenario) = (&run.spec, &run.scenario);
            let (name, verdict) = (&property.name, property.verdict);
            let verdict = if verdict.is_success() { verdict.to_string() } else { format!("**{verdict}**") };
            let vacuous = if property.vacuous { " (vacuous)" } else { "" };
            let pattern = pattern(property).map(|name| format!("`{name}`")).unwrap_or_default();
            // Writing to a text does not fail.
            let _ = writeln!(
                text,
                "| [{spec}]({spec}) | {scenario} | {fault} | {name} | {pattern} | {verdict}{vacuous} | {when} |"
            );
        }
    }
    text
}

/// The table of faults of the simulator's page.
pub fn faults() -> String {
    let mut text = String::from("| fault | what goes wrong | from |\n| --- | --- | --- |\n");
    for about in ALL {
        let _ = writeln!(text, "| `{}` | {} | {} |", about.name, about.what, about.bug);
    }
    text
}
