//! The motors: of the wheels, and of the arm.

/// A wheel with its motor, which keeps its speed and counts how far it has turned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Wheel {
    /// What it is set to, in degrees a second; it takes effect with the next order.
    pub set: f64,
    wanted: f64,
    speed: f64,
    turned: f64,
}

/// By how much the speed of a wheel changes at most, in degrees/s².
const RAMP: f64 = 1500.0;

impl Wheel {
    /// It is to turn forwards (1), backwards (-1) or not at all (0).
    pub fn order(&mut self, way: f64) {
        self.wanted = way * self.set;
    }

    /// Some seconds pass.
    pub fn turn(&mut self, seconds: f64) {
        let change = RAMP * seconds;
        self.speed += (self.wanted - self.speed).clamp(-change, change);
        self.turned += self.speed * seconds;
    }

    /// How fast it turns, in degrees a second.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// How far it has turned, in degrees.
    pub fn turned(&self) -> f64 {
        self.turned
    }
}

/// The arm with its motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Arm {
    /// How strong it is told to be, in per cent.
    pub power: f64,
    way: f64,
    /// How far it is out, from 0 to 1.
    out: f64,
    /// Whether it has struck on its way out.
    struck: bool,
}

/// How fast the arm swings out at full power, in swings a second.
const SWINGS: f64 = 6.0;
/// How much faster the ball is after a stroke at full power, in m/s.
const STROKE: f64 = 0.3;

impl Arm {
    /// It is to turn forwards (1), backwards (-1) or not at all (0).
    pub fn order(&mut self, way: f64) {
        self.way = way;
    }

    /// Whether it turns.
    pub fn is_moving(&self) -> bool {
        self.way != 0.0 && self.power > 0.0
    }

    /// Some seconds pass. Returns by how much the ball gets faster, where it is there to be struck.
    pub fn swing(&mut self, seconds: f64, has_ball: bool) -> Option<f64> {
        let strength = self.power.clamp(0.0, 100.0) / 100.0;
        let before = self.out;
        self.out = (self.out + self.way * strength * SWINGS * seconds).clamp(0.0, 1.0);
        if self.out == 0.0 {
            self.struck = false;
        }
        let strikes = self.out > before && has_ball && !self.struck;
        self.struck |= strikes;
        strikes.then_some(STROKE * strength)
    }
}
