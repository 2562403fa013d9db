//! Standard input: checked as it grows, left when the user stops, and read to its end first where its topics must be known.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// One property for each robot that has odometry.
const EACH: &str = "world * topics /{name}/odom Odometry\nfor each r in topics /{r}/odom: never r.velocity > 2\n";

/// A line with the odometry of a robot.
fn odometry(t: f64, robot: &str, speed: f64) -> String {
    let zero = r#"{"x":0,"y":0,"z":0}"#;
    let pose = format!(r#"{{"pose":{{"position":{zero},"orientation":{{"x":0,"y":0,"z":0,"w":1}}}}}}"#);
    let twist = format!(r#"{{"twist":{{"linear":{{"x":{speed},"y":0,"z":0}},"angular":{zero}}}}}"#);
    let message = format!(r#"{{"pose":{pose},"twist":{twist}}}"#);
    format!(r#"{{"t":{t},"topic":"/{robot}/odom","type":"nav_msgs/Odometry","msg":{message}}}"#)
}

/// Checks standard input against a specification, with further arguments.
fn check(spec: &str, more: &[&str]) -> (tempfile::TempDir, Child) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("x.rv");
    std::fs::write(&path, spec).unwrap();
    let child = Command::new(env!("CARGO_BIN_EXE_lapwing"))
        .args(["check", "--color", "never"])
        .args(more)
        .arg(&path)
        .arg("-")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    (dir, child)
}

#[test]
fn topics_that_appear_late_have_instances() {
    let (_dir, mut child) = check(EACH, &["--format", "json"]);
    let mut to = child.stdin.take().unwrap();
    for (t, robot, x) in [(0.0, "r1", 1.0), (1.0, "r1", 1.0), (2.0, "r2", 1.0), (3.0, "r2", 3.0), (4.0, "r1", 1.0)] {
        writeln!(to, "{}", odometry(t, robot, x)).unwrap();
        to.flush().unwrap();
    }
    drop(to);
    let output = child.wait_with_output().unwrap();
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report[0]["trace"], "-");
    let properties = report[0]["properties"].as_array().unwrap();
    let verdicts: Vec<_> =
        properties.iter().map(|p| (p["name"].as_str().unwrap(), p["verdict"].as_str().unwrap())).collect();
    assert_eq!(verdicts, [("line 2[r1]", "holds"), ("line 2[r2]", "violated")], "{report:#}");
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("standard input is read\n         to its end first, and judged then"), "{said}");
}

/// A property over topics, and one that can be judged at once.
#[test]
fn a_table_is_judged_as_it_comes() {
    let spec = "never x > 2\nfor each r in topics /{r}/v: age(/{r}/v) < 5\n";
    let (_dir, mut child) = check(spec, &["--format", "ndjson"]);
    let mut to = child.stdin.take().unwrap();
    to.write_all(b"time,x\n0,3\n").unwrap();
    to.flush().unwrap();
    let mut from = BufReader::new(child.stdout.take().unwrap()).lines();
    // Its input goes on: the answer is there before its end.
    let violation = from.find(|line| line.as_ref().unwrap().contains("\"violation\"")).unwrap().unwrap();
    assert!(violation.contains("\"failed_ns\":0"), "{violation}");
    drop(to);
    assert_eq!(child.wait().unwrap().code(), Some(1));
}

/// What is said of lines on standard input.
fn said_of(spec: &str, lines: &str) -> serde_json::Value {
    let (_dir, mut child) = check(spec, &["--format", "json"]);
    child.stdin.take().unwrap().write_all(lines.as_bytes()).unwrap();
    serde_json::from_slice(&child.wait_with_output().unwrap().stdout).unwrap()
}

#[test]
fn names_that_never_came_were_meant_otherwise() {
    let lines = concat!(
        r#"{"t":1,"values":{"first":1}}"#,
        "\n",
        r#"{"t":2,"values":{"speed":1,"pose":{"x":1,"y":[1,2]}}}"#,
        "\n",
        r#"{"t":3,"event":"kick"}"#,
        "\n",
    );
    let report = said_of(
        concat!("event kik\na: sped < 2\nb: pose.z < frist\n", "d: never kik\ne: never kick > 1\nf: mode < 1\n"),
        lines,
    );
    let causes: Vec<_> = report[0]["properties"].as_array().unwrap().iter().map(|p| p["cause"].as_str()).collect();
    let expected = [
        Some("no value ever came: sped; did you mean `speed`?"),
        Some("no value ever came: pose.z, frist; did you mean `first` for `frist`, `pose.x` for `pose.z`?"),
        None,
        Some("no value ever came: kick; `kick` came as an event: declare it, `event kick`"),
        Some("no value ever came: mode"),
    ];
    assert_eq!(causes, expected, "{report:#}");
    let warnings = report[0]["warnings"].to_string();
    assert!(warnings.contains("no event `kik` came, but `kick` did"), "{report:#}");
    let message = r#"{"t":0,"topic":"/odom","type":"std_msgs/Float64","msg":{"data":1}}"#;
    let report = said_of("decl x /odmo std_msgs/Float64.data\nx < 2\n", message);
    let cause = &report[0]["properties"][0]["cause"];
    assert_eq!(cause, "no value ever came: /odmo; did you mean `/odom`?", "{report:#}");
}

#[test]
fn fields_that_messages_lack_are_named_once_and_topics_that_never_came_too() {
    let spec = concat!(
        "decl a /a geometry_msgs/Twist.linear.x\n",
        "decl b /a geometry_msgs/Twist.linear.z\n",
        "decl c /silent geometry_msgs/Twist.linear.x\n",
        "decl d /silent geometry_msgs/Twist.linear.y\n",
        "decl j /j std_msgs/Float64MultiArray.data\n",
        "p: a + b + a < 1\n",
        "q: c + d < 1\n",
        "r: norm(j) < 1\n",
    );
    let lines = concat!(
        r#"{"t":0,"topic":"/a","msg":{"linear":{"y":1}}}"#,
        "\n",
        r#"{"t":1,"topic":"/j","msg":{"data":[1,2]}}"#,
        "\n",
    );
    let report = said_of(spec, lines);
    let causes: Vec<_> = report[0]["properties"].as_array().unwrap().iter().map(|p| p["cause"].as_str()).collect();
    let expected = [
        Some("no value ever came: /a.linear.x, /a.linear.z"),
        Some("no value ever came: /silent"),
        Some("no value ever came: /j.data.x, /j.data.y, /j.data.z"),
    ];
    assert_eq!(causes, expected, "{report:#}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_a_wait_for_input() {
    for spec in ["never x > 2\n", EACH] {
        let (_dir, mut child) = check(spec, &["--format", "ndjson"]);
        let mut to = child.stdin.take().unwrap();
        writeln!(to, "{{\"t\":0,\"values\":{{\"x\":3}}}}").unwrap();
        writeln!(to, "{}", odometry(1.0, "r1", 1.0)).unwrap();
        to.flush().unwrap();
        let mut from = BufReader::new(child.stdout.take().unwrap()).lines();
        if spec.starts_with("never") {
            let violation = from.find(|line| line.as_ref().unwrap().contains("\"violation\"")).unwrap().unwrap();
            assert!(violation.contains("\"failed_ns\":0"), "{violation}");
        } else {
            // Nothing is said before the end of the input: give the program time to begin.
            std::thread::sleep(Duration::from_millis(500));
        }
        let start = Instant::now();
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
        let status = child.wait().unwrap();
        assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
        let rest: Vec<String> = from.map(Result::unwrap).collect();
        let verdict = rest.iter().find(|line| line.contains("\"type\":\"verdict\"")).unwrap();
        let (code, word) = if spec.starts_with("never") { (1, "violated") } else { (3, "inconclusive") };
        assert!(verdict.contains(&format!("\"verdict\":\"{word}\"")), "{verdict}");
        assert_eq!(status.code(), Some(code), "{rest:?}");
        drop(to);
    }
}

#[test]
fn a_declared_signal_is_the_value_of_its_name() {
    let (_dir, mut child) = check("decl speed /odom Odometry.twist.twist.linear.x\nnever speed > 2\n", &[]);
    let mut to = child.stdin.take().unwrap();
    to.write_all(b"{\"t\":0,\"values\":{\"speed\":1}}\n{\"t\":1,\"values\":{\"speed\":3}}\n").unwrap();
    drop(to);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stdout));
}

#[test]
fn a_table_without_rows_has_its_columns_however_far_one_looks() {
    let spec = "xx > 0\nfresh: for each r in topics /{r}/v: age(/{r}/v) < 5\n";
    let (_dir, mut child) = check(spec, &[]);
    child.stdin.take().unwrap().write_all(b"time,xy\n").unwrap();
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("the recording has `xy`"), "{said}");
}
