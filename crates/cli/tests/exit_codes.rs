//! Each exit code, for each of its reasons.

mod common;

use common::{Folder, stop_sign, table};

/// A folder with a recording in which `x` goes from 0 to 2.
fn folder(spec: &str) -> Folder {
    Folder::new(&[("spec.rv", spec), ("run.csv", &table("x", &[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)]))])
}

fn code(spec: &str) -> i32 {
    folder(spec).lapwing("check spec.rv run.csv").code
}

#[test]
fn zero_when_all_is_well() {
    assert_eq!(code("never x > 3\n"), 0);
    assert_eq!(code("eventually x > 1\n"), 0);
}

#[test]
fn one_when_something_failed() {
    assert_eq!(code("never x > 1\n"), 1);
    assert_eq!(code("eventually x > 3\n"), 1);
}

#[test]
fn two_when_the_specification_is_wrong() {
    let run = folder("never x >\n").lapwing("check spec.rv run.csv");
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(run.stderr.contains("spec.rv:1"), "{}", run.stderr);
}

#[test]
fn two_when_the_command_line_is_wrong() {
    let folder = folder("never x > 3\n");
    for arguments in [
        "",
        "chek spec.rv run.csv",
        "check spec.rv",
        "check run.csv",
        "check spec.rv nothere.csv",
        "check spec.rv run.csv --shard 3/2",
    ] {
        assert_eq!(folder.lapwing(arguments).code, 2, "{arguments}");
    }
}

#[test]
fn three_when_something_could_not_be_judged() {
    assert_eq!(code("never y > 3\n"), 3);
}

#[test]
fn one_outweighs_three() {
    assert_eq!(code("never y > 3\nnever x > 1\n"), 1);
}

#[test]
fn three_when_a_recording_breaks_off() {
    let folder = Folder::new(&[("ok.rv", "never car.velocity > 100\n"), ("due.rv", "eventually car.velocity > 100\n")]);
    let bytes = stop_sign();
    folder.write("cut.mcap", &bytes[..bytes.len() / 2]);
    let run = folder.lapwing("check ok.rv cut.mcap");
    assert_eq!(run.code, 3, "{}{}", run.stdout, run.stderr);
    assert!(run.stdout.contains("not everything was looked at: cut.mcap"), "{}", run.stdout);
    // As far as was seen, up to the last message of a chunk that is there in part.
    assert!(run.stdout.contains("  holds ") && !run.stdout.contains("inconclusive"), "{}", run.stdout);
    let run = folder.lapwing("check due.rv cut.mcap");
    assert!(run.code == 3 && run.stdout.contains("inconclusive"), "{}", run.stdout);
}

#[test]
fn three_when_a_recording_cannot_be_opened() {
    let folder = folder("never x > 3\n");
    folder.write("noise.mcap", b"\x00\x01\x02 nothing that anyone recorded");
    let run = folder.lapwing("check spec.rv noise.mcap run.csv");
    assert_eq!(run.code, 3, "{}", run.stdout);
    assert!(run.stdout.contains("line 1  the recording cannot be opened\n"), "{}", run.stdout);
    let why = "noise.mcap: no recording: it begins with";
    assert!(run.stdout.contains(&format!("not everything was looked at: {why}")), "{}", run.stdout);
    assert_eq!(run.stdout.matches(why).count(), 1, "said once, however many properties there are: {}", run.stdout);
    let json = folder.lapwing("check spec.rv noise.mcap --format json").stdout;
    assert_eq!(json.matches(why).count(), 2, "{json}");
    assert!(run.stdout.contains("1 inconclusive, 1 holds"), "{}", run.stdout);
}

#[test]
fn three_when_a_field_is_missing() {
    let folder = Folder::new(&[("spec.rv", "decl s /odom nav_msgs/Odometry.twist.twist.linear.speed\nnever s > 3\n")]);
    folder.write("run.mcap", &stop_sign());
    let run = folder.lapwing("check spec.rv run.mcap");
    assert_eq!(run.code, 3, "{}", run.stdout);
    assert!(run.stderr.contains("unknown-field") && run.stderr.contains("spec.rv:1"), "{}", run.stderr);
}

#[test]
fn a_specification_that_is_no_text_is_told_with_its_place() {
    let folder = Folder::new(&[("run.csv", "time,x\n0,1\n")]);
    folder.write("latin.rv", b"never x > 3\n# caf\xe9\n");
    let wide: Vec<u8> = "\u{feff}never x > 3\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    folder.write("wide.rv", &wide);
    for command in ["check latin.rv run.csv", "fmt --check latin.rv", "explain latin.rv"] {
        let run = folder.lapwing(command);
        let said = "error: latin.rv: line 2, column 6: the byte 0xe9 is not UTF-8; save the file as UTF-8\n";
        assert_eq!((run.code, &*run.stderr), (2, said), "{command}");
    }
    assert_eq!(folder.lapwing("check wide.rv run.csv").stderr, "error: wide.rv: it is UTF-16 text; save it as UTF-8\n");
}
