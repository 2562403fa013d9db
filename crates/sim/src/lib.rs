//! A robot in the box: a deterministic simulator whose robots can be made to fail as real ones did.
//!
//! A [`Scenario`] is a readable file: a world, robots with what they do, and faults. A [`Simulation`] is a run of it: the same scenario, seed and
//! faults give the same messages, to the bit, on every machine. What is published goes to a file ([`record`]) or straight into a monitor
//! ([`recording`]).
//!
//! ```
//! use lapwing_sim::{Options, Scenario, Simulation};
//!
//! let scenario = Scenario::bundled("patrol").ok_or("there is no such scenario")??;
//! let options = Options { seed: 7, duration: Some(1.0), faults: vec!["frozen-scan@0.5".parse()?] };
//! let mut run = Simulation::new(&scenario, &options);
//! let mut odometry = 0;
//! while let Some((_time, topic)) = run.advance() {
//!     odometry += usize::from(run.topics()[topic].name == "/odom");
//! }
//! assert_eq!(odometry, 30);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where to read on
//!
//! The floor itself is there for robots of other kinds as well: a [`World`] with what stands and moves on it, and chance by a seed ([`Random`]).
//!
//! [`simulation`](Simulation) has the loop. A `robot` wires a `driver` (its program), a `base` and `sensor`s; `fault`s act on the wires. The
//! `world` is the only module that knows the physics engine, `message` the only one that knows the encoding.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod simulation;

mod clock;
mod outbox;
mod robot;

mod base;
mod driver;
mod sensor;

mod drone;
mod stage;

mod pose;
mod random;
mod world;

pub mod fault;
mod feed;
pub mod message;
mod record;
pub mod scenario;

pub use feed::{recording, run_name};
pub use message::DefinitionMissing;
pub use outbox::Topic;
pub use pose::{Motion, Pose, wrap};
pub use random::Random;
pub use record::{RecordError, Recorder, record};
pub use scenario::{Scenario, ScenarioError};
pub use simulation::{Options, Simulation};
pub use world::{Body, Outline, World};
