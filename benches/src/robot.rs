//! W2: a robot's log at 1 kHz, and what one asks of it: a limit, a response, a freshness, a caution; each with the loop that one would write
//! for it by hand, and a hundred of them together.

/// The columns of a row.
pub const COLUMNS: [&str; 8] = ["x", "y", "vx", "vy", "wz", "min_laser", "scan", "speed"];
/// One step's values. `scan` is 1 in the step in which one came.
pub type Row = [f64; 8];

const LASER: usize = 5;
const SCAN: usize = 6;
const SPEED: usize = 7;

/// A property of the robot, with the number of its variant: constants are spread, so that no two are one.
#[derive(Clone, Copy, Debug)]
pub enum Question {
    /// `speed < 2`
    Limit(u32),
    /// After an obstacle nearer than 1 m, a stop within 0.5 s.
    Response(u32),
    /// Moving implies a scan within 100 ms.
    Freshness(u32),
    /// Fast only where there is room, once there was plenty.
    Caution(u32),
}

use Question::{Caution, Freshness, Limit, Response};

/// The four, each alone.
pub const FOUR: [Question; 4] = [Limit(0), Response(0), Freshness(0), Caution(0)];

/// Twenty-five of each.
pub fn hundred() -> Vec<Question> {
    (0..25).flat_map(|i| [Limit(i), Response(i), Freshness(i), Caution(i)]).collect()
}

impl Question {
    /// What it asks, in Lapwing's language.
    pub fn formula(self) -> String {
        match self {
            Limit(i) => format!("speed < {}", top(i)),
            Response(i) => {
                format!("whenever min_laser < {}, eventually within {} ms speed < 0.01", near(i), patience(i))
            }
            Freshness(i) => format!("speed > {} implies once within {} ms scan > 0", moving(i), age(i)),
            Caution(i) => format!("speed > {} implies (min_laser >= 0.3 since min_laser > {})", fast(i), room(i)),
        }
    }

    /// The monitor written by hand.
    pub fn by_hand(self) -> ByHand {
        ByHand { question: self, since: i64::MIN / 4, waits: false, holds: false, bad: 0 }
    }
}

fn top(i: u32) -> f64 {
    2.0 + 0.04 * f64::from(i)
}
fn near(i: u32) -> f64 {
    1.0 - 0.01 * f64::from(i)
}
fn patience(i: u32) -> i64 {
    500 + 20 * i64::from(i)
}
fn moving(i: u32) -> f64 {
    0.05 + 0.01 * f64::from(i)
}
fn age(i: u32) -> i64 {
    100 + 10 * i64::from(i)
}
fn fast(i: u32) -> f64 {
    0.5 + 0.02 * f64::from(i)
}
fn room(i: u32) -> f64 {
    1.2 + 0.01 * f64::from(i)
}

/// A monitor written by hand.
#[derive(Clone, Debug)]
pub struct ByHand {
    question: Question,
    /// When the scan came, or the first obstacle that is not answered.
    since: i64,
    waits: bool,
    holds: bool,
    /// How often it failed.
    pub bad: u64,
}

impl ByHand {
    /// Takes a step in, at this millisecond.
    #[inline]
    pub fn step(&mut self, t: i64, row: &Row) {
        let is_good = match self.question {
            Limit(i) => row[SPEED] < top(i),
            Response(i) => self.respond(t, row, near(i), patience(i)),
            Freshness(i) => {
                if row[SCAN] > 0.0 {
                    self.since = t;
                }
                row[SPEED] <= moving(i) || t - self.since <= age(i)
            }
            Caution(i) => {
                self.holds = row[LASER] > room(i) || (self.holds && row[LASER] >= 0.3);
                row[SPEED] <= fast(i) || self.holds
            }
        };
        self.bad += u64::from(!is_good);
    }

    /// Obstacles that wait for an answer have the same answer: the first of them decides.
    fn respond(&mut self, t: i64, row: &Row, near: f64, patience: i64) -> bool {
        let late = self.waits && t - self.since > patience;
        self.waits &= !late;
        if row[LASER] < near && !self.waits {
            (self.since, self.waits) = (t, true);
        }
        if row[SPEED] < 0.01 {
            self.waits = false;
        }
        !late
    }
}

/// A log on which all hold: the robot drives, slows down where an obstacle comes near, waits until it is gone.
pub fn log(steps: usize) -> Vec<Row> {
    let (mut x, mut heading, mut speed, mut laser) = (0.0, 0.0_f64, 0.0, 4.0);
    (0..steps)
        .map(|t| {
            let phase = t % 10_000;
            // An obstacle comes nearer for two seconds, stays for one, and goes.
            let goal = if (6_000..8_000).contains(&phase) { 0.9 } else { 4.0 };
            laser += (goal - laser) * 0.002 + 0.001 * wave(t, 37.0);
            let wanted = if laser < 1.5 { 0.0 } else { 1.2 + 0.3 * wave(t, 900.0) };
            speed += (wanted - speed).clamp(-0.005, 0.002);
            let wz = 0.4 * wave(t, 2_300.0);
            heading += wz * 1e-3;
            x += speed * heading.cos() * 1e-3;
            let scan = f64::from(u8::from(t % 25 == 0));
            [x, heading, speed * heading.cos(), speed * heading.sin(), wz, laser, scan, speed]
        })
        .collect()
}

fn wave(t: usize, period: f64) -> f64 {
    (t as f64 / period * std::f64::consts::TAU).sin()
}
