//! Anywhere, but not into what the scanner sees.

use super::View;
use crate::base::Command;
use crate::random::Random;
use crate::scenario::{self, Amount};

/// How far to either side of straight ahead it looks for obstacles, in degrees, which is in rays.
const SIDE: usize = 50;
/// How fast it turns away from one, in rad/s.
const AWAY: f64 = 1.0;

/// A walk at random.
#[derive(Clone, Debug)]
pub struct Wander {
    speed: Amount,
    turn: Amount,
    keep: Amount,
    clear: f64,
    random: Random,
    choice: Command,
    until: f64,
    /// The turn by which it avoids an obstacle, until the way is clear.
    avoiding: Option<f64>,
}

impl Wander {
    /// With the numbers of this run.
    pub fn new(drive: &scenario::Wander, mut random: Random) -> Wander {
        Wander {
            speed: drive.speed.clone(),
            turn: drive.turn.clone(),
            keep: drive.keep.clone(),
            clear: drive.clear.draw(&mut random),
            random,
            choice: Command::default(),
            until: 0.0,
            avoiding: None,
        }
    }

    /// On, or away from what is in the way.
    pub fn decide(&mut self, view: &View<'_>) -> Command {
        // Before the first scan it cannot know what is in its way.
        if view.scan.is_empty() {
            return Command::default();
        }
        let (left, right) =
            (nearest(view.scan, 0..SIDE), nearest(view.scan, view.scan.len().saturating_sub(SIDE)..usize::MAX));
        if f64::from(left.min(right)) < self.clear {
            let away = if left < right { -AWAY } else { AWAY };
            return Command { ahead: 0.0, turn: *self.avoiding.get_or_insert(away) };
        }
        self.avoiding = None;
        if view.now >= self.until {
            let side = if self.random.unit() < 0.5 { -1.0 } else { 1.0 };
            self.choice = Command {
                ahead: self.speed.draw(&mut self.random),
                turn: side * self.turn.draw(&mut self.random).to_radians(),
            };
            self.until = view.now + self.keep.draw(&mut self.random);
        }
        self.choice
    }
}

fn nearest(scan: &[f32], rays: std::ops::Range<usize>) -> f32 {
    scan.iter().skip(rays.start).take(rays.len()).copied().fold(f32::INFINITY, f32::min)
}
