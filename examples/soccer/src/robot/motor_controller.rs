//! What moves: the wheels, by way of the navigator, and the arm.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tracing::{debug, instrument};

use super::hardware::{Brick, MotorPort, NotConnected, SensorPort, UnregulatedMotor};
use super::navigator::{Navigator, Position};
use super::settings::Settings;

/// The wheels and the arm.
pub struct MotorController {
    brick: Arc<dyn Brick>,
    navigator: Mutex<Navigator>,
    arm: Box<dyn UnregulatedMotor>,
    goal: [f64; 2],
    goal_range: f64,
}

/// The ports of the motors and of the compass.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ports {
    pub left: MotorPort,
    pub right: MotorPort,
    pub arm: MotorPort,
    pub compass: SensorPort,
}

/// How long it takes until a turn is looked at again.
const GLANCE: Duration = Duration::from_millis(10);
/// How nearly a turn is done, in degrees.
const TURNED: f64 = 1.0;
/// How many glances a turn gets; at the slowest, more than a whole turn.
const GLANCES: u32 = 4000;

impl MotorController {
    /// Connects to the motors and the compass.
    pub(super) fn new(brick: Arc<dyn Brick>, ports: Ports, settings: &Settings) -> Result<Self, NotConnected> {
        let (left, right) = (brick.regulated_motor(ports.left)?, brick.regulated_motor(ports.right)?);
        let arm = brick.unregulated_motor(ports.arm)?;
        let navigator = Navigator::new(left, right, brick.compass(ports.compass)?, settings);
        let (goal, goal_range) = (settings.goal, settings.goal_range);
        Ok(MotorController { brick, navigator: Mutex::new(navigator), arm, goal, goal_range })
    }

    /// Lets the navigator go on, and says where the robot is and how its wheels turn.
    pub fn update(&self) -> Position {
        let (Position { x, y, heading }, [left_speed, right_speed]) = {
            let mut navigator = self.navigator();
            navigator.update();
            (navigator.position(), navigator.wheel_speeds())
        };
        debug!(x, y, heading, left_speed, right_speed);
        Position { x, y, heading }
    }

    /// Whether the goal is near enough for a shot.
    #[instrument(level = "debug", skip_all, ret)]
    pub fn in_goal_range(&self) -> bool {
        self.update().distance(self.goal) <= self.goal_range
    }

    /// Drives straight on at that speed, in m/s.
    pub fn go_forward(&self, speed: f64) {
        let mut navigator = self.navigator();
        navigator.set_linear_speed(speed);
        navigator.forward();
    }

    /// Sets out for the goal, at those speeds in m/s and degrees a second, unless it is on its way.
    pub fn set_out_for_goal(&self, speed: f64, turn: f64) {
        let mut navigator = self.navigator();
        navigator.set_linear_speed(speed);
        navigator.set_angular_speed(turn);
        navigator.go_to(self.goal);
    }

    /// Turns by an angle in degrees, anticlockwise, at that speed in degrees a second. Returns when it has turned.
    #[instrument(level = "debug", skip(self))]
    pub fn turn(&self, speed: f64, angle: f64) {
        let mut before = self.update().heading;
        let mut left = angle;
        {
            let mut navigator = self.navigator();
            navigator.set_angular_speed(speed);
            navigator.spin(angle > 0.0);
        }
        for _ in 0..GLANCES {
            self.brick.delay(GLANCE);
            let heading = self.update().heading;
            left -= (heading - before + 540.0).rem_euclid(360.0) - 180.0;
            before = heading;
            if left * angle.signum() <= TURNED {
                break;
            }
        }
        self.stop();
    }

    /// Moves the arm at full power: each step forwards or else backwards, for so long.
    #[instrument(level = "debug", skip_all)]
    pub fn move_arm(&self, steps: &[(bool, Duration)]) {
        self.arm.set_power(100.0);
        for (forward, time) in steps {
            if *forward {
                self.arm.forward()
            } else {
                self.arm.backward()
            }
            self.brick.delay(*time);
        }
        self.arm.stop();
    }

    /// Stops the wheels.
    pub fn stop(&self) {
        self.navigator().stop();
    }

    fn navigator(&self) -> MutexGuard<'_, Navigator> {
        self.navigator.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
