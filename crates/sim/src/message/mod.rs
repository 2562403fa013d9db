//! The messages that robots and simulator publish, as plain data, and how they are encoded.

mod cdr;
mod definition;
mod fields;

use lapwing_stream::Time;

pub use cdr::Cdr;
pub use definition::{Definition, DefinitionMissing, Kind};
pub use fields::{Field, field};

/// A point or a vector in space.
pub type Vector = [f64; 3];

/// The values of an identity covariance, and of one that is not known.
const NO_COVARIANCE: [f64; 36] = [0.0; 36];

/// The stamp and the frame of a message.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// When what it says was so.
    pub stamp: Time,
    /// The frame that it says it in.
    pub frame: String,
}

/// A rotation, as a unit quaternion: x, y, z, w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quaternion(pub [f64; 4]);

impl Quaternion {
    /// First about the forward axis, then about the vertical one.
    pub fn of_roll_and_yaw(roll: f64, yaw: f64) -> Quaternion {
        let ((sr, cr), (sy, cy)) = (libm::sincos(roll / 2.0), libm::sincos(yaw / 2.0));
        Quaternion([sr * cy, sr * sy, cr * sy, cr * cy])
    }

    /// About the vertical axis.
    pub fn of_yaw(yaw: f64) -> Quaternion {
        Quaternion::of_roll_and_yaw(0.0, yaw)
    }
}

/// A place and a rotation in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The place.
    pub position: Vector,
    /// The rotation.
    pub rotation: Quaternion,
}

/// A velocity in space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Metres a second.
    pub linear: Vector,
    /// Radians a second.
    pub angular: Vector,
}

/// One object of the simulator's ground truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub placement: Placement,
    /// How it moves, in the frame of the world.
    pub twist: Twist,
}

/// A transform from a frame to a child of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Transform {
    /// When, and from which frame.
    pub header: Header,
    /// To which.
    pub child: String,
    /// Where the child is.
    pub placement: Placement,
}

/// What a laser scanner sees.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// When it was taken, by what.
    pub header: Header,
    /// How long one takes, in seconds.
    pub duration: f32,
    /// The least and the greatest distance that it can tell.
    pub limits: [f32; 2],
    /// Distances, anticlockwise all around, beginning straight ahead; infinite where there is nothing.
    pub ranges: Vec<f32>,
}

/// What the wheels did.
#[derive(Clone, Debug, PartialEq)]
pub struct Joints {
    /// When.
    pub header: Header,
    /// The names of the joints.
    pub names: [&'static str; 2],
    /// By how much each has turned, in radians.
    pub positions: [f64; 2],
    /// How fast each turns, in radians a second.
    pub velocities: [f64; 2],
}

/// The state of a battery.
#[derive(Clone, Debug, PartialEq)]
pub struct Battery {
    /// When.
    pub header: Header,
    /// Volts.
    pub voltage: f32,
    /// Amperes; negative while it is drained.
    pub current: f32,
    /// From 0 to 1.
    pub charge: f32,
    /// What it does.
    pub status: BatteryStatus,
}

/// What a battery does, with the numbers of `sensor_msgs/BatteryState`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BatteryStatus {
    /// It is being charged.
    Charging = 1,
    /// It is being drained.
    Discharging = 2,
    /// It is full and on the charger.
    Full = 4,
}

/// What an inertial sensor feels.
#[derive(Clone, Debug, PartialEq)]
pub struct Imu {
    /// When, by what.
    pub header: Header,
    /// The heading, in radians.
    pub yaw: f64,
    /// How fast the heading changes.
    pub turn: f64,
    /// The acceleration.
    pub acceleration: Vector,
}

/// Where a robot believes to be.
#[derive(Clone, Debug, PartialEq)]
pub struct Odometry {
    /// When, in which frame.
    pub header: Header,
    /// The frame of the robot.
    pub child: String,
    /// Where it is.
    pub placement: Placement,
    /// How it moves, in its own frame.
    pub twist: Twist,
}

/// How far something is.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// When, by what.
    pub header: Header,
    /// The greatest distance that can be told.
    pub limit: f32,
    /// The distance; infinite where nothing is seen.
    pub range: f32,
}

/// A message of any kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// `geometry_msgs/Twist`
    Twist(Twist),
    /// `nav_msgs/Odometry`
    Odometry(Box<Odometry>),
    /// `sensor_msgs/LaserScan`
    Scan(Scan),
    /// `sensor_msgs/Imu`
    Imu(Box<Imu>),
    /// `sensor_msgs/JointState`
    Joints(Box<Joints>),
    /// `sensor_msgs/BatteryState`
    Battery(Battery),
    /// `sensor_msgs/Range`
    Range(Range),
    /// `std_msgs/Bool`
    Bool(bool),
    /// `std_msgs/String`
    Text(String),
    /// `drone_mov/Vector3`
    Rotor(f64),
    /// `gazebo_msgs/ModelStates`
    Models(Vec<Model>),
    /// `tf2_msgs/TFMessage`
    Transforms(Vec<Transform>),
    /// `rosgraph_msgs/Clock`
    Clock(Time),
}

