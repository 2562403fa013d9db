//! The simulator as a node of ROS 2, with a fault daemon written with rclpy between its program and its base, and Lapwing watching.
//!
//! Needs what `tools/ros2.sh` installs; without it the test fails and says so.
#![cfg(feature = "ros2")]

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use serde_json::Value;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn lapwing(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lapwing"));
    command.args(arguments);
    command
}

/// A node of ROS 2. Dropped, it is killed.
struct Daemon(Child);

impl Daemon {
    fn start(domain: u16, fault: &str) -> Daemon {
        let distribution = std::env::var("LAPWING_ROS2").unwrap_or_else(|_| "jazzy".to_owned());
        let python = root().join(format!(".venv-{distribution}/bin/python"));
        assert!(python.exists(), "there is no {}: `tools/ros2.sh {distribution}` makes it", python.display());
        let mut child = Command::new(python)
            .arg(root().join("examples/turtlebot/live/fault_daemon_ros2.py"))
            .arg(fault)
            .env("ROS_DOMAIN_ID", domain.to_string())
            .env("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
            .env("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut ready = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut ready).unwrap();
        assert_eq!(ready, "ready\n");
        Daemon(child)
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The verdict of the corrected property in a report.
fn corrected(report: &[u8]) -> String {
    let report: Value = serde_json::from_slice(report).unwrap();
    let properties = report[0]["properties"].as_array().unwrap();
    let corrected = properties.iter().find(|p| p["name"] == "corrected").unwrap();
    corrected["verdict"].as_str().unwrap().to_owned()
}

/// Runs the docking with a fault of the daemon, and watches it live; gives the live verdict of the corrected property, and that on what the monitor recorded.
fn docked_with(domain: u16, fault: &str) -> (String, String) {
    let _daemon = Daemon::start(domain, fault);
    let spec = root().join("examples/turtlebot/docking.rv");
    let (spec, domain) = (spec.to_str().unwrap(), domain.to_string());
    let recording = tempfile::NamedTempFile::with_suffix(".mcap").unwrap();
    let path = recording.path().to_str().unwrap();
    let watch = ["monitor", spec, "--ros2", "--domain", &domain, "--record", path, "--format", "json"];
    let watching = lapwing(&watch).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let run = ["sim", "docking", "--ros2", "--domain", &domain, "--outside", "--duration", "12s", "--quiet"];
    assert!(lapwing(&run).status().unwrap().success());
    assert!(Command::new("kill").args(["-INT", &watching.id().to_string()]).status().unwrap().success());
    let watched = watching.wait_with_output().unwrap();
    let checked = lapwing(&["check", spec, path, "--format", "json"]).output().unwrap();
    assert!(!watched.stdout.is_empty(), "{}", String::from_utf8_lossy(&watched.stderr));
    (corrected(&watched.stdout), corrected(&checked.stdout))
}

#[test]
fn a_fault_between_program_and_base_is_caught_live_as_in_the_recording() {
    let (live, recorded) = docked_with(151, "docking-stuck");
    assert_eq!((live.as_str(), recorded.as_str()), ("violated", "violated"));
}

#[test]
fn a_healthy_base_is_found_healthy() {
    let (live, recorded) = docked_with(152, "none");
    assert_eq!(live, recorded);
    assert_ne!(live, "violated");
}
