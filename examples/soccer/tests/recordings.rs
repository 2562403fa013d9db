//! Recordings of matches: `lapwing check soccer.rv` gives the verdicts that the monitors gave, and the state diagram needs the signals alone.

mod common;

use std::fs;

use common::{checked, player, soccer};
use soccer::fault::Fault;
use soccer::game::SPEC;

#[test]
fn a_recording_gives_the_verdicts_of_the_match() {
    let folder = tempfile::tempdir().unwrap();
    let record = |name: &str, fault: Option<Fault>| {
        let path = folder.path().join(name);
        let mut arguments = vec!["play", "--record", path.to_str().unwrap()];
        fault.into_iter().for_each(|fault| arguments.extend(["--fault", fault.name()]));
        soccer(&arguments);
        checked("soccer.rv", SPEC, &path)
    };
    for fault in std::iter::once(None).chain(Fault::ALL.map(Some)) {
        let account = player(1).play(fault, None).unwrap();
        let offline = record("run.ndjson", fault);
        assert_eq!(record("match.mcap", fault), offline, "{fault:?}: as MCAP and as NDJSON");
        assert_eq!(offline, account.rejudged, "{fault:?}: the log, read as a file and gone through once more");
        let verdicts =
            |all: &[soccer::watch::Judged]| all.iter().map(|j| (j.name.clone(), j.verdict.clone())).collect::<Vec<_>>();
        assert_eq!(verdicts(&offline), verdicts(&account.judged), "{fault:?}: offline and live");
        let first = |all: &[soccer::watch::Judged]| all.iter().map(|j| j.failed.first().copied()).collect::<Vec<_>>();
        assert_eq!(first(&offline), first(&account.judged), "{fault:?}: the first failures");
    }
}

#[test]
fn the_state_diagram_is_checked_from_signals_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.ndjson");
    for fault in ["range-missed", "sonar-unplugged"] {
        soccer(&["play", "--fault", fault, "--record", path.to_str().unwrap()]);
        let whole = checked("soccer.rv", SPEC, &path);
        let recording = fs::read_to_string(&path).unwrap();
        let signals: Vec<&str> = recording.lines().filter(|line| line.contains("\"values\"")).collect();
        assert!(signals.len() > 1000 && signals.len() < recording.lines().count());
        fs::write(&path, signals.join("\n") + "\n").unwrap();
        let diagram = SPEC.split("\nevent ").next().unwrap();
        assert_eq!(checked("diagram.rv", diagram, &path), whole[..1], "{fault}");
        assert_eq!(whole[0].verdict, "violated");
        // What needs the events of the program says that it cannot be judged.
        let properties = checked("soccer.rv", SPEC, &path);
        assert!(properties[1..].iter().all(|p| p.verdict == "inconclusive"), "{properties:?}");
    }
}
