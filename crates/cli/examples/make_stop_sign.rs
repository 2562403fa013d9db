//! Makes the recording of `lapwing demo`: a car in a simulator passes two stop signs, and does not stop at the second.
//!
//! `cargo run -p lapwing-cli --example make_stop_sign` writes `examples/stop-sign/run.mcap` anew. A test holds that it is what this
//! program writes. Only the four basic operations are used on numbers, so that every machine writes the same bytes.

use std::collections::BTreeMap;
use std::io::{self, Cursor};
use std::path::Path;

use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};

/// The step of the simulation, in nanoseconds.
const STEP: u64 = 1_000_000;
/// The length of the recording, in steps.
const STEPS: u64 = 20_000;
/// Where the signs stand along the road; both are a metre beside it.
const SIGNS: [f64; 2] = [8.0, 22.0];
/// How far before a sign the car brakes, in metres.
const BRAKES_BEFORE: f64 = 2.0;
/// How long it waits at a sign, in steps.
const WAITS: u64 = 1_500;
/// What it drives at between signs, in m/s.
const CRUISE: f64 = 2.0;
/// What it slows down to at the second sign, where it should have stopped.
const CREEP: f64 = 0.4;

fn main() -> io::Result<()> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/stop-sign/run.mcap");
    std::fs::write(path, recording().map_err(io::Error::other)?)
}

/// The bytes of the recording.
pub fn recording() -> mcap::McapResult<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    // The library's name would carry its version.
    let options = WriteOptions::new().profile("ros2").library("lapwing make_stop_sign");
    let mut recorder = Recorder::new(options.create(&mut bytes)?)?;
    let mut car = Car::default();
    for step in 0..STEPS {
        car.drive(step);
        if step % 25 == 0 {
            recorder.write(0, step, &model_states(&car))?;
        }
        if step % 33 == 5 {
            recorder.write(1, step, &odometry(&car, step))?;
        }
        if step % 50 == 10 {
            recorder.write(2, step, &twist(car.command))?;
        }
    }
    recorder.writer.finish()?;
    drop(recorder);
    Ok(bytes.into_inner())
}

/// The car: where it is, where it believes to be, and what it was told.
#[derive(Default)]
struct Car {
    x: f64,
    speed: f64,
    believed: f64,
    command: f64,
    /// When it stopped at the first sign.
    stopped: Option<u64>,
}

impl Car {
    /// A millisecond of driving. The wheels follow the command with a time constant of a quarter of a second.
    fn drive(&mut self, step: u64) {
        self.command = self.decide(step);
        self.speed += (self.command - self.speed) * 0.004;
        if self.command == 0.0 && self.speed < 0.02 {
            self.speed = 0.0;
        }
        self.x += self.speed * 0.001;
        self.believed += self.speed * 0.001 * 1.004;
    }

    fn decide(&mut self, step: u64) -> f64 {
        let ahead = |sign: f64| sign - self.x;
        if step < 500 {
            return 0.0;
        }
        if ahead(SIGNS[0]) < BRAKES_BEFORE && self.stopped.is_none_or(|since| step < since + WAITS) {
            if self.speed == 0.0 {
                self.stopped.get_or_insert(step);
            }
            return 0.0;
        }
        // The fault: it takes the second sign for one at which slowing down will do.
        if (-0.5..BRAKES_BEFORE).contains(&ahead(SIGNS[1])) { CREEP } else { CRUISE }
    }
}

/// Writes messages to channels, each with its number.
struct Recorder<'w> {
    writer: Writer<&'w mut Cursor<Vec<u8>>>,
    channels: Vec<u16>,
    sequence: u32,
}

