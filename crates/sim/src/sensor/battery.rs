//! A battery: drained by the electronics and by driving, charged at a dock.

use crate::message::BatteryStatus;

/// What the electronics take of the capacity in a second: it lasts two hours and a half.
const IDLE: f64 = 1.1e-4;
/// What driving takes besides, for each m/s of the wheels.
const DRIVING: f64 = 5e-4;

/// A charging station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Charger {
    /// Where.
    pub at: [f64; 2],
    /// How near a robot has to come, in metres.
    pub reach: f64,
    /// By how much of its capacity it charges a battery in a second.
    pub rate: f64,
}

/// How full a battery is, and what it does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Charge {
    /// From 0 to 1.
    pub level: f64,
    /// What it does.
    pub status: BatteryStatus,
}

impl Charge {
    /// A battery that is not charged at the moment.
    pub fn new(level: f64) -> Charge {
        Charge { level: level.clamp(0.0, 1.0), status: BatteryStatus::Discharging }
    }

    /// Some seconds pass: at a charger of that rate, or driving.
    pub fn pass(&mut self, rate: Option<f64>, speeds: [f64; 2], seconds: f64) {
        let driving = DRIVING * (speeds[0].abs() + speeds[1].abs()) / 2.0;
        let change = rate.unwrap_or(-IDLE - driving) * seconds;
        self.level = (self.level + change).clamp(0.0, 1.0);
        self.status = match rate {
            None => BatteryStatus::Discharging,
            Some(_) if self.level < 1.0 => BatteryStatus::Charging,
            Some(_) => BatteryStatus::Full,
        };
    }

    /// The voltage of three lithium cells at that level, nearly.
    pub fn voltage(&self) -> f64 {
        11.0 + 1.6 * self.level
    }

    /// The current in amperes, negative while it is drained.
    pub fn current(&self, speeds: [f64; 2]) -> f64 {
        match self.status {
            BatteryStatus::Charging => 1.5,
            BatteryStatus::Full => 0.0,
            BatteryStatus::Discharging => -0.7 - (speeds[0].abs() + speeds[1].abs()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_battery_is_drained_charged_and_full() {
        let mut charge = Charge::new(0.5);
        charge.pass(None, [0.2; 2], 10.0);
        assert!(charge.level < 0.5 && charge.status == BatteryStatus::Discharging && charge.current([0.2; 2]) < 0.0);
        charge.pass(Some(0.1), [0.0; 2], 1.0);
        assert_eq!(charge.status, BatteryStatus::Charging);
        charge.pass(Some(0.1), [0.0; 2], 10.0);
        assert_eq!((charge.level, charge.status), (1.0, BatteryStatus::Full));
    }
}
