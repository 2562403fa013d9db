//! The field: a robot with two wheels, an arm and sensors, a ball that shines, a goal, walls, and hands that reach in. Time is logical: it
//! passes while the robot waits or senses, and only then. The same seed gives the same match on every machine.

mod brick;
mod hand;
mod parts;
mod senses;

use std::collections::{BTreeSet, VecDeque};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use lapwing_sim::{Body, Motion, Outline, Pose, Random, World};
use serde::{Deserialize, Serialize};

use crate::robot::SensorPort;
pub use hand::{Deed, Hand, Moment};
use parts::{Arm, Wheel};

/// How much time passes at once.
const STEP: Duration = Duration::from_millis(2);
/// How often the match is sketched.
const SKETCH: Duration = Duration::from_millis(50);

/// The radius of the ball, in metres.
pub const BALL: f64 = 0.037;
/// The robot's body: how long and how wide it is.
pub const BODY: [f64; 2] = [0.16, 0.14];
/// Its left arm, from point to point in the robot's own frame; the right one is its mirror image. It first bends inwards, so that the ball stays when
/// the robot turns, and then opens, to catch it.
pub const ARM: [[f64; 2]; 3] = [[0.085, 0.064], [0.150, 0.052], [0.195, 0.084]];
/// Each half of an arm is a row of so many studs. (A bar at an angle pushes a ball that only comes near to it: so the physics engine has it.)
const STUDS: u8 = 8;
/// How thick an arm is.
pub const ARM_THICK: f64 = 0.01;
/// The goal: how wide and how deep it is.
pub const GOAL: [f64; 2] = [0.6, 0.2];
/// The corners of the field: the lower left and the upper right one.
pub const CORNERS: [[f64; 2]; 2] = [[-0.7, -1.9], [1.9, 0.9]];

/// The radius of a wheel and the distance between the two, in metres.
const WHEEL: f64 = 0.02373;
const TRACK: f64 = 0.132;
/// By how much the tyres can change the speed at most, in m/s².
const GRIP: f64 = 6.0;
/// By how much rolling slows the ball down, in m/s².
const ROLLING: f64 = 0.4;
/// What robot and ball weigh, in kilograms.
const MASSES: [f64; 2] = [1.0, 0.1];

/// A moment of a match, for its picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sketch {
    /// When, in seconds since the kickoff.
    pub time: f64,
    /// Where the robot is: `x`, `y` and the heading in radians.
    pub robot: [f64; 3],
    /// Where the ball is.
    pub ball: [f64; 2],
    /// Whether the ball shines.
    pub shines: bool,
}

/// How a match begins.
#[derive(Clone, Debug, PartialEq)]
pub struct Kickoff {
    /// What chance follows.
    pub seed: u64,
    /// Where the ball lies: how far away, and by how many degrees to the left.
    pub ball: (f64, f64),
    /// What hands will do, one after the other.
    pub hands: Vec<Hand>,
    /// Sensors that are not plugged in.
    pub unplugged: Vec<SensorPort>,
    /// The middle of the goal.
    pub goal: [f64; 2],
}

/// The field, shared by all parts of the robot.
#[derive(Clone)]
pub struct Field {
    inner: Arc<Mutex<Inner>>,
    now: Arc<AtomicU64>,
    goal: Pose,
}

/// A clock that shows the field's time without asking for the field.
#[derive(Clone)]
pub struct Clock(Arc<AtomicU64>);

impl lapwing_tracing::Clock for Clock {
    fn now(&self) -> lapwing_tracing::Time {
        lapwing_tracing::Time(i64::try_from(self.0.load(Ordering::Relaxed)).unwrap_or(i64::MAX))
    }
}

impl Clock {
    /// The time since the kickoff.
    pub fn now(&self) -> Duration {
        Duration::from_nanos(self.0.load(Ordering::Relaxed))
    }
}

