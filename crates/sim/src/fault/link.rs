//! The way of a command from `/cmd_vel_original`, where the program publishes it, to `/cmd_vel`, where the base hears it.

use super::{Fault, Faults};
use crate::base::Command;

/// Below this speed a base with inverted directions turns the other way, in m/s.
const SLOW_TURN: f64 = 0.012;
/// Below this speed a base that gets stuck does not move, in m/s.
const TOO_SLOW: f64 = 0.015;
/// Above this speed a base that goes backwards does so, in m/s.
const FAST: f64 = 0.03;
/// For how long a command is repeated when the base does not notice that none comes, in seconds.
const REPEATED: f64 = 2.0;
/// How often it is then repeated, in seconds.
const EVERY: f64 = 0.05;

/// The way from the program to the base.
#[derive(Clone, Debug, Default)]
pub struct Link {
    last: Option<Passed>,
}

/// A command that went through: when it came, and when it was handed on last.
#[derive(Clone, Copy, Debug)]
struct Passed {
    command: Command,
    came: f64,
    handed: f64,
}

impl Link {
    /// What becomes of a command that the program gives; nothing, where it is lost.
    pub fn pass(&mut self, command: Command, faults: &Faults, now: f64) -> Option<Command> {
        if faults.has(Fault::CommandLost, now) {
            return None;
        }
        let command = altered(command, faults, now);
        self.last = Some(Passed { command, came: now, handed: now });
        Some(command)
    }

    /// What is handed on although the program said nothing.
    pub fn repeat(&mut self, faults: &Faults, now: f64) -> Option<Command> {
        let last = self.last.as_mut()?;
        let is_due = now - last.handed > EVERY + 1e-9 && now - last.came < REPEATED;
        if !is_due || !faults.has(Fault::CommandTimeout, now) {
            return None;
        }
        last.handed = now;
        Some(last.command)
    }
}

fn altered(command: Command, faults: &Faults, now: f64) -> Command {
    let mut altered = command;
    if faults.has(Fault::DirectionInverted, now) && command.ahead.abs() < SLOW_TURN {
        altered.turn = -command.turn;
    }
    if faults.has(Fault::DockingStuck, now) && command.ahead.abs() < TOO_SLOW {
        altered.ahead = 0.0;
    }
    if faults.has(Fault::Backwards, now) && command.ahead.abs() > FAST {
        altered.ahead = -command.ahead;
    }
    let scale = match (faults.has(Fault::Sluggish, now), faults.has(Fault::Overspeed, now)) {
        (true, _) => 0.5,
        (_, true) => 1.5,
        _ => 1.0,
    };
    Command { ahead: altered.ahead * scale, turn: altered.turn * scale }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn through(fault: &str, ahead: f64, turn: f64) -> Option<Command> {
        let faults = Faults::of("robot", &[fault.parse().unwrap()], 30.0);
        Link::default().pass(Command { ahead, turn }, &faults, 1.0)
    }

    #[test]
    fn commands_are_altered_as_the_bugs_did() {
        for (fault, told, done) in [
            ("direction-inverted", (-0.01, 0.5), (-0.01, -0.5)),
            ("direction-inverted", (-0.02, 0.5), (-0.02, 0.5)),
            ("docking-stuck", (0.014, 0.5), (0.0, 0.5)),
            ("docking-stuck", (0.016, 0.5), (0.016, 0.5)),
            ("backwards", (0.04, 0.5), (-0.04, 0.5)),
            ("backwards", (0.02, 0.5), (0.02, 0.5)),
            ("sluggish", (0.2, 0.5), (0.1, 0.25)),
            ("overspeed", (0.2, 0.5), (0.3, 0.75)),
            ("frozen-scan", (0.2, 0.5), (0.2, 0.5)),
        ] {
            let (ahead, turn) = told;
            let done = Command { ahead: done.0, turn: done.1 };
            let got = through(fault, ahead, turn).unwrap();
            assert!((got.ahead - done.ahead).abs() < 1e-12 && (got.turn - done.turn).abs() < 1e-12, "{fault}: {got:?}");
        }
        assert_eq!(through("command-lost", 0.2, 0.0), None);
    }

    #[test]
    fn the_last_command_is_repeated_for_two_seconds() {
        let faults = Faults::of("robot", &["command-timeout".parse().unwrap()], 30.0);
        let mut link = Link::default();
        assert_eq!(link.repeat(&faults, 0.5), None);
        link.pass(Command { ahead: 0.2, turn: 0.0 }, &faults, 1.0);
        let times: Vec<f64> = (0..600).map(|k| 1.0 + f64::from(k) * 0.005).collect();
        let repeated: Vec<f64> = times.into_iter().filter(|t| link.repeat(&faults, *t).is_some()).collect();
        assert!(repeated.len() > 30 && repeated.iter().all(|t| *t < 3.0), "{repeated:?}");
        assert_eq!(Link::default().repeat(&Faults::default(), 1.0), None);
    }
}
