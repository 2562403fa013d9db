//! The examples of the language reference and of the first seed check clean: alone, on a robot's recording and on columns.

mod support;

use support::examples::ALL;
use support::shapes::{csv, robot};
use support::{against, alone};

#[test]
fn alone_they_are_right() {
    let spec = alone(&ALL.concat());
    assert_eq!(spec.messages(), "");
    assert!(spec.checked.spec.properties.iter().all(|p| p.problem.is_none()));
}

#[test]
fn on_a_recording_only_what_it_lacks_is_said() {
    let mut trace = robot();
    trace.live = true;
    let machine = ["sonar", "ir_mod", "ir_unmod", "ball_in_front", "ball_close", "has_ball"];
    let declared: String = machine.iter().map(|name| format!("decl {name} /kick Bool.data default false\n")).collect();
    let text = ALL
        .concat()
        .replace("sonar <= 0.07", "sonar")
        .replace("ir_mod == 0", "ir_mod")
        .replace("ir_unmod == 0", "ir_unmod");
    let spec = against(&(declared + &text), &trace);
    assert_eq!(spec.messages(), "");
    let lacks = "heard: nobody tells of calls of /set_mode: its node does where service introspection is on\n";
    assert_eq!(spec.problems(), lacks);
}

#[test]
fn the_seeds_properties_run_on_columns_alone() {
    let columns = [
        "turtlebot3.velocity",
        "turtlebot3.velocity.x",
        "turtlebot3.velocity.angular.z",
        "vel_robot_perception",
        "/cmd_vel_original.angular.z",
    ];
    let spec = against(ALL[ALL.len() - 1], &csv(&columns));
    assert_eq!(spec.messages(), "");
    assert_eq!(spec.problems(), "");
}

#[test]
fn the_same_text_gives_the_same_result() {
    let (first, second) = (alone(&ALL.concat()), alone(&ALL.concat()));
    assert_eq!(format!("{:?}", first.checked.spec), format!("{:?}", second.checked.spec));
    assert_eq!(first.checked.diagnostics, second.checked.diagnostics);
}
