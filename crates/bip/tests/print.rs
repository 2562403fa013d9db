//! What is printed is read back as the same tree, and printed again as the same text.

mod support;

use lapwing_bip::ast::{BinaryOp, Expr, Stmt, UnaryOp};
use lapwing_bip::{FileId, parse, print};
use std::fs;
use std::path::Path;

#[test]
fn models_are_read_back() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/models");
    for path in fs::read_dir(folder).expect("models").flatten().map(|e| e.path()) {
        let text = fs::read_to_string(&path).expect("a model");
        let parsed = parse(FileId(0), &text);
        assert!(parsed.diagnostics.is_empty(), "{}: {:?}", path.display(), parsed.diagnostics);
        let printed = print(&parsed.package);
        let again = parse(FileId(0), &printed);
        assert!(again.diagnostics.is_empty(), "{}: {:?}\n{printed}", path.display(), again.diagnostics);
        assert_eq!(print(&again.package), printed, "{}", path.display());
        assert_eq!(again.package.decls.len(), parsed.package.decls.len());
    }
}

fn printed(expr: Expr) -> String {
    let body = vec![Stmt::assign("x", expr)];
    let atom = lapwing_bip::ast::AtomType {
        name: "A".into(),
        places: vec!["a".into()],
        initial: lapwing_bip::ast::Initial { places: vec!["a".into()], body, ..Default::default() },
        ..Default::default()
    };
    let decl = lapwing_bip::ast::DeclKind::Atom(atom);
    let package = lapwing_bip::ast::Package { name: "p".into(), decls: vec![decl.into()], ..Default::default() };
    let text = print(&package);
    let again = parse(FileId(0), &text);
    assert!(again.diagnostics.is_empty(), "{:?}\n{text}", again.diagnostics);
    assert_eq!(print(&again.package), text);
    let line = text.lines().find(|l| l.contains("x = ")).unwrap_or_default();
    line.trim().trim_start_matches("do { x = ").trim_end_matches("; }").to_owned()
}

#[test]
fn brackets_where_they_are_needed() {
    let (a, b, c) = (Expr::path("a"), Expr::path("b"), Expr::path("c"));
    let sub = |l: &Expr, r: &Expr| Expr::binary(BinaryOp::Subtract, l.clone(), r.clone());
    assert_eq!(printed(sub(&sub(&a, &b), &c)), "a - b - c");
    assert_eq!(printed(sub(&a, &sub(&b, &c))), "a - (b - c)");
    let sum = Expr::binary(BinaryOp::Add, a.clone(), b.clone());
    assert_eq!(printed(Expr::binary(BinaryOp::Multiply, sum, c.clone())), "(a + b) * c");
    let both = Expr::binary(BinaryOp::And, a.clone(), b.clone());
    assert_eq!(printed(Expr::binary(BinaryOp::Or, both.clone(), c.clone())), "(a && b) || c");
    assert_eq!(printed(Expr::unary(UnaryOp::Not, both)), "!(a && b)");
    assert_eq!(printed(Expr::unary(UnaryOp::Minus, Expr::int(-3))), "-(-3)");
    assert_eq!(printed(Expr::int(i64::MIN)), "-9223372036854775807 - 1");
    assert_eq!(printed(Expr::text("a\"b\\c\n")), "\"a\\\"b\\\\c\\n\"");
    assert_eq!(printed(Expr::call("f", vec![a, Expr::real("1.50")])), "f(a, 1.50)");
}

#[test]
fn texts_have_the_escapes_of_c_and_go_over_lines() {
    let text = |inside: &str| parse(FileId(0), &format!("package p const data string s = \"{inside}\" end"));
    let read = |inside: &str| {
        let parsed = text(inside);
        assert!(parsed.diagnostics.is_empty(), "{inside}: {:?}", parsed.diagnostics);
        let printed = print(&parsed.package);
        assert_eq!(print(&parse(FileId(0), &printed).package), printed);
        printed.lines().find_map(|l| l.trim().strip_prefix("const data string s = ")).unwrap_or_default().to_owned()
    };
    assert_eq!(read("one\ntwo"), r#""one\ntwo""#);
    assert_eq!(read(r"a\x41\101\0\?\a"), r#""aAA\000?\007""#);
    assert_eq!(read("joined \\\nagain \\\"quoted\\\""), r#""joined again \"quoted\"""#);
    for wrong in [r"\q", r"\x", r"\400"] {
        assert_eq!(text(wrong).diagnostics.first().map(|d| d.code.name()), Some("bad-text"), "{wrong}");
    }
}

#[test]
fn a_text_without_an_end_may_be_another() {
    let parsed = parse(FileId(0), "package p\nconst data string s = \"a\nconst data string t = \"b\"\nend");
    let found = parsed.diagnostics.iter().find(|d| d.code.name() == "bad-text").expect("a text has no end");
    assert_eq!(found.secondary.len(), 1, "{found:?}");
}

#[test]
fn comments_stand_in_front_of_what_they_speak_of() {
    let mut package = parse(FileId(0), "package p port type Go() end").package;
    package.notes = vec!["made of laser.gen".to_owned()];
    package.decls[0].notes = vec!["laser.gen:12\nport Scan".to_owned()];
    let text = print(&package);
    assert_eq!(text, "// made of laser.gen\npackage p\n\n// laser.gen:12\n// port Scan\nport type Go()\n\nend\n");
    assert!(parse(FileId(0), &text).diagnostics.is_empty());
}

#[test]
fn long_lists_are_broken() {
    let places: Vec<String> = (0..60).map(|n| format!("place_number_{n}")).collect();
    let text = format!("package p atom type A() place {} initial to place_number_0 end end", places.join(", "));
    let printed = print(&parse(FileId(0), &text).package);
    assert!(printed.lines().all(|l| l.len() <= 100), "{printed}");
    assert_eq!(print(&parse(FileId(0), &printed).package), printed);
}
