//! What the sensors of a robot publish, and what faults make of it.

use lapwing_stream::{Duration, Time};

use crate::clock::steps;
use crate::fault::Fault;
use crate::message::{
    Battery, BatteryStatus, Header, Imu, Joints, Kind, Message, Odometry, Placement, Quaternion, Range, Scan, Twist,
};
use crate::outbox::{Content, Topics};
use crate::pose::Motion;
use crate::random::Random;
use crate::scenario::Drive;
use crate::sensor::{LIMIT, Ticker, scan};

use super::{Robot, Step};

/// How late a late scan is, in seconds.
const LATE: f64 = 1.0;
/// By how much stamps are ahead, in nanoseconds.
const AHEAD: i64 = 3_000_000_000;
/// How far the sensor for signs, and that for the leader, sees, in metres.
const FAR: f64 = 12.0;
/// The noise of both, in metres.
const NOISE: f64 = 0.01;

/// The rhythms of the sensors, and what they remember.
#[derive(Clone, Debug)]
pub struct Senses {
    odometry: (usize, Ticker),
    joints: (usize, Ticker),
    imu: (usize, Ticker),
    scan: (usize, Ticker),
    battery: (usize, Ticker),
    bumper: (usize, Ticker),
    /// Distances to the leader and to signs, where the program looks at them.
    leader: Option<(usize, Ticker)>,
    sign: Option<(usize, Ticker)>,
    /// How many scans there were.
    scans: u64,
    /// The last scan that the program has seen.
    seen: Vec<f32>,
    /// The scan that a frozen scanner repeats.
    frozen: Option<Vec<f32>>,
    /// The heading that a frozen odometry repeats.
    yaw: Option<f64>,
    /// How the robot moved at the last measurement of the inertial sensor, and when that was.
    moved: (Motion, f64),
}

impl Senses {
    /// The sensors of a robot with that program.
    pub fn new(prefix: &str, drive: &Drive, topics: &mut Topics) -> Senses {
        let mut topic =
            |name: &str, kind, rate, delay| (topics.add(format!("{prefix}/{name}"), kind), Ticker::new(rate, delay));
        Senses {
            odometry: topic("odom", Kind::Odometry, 30.0, 5),
            joints: topic("joint_states", Kind::Joints, 30.0, 10),
            imu: topic("imu", Kind::Imu, 50.0, 5),
            scan: topic("scan", Kind::Scan, 5.0, 100),
            battery: topic("battery_state", Kind::Battery, 2.0, 50),
            bumper: topic("bumper", Kind::Bool, 20.0, 25),
            leader: matches!(drive, Drive::Follow(_)).then(|| topic("leader", Kind::Range, 20.0, 30)),
            sign: matches!(drive, Drive::Road(_)).then(|| topic("sign", Kind::Range, 20.0, 30)),
            scans: 0,
            seen: Vec::new(),
            frozen: None,
            yaw: None,
            moved: (Motion::default(), 0.0),
        }
    }

    /// The last scan that the program has seen.
    pub fn seen(&self) -> &[f32] {
        &self.seen
    }
}

impl Robot {
    /// Publishes what is due.
    pub(super) fn sense(&mut self, step: &mut Step<'_>) {
        let nanos = step.clock.nanos();
        if self.senses.odometry.1.is_due(nanos) {
            self.publish_odometry(step);
        }
        if self.senses.joints.1.is_due(nanos) {
            self.publish_joints(step);
        }
        if self.senses.imu.1.is_due(nanos) {
            self.publish_imu(step);
        }
        if self.senses.scan.1.is_due(nanos) {
            self.publish_scan(step);
        }
        if self.senses.battery.1.is_due(nanos) {
            self.publish_battery(step);
        }
        if self.senses.bumper.1.is_due(nanos) {
            let pressed = step.world.touches(self.body) && !self.has(Fault::BumperDead, step);
            step.outbox.send(self.senses.bumper.0, Message::Bool(pressed));
        }
        if self.senses.leader.as_mut().is_some_and(|(_, ticker)| ticker.is_due(nanos)) {
            let far = self.leader(step).map(|(far, _)| far);
            self.publish_range(self.senses.leader.as_ref().map(|s| s.0), far, step);
        }
        if self.senses.sign.as_mut().is_some_and(|(_, ticker)| ticker.is_due(nanos)) {
            let far = self.sign(step);
            self.publish_range(self.senses.sign.as_ref().map(|s| s.0), far, step);
        }
    }

    fn has(&self, fault: Fault, step: &Step<'_>) -> bool {
        self.faults.has(fault, step.clock.seconds())
    }

    fn header(&self, frame: &str, step: &Step<'_>) -> Header {
        let shown = step.clock.shown();
        let ahead = if self.has(Fault::StampAhead, step) { AHEAD } else { 0 };
        Header { stamp: shown + Duration::from_nanos(ahead), frame: frame.to_owned() }
    }

    fn publish_odometry(&mut self, step: &mut Step<'_>) {
        let pose = self.encoders.pose();
        let motion = self.encoders.read();
        let yaw = self.shown_yaw(pose.yaw, step);
        let odometry = Odometry {
            header: self.header("odom", step),
            child: "base_footprint".to_owned(),
            placement: Placement { position: [pose.x, pose.y, 0.0], rotation: Quaternion::of_yaw(yaw) },
            twist: Twist { linear: [motion.x, 0.0, 0.0], angular: [0.0, 0.0, motion.turn] },
        };
        step.outbox.send(self.senses.odometry.0, Message::Odometry(Box::new(odometry)));
    }

