//! Capsules: what is in them, and that they replay.

mod common;

use std::path::Path;
use std::process::Command;

use common::{Folder, Run, stop_sign};
use serde_json::Value;

/// Checks, and writes capsules into `caps`.
fn encapsulate(folder: &Folder, words: &str) -> Run {
    folder.lapwing(&format!("check {words} --capsules caps"))
}

fn verdict(folder: &Folder, capsule: &str) -> Value {
    serde_json::from_str(&folder.read(&format!("caps/{capsule}/verdict.json"))).unwrap()
}

/// Replays a capsule, which must give the same verdict.
fn replays(folder: &Folder, capsule: &str) -> String {
    let run = folder.lapwing(&format!("replay caps/{capsule}"));
    assert!(run.stdout.contains("the same verdict as in the recording"), "{}{}", run.stdout, run.stderr);
    assert_eq!(run.code, 1);
    run.stdout
}

/// What the libraries that Foxglove opens recordings with find in a file: its topics, their types, how many messages, and how many after the middle.
fn by_foxglove(folder: &Folder, file: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    assert!(root.join(".foxglove/installed").exists(), "run tools/foxglove.sh once, then this test again");
    let script = root.join("crates/sim/tests/others/foxglove.mjs");
    let said = Command::new("node").arg(script).arg(folder.path(file)).output().unwrap();
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    String::from_utf8_lossy(&said.stdout).into_owned()
}

#[test]
fn foxglove_can_read_the_clips() {
    let folder = Folder::new(&[("stop.rv", STOP), ("x.rv", "never x > 5\n"), ("run.csv", "time,x\n0,1\n1,9\n3,1\n")]);
    folder.write("run.mcap", &stop_sign());
    assert_eq!(encapsulate(&folder, "stop.rv run.mcap").code, 1);
    let said = by_foxglove(&folder, "caps/second_stop-1/clip.mcap");
    assert!(said.contains("/odom nav_msgs/msg/Odometry ") && said.contains("/lapwing/end "), "{said}");
    assert_eq!(encapsulate(&folder, "x.rv run.csv").code, 1);
    let said = by_foxglove(&folder, "caps/line-1-1/clip.mcap");
    assert_eq!(said, "/lapwing/rows lapwing.rows 3 1\n/lapwing/end lapwing.end 1 1\n");
}

const STOP: &str = "\
decl speed /odom nav_msgs/Odometry.twist.twist.linear.x
second_stop: after_until car.distance.second_sign < 2, car.distance.second_sign > 2, eventually
    car.velocity =={0.01} 0
";

#[test]
fn a_capsule_has_the_original_messages_around_the_violation() {
    let folder = Folder::new(&[("stop.rv", STOP)]);
    folder.write("run.mcap", &stop_sign());
    let run = encapsulate(&folder, "stop.rv run.mcap");
    assert!(run.code == 1 && run.stderr.contains("wrote caps/second_stop-1\n"), "{}", run.stderr);
    let verdict = verdict(&folder, "second_stop-1");
    let (began, failed) = (verdict["began_ns"].as_u64().unwrap(), verdict["failed_ns"].as_u64().unwrap());
    assert!(began < failed && verdict["clip"]["replays"] == true && verdict["verdict"] == "violated", "{verdict:#}");
    assert!(verdict["values"]["car.velocity"].is_number(), "{verdict:#}");
    assert_eq!(folder.read("caps/second_stop-1/spec.rv"), STOP);

    let messages = |bytes: &[u8]| -> Vec<(String, String, u64, Vec<u8>)> {
        mcap::MessageStream::new(bytes)
            .unwrap()
            .map(Result::unwrap)
            .map(|m| {
                let schema = m.channel.schema.as_ref().map(|s| s.name.clone()).unwrap_or_default();
                (m.channel.topic.clone(), schema, m.log_time, m.data.to_vec())
            })
            .collect()
    };
    let clip = messages(&std::fs::read(folder.path("caps/second_stop-1/clip.mcap")).unwrap());
    let all = messages(&stop_sign());
    let is_inside = |time: u64| (began - 5_000_000_000..=failed + 2_000_000_000).contains(&time);
    let read = |topic: &str| ["/odom", "/gazebo/model_states"].contains(&topic);
    let expected: Vec<_> = all.into_iter().filter(|m| read(&m.0) && is_inside(m.2)).collect();
    let (end, copied): (Vec<_>, Vec<_>) = clip.into_iter().partition(|m| m.0 == "/lapwing/end");
    assert!(copied == expected && copied.len() > 100, "{} of {}", copied.len(), expected.len());
    assert!(copied.iter().any(|m| m.1 == "nav_msgs/msg/Odometry"), "{:?}", copied[0].1);
    assert_eq!(end.len(), 1);

    let page = folder.read("caps/second_stop-1/README.md");
    for said in ["lapwing replay caps/second_stop-1", "car.velocity", "Error at line 2:", "gives the same violation"] {
        assert!(page.contains(said), "{said}\n{page}");
    }
    assert!(replays(&folder, "second_stop-1").contains("Error at line 2:"));
}

