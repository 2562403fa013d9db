//! How signals and properties went over time, as a session notes it.

use lapwing::{Options, Report, Session, Spec};
use lapwing_react::history::{Course, History, Shape, Stand};

fn noted(spec: &str, trace: &str) -> (Report, History) {
    let specs = [Spec::parse("t.rv", spec, &|_| None).unwrap()];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trace.csv");
    std::fs::write(&path, trace).unwrap();
    let options = Options { history: Some(100), margins: true, ..Options::default() };
    let (report, mut histories) = Session::open(&specs, &path, &options).unwrap().run_noting(&mut ());
    assert_eq!(histories.len(), 1);
    let history = histories.remove(0);
    assert_eq!(history.courses.len(), report.properties.len());
    (report, history)
}

/// The phases of a property: since when, and how.
fn phases(course: &Course) -> Vec<(f64, Stand)> {
    course.phases.iter().map(|p| (p.from.seconds(), p.stand)).collect()
}

fn margin(course: &Course) -> Vec<(f64, f64)> {
    match course.margin.as_ref().map(|m| &m.shape) {
        Some(Shape::Curve(points)) => points.iter().map(|(t, x)| (t.seconds(), *x)).collect(),
        _ => Vec::new(),
    }
}

#[test]
fn a_property_starts_fails_and_recovers() {
    let (_, history) =
        noted("never speed > 2.0\n", "time,other,speed\n0,1,\n1,1,1.5\n2,1,2.5\n3,1,2.25\n4,1,1.0\n5,1,1.0\n");
    let course = &history.courses[0];
    let expected = [(0.0, Stand::NotStarted), (1.0, Stand::Holds), (2.0, Stand::Failed), (3.0, Stand::Holds)];
    assert_eq!(phases(course), expected);
    assert_eq!(margin(course), [(1.0, 0.5), (2.0, -0.5), (3.0, -0.25), (4.0, 1.0), (5.0, 1.0)]);
    let plot = &course.plots[0];
    assert_eq!((history.tracks[plot.tracks[0]].name.as_str(), plot.limits[0].value), ("speed", 2.0));
    let Shape::Curve(points) = &history.tracks[plot.tracks[0]].shape else { panic!("speed is a number") };
    assert_eq!(points.iter().map(|(t, x)| (t.seconds(), *x)).collect::<Vec<_>>()[..2], [(1.0, 1.5), (2.0, 2.5)]);
    assert_eq!(course.marks[0].failed.seconds(), 2.0);
    assert_eq!(course.words, "at no instant speed > 2");
}

#[test]
fn scopes_are_open_where_their_conditions_of_the_past_hold() {
    let spec = "whenever held for 1 s (cmd > 0.5), eventually within 1 s odom > 0\n";
    let trace = "time,cmd,odom\n0,0,1\n1,1,1\n2,1,1\n3,1,0\n4,0,0\n5,0,0\n9,0,0\n";
    let (_, history) = noted(spec, trace);
    let course = &history.courses[0];
    let open: Vec<(f64, f64)> =
        course.scopes[0].as_ref().unwrap().iter().map(|(a, b)| (a.seconds(), b.seconds())).collect();
    assert_eq!(open, [(2.0, 3.0)]);
    // What begins at 3 s fails at 4 s.
    let expected = [(0.0, Stand::Idle), (2.0, Stand::Holds), (3.0, Stand::Failed), (4.0, Stand::Idle)];
    assert_eq!(phases(course), expected);
    // Known only later, and told nevertheless for where it begins: at 3 s `cmd > 0.5` holds by 0.5, and `odom > 0` misses by nothing.
    let at_3: Vec<f64> = margin(course).iter().filter(|(t, _)| *t == 3.0).map(|(_, x)| *x).collect();
    assert_eq!(at_3, [0.0]);
}

#[test]
fn after_a_jump_everything_goes_on_further_along_the_axis() {
    let trace = "time,x\n10,1\n11,5\n12,1\n0,1\n1,5\n2,1\n";
    let (report, history) = noted("never x > 2\n", trace);
    let stamps: Vec<(f64, f64)> = history.pieces.iter().map(|p| (p.from.seconds(), p.stamp.seconds())).collect();
    assert_eq!(stamps, [(10.0, 10.0), (12.0, 0.0)]);
    let course = &history.courses[0];
    let failed: Vec<f64> = course.marks.iter().map(|m| m.failed.seconds()).collect();
    assert_eq!(failed, [11.0, 13.0]);
    let stamps: Vec<f64> = report.properties[0].violations.iter().map(|v| v.failed.seconds()).collect();
    assert_eq!(stamps, [11.0, 1.0]);
}

