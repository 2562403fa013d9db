//! What is wrong, and where: each code with a specification that has the fault and one that has not.

mod support;

use expect_test::{Expect, expect};
use support::shapes::{csv, robot};
use support::{against, alone, check_with, clean, faults, said};

fn faults_on(text: &str, expected: Expect) {
    expected.assert_eq(&against(text, &robot()).codes());
}

#[test]
fn unknown_names() {
    faults_on(
        "decl speed /odom Odometry.twist.twist.linear.x\nspede > 2 and speed > 1",
        expect![[r#"
        unknown-name: spede
    "#]],
    );
    faults_on(
        "robot.velocty > 2",
        expect![[r#"
        unknown-name: robot.velocty
    "#]],
    );
    faults_on("robot.position.x > 2", expect![[""]]);
    faults("spede > 2", expect![[""]]);
    expect![[r#"
        unknown name `odom.pose.pose.position.x`
          nothing declares it
          the topic /odom needs a declaration: `decl odom /odom nav_msgs/Odometry`
    "#]]
    .assert_eq(&said(&against("odom.pose.pose.position.x > 1", &robot())));
    expect![[r#"
        unknown name `sped`; did you mean `speed`?
          nothing declares it and no column has this name
          the recording has `speed`, `x`
    "#]]
    .assert_eq(&said(&against("sped > 1", &csv(&["speed", "x"]))));
    let signals = csv(&["speed", "s", "x"]);
    let unit = |written: &str| said(&against(&format!("never speed > {written}"), &signals));
    for (written, meant) in [
        ("1.5m/s2", "m/s^2"),
        ("1.5 m/s2", "m/s^2"),
        ("1 m/s²", "m/s^2"),
        ("1 m/sec", "m/s"),
        ("1 m/sec2", "m/s^2"),
        ("1 rad/sec", "rad/s"),
    ] {
        let message = unit(written);
        assert!(message.contains(&format!("is written `{meant}`\n  write `{meant}`\n")), "{written}: {message}");
    }
    expect![[r#"
        unknown name `h`
          nothing declares it and no column has this name
          if `km/h` is meant as a unit: the units are `ns`, `us`, `ms`, `s`, `min`, `h`, `mm`, `cm`, `m`, `km`, `m/s`, `m/s^2`, `rad`, `rad/s`, `deg`, `deg/s` and `Hz`
          the recording has `speed`, `s`, `x`
    "#]]
    .assert_eq(&unit("1 km/h"));
    // What is a name stays one, and what no number precedes is no unit.
    assert_eq!(unit("1 m/x"), "");
    assert!(unit("x/s2").starts_with("unknown name `s2`; did you mean") && unit("1 m / s2").contains("did you mean"));
    expect![[r#"
        unknown name `r.localization_error`: nothing says what r believes of its position
          no `model` declares it
          say where it comes from: `model r: position /odom Odometry.pose.pose.position ;`
    "#]]
    .assert_eq(&said(&against("r.localization_error > 1", &robot())));
}

#[test]
fn unknown_functions() {
    faults(
        "nrom(x, y) > 1",
        expect![[r#"
        unknown-function: nrom
    "#]],
    );
    faults(
        "limit = 3\nlimit() > 1",
        expect![[r#"
        unknown-function: limit
    "#]],
    );
    expect![[r#"
        there is no function or pattern `nrom`; did you mean `norm`?
          unknown
    "#]]
    .assert_eq(&said(&alone("nrom(x, y) > 1")));
}

#[test]
fn unknown_fields() {
    expect![[r#"
        geometry_msgs/Pose has no field `positoin`; did you mean `position`?
          not a field of this type
          its fields are `position`, `orientation`
    "#]]
    .assert_eq(&said(&against("decl o /odom Odometry.pose.pose.positoin.x\no > 1", &robot())));
    faults_on(
        "decl o /odom Odometry\no.twist.twist.linear.w > 1",
        expect![[r#"
        unknown-field: w
    "#]],
    );
    faults_on(
        "decl o /scan LaserScan\no.ranges.x > 1 m",
        expect![[r#"
        unknown-field: x
    "#]],
    );
    faults_on("decl o /odom Odometry\no.twist.twist.linear.x > 1", expect![[""]]);
}

#[test]
fn unknown_states() {
    let machine = "machine m {\n initial a\n state a when x > 1\n state bee when x < 0\n a -> bee\n}\n";
    faults(
        &format!("{machine}never m == be and y > 1"),
        expect![[r#"
        unknown-state: be
    "#]],
    );
    faults(
        &format!("{machine}whenever entered(m.bees), eventually left(m.a)"),
        expect![[r#"
        unknown-state: bees
    "#]],
    );
    faults(
        "machine m {\n initial a\n state a when x > 1\n a -> c\n}",
        expect![[r#"
        unknown-state: c
    "#]],
    );
    clean(&format!("{machine}whenever m == bee, eventually entered(m.a)"));
}

#[test]
fn libraries() {
    expect![[r#"
        there is no library `std.robto`; did you mean `std.robot`?
          unknown library
          the libraries are `std.robot`, `std.dwyer`, `std.mission`
          a pattern of your own can stand in a file beside this one: `use "mine.rv"`
    "#]]
    .assert_eq(&said(&alone("use std.robto\nx > 1")));
    expect![[r#"
        the file `mine.rv` cannot be read
          no such file, or none that is a text
          the path is relative to the file that uses it
          a library that comes with Lapwing is named without quotes: `use std.robot`
    "#]]
    .assert_eq(&said(&alone("use \"mine.rv\"\nx > 1")));
    let mine = [
        ("mine.rv", "pattern high(a): a > 3\nuse \"deeper/more.rv\""),
        ("deeper/more.rv", "limit = 3\nuse \"../mine.rv\""),
    ];
    expect![[r#"
        cannot-hold: high(x) and x < limit
    "#]]
    .assert_eq(&check_with("use \"mine.rv\"\nhigh(x) and x < limit", None, &mine).codes());
    let judged = [("mine.rv", "property p: x > 1")];
    expect![[r#"
        library-property: property p: x > 1
    "#]]
    .assert_eq(&check_with("use \"mine.rv\"\nx > 1", None, &judged).codes());
}

#[test]
fn duplicates() {
    faults(
        "limit = 1\nlimit = 2\nx > limit",
        expect![[r#"
        duplicate-name: limit
    "#]],
    );
    faults(
        "property p: x > 1\np = always y > 1",
        expect![[r#"
        duplicate-name: p
    "#]],
    );
    faults(
        "pattern norm(a): a > 1\nx > norm(y)",
        expect![[r#"
        duplicate-name: norm
    "#]],
    );
    faults(
        "for each r in (a, b, a): r.x > 1",
        expect![[r#"
        duplicate-name: a
    "#]],
    );
    faults(
        "model r: position /a P.p\n position /b P.p\n;\nr.x > 1",
        expect![[r#"
        duplicate-name: position
    "#]],
    );
    faults(
        "__rate__ = 30\n__rate__ = 20\nx > 1",
        expect![[r#"
        duplicate-name: __rate__ = 20
    "#]],
    );
    clean("limit = 1\nx > limit");
}

#[test]
fn recursion() {
    faults(
        "a = b + 1\nb = a + 1\nx > a",
        expect![[r#"
        recursive-name: a
    "#]],
    );
    faults(
        "pattern p(x): x > 1 and p(x)\np(y)",
        expect![[r#"
        recursive-name: p
    "#]],
    );
    faults(
        "machine m {\n initial a\n state a when m == b\n state b when x > 1\n a -> b\n}",
        expect![[r#"
        recursive-name: m
    "#]],
    );
    expect![[r#"
        `speed` depends on itself
          it is defined by itself
          where `speed` was meant as a column or a signal, define this under another name, such as `my_speed`: a name that is defined here always means its definition
          where it was meant as what was before: that is said by `previously`, `since` or `@{x, -1}`
    "#]]
    .assert_eq(&said(&against("speed: always speed < 2", &csv(&["speed"]))));
    clean("a = b + 1\nb = 1\nx > a");
    clean("v = any(list, v => v > 1)\nnever v");
}

#[test]
fn types() {
    faults(
        "\"text\" and x > 1",
        expect![[r#"
        type-mismatch: "text"
    "#]],
    );
    faults(
        "x + (y > 1) > 3",
        expect![[r#"
        type-mismatch: y > 1
    "#]],
    );
    faults(
        "x == \"a\" and \"a\" < \"b\"",
        expect![[r#"
        type-mismatch: "a"
        type-mismatch: "b"
    "#]],
    );
    faults(
        "abs(x) implies x > 1",
        expect![[r#"
        type-mismatch: abs(x)
    "#]],
    );
    faults_on(
        "decl v /cmd_vel Twist.linear.x\nv",
        expect![[r#"
        type-mismatch: v
    "#]],
    );
    faults_on(
        "decl v /cmd_vel Twist\nv > 1",
        expect![[r#"
        type-mismatch: v
    "#]],
    );
    faults_on(
        "decl v /mode String.data\nv and v == 3",
        expect![[r#"
        type-mismatch: v
        type-mismatch: 3
    "#]],
    );
    faults_on(
        "decl v /scan LaserScan.ranges\nv > 1",
        expect![[r#"
        type-mismatch: v
    "#]],
    );
    faults_on(
        "decl v /odom Odometry.pose.pose.position\nyaw(v) > 1",
        expect![[r#"
        type-mismatch: v
    "#]],
    );
    faults_on(
        "decl v /estop Bool.data default 3\nv",
        expect![[r#"
        type-mismatch: 3
    "#]],
    );
    faults_on("decl v /mode String.data\nv == \"auto\" and contains(v, \"a\")", expect![[""]]);
    faults(
        "robot.position > 1",
        expect![[r#"
        type-mismatch: robot.position
    "#]],
    );
    expect![[r#"
        `robot.position` has several parts, where one value is wanted
          one value is wanted here
          name the part that you mean: `robot.position.x`, `robot.position.y`, `robot.position.z`
          or its length: `norm(robot.position)`
    "#]]
    .assert_eq(&said(&alone("robot.position > 1")));
    clean("flag and x > 1");
}

#[test]
fn dimensions() {
    faults(
        "robot.velocity > robot.position.x",
        expect![[r#"
        dimension-mismatch: robot.position.x
    "#]],
    );
    faults(
        "robot.velocity + 2 s > 1",
        expect![[r#"
        dimension-mismatch: 2 s
    "#]],
    );
    faults(
        "robot.velocity > 2 s",
        expect![[r#"
        dimension-mismatch: 2 s
    "#]],
    );
    faults(
        "robot.velocity =={1 m} 0",
        expect![[r#"
        dimension-mismatch: 1 m
    "#]],
    );
    faults(
        "decl v /cmd_vel Twist.linear.x\ndecl w /cmd_vel Twist.angular.z\nv > w",
        expect![[r#"
        dimension-mismatch: w
    "#]],
    );
    faults(
        "age(/scan) > 2 m",
        expect![[r#"
        dimension-mismatch: 2 m
    "#]],
    );
    faults(
        "sin(robot.position.x) > 1",
        expect![[r#"
        dimension-mismatch: robot.position.x
    "#]],
    );
    faults(
        "norm(robot.position.x, robot.velocity.x) > 1",
        expect![[r#"
        dimension-mismatch: robot.velocity.x
    "#]],
    );
    expect![[r#"
        m/s and m cannot be compared
          in m
          a bare number fits everything; a unit after it says what it is: `0.5 m`, `2 m/s`, `100 ms`, `30 deg`
    "#]]
    .assert_eq(&said(&alone("robot.velocity > robot.position.x")));
    clean("robot.velocity > 2 and robot.velocity * 3 s > robot.position.x");
    clean("robot.velocity.angular.z * 0.3 m < robot.velocity and robot.orientation < 3");
    clean("rate(robot.position.x) < 3 m/s and sqrt(robot.position.x * robot.position.x) < 2 m");
    clean("delta(robot.position.x) < 2 * robot.velocity and frequency(/scan, 1 s) > 2 Hz");
}

#[test]
fn arguments() {
    faults(
        "norm() > 1 and atan2(x) > 1 and age(x, y) > 1",
        expect![[r#"
        wrong-arguments: norm()
        wrong-arguments: atan2(x)
        wrong-arguments: age(x, y)
    "#]],
    );
    faults(
        "pattern p(a, b): a > b\np(x)",
        expect![[r#"
        wrong-arguments: p(x)
    "#]],
    );
    faults(
        "age(x) < 1",
        expect![[r#"
        wrong-arguments: x
    "#]],
    );
    faults(
        "min_over(x, 5) > 1",
        expect![[r#"
        not-a-duration: 5
    "#]],
    );
    faults(
        "any(list, x > 1)",
        expect![[r#"
        wrong-arguments: any(list, x > 1)
    "#]],
    );
    expect![[r#"
        `atan2` cannot be called with one argument like this
          does not fit the signature
          it is called as `atan2(y, x)`
    "#]]
    .assert_eq(&said(&alone("atan2(x) > 1")));
    expect![[r#"
        the pattern `p` takes 2 arguments, not 1
          `b` is missing
          it is called as `p(a, b)`
    "#]]
    .assert_eq(&said(&alone("pattern p(a, b): a > b\np(x)")));
}

#[test]
fn the_future_inside() {
    faults(
        "once eventually x > 1",
        expect![[r#"
        future-inside: eventually x > 1
    "#]],
    );
    faults(
        "soon = eventually x > 1\npreviously soon",
        expect![[r#"
        future-inside: eventually x > 1
    "#]],
    );
    faults(
        "count(eventually x > 1, 2 s) > 1",
        expect![[r#"
        future-inside: eventually x > 1
    "#]],
    );
    faults(
        "(eventually x > 1) == true",
        expect![[r#"
        future-inside: eventually x > 1
    "#]],
    );
    faults(
        "machine m {\n initial a\n state a when eventually x > 1\n a -> a\n}",
        expect![[r#"
        future-inside: eventually x > 1
    "#]],
    );
    clean("eventually once x > 1");
}

#[test]
fn bounds() {
    faults(
        "eventually within [2 s, 1 s] x > 1",
        expect![[r#"
        empty-bound: within [2 s, 1 s]
    "#]],
    );
    faults(
        "limit = 3\neventually within limit x > 1",
        expect![[r#"
        not-a-duration: 3
    "#]],
    );
    faults(
        "limit = y\neventually within limit x > 1",
        expect![[r#"
        not-a-duration: y
    "#]],
    );
    faults(
        "limit = 0.1 * 1 ns\neventually within limit x > 1",
        expect![[r#"
        duration-range: 0.1 * 1 ns
    "#]],
    );
    faults(
        "__rate__ = 10\neventually within 100 ms x > 1",
        expect![[r#"
        bound-under-three-periods: within 100 ms
    "#]],
    );
    clean("__rate__ = 10\neventually within 300 ms x > 1");
    clean("eventually within [1 s, 1 s] x > 1");
}

#[test]
fn clocks() {
    faults(
        "__rate__ = 30\nclock events\nx > 1",
        expect![[r#"
        clock-conflict: clock events
    "#]],
    );
    faults(
        "__rate__ = 1.5\nx > 1",
        expect![[r#"
        bad-setting: 1.5
    "#]],
    );
    faults(
        "__rate__ = 30\nproperty p: x > 1\nguard /a from /b by p else drop",
        expect![[r#"
        clock-conflict: guard /a from /b by p else drop
    "#]],
    );
    clean("__rate__ = 30\n__timeout__ = 100\nx > 1");
}

#[test]
fn alphabets() {
    faults(
        "event kick\nproperty p over (kick): x > 1",
        expect![[r#"
        over-signals: kick
    "#]],
    );
    faults(
        "event kick\nproperty p over (kik): always not kick",
        expect![[r#"
        unknown-name: kik
    "#]],
    );
    faults(
        "event on\nltl([] on)",
        expect![[r#"
        cannot-fail: ltl([] on)
    "#]],
    );
    faults(
        "event on\nevent off\nproperty p over (on): always (on or off)",
        expect![[r#"
        cannot-fail: always (on or off)
    "#]],
    );
    clean("event on\nevent off\nproperty p over (on, off): ltl([] on)");
}

#[test]
fn misplaced() {
    faults(
        "updated(x) and y > 1",
        expect![[r#"
        misplaced: updated(x)
    "#]],
    );
    faults(
        "/scan > 1",
        expect![[r#"
        syntax: /
    "#]],
    );
    faults(
        "machine m {\n initial a\n state a when x > 1\n a -> a\n}\nm > 1",
        expect![[r#"
        misplaced: m
    "#]],
    );
    faults(
        "x > (v => v)",
        expect![[r#"
        foreign-operator: =>
        type-mismatch: v => v
    "#]],
    );
    faults(
        "p = for each r in (a, b): r.x > 1\nalways p",
        expect![[r#"
        misplaced: p
    "#]],
    );
}

#[test]
fn reactions() {
    faults(
        "property p: x > 1\non violation of q { stop }",
        expect![[r#"
        unknown-name: q
    "#]],
    );
    faults(
        "p = always x > 1\nproperty q: p and y > 1\non violation of p { stop }",
        expect![[r#"
        judged-once: p and y > 1
        not-judged: p
    "#]],
    );
    clean("property p: x > 1\non violation of p { stop }");
}

#[test]
fn constants() {
    faults(
        "decl v /estop Bool.data default x\nv",
        expect![[r#"
        not-constant: x
    "#]],
    );
    faults_on(
        "decl b /battery BatteryState\nb.power_supply_status == BatteryState.CHRAGING",
        expect![[r#"
        unknown-name: CHRAGING
    "#]],
    );
    faults(
        "world robot /odom Twist\nrobot.position.x > 1",
        expect![[r#"
        world-source: Twist
    "#]],
    );
    faults(
        "machine m {\n state a when x > 1\n a -> a\n}",
        expect![[r#"
        no-initial-state: m
    "#]],
    );
}

#[test]
fn growth_and_depth_are_bounded() {
    let mut text = String::from("a0 = x + 1\n");
    for i in 1..64 {
        text += &format!("a{i} = a{} + a{}\n", i - 1, i - 1);
    }
    faults(
        &format!("{text}a63 > 1"),
        expect![[r#"
        too-large: x
    "#]],
    );
    let mut text = String::from("a0 = x + 1\n");
    for i in 1..2000 {
        text += &format!("a{i} = a{} + 1\n", i - 1);
    }
    faults(
        &format!("{text}a1999 > 1"),
        expect![[r#"
        too-deep: a1799
    "#]],
    );
}

#[test]
fn faults_in_patterns_are_reported_where_they_are_used() {
    let spec = alone("pattern p(a): a > 1 m\np(robot.velocity)");
    expect![[r#"
        dimension-mismatch: p(robot.velocity)
    "#]]
    .assert_eq(&spec.codes());
    let shown: Vec<String> =
        spec.checked.diagnostics[0].secondary.iter().map(|l| spec.sources.slice(l.span).to_owned()).collect();
    assert_eq!(shown, ["robot.velocity", "p"]);
}
