//! Which statements a text has, and where they end.

mod common;

use common::{parsed, placeless};
use expect_test::{Expect, expect};
use lapwing_syntax::ast::ItemKind;

/// The statements of a text, one a line, without their places.
fn check(text: &str, expected: Expect) {
    let shown: Vec<String> = parsed(text).items.iter().map(|item| placeless(&item.kind) + "\n").collect();
    expected.assert_eq(&shown.concat());
}

#[test]
fn settings() {
    check(
        "__rate__ = 30\n_timeout_ = 100 s\n_default_margin_ = 1e-6\nclock events",
        expect![[r#"
        Setting(Rate(Number { value: 30.0, text: "30", unit: None }))
        Setting(Timeout(Number { value: 100.0, text: "100", unit: Some(S) }))
        Setting(Margin(Number { value: 1e-6, text: "1e-6", unit: None }))
        Setting(ClockEvents)
    "#]],
    );
}

#[test]
fn declarations() {
    check(
        "decl cmd cmd_vel_original geometry_msgs/Twist.linear.x",
        expect![[r#"
        Decl(Decl { name: "cmd", topic: "cmd_vel_original", ty: TypePath { package: Some("geometry_msgs"), name: "Twist", path: [Field("linear"), Field("x")] }, default: None, stale: None })
    "#]],
    );
    check(
        "decl estop /estop Bool.data default false stale after 2 s",
        expect![[r#"
        Decl(Decl { name: "estop", topic: "/estop", ty: TypePath { package: None, name: "Bool", path: [Field("data")] }, default: Some(Expr { kind: Bool(false), parens: false }), stale: Some(Literal(Duration(2000000000))) })
    "#]],
    );
    check(
        "decl first /a/b1/joints sensor_msgs/msg/JointState.position[0].x",
        expect![[r#"
        Decl(Decl { name: "first", topic: "/a/b1/joints", ty: TypePath { package: Some("sensor_msgs"), name: "JointState", path: [Field("position"), Index(0), Field("x")] }, default: None, stale: None })
    "#]],
    );
    check(
        "model robot1:\n position /odom Odometry.pose\n velocity odom nav_msgs/Odometry.twist;",
        expect![[r#"
        Model(Model { object: "robot1", beliefs: [Belief { quantity: "position", topic: "/odom", ty: TypePath { package: None, name: "Odometry", path: [Field("pose")] } }, Belief { quantity: "velocity", topic: "odom", ty: TypePath { package: Some("nav_msgs"), name: "Odometry", path: [Field("twist")] } }] })
    "#]],
    );
}

#[test]
fn worlds() {
    check(
        "world robot /gt/robot Odometry",
        expect![[r#"
        World(World { object: Some("robot"), source: Topic { topic: "/gt/robot", ty: TypePath { package: None, name: "Odometry", path: [] } } })
    "#]],
    );
    check(
        "world * topics /{name}/gt PoseStamped",
        expect![[r#"
        World(World { object: None, source: Topic { topic: "/{name}/gt", ty: TypePath { package: None, name: "PoseStamped", path: [] } } })
    "#]],
    );
    check(
        "world robot tf map robot/base_link",
        expect![[r#"
        World(World { object: Some("robot"), source: Tf { fixed: "map", frame: "robot/base_link" } })
    "#]],
    );
}

#[test]
fn events() {
    check(
        "event kick",
        expect![[r#"
        Event(EventDecl { name: "kick", source: None, when: None, below: None })
    "#]],
    );
    check(
        "event a = call Kicker::play\nevent b = return play when result == true",
        expect![[r#"
        Event(EventDecl { name: "a", source: Some(Call(CallPath { segments: ["Kicker", "play"] })), when: None, below: None })
        Event(EventDecl { name: "b", source: Some(Return(CallPath { segments: ["play"] })), when: Some(Expr { kind: Binary(Eq, Expr { kind: Path(["result"]), parens: false }, Expr { kind: Bool(true), parens: false }), parens: false }), below: None })
    "#]],
    );
    check(
        "event inner = set S.sonar when x > 1 below K::f",
        expect![[r#"
        Event(EventDecl { name: "inner", source: Some(Set(["S", "sonar"])), when: Some(Expr { kind: Binary(Gt, Expr { kind: Path(["x"]), parens: false }, Expr { kind: Number(Number { value: 1.0, text: "1", unit: None }), parens: false }), parens: false }), below: Some(CallPath { segments: ["K", "f"] }) })
    "#]],
    );
    check(
        "event a = message /kick std_msgs/Bool when data\nevent b = message kick when x",
        expect![[r#"
        Event(EventDecl { name: "a", source: Some(Message("/kick", Some(TypePath { package: Some("std_msgs"), name: "Bool", path: [] }))), when: Some(Expr { kind: Path(["data"]), parens: false }), below: None })
        Event(EventDecl { name: "b", source: Some(Message("kick", None)), when: Some(Expr { kind: Path(["x"]), parens: false }), below: None })
    "#]],
    );
    check(
        "event a = request /set_mode\nevent b = reply set_mode\nevent c = request P.Stop",
        expect![[r#"
        Event(EventDecl { name: "a", source: Some(Request("/set_mode")), when: None, below: None })
        Event(EventDecl { name: "b", source: Some(Reply("set_mode")), when: None, below: None })
        Event(EventDecl { name: "c", source: Some(Activity(Request, ["P", "Stop"])), when: None, below: None })
    "#]],
    );
    check(
        "event a = write L.Laser\nevent b = start P.A\nevent c = end P.A\nevent d = report P.A",
        expect![[r#"
        Event(EventDecl { name: "a", source: Some(Write(["L", "Laser"])), when: None, below: None })
        Event(EventDecl { name: "b", source: Some(Activity(Start, ["P", "A"])), when: None, below: None })
        Event(EventDecl { name: "c", source: Some(Activity(End, ["P", "A"])), when: None, below: None })
        Event(EventDecl { name: "d", source: Some(Activity(Report, ["P", "A"])), when: None, below: None })
    "#]],
    );
}

#[test]
fn machines() {
    check(
        "machine m { initial a\n sample when x\n or y\n state a\n state b on e when c at least 1 s at most 2 s\n else stay\n a -> b | a on e when x\n state -> initial }",
        expect![[r#"
            Machine(Machine { name: "m", sample: Some(Expr { kind: Binary(Or, Expr { kind: Path(["x"]), parens: false }, Expr { kind: Path(["y"]), parens: false }), parens: false }), initial: Some("a"), states: [State { name: "a", when: None, on: None, at_most: None, at_least: None }, State { name: "b", when: Some(Expr { kind: Path(["c"]), parens: false }), on: Some("e"), at_most: Some(Literal(Duration(2000000000))), at_least: Some(Literal(Duration(1000000000))) }], else_stay: true, edges: [Edge { from: "a", to: "b", on: Some("e"), when: Some(Expr { kind: Path(["x"]), parens: false }) }, Edge { from: "a", to: "a", on: Some("e"), when: Some(Expr { kind: Path(["x"]), parens: false }) }, Edge { from: "state", to: "initial", on: None, when: None }] })
        "#]],
    );
}

#[test]
fn patterns_and_libraries() {
    check(
        "pattern p(a, b):\n always a implies b",
        expect![[r#"
        Pattern(Pattern { name: "p", params: ["a", "b"], body: Expr { kind: Prefix(Always, None, Expr { kind: Binary(Implies, Expr { kind: Path(["a"]), parens: false }, Expr { kind: Path(["b"]), parens: false }), parens: false }), parens: false } })
    "#]],
    );
    check(
        "use std.robot\nuse \"my \\u0041.rv\"",
        expect![[r#"
        Use(Library(["std", "robot"]))
        Use(File("my A.rv"))
    "#]],
    );
}

#[test]
fn reactions_and_guards() {
    check(
        "on violation of p at most every 1 s { run find_ball  reset }",
        expect![[r#"
        Reaction(Reaction { property: "p", at_most_every: Some(Literal(Duration(1000000000))), actions: [Run("find_ball"), Reset()] })
    "#]],
    );
    check(
        "on violation of p {\n publish /t a/T { x: -1, y: [1, { z: \"s\" }], }\n call s T {} request A.B stop }",
        expect![[r#"
        Reaction(Reaction { property: "p", at_most_every: None, actions: [Publish("/t", TypePath { package: Some("a"), name: "T", path: [] }, Record([("x", Value(Expr { kind: Neg(Expr { kind: Number(Number { value: 1.0, text: "1", unit: None }), parens: false }), parens: false })), ("y", List([Value(Expr { kind: Number(Number { value: 1.0, text: "1", unit: None }), parens: false }), Record([("z", Value(Expr { kind: Str("s"), parens: false }))])]))])), Call("s", TypePath { package: None, name: "T", path: [] }, Record([])), Request(["A", "B"]), Stop()] })
    "#]],
    );
    check(
        "guard /a from b by p else drop",
        expect![[r#"
        Guard(Guard { to: "/a", from: "b", property: "p", instead: None, fail_open: false })
    "#]],
    );
    check(
        "guard /a from /b by p else publish T { x: 1 } fail open",
        expect![[r#"
        Guard(Guard { to: "/a", from: "/b", property: "p", instead: Some((TypePath { package: None, name: "T", path: [] }, Record([("x", Value(Expr { kind: Number(Number { value: 1.0, text: "1", unit: None }), parens: false }))]))), fail_open: true })
    "#]],
    );
    check(
        "guard /a from /b by p else drop fail closed",
        expect![[r#"
        Guard(Guard { to: "/a", from: "/b", property: "p", instead: None, fail_open: false })
    "#]],
    );
}

#[test]
fn properties() {
    check(
        "a > 1\nproperty q: b\nr: c\ns = d\nt over (e, f): g",
        expect![[r#"
            Property(Property { name: None, over: None, each: [], body: Expr { kind: Binary(Gt, Expr { kind: Path(["a"]), parens: false }, Expr { kind: Number(Number { value: 1.0, text: "1", unit: None }), parens: false }), parens: false } })
            Property(Property { name: Some("q"), over: None, each: [], body: Expr { kind: Path(["b"]), parens: false } })
            Property(Property { name: Some("r"), over: None, each: [], body: Expr { kind: Path(["c"]), parens: false } })
            Definition(Definition { name: "s", each: [], body: Expr { kind: Path(["d"]), parens: false } })
            Property(Property { name: Some("t"), over: Some([Expr { kind: Path(["e"]), parens: false }, Expr { kind: Path(["f"]), parens: false }]), each: [], body: Expr { kind: Path(["g"]), parens: false } })
        "#]],
    );
    check(
        "for each r in (a, b): for each k of call.robot.id: r.x",
        expect![[r#"
        Property(Property { name: None, over: None, each: [ForEach { var: "r", set: List(["a", "b"]) }, ForEach { var: "k", set: Values("call", ["robot", "id"]) }], body: Expr { kind: Path(["r", "x"]), parens: false } })
    "#]],
    );
    check(
        "p: for each r in topics /{r}/odom: r.x\nq = for each r in (a): r",
        expect![[r#"
        Property(Property { name: Some("p"), over: None, each: [ForEach { var: "r", set: Topics("/{r}/odom") }], body: Expr { kind: Path(["r", "x"]), parens: false } })
        Definition(Definition { name: "q", each: [ForEach { var: "r", set: List(["a"]) }], body: Expr { kind: Path(["r"]), parens: false } })
    "#]],
    );
}

/// How many statements there are, and the text of each.
fn pieces(text: &str) -> Vec<&str> {
    parsed(text).items.iter().map(|item| &text[item.span.start as usize..item.span.end as usize]).collect()
}

#[test]
fn a_newline_ends_a_statement() {
    assert_eq!(pieces("a\nb\n\n# c\nd # e\n"), ["a", "b", "d"]);
    assert_eq!(pieces("never a\nuntil b, c"), ["never a", "until b, c"]);
    assert_eq!(pieces("x\r\ny"), ["x", "y"]);
    assert_eq!(pieces("  never a\n\tb"), ["never a", "b"], "indentation means nothing");
    assert_eq!(pieces("a\n(b)\n-c > 1\nd"), ["a", "(b)", "-c > 1", "d"]);
}

#[test]
fn but_not_inside_brackets() {
    assert_eq!(pieces("p: (a\nand\nb\n)"), ["p: (a\nand\nb\n)"]);
    assert_eq!(pieces("f(a,\nb\n.\nc)\nd"), ["f(a,\nb\n.\nc)", "d"]);
    assert_eq!(pieces("x == {\n1\n} 2"), ["x == {\n1\n} 2"]);
    assert_eq!(pieces("@{\nx,\n-1\n} > 2"), ["@{\nx,\n-1\n} > 2"]);
    assert_eq!(pieces("always within (0 s,\n2 s] x"), ["always within (0 s,\n2 s] x"]);
    assert_eq!(pieces("a[\n0\n] > 1"), ["a[\n0\n] > 1"]);
}

#[test]
fn nor_after_an_operator_a_comma_or_a_colon() {
    for operator in ["and", "or", "implies", "iff", "until", "since", "+", "-", "*", "/", "==", "<", ">="] {
        let text = format!("a {operator}\n b");
        assert_eq!(pieces(&text), [text.as_str()]);
    }
    for before in
        ["not", "always", "never", "eventually", "once", "becomes", "x = ", "x:", "p: for each r in (a):", "after a,"]
    {
        let text = format!("{before}\n# comment\n\nb");
        assert_eq!(pieces(&text), [text.as_str()]);
    }
    assert_eq!(pieces("x == -\n1"), ["x == -\n1"]);
    // A name that is spelt like an operator joins nothing.
    assert_eq!(pieces("a.always\nb\ndecl x /once T.not\nc"), ["a.always", "b", "decl x /once T.not", "c"]);
}

#[test]
fn nor_before_a_connective() {
    for connective in ["and", "or", "implies", "iff", "since"] {
        let text = format!("a\n# comment\n  {connective} b");
        assert_eq!(pieces(&text), [text.as_str()]);
    }
    assert_eq!(pieces("a\nuntil b, c"), ["a", "until b, c"]);
    assert_eq!(pieces("a\nsince == 3"), ["a", "since == 3"], "`since` as a name");
}

#[test]
fn a_property_is_what_its_span_covers() {
    let text = "# before\nnever a > 2  # behind\n    and b\n\n# after\n";
    assert_eq!(pieces(text), ["never a > 2  # behind\n    and b"]);
    let file = parsed("property p: x");
    assert_eq!((file.items[0].span.start, file.items[0].span.end), (0, 13));
    assert!(matches!(&file.items[0].kind, ItemKind::Property(p) if p.body.span.start == 12));
}

#[test]
fn names_of_recordings_are_written_so_that_they_are_names() {
    for (name, as_written) in [
        ("speed", Some("speed")),
        ("robot.velocity", Some("robot.velocity")),
        ("my col", Some("`my col`")),
        ("/odom.x", Some("`/odom.x`")),
        ("always", Some("`always`")),
        ("2nd", Some("`2nd`")),
        ("x > 0 and y", Some("`x > 0 and y`")),
        ("a`b", None),
        ("a\nnever b", None),
        ("", None),
    ] {
        assert_eq!(lapwing_syntax::written(name).as_deref(), as_written, "{name}");
    }
}
