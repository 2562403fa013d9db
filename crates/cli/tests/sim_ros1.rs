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

/// Runs cases of `catch.py`, the command of the example: Lapwing watches a simulator and a fault daemon, and three reports are compared.
fn caught(cases: &[&str]) {
    let mut command = Command::new("/usr/bin/python3");
    command.arg(examples().join("live/catch.py")).arg("ros1").args(cases);
    let done = command.env("LAPWING", env!("CARGO_BIN_EXE_lapwing")).output().unwrap();
    let (said, complained) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
    assert!(
        done.status.success() && cases.iter().all(|case| said.contains(case)),
        "{said}{complained}tools/peers.sh installs what is missing"
    );
}

#[test]
fn the_docking_of_a_healthy_and_of_a_faulty_robot() {
    caught(&["healthy", "docking-stuck"]);
}

#[test]
fn the_other_bugs_and_the_stop_sign() {
    caught(&["direction-inverted", "backwards", "sign-unseen"]);
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
        (&["sim", "docking", "--speed", "2"], "add --ros1 or --ros2"),
        (&["sim", "docking", "--ros1", "--speed", "0"], "from 0.01 to 1000"),
        (&["sim", "docking", "--ros1", "http://:"], "no address"),
    ] {
        let done = lapwing(arguments).output().unwrap();
        let said = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.code() == Some(2) && said.contains(says), "{arguments:?}: {said}");
    }
}
