//! The robot's brick on the field: sockets, and what is plugged into them.

use std::time::Duration;

use super::parts::Wheel;
use super::senses::{LOOK, NEEDLE, PING};
use super::{Field, Inner};
use crate::robot::{
    Brick, InfraredMode, MotorPort, NotConnected, RegulatedMotor, SampleProvider, SensorPort, UnregulatedMotor,
};

/// How long it takes until somebody has read what the brick says, plugged in all cables and pressed a button.
const HELP: Duration = Duration::from_secs(2);

impl Brick for Field {
    fn infrared_seeker(&self, port: SensorPort, mode: InfraredMode) -> Result<Box<dyn SampleProvider>, NotConnected> {
        let sample = move |field: &mut Inner| field.infrared(mode);
        self.sensor("infrared seeker", port, SensorPort::S3, LOOK, sample)
    }

    fn ultrasonic_sensor(&self, port: SensorPort) -> Result<Box<dyn SampleProvider>, NotConnected> {
        self.sensor("sonar", port, SensorPort::S2, PING, Inner::sonar)
    }

    fn compass(&self, port: SensorPort) -> Result<Box<dyn SampleProvider>, NotConnected> {
        self.sensor("compass", port, SensorPort::S1, NEEDLE, Inner::compass)
    }

    fn regulated_motor(&self, port: MotorPort) -> Result<Box<dyn RegulatedMotor>, NotConnected> {
        let side = match port {
            MotorPort::A => 0,
            MotorPort::D => 1,
            MotorPort::B | MotorPort::C => return Err(missing("large motor", port)),
        };
        Ok(Box::new(WheelMotor { field: self.clone(), side }))
    }

    fn unregulated_motor(&self, port: MotorPort) -> Result<Box<dyn UnregulatedMotor>, NotConnected> {
        match port {
            MotorPort::C => Ok(Box::new(ArmMotor(self.clone()))),
            _ => Err(missing("small motor", port)),
        }
    }

    fn delay(&self, time: Duration) {
        self.after(time, |_| ());
    }

    fn elapsed(&self) -> Duration {
        self.clock().now()
    }

    fn wait_for_any_press(&self) {
        self.after(HELP, |field| field.unplugged.clear());
    }
}

fn missing(device: &'static str, port: impl std::fmt::Debug) -> NotConnected {
    NotConnected { device, port: format!("{port:?}") }
}

impl Field {
    fn sensor(
        &self,
        device: &'static str,
        port: SensorPort,
        socket: SensorPort,
        takes: Duration,
        sample: impl Fn(&mut Inner) -> f64 + Send + Sync + 'static,
    ) -> Result<Box<dyn SampleProvider>, NotConnected> {
        if port != socket || self.lock().unplugged.contains(&port) {
            return Err(missing(device, port));
        }
        Ok(Box::new(Sensor { field: self.clone(), port, takes, sample }))
    }
}

struct Sensor<F> {
    field: Field,
    port: SensorPort,
    takes: Duration,
    sample: F,
}

impl<F: Fn(&mut Inner) -> f64 + Send + Sync> SampleProvider for Sensor<F> {
    fn fetch_sample(&self) -> f64 {
        self.field.after(self.takes, |field| {
            let sample = (self.sample)(field);
            if field.unplugged.contains(&self.port) { f64::NAN } else { sample }
        })
    }
}

struct WheelMotor {
    field: Field,
    side: usize,
}

impl WheelMotor {
    fn with<T>(&self, what: impl FnOnce(&mut Wheel) -> T) -> Option<T> {
        self.field.lock().wheels.get_mut(self.side).map(what)
    }
}

impl RegulatedMotor for WheelMotor {
    fn set_speed(&self, speed: f64) {
        self.with(|wheel| wheel.set = speed.abs());
    }

    fn forward(&self) {
        self.with(|wheel| wheel.order(1.0));
    }

    fn backward(&self) {
        self.with(|wheel| wheel.order(-1.0));
    }

    fn stop(&self) {
        self.with(|wheel| wheel.order(0.0));
    }

    fn tacho_count(&self) -> f64 {
        self.with(|wheel| wheel.turned()).unwrap_or_default()
    }

    fn rotation_speed(&self) -> f64 {
        self.with(|wheel| wheel.speed()).unwrap_or_default()
    }
}

struct ArmMotor(Field);

impl UnregulatedMotor for ArmMotor {
    fn set_power(&self, percent: f64) {
        self.0.lock().arm.power = percent;
    }

    fn forward(&self) {
        self.0.lock().arm.order(1.0);
    }

    fn backward(&self) {
        self.0.lock().arm.order(-1.0);
    }

    fn stop(&self) {
        self.0.lock().arm.order(0.0);
    }

    fn is_moving(&self) -> bool {
        self.0.lock().arm.is_moving()
    }
}
