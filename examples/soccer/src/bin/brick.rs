//! `brick FOLDER`: the robot's program alone, as it would be put on the robot. With the feature `monitors` it is watched by `soccer.rv`; a line is all that
//! differs, and `soccer costs` compares the two in size.
//!
//! The devices are files of a folder, as Linux shows those of a brick: a sensor's latest sample stands in `S1`, and a seeker's in `S3.modulated` and
//! `S3.unmodulated`; a motor's order is written to `A`, and `A.count` and `A.speed` say how far it has turned in degrees and how fast. A device without
//! its file is not plugged in.

use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use soccer::robot::{
    Brick, InfraredMode, Kicker, Mission, MotorPort, NotConnected, RegulatedMotor, SampleProvider, SensorPort,
    Settings, UnregulatedMotor,
};

fn main() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(1) else {
        eprintln!("brick FOLDER: the folder with the files of the devices");
        return ExitCode::from(2);
    };
    let kicker =
        Arc::new(Kicker::new(Arc::new(Files { folder: folder.into(), on: Instant::now() }), Settings::default()));
    #[cfg(feature = "monitors")]
    let monitor = match soccer::watch::install(&kicker) {
        Ok(monitor) => monitor,
        Err(why) => {
            eprintln!("brick: {why}");
            return ExitCode::from(2);
        }
    };
    kicker.init();
    kicker.ready();
    kicker.play();
    #[cfg(feature = "monitors")]
    for property in monitor.finish().properties {
        println!("{}: {}", property.name, property.verdict.word());
    }
    ExitCode::SUCCESS
}

/// A brick whose devices are files.
struct Files {
    folder: PathBuf,
    on: Instant,
}

impl Files {
    fn device(&self, device: &'static str, port: impl Display, needs: &str) -> Result<Device, NotConnected> {
        let path = self.folder.join(format!("{port}{needs}"));
        if path.exists() {
            Ok(Device(self.folder.join(port.to_string())))
        } else {
            Err(NotConnected { device, port: port.to_string() })
        }
    }
}

/// The files of a device: one of its own name, and others with an ending.
struct Device(PathBuf);

impl Device {
    /// The number in a file; without one it is not a number.
    fn read(&self, ending: &str) -> f64 {
        let path = self.0.with_extension(ending);
        std::fs::read_to_string(path).ok().and_then(|text| text.trim().parse().ok()).unwrap_or(f64::NAN)
    }

    /// Gives an order. A device that has gone takes none, and its samples say so.
    fn write(&self, order: &str) {
        let _gone = std::fs::write(Path::new(&self.0), order);
    }
}

/// A sensor: the ending of the file with its sample.
struct Sensor(Device, &'static str);

impl SampleProvider for Sensor {
    fn fetch_sample(&self) -> f64 {
        self.0.read(self.1)
    }
}

impl RegulatedMotor for Device {
    fn set_speed(&self, speed: f64) {
        self.write(&format!("speed {speed}"));
    }

    fn forward(&self) {
        self.write("forward");
    }

    fn backward(&self) {
        self.write("backward");
    }

    fn stop(&self) {
        self.write("stop");
    }

    fn tacho_count(&self) -> f64 {
        self.read("count")
    }

    fn rotation_speed(&self) -> f64 {
        self.read("speed")
    }
}

impl UnregulatedMotor for Device {
    fn set_power(&self, percent: f64) {
        self.write(&format!("power {percent}"));
    }

    fn forward(&self) {
        self.write("forward");
    }

    fn backward(&self) {
        self.write("backward");
    }

    fn stop(&self) {
        self.write("stop");
    }

    fn is_moving(&self) -> bool {
        self.read("speed") != 0.0
    }
}

impl Brick for Files {
    fn infrared_seeker(&self, port: SensorPort, mode: InfraredMode) -> Result<Box<dyn SampleProvider>, NotConnected> {
        let ending = match mode {
            InfraredMode::Unmodulated => "unmodulated",
            InfraredMode::Modulated => "modulated",
        };
        let device = self.device("infrared seeker", format!("{port:?}"), &format!(".{ending}"))?;
        Ok(Box::new(Sensor(device, ending)))
    }

    fn ultrasonic_sensor(&self, port: SensorPort) -> Result<Box<dyn SampleProvider>, NotConnected> {
        Ok(Box::new(Sensor(self.device("sonar", format!("{port:?}"), "")?, "")))
    }

    fn compass(&self, port: SensorPort) -> Result<Box<dyn SampleProvider>, NotConnected> {
        Ok(Box::new(Sensor(self.device("compass", format!("{port:?}"), "")?, "")))
    }

    fn regulated_motor(&self, port: MotorPort) -> Result<Box<dyn RegulatedMotor>, NotConnected> {
        Ok(Box::new(self.device("large motor", format!("{port:?}"), ".count")?))
    }

    fn unregulated_motor(&self, port: MotorPort) -> Result<Box<dyn UnregulatedMotor>, NotConnected> {
        Ok(Box::new(self.device("small motor", format!("{port:?}"), "")?))
    }

    fn delay(&self, time: Duration) {
        std::thread::sleep(time);
    }

    fn elapsed(&self) -> Duration {
        self.on.elapsed()
    }

    fn wait_for_any_press(&self) {
        let mut line = String::new();
        let _end = std::io::stdin().read_line(&mut line);
    }
}
