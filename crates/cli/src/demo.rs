//! `lapwing demo`: the built-in robots run, are recorded and are checked, and what they do wrong is found, told and drawn.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use lapwing::{Options, Report, Session, Spec};
use lapwing_diag::Style;
use lapwing_page::Entry;
use lapwing_react::{Format, Tally, end, render};
use lapwing_sim::Scenario;

use crate::args::Demo;
use crate::complain::{Complaint, styles};
use crate::exit::Exit;
use crate::page::Page;
use crate::sim;

/// A scenario in which something goes wrong, and the specification that finds it.
struct Scene {
    /// What its files are called.
    name: &'static str,
    scenario: &'static str,
    fault: &'static str,
    spec: &'static str,
    /// What there is to see, in one sentence.
    story: &'static str,
}

const SCENES: [Scene; 2] = [
    Scene {
        name: "stop_sign",
        scenario: "stop-sign",
        fault: "sign-unseen",
        spec: include_str!("demo/stop_sign.rv"),
        story: "A car drives towards a stop sign, and its camera does not see it.",
    },
    Scene {
        name: "docking",
        scenario: "docking",
        fault: "docking-stuck",
        spec: include_str!("demo/docking.rv"),
        story: "A robot creeps into its dock, too slowly for its motors: a bug that the Kobuki base had (ROBUST, kobuki 0416c81).",
    },
];

/// A scene that was played.
struct Played {
    scene: &'static Scene,
    spec: PathBuf,
    trace: PathBuf,
    report: Report,
    /// What the page shows of it.
    entry: Entry,
}

/// Runs the command. What it shows is violations, and showing them is what it is for: it succeeds.
pub fn run(demo: &Demo) -> Result<Exit, Complaint> {
    fs::create_dir_all(&demo.dir).map_err(|e| Complaint::new(format!("{}: {e}", demo.dir.display())))?;
    let played = SCENES.iter().map(|scene| play(scene, &demo.dir)).collect::<Result<Vec<Played>, Complaint>>()?;
    let text = told(&played, styles(demo.color).0) + &closing(&played, &demo.dir);
    let page = demo.dir.join("report.html");
    let (said, is_there) = Page::create(&page)?.write(&played.into_iter().map(|p| p.entry).collect::<Vec<Entry>>());
    if !is_there {
        return Err(Complaint::rendered(said));
    }
    let text = format!("{text}\nThe whole story, with charts, to be opened in a browser: {}\n", page.display());
    // Where nobody reads it there is nothing to be done.
    drop(io::stdout().write_all(text.as_bytes()));
    Ok(Exit::Good)
}

/// Records a scene and checks the recording.
fn play(scene: &'static Scene, folder: &Path) -> Result<Played, Complaint> {
    let spec = folder.join(format!("{}.rv", scene.name));
    let trace = folder.join(format!("{}.mcap", scene.name));
    // What the user changed in the specification stays.
    if !spec.exists() {
        fs::write(&spec, scene.spec).map_err(|e| Complaint::new(format!("{}: {e}", spec.display())))?;
    }
    sim::write(&scenario(scene)?, &options(scene)?, &trace)?;
    let specs = [Spec::load(&spec).map_err(|e| Complaint::rendered(format!("{e}\n")))?];
    let options = Options { history: Some(lapwing_page::points(SCENES.len())), margins: true, ..Options::default() };
    let session = Session::open(&specs, &trace, &options).map_err(|e| Complaint::new(e.to_string()))?;
    let (report, histories) = session.run_noting(&mut ());
    let entry = lapwing_page::entry(&report, &histories);
    Ok(Played { scene, spec, trace, report, entry })
}

fn scenario(scene: &Scene) -> Result<Scenario, Complaint> {
    let found = Scenario::bundled(scene.scenario).ok_or_else(|| Complaint::new("a scenario of the demo is missing"))?;
    found.map_err(|e| Complaint::new(e.to_string()))
}

fn options(scene: &Scene) -> Result<lapwing_sim::Options, Complaint> {
    let fault = scene.fault.parse().map_err(|e: lapwing_sim::fault::OrderError| Complaint::new(e.to_string()))?;
    Ok(lapwing_sim::Options { seed: 1, faults: vec![fault], duration: None })
}

/// The stories with their reports.
fn told(played: &[Played], style: Style) -> String {
    let mut tally = Tally::default();
    let one = |played: &Played| {
        tally.add(&played.report);
        format!(
            "{}\nThis is what `lapwing check {} {}` says of it:\n\n{}\n",
            played.scene.story,
            played.spec.display(),
            played.trace.display(),
            render(&played.report, Format::Text, style)
        )
    };
    let reports: Vec<String> = played.iter().map(one).collect();
    reports.join("\n") + &end(&tally, Format::Text, style)
}

fn closing(played: &[Played], folder: &Path) -> String {
    let Some(Played { scene, spec, trace, .. }) = played.first() else { return String::new() };
    let (spec, trace, scenario) = (spec.display(), trace.display(), scene.scenario);
    let next = [
        (format!("explain {spec} {trace}"), "what each property means"),
        (format!("check {spec} {trace}"), "the same report; it exits with 1, for scripts"),
        (format!("sim {scenario} --check {spec}"), "the same car, healthy"),
        ("sim --list".to_owned(), "more scenarios, and what can go wrong in them"),
        ("new YOUR.mcap -o robot.rv".to_owned(), "a specification for a recording of your own"),
    ];
    let width = next.iter().map(|(command, _)| command.chars().count()).max().unwrap_or_default();
    let lines = next.iter().map(|(command, what)| format!("  lapwing {command:<width$}   {what}\n"));
    format!(
        "\nRecordings and specifications are in {}; Foxglove opens the recordings. What to try next:\n{}",
        folder.display(),
        lines.collect::<String>()
    )
}
