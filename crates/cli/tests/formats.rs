//! The formats of reports, each read back.

mod common;

use common::{Folder, stop_sign, table};
use expect_test::expect;
use quick_xml::events::Event;
use serde_json::{Value, json};

const SPEC: &str = "never robot.velocity > 2.0  # too fast\nslow: eventually within 1 s robot.velocity < 1\n";

fn folder() -> Folder {
    let rows = [(0.0, 1.5), (0.5, 2.25), (1.0, 2.5), (1.5, 1.0), (2.0, 3.0)];
    Folder::new(&[("spec.rv", SPEC), ("run.csv", &table("robot.velocity", &rows))])
}

#[test]
fn text() {
    let run = folder().lapwing("check spec.rv run.csv");
    expect![[r#"
        Error at line 1:
          never robot.velocity > 2.0
        Failing state:
          robot.velocity: 2.25
        Failed at 0.5 s.
        What led to it:
           time  robot.velocity
            0 s             1.5
          0.5 s            2.25  failed
        3 failures in 2 episodes; 2 met.
          again at 2 s (1 failure)
        Where: spec.rv:1:1 (line 1), run.csv

        Error at line 2:
          slow: eventually within 1 s robot.velocity < 1
        Failing state:
          robot.velocity: 2.5
        Failed at 1 s; what failed began at 0 s, 1 s earlier.
        What led to it:
           time  robot.velocity
            0 s             1.5  began
          0.5 s            2.25
            1 s             2.5  failed
        1 failure; 0 met.
        Where: spec.rv:2:1 (slow), run.csv

        run.csv: 2 s, 5 instants
          violated      line 1  3 failures in 2 episodes, first at 0.5 s
          violated      slow    1 failure in 1 episode, first at 1 s

        2 violated
    "#]]
    .assert_eq(&run.stdout);
    assert_eq!(run.code, 1);
}

#[test]
fn json() {
    let run = folder().lapwing("check spec.rv run.csv --format json");
    let reports: Value = serde_json::from_str(&run.stdout).unwrap();
    // What is judged as a whole is no value; a part of it is.
    let slow = |v: f64| json!({"robot.velocity": v, "robot.velocity < 1": v < 1.0});
    let speed = |v: f64| json!({"robot.velocity": v});
    type Values<'v> = &'v dyn Fn(f64) -> Value;
    let episode = |values: Values, (began, failed, until, count): (i64, i64, i64, u64), v, before: &[(i64, f64)]| {
        let at_beginning = before.iter().find(|(time, _)| *time == began).map_or(v, |(_, v)| *v);
        let row = |(time, v): &(i64, f64)| json!({"time_ns": time, "values": values(*v)});
        json!({
            "began_ns": began, "failed_ns": failed, "until_ns": until, "count": count,
            "values": values(v), "began_values": values(at_beginning),
            "history": before.iter().map(row).collect::<Vec<_>>()
        })
    };
    let rows = [(0, 1.5), (500_000_000, 2.25), (1_000_000_000, 2.5), (1_500_000_000, 1.0)];
    let expected = json!([{
        "lapwing": 1, "spec": ["spec.rv"], "trace": "run.csv",
        "start_ns": 0, "end_ns": 2_000_000_000_i64, "instants": 5, "topics": [],
        "properties": [
            {
                "name": "line 1", "file": "spec.rv", "line": 1, "text": "never robot.velocity > 2.0",
                "verdict": "violated", "cause": null, "vacuous": false,
                "obligations": {"met": 2, "failed": 3, "open": 0}, "margin": null,
                "violations": [
                    episode(&speed, (500_000_000, 500_000_000, 1_000_000_000, 2), 2.25, &rows[..1]),
                    episode(&speed, (2_000_000_000, 2_000_000_000, 2_000_000_000, 1), 3.0, &rows[2..]),
                ],
                "nans": 0
            },
            {
                "name": "slow", "file": "spec.rv", "line": 2, "text": "slow: eventually within 1 s robot.velocity < 1",
                "verdict": "violated", "cause": null, "vacuous": false,
                "obligations": {"met": 0, "failed": 1, "open": 0}, "margin": null,
                "violations": [episode(&slow, (0, 1_000_000_000, 1_000_000_000, 1), 2.5, &rows[..3])],
                "nans": 0
            }
        ],
        "warnings": [], "gaps": []
    }]);
    assert_eq!(reports, expected, "{reports:#}");
    let keys = reports[0]["properties"][0].as_object().unwrap().keys().take(9).cloned().collect::<Vec<_>>();
    assert_eq!(keys, ["name", "file", "line", "text", "verdict", "cause", "vacuous", "obligations", "margin"]);
}

#[test]
fn several_recordings_are_one_array() {
    let folder = folder();
    folder.write("b.csv", folder.read("run.csv").as_bytes());
    let run = folder.lapwing("check spec.rv run.csv b.csv --format json");
    let reports: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!((&reports[0]["trace"], &reports[1]["trace"]), (&json!("run.csv"), &json!("b.csv")));
}

#[test]
fn several_specifications_are_one_object_with_a_clock_each() {
    let folder = folder();
    folder.write("rate.rv", b"__rate__ = 1\nnever robot.velocity > 2.0\n");
    let run = folder.lapwing("check spec.rv rate.rv run.csv --format json");
    let reports: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(reports.as_array().unwrap().len(), 1);
    assert_eq!(reports[0]["spec"], json!(["spec.rv", "rate.rv"]));
    let properties = reports[0]["properties"].as_array().unwrap();
    let told: Vec<_> = properties
        .iter()
        .map(|p| (p["file"].as_str().unwrap(), p["obligations"]["failed"].as_u64().unwrap()))
        .collect();
    assert_eq!(told, [("spec.rv", 3), ("spec.rv", 1), ("rate.rv", 2)]);
}

#[test]
fn ndjson_tells_things_as_they_happen() {
    let run = folder().lapwing("check spec.rv run.csv --format ndjson");
    let lines: Vec<Value> = run.stdout.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    let told: Vec<_> = lines.iter().map(|l| (l["type"].as_str().unwrap(), l["name"].as_str().unwrap_or(""))).collect();
    let violations = [("violation", "line 1"), ("violation", "slow"), ("violation", "line 1")];
    assert_eq!(told[0], ("start", ""));
    assert_eq!(told[1..4], violations);
    assert_eq!(told[4..], [("verdict", "line 1"), ("verdict", "slow"), ("end", "")]);
    assert!(lines.iter().all(|l| l["trace"] == "run.csv"));
    assert_eq!(lines[2]["failed_ns"], 1_000_000_000);
    assert_eq!(lines[4]["violations"].as_array().unwrap().len(), 2);
    assert_eq!(lines[6]["instants"], 5);
}

#[test]
fn junit_has_a_suite_per_recording_and_a_case_per_property() {
    let folder =
        Folder::new(&[("spec.rv", "never car.velocity > 1\nnever car.velocity > 9\nnever ghost.velocity > 1\n")]);
    folder.write("run.mcap", &stop_sign());
    let run = folder.lapwing("check spec.rv run.mcap --format junit");
    let mut reader = quick_xml::Reader::from_str(&run.stdout);
    let mut found = Vec::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Start(element) => {
                let name = element.name().as_ref().to_owned();
                let of = element.try_get_attribute("name").unwrap().map(|a| a.value.into_owned());
                found.push((name, of.unwrap_or_default()));
            }
            Event::Eof => break,
            _ => {}
        }
    }
    let found: Vec<_> = found.iter().map(|(a, b)| (a.as_str(), b.as_str())).collect();
    let expected = [
        ("testsuites", "lapwing"),
        ("testsuite", "run.mcap"),
        ("testcase", "line 1"),
        ("failure", ""),
        ("testcase", "line 2"),
        ("system-out", ""),
        ("testcase", "line 3"),
        ("error", ""),
    ];
    assert_eq!(found[..8], expected, "{}", run.stdout);
}

