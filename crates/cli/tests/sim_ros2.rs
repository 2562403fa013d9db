//! The simulator as a node of ROS 2, with a fault daemon written with rclpy between its program and its base, and Lapwing watching: the command of the
//! example, `catch.py`, which compares three reports of each run.
//!
//! Needs what `tools/ros2.sh` installs; without it the test fails and says so.
#![cfg(feature = "ros2")]

use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Runs cases in a domain of their own.
fn caught(domain: u16, cases: &[&str]) {
    let distribution = std::env::var("LAPWING_ROS2").unwrap_or_else(|_| "jazzy".to_owned());
    let python = root().join(format!(".venv-{distribution}/bin/python"));
    assert!(python.exists(), "there is no {}: `tools/ros2.sh {distribution}` makes it", python.display());
    let mut command = Command::new(python);
    command.arg(root().join("examples/turtlebot/live/catch.py")).arg("ros2").args(cases);
    command.env("LAPWING", env!("CARGO_BIN_EXE_lapwing")).env("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp");
    let done = command.env("ROS_DOMAIN_ID", domain.to_string()).output().unwrap();
    let (said, complained) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
    assert!(done.status.success() && cases.iter().all(|case| said.contains(case)), "{said}{complained}");
}

#[test]
fn the_docking_of_a_healthy_and_of_a_faulty_robot() {
    caught(151, &["healthy", "docking-stuck"]);
}

#[test]
fn the_other_bugs_and_the_stop_sign() {
    caught(152, &["direction-inverted", "backwards", "sign-unseen"]);
}
