//! Reports to draw: a robot on a drive, and one whose names are hostile.

use lapwing_draw::{Graph, Shape as Node};
use lapwing_react::history::{Course, History, Limit, Mark, Phase, Piece, Plot, Shape, Stand, Track};
use lapwing_react::{Obligations, Property, Reading, Report, Scope, Topic, Violation, Warning};
use lapwing_stream::{Time, Value, Verdict};

/// The length of the drive, in seconds.
const LENGTH: f64 = 30.0;

pub fn at(seconds: f64) -> Time {
    Time((seconds * 1e9).round() as i64)
}

/// A drive with a bit of everything.
pub fn drive() -> (Report, History) {
    let speed = |t: f64| 1.6 + 0.5 * (t * 0.7).sin() + if (12.0..12.4).contains(&t) { 0.6 } else { 0.0 };
    let properties = vec![
        property(4, "never speed > 2.0 m/s", Verdict::Violated),
        property(6, "whenever held for 0.5 s (cmd > 0.1), eventually within 1 s speed > 0", Verdict::Holds),
        property(8, "never scan_near < 0.2", Verdict::Inconclusive),
        property(10, "after docked, never speed > 0.1", Verdict::Holds),
        Property {
            name: "driver".into(),
            ..property(
                12,
                "machine driver {\n    initial idle\n    state drive when speed > 0.5\n    idle -> drive\n}",
                Verdict::Violated,
            )
        },
        property(20, "eventually docked", Verdict::Unmet),
    ];
    let mut report = Report {
        specs: vec!["robot.rv".into()],
        trace: "runs/2024-11-03/drive.mcap".into(),
        span: Some((at(0.0), at(LENGTH))),
        instants: 1501,
        topics: vec![Topic {
            name: "/odom".into(),
            type_name: Some("nav_msgs/Odometry".into()),
            messages: 1500,
            unseen: 0,
        }],
        properties,
        warnings: vec![Warning::plain("time jumped back from 20 s to 0 s: every monitor of robot.rv started anew")],
        gaps: Vec::new(),
    };
    let all = &mut report.properties;
    all[0].violations = vec![
        violation(2.1, 2.1, 3.4, 66, 2.09),
        violation(12.0, 12.0, 12.36, 19, 2.31),
        violation(20.2, 20.2, 20.2, 1, 2.004),
    ];
    all[0].obligations = Obligations { met: 1415, failed: 86, open: 0 };
    all[0].margin = Some(-0.31);
    all[1].scopes = vec![Scope { text: "whenever held for 0.5 s (cmd > 0.1)".into(), entered: 900 }];
    all[1].obligations = Obligations { met: 900, failed: 0, open: 0 };
    all[2].cause = Some("no value ever came: /scan".into());
    all[3].scopes = vec![Scope { text: "after docked".into(), entered: 0 }];
    all[3].vacuous = true;
    all[3].hints = vec!["nothing in this recording put it to the test".into()];
    all[4].violations =
        vec![Violation { why: Some("illegal transition drive -> idle".into()), ..violation(9.0, 9.0, 9.0, 1, 0.4) }];
    all[5].unmet_since = Some(at(0.0));
    let curve = |name: &str, unit: Option<&str>, f: &dyn Fn(f64) -> f64| Track {
        name: name.into(),
        unit: unit.map(Into::into),
        shape: Shape::Curve((0..=1500).map(|k| (at(f64::from(k) * 0.02), f(f64::from(k) * 0.02))).collect()),
        is_thinned: false,
    };
    let steps = Shape::Steps {
        changes: vec![
            (at(0.0), Some(0)),
            (at(1.0), Some(1)),
            (at(9.0), Some(0)),
            (at(10.0), Some(1)),
            (at(26.0), None),
            (at(28.0), Some(0)),
        ],
        labels: vec!["idle".into(), "drive".into()],
    };
    let margin = Track { name: "margin".into(), ..curve("", Some("m/s"), &|t| 2.0 - speed(t)) };
    let tracks = vec![
        curve("speed", Some("m/s"), &speed),
        curve("cmd", None, &|t| if t > 1.0 && t < 25.0 { 0.5 } else { 0.0 }),
        Track { name: "driver".into(), unit: None, shape: steps, is_thinned: true },
        Track { name: "kick".into(), unit: None, shape: Shape::Ticks(vec![at(4.0), at(15.0)]), is_thinned: false },
    ];
    let limit = |value: f64, text: &str| Limit { value, text: text.into() };
    let plot = |track: usize, limits: Vec<Limit>| Plot { tracks: vec![track], limits };
    let whole = |stand| vec![phase(0.0, LENGTH, stand)];
    let failed = [(2.1, 3.4), (12.0, 12.36), (20.2, 20.2)];
    let mut phases = vec![phase(0.0, 0.1, Stand::NotStarted)];
    let mut since = 0.1;
    for (from, to) in failed.into_iter().filter(|(from, to)| from < to) {
        phases.extend([phase(since, from, Stand::Holds), phase(from, to, Stand::Failed)]);
        since = to;
    }
    phases.push(phase(since, LENGTH, Stand::Holds));
    let courses = vec![
        Course {
            words: "at no instant speed > 2".into(),
            phases,
            plots: vec![plot(0, vec![limit(2.0, "> 2.0 m/s")])],
            margin: Some(margin),
            ..course(&report.properties[0])
        },
        Course {
            words: "at every instant with held for 500 ms (cmd > 0.1), seen from there: at some instant within 1 s speed > 0".into(),
            phases: vec![phase(0.0, 1.5, Stand::Idle), phase(1.5, 25.0, Stand::Holds), phase(25.0, LENGTH, Stand::Idle)],
            scopes: vec![Some(vec![(at(1.5), at(25.0))])],
            plots: vec![plot(1, vec![limit(0.1, "> 0.1")]), plot(0, vec![limit(0.0, "> 0")])],
            ..Course::default()
        },
        Course { phases: whole(Stand::NotStarted), ..Course::default() },
        Course { phases: whole(Stand::Idle), scopes: vec![Some(Vec::new())], plots: vec![plot(0, Vec::new())], ..Course::default() },
        Course { phases: whole(Stand::Holds), lanes: vec![2, 3], plots: vec![plot(0, Vec::new())], diagram: Some(diagram()), ..course(&report.properties[4]) },
        Course { phases: whole(Stand::Unmet), ..Course::default() },
    ];
    let history = History { pieces: vec![Piece { from: at(0.0), to: at(LENGTH), stamp: at(0.0) }], tracks, courses };
    (report, history)
}

