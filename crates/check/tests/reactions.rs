//! Reactions: whom they wait for, and the messages that they write, field by field.

mod support;

use expect_test::{Expect, expect};
use support::shapes::{csv, robot};
use support::{against, alone, clean, faults, said};

const SCAN: &str = "property lost: always age(/scan) < 1 s\n";

fn publishes(message: &str, expected: Expect) {
    faults(&format!("{SCAN}on violation of lost {{ publish /cmd_vel geometry_msgs/Twist {message} }}"), expected);
}

#[test]
fn messages_fit_their_definition() {
    let whole = "{ linear: { x: -0.5, y: 0, z: 1e-3 m/s }, angular: { z: 10 deg/s } }";
    clean(&format!("{SCAN}on violation of lost {{ publish /cmd_vel geometry_msgs/Twist {whole} }}"));
    clean(&format!(
        "{SCAN}slow = 2 * 0.1\non violation of lost {{ publish /cmd_vel Twist {{ linear: {{ x: slow }} }} }}"
    ));
    clean(&format!("{SCAN}on violation of lost {{ call /light std_srvs/SetBool {{ data: true }} }}"));
    clean(&format!("{SCAN}on violation of lost {{ publish /anything my_msgs/Stop {{ now: true }} }}"));
    let state = "sensor_msgs/BatteryState { power_supply_status: BatteryState.FULL, present: true }";
    clean(&format!("{SCAN}on violation of lost {{ publish /battery {state} }}"));
}

#[test]
fn unknown_fields() {
    expect![[r#"
        geometry_msgs/Twist has no field `linaer`; did you mean `linear`?
          not a field of this type
          its fields are `linear`, `angular`
    "#]]
    .assert_eq(&said(&alone(&format!(
        "{SCAN}on violation of lost {{ publish /cmd_vel geometry_msgs/Twist {{ linaer: {{ x: 0 }} }} }}"
    ))));
    publishes(
        "{ linear: { x: 0, w: 1 } }",
        expect![[r#"
        unknown-field: w
    "#]],
    );
    faults(
        &format!("{SCAN}on violation of lost {{ call /stop std_srvs/Trigger {{ now: true }} }}"),
        expect![[r#"
            unknown-field: now
        "#]],
    );
    publishes(
        "{ linear: { x: 0, x: 1 } }",
        expect![[r#"
        duplicate-name: x
    "#]],
    );
}

#[test]
fn wrong_values() {
    publishes(
        "{ linear: 1 }",
        expect![[r#"
        type-mismatch: 1
    "#]],
    );
    publishes(
        "{ linear: { x: \"fast\" } }",
        expect![[r#"
        type-mismatch: "fast"
    "#]],
    );
    publishes(
        "{ linear: { x: { y: 1 } } }",
        expect![[r#"
        type-mismatch: { y: 1 }
    "#]],
    );
    publishes(
        "{ linear: [0, 0, 0] }",
        expect![[r#"
        type-mismatch: [0, 0, 0]
    "#]],
    );
    publishes(
        "{ linear: { x: 0.5 m } }",
        expect![[r#"
        dimension-mismatch: 0.5 m
    "#]],
    );
    publishes(
        "{ linear: { x: speed } }",
        expect![[r#"
        not-constant: speed
    "#]],
    );
    faults(
        &format!("{SCAN}on violation of lost {{ publish /b sensor_msgs/BatteryState {{ power_supply_status: 1.5 }} }}"),
        expect![[r#"
            type-mismatch: 1.5
        "#]],
    );
}

#[test]
fn unknown_types() {
    expect![[r#"
        no definition of geometry_msgs/Twst is known; did you mean `geometry_msgs/Twist`?
          its fields are not checked
          known are the common packages of ROS, those of --msgs DIR, and the types of the topics in the recording
    "#]]
    .assert_eq(&said(&alone(&format!("{SCAN}on violation of lost {{ publish /c geometry_msgs/Twst {{}} }}"))));
    expect![[r#"
        several packages have a message `Bool`
          its fields are not checked
          write one of `other_msgs/Bool`, `std_msgs/Bool`
    "#]]
    .assert_eq(&said(&alone(&format!("{SCAN}on violation of lost {{ publish /c Bool {{ data: 3 }} }}"))));
    // A package of one's own may come with a recording, and this one does not have it.
    let own = format!("{SCAN}on violation of lost {{ publish /c my_msgs/Stop {{}} }}");
    expect![[r#"
        unknown-type: no definition of my_msgs/Stop is known
    "#]]
    .assert_eq(&against(&own, &robot()).messages());
    assert!(against(&own, &csv(&["x"])).messages().contains("unknown-type: no definition of my_msgs/Stop"));
}

#[test]
fn the_recording_comes_first() {
    let odometry = "publish /odom nav_msgs/Odometry { child_frame: \"base\" }";
    expect![[r#"
        unknown-field: nav_msgs/Odometry has no field `child_frame`; did you mean `child_frame_id`?
    "#]]
    .assert_eq(&against(&format!("{SCAN}on violation of lost {{ {odometry} }}"), &robot()).messages());
    expect![[r#"
        topic-type: /odom is a nav_msgs/Odometry in this recording, not a Twist
    "#]]
    .assert_eq(&against(&format!("{SCAN}on violation of lost {{ publish /odom Twist {{}} }}"), &robot()).messages());
}

#[test]
fn guards() {
    let stop = "publish geometry_msgs/Twist { linear: { x: 0 } } fail open";
    clean(&format!("property p: always v < 2\nguard /cmd_vel from /cmd_vel_raw by p else {stop}"));
    faults(
        "property p: always v < 2\nguard /cmd_vel from /raw by p else publish geometry_msgs/Twist { lin: {} }",
        expect![[r#"
            unknown-field: lin
        "#]],
    );
    faults(
        "property p: always v < 2\nguard /cmd_vel from cmd_vel by p else drop",
        expect![[r#"
            misplaced: cmd_vel
        "#]],
    );
}

#[test]
fn whom_they_wait_for() {
    faults(
        &format!("{SCAN}on violation of lots {{ stop }}"),
        expect![[r#"
            unknown-name: lots
        "#]],
    );
    let used = [("mine.rv", "property theirs: always x < 1")];
    let spec = support::check_with("use \"mine.rv\"\nalways theirs\non violation of theirs { stop }", None, &used);
    expect![[r#"
        not-judged: theirs
    "#]]
    .assert_eq(&spec.codes());
}

#[test]
fn a_message_is_written_whole() {
    faults(
        &format!("{SCAN}on violation of lost {{ publish /cmd_vel geometry_msgs/Twist.linear {{ x: 0 }} }}"),
        expect![[r#"
            syntax: linear
        "#]],
    );
}