#[test]
fn machines_and_truth_values_are_lanes() {
    let spec =
        "machine m {\n    initial low\n    state low when x < 2\n    state high when x >= 2\n    low -> high\n}\n";
    let (report, history) = noted(spec, "time,x\n0,1\n1,3\n2,1\n3,1\n");
    assert_eq!(report.properties[0].verdict.word(), "violated");
    let course = &history.courses[0];
    let Shape::Steps { changes, labels } = &history.tracks[course.lanes[0]].shape else { panic!("states are steps") };
    let states: Vec<(f64, &str)> = changes.iter().map(|(t, s)| (t.seconds(), labels[s.unwrap()].as_str())).collect();
    assert_eq!(states, [(0.0, "low"), (1.0, "high"), (2.0, "low")]);
    assert_eq!(course.marks[0].failed.seconds(), 2.0);
    let (_, history) = noted("never docked and x > 2\n", "time,docked,x\n0,true,1\n1,false,1\n");
    let names = |tracks: &[usize]| tracks.iter().map(|t| history.tracks[*t].name.clone()).collect::<Vec<_>>();
    let course = &history.courses[0];
    assert_eq!(
        (names(&course.lanes), names(&course.plots[0].tracks)),
        (vec!["docked".to_owned()], vec!["x".to_owned()])
    );
}

#[test]
fn what_did_not_happen_and_what_cannot_be_judged() {
    let (_, history) = noted("eventually x > 9\n", "time,x\n0,1\n1,2\n");
    assert_eq!(phases(&history.courses[0]), [(0.0, Stand::Unmet)]);
    let (_, history) = noted("never y > 9\n", "time,x\n0,1\n1,2\n");
    assert_eq!(phases(&history.courses[0]), [(0.0, Stand::NotStarted)]);
}

#[test]
fn the_least_of_a_margin_over_time_is_the_margin() {
    let trace: String = (0..60)
        .map(|k| format!("{k},{},{}\n", (f64::from(k) * 0.7).sin() * 3.0, (f64::from(k) * 0.31).cos() * 2.0))
        .fold("time,x,y\n".to_owned(), |all, row| all + &row);
    let specs = [
        "never x > 2.5\n",
        "always (x < 2 and y > -1.5)\n",
        "whenever x > 1, eventually within 3 s y > 1\n",
        "while x > 0, always y < 1\n",
        "while x > 0, eventually within 2 s y < 1\n",
        "after y < -1, never x > 2\n",
        "after_until x > 1, x < -1, eventually y > 1.5\n",
        "until x > 2.9, y > -3\n",
        "before x > 2.9, always within 2 s y > 0\n",
        "always (x < 2.5 and eventually within 4 s y > 1)\n",
        "x < 5 until y < -1\n",
        "always (once within 5 s x > 1)\n",
    ];
    for spec in specs {
        let (report, history) = noted(spec, &trace);
        let told = margin(&history.courses[0]).iter().map(|(_, x)| *x).filter(|x| !x.is_nan()).reduce(f64::min);
        assert!(told.is_some(), "{spec}");
        assert_eq!(told, report.properties[0].margin.filter(|m| m.is_finite()), "{spec}");
    }
}

#[test]
fn a_diagram_has_the_moves_that_it_does_not_have() {
    let spec = "\
machine gear {
    initial low
    state low when speed < 1
    state mid when speed < 2
    state high when speed < 3
    low -> mid
    mid -> high
    high -> mid
}
never gear == high and speed > 9
";
    let trace = "time,speed\n0,0.5\n1,1.5\n2,2.5\n3,0.5\n4,2.5\n5,0.5\n6,7\n7,0.5\n8,1.5\n";
    let (report, history) = noted(spec, trace);
    assert_eq!(report.properties[0].violations.len(), 4);
    let graph = history.courses[0].diagram.as_ref().unwrap();
    let wrong =
        graph.edges.iter().filter(|e| e.is_wrong).map(|e| (graph.name(e.from), graph.name(e.to), e.label.as_str()));
    let expected = [
        ("low", "undefined", "no state fits, once"),
        ("low", "high", "illegal, once"),
        ("high", "low", "illegal, 2 times"),
    ];
    assert_eq!(wrong.collect::<Vec<_>>(), expected);
    assert_eq!((graph.edges.len(), graph.nodes.len()), (6, 4));
    // What only asks for its state is no diagram.
    assert_eq!(history.courses[1].diagram, None);
}

#[test]
fn a_stay_that_was_too_long_is_shown_from_where_it_began() {
    let spec = "machine gate {\n    initial shut\n    state open at most 5 s when x > 1\n    state shut when x < 1\n    shut -> open\n    open -> shut\n}\n";
    // More happens meanwhile than is remembered without a reason.
    let rows: String = (0..20_000).map(|n| format!("{},{}\n", 2.0 + f64::from(n) / 2000.0, 2 + n % 2)).collect();
    let (report, history) = noted(spec, &format!("time,x\n0,0\n{rows}"));
    let violation = &report.properties[0].violations[0];
    assert_eq!((violation.began.seconds(), violation.failed.seconds()), (2.0, 7.0));
    let began = violation.began_values.as_ref().expect("the values when it began");
    assert!(began.iter().any(|r| r.name == "x" && r.value == 2.0.into()), "{began:?}");
    assert!(history.courses[0].words.ends_with("along an edge that is drawn, and stays in open for at most 5 s"));
}
