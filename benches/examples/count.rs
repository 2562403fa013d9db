//! `valgrind --tool=callgrind --toggle-collect='*by_engine*' target/release/examples/count RecurBqr 100`: the instructions of a hundred
//! thousand steps on a satisfying trace; with `*by_loop*` those of the hand-written loop.

#[path = "../src/program.rs"]
mod program;
#[path = "../src/timescales.rs"]
#[allow(dead_code)] // The other bench needs all of it.
mod timescales;

use lapwing_engine::{Program, State};
use timescales::{Property, Row};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_default();
    let property = Property::ALL.into_iter().find(|p| format!("{p:?}") == name).unwrap_or(Property::RecurGlb);
    let bound = arguments.next().and_then(|b| b.parse().ok()).unwrap_or(100);
    let rows = property.satisfying(bound, 100_000);
    let program = program::of(&property.formula(bound));
    println!("{property:?} {bound}: {} {}", by_engine(&program, &rows), by_loop(property, bound, &rows));
}

#[inline(never)]
fn by_engine(program: &Program, rows: &[Row]) -> u64 {
    let mut state = State::new(program);
    program::feed(&mut state, program, rows);
    state.instants()
}

#[inline(never)]
fn by_loop(property: Property, bound: u32, rows: &[Row]) -> u64 {
    property.by_hand(bound, rows)
}
