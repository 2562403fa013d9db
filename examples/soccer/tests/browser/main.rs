//! The page of a match in a real browser: `look.py` opens it in headless Chromium. `tools/browser.sh` installs both.

#[path = "../common/mod.rs"]
mod common;

use std::path::Path;
use std::process::Command;

#[test]
fn a_match_can_be_watched() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let python = root.join(".venv/bin/python");
    assert!(python.exists(), "{} is not there: run tools/browser.sh", python.display());
    let folder = tempfile::tempdir().unwrap();
    let page = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    common::soccer(&["play", "--page", &page("healthy.html")]);
    common::soccer(&["play", "--fault", "ball-off", "--page", &page("ball-off.html")]);
    common::soccer(&["play", "--fault", "taken-while-dribbling", "--page", &page("taken.html")]);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser/look.py");
    let looked = Command::new(python).arg(script).arg(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&looked.stdout);
    assert!(
        looked.status.success(),
        "{said}{}\ntools/browser.sh installs what is missing",
        String::from_utf8_lossy(&looked.stderr)
    );
    assert_eq!(said.lines().filter(|line| line.starts_with("ok ")).count(), 5, "{said}");
}
