//! A robot on wheels: its program, its base and its sensors, wired as the nodes of a real one are, with faults at the wires.
//!
//! ```text
//! program ──/cmd_vel_original──▶ link ──/cmd_vel──▶ base ──▶ world
//!    ▲                         (faults)                        │
//!    └──/odom, /scan, …────────(faults)──── sensors ◀──────────┘
//! ```

mod people;
mod senses;

use crate::base::{Base, Build, Command};
use crate::clock::{Clock, SECONDS, steps};
use crate::driver::{Driver, View};
use crate::fault::{Fault, Faults, Link, Order};
use crate::message::{Kind, Message, Twist};
use crate::outbox::{Outbox, Topics, prefix_of};
use crate::pose::{Motion, Pose};
use crate::random::Random;
use crate::scenario::{self, draw_point};
use crate::sensor::{Charge, Charger, Encoders, Ticker};
use crate::world::{Body, Outline, World};

use people::People;
use senses::Senses;
pub use senses::scan_message;

/// What a robot may do, and look at, in a step.
pub struct Step<'s> {
    /// The time.
    pub clock: Clock,
    /// What it publishes.
    pub outbox: &'s mut Outbox,
    /// The world, which it senses.
    pub world: &'s World,
    /// Where the signs are.
    pub signs: &'s [[f64; 2]],
    /// Where the charging station is.
    pub charger: Option<Charger>,
    /// Where the robot is that this one follows.
    pub leader: Option<Pose>,
    /// What the robots before were told in this step: those that are confused listen to it.
    pub overheard: &'s mut Vec<Command>,
    /// The seed of the run.
    pub seed: u64,
}

/// How to make a robot.
pub struct Plan<'p> {
    /// Its number.
    pub number: usize,
    /// What the scenario says.
    pub robot: &'p scenario::Robot,
    /// Whether it is the only one.
    pub alone: bool,
    /// The seed of the run.
    pub seed: u64,
    /// The faults that are wanted.
    pub orders: &'p [Order],
    /// How long the run takes, in seconds.
    pub duration: f64,
}

/// A robot on wheels.
pub struct Robot {
    name: String,
    number: usize,
    body: Body,
    base: Base,
    driver: Driver,
    encoders: Encoders,
    charge: Charge,
    faults: Faults,
    link: Link,
    people: People,
    senses: Senses,
    /// The topics between the program and the base.
    asked: usize,
    told: usize,
    decides: Ticker,
    /// Commands from outside that were not told to the base yet; nothing where it obeys its own program.
    outside: Option<Vec<Command>>,
}