/// The same drive with names and texts that try to be more than text.
pub fn hostile() -> (Report, History) {
    let evil = |what: &str| {
        format!("</script><script>alert('{what}')</script><img src=x onerror=alert(1)>\"'&<!--%{{x}}$\\alpha$")
    };
    let (mut report, mut history) = drive();
    report.trace = evil("trace");
    report.specs = vec![evil("spec")];
    report.topics[0].name = evil("topic");
    report.topics[0].type_name = Some(evil("type"));
    report.warnings.push(Warning::plain(evil("warning")));
    report.gaps.push(evil("gap"));
    for property in &mut report.properties {
        property.name = evil("name");
        property.file = evil("file");
        property.text = evil("text");
        property.cause = Some(evil("cause"));
        property.hints = vec![evil("hint")];
        property.reactions = vec![evil("reaction")];
        property.scopes.iter_mut().for_each(|s| s.text = evil("scope"));
        for violation in &mut property.violations {
            violation.why = Some(evil("why"));
            violation.values =
                Some(vec![Reading { name: evil("reading"), value: Value::Str(evil("value")), ..reading("", 0.0) }]);
        }
    }
    for track in &mut history.tracks {
        track.name = evil("track");
        track.unit = Some(evil("unit"));
        if let Shape::Steps { labels, .. } = &mut track.shape {
            labels.iter_mut().for_each(|label| *label = evil("label"));
        }
    }
    for course in &mut history.courses {
        course.words = evil("words");
        if let Some(graph) = &mut course.diagram {
            graph.title = evil("title");
            graph.nodes.iter_mut().for_each(|node| node.label = evil("node"));
            graph.edges.iter_mut().for_each(|edge| edge.label = evil("edge"));
        }
        course.plots.iter_mut().flat_map(|p| &mut p.limits).for_each(|limit| limit.text = evil("limit"));
    }
    (report, history)
}

/// The driver's states; it went back to the first although no arrow leads there, and was lost once.
fn diagram() -> Graph {
    let mut graph = Graph { title: "driver".into(), is_machine: true, ..Graph::default() };
    let idle = graph.node(Node::Initial, "idle");
    let drive = graph.node(Node::State, "drive\nat most 5 s");
    graph.edge(idle, drive, "speed > 0.5 m/s");
    graph.wrong(drive, idle, "illegal, once");
    let undefined = graph.node(Node::Nowhere, "undefined");
    graph.wrong(drive, undefined, "no state fits, 2 times");
    graph
}

fn phase(from: f64, to: f64, stand: Stand) -> Phase {
    Phase { from: at(from), to: at(to), stand }
}

fn course(property: &Property) -> Course {
    let mark = |v: &Violation| Mark { began: v.began, failed: v.failed, until: v.until };
    Course { marks: property.violations.iter().map(mark).collect(), ..Course::default() }
}

fn reading(name: &str, value: f64) -> Reading {
    Reading { name: name.into(), value: Value::Num(value), role: Default::default() }
}

fn violation(began: f64, failed: f64, until: f64, count: u64, speed: f64) -> Violation {
    let values = vec![reading("speed", speed), reading("cmd", 0.5)];
    Violation {
        began: at(began),
        failed: at(failed),
        until: at(until),
        count,
        values: Some(values.clone()),
        began_values: Some(values),
        history: Vec::new(),
        why: None,
    }
}

fn property(line: usize, text: &str, verdict: Verdict) -> Property {
    Property { verdict, ..Property::new(&format!("line {line}"), "robot.rv", (line, 1), text) }
}
