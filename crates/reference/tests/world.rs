//! *Declarations*: the ground truth of objects from its sources.

mod build;

use build::*;
use lapwing_check::checked::*;
use lapwing_reference::{Arrival, Outcome, Trace};
use lapwing_stream::{Time, Value, Verdict};

fn record(fields: &[(&str, Value)]) -> Value {
    Value::Record(fields.iter().map(|(name, value)| ((*name).into(), value.clone())).collect())
}

fn vector(x: f64, y: f64, z: f64) -> Value {
    record(&[("x", x.into()), ("y", y.into()), ("z", z.into())])
}

/// A pose at `x, y`, turned left by a quarter or not at all.
fn pose(x: f64, y: f64, quarter: bool) -> Value {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let (z, w) = if quarter { (half, half) } else { (0.0, 1.0) };
    let orientation = record(&[("x", 0.0.into()), ("y", 0.0.into()), ("z", z.into()), ("w", w.into())]);
    record(&[("position", vector(x, y, 0.0)), ("orientation", orientation)])
}

fn twist(x: f64) -> Value {
    record(&[("linear", vector(x, 0.0, 0.0)), ("angular", vector(0.0, 0.0, 0.0))])
}

/// One object, robot, and the parts of it as inputs in the order given.
fn world(source: ObjectSource, parts: &[Part]) -> Spec {
    let input = |part: &Part| Input {
        label: format!("{part:?}"),
        source: InputSource::World { object: 0, part: *part },
        ty: lapwing_stream::Type::Num { float: true },
        dim: Dim(None),
        default: None,
        stale: None,
    };
    Spec {
        topics: vec![topic("/a"), topic("/b")],
        objects: vec![Object { name: "robot".into(), source }],
        inputs: parts.iter().map(input).collect(),
        ..Spec::default()
    }
}

fn judge(spec: &Spec, f: Expr, samples: Vec<(i64, Vec<Value>)>) -> Outcome {
    let message = |(ms, values)| (Time(ms * MS), Arrival::Message { topic: 0, values });
    let trace = Trace { samples: samples.into_iter().map(message).collect(), ..Trace::default() };
    outcomes(spec.clone(), vec![property(f)], &trace).remove(0)
}

fn is_about(input: usize, value: f64) -> Expr {
    let margin = Some(Box::new(num(1e-9)));
    let left = Box::new(numeric(Kind::Input(input)));
    boolean(Kind::Compare { op: Compare::Eq, margin, left, right: Box::new(num(value)) })
}

#[test]
fn model_states_has_an_object_when_its_name_is_there() {
    let source = ObjectSource::ModelStates { topic: 0, name: 0, pose: 1, twist: 2 };
    let spec = world(source, &[Part::PositionX, Part::LinearX]);
    let states = |names: &[&str], x: f64| {
        let names = Value::List(names.iter().map(|n| Value::from(*n)).collect());
        let poses = Value::List(vec![pose(9.0, 9.0, false), pose(x, 0.0, false)]);
        vec![names, poses, Value::List(vec![twist(9.0), twist(2.0)])]
    };
    let samples = vec![
        (0, states(&["wall", "robot"], 1.0)),
        (1000, states(&["wall", "other"], 5.0)),
        (2000, states(&["wall", "robot"], 3.0)),
    ];
    assert_eq!(summary(&judge(&spec, is_about(0, 1.0), samples.clone())), "violated 2/1/0 2>2..2 x1");
    assert_eq!(judge(&spec, is_about(1, 2.0), samples).verdict, Verdict::Holds);
}

#[test]
fn odometry_speaks_of_the_body_and_is_turned() {
    let spec = world(ObjectSource::Odometry { topic: 0, pose: 0, twist: 1 }, &[Part::LinearX, Part::LinearY]);
    let samples = vec![(0, vec![pose(0.0, 0.0, true), twist(2.0)])];
    assert_eq!(judge(&spec, and(is_about(0, 0.0), is_about(1, 2.0)), samples).verdict, Verdict::Holds);
}

#[test]
fn a_pose_alone_gives_differences_from_the_second_message_on() {
    let spec = world(ObjectSource::Pose { topic: 0, pose: 0 }, &[Part::LinearX, Part::AngularZ]);
    let samples = vec![
        (0, vec![pose(0.0, 0.0, false)]),
        (500, vec![pose(1.0, 0.0, true)]),
        (500, vec![pose(1.0, 0.0, true)]),
        (1500, vec![pose(1.0, 0.0, true)]),
    ];
    let linear = judge(&spec, is_about(0, 2.0), samples.clone());
    // Where no time has passed the difference stays.
    assert_eq!(summary(&linear), "violated 2/1/0 1.5>1.5..1.5 x1");
    let angular = judge(&spec, or(is_about(1, std::f64::consts::PI), is_about(1, 0.0)), samples);
    assert_eq!(summary(&angular), "holds 3/0/0");
}

#[test]
fn transforms_are_chained() {
    let source =
        ObjectSource::Tf { topics: vec![(0, 0), (1, 0)], fixed: "map".into(), frame: "robot/base_link".into() };
    let spec = world(source, &[Part::PositionX, Part::PositionY]);
    let link = |parent: &str, child: &str, x: f64, quarter: bool| {
        let pose = pose(x, 0.0, quarter);
        let get = |name: &str| pose.field(name).cloned().unwrap_or_default();
        let transform = record(&[("translation", get("position")), ("rotation", get("orientation"))]);
        let header = record(&[("frame_id", parent.into())]);
        record(&[("header", header), ("child_frame_id", child.into()), ("transform", transform)])
    };
    let samples = vec![
        (0, vec![Value::List(vec![link("map", "odom", 1.0, true)])]),
        (100, vec![Value::List(vec![link("odom", "/robot/base_link", 2.0, false)])]),
        (200, vec![Value::List(vec![link("odom", "camera", 2.0, false)])]),
    ];
    // It starts with the second link: one metre ahead, turned left, two metres on from there.
    let outcome = judge(&spec, and(is_about(0, 1.0), is_about(1, 2.0)), samples);
    assert_eq!(summary(&outcome), "holds 2/0/0");
}
