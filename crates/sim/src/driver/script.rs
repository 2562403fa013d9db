//! Commands at given times, each repeated until the next.

use super::View;
use crate::base::Command;
use crate::random::Random;
use crate::scenario::Line;

/// A script.
#[derive(Clone, Debug)]
pub struct Script {
    /// Since when, and what; nothing is silence.
    lines: Vec<(f64, Option<Command>)>,
}

impl Script {
    /// With the numbers of this run.
    pub fn new(lines: &[Line], random: &mut Random) -> Script {
        let line = |line: &Line| {
            let at = line.at.draw(random);
            let command = Command { ahead: line.ahead.draw(random), turn: line.turn.draw(random).to_radians() };
            (at, (!line.silent).then_some(command))
        };
        let mut lines: Vec<_> = lines.iter().map(line).collect();
        lines.sort_by(|a, b| a.0.total_cmp(&b.0));
        Script { lines }
    }

    /// The last command that has begun.
    pub fn decide(&self, view: &View<'_>) -> Option<Command> {
        self.lines.iter().rev().find(|(at, _)| *at <= view.now).and_then(|(_, command)| *command)
    }
}
