//! Behind another robot, at a distance.

use super::View;
use crate::base::Command;
use crate::random::Random;
use crate::scenario;

/// By how much it is faster for each metre that it is too far behind, in 1/s.
const EAGER: f64 = 5.0;

/// A follower.
#[derive(Clone, Debug)]
pub struct Follow {
    gap: f64,
    speed: f64,
}

impl Follow {
    /// With the numbers of this run.
    pub fn new(drive: &scenario::Follow, random: &mut Random) -> Follow {
        Follow { gap: drive.gap.draw(random), speed: drive.speed.draw(random) }
    }

    /// Faster the farther behind it is. Where it does not see the other one it stops.
    pub fn decide(&self, view: &View<'_>) -> Command {
        let Some((far, aside)) = view.leader else { return Command::default() };
        Command { ahead: (EAGER * (far - self.gap)).clamp(0.0, self.speed), turn: (2.0 * aside).clamp(-1.0, 1.0) }
    }
}
