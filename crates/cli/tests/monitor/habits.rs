//! The habits of examples/live, as whoever copies them has them: tests of pytest and launch_testing, which fail where the robot violates its specification
//! while it runs, with Lapwing's explanation; launch files of ROS 2 and ROS 1.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::graph::{Graph, Process};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Python with rclpy, on a graph, in the folder of the examples.
fn python(graph: &Graph) -> Command {
    let python = root().join(".venv-jazzy/bin/python");
    assert!(python.exists(), "there is no {}: `tools/ros2.sh jazzy` makes it", python.display());
    let mut command = graph.around(Command::new(python));
    // Nothing is left in the folder.
    command.env("PYTHONDONTWRITEBYTECODE", "1").env("LAPWING", env!("CARGO_BIN_EXE_lapwing"));
    command.current_dir(root().join("examples/live"));
    command
}

fn launching(graph: &Graph) -> Command {
    let mut command = python(graph);
    command.arg(root().join("crates/cli/tests/monitor/launching.py"));
    command
}

/// Where `lapwing` is found by its name.
fn path() -> String {
    let folder = Path::new(env!("CARGO_BIN_EXE_lapwing")).parent().unwrap();
    format!("{}:{}", folder.display(), std::env::var("PATH").unwrap_or_default())
}

fn said(done: Output) -> (Option<i32>, String) {
    let said = [done.stdout, done.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    (done.status.code(), said)
}

/// Runs the example's test of a robot that drives at a speed. Its exit code, and what it said.
fn driven(speed: &str) -> (Option<i32>, String) {
    let mut command = python(&Graph::ros2());
    command.args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "test_drive.py"]).env("SPEED", speed);
    said(command.output().unwrap())
}

/// The same with launch_testing.
fn launched(speed: &str) -> (Option<i32>, String) {
    let mut command = launching(&Graph::ros2());
    let robot = root().join("crates/cli/tests/monitor/drive.py");
    let robot = format!("{} {} {speed}", command.get_program().to_string_lossy(), robot.display());
    said(command.args(["test", "test_drive_launch.py"]).env("ROBOT", robot).output().unwrap())
}

#[test]
fn pytest_passes_a_robot_that_keeps_to_its_specification() {
    let (code, said) = driven("0.5");
    assert!(code == Some(0) && said.contains("1 passed"), "{said}");
}

#[test]
fn pytest_fails_with_the_explanation_of_what_was_violated() {
    let (code, said) = driven("1.5");
    assert!(code == Some(1) && said.contains("calm is violated: calm: never speed > 1.0"), "{said}");
    assert!(said.contains("speed = 1.5"), "{said}");
}

#[test]
fn launch_testing_passes_a_robot_that_keeps_to_its_specification() {
    let (code, said) = launched("0.5");
    assert!(code == Some(0) && said.contains("test_nothing_was_violated"), "{said}");
}

#[test]
fn launch_testing_fails_with_the_report_on_what_was_violated() {
    let (code, said) = launched("1.5");
    let failure = said.split_once("AssertionError").map(|(_, failure)| failure).unwrap_or_default();
    assert!(code == Some(1) && failure.contains("calm: never speed > 1.0"), "{said}");
    assert!(failure.contains("speed: 1.5"), "{said}");
}

#[test]
fn a_launch_file_of_ros2_watches_and_reports_when_it_is_interrupted() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("run.mcap");
    let mut command = launching(&Graph::ros2());
    command.args(["launch", "watch.launch.py", "spec:=robot.rv"]).arg(format!("record:={}", record.display()));
    command.env("PATH", path());
    let mut launch = Process::start(command, "tools/ros2.sh jazzy");
    launch.line_with("reading /odom, /cmd_vel");
    launch.close();
    launch.line_with("inconclusive  calm");
    assert!(launch.child.wait().unwrap().success() && record.exists());
}

#[test]
fn a_launch_file_of_ros1_watches_and_reports_when_it_is_interrupted() {
    let graph = Graph::ros1();
    let package = tempfile::tempdir().unwrap();
    let example = |file: &str| root().join("examples/live").join(file);
    let manifest = "<package format=\"2\"><name>my_robot</name><version>0.0.1</version><description>A robot.</description>\
                    <maintainer email=\"robot@example.org\">Robot</maintainer><license>MIT</license></package>";
    fs::write(package.path().join("package.xml"), manifest).unwrap();
    for (file, folder) in [("lapwing.sh", "scripts"), ("watch.launch", "launch"), ("robot.rv", "spec")] {
        fs::create_dir_all(package.path().join(folder)).unwrap();
        fs::copy(example(file), package.path().join(folder).join(file)).unwrap();
    }
    let record = package.path().join("run.mcap");
    let mut command = graph.around(Command::new("roslaunch"));
    command.args(["--skip-log-check", "my_robot", "watch.launch"]).arg(format!("record:={}", record.display()));
    command.env("PATH", path()).env("ROS_PACKAGE_PATH", package.path()).env("ROS_HOME", package.path().join("home"));
    let mut launch = Process::start(command, "tools/peers.sh");
    launch.line_with("reading /odom, /cmd_vel");
    launch.signal("INT");
    launch.line_with("inconclusive  calm");
    assert!(launch.child.wait().unwrap().success() && record.exists());
}
