//! What `lapwing check` takes and how it goes about it.

mod common;

use common::{Folder, stop_sign, table};
use serde_json::Value;

/// Eight recordings; in the odd ones `x` goes too far.
fn campaign() -> Folder {
    let folder = Folder::new(&[("spec.rv", "never x > 5\nnever z > 5\n")]);
    for n in 0..8 {
        let rows: Vec<(f64, f64)> = (0..50).map(|k| (f64::from(k) * 0.1, f64::from(k * (n % 2)) * 0.2)).collect();
        folder.write(&format!("runs/{n}.csv"), table("x", &rows).as_bytes());
    }
    folder
}

#[test]
fn the_number_of_jobs_makes_no_difference() {
    let folder = campaign();
    for format in ["text", "json", "ndjson", "junit"] {
        let run = |jobs| folder.lapwing(&format!("check spec.rv runs --format {format} --jobs {jobs}"));
        let (one, two, many) = (run(1), run(2), run(8));
        assert_eq!(one.stdout, two.stdout);
        assert_eq!(one.stdout, many.stdout);
        assert_eq!((one.stderr, one.code), (many.stderr, many.code));
    }
}

#[test]
fn shards_share_the_recordings() {
    let folder = campaign();
    let traces = |shard: &str| -> Vec<String> {
        let run = folder.lapwing(&format!("check spec.rv runs/*.csv --format json --shard {shard}"));
        let reports: Value = serde_json::from_str(&run.stdout).unwrap();
        reports.as_array().unwrap().iter().map(|r| r["trace"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(traces("1/3"), ["runs/0.csv", "runs/3.csv", "runs/6.csv"]);
    assert_eq!(traces("2/3"), ["runs/1.csv", "runs/4.csv", "runs/7.csv"]);
    assert_eq!(traces("3/3"), ["runs/2.csv", "runs/5.csv"]);
    assert!(traces("9/9").is_empty());
}

#[test]
fn signals_that_are_conditions_are_shown_with_their_values() {
    let files = [
        ("spec.rv", "bare: x\nboth: always (y and x)\nnever_y: whenever y, never y\n"),
        ("run.csv", "time,x,y\n0,-0.0,true\n1,nan,true\n"),
    ];
    let folder = Folder::new(&files);
    let run = folder.lapwing("check spec.rv run.csv --format json");
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    let values = |property: usize| report[0]["properties"][property]["violations"][0]["values"].to_string();
    assert_eq!(values(0), r#"{"x":-0.0}"#);
    assert_eq!(values(1), r#"{"y":true,"x":-0.0}"#);
    assert_eq!(values(2), r#"{"y":true}"#);
}

#[test]
fn a_field_of_messages_that_nothing_declares_is_proposed() {
    let message = |time: u32, ty: &str| {
        format!(
            "{{\"t\": {time}, \"topic\": \"/odom\"{ty}, \"msg\": {{\"id\": [1], \"deep\": {{\"low\": 2}}, \"speed\": 1}}}}\n"
        )
    };
    let lines = |ty: &str| message(0, ty) + &message(1, ty);
    let typed = lines(", \"type\": \"my/Odo\"");
    let folder = Folder::new(&[("bare.ndjson", &lines("")), ("typed.ndjson", &typed)]);
    for (recording, name, line) in [
        ("bare.ndjson", "speed", "decl speed /odom TYPE.speed"),
        ("typed.ndjson", "speed", "decl speed /odom my/Odo.speed"),
        ("bare.ndjson", "low", "decl low /odom TYPE.deep.low"),
    ] {
        folder.write("spec.rv", format!("never {name} > 3\n").as_bytes());
        let run = folder.lapwing(&format!("check spec.rv {recording}"));
        assert!(run.code == 3 && run.stdout.contains(&format!("declare it, `{line}`\n")), "{}", run.stdout);
        folder.write("declared.rv", format!("{line}\nnever {name} > 3\n").as_bytes());
        assert_eq!(folder.lapwing(&format!("check declared.rv {recording}")).code, 0, "{line}");
    }
    folder.write("spec.rv", b"never peed > 3\n");
    assert!(!folder.lapwing("check spec.rv bare.ndjson").stdout.contains("decl "));
}

#[test]
fn a_value_of_another_kind_is_named_with_its_time() {
    let files = [
        ("spec.rv", "slow: never x + 1 > 5\nworn: always y\ntwice: count(z > 1, 10 s) < 5\n"),
        ("run.csv", "time,x,y,z\n0,1,true,1\n1.5,n/a,true,1\n2,1,true,1\n3,1,worn,1\n4,1,true,1\n"),
    ];
    let folder = Folder::new(&files);
    let run = folder.lapwing("check spec.rv run.csv --format json");
    let report: Value = serde_json::from_str(&run.stdout).unwrap();
    let told = |n: usize| (&report[0]["properties"][n]["verdict"], &report[0]["properties"][n]["cause"]);
    assert_eq!(
        told(0),
        (&"inconclusive".into(), &"the value of x at 1.5 s was of another kind than the formula needs".into())
    );
    assert_eq!(
        told(1),
        (&"inconclusive".into(), &"the value of y at 3 s was of another kind than the formula needs".into())
    );
    assert_eq!(told(2).0, "holds");
    assert_eq!(run.code, 3);
}

#[test]
fn standard_input_is_read_as_ndjson() {
    let folder = Folder::new(&[("spec.rv", "event kick\nfar: always (kick implies kick.power < 5)\nnever x > 2\n")]);
    let input = concat!(
        "{\"t\": 0, \"values\": {\"x\": 1}}\n",
        "{\"t\": 1, \"event\": \"kick\", \"power\": 3}\n",
        "{\"t\": 2, \"event\": \"kick\", \"power\": 7}\n",
        "{\"t\": 3, \"values\": {\"x\": 3}}\n",
    );
    let run = folder.lapwing_with("check spec.rv - --format ndjson", input);
    let lines: Vec<Value> = run.stdout.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    let violations: Vec<_> = lines
        .iter()
        .filter(|l| l["type"] == "violation")
        .map(|l| (l["name"].as_str(), l["failed_ns"].as_i64()))
        .collect();
    assert_eq!(
        violations,
        [(Some("far"), Some(2_000_000_000)), (Some("line 3"), Some(3_000_000_000))],
        "{}",
        run.stderr
    );
    assert_eq!(run.code, 1);
}

#[test]
fn reading_stops_at_the_first_violation_where_that_is_asked() {
    let folder = campaign();
    let run = folder.lapwing("check spec.rv runs/1.csv --until-first-violation --format json");
    let reports: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(reports[0]["properties"][0]["obligations"]["failed"], 1);
    assert_eq!(reports[0]["gaps"][0], "stopped at the first violation, as asked");
    assert_eq!(run.code, 1);
}

#[test]
fn quiet_leaves_out_what_is_well() {
    let folder = Folder::new(&[("spec.rv", "never x > 5\nlimit = 2\n"), ("run.csv", &table("x", &[(0.0, 1.0)]))]);
    let loud = folder.lapwing("check spec.rv run.csv");
    assert!(loud.stdout.contains("1 holds") && loud.stderr.contains("unused-name"), "{loud:?}");
    let quiet = folder.lapwing("check spec.rv run.csv --quiet");
    assert_eq!((quiet.code, quiet.stdout.as_str(), quiet.stderr.as_str()), (0, "", ""));
}

#[test]
fn names_that_are_almost_right_are_recognised() {
    let folder = Folder::new(&[("robot.rv", "never x > 5\n"), ("run.csv", &table("x", &[(0.0, 1.0)]))]);
    let help = |arguments: &str| folder.lapwing(arguments).stderr;
    assert!(help("chek robot.rv run.csv").contains("'check'"));
    assert!(help("check robt.rv run.csv").contains("did you mean `robot.rv`?"));
    assert!(help("check robot.rv rum.csv").contains("did you mean `run.csv`?"));
    folder.write("other.rv", b"never y > 5\n");
    assert!(help("check robot.rv run.csv other.rv").contains("nothing declares it and no column has this name"));
    folder.write("spec.txt", b"never y > 5\n");
    assert!(help("check robot.rv spec.txt").contains("does not end in .rv"));
    let run = folder.lapwing("check other.rv run.csv");
    assert!(run.stdout.contains("inconclusive") && run.stdout.contains('y'), "{}", run.stdout);
}

#[test]
fn what_a_rate_does_not_see_is_reported() {
    let folder =
        Folder::new(&[("spec.rv", "__rate__ = 5\ndecl v /odom nav_msgs/Odometry.twist.twist.linear.x\nnever v > 9\n")]);
    folder.write("run.mcap", &stop_sign());
    let run = folder.lapwing("check spec.rv run.mcap --format json");
    let reports: Value = serde_json::from_str(&run.stdout).unwrap();
    let topic = &reports[0]["topics"][0];
    assert_eq!((topic["name"].as_str(), topic["type"].as_str()), (Some("/odom"), Some("nav_msgs/Odometry")));
    assert!(topic["unseen"].as_u64().unwrap() * 2 > topic["messages"].as_u64().unwrap());
    assert_eq!(reports[0]["warnings"][0]["code"], "sampling-unseen");
}

#[test]
fn time_that_jumps_back_is_reported() {
    let table = table("x", &[(0.0, 0.0), (5.0, 1.0), (1.0, 1.0), (2.0, 1.0)]);
    let folder = Folder::new(&[("spec.rv", "never x > 5\n"), ("run.csv", &table)]);
    let run = folder.lapwing("check spec.rv run.csv");
    assert!(run.stdout.contains("time jumped back from 5 s to 1 s"), "{}", run.stdout);
    assert!(run.stdout.contains("4 instants") && run.code == 0, "{}", run.stdout);
}

#[test]
fn what_rests_on_a_lost_part_is_not_judged() {
    let folder =
        Folder::new(&[("spec.rv", "never x > 5\nnever x > 0.5\n"), ("run.csv", "time,x\n0,0\noops,1\n2,0\n3,1\n")]);
    let run = folder.lapwing("check spec.rv run.csv --format json");
    let reports: Value = serde_json::from_str(&run.stdout).unwrap();
    let verdicts: Vec<_> = (0..2).map(|k| reports[0]["properties"][k]["verdict"].as_str().unwrap()).collect();
    assert_eq!(verdicts, ["inconclusive", "violated"], "{reports:#}");
    assert!(reports[0]["gaps"][0].as_str().unwrap().contains("run.csv, line 3"), "{reports:#}");
    assert_eq!(run.code, 1);
}

#[test]
#[cfg(unix)]
fn an_interrupt_ends_the_reading_and_what_is_known_is_reported() {
    use std::io::{Read, Write};
    use std::process::{Command, Stdio};

    let folder = Folder::new(&[("spec.rv", "never x > 5\neventually x > 9\n")]);
    let mut child = Command::new(env!("CARGO_BIN_EXE_lapwing"))
        .args(["check", "spec.rv", "-", "--format", "ndjson"])
        .current_dir(folder.path(""))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    let mut output = child.stdout.take().unwrap();
    writeln!(input, "{{\"t\": 0, \"values\": {{\"x\": 1}}}}").unwrap();
    // The first line comes when the recording is open: by then interrupts are listened to.
    let mut first = [0];
    output.read_exact(&mut first).unwrap();
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    std::thread::sleep(std::time::Duration::from_millis(200));
    // It is gone already, or goes now.
    let _ = writeln!(input, "{{\"t\": 1, \"values\": {{\"x\": 2}}}}");
    drop(input);
    let mut rest = String::new();
    output.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(3), "{rest}");
    assert!(rest.contains("\"gaps\":[\"interrupted\"]") && rest.contains("\"verdict\":\"inconclusive\""), "{rest}");
}

#[test]
#[cfg(unix)]
fn nobody_has_to_read_it_all() {
    let folder = campaign();
    let command = format!("{} check spec.rv runs --format ndjson | head -n 1", env!("CARGO_BIN_EXE_lapwing"));
    let run = std::process::Command::new("sh").args(["-c", &command]).current_dir(folder.path("")).output().unwrap();
    assert_eq!(run.stdout.iter().filter(|b| **b == b'\n').count(), 1);
    assert_eq!(String::from_utf8_lossy(&run.stderr).matches("panicked").count(), 0);
}

#[test]
fn an_after_that_has_ceased_is_pointed_out() {
    let folder = Folder::new(&[
        ("spec.rv", "after x > 1, never y > 1\n"),
        ("run.csv", "time,x,y\n0,0,0\n1,2,0\n2,0,0\n3,0,2\n"),
    ]);
    let run = folder.lapwing("check spec.rv run.csv");
    assert!(run.stdout.contains("`while x > 1, never y > 1`"), "{}", run.stdout);
    assert!(run.stdout.contains("`whenever held for 0.5 s (x > 1), never y > 1`"), "{}", run.stdout);
    assert!(run.stdout.contains("warning[latched-after]"), "{}", run.stdout);
    let report = folder.lapwing("check spec.rv run.csv --format json").stdout;
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    let warning = &report[0]["warnings"][0];
    assert_eq!(
        (&warning["code"], &warning["file"], &warning["line"]),
        (&"latched-after".into(), &"spec.rv".into(), &1.into())
    );
}

#[test]
fn reactions_are_told_and_not_carried_out() {
    let folder = Folder::new(&[
        (
            "spec.rv",
            "slow: never x > 1\non violation of slow at most every 1 s {\n    publish /cmd_vel geometry_msgs/Twist { linear: { x: 0.0 } }\n}\n",
        ),
        ("run.csv", &table("x", &[(0.0, 2.0)])),
    ]);
    let run = folder.lapwing("check spec.rv run.csv");
    assert!(run.stdout.contains("would publish /cmd_vel geometry_msgs/Twist, at most every 1 s"), "{}", run.stdout);
}

#[test]
fn instances_and_world_signals_are_shown_by_the_names_of_the_specification() {
    let folder =
        Folder::new(&[("spec.rv", "apart: for each s in (first_sign, second_sign): never car.distance.s < 1.01\n")]);
    folder.write("run.mcap", &stop_sign());
    let run = folder.lapwing("check spec.rv run.mcap --format json");
    let reports: Value = serde_json::from_str(&run.stdout).unwrap();
    let second = &reports[0]["properties"][1];
    assert_eq!(second["name"], "apart[second_sign]");
    let values = second["violations"][0]["values"].as_object().unwrap();
    assert_eq!(values.keys().collect::<Vec<_>>(), ["car.distance.second_sign"]);
    assert!(values["car.distance.second_sign"].as_f64().unwrap() < 1.01);
}

#[test]
fn colours_are_for_those_who_want_them() {
    let folder = campaign();
    assert!(!folder.lapwing("check spec.rv runs/1.csv").stdout.contains('\u{1b}'));
    assert!(folder.lapwing("check spec.rv runs/1.csv --color always").stdout.contains('\u{1b}'));
}

/// The margins of a report, by property.
fn margins(json: &str) -> Vec<Value> {
    let reports: Value = serde_json::from_str(json).unwrap();
    reports[0]["properties"].as_array().unwrap().iter().map(|p| p["margin"].clone()).collect()
}

#[test]
fn margins_say_how_close_it_was() {
    let spec = "never speed > 2.0\nalways speed < 3\nwhenever speed > 2, eventually within 0.2 s speed < 1\n";
    let folder = Folder::new(&[("spec.rv", spec)]);
    let trace = table("speed", &[(0.0, 1.5), (0.1, 2.31), (0.2, 1.25), (0.3, 0.75), (0.4, 1.0)]);
    folder.write("run.csv", trace.as_bytes());
    let run = folder.lapwing("check spec.rv run.csv --margins --format json");
    let found: Vec<f64> = margins(&run.stdout).iter().map(|m| m.as_f64().unwrap()).collect();
    // At 0.1 s the response comes within time, with 0.25 to spare; that is the worst: at the others 2 - speed is greater.
    for (found, expected) in found.iter().zip([-0.31, 0.69, 0.25]) {
        assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
    }
    let text = folder.lapwing("check spec.rv run.csv --margins").stdout;
    assert!(text.contains("margin -0.31") && text.contains("margin 0.25"), "{text}");
}

#[test]
fn without_the_flag_there_is_no_margin() {
    let folder = Folder::new(&[("spec.rv", "never x > 2.0\n"), ("run.csv", &table("x", &[(0.0, 1.5), (0.1, 2.31)]))]);
    let run = folder.lapwing("check spec.rv run.csv --format json");
    assert_eq!(margins(&run.stdout), [Value::Null]);
    assert!(!folder.lapwing("check spec.rv run.csv").stdout.contains("margin"));
}

#[test]
fn margins_that_would_mean_nothing_are_null_or_infinite() {
    // Metres against radians; truth values alone.
    let spec = "always x < 2.0 m or y < 3.0 rad\nalways true or x > 1\n";
    let folder = Folder::new(&[("spec.rv", spec), ("run.csv", "time,x,y\n0,1,1\n1,2,2\n")]);
    let run = folder.lapwing("check spec.rv run.csv --margins --format json");
    assert_eq!(margins(&run.stdout), [Value::Null, Value::from("Infinity")]);
}

#[test]
fn an_instance_over_topics_is_made_for_a_topic_that_appears_late() {
    let message = |t: usize, robot: &str, speed: f64| {
        let msg = format!("{{\"twist\":{{\"twist\":{{\"linear\":{{\"x\":{speed}}}}}}}}}");
        format!("{{\"t\":{t},\"topic\":\"/{robot}/odom\",\"type\":\"nav_msgs/Odometry\",\"msg\":{msg}}}\n")
    };
    // More than the first megabyte, which is all that is looked through for topics where no property runs over them.
    let mut trace: String = (0..20_000).map(|t| message(t, "r1", 1.0)).collect();
    assert!(trace.len() > 1 << 20);
    trace += &message(20_000, "r2", 3.0);
    let folder =
        Folder::new(&[("spec.rv", "v: for each r in topics /{r}/odom: never r.odom.twist.twist.linear.x > 2\n")]);
    folder.write("late.ndjson", trace.as_bytes());
    let run = folder.lapwing("check spec.rv late.ndjson --format json");
    let reports: Value = serde_json::from_str(&run.stdout).unwrap();
    let verdicts: Vec<_> =
        reports[0]["properties"].as_array().unwrap().iter().map(|p| (&p["name"], &p["verdict"])).collect();
    assert_eq!(
        format!("{verdicts:?}"),
        "[(String(\"v[r1]\"), String(\"holds\")), (String(\"v[r2]\"), String(\"violated\"))]"
    );
}

#[test]
fn reactions_write_messages_of_share_trees() {
    let spec = "slow: never x > 1\non violation of slow { publish /stop my_msgs/Stop { hrad: true } }\n";
    let folder = Folder::new(&[("spec.rv", spec), ("run.csv", "time,x\n0,0\n")]);
    folder.write("share/my_msgs/msg/Stop.msg", b"bool hard\n");
    let without = folder.lapwing("check spec.rv run.csv");
    assert!(without.stderr.contains("no definition of my_msgs/Stop is known"), "{}", without.stderr);
    for command in ["check spec.rv run.csv --msgs share", "explain spec.rv --msgs share"] {
        let said = folder.lapwing(command);
        assert!(said.stderr.contains("my_msgs/Stop has no field `hrad`; did you mean `hard`?"), "{}", said.stderr);
        assert_eq!(said.code, 2, "{command}");
    }
}
