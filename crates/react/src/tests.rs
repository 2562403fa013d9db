//! The renderers on one report that has a bit of everything.

use expect_test::{Expect, expect};
use lapwing_stream::{Time, Value, Verdict};

use crate::*;

fn reading(name: &str, value: impl Into<Value>) -> Reading {
    Reading { name: name.into(), value: value.into(), role: Role::Value }
}

fn property(line: usize, text: &str, verdict: Verdict) -> Property {
    Property { verdict, ..Property::new(&format!("line {line}"), "stop.rv", (line, 1), text) }
}

fn stop_sign() -> Property {
    let values = |d: f64, v: f64| vec![reading("robot.distance.stop_sign", d), reading("robot.velocity", v)];
    let row = |ms: i64, d: f64, v: f64| Row { time: Time(ms * 1_000_000), values: vec![Value::Num(d), Value::Num(v)] };
    let text =
        "after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1, eventually\nrobot.velocity == 0";
    Property {
        obligations: Obligations { met: 1, failed: 2, open: 0 },
        violations: vec![
            Violation {
                began: Time(12_400_000_000),
                failed: Time(15_100_000_000),
                until: Time(15_100_000_000),
                count: 1,
                values: Some(values(1.000545118597548, 0.1775830972779925)),
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
            Property {
                cause: Some("no message on /scan".into()),
                nans: 2,
                ..property(8, "never scan < 1", Verdict::Inconclusive)
            },
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
    check(
        &render(&sample(), Format::Text, Style::Plain),
        expect![[r#"
        Error at line 3:
          after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1, eventually
          robot.velocity == 0
        Failing state:
          robot.distance.stop_sign: 1.000545118597548
          robot.velocity: 0.1775830972779925
        Failed at 15.1 s; what failed began at 12.4 s, 2.7 s earlier.
        What led to it:
            time  robot.distance.stop_sign  robot.velocity
          12.4 s                    0.9998            0.61  began
            15 s                      0.97            0.21
          15.1 s                    1.0005         0.17758  failed
        2 failures in 2 episodes; 1 met.
          again at 18 s (1 failure)
        On a live robot: would publish /cmd_vel geometry_msgs/Twist
        Look at: the brakes
        Where: stop.rv:3:1 (line 3), run.mcap

        Error at line 9:
          eventually goal
        State at the end:
          goal: false
        What had to happen did not happen before the recording ended at 20 s. It was due since 0 s.
        Where: stop.rv:9:1 (line 9), run.mcap

        run.mcap: 20 s, 800 messages of 2 topics, 801 instants
          violated      line 3  2 failures in 2 episodes, first at 15.1 s
          holds         line 6  met 801 times; vacuous, never triggered: `whenever honk`
          inconclusive  line 8  no message on /scan; 2 comparisons met NaN, which is never true
          unmet         line 9  what had to happen did not happen before the recording ended
          /odom: 3 of 600 messages came between two instants and went unseen
          not everything was looked at: run.mcap, byte 12: the file breaks off
          warning: time jumped back from 3 s to 1 s
    "#]],
    );
    let mut tally = Tally::default();
    tally.add(&sample());
    check(
        &end(&tally, Format::Text, Style::Plain),
        expect![[r#"

        1 violated, 1 unmet, 1 inconclusive, 1 holds, 1 vacuous, 1 recording not read whole
    "#]],
    );
}

#[test]
fn json() {
    let value: serde_json::Value = serde_json::from_str(&render(&sample(), Format::Json, Style::Plain)).unwrap();
    check(
        &format!("{value:#}\n"),
        expect![[r#"
        {
          "lapwing": 1,
          "spec": [
            "stop.rv"
          ],
          "trace": "run.mcap",
          "start_ns": 0,
          "end_ns": 20000000000,
          "instants": 801,
          "topics": [
            {
              "name": "/odom",
              "type": "nav_msgs/Odometry",
              "messages": 600,
              "unseen": 3
            },
            {
              "name": "/gt",
              "type": null,
              "messages": 200,
              "unseen": 0
            }
          ],
          "properties": [
            {
              "name": "line 3",
              "file": "stop.rv",
              "line": 3,
              "text": "after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1, eventually\nrobot.velocity == 0",
              "verdict": "violated",
              "cause": null,
              "vacuous": false,
              "obligations": {
                "met": 1,
                "failed": 2,
                "open": 0
              },
              "margin": null,
              "violations": [
                {
                  "began_ns": 12400000000,
                  "failed_ns": 15100000000,
                  "until_ns": 15100000000,
                  "count": 1,
                  "values": {
                    "robot.distance.stop_sign": 1.000545118597548,
                    "robot.velocity": 0.1775830972779925
                  },
                  "began_values": {
                    "robot.distance.stop_sign": 0.9998,
                    "robot.velocity": 0.61
                  },
                  "history": [
                    {
                      "time_ns": 12400000000,
                      "values": {
                        "robot.distance.stop_sign": 0.9998,
                        "robot.velocity": 0.61
                      }
                    },
                    {
                      "time_ns": 15000000000,
                      "values": {
                        "robot.distance.stop_sign": 0.97,
                        "robot.velocity": 0.21
                      }
                    }
                  ]
                },
                {
                  "began_ns": 17000000000,
                  "failed_ns": 18000000000,
                  "until_ns": 18000000000,
                  "count": 1,
                  "values": {
                    "robot.distance.stop_sign": 1.1,
                    "robot.velocity": "Infinity"
                  },
                  "began_values": null
                }
              ],
              "nans": 0
            },
            {
              "name": "line 6",
              "file": "stop.rv",
              "line": 6,
              "text": "whenever honk, lights",
              "verdict": "holds",
              "cause": null,
              "vacuous": true,
              "obligations": {
                "met": 801,
                "failed": 0,
                "open": 0
              },
              "margin": null,
              "violations": [],
              "nans": 0
            },
            {
              "name": "line 8",
              "file": "stop.rv",
              "line": 8,
              "text": "never scan < 1",
              "verdict": "inconclusive",
              "cause": "no message on /scan",
              "vacuous": false,
              "obligations": {
                "met": 0,
                "failed": 0,
                "open": 0
              },
              "margin": null,
              "violations": [],
              "nans": 2
            },
            {
              "name": "line 9",
              "file": "stop.rv",
              "line": 9,
              "text": "eventually goal",
              "verdict": "unmet",
              "cause": null,
              "vacuous": false,
              "obligations": {
                "met": 0,
                "failed": 0,
                "open": 0
              },
              "margin": null,
              "violations": [],
              "nans": 0
            }
          ],
          "warnings": [
            {
              "code": null,
              "message": "time jumped back from 3 s to 1 s",
              "file": null,
              "line": null
            }
          ],
          "gaps": [
            "run.mcap, byte 12: the file breaks off"
          ]
        }
    "#]],
    );
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
    check(
        &events.map(|e| line(&report.trace, e)).concat(),
        expect![[r#"
        {"type":"start","lapwing":1,"spec":["stop.rv"],"trace":"run.mcap","topics":[{"name":"/odom","type":"nav_msgs/Odometry"},{"name":"/gt","type":null}],"properties":[{"name":"line 3","file":"stop.rv","line":3,"text":"after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1, eventually\nrobot.velocity == 0"},{"name":"line 6","file":"stop.rv","line":6,"text":"whenever honk, lights"},{"name":"line 8","file":"stop.rv","line":8,"text":"never scan < 1"},{"name":"line 9","file":"stop.rv","line":9,"text":"eventually goal"}]}
        {"type":"violation","trace":"run.mcap","name":"line 3","file":"stop.rv","line":3,"text":"after_until robot.distance.stop_sign < 1, robot.distance.stop_sign > 1, eventually\nrobot.velocity == 0","began_ns":12400000000,"failed_ns":15100000000,"until_ns":15100000000,"count":1,"values":{"robot.distance.stop_sign":1.000545118597548,"robot.velocity":0.1775830972779925},"began_values":{"robot.distance.stop_sign":0.9998,"robot.velocity":0.61},"history":[{"time_ns":12400000000,"values":{"robot.distance.stop_sign":0.9998,"robot.velocity":0.61}},{"time_ns":15000000000,"values":{"robot.distance.stop_sign":0.97,"robot.velocity":0.21}}]}
        {"type":"warning","trace":"run.mcap","code":null,"message":"time jumped back from 3 s to 1 s","file":null,"line":null}
        {"type":"verdict","trace":"run.mcap","name":"line 9","file":"stop.rv","line":9,"text":"eventually goal","verdict":"unmet","cause":null,"vacuous":false,"obligations":{"met":0,"failed":0,"open":0},"margin":null,"violations":[],"nans":0}
        {"type":"end","trace":"run.mcap","start_ns":0,"end_ns":20000000000,"instants":801,"topics":[{"name":"/odom","type":"nav_msgs/Odometry","messages":600,"unseen":3},{"name":"/gt","type":null,"messages":200,"unseen":0}],"gaps":["run.mcap, byte 12: the file breaks off"]}
    "#]],
    );
}

#[test]
fn junit() {
    let mut report = sample();
    report.properties[2].cause = Some("a \u{0} byte & <more>".into());
    let text = format!(
        "{}{}{}",
        Format::Junit.begin(),
        render(&report, Format::Junit, Style::Plain),
        end(&Tally::default(), Format::Junit, Style::Plain)
    );
    check(
        &text,
        expect![[r#"
        <?xml version="1.0" encoding="UTF-8"?>
        <testsuites name="lapwing">
        <testsuite name="run.mcap" tests="4" failures="2" errors="1" time="20.000">
          <testcase name="line 3" classname="stop.rv" file="stop.rv" line="3">
            <failure message="violated: 2 failures in 2 episodes, first at 15.1 s" type="violated">Error at line 3:
          after_until robot.distance.stop_sign &lt; 1, robot.distance.stop_sign &gt; 1, eventually
          robot.velocity == 0
        Failing state:
          robot.distance.stop_sign: 1.000545118597548
          robot.velocity: 0.1775830972779925
        Failed at 15.1 s; what failed began at 12.4 s, 2.7 s earlier.
        What led to it:
            time  robot.distance.stop_sign  robot.velocity
          12.4 s                    0.9998            0.61  began
            15 s                      0.97            0.21
          15.1 s                    1.0005         0.17758  failed
        2 failures in 2 episodes; 1 met.
          again at 18 s (1 failure)
        On a live robot: would publish /cmd_vel geometry_msgs/Twist
        Look at: the brakes
        Where: stop.rv:3:1 (line 3), run.mcap
        </failure>
          </testcase>
          <testcase name="line 6" classname="stop.rv" file="stop.rv" line="6">
            <system-out>holds: met 801 times; vacuous, never triggered: `whenever honk`</system-out>
          </testcase>
          <testcase name="line 8" classname="stop.rv" file="stop.rv" line="8">
            <error message="inconclusive: a � byte &amp; &lt;more&gt;; 2 comparisons met NaN, which is never true" type="inconclusive">Not judged, line 8:
          never scan &lt; 1
        a � byte &amp; &lt;more&gt;
        Where: stop.rv:8:1 (line 8), run.mcap
        </error>
          </testcase>
          <testcase name="line 9" classname="stop.rv" file="stop.rv" line="9">
            <failure message="unmet: what had to happen did not happen before the recording ended" type="unmet">Error at line 9:
          eventually goal
        State at the end:
          goal: false
        What had to happen did not happen before the recording ended at 20 s. It was due since 0 s.
        Where: stop.rv:9:1 (line 9), run.mcap
        </failure>
          </testcase>
          <system-out>  /odom: 3 of 600 messages came between two instants and went unseen
          not everything was looked at: run.mcap, byte 12: the file breaks off
          warning: time jumped back from 3 s to 1 s
        </system-out>
        </testsuite>
        </testsuites>
    "#]],
    );
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

#[test]
fn of_many_losses_the_first_and_the_last_are_told_and_the_others_counted() {
    let shown = |losses: usize| {
        let gaps = (1..=losses).map(|line| format!("run.csv, line {line}: the line is lost")).collect();
        text::remarks(&Report { gaps, topics: vec![], warnings: vec![], ..sample() })
    };
    assert_eq!(shown(10).lines().count(), 10);
    let many = shown(1_000);
    let last = [
        "  not everything was looked at: run.csv, line 9: the line is lost",
        "  not everything was looked at: 990 more like these, which `--format json` lists",
        "  not everything was looked at: run.csv, line 1000: the line is lost",
    ];
    assert_eq!(many.lines().skip(8).collect::<Vec<_>>(), last);
}
