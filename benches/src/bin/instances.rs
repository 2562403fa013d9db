//! `cargo run --release -p lapwing-benches --bin instances [robots]`: what a property of each of many robots takes, in bytes and per event.
//!
//! The properties are of the shapes that the soccer robot's have. Robots take turns, so that each event is another one's; with one robot there
//! is nothing else in the caches. Times are the least of several rounds.

use std::time::Instant;

use allocation_counter::measure;
use lapwing_check::{TraceShape, check, compile::compile, load};
use lapwing_diag::SourceMap;
use lapwing_engine::{Ending, Program, State};
use lapwing_stream::{Sample, Time, Value, What};

/// What robots tell.
const EVENTS: [&str; 6] = ["ready", "play", "turn", "lose", "close", "kick"];

/// A property, and what a robot does again and again that satisfies it.
const PROPERTIES: [(&str, &str, &[&str]); 6] = [
    ("init", "over (ready, play): for each r of play.robot: ltl([](play => <*> ready))", &["ready", "play"]),
    ("always_ir", "over (lose, play): for each r of play.robot: ltl([] ! lose)", &["play", "play"]),
    ("close_at_kick", "over (close, kick): for each r of kick.robot: ltl([](kick => (*) close))", &["close", "kick"]),
    (
        "front_until_kick",
        "over (turn, lose, close, kick): for each r of turn.robot: ltl([](turn => o(close U kick)))",
        &["turn", "close", "close", "kick"],
    ),
    (
        "kicks",
        "over (ready, play, kick): for each r of play.robot: ltl([](play => (<*> ready and <*> kick)))",
        &["ready", "kick", "play"],
    ),
    (
        "kicks_in_time",
        "over (turn, kick): for each r of turn.robot: always (turn implies eventually within 1000 s kick)",
        &["turn", "kick"],
    ),
];

/// Properties that read a signal as well.
const WITH_SIGNAL: [(&str, &str); 4] = [
    ("near_at_kick", "for each r of kick.robot: whenever kick, near"),
    ("near_since_turn", "for each r of kick.robot: whenever kick, near since turn"),
    ("turns_near", "for each r of kick.robot: whenever kick, eventually within 1000 s (turn and near)"),
    ("never_far", "for each r of kick.robot: always (once kick implies near)"),
];

/// Properties that read a signal, and of which each robot has an obligation open.
const OPEN: [(&str, &str); 3] = [
    ("turns_near", "for each r of kick.robot: whenever kick, eventually (turn and near)"),
    ("near_in_time", "for each r of kick.robot: whenever kick, eventually within 1000 s near"),
    ("turn_until_near", "for each r of kick.robot: whenever kick, not turn until near"),
];

/// Rows of a measurement.
const ROWS: u32 = 200;

/// How often each robot does all of it at a measurement, and how often that is measured.
const TURNS: usize = 8;
const ROUNDS: usize = 5;

fn main() {
    let most = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(60_000);
    println!("{:<20} {:>8} {:>12} {:>12}", "property", "robots", "bytes each", "ns an event");
    for (name, property, steps) in PROPERTIES {
        for robots in [1, 1_000, most] {
            let (bytes, nanos) = cost(&program(&format!("property {name} {property}\n")), steps, robots);
            println!("{name:<20} {robots:>8} {bytes:>12} {nanos:>12.0}");
        }
    }
    println!("\n{:<20} {:>8} {:>12} {:>12}", "with a signal", "robots", "bytes each", "ns a row");
    for (name, property) in WITH_SIGNAL {
        for robots in [1, 1_000, most] {
            let (bytes, nanos) = cost_of_rows(&program(&format!("property {name}: {property}\n")), robots);
            println!("{name:<20} {robots:>8} {bytes:>12} {nanos:>12.0}");
        }
    }
    println!("\n{:<20} {:>8} {:>12} {:>12}", "with one open", "robots", "bytes each", "ns an event");
    for (name, property) in OPEN {
        for robots in [1, 1_000, most] {
            let (bytes, nanos) = cost_while_open(&program(&format!("property {name}: {property}\n")), robots);
            println!("{name:<20} {robots:>8} {bytes:>12} {nanos:>12.0}");
        }
    }
}

