//! How long the robot's program takes at a place, without what its brick takes: a brick that stops the time of every call behind it, and a
//! player that stops the time of its steps.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::{Place, Times};
use crate::field::Field;
use crate::robot::{
    Brick, InfraredMode, Kicker, Mission, MotorPort, NotConnected, RegulatedMotor, SampleProvider, SensorPort,
    UnregulatedMotor,
};

/// How often each sensor is read before the ball is searched for.
const READINGS: usize = 25;

/// What was measured, and how long the brick has taken so far in nanoseconds.
#[derive(Clone, Default)]
pub struct Stopwatch {
    times: Arc<Mutex<Times>>,
    in_brick: Arc<AtomicU64>,
}

impl Stopwatch {
    /// A brick on a field, whose calls it leaves out.
    pub fn brick(&self, field: Field) -> Arc<dyn Brick> {
        Arc::new(Stopped { what: field, watch: self.clone() })
    }

    /// What was measured.
    pub fn times(&self) -> Times {
        self.lock().clone()
    }

    /// Nothing was measured.
    pub fn forget(&self) {
        self.lock().clear();
    }

    /// Does something at a place.
    fn at<R>(&self, place: Place, what: impl FnOnce() -> R) -> R {
        let (before, start) = (self.in_brick.load(Ordering::Relaxed), Instant::now());
        let result = what();
        let all = start.elapsed();
        self.note(place, all, self.in_brick.load(Ordering::Relaxed) - before);
        result
    }

    fn note(&self, place: Place, all: Duration, in_brick: u64) {
        self.lock().entry(place).or_default().push(nanos(all).saturating_sub(in_brick));
    }

    /// Something that the brick does.
    fn behind<R>(&self, what: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let result = what();
        self.in_brick.fetch_add(nanos(start.elapsed()), Ordering::Relaxed);
        result
    }

    fn lock(&self) -> MutexGuard<'_, Times> {
        self.times.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn nanos(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

/// Plays a match, and stops the time.
pub fn play_once(kicker: &Kicker, watch: &Stopwatch) {
    kicker.init();
    kicker.ready();
    let timed = Timed { kicker, watch, called: Mutex::default() };
    *timed.lock() = Some(Instant::now());
    timed.play();
}

/// A player like the kicker whose steps it takes, and who looks at the clock before and after.
struct Timed<'k> {
    kicker: &'k Kicker,
    watch: &'k Stopwatch,
    /// When `play` was called, until it begins.
    called: Mutex<Option<Instant>>,
}

impl Timed<'_> {
    fn lock(&self) -> MutexGuard<'_, Option<Instant>> {
        self.called.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads the sensors, as the steps do that are not looked at one by one.
    fn read(&self) {
        let Some(sensors) = self.kicker.sensors() else { return };
        for _ in 0..READINGS {
            self.watch.at(Place::InfraredModulated, || sensors.get_ir(InfraredMode::Modulated));
            self.watch.at(Place::InfraredUnmodulated, || sensors.get_ir(InfraredMode::Unmodulated));
            self.watch.at(Place::Sonar, || sensors.get_sonar());
        }
    }
}

impl Mission for Timed<'_> {
    /// The first thing that `play` asks for: from the call to here is what happens before it.
    fn kicker(&self) -> &Kicker {
        if let Some(called) = self.lock().take() {
            self.watch.note(Place::BeforePlay, called.elapsed(), 0);
        }
        self.kicker
    }

    fn find_ball(&self) -> bool {
        self.read();
        self.kicker.find_ball()
    }

    fn kick_ball(&self) {
        self.watch.at(Place::Kick, || self.kicker.kick_ball());
    }

    fn ball_close(&self) -> bool {
        self.watch.at(Place::BallClose, || self.kicker.ball_close())
    }

    fn ball_in_front(&self) -> bool {
        self.watch.at(Place::BallInFront, || self.kicker.ball_in_front())
    }

    fn game_over(&self) {
        self.watch.at(Place::GameOver, || self.kicker.game_over());
    }
}

/// A part of a brick, or all of it, the time of whose calls is stopped.
struct Stopped<T> {
    what: T,
    watch: Stopwatch,
}

impl<T> Stopped<T> {
    fn with<R>(&self, call: impl FnOnce(&T) -> R) -> R {
        self.watch.behind(|| call(&self.what))
    }

    fn part<P>(&self, what: P) -> Stopped<P> {
        Stopped { what, watch: self.watch.clone() }
    }
}

impl Brick for Stopped<Field> {
    fn infrared_seeker(&self, port: SensorPort, mode: InfraredMode) -> Result<Box<dyn SampleProvider>, NotConnected> {
        Ok(Box::new(self.part(self.what.infrared_seeker(port, mode)?)))
    }

    fn ultrasonic_sensor(&self, port: SensorPort) -> Result<Box<dyn SampleProvider>, NotConnected> {
        Ok(Box::new(self.part(self.what.ultrasonic_sensor(port)?)))
    }

    fn compass(&self, port: SensorPort) -> Result<Box<dyn SampleProvider>, NotConnected> {
        Ok(Box::new(self.part(self.what.compass(port)?)))
    }

    fn regulated_motor(&self, port: MotorPort) -> Result<Box<dyn RegulatedMotor>, NotConnected> {
        Ok(Box::new(self.part(self.what.regulated_motor(port)?)))
    }

    fn unregulated_motor(&self, port: MotorPort) -> Result<Box<dyn UnregulatedMotor>, NotConnected> {
        Ok(Box::new(self.part(self.what.unregulated_motor(port)?)))
    }

    fn delay(&self, time: Duration) {
        self.with(|brick| brick.delay(time));
    }

    fn elapsed(&self) -> Duration {
        self.with(Brick::elapsed)
    }

    fn wait_for_any_press(&self) {
        self.with(Brick::wait_for_any_press);
    }
}

impl SampleProvider for Stopped<Box<dyn SampleProvider>> {
    fn fetch_sample(&self) -> f64 {
        self.with(|sensor| sensor.fetch_sample())
    }
}

impl RegulatedMotor for Stopped<Box<dyn RegulatedMotor>> {
    fn set_speed(&self, speed: f64) {
        self.with(|motor| motor.set_speed(speed));
    }

    fn forward(&self) {
        self.with(|motor| motor.forward());
    }

    fn backward(&self) {
        self.with(|motor| motor.backward());
    }

    fn stop(&self) {
        self.with(|motor| motor.stop());
    }

    fn tacho_count(&self) -> f64 {
        self.with(|motor| motor.tacho_count())
    }

    fn rotation_speed(&self) -> f64 {
        self.with(|motor| motor.rotation_speed())
    }
}

impl UnregulatedMotor for Stopped<Box<dyn UnregulatedMotor>> {
    fn set_power(&self, percent: f64) {
        self.with(|motor| motor.set_power(percent));
    }

    fn forward(&self) {
        self.with(|motor| motor.forward());
    }

    fn backward(&self) {
        self.with(|motor| motor.backward());
    }

    fn stop(&self) {
        self.with(|motor| motor.stop());
    }

    fn is_moving(&self) -> bool {
        self.with(|motor| motor.is_moving())
    }
}
