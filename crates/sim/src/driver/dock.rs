//! To a point in front of a dock, and from there slowly into it.

use super::{View, towards};
use crate::base::Command;
use crate::random::Random;
use crate::scenario::{DockDrive, draw_point};

/// So near is there, in metres.
const THERE: f64 = 0.05;
/// How fast it turns, in rad/s.
const TURN: f64 = 1.0;

/// The way into a dock.
#[derive(Clone, Debug)]
pub struct Dock {
    before: [f64; 2],
    at: [f64; 2],
    speed: f64,
    creep: f64,
    stage: Stage,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Approach,
    Creep,
    Docked,
}

impl Dock {
    /// With the numbers of this run.
    pub fn new(drive: &DockDrive, random: &mut Random) -> Dock {
        Dock {
            before: draw_point(&drive.before, random),
            at: draw_point(&drive.at, random),
            speed: drive.speed.draw(random),
            creep: drive.creep.draw(random),
            stage: Stage::Approach,
        }
    }

    /// On, until it is there.
    pub fn decide(&mut self, view: &View<'_>) -> Command {
        let (point, speed, next) = match self.stage {
            Stage::Approach => (self.before, self.speed, Stage::Creep),
            Stage::Creep => (self.at, self.creep, Stage::Docked),
            Stage::Docked => return Command::default(),
        };
        let (far, command) = towards(view.pose, point, speed, TURN);
        if far < THERE {
            self.stage = next;
        }
        command
    }
}
