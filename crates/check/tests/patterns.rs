//! Patterns: their bodies are read whether anyone uses them or not, and those that are shipped keep out of everybody's way.

mod support;

use std::collections::BTreeSet;

use expect_test::expect;
use lapwing_check::LIBRARIES;
use lapwing_diag::{Code, FileId};
use lapwing_syntax::ast::{ExprKind, ItemKind, Pattern};
use support::{alone, check_with, clean, faults};

/// The diagnostics of a pattern that nobody uses, but for that.
fn unused(pattern: &str) -> String {
    let spec = alone(&format!("{pattern}\nproperty p: always x > 1"));
    let faults = spec.checked.diagnostics.iter().filter(|d| d.code != Code::UnusedName);
    faults.map(|d| format!("{}: {}\n", d.code.name(), spec.sources.slice(d.primary.span))).collect()
}

#[test]
fn bodies_that_nobody_uses_are_read() {
    assert_eq!(unused("pattern p1(a): nrom(a) > 1"), "unknown-function: nrom\n");
    assert_eq!(unused("pattern p1(a): once eventually a"), "future-inside: eventually a\n");
    assert_eq!(unused("pattern p1(a): always \"text\" and a"), "type-mismatch: \"text\"\n");
    assert_eq!(unused("pattern p1(a): a > 1 m and 1 m > 2 s"), "dimension-mismatch: 2 s\n");
    assert_eq!(unused("pattern p1(a): eventually within limit a\nlimit = 3"), "not-a-duration: 3\n");
    assert_eq!(unused("pattern p1(a): a(1) > 2"), "unknown-function: a\n");
    let machine = "machine m {\n initial s1\n state s1 when v > 1\n}\n";
    assert_eq!(unused(&format!("{machine}pattern p1(a): m == s2 and a")), "unknown-state: s2\n");
    // One that only an unused pattern uses.
    assert_eq!(
        unused("pattern inner(a): nrom(a) > 1\npattern p1(a): inner(a)"),
        "unknown-function: p1\n".replace("p1", "inner(a)")
    );
}

#[test]
fn what_arguments_can_cure_is_no_fault() {
    let machine = "machine m {\n initial s1\n state s1 when v > 1\n}\n";
    let bodies = [
        "always a",
        "once a",
        "a > 1 m and a < 2 s",
        "a == \"text\" and a",
        "a.b.c[0] > 1",
        "norm(a) > 1 and yaw(a) > 1",
        "any(a, v => v.x > 1)",
        "age(a) < 1 s and fresh(a) and frequency(a, a) > 1",
        "held for a (x > 1)",
        "eventually within (0 s, a] x > 1",
        "count(x > 1, 2 * a) > 2",
        "m == a",
        "entered(a)",
        "lookup(a.name, a.position, \"elbow\") > 1",
        "@{a, -2} > a",
    ];
    for body in bodies {
        assert_eq!(unused(&format!("{machine}pattern p1(a): {body}")), "", "{body}");
    }
}

#[test]
fn nothing_of_them_is_read_of_a_recording() {
    let spec = alone(
        "decl v /odom Odometry.twist.twist.linear.x\npattern p1(a): v > a and age(/scan) > w\nproperty p: always v > 1",
    );
    let topics: Vec<&str> = spec.checked.spec.topics.iter().map(|t| t.name.as_str()).collect();
    assert_eq!((topics, spec.checked.spec.columns.len()), (vec!["/odom"], 0));
}

