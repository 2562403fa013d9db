//! Straight on, with a stop at each sign.

use super::View;
use crate::base::Command;
use crate::pose::{Pose, wrap};
use crate::random::Random;
use crate::scenario;

/// How hard it brakes, in m/s².
const BRAKES: f64 = 0.8;
/// The least speed on the way to a stop, in m/s.
const CREEP: f64 = 0.05;
/// So much farther than where it stops a sign is out of mind, in metres.
const PAST: f64 = 0.5;

/// A car on a straight road.
#[derive(Clone, Debug)]
pub struct Road {
    /// The lane: where it began, and which way it goes.
    lane: Pose,
    speed: f64,
    stop: f64,
    wait: f64,
    stage: Stage,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Cruising,
    /// Until then, in seconds.
    Waiting(f64),
    /// Past the sign, which it still sees.
    Leaving,
}

impl Road {
    /// With the numbers of this run.
    pub fn new(drive: &scenario::Road, start: Pose, random: &mut Random) -> Road {
        Road {
            lane: start,
            speed: drive.speed.draw(random),
            stop: drive.stop.draw(random),
            wait: drive.wait.draw(random),
            stage: Stage::Cruising,
        }
    }

    /// On along the lane, as fast as the next sign allows.
    pub fn decide(&mut self, view: &View<'_>) -> Command {
        let ahead = self.speed(view);
        // Away from the lane to the left, and turned to the left.
        let (sin, cos) = libm::sincos(self.lane.yaw);
        let left = (view.on_lane.y - self.lane.y) * cos - (view.on_lane.x - self.lane.x) * sin;
        let turned = wrap(view.on_lane.yaw - self.lane.yaw);
        Command { ahead, turn: (-0.5 * left - 1.5 * turned).clamp(-0.5, 0.5) }
    }

    fn speed(&mut self, view: &View<'_>) -> f64 {
        let sign = view.sign.unwrap_or(f64::INFINITY);
        match self.stage {
            Stage::Cruising if sign <= self.stop => {
                self.stage = Stage::Waiting(view.now + self.wait);
                0.0
            }
            Stage::Cruising => (2.0 * BRAKES * (sign - self.stop)).sqrt().max(CREEP).min(self.speed),
            Stage::Waiting(until) if view.now < until => 0.0,
            Stage::Waiting(_) => {
                self.stage = Stage::Leaving;
                self.speed
            }
            Stage::Leaving => {
                if sign > self.stop + PAST {
                    self.stage = Stage::Cruising;
                }
                self.speed
            }
        }
    }
}
