//! What the robot senses of the ball: the direction, by infrared light, and the distance, by the sonar.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use tracing::{debug, info, instrument};

use super::hardware::{Brick, InfraredMode, NotConnected, SampleProvider, SensorPort};
use super::settings::Settings;

/// The seeker and the sonar, with their latest readings.
pub struct SensorController {
    brick: Arc<dyn Brick>,
    unmodulated: Box<dyn SampleProvider>,
    modulated: Box<dyn SampleProvider>,
    sonar: Box<dyn SampleProvider>,
    rest: Duration,
    error: f64,
    last: Mutex<Readings>,
}

/// The latest readings.
#[derive(Clone, Copy, Debug)]
struct Readings {
    unmodulated: f64,
    modulated: f64,
    sonar: f64,
    /// When the sonar pinged last.
    pinged: Option<Duration>,
}

impl SensorController {
    /// Connects to the sensors.
    pub fn new(
        brick: Arc<dyn Brick>,
        seeker: SensorPort,
        sonar: SensorPort,
        settings: &Settings,
    ) -> Result<SensorController, NotConnected> {
        let unmodulated = brick.infrared_seeker(seeker, InfraredMode::Unmodulated)?;
        let modulated = brick.infrared_seeker(seeker, InfraredMode::Modulated)?;
        let sonar = brick.ultrasonic_sensor(sonar)?;
        let nothing = Readings { unmodulated: f64::NAN, modulated: f64::NAN, sonar: f64::INFINITY, pinged: None };
        Ok(SensorController {
            brick,
            unmodulated,
            modulated,
            sonar,
            rest: settings.sonar_rest,
            error: settings.sonar_error,
            last: Mutex::new(nothing),
        })
    }

    /// Asks the seeker where the ball is. Returns whether it has a signal; [`SensorController::last_ir`] gives the direction.
    #[instrument(level = "debug", skip_all, ret)]
    pub fn get_ir(&self, mode: InfraredMode) -> bool {
        let direction = match mode {
            InfraredMode::Unmodulated => {
                let ball_dir_unmod = self.unmodulated.fetch_sample();
                self.note(|last| last.unmodulated = ball_dir_unmod);
                debug!(ball_dir_unmod);
                ball_dir_unmod
            }
            InfraredMode::Modulated => {
                let ball_dir_mod = self.modulated.fetch_sample();
                self.note(|last| last.modulated = ball_dir_mod);
                debug!(ball_dir_mod);
                ball_dir_mod
            }
        };
        !direction.is_nan()
    }

    /// Pings, and returns the distance to the next thing ahead in metres. The sonar has its rest before it, as it returns errors without.
    #[instrument(level = "debug", skip_all)]
    pub fn get_sonar(&self) -> f64 {
        let since = self.last().pinged.map(|at| self.brick.elapsed().saturating_sub(at));
        if let Some(rest) = since.and_then(|since| self.rest.checked_sub(since)) {
            self.brick.delay(rest);
        }
        let sonar_read = self.sonar.fetch_sample();
        let pinged = self.brick.elapsed();
        self.note(|last| (last.sonar, last.pinged) = (sonar_read, Some(pinged)));
        debug!(sonar_read);
        sonar_read
    }

    /// The direction that the seeker gave last, in degrees clockwise; `None` without a signal.
    pub fn last_ir(&self, mode: InfraredMode) -> Option<f64> {
        let last = self.last();
        let direction = match mode {
            InfraredMode::Unmodulated => last.unmodulated,
            InfraredMode::Modulated => last.modulated,
        };
        Some(direction).filter(|direction| !direction.is_nan())
    }

    /// Reads every sensor once, so that what comes later is not what was there before.
    #[instrument(level = "debug", skip_all)]
    pub fn flush_sensors(&self) {
        if !self.get_ir(InfraredMode::Modulated) {
            info!("no modulated signal of the ball");
        }
        if !self.get_ir(InfraredMode::Unmodulated) {
            info!("no unmodulated signal of the ball");
        }
        if self.get_sonar() == self.error {
            info!("an error of the sonar");
        }
    }

    fn last(&self) -> Readings {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn note(&self, what: impl FnOnce(&mut Readings)) {
        what(&mut self.last.lock().unwrap_or_else(PoisonError::into_inner));
    }
}
