//! Ground truth: where an object is and how it moves, whatever kind of message says so.

use alloc::collections::BTreeMap;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use lapwing_stream::{Name, Value};
use serde::{Deserialize, Serialize};

use crate::functions::{norm, product, rotate, rotate_back};
use crate::inputs::Inputs;
use crate::program::{Object, ObjectSource, Program};

/// How deep a tree of frames may be.
const DEEPEST: usize = 1000;

/// How many frames are remembered.
const MOST_FRAMES: usize = 10_000;

/// What is remembered of an object.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct ObjectMemory {
    /// The latest pose, and its stamp.
    before: Option<(i64, Pose)>,
    /// The latest velocities.
    twist: Option<Twist>,
    /// The latest transform to each frame from its parent.
    frames: BTreeMap<String, (String, Pose)>,
}

/// A position and an orientation (x, y, z, w).
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Pose {
    position: [f64; 3],
    turn: [f64; 4],
}

/// A linear and an angular velocity.
type Twist = ([f64; 3], [f64; 3]);

impl ObjectMemory {
    /// A message of a topic that moves the object.
    pub fn message(
        &mut self,
        program: &Program,
        object: &Object,
        topic: usize,
        values: &[Value],
        now: i64,
        inputs: &mut Inputs,
    ) {
        let value = |i: usize| values.get(i).unwrap_or(&Value::Missing);
        match &object.source {
            ObjectSource::ModelStates { name, pose, twist } => {
                let Some(i) = index_of(value(*name), &object.name) else { return };
                if let Some(pose) = nth(value(*pose), i).and_then(pose_of) {
                    let twist = nth(value(*twist), i).and_then(twist_of);
                    self.set(program, object, &pose, twist.as_ref(), inputs);
                }
            }
            ObjectSource::Odometry { pose, twist } => {
                if let Some(pose) = pose_of(value(*pose)) {
                    let turned = twist_of(value(*twist)).map(|(l, a)| (rotate(l, pose.turn), rotate(a, pose.turn)));
                    self.set(program, object, &pose, turned.as_ref(), inputs);
                }
            }
            ObjectSource::Pose { pose } => {
                if let Some(pose) = pose_of(value(*pose)) {
                    self.moved(program, object, pose, now, inputs);
                }
            }
            ObjectSource::Tf { topics, fixed, frame } => {
                let Some((_, field)) = topics.iter().find(|(t, _)| *t == topic) else { return };
                if self.take_transforms(value(*field), fixed, frame)
                    && let Some(pose) = self.pose_in(fixed, frame)
                {
                    self.moved(program, object, pose, now, inputs);
                }
            }
        }
    }

    /// A pose without velocities: they are differences from the one before.
    fn moved(&mut self, program: &Program, object: &Object, pose: Pose, now: i64, inputs: &mut Inputs) {
        let twist = match self.before {
            Some((stamp, before)) if stamp < now => Some(difference(before, pose, (now - stamp) as f64 / 1e9)),
            _ => None,
        };
        self.set(program, object, &pose, twist.as_ref(), inputs);
        self.before = Some((now, pose));
    }

    /// Fills the slots that are read of the object.
    fn set(&mut self, program: &Program, object: &Object, pose: &Pose, twist: Option<&Twist>, inputs: &mut Inputs) {
        if let Some(twist) = twist {
            self.twist = Some(*twist);
        }
        for &(part, slot) in &object.parts {
            let value = match part {
                0..3 => Some(pose.position[part]),
                3..7 => Some(pose.turn[part - 3]),
                7..10 => twist.map(|(linear, _)| linear[part - 7]),
                10..13 => twist.map(|(_, angular)| angular[part - 10]),
                13..16 => self.twist.as_ref().map(|(linear, _)| rotate_back(*linear, pose.turn)[part - 13]),
                16..19 => self.twist.as_ref().map(|(_, angular)| rotate_back(*angular, pose.turn)[part - 16]),
                _ => None,
            };
            if let Some(x) = value {
                inputs.set_number(program, slot, x);
            }
        }
    }

    /// Stores transforms; whether one of them lies between the two frames.
    fn take_transforms(&mut self, transforms: &Value, fixed: &str, frame: &str) -> bool {
        let Value::List(list) = transforms else { return false };
        let mut stored = Vec::new();
        for transform in list {
            if let Some((parent, child, pose)) = transform_of(transform) {
                stored.push(child.clone());
                if self.frames.len() >= MOST_FRAMES && !self.frames.contains_key(&child) {
                    continue;
                }
                self.frames.insert(child, (parent, pose));
            }
        }
        let Some((up, down)) = self.between(fixed, frame) else { return false };
        up.into_iter().chain(down).any(|child| stored.iter().any(|moved| moved == child))
    }

    /// The pose of a frame in another, both hanging from the same root.
    fn pose_in(&self, fixed: &str, frame: &str) -> Option<Pose> {
        let (up, down) = self.between(fixed, frame)?;
        let of_frame = self.along(&up);
        Some(if down.is_empty() { of_frame } else { compose(inverse(self.along(&down)), of_frame) })
    }

