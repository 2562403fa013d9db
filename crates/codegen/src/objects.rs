//! Ground truth of a simulator: poses of objects, and how they move. They are handed over as their source has them; what the specification
//! reads of them, velocities above all, the monitor works out, by the very operations of the engine in their order.

use std::collections::BTreeSet;

use lapwing_check::checked::{InputSource, ObjectSource, Spec};

use crate::assemble::Writer;
use crate::code::{Block, Expr, Helper, Ty, call, field, local, since};
use crate::geometry::{inverse, norm, product, rotated};
use crate::interface::{From, Names, identifier};
use crate::scene::Scene;

/// An object whose pose, and whose motion if its source tells of it, are handed over.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// What the specification calls it.
    pub name: String,
    /// Its number in the checked specification.
    pub object: usize,
    /// The functions that take it.
    pub setters: Vec<Setter>,
}

/// A function that takes the pose of an object, or its velocities.
#[derive(Clone, Debug, PartialEq)]
pub struct Setter {
    /// Its name; in C the prefix and `_` stand before that.
    pub name: String,
    /// The member that says that it was called: [`From::Pose`] or [`From::Twist`].
    pub came: From,
    /// The vectors that it takes, which are those that something is read of.
    pub vectors: Vec<Vector>,
    /// What it is, for the reader of the file.
    pub(crate) doc: String,
}

/// A vector of an object's ground truth.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Vector {
    /// Where it is.
    Position,
    /// A unit quaternion: x, y, z, w.
    Orientation,
    /// Its velocity.
    Linear,
    /// Its angular velocity.
    Angular,
    /// Its velocity in its own frame: the latest, turned back by the latest orientation.
    BodyLinear,
    /// Its angular velocity in its own frame.
    BodyAngular,
}

/// The first part of the orientation, of the velocity, of the angular velocity, and of those in the object's own frame, as the engine numbers them.
const ORIENTATION: usize = 3;
const LINEAR: usize = 7;
const ANGULAR: usize = 10;
const BODY_LINEAR: usize = 13;
const BODY_ANGULAR: usize = 16;

const LETTERS: [&str; 4] = ["x", "y", "z", "w"];

impl Vector {
    /// The vector that a part belongs to.
    pub fn of(part: usize) -> Vector {
        match part {
            ..ORIENTATION => Vector::Position,
            ..LINEAR => Vector::Orientation,
            ..ANGULAR => Vector::Linear,
            ..BODY_LINEAR => Vector::Angular,
            ..BODY_ANGULAR => Vector::BodyLinear,
            _ => Vector::BodyAngular,
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Vector::Position => "position",
            Vector::Orientation => "orientation",
            Vector::Linear => "linear",
            Vector::Angular => "angular",
            Vector::BodyLinear => "body",
            Vector::BodyAngular => "body_angular",
        }
    }

    /// The first of its parts.
    pub fn first(self) -> usize {
        match self {
            Vector::Position => 0,
            Vector::Orientation => ORIENTATION,
            Vector::Linear => LINEAR,
            Vector::Angular => ANGULAR,
            Vector::BodyLinear => BODY_LINEAR,
            Vector::BodyAngular => BODY_ANGULAR,
        }
    }

    /// How many it has.
    pub fn len(self) -> usize {
        if self == Vector::Orientation { 4 } else { 3 }
    }

    /// Its parts.
    fn parts(self) -> impl Iterator<Item = usize> {
        self.first()..self.first() + self.len()
    }

    /// The vector of the world's frame that it is, turned back.
    fn turned_back(self) -> Option<Vector> {
        match self {
            Vector::BodyLinear => Some(Vector::Linear),
            Vector::BodyAngular => Some(Vector::Angular),
            _ => None,
        }
    }
}

/// The name of a part: `robot1.position.x`.
pub(crate) fn part_name(object: &str, part: usize) -> String {
    let vector = Vector::of(part);
    let letter = LETTERS[part - vector.first()];
    format!("{object}.{}.{letter}", vector.name())
}

/// Which part of which object a signal is.
pub(crate) fn part_of(spec: &Spec, slot: usize) -> Option<(usize, usize)> {
    match spec.inputs.get(slot)?.source {
        InputSource::World { object, part } => Some((object, part as usize)),
        _ => None,
    }
}

