//! What specifications mean: text in, checked formulas out.

mod support;

use expect_test::{Expect, expect};
use support::shapes::{csv, ndjson, robot};
use support::{against, alone, dump};

/// The properties of a specification that is right.
fn means(text: &str, expected: Expect) {
    let spec = alone(text);
    assert!(!spec.checked.has_errors() && spec.parse.is_empty(), "{text}\n{}", spec.messages());
    expected.assert_eq(&dump::properties(&spec.checked.spec));
}

/// The properties of a specification on a trace, then its diagnostics.
fn on(text: &str, trace: &lapwing_check::TraceShape, expected: Expect) {
    let spec = against(text, trace);
    expected.assert_eq(&format!("{}{}", dump::properties(&spec.checked.spec), spec.messages()));
}

#[test]
fn names_and_lines() {
    means(
        "\n# first\nnever a > 1\nproperty p: always b > 0\nq = eventually c > 0",
        expect![[r#"
        line 3: always not (a > 1) | reads a
        p: always (b > 0) | reads b
        q: eventually (c > 0) | reads c
    "#]],
    );
    means(
        "never `line 2` > 1",
        expect![[r#"
        line 1: always not (line 2 > 1) | reads line 2
    "#]],
    );
}

#[test]
fn a_definition_is_a_property_when_it_is_about_time_and_nobody_uses_it() {
    means(
        "calm = always v < 1\nboth: calm and eventually stopped",
        expect![[r#"
        both: (always (v < 1) and eventually truth(stopped)) | reads v stopped
    "#]],
    );
    means(
        "fast = v > 2\nnever fast",
        expect![[r#"
        line 2: always not (v > 2) | reads v
    "#]],
    );
    means(
        "recently = once within 2 s v > 2\nalarm = recently and estop",
        expect![[r#"
        alarm: (once[0 s,2 s] (v > 2) and truth(estop)) | reads v estop
    "#]],
    );
}

#[test]
fn a_property_is_judged_even_when_another_uses_it() {
    means(
        "property calm: v < 1\nproperty both: always (calm and w < 1)",
        expect![[r#"
        calm: (v < 1) | reads v
        both: always ((v < 1) and (w < 1)) | reads v w
    "#]],
    );
}

#[test]
fn operators() {
    means(
        "never within_range > 1",
        expect![[r#"
        line 1: always not (within_range > 1) | reads within_range
    "#]],
    );
    means(
        "eventually within [1 s, 2.5 s) x > 1",
        expect![[r#"
        line 1: eventually[1 s,2.5 s) (x > 1) | reads x
    "#]],
    );
    means(
        "always for 200 ms x > 1",
        expect![[r#"
        line 1: always[0 s,200 ms] (x > 1) | reads x
    "#]],
    );
    means(
        "x > 1 until within 2 s y > 1",
        expect![[r#"
        line 1: ((x > 1) until[0 s,2 s] (y > 1)) | reads x y
    "#]],
    );
    means(
        "(x > 1) since within (0 s, 2 s] y > 1",
        expect![[r#"
        line 1: ((x > 1) since(0 s,2 s] (y > 1)) | reads x y
    "#]],
    );
    means(
        "previously x > 1 and becomes y > 1",
        expect![[r#"
        line 1: prev ((x > 1) and becomes (y > 1)) | reads x y
    "#]],
    );
    means(
        "historically held for 1 s x > 1",
        expect![[r#"
        line 1: hist held 1 s (x > 1) | reads x
    "#]],
    );
    means(
        "after x > 1, until y > 1, before z > 1, while w > 1, always v > 1",
        expect![[r#"
        line 1: after (x > 1), until (y > 1), before (z > 1), while (w > 1), always (v > 1) | reads x y z w v
    "#]],
    );
    means(
        "after_until x > 1, y > 1, next z > 1",
        expect![[r#"
        line 1: after_until (x > 1), (y > 1), next (z > 1) | reads x y z
    "#]],
    );
    means(
        "whenever x > 1, eventually within 1 s y > 1",
        expect![[r#"
        line 1: whenever (x > 1), eventually[0 s,1 s] (y > 1) | reads x y
    "#]],
    );
    means(
        "ltl([](p => <*> q))",
        expect![[r#"
        line 1: always (truth(p) => once truth(q)) | reads p q
    "#]],
    );
}

#[test]
fn durations_have_names() {
    means(
        "limit = 500 ms\nwhenever x > 1, eventually within limit y > 1",
        expect![[r#"
        line 2: whenever (x > 1), eventually[0 s,500 ms] (y > 1) | reads x y
    "#]],
    );
    means(
        "base = 0.1 s\nlimit = 3 * base\nheld for limit x > 1",
        expect![[r#"
        line 3: held 300 ms (x > 1) | reads x
    "#]],
    );
}

#[test]
fn margins() {
    means(
        "x =={0.1} y and x <{2 * m} y",
        expect![[r#"
        line 1: ((x =={0.1} y) and (x <{(2 * m)} y)) | reads x y m
    "#]],
    );
    means(
        "__margin__ = 0.01\nx == y and x <{0.5} y and s == \"on\" and b == true",
        expect![[r#"
        line 2: ((((x =={0.01} y) and (x <{0.5} y)) and (s == "on")) and (b == true)) | reads x y s b
    "#]],
    );
    means(
        "__margin__ = 0\nx == 1",
        expect![[r#"
        line 2: (x == 1) | reads x
    "#]],
    );
}

#[test]
fn units_are_si() {
    means(
        "a > 30 deg and b > 100 ms and c > 2 km and d > 5 cm and e > 1.5 min",
        expect![[r#"
        line 1: (((((a > 0.5235987755982988) and (b > 0.1)) and (c > 2000)) and (d > 0.05)) and (e > 90)) | reads a b c d e
    "#]],
    );
}

#[test]
fn looking_back_adds_up() {
    means(
        "@{delta(x), -2} > rate(@{y, -1}) + x",
        expect![[r#"
        line 1: (@2delta(x) > (rate(@1y) + x)) | reads x@3 y@2
    "#]],
    );
}

#[test]
fn world_signals() {
    means(
        "robot.position.x > robot.velocity.body.x * 1 s",
        expect![[r#"
            line 1: (robot.position.x > (robot.velocity.body.x * 1)) | reads robot.position.x robot.velocity.body.x
        "#]],
    );
    means(
        "robot.orientation < 1 and robot.orientation.roll < 1 and robot.velocity.angular.z < 1",
        expect![[r#"
        line 1: (((Yaw(robot.orientation.x robot.orientation.y robot.orientation.z robot.orientation.w) < 1) and (Roll(robot.orientation.x robot.orientation.y robot.orientation.z robot.orientation.w) < 1)) and (robot.velocity.angular.z < 1)) | reads robot.orientation.x robot.orientation.y robot.orientation.z robot.orientation.w robot.velocity.angular.z
    "#]],
    );
    means(
        "robot.distanceZ.wall < 1 m and robot.orientation_between.wall < 10 deg",
        expect![[r#"
        line 1: ((Norm((robot.position.x - wall.position.x) (robot.position.y - wall.position.y) (robot.position.z - wall.position.z)) < 1) and (AngleBetween(robot.orientation.x robot.orientation.y robot.orientation.z robot.orientation.w wall.orientation.x wall.orientation.y wall.orientation.z wall.orientation.w) < 0.17453292519943295)) | reads robot.position.x robot.position.y robot.position.z wall.position.x wall.position.y wall.position.z robot.orientation.x robot.orientation.y robot.orientation.z robot.orientation.w wall.orientation.x wall.orientation.y wall.orientation.z wall.orientation.w
    "#]],
    );
    means(
        "model r: velocity /odom Odometry.twist.twist ;\nr.velocity_error < 1",
        expect![[r#"
            line 2: (Norm((r.velocity.body.x - r.believed.velocity.linear.x) (r.velocity.body.y - r.believed.velocity.linear.y) (r.velocity.body.z - r.believed.velocity.linear.z)) < 1) | reads r.velocity.body.x r.velocity.body.y r.velocity.body.z r.believed.velocity.linear.x r.believed.velocity.linear.y r.believed.velocity.linear.z
        "#]],
    );
    means(
        "model r: position /odom Odometry.pose.pose.position ;\nr.believed.position.x < 1 m",
        expect![[r#"
        line 2: (r.believed.position.x < 1) | reads r.believed.position.x
    "#]],
    );
}

#[test]
fn vectors_and_rotations_are_taken_apart() {
    means(
        "decl v /odom Odometry.twist.twist.linear\nnorm(v) < 1",
        expect![[r#"
        line 2: (Norm(v.x v.y v.z) < 1) | reads v.x v.y v.z
    "#]],
    );
    means(
        "decl q /odom Odometry.pose.pose.orientation\nyaw(q) < roll(0, 0, 0, 1)",
        expect![[r#"
        line 2: (Yaw(q.x q.y q.z q.w) < Roll(0 0 0 1)) | reads q.x q.y q.z q.w
    "#]],
    );
    means(
        "distance(a.position, b.position) < norm(a.velocity) * 2 s",
        expect![[r#"
        line 1: (Norm((a.position.x - b.position.x) (a.position.y - b.position.y) (a.position.z - b.position.z)) < (Norm(a.velocity.x a.velocity.y a.velocity.z) * 2)) | reads a.position.x a.position.y a.position.z b.position.x b.position.y b.position.z a.velocity.x a.velocity.y a.velocity.z
    "#]],
    );
    means(
        "decl p /p PointStamped\nany(p.list, v => norm(v.position) > 1 and any(v.inner, w => w > v.limit))",
        expect![[r#"
        line 2: any(p.list: ((Norm(%0.position.x %0.position.y %0.position.z) > 1) and any(%0.inner: (%0 > %1.limit)))) | reads p.list
    "#]],
    );
}

#[test]
fn events_and_slices() {
    means(
        "event kick\nevent save\nwhenever kick, eventually save",
        expect![[r#"
        line 3: whenever !kick, eventually !save | over kick save
    "#]],
    );
    means(
        "event kick\nfor each k of kick.robot: whenever kick, kick.power > 3",
        expect![[r#"
        line 2: whenever !kick, (!kick.power > 3) | over kick | slice kick.robot [kick:1]
    "#]],
    );
    means(
        "event kick\nevent save\nproperty p over (save): always not kick",
        expect![[r#"
        p: always not !kick | over kick save
    "#]],
    );
    means(
        "event kick\nwhenever kick and x > 1, eventually y > 1",
        expect![[r#"
        line 2: whenever (!kick and (x > 1)), eventually (y > 1) | reads x y
    "#]],
    );
}

#[test]
fn for_each_over_lists() {
    means(
        "for each r in (a, b): never r.velocity.x > 1",
        expect![[r#"
        line 1[a]: always not (a.velocity.x > 1) | reads a.velocity.x
        line 1[b]: always not (b.velocity.x > 1) | reads b.velocity.x
    "#]],
    );
    means(
        "p: for each r in (a, b): for each s in (c, d): always r.x.s > 1",
        expect![[r#"
        p[a][c]: always (a.x.c > 1) | reads a.x.c
        p[a][d]: always (a.x.d > 1) | reads a.x.d
        p[b][c]: always (b.x.c > 1) | reads b.x.c
        p[b][d]: always (b.x.d > 1) | reads b.x.d
    "#]],
    );
    means(
        "near = r.x > 1\nfor each r in (a, b): never r.limit < 1 and any(list, r => r.x > 1)",
        expect![[r#"
        line 2[a]: always not ((a.limit < 1) and any(list: (%0.x > 1))) | reads a.limit list
        line 2[b]: always not ((b.limit < 1) and any(list: (%0.x > 1))) | reads list b.limit
    "#]],
    );
}

#[test]
fn for_each_over_topics() {
    let text = "decl v /odom Odometry\nfor each r in topics /{r}/odom: never r.velocity.x > 1 m/s\n_x = v.header";
    on(
        text,
        &robot(),
        expect![[r#"
        line 2[robot1]: always not (robot1.velocity.x > 1) | reads robot1.velocity.x
        line 2[robot2]: always not (robot2.velocity.x > 1) | reads robot2.velocity.x
    "#]],
    );
    on(
        "for each r in topics /{r}/imu: never r.velocity.x > 1",
        &robot(),
        expect![[r#"
        line 1: nothing | problem no topic of this recording matches /{r}/imu
    "#]],
    );
}

#[test]
fn patterns_are_hygienic() {
    let pattern = "pattern soon(a, limit): whenever a > x, eventually within limit a < x\n";
    means(
        &format!("{pattern}soon(y, 2 s)"),
        expect![[r#"
        line 2: whenever (y > x), eventually[0 s,2 s] (y < x) | reads y x
    "#]],
    );
    means(
        &format!("{pattern}p: soon(a + x, 2 s)"),
        expect![[r#"
        p: whenever ((a + x) > x), eventually[0 s,2 s] ((a + x) < x) | reads a x
    "#]],
    );
    means(
        "pattern inner(a): a > b\npattern outer(b): whenever inner(b), eventually inner(c)\nouter(z)",
        expect![[r#"
        line 3: whenever (z > b), eventually (c > b) | reads z b c
    "#]],
    );
    means(
        "pattern stays_fresh(topic, max): age(topic) < max\nstays_fresh(/scan, 500 ms)",
        expect![[r#"
        line 2: (age(/scan) < 0.5) | reads /scan
    "#]],
    );
    means(
        "pattern has(list, limit): any(list, v => v > limit)\nhas(a, v)",
        expect![[r#"
        line 2: any(a: (%0 > v)) | reads a v
    "#]],
    );
}

#[test]
fn machines_and_their_states() {
    let machine = "machine m {\n initial a\n state a when x > 1\n state b when x < 0\n a -> b\n b -> a\n}\n";
    means(
        &format!("{machine}whenever m == b, eventually m != b"),
        expect![[r#"
        m: machine 0 | reads x
        line 8: whenever m==b, eventually not m==b | reads x | machines m
    "#]],
    );
    means(
        &format!("{machine}never m == undefined and y > 1"),
        expect![[r#"
        m: machine 0 | reads x
        line 8: always not (m==undefined and (y > 1)) | reads x y | machines m
    "#]],
    );
    means(
        &format!("{machine}@{{m == a, -2}} or z > 1"),
        expect![[r#"
        m: machine 0 | reads x
        line 8: (@2m==a or (z > 1)) | reads x@2 z | machines m
    "#]],
    );
    means(
        &format!("whenever entered(m.b), eventually left(m.b)\n{machine}"),
        expect![[r#"
        line 1: whenever !entered(m.b), eventually !left(m.b) | over entered(m.b) left(m.b)
        m: machine 0 | reads x
    "#]],
    );
    let second = "machine n {\n initial u\n state u when entered(m.a)\n state v when m == b\n u -> v\n}\n";
    means(
        &format!("{second}{machine}"),
        expect![[r#"
        n: machine 1 | reads x | machines m
        m: machine 0 | reads x
    "#]],
    );
}

#[test]
fn a_machine_over_events_alone() {
    means(
        "event go\nevent halt\nmachine m {\n initial a\n state a on halt\n state b on go\n a -> b\n b -> a\n}",
        expect![[r#"
        m: machine 0 | over go halt
    "#]],
    );
}

#[test]
fn types_come_from_the_trace() {
    on(
        "decl stamp /odom Odometry.header.stamp\nage(stamp) < 1 s and stamp > 5 s",
        &robot(),
        expect![[r#"
        line 2: ((age(/odom) < 1) and ((stamp.sec + (stamp.nanosec * 0.000000001)) > 5)) | reads stamp.sec stamp.nanosec /odom
    "#]],
    );
    on(
        "decl b /battery BatteryState\nb.power_supply_status == BatteryState.NOT_CHARGING",
        &robot(),
        expect![[r#"
        line 2: (b.power_supply_status == 3) | reads b.power_supply_status
    "#]],
    );
    on(
        "LaserDriver.Laser.count > 3",
        &robot(),
        expect![[r#"
        line 1: (LaserDriver.Laser.count > 3) | reads LaserDriver.Laser.count
    "#]],
    );
    on(
        "decl c /joint_states JointState\nlookup(c.name, c.position, \"elbow\") > len(c.name)",
        &robot(),
        expect![[r#"
        line 2: (Lookup(c.name c.position "elbow") > Len(c.name)) | reads c.name c.position
    "#]],
    );
    on(
        "event kicked = message /kick Bool when data\nwhenever kicked, kicked.data",
        &robot(),
        expect![[r#"
        line 2: whenever !kicked, !kicked.data | over kicked
    "#]],
    );
}

#[test]
fn csv_columns() {
    on(
        "x > 1 and flag",
        &csv(&["x", "flag"]),
        expect![[r#"
        line 1: ((x > 1) and truth(flag)) | reads x flag
    "#]],
    );
    on(
        "decl v /odom Odometry.twist.twist.linear.x\nv > 1",
        &csv(&["/odom.twist.twist.linear.x"]),
        expect![[r#"
        line 2: (v > 1) | reads v
    "#]],
    );
    on(
        "decl v /odom Odometry.twist.twist.linear\nnorm(v) > 1",
        &csv(&["v.x", "v.y"]),
        expect![[r#"
        line 2: (Norm(v.x v.y 0) > 1) | reads v.x v.y
        assumed-flat: there is no column `v.z`: it counts as 0
    "#]],
    );
    on(
        "never robot.velocity > 2",
        &csv(&["robot.velocity"]),
        expect![[r#"
        line 1: always not (robot.velocity > 2) | reads robot.velocity
    "#]],
    );
    on(
        "never robot.velocity > 2",
        &csv(&["robot.velocity.x", "robot.velocity.y"]),
        expect![[r#"
        line 1: always not (Norm(robot.velocity.x robot.velocity.y 0) > 2) | reads robot.velocity.x robot.velocity.y
        assumed-flat: there is no column `robot.velocity.z`: it counts as 0
    "#]],
    );
    on(
        "never robot.distance.wall < 1",
        &csv(&["robot.distance.wall", "robot.position.x"]),
        expect![[r#"
        line 1: always not (robot.distance.wall < 1) | reads robot.distance.wall
    "#]],
    );
    let positions = ["robot.position.x", "robot.position.y", "wall.position.x", "wall.position.y"];
    on(
        "never robot.distanceZ.wall < 1",
        &csv(&positions),
        expect![[r#"
        line 1: always not (Norm((robot.position.x - wall.position.x) (robot.position.y - wall.position.y) (0 - 0)) < 1) | reads robot.position.x robot.position.y wall.position.x wall.position.y
        assumed-flat: there is no column `robot.position.z`: it counts as 0
        assumed-flat: there is no column `wall.position.z`: it counts as 0
    "#]],
    );
    on(
        "never robot.orientation_between.wall > 1",
        &csv(&["robot.orientation", "wall.orientation"]),
        expect![[r#"
        line 1: always not (AngleBetween(0 0 Sin((robot.orientation * 0.5)) Cos((robot.orientation * 0.5)) 0 0 Sin((wall.orientation * 0.5)) Cos((wall.orientation * 0.5))) > 1) | reads robot.orientation wall.orientation
    "#]],
    );
}

#[test]
fn ndjson_columns_and_topics() {
    on(
        "decl v /odom Odometry.twist.twist.linear.x\nv > 1",
        &ndjson(&["v"], &[("/odom", "nav_msgs/Odometry")], false),
        expect![[r#"
        line 2: (v > 1) | reads v
    "#]],
    );
    on(
        "decl v /odom Odometry.twist.twist.linear.x\nv > 1",
        &ndjson(&[], &[("/odom", "nav_msgs/Odometry")], false),
        expect![[r#"
        line 2: (v > 1) | reads v
    "#]],
    );
    on(
        "later > 1",
        &ndjson(&["v"], &[], true),
        expect![[r#"
        line 1: (later > 1) | reads later
    "#]],
    );
    on(
        "later > 1",
        &ndjson(&["v"], &[], false),
        expect![[r#"
        line 1: nothing | problem unknown name `later`
        unknown-name: unknown name `later`
    "#]],
    );
    on(
        "never robot.velocity.x > 1",
        &ndjson(&[], &[("/gazebo/model_states", "gazebo_msgs/ModelStates")], false),
        expect![[r#"
        line 1: always not (robot.velocity.x > 1) | reads robot.velocity.x
    "#]],
    );
}

#[test]
fn signals_that_are_missing_on_one_trace() {
    on(
        "decl o /odmo Odometry.pose.pose.position.x\no > 1\nage(/scan) < 1 s",
        &robot(),
        expect![[r#"
        line 2: (o > 1) | reads o | problem no message on /odmo in this recording; did you mean /odom?
        line 3: (age(/scan) < 1) | reads /scan
        missing-topic: no message on /odmo in this recording; did you mean /odom?
    "#]],
    );
    on(
        "decl o /odom Twist.linear.x\no > 1\nage(/scan) < 1 s",
        &robot(),
        expect![[r#"
        line 2: (o > 1) | reads o | problem /odom is a nav_msgs/Odometry in this recording, not a Twist
        line 3: (age(/scan) < 1) | reads /scan
        topic-type: /odom is a nav_msgs/Odometry in this recording, not a Twist
    "#]],
    );
    on(
        "decl o /odom Odometry.pose.pose.positoin.x\no > 1\nage(/scan) < 1 s",
        &robot(),
        expect![[r#"
        line 2: nothing | problem geometry_msgs/Pose has no field `positoin`; did you mean `position`?
        line 3: (age(/scan) < 1) | reads /scan
        unknown-field: geometry_msgs/Pose has no field `positoin`; did you mean `position`?
    "#]],
    );
}

#[test]
fn what_only_a_running_system_has() {
    on(
        "event go = call Robot::go\nwhenever go, eventually go\npublishers(/cmd_vel) == 1",
        &robot(),
        expect![[r#"
        line 2: whenever !go, eventually !go | over go | problem a recording has no such events: `go` is `call Robot::go`
        line 3: (publishers(/cmd_vel) == 1) | reads publishers(/cmd_vel) | problem `publishers(/cmd_vel)` is known only of a running system, not from a recording
    "#]],
    );
}