impl Robot {
    /// Puts a robot into the world. It draws what is to be drawn, always in the same order.
    pub fn new(plan: &Plan<'_>, world: &mut World, topics: &mut Topics) -> Robot {
        let Plan { number, robot, seed, .. } = *plan;
        let name = robot.name.get_ref().clone();
        let random = |what: &str| Random::new(seed, &format!("{name}/{what}"), 0);
        let mut draw = random("robot");
        let [x, y] = draw_point(&robot.at, &mut draw);
        let start = Pose { x, y, yaw: robot.heading.draw(&mut draw).to_radians() };
        let (mut build, outline) = build(robot.kind);
        build.mass = robot.mass.as_ref().map_or(build.mass, |m| m.draw(&mut draw));
        let faults = Faults::of(&name, plan.orders, plan.duration);
        let (drift, noise) = (robot.odometry.drift.draw(&mut draw), robot.odometry.noise.draw(&mut draw));
        let prefix = match &robot.topics {
            Some(prefix) => prefix_of(prefix),
            None if plan.alone => String::new(),
            None => format!("/{name}"),
        };
        Robot {
            body: world.place(start, outline, build.mass),
            charge: Charge::new(robot.charge.draw(&mut draw)),
            people: People::new(&robot.event, &prefix, topics, &mut draw),
            encoders: Encoders::new(&build, start, drift, noise, random("odometry")),
            driver: Driver::new(&robot.drive, start, random("driver")),
            base: Base::new(build),
            asked: topics.add(format!("{prefix}/cmd_vel_original"), Kind::Twist),
            told: topics.add(format!("{prefix}/cmd_vel"), Kind::Twist),
            senses: Senses::new(&prefix, &robot.drive, topics),
            decides: Ticker::new(20.0, 15),
            outside: (robot.commands == scenario::Commands::Outside).then(Vec::new),
            link: Link::default(),
            faults,
            name,
            number,
        }
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its body in the world.
    pub fn body(&self) -> Body {
        self.body
    }

    /// From now on it obeys what comes from outside, and nothing else.
    pub fn obey_outside(&mut self) {
        self.outside.get_or_insert_default();
    }

    /// The topic on which it is told commands from outside, if it obeys these.
    pub fn ear(&self) -> Option<usize> {
        self.outside.as_ref().map(|_| self.told)
    }

    /// A command from outside, which it is told in the next step.
    pub fn command(&mut self, command: Command) {
        self.outside.iter_mut().for_each(|heard| heard.push(command));
    }

    /// Its base pulls it along, before the world takes a step.
    pub fn drive(&mut self, world: &mut World) {
        let yaw = world.pose(self.body).yaw;
        let moving = world.motion(self.body).in_body(yaw);
        let motion = self.base.drive(moving, SECONDS);
        if motion != moving || motion != Motion::default() {
            world.set_motion(self.body, motion.in_world(yaw));
        }
    }

    /// It senses, publishes, decides and is told, after the world has taken a step.
    pub fn live(&mut self, step: &mut Step<'_>) {
        let now = step.clock.seconds();
        self.encoders.count(self.base.rolled(), SECONDS);
        self.charge.pass(self.charging(step), self.base.speeds(), SECONDS);
        self.suffer(step);
        self.meet_people(step);
        self.sense(step);
        for command in self.outside.as_mut().map(std::mem::take).unwrap_or_default() {
            self.tell(command, step);
        }
        if self.decides.is_due(step.clock.nanos()) {
            self.decide(step);
        } else if let Some(command) = self.link.repeat(&self.faults, now) {
            self.tell(command, step);
        }
        self.overhear(step);
    }

    /// The program decides, and what it decides is on its way to the base.
    fn decide(&mut self, step: &mut Step<'_>) {
        let now = step.clock.seconds();
        let view = View {
            now,
            pose: self.encoders.pose(),
            on_lane: step.world.pose(self.body),
            scan: self.senses.seen(),
            leader: self.leader(step),
            sign: self.sign(step),
        };
        let Some(command) = self.driver.decide(&view) else { return };
        step.outbox.send(self.asked, Message::Twist(twist(command)));
        if self.outside.is_some() {
            return;
        }
        if let Some(command) = self.link.pass(command, &self.faults, now) {
            self.tell(command, step);
            step.overheard.push(command);
        }
    }

    fn tell(&mut self, command: Command, step: &mut Step<'_>) {
        step.outbox.send(self.told, Message::Twist(twist(command)));
        self.base.obey(command);
    }

    /// A robot whose topics are mixed up hears what the others are told.
    fn overhear(&mut self, step: &mut Step<'_>) {
        if self.faults.has(Fault::CrossTalk, step.clock.seconds())
            && self.number > 0
            && let Some(command) = step.overheard.first().copied()
        {
            self.tell(command, step);
        }
    }

    /// The rate of the charger that it stands at.
    fn charging(&self, step: &Step<'_>) -> Option<f64> {
        let charger = step.charger?;
        let (far, _) = step.world.pose(self.body).towards(charger.at);
        (far <= charger.reach).then_some(charger.rate)
    }

    /// The faults of its base and of its odometry that begin in this step.
    fn suffer(&mut self, step: &Step<'_>) {
        let begins = |fault| self.faults.begin(fault).is_some_and(|at| steps(at).max(1) == step.clock.step());
        if begins(Fault::NoSmoothing) {
            self.base.stop_smoothing();
        }
        if begins(Fault::OdomDrift) {
            self.encoders.set_drift(0.05);
        }
        if begins(Fault::OdomJump) {
            let pose = self.encoders.pose();
            self.encoders.set_pose(Pose { x: pose.x + 0.5, ..pose });
        }
    }
}

fn twist(command: Command) -> Twist {
    Twist { linear: [command.ahead, 0.0, 0.0], angular: [0.0, 0.0, command.turn] }
}

/// What a kind of robot is like, and what it looks like from above.
fn build(kind: scenario::Kind) -> (Build, Outline) {
    match kind {
        scenario::Kind::Turtlebot3 => {
            let build = Build {
                mass: 1.0,
                track: 0.16,
                wheel: 0.033,
                speed: 0.22,
                turn: 2.84,
                ramp: 0.8,
                grip: 6.0,
                patience: 0.6,
            };
            (build, Outline::Disc(0.105))
        }
        scenario::Kind::Car => {
            let build = Build {
                mass: 60.0,
                track: 0.36,
                wheel: 0.1,
                speed: 6.0,
                turn: 1.5,
                ramp: 2.5,
                grip: 7.0,
                patience: 0.6,
            };
            (build, Outline::Rectangle(0.6, 0.4))
        }
    }
}
