//! `cargo run --release -p lapwing-benches --bin simulator [runs]`: how many seconds are simulated in a second, alone and monitored, on one
//! thread.
//!
//! What the monitor costs is told apart from what its questions cost: a scan is only taken where somebody reads it. So `read` makes the messages
//! that the specification reads, as bytes, and judges nothing; `monitored` is told their fields, and judges them. By instructions, what begins once
//! left out by the difference of two numbers of runs:
//!
//! ```text
//! valgrind --tool=callgrind target/release/simulator 2 read
//! valgrind --tool=callgrind target/release/simulator 2 monitored
//! ```

use std::io::Cursor;
use std::time::Instant;

use lapwing::{Options, Session, Spec};
use lapwing_sim::{Scenario, Simulation, record, recording, run_name};

/// The specification: what a scanner, an odometry and a bumper should do.
const SPEC: &str = "\
decl ranges /scan LaserScan.ranges
decl cmd /cmd_vel Twist.linear.x
decl bumper /bumper Bool.data
decl x /odom Odometry.pose.pose.position.x

never min(ranges) < 0.13
always age(/scan) < 0.5
never bumper
never abs(delta(x)) > 0.05
tracks: whenever held for 1 s (delta(cmd) =={1e-6} 0), turtlebot3.velocity.body.x =={0.05} cmd
";
/// The topics that it reads.
const TOPICS: [&str; 5] = ["/scan", "/cmd_vel", "/bumper", "/odom", "/gazebo/model_states"];
/// How long a run takes, in simulated seconds.
const SECONDS: f64 = 30.0;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let runs = arguments.next().and_then(|n| n.parse().ok()).unwrap_or(20);
    let only = arguments.next().unwrap_or_default();
    let scenario = Scenario::bundled("wander").expect("it comes with the simulator").expect("it is right");
    let specs = [Spec::parse("bench.rv", SPEC, &|_| None).expect("it is right")];
    let modes: [(&str, &dyn Fn(u64)); 4] = [
        ("alone", &|seed| alone(&scenario, seed)),
        ("read", &|seed| read(&scenario, seed)),
        ("monitored", &|seed| monitored(&scenario, &specs, seed)),
        ("recorded", &|seed| recorded(&scenario, seed)),
    ];
    println!("{runs} runs of {SECONDS} s: simulated seconds a second, on one thread\n");
    for (name, mode) in modes.into_iter().filter(|(name, _)| name.contains(&only)) {
        let start = Instant::now();
        (1..=runs).for_each(mode);
        println!("{name:<12} {:>8.0}", SECONDS * runs as f64 / start.elapsed().as_secs_f64());
    }
}

fn options(seed: u64) -> lapwing_sim::Options {
    lapwing_sim::Options { seed, duration: Some(SECONDS), ..Default::default() }
}

/// Nobody looks.
fn alone(scenario: &Scenario, seed: u64) {
    let mut simulation = Simulation::new(scenario, &options(seed));
    while std::hint::black_box(simulation.advance()).is_some() {}
}

/// The messages that the specification reads are made, and nothing is judged.
fn read(scenario: &Scenario, seed: u64) {
    let mut simulation = Simulation::new(scenario, &options(seed));
    let wanted: Vec<bool> = simulation.topics().iter().map(|t| TOPICS.contains(&t.name.as_str())).collect();
    assert_eq!(wanted.iter().filter(|w| **w).count(), TOPICS.len());
    while let Some((_, topic)) = simulation.advance() {
        if wanted[topic] {
            std::hint::black_box(simulation.payload());
        }
    }
}

/// The specification is checked while the run goes on.
fn monitored(scenario: &Scenario, specs: &[Spec], seed: u64) {
    let recording = recording(scenario, &options(seed)).expect("every message has a definition");
    let report = Session::over(specs, recording, &run_name(scenario, seed), &Options::default()).run(&mut ());
    assert!(report.properties.iter().all(|p| p.cause.is_none()), "{:?}", report.properties);
}

/// Everything is written to a recording in memory.
fn recorded(scenario: &Scenario, seed: u64) {
    let count = record(scenario, &options(seed), Cursor::new(Vec::new())).expect("memory does not fail");
    assert!(count > 1000);
}
