//! What is reported once, and the edits that are proposed.

mod support;

use support::shapes::csv;
use support::{Spec, against, alone};

/// The edits that a text's diagnostics propose: what stands there and what should.
fn edits(spec: &Spec) -> Vec<(&str, &str)> {
    let fixes = spec.checked.diagnostics.iter().filter_map(|d| d.fix.as_ref());
    fixes.map(|(span, text)| (spec.sources.slice(*span), text.as_str())).collect()
}

#[test]
fn an_edit_keeps_the_variables_of_for_each() {
    let trace = csv(&["r1.v", "r1.w", "r2.v", "r1.in.r1", "r2.in.r2"]);
    let each = |formula: &str| against(&format!("a: for each r in (r1, r2): {formula}"), &trace);
    assert_eq!(edits(&each("r.w < 1")), [("r.w", "r.v")]);
    assert_eq!(edits(&each("r.im.r < 1")), [("r.im.r", "r.in.r"), ("r.im.r", "r.in.r")]);
    assert_eq!(edits(&against("a: r2.w < 1", &csv(&["r2.v"]))), [("r2.w", "r2.v")]);
}

#[test]
fn an_edit_with_a_name_that_is_no_word_has_backquotes() {
    assert_eq!(edits(&against("a: my_speed < 1", &csv(&["my speed"]))), [("my_speed", "`my speed`")]);
}

#[test]
fn an_edit_that_is_right_in_one_instance_only_is_none() {
    let spec = against("a: for each r in (lef, right): r.speed < 1", &csv(&["left.speed", "right.speed"]));
    assert_eq!(spec.messages(), "unknown-name: unknown name `lef.speed`; did you mean `left.speed`?\n");
    assert_eq!(edits(&spec), []);
}

#[test]
fn an_edit_inside_ltl_is_in_its_notation() {
    for (text, whole) in [
        ("a: ltl(p => <> q)", "[] (p => <> q)"),
        ("a: ltl(p and <> q)", "[] (p and <> q)"),
        ("a: p implies ltl(<> q)", "whenever p, ltl(<> q)"),
    ] {
        assert_eq!(edits(&alone(text)).iter().map(|(_, edit)| *edit).collect::<Vec<_>>(), [whole], "{text}");
    }
}

#[test]
fn what_the_parser_reports_is_not_reported_again() {
    for (text, code) in [
        ("never within 3 s p", "bound-not-allowed: within 3 s\n"),
        ("next within 3 s p", "bound-not-allowed: within 3 s\n"),
        ("d = 0.5 ns\nalways within d p", "duration-range: 0.5 ns\n"),
        ("d = 1 ns / 3\nalways within d p", "duration-range: 1 ns / 3\n"),
    ] {
        let spec = alone(text);
        assert_eq!(spec.codes(), code, "{text}");
    }
}

#[test]
fn an_edit_stands_for_the_whole_of_what_it_replaces() {
    let of = |text: &str| -> Vec<(String, String)> {
        edits(&alone(text)).into_iter().map(|(old, new)| (old.to_owned(), new.to_owned())).collect()
    };
    let edit = |old: &str, new: &str| (old.to_owned(), new.to_owned());
    let first = edit("x > 0 implies eventually y > 1", "whenever x > 0, eventually y > 1");
    // Each part of a conjunction is a formula of its own.
    let second = edit("y > 2 implies always x > 3", "whenever y > 2, always x > 3");
    let both = of("(x > 0 implies eventually y > 1) and (y > 2 implies always x > 3)");
    assert_eq!(both, [first.clone(), second]);
    // Below `not`, and the other way round, `whenever` would say something else.
    assert_eq!(of("not (x > 0 implies always y > 1)"), []);
    assert_eq!(of("(always y > 1) implies x > 0"), []);
    assert_eq!(of("x > 0 implies eventually y > 1"), [first]);
}
