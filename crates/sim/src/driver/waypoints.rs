//! From point to point, once or again and again.

use super::{View, towards};
use crate::base::Command;
use crate::random::Random;
use crate::scenario::{self, draw_point};

/// So near is there, in metres.
const THERE: f64 = 0.08;

/// A tour of points.
#[derive(Clone, Debug)]
pub struct Waypoints {
    points: Vec<[f64; 2]>,
    speed: f64,
    turn: f64,
    again: bool,
    next: usize,
}

impl Waypoints {
    /// With the numbers of this run.
    pub fn new(drive: &scenario::Waypoints, random: &mut Random) -> Waypoints {
        Waypoints {
            points: drive.points.iter().map(|p| draw_point(p, random)).collect(),
            speed: drive.speed.draw(random),
            turn: drive.turn.draw(random).to_radians(),
            again: drive.again,
            next: 0,
        }
    }

    /// To the next point; at the last one it stops.
    pub fn decide(&mut self, view: &View<'_>) -> Command {
        let Some(point) = self.points.get(self.next) else { return Command::default() };
        let (far, command) = towards(view.pose, *point, self.speed, self.turn);
        if far < THERE {
            self.next += 1;
            if self.again && self.next == self.points.len() {
                self.next = 0;
            }
        }
        command
    }
}
