//! Generated cases whose samples lie: stamps from the ends of time, values of the wrong kind and number, topics that are not there.

use lapwing_check::checked::Spec;
use lapwing_check::compile::compile;
use lapwing_engine::program::Clock;
use lapwing_engine::{Ending, Program, State};
use lapwing_reference::Arrival;
use lapwing_reference::generate::generate;
use lapwing_stream::{Sample, Time, Value, What};

use super::Dice;
use crate::random::{Told, run};

/// How long the traces and how deep the formulas are, about.
const SIZE: usize = 24;
const HOUR: i64 = 3_600_000_000_000;

/// Engine and reference say the same of the case of a seed.
pub fn differential(data: &[u8]) {
    if let Told::Differed(how) = run(Dice { data }.long()) {
        panic!("{how}");
    }
}

/// The case of a seed, with lies told by the bytes after it.
pub fn step(data: &[u8]) {
    let mut dice = Dice { data };
    let case = generate(dice.long(), SIZE);
    let spec = super::texts::checked(&case.text(), &case.shape).expect("generated texts are right");
    let mut samples = case.trace(&spec).samples;
    for _ in 0..dice.below(12) {
        lie(&mut samples, &mut dice);
    }
    let mut program = compile(&spec);
    program.open_limit = dice.pick(&[program.open_limit, 4, 1, 0]);
    drive(&program, &samples, &mut dice);
}

fn lie(samples: &mut Vec<(Time, Arrival)>, dice: &mut Dice<'_>) {
    let at = dice.below(samples.len());
    let Some(sample) = samples.get(at).cloned() else { return };
    match dice.below(8) {
        0 | 1 => samples[at].0 = stamp(dice),
        2 => {
            let by = dice.pick(&[1, HOUR, 1 << 55, i64::MAX]);
            samples[at..].iter_mut().for_each(|s| s.0.0 = s.0.0.saturating_add(by));
        }
        3 => samples.insert(at, sample),
        4 => samples[at].1 = elsewhere(&sample.1, dice.pick(&[0, 1, 1000, usize::MAX])),
        kind => {
            let Some(values) = values(&mut samples[at].1) else { return };
            match kind {
                5 => values.push(value(dice)),
                6 => _ = values.pop(),
                _ if values.is_empty() => {}
                _ => {
                    let n = dice.below(values.len());
                    values[n] = value(dice);
                }
            }
        }
    }
}

fn stamp(dice: &mut Dice<'_>) -> Time {
    let any = dice.long() as i64;
    Time(dice.pick(&[i64::MIN, i64::MIN + 1, -HOUR, -1, 0, 1, HOUR, 1 << 60, i64::MAX - 1, i64::MAX, any]))
}

fn value(dice: &mut Dice<'_>) -> Value {
    let list = || Value::List(vec![Value::Num(1.0), Value::Missing, Value::from("x"), Value::List(Vec::new())]);
    match dice.below(16) {
        0 => Value::Missing,
        1 => Value::Bool(true),
        2 => Value::Num(f64::NAN),
        3 => Value::Num(f64::INFINITY),
        4 => Value::Num(f64::NEG_INFINITY),
        5 => Value::Num(-0.0),
        6 => Value::Num(f64::MAX),
        7 => Value::Num(f64::MIN_POSITIVE / 2.0),
        8 => Value::from(""),
        9 => Value::Str("é".repeat(dice.below(300))),
        10 => Value::Nums(Vec::new()),
        11 => Value::Nums(vec![f64::NAN; dice.below(300)]),
        12 => list(),
        13 => Value::Record(Vec::new()),
        14 => Value::Record(vec![("data".into(), list())]),
        _ => Value::Num(f64::from_bits(dice.long())),
    }
}

/// The same, of another topic or as another event.
fn elsewhere(arrival: &Arrival, number: usize) -> Arrival {
    match arrival.clone() {
        Arrival::Message { values, .. } => Arrival::Message { topic: number, values },
        Arrival::Event { values, .. } => Arrival::Event { event: number, values },
        Arrival::Row { cells } => Arrival::Message { topic: number, values: cells },
        Arrival::Other => Arrival::Event { event: number, values: Vec::new() },
    }
}

fn values(arrival: &mut Arrival) -> Option<&mut Vec<Value>> {
    match arrival {
        Arrival::Message { values, .. } | Arrival::Event { values, .. } => Some(values),
        Arrival::Row { cells } => Some(cells),
        Arrival::Other => None,
    }
}

/// Feeds everything; a snapshot taken on the way comes to the same end, and no deadline comes twice.
fn drive(program: &Program, samples: &[(Time, Arrival)], dice: &mut Dice<'_>) {
    let mut state = State::new(program);
    let snapshot_at = dice.below(samples.len());
    let mut snapshot = state.clone();
    for (n, (time, arrival)) in samples.iter().enumerate() {
        if n == snapshot_at {
            snapshot = state.clone();
        }
        state.feed(program, Sample { time: *time, what: arrival.what() }, &mut ());
        if n % 4 == 0 {
            wakes_once(program, state.clone(), *time);
        }
    }
    for (time, arrival) in samples.get(snapshot_at..).unwrap_or_default() {
        snapshot.feed(program, Sample { time: *time, what: arrival.what() }, &mut ());
    }
    let end = |mut state: State| format!("{:?}", state.finish(program, &Ending::default(), &mut ()));
    assert_eq!(end(state), end(snapshot), "a snapshot goes on otherwise");
}

/// A live caller that wakes up after a deadline is not told to wake up for it again.
fn wakes_once(program: &Program, mut state: State, now: Time) {
    let Some(deadline) = state.next_deadline(program) else { return };
    let awake = Time(deadline.max(now).0.saturating_add(1));
    state.feed(program, Sample { time: awake, what: What::Other }, &mut ());
    if program.timeout.is_none() && awake.0 < i64::MAX {
        let next = state.next_deadline(program);
        assert!(next.is_none_or(|next| next > deadline), "{deadline:?} again, as {next:?}, after waking at {awake:?}");
    }
}

/// A few samples of whatever the specification reads, none of them as it should be.
pub fn run_for_a_while(spec: &Spec, seed: u64) {
    let program = compile(spec);
    let step = match program.clock {
        Clock::Events => 100_000_000,
        // A rate may be anything; a few instants between two samples are enough.
        Clock::Rate(hz) => 3_000_000_000 / i64::from(hz.max(1)),
    };
    let bytes: Vec<u8> = (seed..).map(|n| (n.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as u8).take(400).collect();
    let mut dice = Dice { data: &bytes };
    let mut samples = Vec::new();
    for n in 0..24 {
        let values = (0..8).map(|_| if dice.below(3) == 0 { value(&mut dice) } else { Value::Num(n as f64) }).collect();
        let arrival = match n % 3 {
            0 => Arrival::Row { cells: values },
            1 => Arrival::Message { topic: n / 3 % spec.topics.len().max(1), values },
            _ => Arrival::Event { event: n / 3 % spec.events.len().max(1), values },
        };
        samples.push((Time(n as i64 * step), arrival));
    }
    drive(&program, &samples, &mut dice);
}