struct Inner {
    world: World,
    robot: Body,
    ball: Body,
    now: Duration,
    wheels: [Wheel; 2],
    arm: Arm,
    shines: bool,
    unplugged: BTreeSet<SensorPort>,
    chance: Chance,
    pings: u32,
    pinged: Option<Duration>,
    hands: VecDeque<Hand>,
    /// When a hand reached in last.
    reached: Duration,
    /// Where the robot took the ball up, while it has it.
    taken: Option<[f64; 2]>,
    sketches: Vec<Sketch>,
}

/// Each sensor has chance of its own, so that one that is asked more often does not change the others.
struct Chance {
    unmodulated: Random,
    modulated: Random,
    sonar: Random,
    compass: Random,
}

impl Field {
    /// Sets up the field.
    pub fn new(kickoff: &Kickoff) -> Field {
        let mut world = World::new(STEP.as_secs_f64());
        let goal = facing(kickoff.goal);
        build_walls(&mut world, goal);
        let robot = build_robot(&mut world);
        let (far, left) = kickoff.ball;
        let [x, y] = Pose { yaw: left.to_radians(), ..Pose::default() }.point(far, 0.0);
        let ball = world.place(Pose { x, y, yaw: 0.0 }, Outline::Disc(BALL), MASSES[1]);
        // The world sees what stands on it after its first step.
        world.step();
        let chance = |name| Random::new(kickoff.seed, name, 0);
        let inner = Inner {
            world,
            robot,
            ball,
            now: Duration::ZERO,
            wheels: Default::default(),
            arm: Arm::default(),
            shines: true,
            unplugged: kickoff.unplugged.iter().copied().collect(),
            chance: Chance {
                unmodulated: chance("unmodulated"),
                modulated: chance("modulated"),
                sonar: chance("sonar"),
                compass: chance("compass"),
            },
            pings: 0,
            pinged: None,
            hands: kickoff.hands.iter().cloned().collect(),
            reached: Duration::ZERO,
            taken: None,
            sketches: Vec::new(),
        };
        Field { inner: Arc::new(Mutex::new(inner)), now: Arc::default(), goal }
    }

    /// Its clock.
    pub fn clock(&self) -> Clock {
        Clock(self.now.clone())
    }

    /// Where the ball is.
    pub fn ball(&self) -> [f64; 2] {
        self.lock().ball_at()
    }

    /// Whether the ball is in the goal.
    pub fn is_in_goal(&self) -> bool {
        let (far, turn) = self.goal.towards(self.ball());
        let (sin, cos) = libm::sincos(turn);
        (0.0..=GOAL[1]).contains(&(far * cos)) && (far * sin).abs() <= GOAL[0] / 2.0
    }

    /// The match so far, from time to time.
    pub fn sketches(&self) -> Vec<Sketch> {
        self.lock().sketches.clone()
    }

