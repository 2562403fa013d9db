//! A base with two driven wheels: it turns a command into motion, as far as its motors and the grip of its tyres allow.

use crate::pose::Motion;

/// What a base is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Build {
    /// The mass, in kilograms.
    pub mass: f64,
    /// The distance between the wheels, in metres.
    pub track: f64,
    /// The radius of a wheel, in metres.
    pub wheel: f64,
    /// The greatest speed, in m/s.
    pub speed: f64,
    /// The greatest turn, in rad/s.
    pub turn: f64,
    /// By how much the firmware lets a wheel's speed change, in m/s².
    pub ramp: f64,
    /// By how much the tyres can change the speed at most, in m/s².
    pub grip: f64,
    /// For how long a command counts, in seconds.
    pub patience: f64,
}

/// A command: forwards in m/s, and anticlockwise in rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Forwards.
    pub ahead: f64,
    /// Anticlockwise.
    pub turn: f64,
}

/// The base and its wheels.
#[derive(Clone, Debug)]
pub struct Base {
    build: Build,
    command: Command,
    /// For how long the command has been there, in seconds.
    age: f64,
    /// The speeds of the left and the right wheel over the floor, in m/s.
    speeds: [f64; 2],
    /// How far each wheel has rolled, in metres.
    rolled: [f64; 2],
    stop: Stop,
}

/// The emergency stop: once pressed it has to be released, and then the base has to be enabled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stop {
    Free,
    Pressed,
    Released,
}

impl Base {
    /// A base at rest.
    pub fn new(build: Build) -> Base {
        Base {
            build,
            command: Command::default(),
            age: f64::INFINITY,
            speeds: [0.0; 2],
            rolled: [0.0; 2],
            stop: Stop::Free,
        }
    }

    /// What it is like.
    pub fn build(&self) -> &Build {
        &self.build
    }

    /// From now on the wheels change their speed at once, and the tyres do what they can.
    pub fn stop_smoothing(&mut self) {
        self.build.ramp = f64::INFINITY;
    }

    /// It is told what to do.
    pub fn obey(&mut self, command: Command) {
        (self.command, self.age) = (command, 0.0);
    }

    /// The emergency stop is pressed or released.
    pub fn set_stop(&mut self, pressed: bool) {
        self.stop = match (self.stop, pressed) {
            (_, true) => Stop::Pressed,
            (Stop::Pressed, false) => Stop::Released,
            (stop, false) => stop,
        };
    }

    /// It may move again, where the emergency stop is released.
    pub fn enable(&mut self) {
        if self.stop == Stop::Released {
            self.stop = Stop::Free;
        }
    }

    /// Some seconds pass; `moving` is how it moves, in its own frame, and the result is how it moves then.
    pub fn drive(&mut self, moving: Motion, seconds: f64) -> Motion {
        self.age += seconds;
        let wanted = if self.age > self.build.patience || self.stop != Stop::Free {
            [0.0; 2]
        } else {
            self.wheels(self.command)
        };
        let change = self.build.ramp * seconds;
        for ((speed, rolled), wanted) in self.speeds.iter_mut().zip(&mut self.rolled).zip(wanted) {
            *speed += (wanted - *speed).clamp(-change, change);
            *rolled += *speed * seconds;
        }
        self.pull(moving, seconds)
    }

    /// The speeds of the wheels that a command asks for, within the limits.
    fn wheels(&self, command: Command) -> [f64; 2] {
        let ahead = command.ahead.clamp(-self.build.speed, self.build.speed);
        let side = command.turn.clamp(-self.build.turn, self.build.turn) * self.build.track / 2.0;
        [ahead - side, ahead + side]
    }

    /// The tyres pull the base along with the wheels. What they cannot hold slips, and the wheels count it all the same.
    fn pull(&self, moving: Motion, seconds: f64) -> Motion {
        let [left, right] = self.speeds;
        let change = self.build.grip * seconds;
        let to = |from: f64, to: f64, most: f64| from + (to - from).clamp(-most, most);
        Motion {
            x: to(moving.x, (left + right) / 2.0, change),
            y: to(moving.y, 0.0, change),
            turn: to(moving.turn, (right - left) / self.build.track, change * 2.0 / self.build.track),
        }
    }

    /// The speeds of the left and the right wheel over the floor, in m/s.
    pub fn speeds(&self) -> [f64; 2] {
        self.speeds
    }

    /// How far the left and the right wheel have rolled, in metres.
    pub fn rolled(&self) -> [f64; 2] {
        self.rolled
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BUILD: Build =
        Build { mass: 1.0, track: 0.16, wheel: 0.033, speed: 0.22, turn: 2.84, ramp: 1.0, grip: 6.0, patience: 0.6 };

    /// How a base moves after some seconds of a command that is repeated, or not.
    fn after(base: &mut Base, seconds: f64, command: Option<Command>) -> Motion {
        let mut motion = Motion::default();
        for _ in 0..(seconds / 0.005) as usize {
            command.into_iter().for_each(|c| base.obey(c));
            motion = base.drive(motion, 0.005);
        }
        motion
    }

    #[test]
    fn it_does_what_it_is_told_within_its_limits() {
        let mut base = Base::new(BUILD);
        let motion = after(&mut base, 2.0, Some(Command { ahead: 9.0, turn: 0.5 }));
        assert!((motion.x - 0.22).abs() < 1e-9 && (motion.turn - 0.5).abs() < 1e-9, "{motion:?}");
    }

    #[test]
    fn it_stops_when_nobody_speaks_to_it() {
        let mut base = Base::new(BUILD);
        base.obey(Command { ahead: 0.2, turn: 0.0 });
        assert!(after(&mut base, 0.5, None).x > 0.19);
        assert_eq!(after(&mut base, 0.6, None), Motion::default());
    }

    #[test]
    fn after_an_emergency_stop_it_waits_to_be_enabled() {
        let (mut base, forwards) = (Base::new(BUILD), Some(Command { ahead: 0.2, turn: 0.0 }));
        base.set_stop(true);
        assert_eq!(after(&mut base, 1.0, forwards).x, 0.0);
        base.enable();
        assert_eq!(after(&mut base, 1.0, forwards).x, 0.0, "enabled while it is pressed");
        base.set_stop(false);
        assert_eq!(after(&mut base, 1.0, forwards).x, 0.0, "released only");
        base.enable();
        assert!(after(&mut base, 1.0, forwards).x > 0.19);
    }
}
