//! Where something is on the floor, and how fast it moves.
//!
//! Sines and cosines come from `libm`: those of the standard library differ between machines, and would make recordings differ.

use std::f64::consts::{PI, TAU};

/// A place on the floor and a heading, in metres and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// To the east.
    pub x: f64,
    /// To the north.
    pub y: f64,
    /// Anticlockwise from the east.
    pub yaw: f64,
}

/// How fast something moves, in metres and radians a second: in its own frame or in the world's, as is said where it is used.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Forwards, or to the east.
    pub x: f64,
    /// To the left, or to the north.
    pub y: f64,
    /// Anticlockwise.
    pub turn: f64,
}

impl Pose {
    /// From here straight to a point: how far, and by how much to turn to face it.
    pub fn towards(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        let (dx, dy) = (x - self.x, y - self.y);
        (libm::hypot(dx, dy), wrap(libm::atan2(dy, dx) - self.yaw))
    }

    /// The point that lies so far ahead and to the left.
    pub fn point(&self, ahead: f64, left: f64) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.yaw);
        [self.x + ahead * cos - left * sin, self.y + ahead * sin + left * cos]
    }

    /// Moved on by a motion in its own frame, for so many seconds.
    pub fn moved(&self, motion: Motion, seconds: f64) -> Pose {
        // Half of the turn first: the chord of the arc, nearly.
        let middle = Pose { yaw: self.yaw + motion.turn * seconds / 2.0, ..*self };
        let [x, y] = middle.point(motion.x * seconds, motion.y * seconds);
        Pose { x, y, yaw: wrap(self.yaw + motion.turn * seconds) }
    }
}

impl Motion {
    /// The motion of something with that heading, from its own frame to that of the world.
    pub fn in_world(self, yaw: f64) -> Motion {
        let (sin, cos) = libm::sincos(yaw);
        Motion { x: self.x * cos - self.y * sin, y: self.x * sin + self.y * cos, turn: self.turn }
    }

    /// The motion of something with that heading, from the frame of the world to its own.
    pub fn in_body(self, yaw: f64) -> Motion {
        self.in_world(-yaw)
    }
}

/// An angle within half a turn.
pub fn wrap(angle: f64) -> f64 {
    if (-PI..=PI).contains(&angle) {
        return angle;
    }
    let turned = libm::fmod(angle + PI, TAU);
    if turned < 0.0 { turned + PI } else { turned - PI }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_wrapped() {
        for (angle, wrapped) in [(0.5, 0.5), (PI + 0.5, 0.5 - PI), (-PI - 0.5, PI - 0.5), (5.0 * TAU + 1.0, 1.0)] {
            assert!((wrap(angle) - wrapped).abs() < 1e-12, "{angle}");
        }
    }

    #[test]
    fn a_quarter_of_a_circle_ends_where_it_should() {
        let mut pose = Pose::default();
        for _ in 0..1000 {
            pose = pose.moved(Motion { x: 1.0, y: 0.0, turn: 1.0 }, PI / 2000.0);
        }
        assert!((pose.x - 1.0).abs() < 1e-5 && (pose.y - 1.0).abs() < 1e-5 && (pose.yaw - PI / 2.0).abs() < 1e-9);
        let (far, turn) = Pose { x: 1.0, y: 0.0, yaw: PI / 2.0 }.towards([1.0, 2.0]);
        assert!((far - 2.0).abs() < 1e-12 && turn.abs() < 1e-12);
        let there = Motion { x: 1.0, y: 0.5, turn: 0.1 };
        let back = there.in_world(0.7).in_body(0.7);
        assert!((back.x - 1.0).abs() < 1e-12 && (back.y - 0.5).abs() < 1e-12);
    }
}
