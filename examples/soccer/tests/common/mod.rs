//! Matches for the tests, each in a process of its own, and recordings of them.

// Each test uses what it needs of it.
#![allow(dead_code)]

use std::fs;
use std::path::Path;
use std::process::Command;

use soccer::figures::Player;
use soccer::watch::Judged;

/// The program that plays.
pub fn player(seed: u64) -> Player {
    Player::new(env!("CARGO_BIN_EXE_soccer").into(), seed)
}

/// Runs the command; what it wrote to standard output.
pub fn soccer(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_soccer")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// A part of the README, between `<!-- NAME -->` and `<!-- /NAME -->`, is as it should be; with `BLESS` it is made so. `test` is the one that asks.
pub fn readme_has(name: &str, part: &str, test: &str) {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let there = fs::read_to_string(&page).unwrap();
    let (before, rest) = there.split_once(&format!("<!-- {name} -->\n")).unwrap();
    let (_, after) = rest.split_once(&format!("<!-- /{name} -->")).unwrap();
    let wanted = format!("{before}<!-- {name} -->\n{part}<!-- /{name} -->{after}");
    if std::env::var_os("BLESS").is_some() {
        fs::write(&page, wanted).unwrap();
    } else {
        assert!(there == wanted, "README.md is out of date: BLESS=1 cargo test -p soccer --test {test}");
    }
}

/// What `lapwing check` says of a recording.
pub fn checked(name: &str, spec: &str, recording: &Path) -> Vec<Judged> {
    let specs = [lapwing::Spec::parse(name, spec, &|_| None).unwrap_or_else(|e| panic!("{e}"))];
    let session = lapwing::Session::open(&specs, recording, &lapwing::Options::default()).unwrap();
    session.run(&mut ()).properties.iter().map(Judged::of).collect()
}
