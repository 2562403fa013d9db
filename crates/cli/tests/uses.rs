//! Specifications that use other files: where these are looked for, and where their faults are.

mod common;

use common::{Folder, table};

const RUN: &str = "run.csv";

fn folder(files: &[(&str, &str)]) -> Folder {
    let folder = Folder::new(files);
    folder.write(RUN, table("x", &[(0.0, 0.0), (1.0, 1.0), (2.0, 4.0)]).as_bytes());
    folder
}

#[test]
fn files_are_looked_for_beside_the_one_that_uses_them() {
    let folder = folder(&[
        ("specs/robot.rv", "use \"lib/mine.rv\"\nproperty calm: never high(x)\n"),
        ("specs/lib/mine.rv", "use \"limits.rv\"\npattern high(a): a > limit\n"),
        ("specs/lib/limits.rv", "limit = 3\n"),
    ]);
    let run = folder.lapwing("check specs/robot.rv run.csv");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""), "{}", run.stdout);
    assert!(run.stdout.contains("never high(x)"), "{}", run.stdout);
}

#[test]
fn circles_end() {
    let folder = folder(&[
        ("specs/robot.rv", "use \"mine.rv\"\nuse \"../specs/mine.rv\"\nproperty calm: never high(x)\n"),
        ("specs/mine.rv", "use \"robot.rv\"\nuse \"mine.rv\"\npattern high(a): a > 5\n"),
    ]);
    let run = folder.lapwing("check specs/robot.rv run.csv");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{}", run.stdout);
}

#[test]
fn a_missing_file_is_an_error_where_it_is_named() {
    let folder = folder(&[
        ("specs/robot.rv", "use \"mine.rv\"\nproperty calm: never x > 3\n"),
        ("specs/mine.rv", "# nothing yet\nuse \"none.rv\"\n"),
    ]);
    let run = folder.lapwing("check specs/robot.rv run.csv");
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(run.stderr.contains("specs/mine.rv:2:5"), "{}", run.stderr);
    assert!(run.stderr.contains("`none.rv` cannot be read"), "{}", run.stderr);
}

#[test]
fn faults_are_shown_in_the_used_file() {
    let folder = folder(&[
        ("specs/robot.rv", "use \"mine.rv\"\nproperty calm: never x > 3\n"),
        ("specs/mine.rv", "pattern high(a):\n    nrom(a) > 3\n"),
    ]);
    let run = folder.lapwing("check specs/robot.rv run.csv");
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(run.stderr.contains("specs/mine.rv:2:5"), "{}", run.stderr);
    assert!(run.stderr.contains("did you mean `norm`?"), "{}", run.stderr);
}

#[test]
fn libraries_are_at_hand() {
    let folder =
        folder(&[("robot.rv", "use std.robot\nuse std.dwyer\narm: no_jump(x, 2)\nonce_high: existence(x > 3)\n")]);
    let run = folder.lapwing("check robot.rv run.csv");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""), "{}", run.stdout);
    assert!(run.stdout.contains("arm: no_jump(x, 2)"), "{}", run.stdout);
}
