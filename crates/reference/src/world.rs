//! World signals: the ground truth of objects, from four kinds of sources (language reference, *Declarations*).
//!
//! Everything is in the world frame. What a source lacks is a finite difference between two deliveries.

use lapwing_check::checked::{Object, ObjectSource, Part};
use lapwing_stream::{Time, Value};
use std::collections::BTreeMap;

type Vector = [f64; 3];

/// `x, y, z, w`
type Quaternion = [f64; 4];

#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    position: Vector,
    orientation: Quaternion,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Twist {
    linear: Vector,
    angular: Vector,
}

/// What one message said of one object.
pub struct Delivery {
    pose: Pose,
    twist: Option<Twist>,
    /// The latest velocity in the object's own frame, by this pose.
    body: Option<Twist>,
}

impl Delivery {
    /// The value that it has for a part, if any.
    pub fn part(&self, part: Part) -> Option<f64> {
        let Pose { position: p, orientation: q } = self.pose;
        let twist = |pick: fn(Twist) -> f64| self.twist.map(pick);
        let body = |pick: fn(Twist) -> f64| self.body.map(pick);
        match part {
            Part::PositionX => Some(p[0]),
            Part::PositionY => Some(p[1]),
            Part::PositionZ => Some(p[2]),
            Part::QuaternionX => Some(q[0]),
            Part::QuaternionY => Some(q[1]),
            Part::QuaternionZ => Some(q[2]),
            Part::QuaternionW => Some(q[3]),
            Part::LinearX => twist(|t| t.linear[0]),
            Part::LinearY => twist(|t| t.linear[1]),
            Part::LinearZ => twist(|t| t.linear[2]),
            Part::AngularX => twist(|t| t.angular[0]),
            Part::AngularY => twist(|t| t.angular[1]),
            Part::AngularZ => twist(|t| t.angular[2]),
            Part::BodyLinearX => body(|t| t.linear[0]),
            Part::BodyLinearY => body(|t| t.linear[1]),
            Part::BodyLinearZ => body(|t| t.linear[2]),
            Part::BodyAngularX => body(|t| t.angular[0]),
            Part::BodyAngularY => body(|t| t.angular[1]),
            Part::BodyAngularZ => body(|t| t.angular[2]),
        }
    }
}

/// What must be remembered of one object from message to message.
#[derive(Default)]
pub struct Tracked {
    /// The delivery before, for finite differences.
    before: Option<(Time, Pose)>,
    /// The latest velocity.
    latest: Option<Twist>,
    /// The latest transform of each child frame, with its parent.
    links: BTreeMap<String, (String, Pose)>,
}

impl Tracked {
    /// What a message of a topic says of the object.
    pub fn deliver(&mut self, object: &Object, time: Time, topic: usize, values: &[Value]) -> Option<Delivery> {
        match &object.source {
            ObjectSource::ModelStates { topic: t, name, pose, twist } if *t == topic => {
                let at = position_of(values.get(*name)?, &object.name)?;
                let twist = element(values.get(*twist)?, at).and_then(twist_of);
                Some(self.delivery(pose_of(element(values.get(*pose)?, at)?)?, twist))
            }
            ObjectSource::Odometry { topic: t, pose, twist } if *t == topic => {
                let pose = pose_of(values.get(*pose)?)?;
                let body = twist_of(values.get(*twist)?);
                let turned = |t: Twist| Twist {
                    linear: turn(pose.orientation, t.linear),
                    angular: turn(pose.orientation, t.angular),
                };
                Some(self.delivery(pose, body.map(turned)))
            }
            ObjectSource::Pose { topic: t, pose } if *t == topic => {
                let pose = pose_of(values.get(*pose)?)?;
                Some(self.differentiate(time, pose))
            }
            ObjectSource::Tf { topics, fixed, frame } => {
                let (_, field) = topics.iter().find(|(t, _)| *t == topic)?;
                let Value::List(transforms) = values.get(*field)? else { return None };
                let moved: Vec<String> = transforms.iter().filter_map(|t| self.link(t)).collect();
                let (chain, pose) = self.chain(fixed, frame)?;
                let concerned = chain.iter().any(|child| moved.contains(child));
                concerned.then(|| self.differentiate(time, pose))
            }
            _ => None,
        }
    }

