//! Matches: the healthy robot violates nothing, whatever the seed; the same seed gives the same match; every fault is caught and mended; the
//! table of the README says what came out.

mod common;

use std::fs;

use common::{player, readme_has, soccer};
use soccer::fault::Fault;
use soccer::figures::{compare, surprises, tables};
use soccer::game::spec;

#[test]
fn the_healthy_robot_violates_nothing() {
    for seed in 1..=12 {
        let account = player(seed).play(None, None).unwrap();
        let wrong: Vec<_> = account.judged.iter().filter(|j| j.verdict != "holds").collect();
        assert!(wrong.is_empty() && account.judged.len() == 7, "seed {seed}: {wrong:?}");
        assert!(account.goal, "seed {seed}");
        let walked: Vec<&str> = account.states.iter().map(|(_, state)| state.as_str()).collect();
        assert!(walked.starts_with(&["init", "turn_to_ball", "goto_ball"]), "{walked:?}");
        assert!(walked.ends_with(&["dribble_to_goal", "kick_ball_to_goal", "game_over"]), "{walked:?}");
    }
}

#[test]
fn the_same_seed_gives_the_same_match() {
    let folder = tempfile::tempdir().unwrap();
    let record = |name: &str, seed: &str| {
        let path = folder.path().join(name);
        soccer(&["play", "--fault", "ball-off", "--seed", seed, "--record", path.to_str().unwrap()]);
        fs::read_to_string(path).unwrap()
    };
    let first = record("a.ndjson", "7");
    assert!(first.lines().count() > 3000 && first == record("b.ndjson", "7"));
    assert_ne!(first, record("c.ndjson", "8"));
}

#[test]
fn the_figures_come_out_and_the_readme_says_so() {
    let spec = spec().unwrap();
    let results = compare(&spec.alone().spec, &player(1)).unwrap();
    let wrong = surprises(&results);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    readme_has("table", &tables(&results), "matches");
}

#[test]
fn the_figures_come_out_for_another_seed_too() {
    let spec = spec().unwrap();
    let wrong = surprises(&compare(&spec.alone().spec, &player(2)).unwrap());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_violation_is_where_the_fault_is() {
    let cases = [
        (Fault::Unplugged, "init"),
        (Fault::BallOff, "always_ir"),
        (Fault::BallTakenAfterTurn, "ball_in_front_until_kick"),
        (Fault::BallTakenWhileDribbling, "ball_in_front_until_kick"),
        (Fault::KickLeftOut, "eventually_kicks"),
        (Fault::KickAtOnce, "ball_close_at_kick"),
        (Fault::KickOutOfRange, "ball_close_at_kick"),
        (Fault::RangeMissed, "goto_goal_until_in_range"),
        (Fault::SonarUnplugged, "soccer"),
    ];
    assert_eq!(cases.map(|(fault, _)| fault), Fault::ALL);
    for (fault, property) in cases {
        let account = player(1).play(Some(fault), None).unwrap();
        let first = account.happenings.iter().find(|h| h.name.starts_with('!')).unwrap();
        assert_eq!(first.name, format!("!{property}"), "{fault}");
    }
}

#[test]
fn the_ball_taken_while_dribbling_alone_violates_the_way_to_the_goal() {
    let property = "goto_goal_until_in_range";
    let account = player(1).play(Some(Fault::BallTakenWhileDribbling), Some(property)).unwrap();
    let names: Vec<&str> = account.happenings.iter().map(|h| h.name.as_str()).collect();
    let at = names.iter().position(|n| *n == "goto_goal_false").unwrap();
    assert_eq!(names[at + 1], format!("!{property}"));
    assert!(names.contains(&"game_over"), "the handler kicks, and the robot plays on");
}
