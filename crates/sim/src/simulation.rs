//! A run of a scenario: a world, the robots in it, and the messages that they publish, one after the other.

use lapwing_stream::{Time, Value};

use crate::base::Command;
use crate::clock::{Clock, SECONDS, steps};
use crate::drone::Drone;
use crate::fault::{Fault, Faults, Order};
use crate::message::{Cdr, Field, Header, Kind, Message, Model, Placement, Quaternion, Transform, Twist, field};
use crate::outbox::{Content, Outbox, Publication, Topic, Topics};
use crate::pose::Pose;
use crate::random::Random;
use crate::robot::{Plan, Robot, Step, scan_message};
use crate::scenario::Scenario;
use crate::sensor::{Ticker, scan};
use crate::stage::Stage;
use crate::world::World;

/// How a scenario is to be run.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// What chance depends on: the same seed gives the same run, to the bit.
    pub seed: u64,
    /// Faults besides those of the scenario.
    pub faults: Vec<Order>,
    /// How long it takes in simulated seconds, where that is not what the scenario says.
    pub duration: Option<f64>,
}

/// A run of a scenario.
pub struct Simulation {
    clock: Clock,
    end: u64,
    seed: u64,
    world: World,
    stage: Stage,
    robots: Vec<Robot>,
    /// The robot that each robot follows.
    leaders: Vec<Option<usize>>,
    drones: Vec<Drone>,
    topics: Topics,
    outbox: Outbox,
    truth: Truth,
    current: Option<Publication>,
    cdr: Cdr,
    /// For each topic of which somebody wants to be told fields: which.
    told: Vec<Vec<Field>>,
}

/// What the simulator itself publishes.
struct Truth {
    models: (usize, Ticker),
    transforms: (usize, Ticker),
    clock: (usize, Ticker),
}

impl Simulation {
    /// A run from its beginning.
    pub fn new(scenario: &Scenario, options: &Options) -> Simulation {
        let (file, seed) = (scenario.file(), options.seed);
        let mut random = Random::new(seed, "scenario", 0);
        let drawn = file.duration.draw(&mut random);
        let duration = options.duration.unwrap_or(drawn);
        let orders: Vec<Order> =
            file.faults.iter().map(|f| f.get_ref().clone()).chain(options.faults.iter().cloned()).collect();
        let mut topics = Topics::default();
        let truth = Truth {
            models: (topics.add("/gazebo/model_states".to_owned(), Kind::Models), Ticker::new(50.0, 5)),
            transforms: (topics.add("/tf".to_owned(), Kind::Transforms), Ticker::new(20.0, 5)),
            clock: (topics.add("/clock".to_owned(), Kind::Clock), Ticker::new(50.0, 5)),
        };
        let mut world = World::new(SECONDS);
        let alone = file.robot.len() == 1;
        let plan = |number| Plan { number, robot: &file.robot[number], alone, seed, orders: &orders, duration };
        let robots: Vec<Robot> = (0..file.robot.len()).map(|n| Robot::new(&plan(n), &mut world, &mut topics)).collect();
        let starts: Vec<Pose> = robots.iter().map(|r| world.pose(r.body())).collect();
        let drone = |drone: &crate::scenario::Drone| {
            let faults = Faults::of(drone.name.get_ref(), &orders, duration);
            Drone::new(drone, faults, seed, &mut topics)
        };
        Simulation {
            drones: file.drone.iter().map(drone).collect(),
            stage: Stage::new(&file.world, &starts, &mut world, &mut random),
            leaders: leaders(scenario),
            clock: Clock::new(Faults::of("", &orders, duration).begin(Fault::ClockJump)),
            end: steps(duration),
            seed,
            world,
            robots,
            topics,
            outbox: Outbox::default(),
            truth,
            current: None,
            cdr: Cdr::default(),
            told: Vec::new(),
        }
    }

    /// All topics that may be published on.
    pub fn topics(&self) -> &[Topic] {
        self.topics.list()
    }

    /// From now on all robots obey commands from outside, whatever their scenario says.
    pub fn obey_outside(&mut self) {
        self.robots.iter_mut().for_each(Robot::obey_outside);
    }

    /// The topics on which robots take commands from outside, by their places in [`topics`](Simulation::topics).
    pub fn ears(&self) -> Vec<usize> {
        self.robots.iter().filter_map(Robot::ear).collect()
    }

    /// Gives a command from outside, in metres and radians a second: the robots that listen to that topic are told it in the next step. What
    /// is no speed is passed over.
    pub fn command(&mut self, topic: usize, ahead: f64, turn: f64) {
        if ahead.is_finite() && turn.is_finite() {
            let told = self.robots.iter_mut().filter(|robot| robot.ear() == Some(topic));
            told.for_each(|robot| robot.command(Command { ahead, turn }));
        }
    }

    /// How long it has taken, in seconds: what its clock shows, unless that has jumped.
    pub fn seconds(&self) -> f64 {
        self.clock.seconds()
    }

    /// How many steps have been taken, and of how many.
    pub fn progress(&self) -> (u64, u64) {
        (self.clock.step().min(self.end), self.end)
    }

