//! What diagnostics look like.

use expect_test::{Expect, expect};
use lapwing_diag::{Code, Diagnostic, FileId, SourceMap, Span, Style, render, render_short};

fn sources(text: &str) -> SourceMap {
    let mut sources = SourceMap::default();
    sources.add("robot.rv", text);
    sources
}

/// The place of the first `part` of `text`.
fn find(text: &str, part: &str) -> Span {
    let start = text.find(part).unwrap();
    Span::new(FileId(0), start, start + part.len())
}

fn check(text: &str, diagnostic: &Diagnostic, expected: Expect) {
    expected.assert_eq(&render(&sources(text), diagnostic, Style::Plain));
}

#[test]
fn message_labels_help_and_cure() {
    let text = "decl v /odom Odometry.x\n\nnevr v > 2\n";
    let diagnostic = Diagnostic::new(Code::UnknownWord, find(text, "nevr"), "`nevr` is no word of the language here")
        .label("did you mean `never`?")
        .also(find(text, "v "), "a signal")
        .help("temporal words are `always`, `never` and `eventually`")
        .fix(find(text, "nevr"), "never");
    check(
        text,
        &diagnostic,
        expect![[r#"
            error[unknown-word]: `nevr` is no word of the language here
             --> robot.rv:3:1
              |
            1 | decl v /odom Odometry.x
              |      -- a signal
            2 |
            3 | nevr v > 2
              | ^^^^ did you mean `never`?
              |
              = help: temporal words are `always`, `never` and `eventually`
            help: write
              |
            3 | never v > 2
              |    +
        "#]],
    );
    expect![[r#"
        robot.rv:3:1: error[unknown-word]: `nevr` is no word of the language here
    "#]]
    .assert_eq(&render_short(&sources(text), &diagnostic));
}

#[test]
fn a_place_at_the_end_of_the_file() {
    let text = "never x >";
    let end = Span::new(FileId(0), text.len(), text.len());
    check(
        text,
        &Diagnostic::new(Code::Syntax, end, "expected a value").label("here"),
        expect![[r#"
        error[syntax]: expected a value
         --> robot.rv:1:10
          |
        1 | never x >
          |          ^ here
    "#]],
    );
    let text = "never x >\n";
    let end = Span::new(FileId(0), text.len(), text.len());
    check(
        text,
        &Diagnostic::new(Code::Syntax, end, "expected a value").label("here"),
        expect![[r#"
        error[syntax]: expected a value
         --> robot.rv:2:1
          |
        2 |
          | ^ here
    "#]],
    );
    check(
        "",
        &Diagnostic::new(Code::Syntax, Span::default(), "nothing is specified"),
        expect![[r#"
        error[syntax]: nothing is specified
         --> robot.rv:1:1
          |
        1 |
          | ^
    "#]],
    );
}

#[test]
fn an_insertion() {
    let text = "after x > 2 never y > 3\n";
    let at = Span::new(FileId(0), 11, 11);
    check(
        text,
        &Diagnostic::new(Code::MissingComma, at, "a comma is missing").fix(at, ","),
        expect![[r#"
        error[missing-comma]: a comma is missing
         --> robot.rv:1:12
          |
        1 | after x > 2 never y > 3
          |            ^
          |
        help: write
          |
        1 | after x > 2, never y > 3
          |            +
    "#]],
    );
}

#[test]
fn tabs_and_wide_characters() {
    let text = "\talways\t`café → 🤖`\t> é\n";
    check(
        text,
        &Diagnostic::new(Code::Syntax, find(text, "> é"), "an é").label("é"),
        expect![[r#"
        error[syntax]: an é
         --> robot.rv:1:20
          |
        1 |     always    `café → 🤖`    > é
          |                              ^^^ é
    "#]],
    );
}

#[test]
fn a_place_over_several_lines() {
    let text = "a\nalways (x\n  and y\n  and z)\nb\n";
    check(
        text,
        &Diagnostic::new(Code::Syntax, find(text, "(x\n  and y\n  and z)"), "brackets"),
        expect![[r#"
        error[syntax]: brackets
         --> robot.rv:2:8
          |
        2 |   always (x
          |  ________^
        3 | |   and y
        4 | |   and z)
          | |________^
    "#]],
    );
}

#[test]
fn a_very_long_line_is_cut() {
    let text = format!("{} nevr y {}\n", "never x and".repeat(500), "or z".repeat(500));
    let shown = render(&sources(&text), &Diagnostic::new(Code::Syntax, find(&text, "nevr"), "long"), Style::Plain);
    assert!(shown.lines().all(|line| line.chars().count() < 200), "{shown}");
    assert!(shown.contains("nevr y"));
}

#[test]
fn several_files() {
    let mut sources = sources("use \"mine.rv\"\ncalm: never x > 2\n");
    let other = sources.add("mine.rv", "# library\ncalm: never y > 2\n");
    let diagnostic = Diagnostic::new(Code::Syntax, Span::new(FileId(0), 14, 18), "there are two properties `calm`")
        .also(Span::new(other, 10, 14), "the other one");
    expect![[r#"
        error[syntax]: there are two properties `calm`
         --> robot.rv:2:1
          |
        2 | calm: never x > 2
          | ^^^^
          |
         ::: mine.rv:2:1
          |
        2 | calm: never y > 2
          | ---- the other one
    "#]]
    .assert_eq(&render(&sources, &diagnostic, Style::Plain));
}

#[test]
fn colour_only_where_it_is_asked_for() {
    let diagnostic =
        Diagnostic::new(Code::Syntax, find("never x", "x"), "wrong").help("help").fix(Span::default(), "y");
    assert!(render(&sources("never x"), &diagnostic, Style::Colour).contains('\x1b'));
    assert!(!render(&sources("never x"), &diagnostic, Style::Plain).contains('\x1b'));
}

#[test]
fn control_characters_do_not_reach_the_terminal() {
    let text = "never \x1b[31mx\x07\n";
    let diagnostic = Diagnostic::new(Code::StrayCharacter, find(text, "\x1b"), "`\x1b` has no meaning here");
    let shown = render(&sources(text), &diagnostic, Style::Plain) + &render_short(&sources(text), &diagnostic);
    assert!(!shown.contains(['\x1b', '\x07']), "{shown:?}");
}

#[test]
fn no_place_makes_it_panic() {
    let text = "é→🤖\n\nx\r\n";
    for start in 0..text.len() + 3 {
        for end in 0..text.len() + 3 {
            for file in 0..2 {
                let span = Span { file: FileId(file), start: start as u32, end: end as u32 };
                let diagnostic =
                    Diagnostic::new(Code::Syntax, span, "m").label("l").also(Span::default(), "s").fix(span, "f");
                for style in [Style::Plain, Style::Colour] {
                    assert!(render(&sources(text), &diagnostic, style).ends_with('\n'));
                }
                render_short(&sources(text), &diagnostic);
            }
        }
    }
}
