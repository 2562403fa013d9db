//! The renderers on one report that has a bit of everything.

use expect_test::{Expect, expect};
use lapwing_stream::{Time, Value, Verdict};

use crate::*;

fn reading(name: &str, value: impl Into<Value>) -> Reading {
    Reading { name: name.into(), value: value.into() }
}

fn property(line: usize, text: &str, verdict: Verdict) -> Property {
    Property {
        name: format!("line {line}"),
        file: "stop.rv".into(),
        line,
        column: 1,
        text: text.into(),
        verdict,
        cause: None,
        vacuous: false,
        obligations: Obligations::default(),
        margin: None,
        violations: Vec::new(),
        scopes: Vec::new(),
        nans: 0,
        unmet_since: None,
        at_end: Vec::new(),
        reactions: Vec::new(),
        hints: Vec::new(),
    }
}

fn stop_sign() -> Property {
    let values = |d: f64, v: f64| vec![reading("robot.distance.stop_sign", d), reading("robot.velocity", v)];
    let row = |ms: i64, d: f64, v: f64| Row { time: Time(ms * 1_000_000), values: vec![Value::Num(d), Value::Num(v)] };
    let text = "after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1, eventually\nrobot.velocity == 0";
    Property {
        obligations: Obligations { met: 1, failed: 2, open: 0 },
        violations: vec![
            Violation {
                began: Time(12_400_000_000),
                failed: Time(15_100_000_000),
                until: Time(15_100_000_000),
                count: 1,
                values: Some(values(1.000545118597548, 0.17758309727799252)),
                began_values: Some(values(0.9998, 0.61)),
                history: vec![row(12_400, 0.9998, 0.61), row(15_000, 0.97, 0.21)],
                why: None,
            },
            Violation {
                began: Time(17_000_000_000),
                failed: Time(18_000_000_000),
                until: Time(18_000_000_000),
                count: 1,
                values: Some(values(1.1, f64::INFINITY)),
                began_values: None,
                history: Vec::new(),
                why: None,
            },
        ],
        reactions: vec!["would publish /cmd_vel geometry_msgs/Twist".into()],
        hints: vec!["the brakes".into()],
        ..property(3, text, Verdict::Violated)
    }
}

fn sample() -> Report {
    Report {
        specs: vec!["stop.rv".into()],
        trace: "run.mcap".into(),
        span: Some((Time(0), Time(20_000_000_000))),
        instants: 801,
        topics: vec![
            Topic { name: "/odom".into(), type_name: Some("nav_msgs/Odometry".into()), messages: 600, unseen: 3 },
            Topic { name: "/gt".into(), type_name: None, messages: 200, unseen: 0 },
        ],
        properties: vec![
            stop_sign(),
            Property {
                obligations: Obligations { met: 801, failed: 0, open: 0 },
                vacuous: true,
                scopes: vec![Scope { text: "whenever honk".into(), entered: 0 }],
                ..property(6, "whenever honk, lights", Verdict::Holds)
            },
            Property { cause: Some("no message on /scan".into()), nans: 2, ..property(8, "never scan < 1", Verdict::Inconclusive) },
            Property {
                unmet_since: Some(Time(0)),
                at_end: vec![reading("goal", false)],
                ..property(9, "eventually goal", Verdict::Unmet)
            },
        ],
        warnings: vec![Warning::plain("time jumped back from 3 s to 1 s")],
        gaps: vec!["run.mcap, byte 12: the file breaks off".into()],
    }
}

fn check(actual: &str, expected: Expect) {
    expected.assert_eq(actual);
}

#[test]
fn text() {
    check(&render(&sample(), Format::Text, Style::Plain), expect![[""]]);
    let mut tally = Tally::default();
    tally.add(&sample());
    check(&end(&tally, Format::Text, Style::Plain), expect![[""]]);
}

#[test]
fn json() {
    let value: serde_json::Value = serde_json::from_str(&render(&sample(), Format::Json, Style::Plain)).unwrap();
    check(&format!("{value:#}\n"), expect![[""]]);
}

#[test]
fn ndjson() {
    let report = sample();
    let property = &report.properties[0];
    let events = [
        Event::Start(&report),
        Event::Violation { property, violation: &property.violations[0] },
        Event::Warning(&report.warnings[0]),
        Event::Verdict(&report.properties[3]),
        Event::End(&report),
    ];
    check(&events.map(|e| line(&report.trace, e)).concat(), expect![[""]]);
}

#[test]
fn junit() {
    let mut report = sample();
    report.properties[2].cause = Some("a \u{0} byte & <more>".into());
    let text = format!("{}{}{}", Format::Junit.begin(), render(&report, Format::Junit, Style::Plain), end(&Tally::default(), Format::Junit, Style::Plain));
    check(&text, expect![[""]]);
}

#[test]
fn one_failure_is_worse_than_any_doubt() {
    let of = |verdicts: &[Verdict], gap: bool| {
        let properties = verdicts.iter().map(|v| property(1, "p", *v)).collect();
        let gaps = if gap { vec!["broke off".to_owned()] } else { Vec::new() };
        Report { properties, gaps, ..Report::default() }.standing()
    };
    assert_eq!(of(&[], false), Standing::Good);
    assert_eq!(of(&[Verdict::Holds, Verdict::Satisfied], false), Standing::Good);
    assert_eq!(of(&[Verdict::Holds], true), Standing::Open);
    assert_eq!(of(&[Verdict::Holds, Verdict::Inconclusive], false), Standing::Open);
    assert_eq!(of(&[Verdict::Inconclusive, Verdict::Unmet], true), Standing::Failed);
    assert_eq!(of(&[Verdict::Violated, Verdict::Holds], false), Standing::Failed);
}
