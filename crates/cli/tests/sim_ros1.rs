//! The simulator as a node of ROS 1, with a fault daemon written with rospy between its program and its base.
//!
//! Needs what `tools/peers.sh` installs; without it the test fails and says so.
#![cfg(feature = "ros1")]

#[allow(dead_code, reason = "the tests of the node use all of it")]
#[path = "../../ros/tests/ros1/peers.rs"]
mod peers;

use std::path::Path;
use std::process::Command;

use lapwing_stream::Value;
use peers::World;

fn lapwing(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lapwing"));
    command.args(arguments);
    command
}

fn examples() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/turtlebot")
}

/// Runs the docking with a fault of the daemon, live, and gives the verdict of the corrected property on what was recorded.
fn docked_with(fault: &str) -> String {
    let world = World::new();
    let _master = world.roscore();
    let daemon = examples().join("live/fault_daemon.py");
    let daemon = world.tool("/usr/bin/python3", &[daemon.to_str().unwrap(), fault]);
    daemon.line_with("ready");
    let recording = tempfile::NamedTempFile::with_suffix(".mcap").unwrap();
    let path = recording.path().to_str().unwrap();
    let run = ["sim", "docking", "--ros1", &world.uri(), "--outside", "--duration", "12s", "-o", path];
    let done = lapwing(&run).output().unwrap();
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success() && said.contains("commands come from /cmd_vel"), "{said}");
    let spec = examples().join("docking.rv");
    let checked = lapwing(&["check", spec.to_str().unwrap(), path, "--format", "json"]).output().unwrap();
    let report: serde_json::Value = serde_json::from_slice(&checked.stdout).unwrap();
    let properties = report[0]["properties"].as_array().unwrap();
    let corrected = properties.iter().find(|p| p["name"] == "corrected").unwrap();
    corrected["verdict"].as_str().unwrap().to_owned()
}

#[test]
fn a_base_that_others_command_obeys_them_faults_and_all() {
    assert_eq!(docked_with("none"), "holds");
    assert_eq!(docked_with("docking-stuck"), "violated");
}

#[test]
fn all_that_the_simulator_says_is_heard() {
    let world = World::new();
    let _master = world.roscore();
    let mut child =
        lapwing(&["sim", "patrol", "--ros1", &world.uri(), "--duration", "20s", "--quiet"]).spawn().unwrap();
    let mut watch = world.watch(&["/clock", "/odom", "/scan", "/gazebo/model_states", "/tf", "/battery_state"]);
    let clock = watch.message("/clock", &["clock.secs"]);
    assert!(matches!(clock[..], [Value::Num(_)]), "{clock:?}");
    for (topic, field) in [
        ("/odom", "pose.pose.orientation.w"),
        ("/scan", "ranges[0]"),
        ("/gazebo/model_states", "name[0]"),
        ("/tf", "transforms[0].transform.translation.x"),
        ("/battery_state", "percentage"),
    ] {
        let values = watch.message(topic, &[field]);
        assert!(!matches!(values[..], [Value::Missing]), "{topic}");
    }
    let echo = world.tool("rostopic", &["echo", "-n", "1", "/odom/header/frame_id"]);
    assert!(echo.line_with("odom").contains("odom"));
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn what_does_not_go_together_is_said() {
    for (arguments, says) in [
        (&["sim", "docking", "--outside"][..], "add --ros1 or --ros2"),
        (&["sim", "docking", "--ros1", "--check", "x.rv"], "`lapwing monitor`"),
        (&["sim", "docking", "--ros1", "http://:"], "no address"),
    ] {
        let done = lapwing(arguments).output().unwrap();
        let said = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.code() == Some(2) && said.contains(says), "{arguments:?}: {said}");
    }
}
