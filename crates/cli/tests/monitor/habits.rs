//! The habits of examples/live, as whoever copies them has them: pytest, whose test fails where the robot violates its specification while it runs, with
//! Lapwing's explanation.

use std::path::Path;
use std::process::Command;

use crate::graph::Graph;

/// Runs the example's test of a robot that drives at a speed. Its exit code, and what it said.
fn driven(speed: &str) -> (Option<i32>, String) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let python = root.join(".venv-jazzy/bin/python");
    assert!(python.exists(), "there is no {}: `tools/ros2.sh jazzy` makes it", python.display());
    let mut command = Graph::ros2().around(Command::new(python));
    // Nothing is left in the example's folder.
    command.args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "test_drive.py"]).env("PYTHONDONTWRITEBYTECODE", "1");
    command.env("LAPWING", env!("CARGO_BIN_EXE_lapwing")).env("SPEED", speed);
    let done = command.current_dir(root.join("examples/live")).output().unwrap();
    let said = [done.stdout, done.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    (done.status.code(), said)
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