impl<'w> Recorder<'w> {
    fn new(mut writer: Writer<&'w mut Cursor<Vec<u8>>>) -> mcap::McapResult<Recorder<'w>> {
        let mut channels = Vec::new();
        for (topic, ty, definition) in CHANNELS {
            let schema = writer.add_schema(ty, "ros2msg", definition.as_bytes())?;
            channels.push(writer.add_channel(schema, topic, "cdr", &BTreeMap::new())?);
        }
        Ok(Recorder { writer, channels, sequence: 0 })
    }

    fn write(&mut self, channel: usize, step: u64, message: &Cdr) -> mcap::McapResult<()> {
        let time = step * STEP;
        let header = MessageHeader {
            channel_id: self.channels[channel],
            sequence: self.sequence,
            log_time: time,
            publish_time: time,
        };
        self.sequence += 1;
        self.writer.write_to_known_channel(&header, &message.bytes)
    }
}

/// A message in the encoding of ROS 2.
struct Cdr {
    bytes: Vec<u8>,
}

impl Cdr {
    fn new() -> Cdr {
        Cdr { bytes: vec![0, 1, 0, 0] }
    }

    fn align(&mut self, to: usize) {
        while !(self.bytes.len() - 4).is_multiple_of(to) {
            self.bytes.push(0);
        }
    }

    fn u32(&mut self, value: u32) {
        self.align(4);
        self.bytes.extend(value.to_le_bytes());
    }

    fn numbers(&mut self, values: &[f64]) {
        self.align(8);
        values.iter().for_each(|v| self.bytes.extend(v.to_le_bytes()));
    }

    fn text(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.bytes.extend(text.bytes().chain([0]));
    }
}

/// The ground truth of the simulator.
fn model_states(car: &Car) -> Cdr {
    let models = [
        ("road", [0.0, 0.0], 0.0),
        ("first_sign", [SIGNS[0], 1.0], 0.0),
        ("second_sign", [SIGNS[1], 1.0], 0.0),
        ("car", [car.x, 0.0], car.speed),
    ];
    let mut message = Cdr::new();
    message.u32(models.len() as u32);
    models.iter().for_each(|(name, ..)| message.text(name));
    message.u32(models.len() as u32);
    models.iter().for_each(|(_, [x, y], _)| message.numbers(&[*x, *y, 0.0, 0.0, 0.0, 0.0, 1.0]));
    message.u32(models.len() as u32);
    models.iter().for_each(|(.., speed)| message.numbers(&[*speed, 0.0, 0.0, 0.0, 0.0, 0.0]));
    message
}

/// What the car believes of itself.
fn odometry(car: &Car, step: u64) -> Cdr {
    let mut message = Cdr::new();
    message.u32((step * STEP / 1_000_000_000) as u32);
    message.u32((step * STEP % 1_000_000_000) as u32);
    message.text("odom");
    message.text("base_link");
    message.numbers(&[car.believed, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    message.numbers(&[0.0; 36]);
    message.numbers(&[car.speed * 1.004, 0.0, 0.0, 0.0, 0.0, 0.0]);
    message.numbers(&[0.0; 36]);
    message
}

/// What the car was told.
fn twist(speed: f64) -> Cdr {
    let mut message = Cdr::new();
    message.numbers(&[speed, 0.0, 0.0, 0.0, 0.0, 0.0]);
    message
}

/// Topics, types and their definitions.
const CHANNELS: [(&str, &str, &str); 3] = [
    (
        "/gazebo/model_states",
        "gazebo_msgs/msg/ModelStates",
        "string[] name
geometry_msgs/Pose[] pose
geometry_msgs/Twist[] twist
================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x 0
float64 y 0
float64 z 0
float64 w 1
================================================================================
MSG: geometry_msgs/Twist
geometry_msgs/Vector3 linear
geometry_msgs/Vector3 angular
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
",
    ),
    (
        "/odom",
        "nav_msgs/msg/Odometry",
        "std_msgs/Header header
string child_frame_id
geometry_msgs/PoseWithCovariance pose
geometry_msgs/TwistWithCovariance twist
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
================================================================================
MSG: geometry_msgs/PoseWithCovariance
geometry_msgs/Pose pose
float64[36] covariance
================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x 0
float64 y 0
float64 z 0
float64 w 1
================================================================================
MSG: geometry_msgs/TwistWithCovariance
geometry_msgs/Twist twist
float64[36] covariance
================================================================================
MSG: geometry_msgs/Twist
geometry_msgs/Vector3 linear
geometry_msgs/Vector3 angular
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
",
    ),
    (
        "/cmd_vel",
        "geometry_msgs/msg/Twist",
        "geometry_msgs/Vector3 linear
geometry_msgs/Vector3 angular
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
",
    ),
];