    /// A pose and the velocity since the one before; where no time has passed there is none, and the one known stays.
    fn differentiate(&mut self, time: Time, pose: Pose) -> Delivery {
        let difference = self.before.and_then(|(earlier, before)| {
            let dt = time.since(earlier).seconds();
            let linear = [0, 1, 2].map(|i| (pose.position[i] - before.position[i]) / dt);
            let turned = multiply(pose.orientation, conjugate(before.orientation));
            (dt > 0.0).then(|| Twist { linear, angular: rotation_vector(turned).map(|a| a / dt) })
        });
        self.before = Some((time, pose));
        self.delivery(pose, difference)
    }

    /// A pose, with a velocity where there is one; the latest is turned back by it.
    fn delivery(&mut self, pose: Pose, twist: Option<Twist>) -> Delivery {
        self.latest = twist.or(self.latest);
        let back = |v| turn(conjugate(pose.orientation), v);
        let body = self.latest.map(|t| Twist { linear: back(t.linear), angular: back(t.angular) });
        Delivery { pose, twist, body }
    }

    /// Takes in one `TransformStamped`; the child frame that it places.
    fn link(&mut self, transform: &Value) -> Option<String> {
        let frame = |v: &Value| match v {
            Value::Str(s) => Some(s.trim_start_matches('/').to_string()),
            _ => None,
        };
        let parent = frame(transform.field("header")?.field("frame_id")?)?;
        let child = frame(transform.field("child_frame_id")?)?;
        let body = transform.field("transform")?;
        let pose = Pose {
            position: vector_of(body.field("translation")?)?,
            orientation: quaternion_of(body.field("rotation")?)?,
        };
        self.links.insert(child.clone(), (parent, pose));
        Some(child)
    }

    /// The pose of `frame` in `fixed`, and the child frames of the links between them.
    fn chain(&self, fixed: &str, frame: &str) -> Option<(Vec<String>, Pose)> {
        let (fixed, frame) = (fixed.trim_start_matches('/'), frame.trim_start_matches('/'));
        let up = self.to_root(frame);
        let down = self.to_root(fixed);
        let (meet_up, (meet, _)) = up.iter().enumerate().find(|(_, (f, _))| down.iter().any(|(g, _)| g == f))?;
        let meet_down = down.iter().position(|(g, _)| g == meet)?;
        let links = up[..meet_up].iter().chain(&down[..meet_down]).map(|(f, _)| f.clone()).collect();
        Some((links, compose(invert(down[meet_down].1), up[meet_up].1)))
    }

    /// A frame and those above it, each with the pose of the first frame in it.
    fn to_root(&self, frame: &str) -> Vec<(String, Pose)> {
        let mut path = vec![(frame.to_string(), Pose { position: [0.0; 3], orientation: [0.0, 0.0, 0.0, 1.0] })];
        while let Some((last, pose)) = path.last()
            && let Some((parent, link)) = self.links.get(last)
            && !path.iter().any(|(f, _)| f == parent)
        {
            let next = (parent.clone(), compose(*link, *pose));
            path.push(next);
        }
        path
    }
}

fn position_of(names: &Value, name: &str) -> Option<usize> {
    match names {
        Value::List(list) => list.iter().position(|v| matches!(v, Value::Str(s) if s == name)),
        _ => None,
    }
}

fn element(list: &Value, at: usize) -> Option<&Value> {
    match list {
        Value::List(list) => list.get(at),
        _ => None,
    }
}

