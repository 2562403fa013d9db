//! Guards on real graphs, and what the robot gets when Lapwing dies.

use std::time::{Duration, Instant};

use crate::graph::{Graph, LIMIT, Robot};
use crate::lapwing::Lapwing;

const SPEC: &str = "\
decl wanted /cmd_raw Float64.data
safe: never wanted > 2
guard /cmd from /cmd_raw by safe else publish std_msgs/Float64 { data: 0.0 }
";

/// Says a number until something is heard: publishers and subscribers take their time to find each other.
fn says_until(robot: &mut Robot, number: f64, heard: &str) {
    let begin = Instant::now();
    loop {
        robot.does(&format!("say /cmd_raw {number}"));
        if robot.0.line_within(heard, Duration::from_millis(300)).is_some() {
            return;
        }
        assert!(begin.elapsed() < LIMIT, "never {heard}");
    }
}

fn guards_and_dies(graph: &Graph) {
    let mut robot = graph.robot();
    robot.does("offer /cmd_raw");
    robot.does("hear /cmd");
    let lapwing = Lapwing::watches(graph, SPEC, "--format ndjson --quiet --clock wall");
    says_until(&mut robot, 1.0, "heard /cmd 1.0");
    says_until(&mut robot, 3.0, "heard /cmd 0.0");
    says_until(&mut robot, 1.5, "heard /cmd 1.5");

    // Killed outright, it cannot say anything more: no command passes, and none is made up. A base stops by its own watchdog.
    lapwing.signal("KILL");
    std::thread::sleep(Duration::from_millis(500));
    while robot.0.line_within("heard", Duration::from_millis(200)).is_some() {}
    for _ in 0..5 {
        robot.does("say /cmd_raw 1.0");
    }
    assert_eq!(robot.0.line_within("heard", Duration::from_secs(1)), None);
}

#[test]
fn nothing_passes_when_lapwing_was_killed_on_ros1() {
    guards_and_dies(&Graph::ros1());
}

#[test]
fn nothing_passes_when_lapwing_was_killed_on_ros2() {
    guards_and_dies(&Graph::ros2());
}
