//! What the robot's program asks of its brick: ports, sensors that give samples, motors, and time that passes. The shape is that of leJOS,
//! the Java system of Lego's EV3.

use std::fmt;
use std::time::Duration;

/// A socket for a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)]
pub enum SensorPort {
    S1,
    S2,
    S3,
    S4,
}

/// A socket for a motor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)]
pub enum MotorPort {
    A,
    B,
    C,
    D,
}

/// How an infrared seeker listens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InfraredMode {
    /// To all infrared light: it reaches far and is imprecise, for lamps shine as well.
    Unmodulated,
    /// To light that pulses as the ball's does: more precise, and not so far.
    Modulated,
}

/// Nothing answers at a port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotConnected {
    /// What was looked for.
    pub device: &'static str,
    /// Where.
    pub port: String,
}

impl fmt::Display for NotConnected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no {} answers at port {}", self.device, self.port)
    }
}

impl std::error::Error for NotConnected {}

/// The brick: the computer of the robot, with its sockets, its clock and its button.
pub trait Brick: Send + Sync {
    /// An infrared seeker. A sample is the direction of the ball in degrees, clockwise from straight ahead, in steps of 30; not a number
    /// without a signal.
    fn infrared_seeker(&self, port: SensorPort, mode: InfraredMode) -> Result<Box<dyn SampleProvider>, NotConnected>;

    /// A sonar. A sample is the distance to the next thing ahead in metres; infinite where there is nothing, 0 after an error, as when
    /// the last ping is not over yet.
    fn ultrasonic_sensor(&self, port: SensorPort) -> Result<Box<dyn SampleProvider>, NotConnected>;

    /// A compass. A sample is the heading in whole degrees, anticlockwise.
    fn compass(&self, port: SensorPort) -> Result<Box<dyn SampleProvider>, NotConnected>;

    /// A large motor.
    fn regulated_motor(&self, port: MotorPort) -> Result<Box<dyn RegulatedMotor>, NotConnected>;

    /// A small motor.
    fn unregulated_motor(&self, port: MotorPort) -> Result<Box<dyn UnregulatedMotor>, NotConnected>;

    /// Lets time pass.
    fn delay(&self, time: Duration);

    /// The time since the brick was switched on.
    fn elapsed(&self) -> Duration;

    /// Waits until somebody presses a button.
    fn wait_for_any_press(&self);
}

/// What gives samples.
pub trait SampleProvider: Send + Sync {
    /// Takes a sample, which takes time. Without a device at the end of the cable it is not a number.
    fn fetch_sample(&self) -> f64;
}

/// A motor that keeps its speed and knows how far it has turned.
pub trait RegulatedMotor: Send + Sync {
    /// The speed from now on, in degrees a second.
    fn set_speed(&self, speed: f64);
    /// Turns forwards.
    fn forward(&self);
    /// Turns backwards.
    fn backward(&self);
    /// Stops, and holds.
    fn stop(&self);
    /// How far it has turned, in degrees.
    fn tacho_count(&self) -> f64;
    /// How fast it turns, in degrees a second; negative backwards.
    fn rotation_speed(&self) -> f64;
}

/// A motor that turns as strongly as it is told.
pub trait UnregulatedMotor: Send + Sync {
    /// How strongly, in per cent.
    fn set_power(&self, percent: f64);
    /// Turns forwards.
    fn forward(&self);
    /// Turns backwards.
    fn backward(&self);
    /// Stops.
    fn stop(&self);
    /// Whether it turns.
    fn is_moving(&self) -> bool;
}
