//! The robot's own program, as its programmers would write it: a mission, two controllers and what they need of the brick. It says what it
//! does through `tracing`, as any program does that has to be understood later, and does not know who listens.

mod hardware;
mod kicker;
mod motor_controller;
mod navigator;
mod sensor_controller;
mod settings;

pub use hardware::{
    Brick, InfraredMode, MotorPort, NotConnected, RegulatedMotor, SampleProvider, SensorPort, UnregulatedMotor,
};
pub use kicker::{Kicker, Mission};
pub use motor_controller::MotorController;
pub use navigator::{Navigator, Position};
pub use sensor_controller::SensorController;
pub use settings::Settings;
