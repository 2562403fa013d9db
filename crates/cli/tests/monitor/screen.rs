//! The screen of a run, on a terminal of its own (`screen.py`).

use std::process::Command;
use std::time::Duration;

use crate::graph::{Graph, LIMIT, Process};

const SPEC: &str = "\
decl speed /speed Float64.data
decl lost /gone Float64.data
calm: never speed > 2
found: never lost > 0
";

#[test]
fn a_screen_shows_how_things_stand_and_q_ends_it_with_the_report() {
    let graph = Graph::ros1();
    let mut robot = graph.robot();
    robot.does("offer /speed");
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("robot.rv"), SPEC).unwrap();
    let mut command = Command::new("python3");
    command.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/monitor/screen.py")).args(["100", "30"]);
    command.arg(env!("CARGO_BIN_EXE_lapwing")).args(["monitor", "robot.rv"]).args(graph.words().split_whitespace());
    command.current_dir(folder.path());
    let mut screen = Process::start(graph.around(command), "python3");
    screen.line_with("what happened");
    let begin = std::time::Instant::now();
    while screen.line_within("speed = 3", Duration::from_millis(200)).is_none() {
        robot.does("say /speed 3");
        assert!(begin.elapsed() < LIMIT, "the violation is not shown");
    }
    screen.line_with("nobody publishes it");
    screen.write("q");
    screen.line_with("first at");
    assert_eq!(screen.child.wait().unwrap().code(), Some(1));
}