/// What `never` denies, and a number that is a condition, are shown with the values that their signals have.
#[test]
fn values_are_those_of_the_signals() {
    let spec = "a: whenever p, never q\nb: x\nc: p implies next never q\n";
    let folder = Folder::new(&[("spec.rv", spec), ("run.csv", "time,p,q,x\n0,true,true,1\n1,false,true,-0\n")]);
    let report: Value = serde_json::from_str(&folder.lapwing("check spec.rv run.csv --format json").stdout).unwrap();
    let values = |i: usize| report[0]["properties"][i]["violations"][0]["values"].clone();
    assert_eq!(values(0), json!({"p": true, "q": true}));
    assert_eq!(values(1), json!({"x": 0.0}));
    assert_eq!(values(2), json!({"p": false, "q": true}));
}

/// The parts of a formula have values as its signals do, and each episode has them, also where several fail at once.
#[test]
fn every_episode_has_the_values_of_all_parts() {
    let spec = "a: @{x, -1} > 7\nb: whenever p, x > 5\nc: before x > 8, p\n";
    let folder = Folder::new(&[
        ("spec.rv", spec),
        ("run.csv", "time,p,x\n0,true,1\n1,false,4\n2,true,6\n3,false,7\n4,true,9\n"),
    ]);
    let report: Value = serde_json::from_str(&folder.lapwing("check spec.rv run.csv --format json").stdout).unwrap();
    let violation = |i: usize, k: usize| report[0]["properties"][i]["violations"][k].clone();
    assert_eq!(violation(0, 0)["values"], json!({"@{x, -1}": 1.0, "x": 4.0}));
    assert_eq!(violation(1, 0)["values"], json!({"p": true, "x": 1.0, "x > 5": false}));
    let both = [violation(2, 0), violation(2, 1)];
    assert_eq!(both.clone().map(|v| v["failed_ns"].clone()), [json!(4_000_000_000_i64), json!(4_000_000_000_i64)]);
    assert_eq!(both.clone().map(|v| v["values"]["x"].clone()), [json!(9.0), json!(9.0)]);
    assert_eq!(both.map(|v| v["began_values"]["x"].clone()), [json!(4.0), json!(7.0)]);
}