/// Bytes an instance, and nanoseconds of an event of one of them while all wait for something.
fn cost_while_open((program, names): &(Program, Vec<String>), robots: u32) -> (i64, f64) {
    let kick = names.iter().position(|known| known == "kick").expect("the properties read it");
    let mut state = State::new(program);
    let mut at = 1_700_000_000_000_000_000;
    let mut tell = |state: &mut State, what: What<'_>| {
        at += 100;
        state.feed(program, Sample { time: Time(at), what }, &mut ());
    };
    tell(&mut state, What::Row { cells: &[Value::Bool(false)] });
    let mut kick_of = |state: &mut State, robot: u32| {
        tell(state, What::Event { event: kick, values: &[Value::Num(f64::from(robot))] });
    };
    kick_of(&mut state, 0);
    let bytes = measure(|| (1..robots + 1).for_each(|robot| kick_of(&mut state, robot))).bytes_current;
    let mut least = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        (0..ROWS).for_each(|n| kick_of(&mut state, 1 + n % robots));
        least = least.min(start.elapsed().as_secs_f64() * 1e9 / f64::from(ROWS));
    }
    let outcomes = state.finish(program, &Ending::default(), &mut ());
    assert!(outcomes.iter().all(|outcome| outcome.failed == 0 && outcome.open > 0), "{:?}", outcomes[0]);
    (bytes / i64::from(robots), least)
}

/// Bytes an instance, and nanoseconds of a row that turns the signal.
fn cost_of_rows((program, names): &(Program, Vec<String>), robots: u32) -> (i64, f64) {
    let mut state = State::new(program);
    let at = std::cell::Cell::new(1_700_000_000_000_000_000);
    let tell = |state: &mut State, what: What<'_>| {
        at.set(at.get() + 100);
        state.feed(program, Sample { time: Time(at.get()), what }, &mut ());
    };
    let row = |state: &mut State, near: bool| tell(state, What::Row { cells: &[Value::Bool(near)] });
    row(&mut state, true);
    let act = |state: &mut State, robots: std::ops::Range<u32>| {
        for name in ["turn", "kick", "turn"] {
            let Some(event) = names.iter().position(|known| known == name) else { continue };
            for robot in robots.clone() {
                let values = [Value::Num(f64::from(robot))];
                tell(state, What::Event { event, values: &values });
            }
        }
    };
    act(&mut state, 0..1);
    let bytes = measure(|| act(&mut state, 1..robots + 1)).bytes_current / i64::from(robots);
    let mut least = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        (0..ROWS).for_each(|n| row(&mut state, n % 2 == 1));
        least = least.min(start.elapsed().as_secs_f64() * 1e9 / f64::from(ROWS));
    }
    (bytes, least)
}

/// Bytes an instance and nanoseconds an event.
fn cost((program, names): &(Program, Vec<String>), steps: &[&str], robots: u32) -> (i64, f64) {
    let number = |name: &&str| names.iter().position(|known| known == name).expect("the property reads it");
    let steps: Vec<usize> = steps.iter().map(number).collect();
    let mut state = State::new(program);
    let mut at = 1_700_000_000_000_000_000;
    let mut all = |state: &mut State, turns: usize, robots: std::ops::Range<u32>| {
        for _ in 0..turns {
            for &event in &steps {
                for robot in robots.clone() {
                    at += 100;
                    let values = [Value::Num(f64::from(robot))];
                    state.feed(
                        program,
                        Sample { time: Time(at), what: What::Event { event, values: &values } },
                        &mut (),
                    );
                }
            }
        }
    };
    all(&mut state, TURNS, 0..1);
    let bytes = measure(|| all(&mut state, TURNS, 1..robots + 1)).bytes_current / i64::from(robots);
    let turns = TURNS * (100_000 / robots.clamp(1, 100_000)).max(1) as usize;
    let mut least = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        all(&mut state, turns, 1..robots + 1);
        least = least.min(start.elapsed().as_secs_f64() * 1e9 / (turns * steps.len()) as f64 / f64::from(robots));
    }
    let outcomes = state.finish(program, &Ending::default(), &mut ());
    assert!(outcomes.iter().all(|outcome| outcome.failed == 0 && outcome.cause.is_none()), "{:?}", outcomes[0]);
    (bytes, least)
}

/// The program of a property, and the names of its events.
fn program(property: &str) -> (Program, Vec<String>) {
    let declared: String = EVENTS.iter().map(|event| format!("event {event}\n")).collect();
    let text = format!("{declared}{property}");
    let mut sources = SourceMap::default();
    let file = sources.add("bench.rv", &*text);
    let loaded = load(&mut sources, lapwing_syntax::parse(file, &text).file, &|_| None);
    let events = EVENTS.map(String::from).to_vec();
    let shape = TraceShape { schemaless: true, events, columns: vec!["near".to_owned()], ..TraceShape::default() };
    let checked = check(&sources, &loaded, Some(&shape));
    assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
    (compile(&checked.spec), checked.spec.events.iter().map(|event| event.name.clone()).collect())
}
