//! The programs of robots: what each decides from what its robot knows, twenty times a second.

mod dock;
mod follow;
mod road;
mod script;
mod wander;
mod waypoints;

use crate::base::Command;
use crate::pose::Pose;
use crate::random::Random;
use crate::scenario::Drive;

/// What a program knows when it decides.
#[derive(Clone, Copy, Debug, Default)]
pub struct View<'v> {
    /// The seconds since the start.
    pub now: f64,
    /// Where the robot believes to be.
    pub pose: Pose,
    /// Where its camera, which sees the lane, places it.
    pub on_lane: Pose,
    /// Its last scan; empty where there was none.
    pub scan: &'v [f32],
    /// How far the robot that it follows is, and by how much to turn to face it.
    pub leader: Option<(f64, f64)>,
    /// How far the nearest sign is.
    pub sign: Option<f64>,
}

/// A program.
#[derive(Clone, Debug)]
pub enum Driver {
    /// It gives no commands.
    Rest,
    /// Commands at given times.
    Script(script::Script),
    /// From point to point.
    Waypoints(waypoints::Waypoints),
    /// Anywhere.
    Wander(wander::Wander),
    /// To a dock.
    Dock(dock::Dock),
    /// Behind another robot.
    Follow(follow::Follow),
    /// Along a road.
    Road(road::Road),
}

impl Driver {
    /// The program that a scenario asks for, of a robot that starts there.
    pub fn new(drive: &Drive, start: Pose, mut random: Random) -> Driver {
        let random = &mut random;
        match drive {
            Drive::Rest {} => Driver::Rest,
            Drive::Script(lines) => Driver::Script(script::Script::new(lines, random)),
            Drive::Waypoints(drive) => Driver::Waypoints(waypoints::Waypoints::new(drive, random)),
            Drive::Wander(drive) => Driver::Wander(wander::Wander::new(drive, random.clone())),
            Drive::Dock(drive) => Driver::Dock(dock::Dock::new(drive, random)),
            Drive::Follow(drive) => Driver::Follow(follow::Follow::new(drive, random)),
            Drive::Road(drive) => Driver::Road(road::Road::new(drive, start, random)),
        }
    }

    /// What it commands now; nothing, where it says nothing.
    pub fn decide(&mut self, view: &View<'_>) -> Option<Command> {
        match self {
            Driver::Rest => None,
            Driver::Script(driver) => driver.decide(view),
            Driver::Waypoints(driver) => Some(driver.decide(view)),
            Driver::Wander(driver) => Some(driver.decide(view)),
            Driver::Dock(driver) => Some(driver.decide(view)),
            Driver::Follow(driver) => Some(driver.decide(view)),
            Driver::Road(driver) => Some(driver.decide(view)),
        }
    }

    /// Whether it looks at scans.
    pub fn needs_scans(&self) -> bool {
        matches!(self, Driver::Wander(_))
    }

    /// Whether it looks for signs.
    pub fn needs_signs(&self) -> bool {
        matches!(self, Driver::Road(_))
    }
}

/// Towards a point: how far it is, and the command that leads there.
fn towards(pose: Pose, point: [f64; 2], speed: f64, turn: f64) -> (f64, Command) {
    /// Where a robot looks farther away from its goal than this it turns on the spot first, in radians.
    const ASIDE: f64 = 0.4;
    let (far, aside) = pose.towards(point);
    let steer = (2.0 * aside).clamp(-turn, turn);
    let ahead = if aside.abs() > ASIDE { 0.0 } else { speed };
    (far, Command { ahead, turn: steer })
}
