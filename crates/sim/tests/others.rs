//! Other people's tools open our recordings, and read in them what we read.
//!
//! Needs what `tools/peers.sh` and `tools/foxglove.sh` install; without it the tests fail and say so.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use lapwing_record::{Item, Options as Reading, Wanted, open};
use lapwing_sim::{Options, Scenario, record};
use lapwing_stream::Value;
use serde_json::{Value as Json, json};

/// Topics with their fields: every type of message that the simulator writes is among them.
fn fields() -> BTreeMap<&'static str, Vec<&'static str>> {
    BTreeMap::from([
        ("/gazebo/model_states", vec!["name", "pose[1].position.x", "pose[1].orientation.w", "twist[1].linear.x"]),
        ("/tf", vec!["transforms[0].child_frame_id", "transforms[0].transform.translation.x"]),
        ("/clock", vec!["clock.sec", "clock.nanosec"]),
        ("/cmd_vel_original", vec!["linear.x", "angular.z"]),
        ("/cmd_vel", vec!["linear.x", "angular.z"]),
        ("/e_stop", vec!["data"]),
        ("/enable", vec!["data"]),
        ("/reset_odometry", vec!["data"]),
        ("/set_mode/request", vec!["data"]),
        ("/set_mode/reply", vec!["data"]),
        ("/mode", vec!["data"]),
        ("/odom", vec!["header.stamp.sec", "header.frame_id", "pose.pose.position.x", "twist.twist.angular.z"]),
        ("/joint_states", vec!["name", "position", "velocity", "effort"]),
        ("/imu", vec!["orientation.z", "angular_velocity.z", "linear_acceleration.z"]),
        ("/scan", vec!["angle_min", "angle_max", "range_max", "ranges", "intensities"]),
        ("/battery_state", vec!["voltage", "percentage", "power_supply_status", "present", "location"]),
        ("/bumper", vec!["data"]),
        ("/sign", vec!["radiation_type", "max_range", "range"]),
        ("/drone_mov/rotor1", vec!["linear.x", "angular.z"]),
        ("/drone_mov/rotor2", vec!["linear.x", "angular.z"]),
    ])
}

const SCENARIO: &str = "
about = 'Everything at once.'
duration = 3
world = { room = [8, 8], sign = [{ name = 'sign', at = [2, 0.3] }] }
drone = [{ name = 'drone', at = [1, 1], climb = [{ at = 0.2, to = 3 }] }]

[[robot]]
name = 'robot'
at = [0, 0]
drive.road.speed = 0.2
event = [
    { at = 1, do = { set-mode = 'auto' } },
    { at = 1.2, do = 'press-stop' },
    { at = 1.5, do = 'release-stop' },
    { at = 2, do = 'enable' },
    { at = 2.5, do = 'reset-odometry' },
]
";

/// A script of `tests/others` with other people's tools.
fn script(name: &str, file: &Path) -> Command {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let python = here.join("../../.venv/bin/python");
    assert!(python.exists(), "the tools are not installed: run tools/peers.sh once, then this test again");
    let mut command = Command::new(python);
    command.arg(here.join("tests/others").join(name)).arg(file);
    command
}

/// A recording of everything, and how many messages it has.
fn everything() -> (tempfile::NamedTempFile, u64) {
    let file = tempfile::NamedTempFile::with_suffix(".mcap").unwrap();
    let scenario = Scenario::parse("everything", SCENARIO).unwrap();
    let options = Options { seed: 11, ..Options::default() };
    let count = record(&scenario, &options, file.reopen().unwrap()).unwrap();
    (file, count)
}

#[test]
fn rosbags_reads_what_we_read() {
    let (file, count) = everything();
    let said = script("read.py", file.path()).arg(serde_json::to_string(&fields()).unwrap()).output().unwrap();
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    let theirs: Vec<(i64, String, Vec<Json>)> = serde_json::from_slice(&said.stdout).unwrap();
    let ours = ours(file.path());
    assert_eq!((theirs.len() as u64, ours.len() as u64), (count, count));
    for topic in fields().keys() {
        assert!(ours.iter().any(|(_, t, _)| t == topic), "no message on {topic}");
    }
    for (ours, theirs) in sorted(ours).iter().zip(&sorted(theirs)) {
        assert_eq!(ours, theirs);
    }
}

#[test]
fn a_viewer_finds_what_it_needs() {
    let (file, _) = everything();
    let said = script("viewer.py", file.path()).output().unwrap();
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    assert_eq!(String::from_utf8_lossy(&said.stdout), "");
}

/// The libraries that Foxglove itself opens recordings with decode every message, and jump to the middle.
#[test]
fn foxglove_can_read_it() {
    let (file, count) = everything();
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    assert!(here.join("../../.foxglove/installed").exists(), "run tools/foxglove.sh once, then this test again");
    let said = Command::new("node").arg(here.join("tests/others/foxglove.mjs")).arg(file.path()).output().unwrap();
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    let said = String::from_utf8_lossy(&said.stdout).into_owned();
    let topics: Vec<Vec<&str>> = said.lines().map(|line| line.split(' ').collect()).collect();
    for topic in fields().keys() {
        assert!(topics.iter().any(|words| words[0] == *topic), "{topic} is missing from\n{said}");
    }
    let sum = |column: usize| topics.iter().map(|words| words[column].parse::<u64>().unwrap()).sum::<u64>();
    assert_eq!(sum(2), count);
    assert!((count * 2 / 5..=count * 3 / 5).contains(&sum(3)), "{} of {count} come after the middle", sum(3));
}

/// In the order of time, and at one time in that of topics: readers differ in what they give first.
fn sorted(mut all: Vec<(i64, String, Vec<Json>)>) -> Vec<(i64, String, Vec<Json>)> {
    all.sort_by(|a, b| (a.0, &a.1).cmp(&(b.0, &b.1)));
    all
}

fn ours(path: &Path) -> Vec<(i64, String, Vec<Json>)> {
    let wanted: Vec<Wanted> = fields()
        .iter()
        .map(|(topic, fields)| Wanted {
            topic: (*topic).to_owned(),
            fields: fields.iter().map(|f| f.parse().unwrap()).collect(),
        })
        .collect();
    let mut reader = open(path, Reading::default()).unwrap().read(&wanted);
    let mut all = Vec::new();
    while let Some(item) = reader.next() {
        let Item::Message { time, topic, values, .. } = item.unwrap() else { continue };
        all.push((time.0, topic.to_owned(), values.iter().map(plain).collect()));
    }
    assert_eq!(reader.losses(), []);
    all
}

fn plain(value: &Value) -> Json {
    match value {
        Value::Bool(b) => json!(b),
        Value::Num(x) => number(*x),
        Value::Str(s) => json!(s),
        Value::Nums(v) => v.iter().map(|x| number(*x)).collect(),
        Value::List(v) => v.iter().map(plain).collect(),
        other => panic!("{other:?}"),
    }
}

/// Numbers compare as numbers, whether they were written `1` or `1.0`; JSON has no infinity.
fn number(x: f64) -> Json {
    match (x.is_finite(), x.fract() == 0.0) {
        (false, _) => json!(format!("{x}")),
        (true, true) => json!(x as i64),
        (true, false) => json!(x),
    }
}
