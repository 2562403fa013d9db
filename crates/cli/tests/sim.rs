//! `lapwing sim`: recordings, runs that are checked while they go on, and campaigns.

mod common;

use common::Folder;

const SPEC: &str = "decl cmd /cmd_vel Twist.linear.x\nspeed: never cmd > 0.19\n";

#[test]
fn a_run_is_the_same_from_a_file_and_without_one() {
    let folder = Folder::new(&[("robot.rv", SPEC)]);
    let made = folder.lapwing("sim patrol --duration 8s --fault overspeed@3 --seed 5 -o run.mcap");
    assert_eq!((made.code, made.stdout.as_str()), (0, ""), "{}", made.stderr);
    assert!(made.stderr.starts_with("run.mcap: ") && made.stderr.ends_with(" messages\n"), "{}", made.stderr);
    let from_file = folder.lapwing("check robot.rv run.mcap --format json");
    let direct = folder.lapwing("sim patrol --duration 8s --fault overspeed@3 --seed 5 --check robot.rv --format json");
    assert_eq!((from_file.code, direct.code), (1, 1), "{}{}", from_file.stderr, direct.stderr);
    assert_eq!(from_file.stdout.replace("\"run.mcap\"", "\"patrol#5\""), direct.stdout);
    assert!(direct.stdout.contains("\"verdict\":\"violated\""), "{}", direct.stdout);
    let again = folder.lapwing("sim patrol --duration 8s --fault overspeed@3 --seed 5 -o again.mcap");
    assert_eq!(again.code, 0);
    let bytes = |name| std::fs::read(folder.path(name)).unwrap();
    assert!(bytes("run.mcap") == bytes("again.mcap"), "the same run twice, and different bytes");
}

#[test]
fn a_campaign_is_summed_up_and_its_failures_can_be_kept() {
    let folder = Folder::new(&[("robot.rv", SPEC)]);
    let run = folder.lapwing("sim wander --runs 6 --duration 10s --check robot.rv --jobs 2 --seed 40 -o bad --quiet");
    assert_eq!(run.code, 1, "{}{}", run.stdout, run.stderr);
    assert!(run.stdout.starts_with("wander: 6 runs from seed 40 on\n"), "{}", run.stdout);
    let line = run.stdout.lines().find(|l| l.trim_start().starts_with("speed")).unwrap();
    let counts: Vec<u64> = line.split_whitespace().skip(1).map(|n| n.parse().unwrap()).collect();
    assert_eq!(counts[..5].iter().sum::<u64>(), 6, "{line}");
    let kept: Vec<_> = std::fs::read_dir(folder.path("bad")).unwrap().collect();
    assert!(counts[0] > 0 && kept.len() as u64 == counts[0], "{line}, {kept:?}");
    // The command that the summary proposes shows a run that failed.
    let again = run.stdout.lines().find_map(|l| l.strip_prefix("  lapwing sim wander --seed")).unwrap();
    let shown = folder.lapwing(&format!("sim wander --seed{again}"));
    assert!(shown.code == 1 && shown.stdout.contains("Error at line 2:"), "{}", shown.stdout);
    let json = folder.lapwing("sim wander --runs 3 --duration 2s --check robot.rv --format json");
    let reports: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    let names: Vec<_> = reports.as_array().unwrap().iter().map(|r| r["trace"].as_str().unwrap()).collect();
    assert_eq!(names, ["wander#1", "wander#2", "wander#3"]);
}

#[test]
fn the_list_has_scenarios_and_faults() {
    let run = Folder::new(&[]).lapwing("sim --list");
    assert_eq!(run.code, 0);
    for part in ["Scenarios:\n", "  stop-sign ", "Faults:\n", "  docking-stuck ", "(kobuki 0416c81)"] {
        assert!(run.stdout.contains(part), "{part}: {}", run.stdout);
    }
}

#[test]
fn what_is_wrong_is_said_with_a_proposal() {
    let folder = Folder::new(&[("mine.toml", "about = ''\nrobt = 1\n")]);
    for (arguments, part) in [
        ("sim patrl", "did you mean `patrol`?"),
        ("sim", "SCENARIO"),
        ("sim patrol --fault froze-scan", "did you mean `frozen-scan`?"),
        ("sim fleet --fault robot3:frozen-scan", "there is no robot called `robot3`"),
        ("sim mine.toml", "mine.toml:2:1: unknown field `robt`"),
        ("sim patrol --runs 5", "--check"),
        ("sim patrol -o missing/run.mcap", "missing/run.mcap: "),
        ("sim patrol --check missing.rv", "there is no such file"),
    ] {
        let run = folder.lapwing(arguments);
        assert!(run.code == 2 && run.stderr.contains(part), "{arguments}: {} {}", run.code, run.stderr);
    }
}