/// Whether a source tells where an object is and no more: how it moves are differences.
fn is_still(source: &ObjectSource) -> bool {
    matches!(source, ObjectSource::Pose { .. } | ObjectSource::Tf { .. })
}

/// The parts that have to be handed over for one that is read.
fn needed(source: &ObjectSource, part: usize) -> Vec<usize> {
    let vector = Vector::of(part);
    if let Some(world) = vector.turned_back() {
        return Vector::Orientation.parts().chain(world.parts().flat_map(|part| needed(source, part))).collect();
    }
    match source {
        _ if part < LINEAR => vec![part],
        ObjectSource::ModelStates { .. } => vec![part],
        // What is in the body's frame is turned into the world's.
        ObjectSource::Odometry { .. } => Vector::Orientation.parts().chain(vector.parts()).collect(),
        ObjectSource::Pose { .. } | ObjectSource::Tf { .. } => match vector {
            Vector::Linear => vec![part - LINEAR],
            _ => Vector::Orientation.parts().collect(),
        },
    }
}

/// What comes from outside for the parts that are read.
pub(crate) fn handed(spec: &Spec, slots: impl Iterator<Item = usize>) -> BTreeSet<From> {
    let mut handed = BTreeSet::new();
    for (object, read) in slots.filter_map(|slot| part_of(spec, slot)) {
        for part in needed(&spec.objects[object].source, read) {
            handed.insert(From::Part(object, part));
            handed.insert(if part < LINEAR { From::Pose(object) } else { From::Twist(object) });
        }
    }
    handed
}

/// The functions that take objects.
pub(crate) fn objects(scene: &Scene<'_>, setters: &mut Names) -> Vec<Object> {
    let mut one = |object: usize| {
        let name = scene.spec.objects[object].name.clone();
        let mut setter = |came: From, word: &str| Setter {
            name: setters.give(&format!("set_{}{word}", identifier(&name))),
            came,
            vectors: vectors(scene, object, came),
            doc: doc(&name, &scene.spec.objects[object].source, came),
        };
        let came = [(From::Pose(object), ""), (From::Twist(object), "_twist")];
        let came = came.into_iter().filter(|(from, _)| scene.members.contains_key(from));
        let setters = came.map(|(from, word)| setter(from, word)).collect();
        Object { name, object, setters }
    };
    scene.objects().into_iter().map(&mut one).collect()
}

fn vectors(scene: &Scene<'_>, of: usize, came: From) -> Vec<Vector> {
    let parts = scene.members.keys().filter_map(|from| match *from {
        From::Part(object, part) if object == of => Some(part),
        _ => None,
    });
    let mut vectors: Vec<Vector> =
        parts.filter(|&part| (part < LINEAR) == matches!(came, From::Pose(_))).map(Vector::of).collect();
    vectors.dedup();
    vectors
}

fn doc(name: &str, source: &ObjectSource, came: From) -> String {
    let frame = match (source, came) {
        (ObjectSource::Tf { fixed, frame, .. }, _) => {
            return format!(
                "The object `{name}` moved: the pose of the frame `{}` in the frame `{}`, as a buffer of transforms looks it up.",
                frame.trim_start_matches('/'),
                fixed.trim_start_matches('/')
            );
        }
        (ObjectSource::Odometry { .. }, From::Twist(_)) => "in its own frame, as odometry has it",
        _ => "in the frame of the world",
    };
    match came {
        From::Twist(_) => {
            format!("How the object `{name}` moves, {frame}. Call it beside the function that takes its pose.")
        }
        _ => format!("Where the object `{name}` is, {frame}. The orientation is a unit quaternion: x, y, z, w."),
    }
}