    /// Goes to the next message: when it is published, and on which topic.
    pub fn advance(&mut self) -> Option<(Time, usize)> {
        loop {
            if let Some(next) = self.outbox.next() {
                let topic = next.topic;
                self.current = Some(next);
                return Some((self.clock.shown(), topic));
            }
            if self.clock.step() >= self.end {
                self.current = None;
                return None;
            }
            self.step();
        }
    }

    /// The bytes of the message that [`advance`](Simulation::advance) went to.
    pub fn payload(&mut self) -> &[u8] {
        match self.current.take().map(|p| p.content) {
            None => self.cdr.begin(),
            Some(content) => self.message(content).encode(&mut self.cdr),
        }
        self.cdr.bytes()
    }

    /// Whether it can tell these fields of the messages of a topic as they are, without bytes: from then on [`tell`](Simulation::tell) does.
    pub fn tells(&mut self, topic: usize, paths: impl Iterator<Item = String>) -> bool {
        let Some(kind) = self.topics().get(topic).map(|topic| topic.kind) else { return false };
        let Some(fields) = paths.map(|path| field(kind, &path)).collect() else { return false };
        self.told.resize_with(self.topics().len(), Vec::new);
        self.told[topic] = fields;
        true
    }

    /// Overwrites values by the fields of the message that [`advance`](Simulation::advance) went to, of those that its topic was asked for.
    pub fn tell(&mut self, values: &mut [Value]) {
        let Some(Publication { topic, content }) = self.current.take() else { return };
        let message = self.message(content);
        let fields = self.told.get(topic).map_or(&[][..], Vec::as_slice);
        fields.iter().zip(values).for_each(|(field, value)| field(&message, value));
    }

    fn message(&self, content: Content) -> Message {
        match content {
            Content::Message(message) => message,
            Content::Scan { robot, number, stamp } => {
                let robot = &self.robots[robot];
                let ranges = scan(&self.world, robot.body(), self.seed, robot.name(), number);
                Message::Scan(scan_message(Header { stamp, frame: "base_scan".to_owned() }, ranges))
            }
            Content::Models => Message::Models(self.models()),
            Content::Transforms => Message::Transforms(self.transforms()),
        }
    }

    fn step(&mut self) {
        self.clock.tick();
        self.outbox.begin(self.clock.step());
        for robot in &mut self.robots {
            robot.drive(&mut self.world);
        }
        self.world.step();
        self.publish_truth();
        let places: Vec<Pose> = self.robots.iter().map(|r| self.world.pose(r.body())).collect();
        let mut overheard = Vec::new();
        let mut step = Step {
            clock: self.clock,
            outbox: &mut self.outbox,
            world: &self.world,
            signs: self.stage.signs(),
            charger: self.stage.charger(),
            leader: None,
            overheard: &mut overheard,
            seed: self.seed,
        };
        for (robot, leader) in self.robots.iter_mut().zip(&self.leaders) {
            step.leader = leader.and_then(|l| places.get(l).copied());
            robot.live(&mut step);
        }
        for drone in &mut self.drones {
            drone.live(&mut step);
        }
    }

    fn publish_truth(&mut self) {
        let nanos = self.clock.nanos();
        if self.truth.clock.1.is_due(nanos) {
            self.outbox.send(self.truth.clock.0, Message::Clock(self.clock.shown()));
        }
        if self.truth.models.1.is_due(nanos) {
            self.outbox.send_later(self.truth.models.0, Content::Models, 0);
        }
        if self.truth.transforms.1.is_due(nanos) {
            self.outbox.send_later(self.truth.transforms.0, Content::Transforms, 0);
        }
    }

    /// All objects as they are now, the ground first, as Gazebo has it.
    fn models(&self) -> Vec<Model> {
        let ground = Model {
            name: "ground_plane".to_owned(),
            placement: Placement { position: [0.0; 3], rotation: Quaternion::of_yaw(0.0) },
            twist: Twist::default(),
        };
        let robots = self.robots.iter().map(|r| self.stage.model(r.name(), r.body(), &self.world));
        let drones = self.drones.iter().map(Drone::model);
        std::iter::once(ground).chain(self.stage.models(&self.world)).chain(robots).chain(drones).collect()
    }

    /// Where the robots and the drones are, as transforms from the map.
    fn transforms(&self) -> Vec<Transform> {
        let robots = self.robots.iter().map(|r| self.stage.model(r.name(), r.body(), &self.world));
        let transform = |model: Model| Transform {
            header: Header { stamp: self.clock.shown(), frame: "map".to_owned() },
            child: format!("{}/base_link", model.name),
            placement: model.placement,
        };
        robots.chain(self.drones.iter().map(Drone::model)).map(transform).collect()
    }
}

/// The numbers of the robots that the robots follow.
fn leaders(scenario: &Scenario) -> Vec<Option<usize>> {
    let robots = &scenario.file().robot;
    let leader = |robot: &crate::scenario::Robot| match &robot.drive {
        crate::scenario::Drive::Follow(follow) => robots.iter().position(|r| r.name.get_ref() == follow.whom.get_ref()),
        _ => None,
    };
    robots.iter().map(leader).collect()
}
