//! A drone that climbs and sinks on two rotors, one on either side.

use crate::clock::SECONDS;
use crate::fault::{Fault, Faults};
use crate::message::{Kind, Message, Model, Placement, Quaternion, Twist};
use crate::outbox::{Topics, prefix_of};
use crate::random::Random;
use crate::robot::Step;
use crate::scenario::{self, draw_point};
use crate::sensor::Ticker;

/// What it weighs, in kilograms.
const MASS: f64 = 1.2;
/// What the earth pulls with, in m/s².
const GRAVITY: f64 = 9.81;
/// The thrust of a rotor, in newtons for each (rad/s)².
const THRUST: f64 = 2.4e-5;
/// The drag, in newtons for each m/s.
const DRAG: f64 = 0.6;
/// By how much the body rolls for each newton that one rotor lifts more, in rad; its own stabiliser holds it there.
const ROLL: f64 = 0.08;
/// How fast a rotor follows its command, in 1/s.
const SPIN: f64 = 20.0;
/// Its greatest speed up or down, in m/s.
const CLIMB: f64 = 1.5;
/// What a wind may do to it, in newtons.
const GUST: f64 = 0.05;

/// A drone.
#[derive(Clone, Debug)]
pub struct Drone {
    name: String,
    at: [f64; 2],
    altitude: f64,
    speed: f64,
    roll: f64,
    /// The speeds of the rotors, in rad/s: as they are, and as they are told to be.
    rotors: [f64; 2],
    told: [f64; 2],
    /// The altitudes to go to, and since when.
    climbs: Vec<(f64, f64)>,
    topics: [usize; 2],
    decides: Ticker,
    random: Random,
    faults: Faults,
}

impl Drone {
    /// A drone on the ground.
    pub fn new(drone: &scenario::Drone, faults: Faults, seed: u64, topics: &mut Topics) -> Drone {
        let name = drone.name.get_ref().clone();
        let mut random = Random::new(seed, &format!("{name}/drone"), 0);
        let mut climbs: Vec<_> = drone.climb.iter().map(|c| (c.at.draw(&mut random), c.to.draw(&mut random))).collect();
        climbs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let prefix = prefix_of(&drone.topics);
        Drone {
            at: draw_point(&drone.at, &mut random),
            topics: ["rotor1", "rotor2"].map(|rotor| topics.add(format!("{prefix}/{rotor}"), Kind::Rotor)),
            name,
            altitude: 0.0,
            speed: 0.0,
            roll: 0.0,
            rotors: [0.0; 2],
            told: [0.0; 2],
            climbs,
            decides: Ticker::new(50.0, 10),
            random,
            faults,
        }
    }

    /// A step: it decides where that is due, and flies.
    pub fn live(&mut self, step: &mut Step<'_>) {
        let now = step.clock.seconds();
        if self.decides.is_due(step.clock.nanos()) {
            let speed = self.decide(now);
            let weak = if self.faults.has(Fault::RotorWeak, now) { 0.97 } else { 1.0 };
            self.told = [speed, speed * weak];
            for (topic, speed) in self.topics.into_iter().zip(self.told) {
                step.outbox.send(topic, Message::Rotor(speed));
            }
        }
        self.fly();
    }

    /// The speed of both rotors that leads to the wanted altitude.
    fn decide(&self, now: f64) -> f64 {
        let wanted = self.climbs.iter().rev().find(|(at, _)| *at <= now).map_or(0.0, |(_, to)| *to);
        if wanted <= 0.0 && self.altitude <= 0.0 {
            return 0.0;
        }
        let climb = (0.8 * (wanted - self.altitude)).clamp(-CLIMB, CLIMB);
        let lift = MASS * (GRAVITY + 3.0 * (climb - self.speed));
        (lift.max(0.0) / (2.0 * THRUST)).sqrt()
    }

    fn fly(&mut self) {
        for (rotor, told) in self.rotors.iter_mut().zip(self.told) {
            *rotor += (told - *rotor) * SPIN * SECONDS;
        }
        let [first, second] = self.rotors.map(|r| THRUST * r * r);
        self.roll = ROLL * (first - second);
        let gust = if self.altitude > 0.0 { self.random.normal(GUST) } else { 0.0 };
        let lift = (first + second) * libm::cos(self.roll) + gust - DRAG * self.speed;
        self.speed += (lift / MASS - GRAVITY) * SECONDS;
        self.altitude += self.speed * SECONDS;
        if self.altitude <= 0.0 {
            (self.altitude, self.speed) = (0.0, self.speed.max(0.0));
        }
    }

    /// As the ground truth has it.
    pub fn model(&self) -> Model {
        Model {
            name: self.name.clone(),
            placement: Placement {
                position: [self.at[0], self.at[1], self.altitude],
                rotation: Quaternion::of_roll_and_yaw(self.roll, 0.0),
            },
            twist: Twist { linear: [0.0, 0.0, self.speed], angular: [0.0; 3] },
        }
    }
}