    /// The heading that is published: where it is frozen, the one that it had when that began.
    fn shown_yaw(&mut self, yaw: f64, step: &Step<'_>) -> f64 {
        if self.has(Fault::YawFrozen, step) {
            return *self.senses.yaw.get_or_insert(yaw);
        }
        self.senses.yaw = None;
        yaw
    }

    fn publish_joints(&mut self, step: &mut Step<'_>) {
        let radius = self.base.build().wheel;
        let mut names = ["wheel_left_joint", "wheel_right_joint"];
        if self.has(Fault::JointsSwapped, step) {
            names.reverse();
        }
        let mut header = self.header("base_link", step);
        if self.has(Fault::ZeroStamp, step) {
            header.stamp = Time(0);
        }
        let joints = Joints {
            header,
            names,
            positions: self.base.rolled().map(|way| way / radius),
            velocities: self.base.speeds().map(|speed| speed / radius),
        };
        step.outbox.send(self.senses.joints.0, Message::Joints(Box::new(joints)));
    }

    fn publish_imu(&mut self, step: &mut Step<'_>) {
        /// The standard deviations of a turn, in rad/s, and of an acceleration, in m/s².
        const TREMBLE: [f64; 2] = [0.002, 0.02];
        /// What the earth adds to an acceleration.
        const GRAVITY: f64 = 9.80665;
        let now = step.clock.seconds();
        let yaw = step.world.pose(self.body).yaw;
        let motion = step.world.motion(self.body).in_body(yaw);
        let (before, then) = std::mem::replace(&mut self.senses.moved, (motion, now));
        let seconds = (now - then).max(crate::clock::SECONDS);
        let mut random = Random::new(step.seed, &format!("{}/imu", self.name), step.clock.step());
        let mut noisy = |value: f64, deviation| value + random.normal(deviation);
        let imu = Imu {
            header: self.header("imu_link", step),
            yaw,
            turn: noisy(motion.turn, TREMBLE[0]),
            acceleration: [
                noisy((motion.x - before.x) / seconds, TREMBLE[1]),
                noisy(motion.x * motion.turn, TREMBLE[1]),
                noisy(GRAVITY, TREMBLE[1]),
            ],
        };
        step.outbox.send(self.senses.imu.0, Message::Imu(Box::new(imu)));
    }

    fn publish_scan(&mut self, step: &mut Step<'_>) {
        let (topic, number) = (self.senses.scan.0, self.senses.scans);
        self.senses.scans += 1;
        let (frozen, late) = (self.has(Fault::FrozenScan, step), self.has(Fault::LateScan, step));
        if self.has(Fault::SilentScan, step) {
            return;
        }
        let header = self.header("base_scan", step);
        if !frozen && !late && !self.driver.needs_scans() {
            self.senses.frozen = None;
            let content = Content::Scan { robot: self.number, number, stamp: header.stamp };
            step.outbox.send_later(topic, content, 0);
            return;
        }
        let mut take = || scan(step.world, self.body, step.seed, &self.name, number);
        let ranges = if frozen {
            self.senses.frozen.get_or_insert_with(&mut take).clone()
        } else {
            self.senses.frozen = None;
            take()
        };
        self.senses.seen.clone_from(&ranges);
        let delay = if late { steps(LATE) } else { 0 };
        step.outbox.send_later(topic, Content::Message(Message::Scan(scan_message(header, ranges))), delay);
    }

    fn publish_battery(&mut self, step: &mut Step<'_>) {
        let is_early = self.has(Fault::ChargedEarly, step) && self.charge.status == BatteryStatus::Charging;
        let battery = Battery {
            header: self.header("", step),
            voltage: self.charge.voltage() as f32,
            current: self.charge.current(self.base.speeds()) as f32,
            charge: self.charge.level as f32,
            status: if is_early { BatteryStatus::Full } else { self.charge.status },
        };
        step.outbox.send(self.senses.battery.0, Message::Battery(battery));
    }

    fn publish_range(&self, topic: Option<usize>, far: Option<f64>, step: &mut Step<'_>) {
        let range = far.map_or(f32::INFINITY, |far| far as f32);
        let header = self.header("camera", step);
        if let Some(topic) = topic {
            step.outbox.send(topic, Message::Range(Range { header, limit: FAR as f32, range }));
        }
    }

    /// How far the leader seems to be, and by how much to turn to face it.
    pub(super) fn leader(&self, step: &Step<'_>) -> Option<(f64, f64)> {
        let leader = step.leader?;
        let (far, aside) = step.world.pose(self.body).towards([leader.x, leader.y]);
        let more = if self.has(Fault::LeaderFar, step) { 1.0 } else { 0.0 };
        (far < FAR).then(|| (far + more + self.tremble("leader", step), aside))
    }

    /// How far the nearest sign ahead seems to be.
    pub(super) fn sign(&self, step: &Step<'_>) -> Option<f64> {
        if !self.driver.needs_signs() || self.has(Fault::SignUnseen, step) {
            return None;
        }
        let pose = step.world.pose(self.body);
        let ahead = step.signs.iter().map(|at| pose.towards(*at));
        let seen = ahead.filter(|(far, aside)| *far < FAR && aside.abs() < std::f64::consts::FRAC_PI_2);
        seen.map(|(far, _)| far).min_by(f64::total_cmp).map(|far| far + self.tremble("sign", step))
    }

    /// The noise of a distance, the same whenever it is asked for in a step.
    fn tremble(&self, what: &str, step: &Step<'_>) -> f64 {
        Random::new(step.seed, &format!("{}/{what}", self.name), step.clock.step()).normal(NOISE)
    }
}

/// A scan as a message.
pub fn scan_message(header: Header, ranges: Vec<f32>) -> Scan {
    Scan { header, duration: 0.2, limits: LIMIT.map(|limit| limit as f32), ranges }
}
