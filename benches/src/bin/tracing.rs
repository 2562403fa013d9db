//! `cargo run --release -p lapwing-benches --bin tracing [passes]`: what a monitor inside a program costs at a call site, against `tracing` alone.
//!
//! Each way runs in a process of its own, since a subscriber is set once for a program. Ratios are taken from alternating runs, and the
//! least of each counts. `memory` instead of a number tells what an instance takes. By instructions, a way alone, with two numbers of passes whose difference is what they cost:
//!
//! ```text
//! valgrind --tool=callgrind target/release/tracing way monitored 100000
//! valgrind --tool=callgrind target/release/tracing way monitored 200000
//! ```

use std::process::Command;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use lapwing_tracing::{Monitor, Spec};
use tracing::{Event, Subscriber, span};
use tracing_subscriber::layer::{Context, Layer, SubscriberExt};

/// How often each way runs.
const ROUNDS: usize = 5;

/// Six properties of the shapes that a soccer robot's have, all of which step at every `tick`.
const SIX: &str = "event a
event b
event c
event tick
property init over (tick): ltl([](b => <*> a))
property front_until_kick over (tick): ltl([](b => o(tick U c)))
property close_at_kick over (tick): ltl([](c => (*) a))
property always_ir over (tick): ltl([] ! c)
property goes_until_in_range over (tick): ltl([](a => o((b or tick) U c)))
property kicks over (tick): ltl([]((c => <*> a) and (c => <*> tick)))
";

/// One property for each robot.
const ROBOTS: &str = "event ready = call robot::ready
event play = call robot::play
property init over (ready, play): for each r of play.robot: always (play implies once ready)
";

mod robot {
    #[tracing::instrument]
    pub fn ready(robot: u64) {}

    #[tracing::instrument]
    pub fn play(robot: u64) {}
}

/// Who listens to the program, and what it does.
const WAYS: [(&str, &str, fn(u64)); 9] = [
    ("nobody", "an event, nobody listening", ticks),
    ("unread", "the same, a monitor that does not read it", ticks),
    ("heard", "the same, a subscriber that counts it", ticks),
    ("monitored", "the same, a monitor that steps six properties", ticks),
    ("counted", "a call, a subscriber that counts it", plays),
    ("robots-1", "a call of one robot, one property each", plays_of::<1>),
    ("robots-10", "a call of one of 10 robots", plays_of::<10>),
    ("robots-100", "a call of one of 100 robots", plays_of::<100>),
    ("robots-1000", "a call of one of 1,000 robots", plays_of::<1000>),
];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["memory"] => memory(),
        ["way", way, passes] => println!("{}", run(way, passes.parse().unwrap_or(100_000))),
        [passes] => compare(passes.parse().unwrap_or(100_000)),
        _ => compare(100_000),
    }
}

fn compare(passes: u64) {
    let mut least = [f64::INFINITY; WAYS.len()];
    for _ in 0..ROUNDS {
        for (best, (way, ..)) in least.iter_mut().zip(WAYS) {
            *best = best.min(in_a_process(way, passes));
        }
    }
    let base = least[0];
    println!("{passes} passes: nanoseconds each, and the ratio to nobody listening\n");
    for ((_, what, _), nanos) in WAYS.iter().zip(least) {
        println!("{what:<48} {nanos:>9.1} {:>9.1}", nanos / base);
    }
}

fn in_a_process(way: &str, passes: u64) -> f64 {
    let program = std::env::current_exe().expect("it has a path");
    let output = Command::new(program).args(["way", way, &passes.to_string()]).output().expect("it runs");
    String::from_utf8_lossy(&output.stdout).trim().parse().expect("it prints nanoseconds")
}

/// Nanoseconds a pass.
fn run(way: &str, passes: u64) -> f64 {
    let Some((_, _, work)) = WAYS.iter().find(|(name, ..)| *name == way) else { return f64::NAN };
    let monitor = listen(way);
    tracing::info!(name: "a", "a");
    tracing::info!(name: "b", "b");
    work(2000.min(passes));
    let start = Instant::now();
    work(passes);
    let nanos = start.elapsed().as_secs_f64() * 1e9 / passes as f64;
    if let Some(report) = monitor.map(|m| m.finish()) {
        assert!(report.properties.iter().all(|p| p.verdict.word() != "violated"), "{:?}", report.properties);
    }
    nanos
}

fn listen(way: &str) -> Option<Monitor> {
    let monitor = |text: &str| {
        let spec = Spec::parse("bench.rv", text, &|_| None).expect("it is right");
        Some(Monitor::builder(spec).install().expect("nobody listens yet"))
    };
    match way {
        "nobody" => None,
        "unread" => monitor("event other\nalways not other\n"),
        "heard" | "counted" => {
            let subscriber = tracing_subscriber::registry().with(Count(AtomicU64::new(0)));
            tracing::subscriber::set_global_default(subscriber).expect("nobody listens yet");
            None
        }
        "monitored" => monitor(SIX),
        _ => monitor(ROBOTS),
    }
}

/// What an instance takes: what is allocated when 1,000 robots have played.
fn memory() {
    let monitor =
        Monitor::builder(Spec::parse("bench.rv", ROBOTS, &|_| None).expect("it is right")).build().expect("a monitor");
    let play = |robots: std::ops::Range<u32>| {
        for n in robots {
            let robot = [("robot", f64::from(n).into())];
            monitor.event_with("ready", &robot);
            monitor.event_with("play", &robot);
        }
    };
    // What is kept to explain violations has its size.
    (0..5000).for_each(|_| play(0..1));
    let taken = allocation_counter::measure(|| play(1..1001)).bytes_current;
    println!("{} bytes an instance", taken / 1000);
}

fn ticks(passes: u64) {
    (0..passes).for_each(|_| tracing::info!(name: "tick", "tick"));
}

fn plays(passes: u64) {
    (0..passes).for_each(|_| robot::play(0));
}

fn plays_of<const ROBOTS: u64>(passes: u64) {
    (0..ROBOTS).for_each(robot::ready);
    (0..passes).for_each(|n| robot::play(n % ROBOTS));
}

/// The least that a subscriber can do.
struct Count(AtomicU64);

impl<S: Subscriber> Layer<S> for Count {
    fn on_event(&self, _: &Event<'_>, _: Context<'_, S>) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn on_new_span(&self, _: &span::Attributes<'_>, _: &span::Id, _: Context<'_, S>) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}
