//! `lapwing demo`: a violation found in a recording that comes with Lapwing.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use lapwing::{Options, Session, Spec};
use lapwing_react::{Format, Tally, end, render};

use crate::args::Demo;
use crate::complain::{Complaint, styles};
use crate::exit::Exit;

const SPEC: &str = include_str!("../../../examples/stop-sign/stop_sign.rv");
const RECORDING: &[u8] = include_bytes!("../../../examples/stop-sign/run.mcap");

/// Runs the command. What it shows is a violation, and showing it is what it is for: it succeeds.
pub fn run(demo: &Demo) -> Result<Exit, Complaint> {
    let (spec, trace) = (demo.dir.join("stop_sign.rv"), demo.dir.join("run.mcap"));
    fs::create_dir_all(&demo.dir).map_err(|e| Complaint::new(format!("{}: {e}", demo.dir.display())))?;
    // What the user changed in the specification stays.
    if !spec.exists() {
        write(&spec, SPEC.as_bytes())?;
    }
    write(&trace, RECORDING)?;
    let (style, _) = styles(demo.color);
    let specs = [Spec::load(&spec).map_err(|e| Complaint::rendered(format!("{e}\n")))?];
    let session = Session::open(&specs, &trace, &Options::default()).map_err(|e| Complaint::new(e.to_string()))?;
    let report = session.run(&mut ());
    let mut tally = Tally::default();
    tally.add(&report);
    let text = format!(
        "{}\n{}{}{}",
        opening(&spec, &trace),
        render(&report, Format::Text, style),
        end(&tally, Format::Text, style),
        closing(&spec, &trace)
    );
    // Where nobody reads it there is nothing to be done.
    drop(io::stdout().write_all(text.as_bytes()));
    Ok(Exit::Good)
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Complaint> {
    fs::write(path, bytes).map_err(|e| Complaint::new(format!("{}: {e}", path.display())))
}

fn opening(spec: &Path, trace: &Path) -> String {
    format!(
        "A car in a simulator drove past two stop signs. This is what `lapwing check {} {}` says of it:\n",
        spec.display(),
        trace.display()
    )
}

fn closing(spec: &Path, trace: &Path) -> String {
    let (spec, trace) = (spec.display(), trace.display());
    format!(
        "\nThe car stopped at the first sign and only slowed down at the second. What to try next:\n  \
         lapwing explain {spec} {trace}     what each property means\n  \
         lapwing check {spec} {trace}       the same report; it exits with 1, for scripts\n  \
         edit {spec}: is `car.velocity =={{0.5}} 0` met?\n  \
         lapwing new YOUR.mcap -o robot.rv    a specification for a recording of your own\n"
    )
}
