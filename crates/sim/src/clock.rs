//! The time of the simulation, and the clock that shows it: it may jump.

use lapwing_stream::Time;

/// How many steps there are in a second.
pub const RATE: u64 = 200;
/// How long a step takes, in nanoseconds.
pub const STEP: i64 = 1_000_000_000 / RATE as i64;
/// How long a step takes, in seconds.
pub const SECONDS: f64 = 1.0 / RATE as f64;
/// By how much a clock jumps back, in seconds.
const JUMP: f64 = 5.0;

/// The time since the start, which only grows, and what is shown of it.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    step: u64,
    /// At which step it jumps back, and by how many nanoseconds.
    jump: Option<(u64, i64)>,
}

impl Clock {
    /// A clock that jumps back at that time, or does not.
    pub fn new(jump: Option<f64>) -> Clock {
        let jump = jump.map(|at| (steps(at), steps(at.min(JUMP)) as i64 * STEP));
        Clock { step: 0, jump }
    }

    /// A step passes.
    pub fn tick(&mut self) {
        self.step += 1;
    }

    /// How many steps have passed.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// The nanoseconds since the start.
    pub fn nanos(&self) -> i64 {
        self.step as i64 * STEP
    }

    /// The seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.step as f64 * SECONDS
    }

    /// What it shows.
    pub fn shown(&self) -> Time {
        let back = self.jump.filter(|(at, _)| self.step >= *at).map_or(0, |(_, back)| back);
        Time(self.nanos() - back)
    }
}

/// So many steps take so many seconds.
pub fn steps(seconds: f64) -> u64 {
    libm::round(seconds * RATE as f64) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_jumps_back_once_and_goes_on() {
        let mut clock = Clock::new(Some(10.0));
        let mut shown = Vec::new();
        for _ in 0..steps(12.0) {
            clock.tick();
            shown.push(clock.shown().0);
        }
        let jumps: Vec<usize> = (1..shown.len()).filter(|k| shown[*k] < shown[k - 1]).collect();
        assert_eq!(jumps, [steps(10.0) as usize - 1]);
        assert_eq!((shown[0], shown.last()), (STEP, Some(&7_000_000_000)));
    }
}