#[test]
fn under_a_rate_a_clip_begins_at_one_of_its_instants() {
    let spec = "__rate__ = 7\nfast: never car.velocity > 1.5\n";
    let folder = Folder::new(&[("fast.rv", spec)]);
    folder.write("run.mcap", &stop_sign());
    let run = encapsulate(&folder, "fast.rv run.mcap --quiet");
    assert_eq!(run.code, 1, "{}", run.stdout);
    assert!(verdict(&folder, "fast-1")["clip"]["replays"] == true, "{}", verdict(&folder, "fast-1"));
    replays(&folder, "fast-1");
}

/// A recording in which the robot is armed and its machine starts long before anything goes wrong.
fn long_ago() -> String {
    let mut lines = vec![
        r#"{"t":0,"values":{"armed":true,"ball":false,"v":0}}"#.to_owned(),
        r#"{"t":1,"values":{"ball":true}}"#.to_owned(),
    ];
    lines.extend((2..1000).map(|k| format!(r#"{{"t":{k}.5,"values":{{"v":{}}}}}"#, k % 7)));
    lines.push(r#"{"t":1001,"event":"kick","power":9}"#.to_owned());
    lines.push(r#"{"t":1002,"values":{"armed":false}}"#.to_owned());
    lines.join("\n") + "\n"
}

const LATCHED: &str = "\
machine robot {
    initial idle
    state idle when not ball
    state chase when ball
    idle -> chase
}
event kick
gentle: whenever kick and robot == chase, kick.power < 5
shy: never (once (armed and v == 0 and not ball)) and not armed
";

#[test]
fn where_a_property_needs_what_was_long_ago_the_clip_has_it() {
    let folder = Folder::new(&[("latched.rv", LATCHED), ("run.ndjson", &long_ago())]);
    assert_eq!(encapsulate(&folder, "latched.rv run.ndjson").code, 1);
    // The machine and the armed robot are carried into a short clip.
    let gentle = verdict(&folder, "gentle-1");
    assert!(gentle["clip"]["carries_latest"] == true && gentle["clip"]["from_ns"].is_i64(), "{gentle:#}");
    replays(&folder, "gentle-1");
    // What was true once only shows in a clip from the beginning.
    let shy = verdict(&folder, "shy-1");
    assert!(shy["clip"]["replays"] == true && shy["clip"]["from_ns"].is_null(), "{shy:#}");
    replays(&folder, "shy-1");
}

#[test]
fn tables_and_their_messages_replay_as_text_and_can_be_viewed() {
    let rows = "time,\"a b\",x,mode\n0,1,nan,go\n1,1,2.5,\"say \"\"hi\"\"\"\n2,,7,go\n9,1,1,go\n20,1,1,go\n";
    let spec = "never `a b` == 1 and x > 5\nnever mode == \"say \\\"hi\\\"\"\n";
    let folder = Folder::new(&[("table.rv", spec), ("run.csv", rows)]);
    assert_eq!(encapsulate(&folder, "table.rv run.csv").code, 1);
    replays(&folder, "line-1-1");
    replays(&folder, "line-2-1");
    let clip = std::fs::read(folder.path("caps/line-1-1/clip.mcap")).unwrap();
    let topics: Vec<String> =
        mcap::MessageStream::new(&clip).unwrap().map(|m| m.unwrap().channel.topic.clone()).collect();
    // The row at 9 s lies behind the two seconds after the failure: it shows that time went on, which the next ones need not show again.
    assert!(topics.iter().filter(|t| *t == "/lapwing/rows").count() == 4, "{topics:?}");

    let lines = concat!(
        r#"{"t":0,"topic":"/scan","type":"sensor_msgs/LaserScan","msg":{"range_min":1.0,"ranges":[1,2,3]}}"#,
        "\n",
        r#"{"t":9,"topic":"/scan","type":"sensor_msgs/LaserScan","msg":{"range_min":0.1,"ranges":[1,0.5,3]}}"#,
        "\n",
        r#"{"t":12,"topic":"/other","msg":{"x":1}}"#,
        "\n"
    );
    let spec = "decl near /scan sensor_msgs/LaserScan.range_min\nalive: whenever near < 0.5, always within 1 s age(/scan) < 0.5 s\n";
    let folder = Folder::new(&[("scan.rv", spec), ("scan.ndjson", lines)]);
    assert_eq!(encapsulate(&folder, "scan.rv scan.ndjson").code, 1);
    replays(&folder, "alive-1");
}

#[test]
fn files_that_a_specification_uses_come_along() {
    let folder = Folder::new(&[
        ("specs/main.rv", "use \"lib/limits.rv\"\nslow: below(x)\n"),
        ("specs/lib/limits.rv", "pattern below(v): never v > 5\n"),
        ("run.csv", "time,x\n0,1\n1,9\n"),
    ]);
    assert_eq!(encapsulate(&folder, "specs/main.rv run.csv").code, 1);
    assert_eq!(folder.read("caps/slow-1/lib/limits.rv"), "pattern below(v): never v > 5\n");
    replays(&folder, "slow-1");
}

#[test]
fn what_differs_is_said_and_what_is_no_capsule_is_refused() {
    let folder = Folder::new(&[("a.rv", "never x > 5\n"), ("run.csv", "time,x\n0,1\n1,9\n2,9\n3,1\n4,8\n")]);
    let run = encapsulate(&folder, "a.rv run.csv");
    assert_eq!(run.stderr, "wrote caps/line-1-1\nwrote caps/line-1-2\n");
    // Nothing is overwritten.
    assert!(encapsulate(&folder, "a.rv run.csv").stderr.contains("wrote caps/line-1-1.2\n"));
    folder.write("caps/line-1-1/spec.rv", b"never x > 50\n");
    let run = folder.lapwing("replay caps/line-1-1");
    assert!(
        run.code == 3 && run.stdout.contains("another verdict") && run.stdout.contains("now it is holds"),
        "{run:?}"
    );
    folder.write("caps/line-1-2/clip.csv", b"time,x\n0.5,1\n1.5,9\n");
    let run = folder.lapwing("replay caps/line-1-2");
    assert!(run.code == 3 && run.stdout.contains("now it begins at 1.5 s"), "{run:?}");
    assert!(folder.lapwing("replay nowhere").stderr.contains("no such folder"));
    folder.write("caps/line-1-2/verdict.json", b"{}");
    let run = folder.lapwing("replay caps/line-1-2");
    assert!(run.code == 2 && run.stderr.contains("names no property"), "{run:?}");
    let run = folder.lapwing_with("check a.rv - --capsules caps", "time,x\n0,9\n");
    assert!(run.code == 1 && run.stderr.contains("standard input cannot be read twice"), "{run:?}");
}

#[test]
fn several_recordings_get_folders_of_their_own() {
    let folder = Folder::new(&[("a.rv", "never x > 5\n"), ("r/1.csv", "time,x\n0,9\n"), ("s/1.csv", "time,x\n0,9\n")]);
    let run = encapsulate(&folder, "a.rv r/1.csv s/1.csv");
    assert_eq!(run.stderr, "wrote caps/001-1/line-1-1\nwrote caps/002-1/line-1-1\n");
    replays(&folder, "002-1/line-1-1");
}
