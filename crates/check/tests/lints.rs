//! Lints: what is no error but probably not meant, each with a specification that has it and one that has not.

mod support;

use expect_test::expect;
use support::{alone, clean, faults, said};

#[test]
fn float_equality() {
    faults(
        "robot.velocity == 0 and robot.velocity != x",
        expect![[r#"
        float-equality: robot.velocity == 0
        float-equality: robot.velocity != x
    "#]],
    );
    faults(
        "x == 0.5",
        expect![[r#"
        float-equality: x == 0.5
    "#]],
    );
    clean("robot.velocity =={0.1} 0");
    clean("__margin__ = 0.01\nrobot.velocity == 0");
    clean("x == 0 and s == \"on\"");
}

#[test]
fn mixed_and_or() {
    faults(
        "a and b or c",
        expect![[r#"
        mixed-and-or: a and b
    "#]],
    );
    clean("(a and b) or c");
    clean("a and b and c");
}

#[test]
fn unused_names() {
    faults(
        "decl v /odom Odometry\nlimit = 3\nevent e\npattern p(a): a > 1\nx > 1",
        expect![[r#"
        unused-name: v
        unused-name: limit
        unused-name: e
        unused-name: p
    "#]],
    );
    clean("_limit = 3\nx > 1");
    clean("decl v /odom Odometry\nage(v) < 1");
    clean("decl a /a Float64.data\ndecl b /b Float64.data\nfor each k in (a, b): k > 0");
    faults(
        "decl a /a Float64.data\ndecl b /b Float64.data\nfor each k in (a, b): any(x.k, k => k > 0)",
        expect![[r#"
        unused-name: a
        unused-name: b
    "#]],
    );
}

#[test]
fn judged_once() {
    faults(
        "x > 0 implies eventually within 2 s y > 1",
        expect![[r#"
        judged-once: x > 0 implies eventually within 2 s y > 1
    "#]],
    );
    faults(
        "x > 0 and always y > 1",
        expect![[r#"
        judged-once: x > 0 and always y > 1
    "#]],
    );
    clean("whenever x > 0, eventually y > 1");
    clean("always (x > 0 implies eventually y > 1)");
    clean("always x > 1 and eventually y > 1");
    expect![[r#"
        this is judged once, at the beginning
          not checked again later
          to check it every time, write `whenever x > 0, eventually within 2 s y > 1`
    "#]]
    .assert_eq(&said(&alone("x > 0 implies eventually within 2 s y > 1")));
}

#[test]
fn what_is_decided_beforehand() {
    faults(
        "always (x > 5 and x < 3)",
        expect![[r#"
        cannot-hold: x > 5 and x < 3
    "#]],
    );
    faults(
        "never (x > 5 and y > 1 and 5 > x)",
        expect![[r#"
        cannot-hold: x > 5 and y > 1 and 5 > x
    "#]],
    );
    faults(
        "always (x > 3 or x <= 3)",
        expect![[r#"
        cannot-fail: always (x > 3 or x <= 3)
    "#]],
    );
    faults(
        "always 1 < 2",
        expect![[r#"
        cannot-fail: always 1 < 2
    "#]],
    );
    faults(
        "eventually false",
        expect![[r#"
        cannot-hold: eventually false
    "#]],
    );
    faults(
        "whenever 1 > 2, x > 1",
        expect![[r#"
        cannot-fail: whenever 1 > 2, x > 1
    "#]],
    );
    clean("always (x > 3 and x < 5)");
    clean("always (x > 3 or y <= 3)");
    clean("always (x >{1} 3 and x < 2.5)");
    clean("x > 3 and previously x < 3");
}