#[test]
fn topics_with_holes() {
    clean(
        "for each r in topics /{r}/odom: always age(/{r}/odom) < 1 s and fresh(/{r}/odom) and frequency(/{r}/odom, 2 s) > 1",
    );
    clean("for each r in (a, b): always age(/{r}/odom) < 1 s");
    clean("pattern old(t): age(t) > 1 s\nfor each r in topics /{r}/odom: never old(/{r}/odom)");
    faults(
        "always age(/{r}/odom) < 1 s",
        expect![[r#"
            unknown-name: /{r}/odom
        "#]],
    );
    faults(
        "event kick\nfor each r in (a, b): for each k of kick.robot: eventually age(/{r}/{k}) < 1 s and kick",
        expect![[r#"
            unknown-name: /{r}/{k}
        "#]],
    );
    let spec = support::against("for each r in (odom, scan): always age(/{r}) < 1 s", &support::shapes::robot());
    assert_eq!(spec.messages(), "");
    let topics: Vec<&str> = spec.checked.spec.topics.iter().map(|t| t.name.as_str()).collect();
    assert_eq!(topics, ["/odom", "/scan"]);
}

#[test]
fn fields_of_a_topic_that_is_an_argument() {
    let pattern = "pattern set(topic): topic.header.stamp > 0\n";
    let robot = support::shapes::robot();
    for argument in ["/odom", "odom"] {
        let text = format!("decl odom /odom Odometry\n{pattern}always set({argument})");
        let spec = support::against(&text, &robot);
        assert_eq!(
            spec.messages(),
            if argument == "odom" { "" } else { "unused-name: the signal `odom` is never used\n" }
        );
        assert_eq!(spec.checked.spec.topics[0].fields.len(), 2, "seconds and nanoseconds");
    }
    let wrong = support::against(&format!("{pattern}always set(/cmd_vel)"), &robot);
    assert_eq!(wrong.codes(), "unknown-field: set(/cmd_vel)\n");
}

fn shipped() -> Vec<(&'static str, Pattern)> {
    let patterns = LIBRARIES.iter().flat_map(|library| {
        let parsed = lapwing_syntax::parse(FileId(0), library.text);
        assert!(parsed.diagnostics.is_empty(), "{}: {:?}", library.name, parsed.diagnostics);
        parsed.file.items.into_iter().map(|item| match item.kind {
            ItemKind::Pattern(pattern) => (library.name, pattern),
            other => panic!("{}: a library holds patterns alone: {other:?}", library.name),
        })
    });
    patterns.collect()
}

#[test]
fn the_libraries_are_right_by_themselves() {
    for library in LIBRARIES {
        clean(library.text);
        assert_eq!(lapwing_syntax::format(library.text).as_deref(), Ok(library.text), "{} is laid out", library.name);
        clean(&format!("use {}\nalways x > 1", library.name));
    }
}

#[test]
fn their_patterns_depend_on_nothing_else() {
    let mut names = BTreeSet::new();
    let patterns = shipped();
    let all: BTreeSet<&str> = patterns.iter().map(|(_, p)| p.name.name.as_str()).collect();
    for (library, pattern) in &patterns {
        let name = &pattern.name.name;
        assert!(names.insert(name), "{name} stands twice");
        let params: Vec<&str> = pattern.params.iter().map(|p| p.name.as_str()).collect();
        let mut open = vec![&pattern.body];
        while let Some(expr) = open.pop() {
            match &expr.kind {
                ExprKind::Path(path) => {
                    assert!(params.contains(&path[0].name.as_str()), "{library}: {name} reads `{}`", path[0].name)
                }
                ExprKind::Call(called, _) => {
                    assert!(!all.contains(called.name.as_str()), "{library}: {name} calls {}", called.name)
                }
                _ => {}
            }
            open.extend(expr.children());
        }
    }
}

#[test]
fn a_misspelt_pattern_of_a_library_is_understood() {
    let spec = alone("use std.robot\nwheels: trakcs(cmd, odom, 0.1, 1 s)");
    assert_eq!(spec.messages(), "unknown-function: there is no function or pattern `trakcs`; did you mean `tracks`?\n");
}

#[test]
fn their_names_give_way() {
    let own = "use std.robot\npattern stuck(a): a > 5\nproperty p: always stuck(x)";
    clean(own);
    assert!(alone(own).checked.spec.properties[0].problem.is_none());
    let used = [("mine.rv", "use std.robot\npattern stuck(a): a > 5")];
    let text = "use std.robot\nuse std.dwyer\nuse \"mine.rv\"\nproperty p: always stuck(x)\nq: answers(x, y, 1 s)";
    assert_eq!(check_with(text, None, &used).codes(), "");
}

#[test]
fn a_file_that_uses_the_specification_brings_nothing_new() {
    let files = [("mine.rv", "use \"test.rv\"\npattern high(a): a > 3")];
    assert_eq!(
        check_with("use \"mine.rv\"\nproperty p: never high(x)\nlimit = 3\nq: never x > limit", None, &files).codes(),
        ""
    );
}

#[test]
fn faults_of_a_used_file_are_located_in_it() {
    let files = [("deep/mine.rv", "# mine\npattern high(a): nrom(a) > 3\nuse \"../none.rv\"")];
    let spec = check_with("use \"deep/mine.rv\"\nproperty p: never x > 2", None, &files);
    let place = |d: &lapwing_diag::Diagnostic| {
        let (line, column) = spec.sources.position(d.primary.span);
        format!("{}:{line}:{column} {}", spec.sources.name(d.primary.span.file), d.message)
    };
    let places: Vec<String> = spec.checked.diagnostics.iter().map(place).collect();
    assert_eq!(
        places,
        [
            "deep/mine.rv:2:18 there is no function or pattern `nrom`; did you mean `norm`?",
            "deep/mine.rv:3:5 the file `none.rv` cannot be read"
        ]
    );
}

#[test]
fn there_is_a_limit_to_files() {
    let name = |n: usize| format!("f{n}.rv");
    let files: Vec<(String, String)> = (0..300).map(|n| (name(n), format!("use \"f{}.rv\"", n + 1))).collect();
    let files: Vec<(&str, &str)> = files.iter().map(|(n, t)| (n.as_str(), t.as_str())).collect();
    let spec = check_with("use \"f0.rv\"\nx > 1", None, &files);
    assert_eq!(spec.messages(), "too-large: a specification uses 256 files at most\n");
}
