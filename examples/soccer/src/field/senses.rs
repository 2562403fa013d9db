//! What the sensors make of the field.

use std::time::Duration;

use lapwing_sim::Random;

use super::{BODY, Inner};
use crate::robot::InfraredMode;

/// How long a look of the seeker takes, a ping of the sonar, and a look at the compass.
pub(super) const LOOK: Duration = Duration::from_millis(8);
pub(super) const PING: Duration = Duration::from_millis(16);
pub(super) const NEEDLE: Duration = Duration::from_millis(2);

/// A sonar that pings again before so much time has passed may hear its own echo.
const QUIET: Duration = Duration::from_millis(10);
/// How often it then errs.
const ERRORS: f64 = 1.0 / 3.0;
/// How far the sonar hears, in metres, and how wide, in degrees to each side.
const HEARS: f64 = 2.55;
const CONE: f64 = 14.0;
/// How exactly it hears, in metres.
const HEARING: f64 = 0.0002;
/// Where sonar and seeker sit, ahead of the robot's middle: the sonar a little behind the front, so that what touches it is not too near.
const SONAR: f64 = BODY[0] / 2.0 - 0.03;
const SEEKER: f64 = 0.06;

/// What lies farther to a side is in the seeker's dead zone, in degrees.
const SPAN: f64 = 135.0;
/// The seeker's steps, in degrees.
const SECTOR: f64 = 30.0;
/// How exactly the compass shows, in degrees.
const COMPASS: f64 = 0.4;

impl Inner {
    /// The direction of the ball in degrees clockwise, in steps; not a number without a signal.
    pub(super) fn infrared(&mut self, mode: InfraredMode) -> f64 {
        let robot = self.world.pose(self.robot);
        let [x, y] = robot.point(SEEKER, 0.0);
        let (far, turn) = lapwing_sim::Pose { x, y, ..robot }.towards(self.ball_at());
        let clockwise = -turn.to_degrees();
        let (chance, reach, spread): (&mut Random, f64, f64) = match mode {
            InfraredMode::Unmodulated => (&mut self.chance.unmodulated, 4.0, 4.0),
            InfraredMode::Modulated => (&mut self.chance.modulated, 2.5, 1.5),
        };
        let seen = clockwise + chance.normal(spread);
        if !self.shines || far > reach || clockwise.abs() > SPAN {
            return f64::NAN;
        }
        // No negative zero: who reads the log should see 0.
        (seen / SECTOR).round().clamp(-4.0, 4.0) * SECTOR + 0.0
    }

    /// The distance to the next thing ahead, in metres; infinite without an echo, 0 after an error.
    pub(super) fn sonar(&mut self) -> f64 {
        let started = self.now.saturating_sub(PING);
        let is_hasty = self.pinged.is_some_and(|last| started.saturating_sub(last) < QUIET);
        self.pings += 1;
        self.pinged = Some(self.now);
        let (slip, noise) = (self.chance.sonar.unit(), self.chance.sonar.normal(HEARING));
        if is_hasty && slip < ERRORS {
            return 0.0;
        }
        let robot = self.world.pose(self.robot);
        let from = robot.point(SONAR, 0.0);
        let beams = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|side| robot.yaw + (side * CONE).to_radians());
        let echoes = beams.into_iter().filter_map(|beam| self.world.look(from, beam, HEARS, self.robot));
        echoes.map(|far| (far + noise).max(0.003)).fold(f64::INFINITY, f64::min)
    }

    /// The heading in whole degrees, anticlockwise from the east.
    pub(super) fn compass(&mut self) -> f64 {
        let heading = self.world.pose(self.robot).yaw.to_degrees() + self.chance.compass.normal(COMPASS);
        heading.round().rem_euclid(360.0)
    }
}