impl Message {
    /// Writes it.
    pub fn encode(&self, cdr: &mut Cdr) {
        cdr.begin();
        match self {
            Message::Twist(m) => twist(cdr, m),
            Message::Odometry(m) => odometry(cdr, m),
            Message::Scan(m) => scan(cdr, m),
            Message::Imu(m) => imu(cdr, m),
            Message::Joints(m) => joints(cdr, m),
            Message::Battery(m) => battery(cdr, m),
            Message::Range(m) => range(cdr, m),
            Message::Bool(m) => cdr.bool(*m),
            Message::Text(m) => cdr.text(m),
            Message::Rotor(speed) => twist(cdr, &Twist { linear: [*speed, 0.0, 0.0], angular: [0.0; 3] }),
            Message::Models(m) => models(cdr, m),
            Message::Transforms(m) => transforms(cdr, m),
            Message::Clock(m) => time(cdr, *m),
        }
    }
}

fn time(cdr: &mut Cdr, time: Time) {
    cdr.i32(i32::try_from(time.0.div_euclid(1_000_000_000)).unwrap_or(i32::MAX));
    cdr.u32(u32::try_from(time.0.rem_euclid(1_000_000_000)).unwrap_or_default());
}

fn header(cdr: &mut Cdr, header: &Header) {
    time(cdr, header.stamp);
    cdr.text(&header.frame);
}

fn placement(cdr: &mut Cdr, placement: &Placement) {
    cdr.f64s(&placement.position);
    cdr.f64s(&placement.rotation.0);
}

fn twist(cdr: &mut Cdr, twist: &Twist) {
    cdr.f64s(&twist.linear);
    cdr.f64s(&twist.angular);
}

fn odometry(cdr: &mut Cdr, odometry: &Odometry) {
    header(cdr, &odometry.header);
    cdr.text(&odometry.child);
    placement(cdr, &odometry.placement);
    cdr.f64s(&NO_COVARIANCE);
    twist(cdr, &odometry.twist);
    cdr.f64s(&NO_COVARIANCE);
}

fn scan(cdr: &mut Cdr, scan: &Scan) {
    header(cdr, &scan.header);
    let rays = scan.ranges.len().max(1) as f32;
    let step = std::f32::consts::TAU / rays;
    for value in [0.0, step * (rays - 1.0), step, scan.duration / rays, scan.duration] {
        cdr.f32(value);
    }
    scan.limits.iter().for_each(|limit| cdr.f32(*limit));
    cdr.array_f32(&scan.ranges);
    cdr.array_f32(&[]);
}

fn imu(cdr: &mut Cdr, imu: &Imu) {
    header(cdr, &imu.header);
    cdr.f64s(&Quaternion::of_yaw(imu.yaw).0);
    cdr.f64s(&NO_COVARIANCE[..9]);
    cdr.f64s(&[0.0, 0.0, imu.turn]);
    cdr.f64s(&NO_COVARIANCE[..9]);
    cdr.f64s(&imu.acceleration);
    cdr.f64s(&NO_COVARIANCE[..9]);
}

fn joints(cdr: &mut Cdr, joints: &Joints) {
    header(cdr, &joints.header);
    cdr.texts(joints.names.into_iter());
    cdr.array_f64(&joints.positions);
    cdr.array_f64(&joints.velocities);
    cdr.array_f64(&[]);
}

fn battery(cdr: &mut Cdr, battery: &Battery) {
    /// What the battery of a TurtleBot3 holds, in ampere hours.
    const CAPACITY: f32 = 1.8;
    header(cdr, &battery.header);
    let temperature = f32::NAN;
    let charge = battery.charge * CAPACITY;
    for value in [battery.voltage, temperature, battery.current, charge, CAPACITY, CAPACITY, battery.charge] {
        cdr.f32(value);
    }
    // The health and the technology, as the message numbers them: good, lithium polymer.
    [battery.status as u8, 1, 3].into_iter().for_each(|value| cdr.u8(value));
    cdr.bool(true);
    cdr.array_f32(&[]);
    cdr.array_f32(&[]);
    cdr.text("");
    cdr.text("");
}

fn range(cdr: &mut Cdr, range: &Range) {
    header(cdr, &range.header);
    // Infrared, as the message numbers it.
    cdr.u8(1);
    for value in [0.1, 0.0, range.limit, range.range, 0.0] {
        cdr.f32(value);
    }
}

fn models(cdr: &mut Cdr, models: &[Model]) {
    cdr.texts(models.iter().map(|m| m.name.as_str()));
    cdr.count(models.len());
    models.iter().for_each(|m| placement(cdr, &m.placement));
    cdr.count(models.len());
    models.iter().for_each(|m| twist(cdr, &m.twist));
}

fn transforms(cdr: &mut Cdr, transforms: &[Transform]) {
    cdr.count(transforms.len());
    for transform in transforms {
        header(cdr, &transform.header);
        cdr.text(&transform.child);
        placement(cdr, &transform.placement);
    }
}