    /// Lets time pass, and does something then.
    fn after<T>(&self, time: Duration, what: impl FnOnce(&mut Inner) -> T) -> T {
        let mut inner = self.lock();
        inner.pass(time);
        self.now.store(u64::try_from(inner.now.as_nanos()).unwrap_or(u64::MAX), Ordering::Relaxed);
        what(&mut inner)
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The middle of the goal, and the way into it from the origin.
pub fn facing([x, y]: [f64; 2]) -> Pose {
    let (_, yaw) = Pose::default().towards([x, y]);
    Pose { x, y, yaw }
}

/// The walls around the field, and the three of the goal.
fn build_walls(world: &mut World, goal: Pose) {
    let [[left, low], [right, high]] = CORNERS;
    world.wall([left, low], [right, low]);
    world.wall([right, low], [right, high]);
    world.wall([right, high], [left, high]);
    world.wall([left, high], [left, low]);
    let [width, depth] = GOAL;
    let corners = [(0.0, -1.0), (depth, -1.0), (depth, 1.0), (0.0, 1.0)];
    let corners = corners.map(|(ahead, side)| goal.point(ahead, side * width / 2.0));
    corners.windows(2).for_each(|pair| world.wall(pair[0], pair[1]));
}

fn build_robot(world: &mut World) -> Body {
    let robot = world.place(Pose::default(), Outline::Rectangle(BODY[0], BODY[1]), MASSES[0]);
    for pair in ARM.windows(2) {
        for stud in 0..=STUDS {
            let share = f64::from(stud) / f64::from(STUDS);
            let [x, y] = [0, 1].map(|axis| pair[0][axis] + (pair[1][axis] - pair[0][axis]) * share);
            for y in [y, -y] {
                world.fasten(robot, Pose { x, y, yaw: 0.0 }, Outline::Disc(ARM_THICK / 2.0));
            }
        }
    }
    robot
}

impl Inner {
    fn pass(&mut self, time: Duration) {
        let until = self.now + time;
        while self.now < until {
            self.step();
        }
    }

    fn step(&mut self) {
        self.reach_in();
        let seconds = STEP.as_secs_f64();
        self.wheels.iter_mut().for_each(|wheel| wheel.turn(seconds));
        self.pull(seconds);
        self.roll(seconds);
        self.strike(seconds);
        self.world.step();
        if self.now.as_nanos().is_multiple_of(SKETCH.as_nanos()) {
            let Pose { x, y, yaw } = self.world.pose(self.robot);
            let (time, ball) = (self.now.as_secs_f64(), self.ball_at());
            self.sketches.push(Sketch { time, robot: [x, y, yaw], ball, shines: self.shines });
        }
        self.now += STEP;
    }

    /// The tyres pull the robot along with its wheels, as far as they grip.
    fn pull(&mut self, seconds: f64) {
        let yaw = self.world.pose(self.robot).yaw;
        let moving = self.world.motion(self.robot).in_body(yaw);
        let [left, right] = self.wheels.each_ref().map(|wheel| wheel.speed().to_radians() * WHEEL);
        let to = |from: f64, to: f64, most: f64| from + (to - from).clamp(-most, most);
        let change = GRIP * seconds;
        let motion = Motion {
            x: to(moving.x, (left + right) / 2.0, change),
            y: to(moving.y, 0.0, change),
            turn: to(moving.turn, (right - left) / TRACK, change * 2.0 / TRACK),
        };
        self.world.set_motion(self.robot, motion.in_world(yaw));
    }

    /// The ball slows down.
    fn roll(&mut self, seconds: f64) {
        let motion = self.world.motion(self.ball);
        let speed = libm::hypot(motion.x, motion.y);
        let kept = if speed > 0.0 { (1.0 - ROLLING * seconds / speed).max(0.0) } else { 0.0 };
        self.world.set_motion(self.ball, Motion { x: motion.x * kept, y: motion.y * kept, turn: motion.turn * kept });
    }

    /// The arm strikes the ball, once a stroke.
    fn strike(&mut self, seconds: f64) {
        let has_ball = self.has_ball();
        if let Some(speed) = self.arm.swing(seconds, has_ball) {
            let yaw = self.world.pose(self.robot).yaw;
            let motion = self.world.motion(self.ball);
            let added = Motion { x: speed, ..Motion::default() }.in_world(yaw);
            self.world.set_motion(self.ball, Motion { x: motion.x + added.x, y: motion.y + added.y, ..motion });
        }
    }

    fn ball_at(&self) -> [f64; 2] {
        let Pose { x, y, .. } = self.world.pose(self.ball);
        [x, y]
    }

    /// Whether the ball is between the arms.
    fn has_ball(&self) -> bool {
        let (far, turn) = self.world.pose(self.robot).towards(self.ball_at());
        let (sin, cos) = libm::sincos(turn);
        let (ahead, side) = (far * cos - BODY[0] / 2.0, far * sin);
        (0.0..=BALL + 0.04).contains(&ahead) && side.abs() <= ARM[1][1]
    }
}

#[cfg(test)]
mod tests;
