//! Operators are evaluated where something makes them due; what comes of it is what comes of evaluating all of them at every position.

mod support;

use std::sync::Arc;

use lapwing_check::{TraceShape, TraceTopic};
use lapwing_engine::Program;
use lapwing_stream::{Field, Schema, Time, Type, Value, What};
use support::{chance, clock, program, program_over, run, run_samples};

const SPECS: [&str; 10] = [
    "a: delta(x) < 0.3\n",
    "a: abs(delta(x)) > 0.2 implies once within 10 ms y > 1\nb: delta(delta(x)) <= 0.5\n",
    "a: x @ 1 <= x or y > 0\nb: y @ 3 < 2\n",
    "a: (x @ 2) - (x @ 1) < 0.6 since within 9 ms y < 1\n",
    "a: rate(x) < 40\nb: delta(x - y) <= 1\n",
    "a: whenever held for 3 ms (delta(y) =={1e-6} 0), x =={1.5} y\n",
    "a: whenever x > y, eventually within 7 ms y >= x\nb: after x > 2.5, always x + y < 5\n",
    "a: after_until x > 2, y > 2, always x * y < 4\n",
    "a: max(x, 5 ms) - min(x, 5 ms) < 2\nb: count(delta(x) > 0, 6 ms) < 3\n",
    "_rate_ = 700\na: delta(x) < 0.5\nb: whenever x < y, eventually within 4 ms y < x\n",
];

/// Over the topics `/m` and `/n`, whose numbers are x and y.
const AGED: [&str; 7] = [
    "a: age(/m) < 0.01\nb: x < y or age(/n) <= 0.02\n",
    "a: once within 15 ms (age(/m) >= 0.008) implies x < 2\n",
    "a: whenever age(/m) > 0.006, x < y\nb: whenever held for 5 ms (age(/n) < 0.02), eventually within 9 ms x > y\n",
    "a: becomes age(/m) > 0.004 implies previously x < 1\nb: age(/n) =={0.001} 0.005 implies delta(y) < 0.3\n",
    "a: after x > 2, always age(/m) < 0.03\nb: after_until age(/n) > 0.01, y > 1, never x > y\n",
    "a: @{(0.004 > age(/m)), -1} or x > 2\nb: @{(age(/n) <= 0.01), -3} implies y < 2\n",
    "a: age(/m) < age(/n) or 0.012 > age(/m)\nb: frequency(/n, 20 ms) > 60 or age(/n) < 0.005\n",
];

/// Two columns of numbers that often stay for a while.
fn rows(seed: u64) -> Vec<(i64, [Value; 2])> {
    let (mut next, mut clock) = (chance(seed), clock(seed));
    let mut at = [0.0_f64; 2];
    let mut cell = |at: &mut f64| {
        *at = (*at + [0.25, -0.25, 0.5, -0.5, 1.0].get(next() as usize % 15).copied().unwrap_or(0.0)).clamp(-3.0, 3.0);
        match next() % 60 {
            0 => Value::Missing,
            1 => Value::Num(f64::NAN),
            2 => Value::Num(f64::INFINITY),
            _ => Value::Num(*at),
        }
    };
    (0..600).map(|_| (clock(), [cell(&mut at[0]), cell(&mut at[1])])).collect()
}

/// Where everything is due at every position.
fn always_due(program: &Program) -> Program {
    let mut plain = Program { skim: None, ..program.clone() };
    for group in &mut plain.groups {
        (group.rests, group.idles) = (false, false);
        if let Some(wiring) = &mut group.at.wiring {
            let all = (0..group.at.ops.len()).fold(0, |all, i| all | 1 << i);
            (wiring.always, wiring.aged, wiring.alphabet) = (all, 0, None);
        }
    }
    plain
}

#[test]
fn what_is_not_due_stays_as_it_is() {
    for (n, text) in SPECS.iter().enumerate() {
        let quick = program(text, &["x", "y"]);
        let plain = always_due(&quick);
        for seed in 0..30 {
            let rows = rows(n as u64 * 1000 + seed);
            assert_eq!(run(&quick, &rows), run(&plain, &rows), "{text}, seed {seed}");
        }
    }
}

fn number_topic(name: &str) -> TraceTopic {
    let ty = Type::Num { float: true };
    let schema =
        Schema { name: "std_msgs/Float64".into(), fields: vec![Field { name: "data".into(), ty }], constants: vec![] };
    TraceTopic { name: name.into(), type_name: "std_msgs/Float64".into(), schema: Some(Arc::new(schema)) }
}

/// What turns on an age is due with its message and where it passes a limit, which is an instant of its own.
#[test]
fn ages_are_due_where_they_pass_their_limits() {
    let shape = TraceShape { topics: ["/m", "/n"].map(number_topic).to_vec(), ..TraceShape::default() };
    for (n, text) in AGED.iter().enumerate() {
        let text = format!("decl x /m Float64.data\ndecl y /n Float64.data\n{text}");
        let quick = program_over(&text, &shape);
        let plain = always_due(&quick);
        for seed in 0..30 {
            let rows = rows(n as u64 * 1000 + seed);
            let mut next = chance(seed);
            let samples: Vec<(Time, What<'_>)> = rows
                .iter()
                .map(|(time, cells)| {
                    let (topic, values) = if next().is_multiple_of(3) { (1, &cells[1..]) } else { (0, &cells[..1]) };
                    (Time(*time), What::Message { topic, values })
                })
                .collect();
            let [quick, plain] = [&quick, &plain].map(|program| run_samples(program, samples.iter().copied()));
            assert_eq!(quick, plain, "{text}, seed {seed}");
        }
    }
}
