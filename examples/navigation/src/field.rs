//! The floor that the robot drives on: walls, pillars, and the robot itself, which does what it was last told.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use lapwing_sim::{Body, Motion, Outline, Pose, Random, World};

/// How many seconds a step of the physics takes.
const STEP: f64 = 0.005;

/// How far the laser sees, in metres.
const REACH: f64 = 8.0;

/// How fast the robot gathers and loses speed, in m/s² and rad/s².
const RAMP: (f64, f64) = (1.5, 6.0);

/// How large the robot is: the radius of a disc, in metres.
pub const RADIUS: f64 = 0.2;

/// Where the pillars stand, and their radii.
pub const PILLARS: [([f64; 2], f64); 3] = [([2.2, 0.6], 0.3), ([4.0, -0.15], 0.3), ([5.6, 0.9], 0.25)];

/// The floor as all codels share it.
#[derive(Clone)]
pub struct Field(Arc<Mutex<Floor>>);

struct Floor {
    world: World,
    robot: Body,
    steps: u64,
    /// Forwards and anticlockwise, as commanded and as it is.
    command: (f64, f64),
    speed: (f64, f64),
    /// What the wheels have counted, which slips a little.
    counted: Pose,
    random: Random,
    bump: Option<f64>,
    travelled: f64,
}

/// What the robot's base says of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motions {
    /// Where the wheels have brought it, as they count.
    pub counted: Pose,
    /// Forwards, in m/s.
    pub linear: f64,
    /// Anticlockwise, in rad/s.
    pub angular: f64,
}

impl Field {
    /// A floor with walls and pillars, and the robot at its western end.
    pub fn new(seed: u64) -> Field {
        let mut world = World::new(STEP);
        let corners = [[-1.0, -2.5], [9.0, -2.5], [9.0, 2.5], [-1.0, 2.5]];
        for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            world.wall(*from, *to);
        }
        for ([x, y], radius) in PILLARS {
            world.fix(Pose { x, y, yaw: 0.0 }, Outline::Disc(radius));
        }
        let robot = world.place(Pose::default(), Outline::Disc(RADIUS), 20.0);
        world.step();
        Field(Arc::new(Mutex::new(Floor {
            world,
            robot,
            steps: 0,
            command: (0.0, 0.0),
            speed: (0.0, 0.0),
            counted: Pose::default(),
            random: Random::new(seed, "field", 0),
            bump: None,
            travelled: 0.0,
        })))
    }

    fn at(&self, seconds: f64) -> MutexGuard<'_, Floor> {
        let mut floor = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        floor.pass(seconds);
        floor
    }

    /// What the laser sees: from the right to the left, in so many directions.
    pub fn scan(&self, seconds: f64, beams: usize) -> Vec<f64> {
        let mut floor = self.at(seconds);
        let pose = floor.world.pose(floor.robot);
        let angle =
            |beam: usize| pose.yaw + std::f64::consts::PI * (beam as f64 / beams.max(2).saturating_sub(1) as f64 - 0.5);
        (0..beams)
            .map(|beam| {
                let far = floor.world.look([pose.x, pose.y], angle(beam), REACH, floor.robot).unwrap_or(REACH);
                (far + floor.random.normal(0.01)).clamp(0.0, REACH)
            })
            .collect()
    }

    /// Where a receiver believes that the robot is.
    pub fn fix(&self, seconds: f64, sigma: f64) -> [f64; 2] {
        let mut floor = self.at(seconds);
        let pose = floor.world.pose(floor.robot);
        [pose.x + floor.random.normal(sigma), pose.y + floor.random.normal(sigma)]
    }

    /// How fast an inertial unit believes that it turns.
    pub fn yaw_rate(&self, seconds: f64) -> f64 {
        let mut floor = self.at(seconds);
        floor.speed.1 + floor.random.normal(0.005)
    }

    /// What the base says.
    pub fn motions(&self, seconds: f64) -> Motions {
        let floor = self.at(seconds);
        Motions { counted: floor.counted, linear: floor.speed.0, angular: floor.speed.1 }
    }

    /// The base is told how fast to drive.
    pub fn command(&self, seconds: f64, linear: f64, angular: f64) {
        self.at(seconds).command = (linear, angular);
    }

    /// Where the robot really is.
    pub fn pose(&self, seconds: f64) -> Pose {
        let floor = self.at(seconds);
        floor.world.pose(floor.robot)
    }

    /// When the robot first ran into something, in seconds.
    pub fn bump(&self) -> Option<f64> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).bump
    }

    /// How far it has driven, in metres.
    pub fn travelled(&self) -> f64 {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).travelled
    }
}

impl Floor {
    /// Lets time pass.
    fn pass(&mut self, seconds: f64) {
        let until = (seconds / STEP) as u64;
        while self.steps < until {
            self.steps += 1;
            let towards = |now: f64, wanted: f64, ramp: f64| now + (wanted - now).clamp(-ramp * STEP, ramp * STEP);
            self.speed = (towards(self.speed.0, self.command.0, RAMP.0), towards(self.speed.1, self.command.1, RAMP.1));
            let motion = Motion { x: self.speed.0, y: 0.0, turn: self.speed.1 };
            let before = self.world.pose(self.robot);
            self.world.set_motion(self.robot, motion.in_world(before.yaw));
            self.world.step();
            let after = self.world.pose(self.robot);
            self.travelled += libm::hypot(after.x - before.x, after.y - before.y);
            self.counted = self.counted.moved(Motion { x: motion.x * 0.99, ..motion }, STEP);
            if self.bump.is_none() && self.world.touches(self.robot) {
                self.bump = Some(self.steps as f64 * STEP);
            }
        }
    }
}