/// Of instants with one stamp it is the one at which the obligation began that says what was so then.
#[test]
fn values_at_the_beginning_are_those_of_its_own_instant() {
    let spec = "a: whenever p, eventually within 1 s x > 5\nb: whenever p, next x > 5\n";
    let run = "time,p,x\n0,true,1\n0,false,2\n0,false,3\n1,true,4\n3,false,2\n";
    let folder = Folder::new(&[("spec.rv", spec), ("run.csv", run)]);
    let report: Value = serde_json::from_str(&folder.lapwing("check spec.rv run.csv --format json").stdout).unwrap();
    let began = |i: usize, k: usize| {
        let values = &report[0]["properties"][i]["violations"][k]["began_values"];
        (values["p"].clone(), values["x"].clone())
    };
    let expected = [(json!(true), json!(1.0)), (json!(true), json!(4.0))];
    assert_eq!([[began(0, 0), began(0, 1)], [began(1, 0), began(1, 1)]], [expected.clone(), expected]);
}

/// A property that has more open than `--open-limit` allows cannot be judged; the others can.
#[test]
fn a_limit_on_what_is_open_can_be_set() {
    let rows: String = (0..40).map(|t| format!("{t},{},false\n", t % 2 == 0)).collect();
    let spec = "a: whenever p, eventually q\nb: never q\n";
    let folder = Folder::new(&[("spec.rv", spec), ("run.csv", &format!("time,p,q\n{rows}"))]);
    let verdicts = |limit: &str| -> Vec<(Value, Value)> {
        let run = folder.lapwing(&format!("check spec.rv run.csv --format json {limit}"));
        let report: Value = serde_json::from_str(&run.stdout).unwrap();
        let properties = report[0]["properties"].as_array().unwrap().iter();
        properties.map(|p| (p["verdict"].clone(), p["cause"].clone())).collect()
    };
    let holds = (json!("holds"), Value::Null);
    assert_eq!(verdicts(""), [(json!("unmet"), Value::Null), holds.clone()]);
    let cause = "more than 10 runs of obligations were open at once";
    assert_eq!(verdicts("--open-limit 10"), [(json!("inconclusive"), json!(cause)), holds]);
    assert_eq!(folder.lapwing("check spec.rv run.csv --open-limit 0").code, 2);
}
