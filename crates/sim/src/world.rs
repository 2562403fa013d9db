//! The floor seen from above: what stands on it, what drives on it, and what bumps into what. The only module that knows rapier.

use rapier2d_f64::geometry::Ray;
use rapier2d_f64::math::Vector;
use rapier2d_f64::prelude::{ColliderBuilder, PhysicsWorld, QueryFilter, RigidBodyBuilder, RigidBodyHandle};

use crate::pose::{Motion, Pose};

/// The shape of something, seen from above, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outline {
    /// A disc of that radius.
    Disc(f64),
    /// A rectangle: along its heading, and across.
    Rectangle(f64, f64),
}

/// Something in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Body(RigidBodyHandle);

/// The floor and all that is on it. There is no gravity: it points into the floor.
pub struct World {
    physics: PhysicsWorld,
}

/// How thick a wall is, in metres.
const WALL: f64 = 0.1;

impl World {
    /// An empty floor; `step` is how many seconds a step takes.
    pub fn new(step: f64) -> World {
        let mut physics = PhysicsWorld::new();
        physics.gravity = Vector::ZERO;
        physics.integration_parameters.dt = step;
        World { physics }
    }

    /// Puts something down that does not move.
    pub fn fix(&mut self, pose: Pose, outline: Outline) -> Body {
        self.put(RigidBodyBuilder::fixed(), pose, outline, 0.0)
    }

    /// Puts something down that can be moved, of that mass in kilograms.
    pub fn place(&mut self, pose: Pose, outline: Outline, mass: f64) -> Body {
        self.put(RigidBodyBuilder::dynamic().can_sleep(false), pose, outline, mass)
    }

    /// Fastens a further part to a body, in the body's own frame. It weighs nothing.
    pub fn fasten(&mut self, body: Body, at: Pose, outline: Outline) {
        let part = collider(outline).translation(Vector::new(at.x, at.y)).rotation(at.yaw).mass(0.0);
        self.physics.insert_collider(part.friction(GRIP), Some(body.0));
    }

    /// Puts a body somewhere else, at rest and with the heading that it has, as a hand would.
    pub fn carry(&mut self, body: Body, to: [f64; 2]) {
        let body = &mut self.physics.bodies[body.0];
        body.set_translation(Vector::new(to[0], to[1]), true);
        body.set_linvel(Vector::ZERO, true);
        body.set_angvel(0.0, true);
    }

    /// Builds a wall from one point to another.
    pub fn wall(&mut self, from: [f64; 2], to: [f64; 2]) {
        let start = Pose { x: from[0], y: from[1], yaw: 0.0 };
        let (length, yaw) = start.towards(to);
        let [x, y] = Pose { yaw, ..start }.point(length / 2.0, 0.0);
        self.fix(Pose { x, y, yaw }, Outline::Rectangle(length + WALL, WALL));
    }

    fn put(&mut self, body: RigidBodyBuilder, pose: Pose, outline: Outline, mass: f64) -> Body {
        let collider = collider(outline);
        let collider = if mass > 0.0 { collider.mass(mass) } else { collider };
        let body = body.translation(Vector::new(pose.x, pose.y)).rotation(pose.yaw);
        Body(self.physics.insert(body, collider.friction(GRIP)).0)
    }

    /// Where a body is.
    pub fn pose(&self, body: Body) -> Pose {
        let body = &self.physics.bodies[body.0];
        let (at, rotation) = (body.translation(), body.rotation());
        Pose { x: at.x, y: at.y, yaw: libm::atan2(rotation.im, rotation.re) }
    }

    /// How a body moves, in the frame of the world.
    pub fn motion(&self, body: Body) -> Motion {
        let body = &self.physics.bodies[body.0];
        let linear = body.linvel();
        Motion { x: linear.x, y: linear.y, turn: body.angvel() }
    }

    /// Makes a body move, in the frame of the world. What is in its way pushes back in the next step.
    pub fn set_motion(&mut self, body: Body, motion: Motion) {
        let body = &mut self.physics.bodies[body.0];
        body.set_linvel(Vector::new(motion.x, motion.y), true);
        body.set_angvel(motion.turn, true);
    }

