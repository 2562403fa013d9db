//! The page in a real browser: `look.py` opens it in headless Chromium and does what a person would. `tools/browser.sh` installs both.

mod sample;

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;

use lapwing_page::{Entry, entry, write};
use lapwing_react::Report;
use lapwing_react::history::History;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

fn page(folder: &Path, name: &str, entries: &[Entry]) {
    write(&mut File::create(folder.join(name)).unwrap(), entries).unwrap();
}

fn part((report, history): &(Report, History)) -> Entry {
    entry(report, std::slice::from_ref(history))
}

/// A recording with which all is well.
fn good() -> (Report, History) {
    let (mut report, mut history) = sample::drive();
    report.trace = "runs/2024-11-04/drive.mcap".into();
    report.properties.truncate(2);
    report.properties.remove(0);
    history.courses.remove(0);
    (report, history)
}

#[test]
fn a_person_finds_what_they_look_for() {
    let python = root().join(".venv/bin/python");
    assert!(python.exists(), "{} is not there: run tools/browser.sh", python.display());
    let folder = tempfile::tempdir().unwrap();
    let (drive, hostile) = (part(&sample::drive()), part(&sample::hostile()));
    page(folder.path(), "drive.html", std::slice::from_ref(&drive));
    page(folder.path(), "hostile.html", std::slice::from_ref(&hostile));
    page(folder.path(), "several.html", &[drive, hostile, part(&good())]);
    let script = root().join("crates/page/tests/browser/look.py");
    let looked = Command::new(python).arg(script).arg(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&looked.stdout);
    assert!(
        looked.status.success(),
        "{said}{}\ntools/browser.sh installs what is missing",
        String::from_utf8_lossy(&looked.stderr)
    );
    assert!(said.lines().filter(|line| line.starts_with("ok ")).count() >= 11, "{said}");
}
