//! `valgrind --tool=callgrind --toggle-collect='*by_engine*' target/release/examples/count RecurBqr 100`: the instructions of a hundred
//! thousand steps on a satisfying trace; with `*by_loop*` those of the hand-written loop. `count W2 100` takes a hundred properties of the
//! robot's log, `count W2 4` four of them.

#[path = "../src/program.rs"]
mod program;
#[path = "../src/robot.rs"]
#[allow(dead_code)] // The other bench needs all of it.
mod robot;
#[path = "../src/timescales.rs"]
#[allow(dead_code)] // The other bench needs all of it.
mod timescales;

use lapwing_engine::{Program, State};
use program::Cell;
use timescales::{Property, Row};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_default();
    let bound = arguments.next().and_then(|b| b.parse().ok()).unwrap_or(100);
    if name == "W2" {
        let questions = robot::hundred();
        let asked = &questions[..questions.len().min(bound as usize)];
        let formulas: Vec<String> = asked.iter().map(|q| q.formula()).collect();
        let rows = robot::log(STEPS);
        let by_loop = by_robots_loop(asked, &rows);
        return println!("{} {by_loop}", by_engine(&program::of(robot::COLUMNS, &formulas), &rows));
    }
    let property = Property::ALL.into_iter().find(|p| format!("{p:?}") == name).unwrap_or(Property::RecurGlb);
    let rows = property.satisfying(bound, STEPS);
    let program = program::of(timescales::COLUMNS, &[property.formula(bound)]);
    println!("{property:?} {bound}: {} {}", by_engine(&program, &rows), by_loop(property, bound, &rows));
}

const STEPS: usize = 100_000;

#[inline(never)]
fn by_engine<C: Cell + Default, const N: usize>(program: &Program, rows: &[[C; N]]) -> u64 {
    let mut state = State::new(program);
    program::feed(&mut state, program, rows);
    state.instants()
}

#[inline(never)]
fn by_robots_loop(questions: &[robot::Question], rows: &[robot::Row]) -> u64 {
    let mut hands: Vec<robot::ByHand> = questions.iter().map(|q| q.by_hand()).collect();
    for (t, row) in rows.iter().enumerate() {
        hands.iter_mut().for_each(|hand| hand.step(t as i64, row));
    }
    hands.iter().map(|hand| hand.bad).sum()
}

#[inline(never)]
fn by_loop(property: Property, bound: u32, rows: &[Row]) -> u64 {
    property.by_hand(bound, rows)
}
