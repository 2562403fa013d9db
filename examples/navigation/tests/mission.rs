//! The case study: what the monitor makes of a mission, in logical and in real time, and what a recording says of it afterwards.

use std::path::{Path, PathBuf};

use lapwing::{Options, Session, Spec};
use lapwing_components::Outcome;
use navigation::{Mission, Went};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn verdict(went: &Went, name: &str) -> &'static str {
    let report = went.report.as_ref().unwrap();
    report.properties.iter().find(|p| p.name == name).unwrap().verdict.word()
}

/// The place of the first line that has all of these words.
fn at(went: &Went, words: &[&str]) -> usize {
    let found = went.log.iter().position(|line| words.iter().all(|word| line.contains(word)));
    found.unwrap_or_else(|| panic!("no line with {words:?} in {:#?}", went.log))
}

#[test]
fn the_mission_succeeds_where_nothing_is_wrong() {
    for seed in [1, 2, 3] {
        let mission = Mission { spec: Some(file("navigation.rv")), seed, ..Mission::default() };
        let went = mission.fly().unwrap();
        assert_eq!(went.goto, Some(Outcome::Done), "seed {seed}: {:?}", went.pose);
        assert_eq!((went.bump, verdict(&went, "Scan_Fail"), verdict(&went, "stands")), (None, "holds", "holds"));
        assert!((went.pose.x - 7.0).abs() < 0.6 && went.pose.y.abs() < 0.6, "{:?}", went.pose);
        assert_eq!((went.missed, went.overruns), (0, 0));
    }
}

#[test]
fn where_scans_come_late_the_robot_hits_a_pillar_unless_it_is_watched() {
    let delayed = Mission { delay: Some((6.0, 3.0)), ..Mission::default() };
    let unwatched = delayed.fly().unwrap();
    assert!(unwatched.bump.is_some(), "{:?}", unwatched.pose);

    let went = Mission { spec: Some(file("navigation.rv")), ..delayed }.fly().unwrap();
    assert_eq!((went.bump, went.goto.clone()), (None, Some(Outcome::Interrupted)));
    assert_eq!((verdict(&went, "Scan_Fail"), verdict(&went, "stands")), ("violated", "holds"));
    assert!(went.speed.abs() < 1e-9, "{}", went.speed);
    // The paper's log: the violation is chosen, the codel `stop` is called, a speed of zero is written.
    let order = [
        at(&went, &["violation Scan_Fail"]),
        at(&went, &["request", "SafetyPilot.Stop()", "by Scan_Fail"]),
        at(&went, &["interrupt SafetyPilot.StopIfObstacle"]),
        at(&went, &["call SafetyPilot.StopIfObstacle.stop ZeroSpeed"]),
        at(&went, &["write SafetyPilot.Cmd", "\"linear\":0.0,\"angular\":0.0"]),
    ];
    assert!(order[1..].is_sorted(), "{order:?}");
}

#[test]
fn forty_milliseconds_are_too_strict_for_a_laser_of_forty() {
    let went = Mission { spec: Some(file("too_strict.rv")), ..Mission::default() }.fly().unwrap();
    assert_eq!((verdict(&went, "Scan_Fail"), went.goto), ("violated", Some(Outcome::Interrupted)));
}

/// Bounded response, absence, periodicity, latency, the time of a codel, the period of a task: each holds of a healthy mission, and what a late laser
/// breaks is what it should break.
#[test]
fn the_example_properties_hold_unless_scans_are_late() {
    let mission = Mission { spec: Some(file("properties.rv")), ..Mission::default() };
    let healthy = mission.fly().unwrap();
    let verdicts = |went: &Went| {
        let all = &went.report.as_ref().unwrap().properties;
        all.iter().map(|p| (p.name.clone(), p.verdict.word())).collect::<Vec<_>>()
    };
    let failed =
        |went: &Went| verdicts(went).into_iter().filter(|(_, v)| *v == "violated").map(|(n, _)| n).collect::<Vec<_>>();
    assert_eq!(failed(&healthy), Vec::<String>::new(), "{:?}", verdicts(&healthy));
    assert!(verdicts(&healthy).contains(&("arrives".to_owned(), "satisfied")), "{:?}", verdicts(&healthy));
    let late = Mission { delay: Some((0.2, 3.0)), ..mission }.fly().unwrap();
    assert_eq!(failed(&late), ["recent", "quick"], "{:?}", verdicts(&late));
}

#[test]
fn a_recording_is_judged_as_the_run_was() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["run.mcap", "run.ndjson"] {
        let record = folder.path().join(name);
        let delay = Some((0.3, 3.0));
        let mission =
            Mission { spec: Some(file("navigation.rv")), delay, record: Some(record.clone()), ..Mission::default() };
        let live = mission.fly().unwrap().report.unwrap();
        let specs = [Spec::load(&file("navigation.rv")).unwrap()];
        let again = Session::open(&specs, &record, &Options::default()).unwrap().run(&mut ());
        assert_eq!(again.gaps, Vec::<String>::new());
        assert_eq!(live.properties.len(), again.properties.len());
        for (live, again) in live.properties.iter().zip(&again.properties) {
            let told = |p: &lapwing_react::Property| (p.name.clone(), p.verdict, p.violations.clone(), p.obligations);
            assert_eq!(told(live), told(again), "{name}");
        }
        assert!(live.properties.iter().any(|p| !p.violations.is_empty()), "{name}");
    }
}

#[test]
fn the_same_seed_gives_the_same_recording_byte_for_byte() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = |name: &str, seed| {
        let record = folder.path().join(name);
        Mission { seed, seconds: 4.0, record: Some(record.clone()), ..Mission::default() }.fly().unwrap();
        std::fs::read(record).unwrap()
    };
    let (one, two, other) = (bytes("1.mcap", 5), bytes("2.mcap", 5), bytes("3.mcap", 6));
    assert!(one == two && one != other);
}

#[test]
fn in_real_time_the_monitor_stops_the_robot_as_well() {
    let mission = Mission {
        spec: Some(file("navigation.rv")),
        delay: Some((2.5, 2.0)),
        is_real: true,
        seconds: 20.0,
        ..Mission::default()
    };
    let went = mission.fly().unwrap();
    // A machine that is slow may make scans late by itself; then the robot stops the earlier.
    assert_eq!((went.bump, verdict(&went, "Scan_Fail")), (None, "violated"));
    assert!(at(&went, &["violation Scan_Fail"]) < at(&went, &["call SafetyPilot.StopIfObstacle.stop ZeroSpeed"]));
    assert!(went.speed.abs() < 1e-9, "{}", went.speed);
}