fn number_of(record: &Value, field: &str) -> Option<f64> {
    match record.field(field)? {
        Value::Num(x) => Some(*x),
        _ => None,
    }
}

fn vector_of(v: &Value) -> Option<Vector> {
    Some([number_of(v, "x")?, number_of(v, "y")?, number_of(v, "z")?])
}

fn quaternion_of(v: &Value) -> Option<Quaternion> {
    Some([number_of(v, "x")?, number_of(v, "y")?, number_of(v, "z")?, number_of(v, "w")?])
}

fn pose_of(v: &Value) -> Option<Pose> {
    Some(Pose { position: vector_of(v.field("position")?)?, orientation: quaternion_of(v.field("orientation")?)? })
}

fn twist_of(v: &Value) -> Option<Twist> {
    Some(Twist { linear: vector_of(v.field("linear")?)?, angular: vector_of(v.field("angular")?)? })
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn conjugate(q: Quaternion) -> Quaternion {
    [-q[0], -q[1], -q[2], q[3]]
}

fn multiply(a: Quaternion, b: Quaternion) -> Quaternion {
    [
        a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
        a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
        a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
        a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
    ]
}

/// `v` turned by the unit quaternion `q`: `v + 2w(u × v) + 2 u × (u × v)`.
pub(crate) fn turn(q: Quaternion, v: Vector) -> Vector {
    let u = [q[0], q[1], q[2]];
    let t = cross(u, v).map(|x| 2.0 * x);
    let tt = cross(u, t);
    [0, 1, 2].map(|i| v[i] + q[3] * t[i] + tt[i])
}

/// The axis of a rotation times its angle, the shorter way round.
fn rotation_vector(q: Quaternion) -> Vector {
    let q = if q[3] < 0.0 { q.map(|x| -x) } else { q };
    let length = libm::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    if length == 0.0 {
        return [0.0; 3];
    }
    let angle = 2.0 * libm::atan2(length, q[3]);
    [q[0], q[1], q[2]].map(|x| x / length * angle)
}

fn compose(outer: Pose, inner: Pose) -> Pose {
    let moved = turn(outer.orientation, inner.position);
    Pose {
        position: [0, 1, 2].map(|i| outer.position[i] + moved[i]),
        orientation: multiply(outer.orientation, inner.orientation),
    }
}

fn invert(pose: Pose) -> Pose {
    let orientation = conjugate(pose.orientation);
    Pose { position: turn(orientation, pose.position).map(|x| -x), orientation }
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUARTER_LEFT: Quaternion = [0.0, 0.0, std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2];

    fn close(a: Vector, b: Vector) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn a_quarter_turn_takes_x_to_y() {
        assert!(close(turn(QUARTER_LEFT, [1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]));
        assert!(close(rotation_vector(QUARTER_LEFT), [0.0, 0.0, std::f64::consts::FRAC_PI_2]));
    }

    #[test]
    fn an_inverse_undoes_a_pose() {
        let pose = Pose { position: [1.0, 2.0, 3.0], orientation: QUARTER_LEFT };
        let nothing = compose(invert(pose), pose);
        assert!(close(nothing.position, [0.0; 3]) && (nothing.orientation[3] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn differences_need_two_deliveries_and_time_between_them() {
        let at = |x| Pose { position: [x, 0.0, 0.0], orientation: [0.0, 0.0, 0.0, 1.0] };
        let mut tracked = Tracked::default();
        let speed = |d: Delivery| d.part(Part::LinearX);
        assert_eq!(speed(tracked.differentiate(Time(0), at(0.0))), None);
        assert_eq!(speed(tracked.differentiate(Time(500_000_000), at(1.0))), Some(2.0));
        assert_eq!(speed(tracked.differentiate(Time(500_000_000), at(1.5))), None);
        assert_eq!(speed(tracked.differentiate(Time(1_000_000_000), at(1.5))), Some(0.0));
    }
}