    /// A step of time.
    pub fn step(&mut self) {
        self.physics.step();
    }

    /// Whether a body touches another.
    pub fn touches(&self, body: Body) -> bool {
        let colliders = self.physics.bodies[body.0].colliders();
        let touching =
            |c: &_| self.physics.narrow_phase.contact_pairs_with(*c).any(|pair| pair.has_any_active_contact());
        colliders.iter().any(touching)
    }

    /// How far it is from the middle of a body to the next thing, in that many directions all around; `None` where there is nothing
    /// within `limit`.
    pub fn look_around(&self, from: Body, rays: usize, limit: f64) -> impl Iterator<Item = Option<f64>> {
        let pose = self.pose(from);
        let origin = Vector::new(pose.x, pose.y);
        let query = self.physics.query_pipeline_with_filter(QueryFilter::default().exclude_rigid_body(from.0));
        (0..rays).map(move |ray| {
            let (sin, cos) = libm::sincos(pose.yaw + std::f64::consts::TAU * ray as f64 / rays as f64);
            query.cast_ray(&Ray::new(origin, Vector::new(cos, sin)), limit, true).map(|(_, far)| far)
        })
    }

    /// How far it is from a point to the next thing in a direction, in radians anticlockwise from the east; `None` where there is nothing
    /// within `limit`. The body `through` is not in the way.
    pub fn look(&self, from: [f64; 2], direction: f64, limit: f64, through: Body) -> Option<f64> {
        let query = self.physics.query_pipeline_with_filter(QueryFilter::default().exclude_rigid_body(through.0));
        let (sin, cos) = libm::sincos(direction);
        let ray = Ray::new(Vector::new(from[0], from[1]), Vector::new(cos, sin));
        query.cast_ray(&ray, limit, true).map(|(_, far)| far)
    }
}

/// How much things rub against each other: the coefficient of friction.
const GRIP: f64 = 0.2;

fn collider(outline: Outline) -> ColliderBuilder {
    match outline {
        Outline::Disc(radius) => ColliderBuilder::ball(radius),
        Outline::Rectangle(length, width) => ColliderBuilder::cuboid(length / 2.0, width / 2.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wall_is_seen_and_stops_what_runs_into_it() {
        let mut world = World::new(0.005);
        world.wall([2.0, -1.0], [2.0, 1.0]);
        let robot = world.place(Pose::default(), Outline::Disc(0.1), 1.0);
        world.step();
        let seen: Vec<_> = world.look_around(robot, 4, 10.0).collect();
        assert!((seen[0].unwrap() - 1.95).abs() < 1e-9 && seen[1..].iter().all(Option::is_none), "{seen:?}");
        assert!(!world.touches(robot));
        for _ in 0..1000 {
            world.set_motion(robot, Motion { x: 1.0, ..Motion::default() });
            world.step();
        }
        assert!((world.pose(robot).x - 1.85).abs() < 0.02 && world.touches(robot), "{:?}", world.pose(robot));
    }

    #[test]
    fn a_part_that_is_fastened_pushes_and_is_looked_through() {
        let mut world = World::new(0.005);
        let robot = world.place(Pose::default(), Outline::Disc(0.1), 1.0);
        world.fasten(robot, Pose { x: 0.15, ..Pose::default() }, Outline::Rectangle(0.1, 0.02));
        let ball = world.place(Pose { x: 0.5, ..Pose::default() }, Outline::Disc(0.05), 0.1);
        world.step();
        let far = world.look([0.0, 0.0], 0.0, 2.0, robot);
        assert!(far.is_some_and(|far| (far - 0.45).abs() < 1e-9), "{far:?}");
        assert_eq!(world.look([0.0, 0.0], std::f64::consts::PI, 2.0, robot), None);
        for _ in 0..400 {
            world.set_motion(robot, Motion { x: 0.2, ..Motion::default() });
            world.step();
        }
        let gap = world.pose(ball).x - world.pose(robot).x;
        assert!(world.pose(ball).x > 0.6 && gap > 0.24, "the ball is {gap} m before the robot");
        world.carry(ball, [-1.0, 0.0]);
        assert_eq!((world.pose(ball).x, world.motion(ball)), (-1.0, Motion::default()));
    }
}
