//! What stands around: walls, posts, boxes, signs and the dock.

use crate::message::{Model, Placement, Quaternion, Twist};
use crate::pose::Pose;
use crate::random::Random;
use crate::scenario::{self, draw_point};
use crate::sensor::Charger;
use crate::world::{Body, Outline, World};

/// The radius of the post of a sign, in metres.
const SIGN: f64 = 0.03;
/// How often a place is looked for where a post can stand.
const TRIES: usize = 50;

/// What stands around.
pub struct Stage {
    /// What the ground truth names.
    named: Vec<(String, Body)>,
    signs: Vec<[f64; 2]>,
    charger: Option<Charger>,
}

impl Stage {
    /// Builds it up around where the robots start.
    pub fn new(plan: &scenario::World, starts: &[Pose], world: &mut World, random: &mut Random) -> Stage {
        let mut stage = Stage { named: Vec::new(), signs: Vec::new(), charger: None };
        if let Some(room) = &plan.room {
            let [length, width] = draw_point(room, random).map(|side| side / 2.0);
            let corners = [[-length, -width], [length, -width], [length, width], [-length, width]];
            (0..4).for_each(|k| world.wall(corners[k], corners[(k + 1) % 4]));
        }
        for wall in &plan.wall {
            let (from, to) = (draw_point(&wall.from, random), draw_point(&wall.to, random));
            world.wall(from, to);
        }
        for post in &plan.post {
            let at = draw_point(&post.at, random);
            world.fix(at_rest(at), Outline::Disc(post.radius.draw(random)));
        }
        plan.boxes.iter().for_each(|b| stage.put_box(b, world, random));
        for sign in &plan.sign {
            let at = draw_point(&sign.at, random);
            stage.signs.push(at);
            stage.named.push((sign.name.get_ref().clone(), world.fix(at_rest(at), Outline::Disc(SIGN))));
        }
        if let Some(scatter) = &plan.scatter {
            strew(scatter, starts, world, random);
        }
        stage.charger = plan.dock.as_ref().map(|dock| Charger {
            at: draw_point(&dock.at, random),
            reach: dock.reach.draw(random),
            rate: dock.rate.draw(random),
        });
        stage
    }

    fn put_box(&mut self, plan: &scenario::Crate, world: &mut World, random: &mut Random) {
        let [length, width] = draw_point(&plan.size, random);
        let [x, y] = draw_point(&plan.at, random);
        let pose = Pose { x, y, yaw: plan.heading.draw(random).to_radians() };
        let outline = Outline::Rectangle(length, width);
        let body = match plan.mass.as_ref().map(|m| m.draw(random)) {
            Some(mass) => world.place(pose, outline, mass),
            None => world.fix(pose, outline),
        };
        self.named.push((plan.name.get_ref().clone(), body));
    }

    /// Where the signs are.
    pub fn signs(&self) -> &[[f64; 2]] {
        &self.signs
    }

    /// The charging station.
    pub fn charger(&self) -> Option<Charger> {
        self.charger
    }

    /// What stands around, as the ground truth has it.
    pub fn models(&self, world: &World) -> impl Iterator<Item = Model> {
        self.named.iter().map(|(name, body)| self.model(name, *body, world))
    }

    /// A body as the ground truth has it.
    pub fn model(&self, name: &str, body: Body, world: &World) -> Model {
        let (pose, motion) = (world.pose(body), world.motion(body));
        Model {
            name: name.to_owned(),
            placement: Placement { position: [pose.x, pose.y, 0.0], rotation: Quaternion::of_yaw(pose.yaw) },
            twist: Twist { linear: [motion.x, motion.y, 0.0], angular: [0.0, 0.0, motion.turn] },
        }
    }
}

fn at_rest([x, y]: [f64; 2]) -> Pose {
    Pose { x, y, yaw: 0.0 }
}

/// Puts posts anywhere but near where a robot starts. Where there is no room for one it is left out.
fn strew(scatter: &scenario::Scatter, starts: &[Pose], world: &mut World, random: &mut Random) {
    let count = libm::round(scatter.count.draw(random)) as usize;
    let [length, width] = draw_point(&scatter.within, random);
    let clear = scatter.clear.draw(random);
    for _ in 0..count {
        let radius = scatter.radius.draw(random);
        let mut place = || [random.between(-0.5, 0.5) * length, random.between(-0.5, 0.5) * width];
        let free = |at: &[f64; 2]| starts.iter().all(|s| s.towards(*at).0 > clear + radius);
        let found = (0..TRIES).map(|_| place()).find(free);
        if let Some(at) = found {
            world.fix(at_rest(at), Outline::Disc(radius));
        }
    }
}