impl Writer<'_> {
    /// What is remembered to tell how objects move.
    pub fn object_fields(&mut self) {
        for object in self.scene.objects() {
            for part in self.remembered(object) {
                let doc = format!("What was {} before.", part_name(&self.scene.spec.objects[object].name, part));
                self.unit.field(&before(object, part), Ty::F64, 0.0.into(), &doc);
            }
            let name = &self.scene.spec.objects[object].name;
            self.unit.field(&format!("w{object}_at"), Ty::I64, 0.into(), &format!("When `{name}` was there."));
            self.unit.field(
                &format!("w{object}_was"),
                Ty::Bool,
                false.into(),
                &format!("Whether `{name}` was anywhere."),
            );
            self.motion_fields(object);
        }
    }

    /// What is remembered of how an object moves, to turn it back into its own frame.
    fn motion_fields(&mut self, object: usize) {
        let name = &self.scene.spec.objects[object].name;
        let kept = self.motions(object);
        for vector in &kept {
            for part in vector.parts() {
                let doc = format!("The latest of {}.", part_name(name, part));
                self.unit.field(&latest(object, part), Ty::F64, 0.0.into(), &doc);
            }
        }
        if !kept.is_empty() {
            self.unit.field(
                &moves(object),
                Ty::Bool,
                false.into(),
                &format!("Whether it is known how `{name}` moves."),
            );
        }
    }

    /// The velocities of an object that are turned back into its own frame.
    fn motions(&self, object: usize) -> BTreeSet<Vector> {
        self.scene.parts(object).filter_map(|(part, _)| Vector::of(part).turned_back()).collect()
    }

    /// The parts of an object's pose whose differences are read.
    fn remembered(&self, object: usize) -> Vec<usize> {
        let source = &self.scene.spec.objects[object].source;
        let read = self.scene.parts(object).filter(|(part, _)| is_still(source) && *part >= LINEAR);
        let moved = read.flat_map(|(part, _)| match Vector::of(part).turned_back() {
            Some(world) => world.parts().collect(),
            None => vec![part],
        });
        let parts: BTreeSet<usize> = moved.flat_map(|part| needed(source, part)).collect();
        parts.into_iter().collect()
    }

    /// An object comes.
    pub fn take_object(&self, b: &mut Block, object: usize) {
        let source = &self.scene.spec.objects[object].source;
        let (pose, twist) = (self.came(From::Pose(object)), self.came(From::Twist(object)));
        b.when(pose.clone(), |b| {
            for (part, slot) in self.scene.parts(object).filter(|(part, _)| *part < LINEAR) {
                self.receive(b, slot, self.part(object, part));
            }
            if is_still(source) {
                self.move_object(b, object);
            }
        });
        let kept = self.motions(object);
        let is_turned = matches!(source, ObjectSource::Odometry { .. });
        b.when(if is_turned { pose.clone() & twist } else { twist }, |b| {
            for vector in [Vector::Linear, Vector::Angular] {
                let read = self.read(object, vector);
                if read.is_empty() && !kept.contains(&vector) {
                    continue;
                }
                let of = [0, 1, 2].map(|i| self.part(object, vector.first() + i));
                let turn = [0, 1, 2, 3].map(|i| self.part(object, ORIENTATION + i));
                let name = |i: usize, e| b.bind(format!("{}_{i}", vector.name()), Ty::F64, e);
                let moves = if is_turned { rotated(&of, &turn, name) } else { of };
                for (part, slot) in read {
                    self.receive(b, slot, moves[part - vector.first()].clone());
                }
                self.keep(b, object, vector, &moves);
            }
        });
        if !kept.is_empty() {
            b.when(pose & field(moves(object)), |b| self.turn_back(b, object));
        }
    }

    /// The parts of a vector that are read, and the signals that they are.
    fn read(&self, object: usize, vector: Vector) -> Vec<(usize, usize)> {
        self.scene.parts(object).filter(|(part, _)| Vector::of(*part) == vector).collect()
    }

    /// Remembers a velocity, where it is turned back into the object's own frame.
    fn keep(&self, b: &mut Block, object: usize, vector: Vector, moved: &[Expr; 3]) {
        if self.motions(object).contains(&vector) {
            vector.parts().zip(moved).for_each(|(part, x)| b.set(&field(latest(object, part)), x.clone()));
            b.set(&field(moves(object)), true);
        }
    }

    /// The latest velocities, turned back by the orientation that came.
    fn turn_back(&self, b: &mut Block, object: usize) {
        let back = inverse([0, 1, 2, 3].map(|i| self.part(object, ORIENTATION + i)));
        for body in [Vector::BodyLinear, Vector::BodyAngular] {
            let read = self.read(object, body);
            let Some(world) = body.turned_back().filter(|_| !read.is_empty()) else { continue };
            let of = [0, 1, 2].map(|i| field(latest(object, world.first() + i)));
            let turned = rotated(&of, &back, |i, e| b.bind(format!("{}_{i}", body.name()), Ty::F64, e));
            for (part, slot) in read {
                self.receive(b, slot, turned[part - body.first()].clone());
            }
        }
    }

    /// An object without velocities moved: they are differences from where it was before.
    fn move_object(&self, b: &mut Block, object: usize) {
        let remembered = self.remembered(object);
        if remembered.is_empty() {
            return;
        }
        let (at, was, now) = (field(format!("w{object}_at")), field(format!("w{object}_was")), local("now"));
        b.when(was.clone() & at.clone().lt(&now), |b| {
            let seconds = b.bind("seconds", Ty::F64, since(&now, &at).cast(Ty::F64).div(1e9));
            let moved = |i: usize| (self.part(object, i) - field(before(object, i))).div(seconds.clone());
            for (part, slot) in self.read(object, Vector::Linear) {
                self.receive(b, slot, moved(part - LINEAR));
            }
            self.keep(b, object, Vector::Linear, &[0, 1, 2].map(moved));
            self.turn_object(b, object, &seconds);
        });
        remembered.iter().for_each(|&part| b.set(&field(before(object, part)), self.part(object, part)));
        b.set(&at, now);
        b.set(&was, true);
    }

    /// The angular velocity: the axis of the turn since before times its angle, the shorter way round.
    fn turn_object(&self, b: &mut Block, object: usize, seconds: &Expr) {
        let read = self.read(object, Vector::Angular);
        if read.is_empty() && !self.motions(object).contains(&Vector::Angular) {
            return;
        }
        let after = [0, 1, 2, 3].map(|i| self.part(object, ORIENTATION + i));
        let back = inverse([0, 1, 2, 3].map(|i| field(before(object, ORIENTATION + i))));
        let turn = product(&after, &back).into_iter().zip(LETTERS);
        let turn: Vec<Expr> = turn.map(|(e, letter)| b.var(format!("turn_{letter}"), Ty::F64, e)).collect();
        b.when(turn[3].clone().lt(0.0), |b| {
            turn.iter().for_each(|c| b.set(c, Expr::Neg(Box::new(c.clone()))));
        });
        let sine = b.bind("sine", Ty::F64, norm(&turn[..3]));
        let angle = Expr::Float(2.0).mul(call(Helper::Atan2, vec![sine.clone(), turn[3].clone()]));
        let angle = b.bind("angle", Ty::F64, angle);
        let turns = |i: usize| {
            let fast = turn[i].clone().div(sine.clone()).mul(angle.clone()).div(seconds.clone());
            sine.clone().gt(0.0).choose(fast, Expr::Float(0.0))
        };
        for (part, slot) in read {
            self.receive(b, slot, turns(part - ANGULAR));
        }
        self.keep(b, object, Vector::Angular, &[0, 1, 2].map(turns));
    }

    fn came(&self, from: From) -> Expr {
        self.scene.members.get(&from).map_or(Expr::Bool(false), |member| Expr::Input(member.name.clone()))
    }

    fn part(&self, object: usize, part: usize) -> Expr {
        let member = self.scene.members.get(&From::Part(object, part));
        member.map_or(Expr::Float(f64::NAN), |member| Expr::Input(member.name.clone()))
    }
}

/// The field that holds a part of how an object moved last.
fn latest(object: usize, part: usize) -> String {
    let vector = Vector::of(part);
    format!("w{object}_latest_{}_{}", vector.name(), LETTERS[part - vector.first()])
}

/// The field that says whether it is known how an object moves.
fn moves(object: usize) -> String {
    format!("w{object}_moves")
}

/// The field that holds a part of where an object was before.
fn before(object: usize, part: usize) -> String {
    let vector = Vector::of(part);
    format!("w{object}_{}_{}", vector.name(), LETTERS[part - vector.first()])
}