    /// The frames from one, and from the other, up to where they meet, without that one: what hangs above is not between them.
    fn between<'a>(&'a self, fixed: &'a str, frame: &'a str) -> Option<(Vec<&'a str>, Vec<&'a str>)> {
        let (mut up, mut down) = (self.path(frame)?, self.path(fixed)?);
        let mut meet = false;
        while up.last().is_some() && up.last() == down.last() {
            up.pop();
            down.pop();
            meet = true;
        }
        meet.then_some((up, down))
    }

    /// A frame and those that it hangs from, up to its root.
    fn path<'a>(&'a self, frame: &'a str) -> Option<Vec<&'a str>> {
        let parent = |frame: &&'a str| self.frames.get(*frame).map(|(parent, _)| parent.as_str());
        let path: Vec<&str> = core::iter::successors(Some(frame), parent).take(DEEPEST).collect();
        (path.len() < DEEPEST).then_some(path)
    }

    /// The pose of the first of some frames, each of which hangs from the next, in what the last hangs from.
    fn along(&self, path: &[&str]) -> Pose {
        let links = path.iter().filter_map(|child| self.frames.get(*child));
        let still = Pose { position: [0.0; 3], turn: [0.0, 0.0, 0.0, 1.0] };
        links.fold(still, |pose, (_, link)| compose(*link, pose))
    }
}

fn difference(before: Pose, after: Pose, seconds: f64) -> Twist {
    let linear = core::array::from_fn(|i| (after.position[i] - before.position[i]) / seconds);
    let [x, y, z, w] = before.turn;
    let mut turn = product(after.turn, [-x, -y, -z, w]);
    if turn[3] < 0.0 {
        // The shorter way round.
        turn = turn.map(|c| -c);
    }
    let sine = norm(&turn[..3]);
    let angle = 2.0 * libm::atan2(sine, turn[3]);
    let angular = if sine > 0.0 { core::array::from_fn(|i| turn[i] / sine * angle / seconds) } else { [0.0; 3] };
    (linear, angular)
}

fn compose(outer: Pose, inner: Pose) -> Pose {
    let turned = rotate(inner.position, outer.turn);
    Pose { position: core::array::from_fn(|i| outer.position[i] + turned[i]), turn: product(outer.turn, inner.turn) }
}

fn inverse(pose: Pose) -> Pose {
    let [x, y, z, w] = pose.turn;
    Pose { position: rotate_back(pose.position, pose.turn).map(|c| -c), turn: [-x, -y, -z, w] }
}

fn index_of(names: &Value, name: &str) -> Option<usize> {
    match names {
        Value::List(list) => list.iter().position(|n| matches!(n, Value::Str(s) if s == name)),
        _ => None,
    }
}

fn nth(array: &Value, i: usize) -> Option<&Value> {
    match array {
        Value::List(list) => list.get(i),
        _ => None,
    }
}

/// The field of a record by its name, where it is most likely at that place.
#[inline]
fn field<'a>(of: &'a Value, place: usize, name: &str) -> Option<&'a Value> {
    match of {
        Value::Record(fields) => match fields.get(place) {
            Some((known, value)) if known.as_bytes() == name.as_bytes() => Some(value),
            _ => of.field(name),
        },
        _ => None,
    }
}

/// The fields of a record that have these letters for names, all of them numbers.
// PERF: comparing letters takes no call, and there are thirteen of them in the least message.
#[inline]
fn numbers<const N: usize>(of: &Value, letters: &[u8; N]) -> Option<[f64; N]> {
    let Value::Record(fields) = of else { return None };
    let mut out = [0.0; N];
    for (place, (x, letter)) in out.iter_mut().zip(letters).enumerate() {
        let is_it = |(known, _): &&(Name, Value)| *known.as_bytes() == [*letter];
        let found = fields.get(place).filter(is_it).or_else(|| fields.iter().find(is_it));
        let Some((_, Value::Num(number))) = found else { return None };
        *x = *number;
    }
    Some(out)
}

fn pose_of(value: &Value) -> Option<Pose> {
    Some(Pose {
        position: numbers(field(value, 0, "position")?, b"xyz")?,
        turn: numbers(field(value, 1, "orientation")?, b"xyzw")?,
    })
}

fn twist_of(value: &Value) -> Option<Twist> {
    let part = |place, name| numbers(field(value, place, name)?, b"xyz");
    Some((part(0, "linear")?, part(1, "angular")?))
}

/// Parent, child, and the child's pose in the parent.
fn transform_of(value: &Value) -> Option<(String, String, Pose)> {
    let name = |v: &Value| match v {
        Value::Str(s) => Some(s.trim_start_matches('/').to_string()),
        _ => None,
    };
    let transform = value.field("transform")?;
    Some((
        name(value.field("header")?.field("frame_id")?)?,
        name(value.field("child_frame_id")?)?,
        Pose {
            position: numbers(transform.field("translation")?, b"xyz")?,
            turn: numbers(transform.field("rotation")?, b"xyzw")?,
        },
    ))
}
