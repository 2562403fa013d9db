//! Numbers make due only what compares them with a constant that they cross; what comes of it is what comes of running everything.

mod support;

use lapwing_engine::Program;
use lapwing_engine::program::Wake;
use lapwing_stream::Value;
use support::{chance, clock, program, run};

const SPECS: [&str; 9] = [
    "a: x < 2\nb: 2 <= x or y > 1\n",
    "a: once within 10 ms x =={0.5} 1\nb: abs(x) >{0.25} 1 implies y !={1} 0\n",
    "a: (x < 2 since within 5 ms -1 > y) or abs(y) <= 2\n",
    "a: whenever x > 2, eventually within 7 ms y < 1\nb: after x > 3, always within 20 ms y <= 3\n",
    "a: x and not (y since x > 0)\n",
    "a: x and y\nb: x and once within 9 ms not y\n",
    "_rate_ = 300\na: x < 2 implies once within 10 ms y > 1\nb: delta(x) < 1 or x > 2\n",
    "a: x < y or x > 1\nb: becomes x > 2 or previously y =={0.5} 2\nc: held for 3 ms x < 3\n",
    "a: x < 1 + 1 implies (once within 4 ms y > -(3 - 1)) and not (x > 1 since within 30 ms y == 2)\n",
];

/// Two columns: numbers near those that are asked for, now and then none, NaN or an infinity, and a truth value where kinds are `mixed`.
fn rows(seed: u64, mixed: bool) -> Vec<(i64, [Value; 2])> {
    let (mut next, mut clock) = (chance(seed), clock(seed));
    let mut at = [0.0_f64; 2];
    let mut cell = |at: &mut f64| {
        *at = (*at + [0.0, 0.25, -0.25, 0.5, -0.5, 1.0, -1.0, 3.0][next() as usize % 8]).clamp(-4.0, 4.0);
        match next() % 60 {
            0 => Value::Missing,
            1 => Value::Num(f64::NAN),
            2 => Value::Num(f64::INFINITY),
            3 => Value::Num(-0.0),
            4 => Value::Num(at.next_up()),
            5 | 6 if mixed => Value::Bool(*at > 0.0),
            _ => Value::Num(*at),
        }
    };
    (0..600).map(|_| (clock(), [cell(&mut at[0]), cell(&mut at[1])])).collect()
}

/// Where every number makes everything due that reads it.
fn without_cuts(program: &Program) -> Program {
    let mut plain = program.clone();
    for slot in &mut plain.slots {
        slot.cuts.clear();
        slot.every = slot.wakes.iter().map(|wake| Wake { letter: Wake::NO_LETTER, ..*wake }).collect();
    }
    plain
}

#[test]
fn numbers_that_cross_no_cut_change_nothing() {
    for (n, text) in SPECS.iter().enumerate() {
        let quick = program(text, &["x", "y"]);
        assert!(quick.slots.iter().any(|slot| !slot.cuts.is_empty()), "{text} compares nothing with constants");
        let plain = without_cuts(&quick);
        for seed in 0..20 {
            // Truth values have no order: only where signals are conditions they may come as well.
            let rows = rows(n as u64 * 1000 + seed, text.contains("x and"));
            assert_eq!(run(&quick, &rows), run(&plain, &rows), "{text}, seed {seed}");
        }
    }
}

/// A signal of which nobody asks more than that has a band, and leaves it as often as a limit is crossed.
#[test]
fn limits_are_cuts_and_anything_else_is_not() {
    let cuts = |text: &str| {
        let program = program(text, &["x", "y"]);
        program.slots.iter().map(|slot| (slot.cuts.len(), slot.every.len())).collect::<Vec<_>>()
    };
    assert_eq!(cuts("a: x < 2 and y > 1\n"), [(1, 0), (1, 0)]);
    assert_eq!(cuts("a: abs(x) < 2\nb: x =={0.1} 1\n"), [(4, 0)]);
    assert_eq!(cuts("a: x < 2\nb: x < y\n"), [(1, 1), (0, 1)]);
    assert_eq!(cuts("a: delta(x) < 2\n"), [(0, 1)]);
}
