//! Odometry: what the encoders of the wheels make a robot believe. It takes the wheels for a little larger or smaller than they are, and so drifts.

use crate::base::Build;
use crate::pose::{Motion, Pose};
use crate::random::Random;

/// The encoders, and the belief that they lead to.
#[derive(Clone, Debug)]
pub struct Encoders {
    track: f64,
    /// By how much each wheel is taken to be larger than it is.
    scales: [f64; 2],
    /// The noise of the speed, as a share of it.
    noise: f64,
    rolled: [f64; 2],
    pose: Pose,
    motion: Motion,
    random: Random,
}

impl Encoders {
    /// Of a base that starts there, and knows it.
    pub fn new(build: &Build, start: Pose, drift: f64, noise: f64, mut random: Random) -> Encoders {
        let scales = [0; 2].map(|_| 1.0 + random.normal(drift));
        Encoders { track: build.track, scales, noise, rolled: [0.0; 2], pose: start, motion: Motion::default(), random }
    }

    /// The wheels have rolled so far by now, in metres since the start, and some seconds have passed.
    pub fn count(&mut self, rolled: [f64; 2], seconds: f64) {
        let way = |k: usize| (rolled[k] - self.rolled[k]) * self.scales[k];
        let (left, right) = (way(0), way(1));
        self.rolled = rolled;
        self.motion = Motion { x: (left + right) / 2.0 / seconds, y: 0.0, turn: (right - left) / self.track / seconds };
        self.pose = self.pose.moved(self.motion, seconds);
    }

    /// One of the wheels is taken to be larger yet.
    pub fn set_drift(&mut self, share: f64) {
        self.scales[1] = 1.0 + share;
    }

    /// Where the robot believes to be.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// From now on it believes to be there.
    pub fn set_pose(&mut self, pose: Pose) {
        self.pose = pose;
    }

    /// How it believes to move, in its own frame, as it is read off now.
    pub fn read(&mut self) -> Motion {
        let mut noisy = |value: f64| value * (1.0 + self.random.normal(self.noise));
        Motion { x: noisy(self.motion.x), y: 0.0, turn: noisy(self.motion.turn) }
    }
}
