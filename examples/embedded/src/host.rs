//! A program without a standard library that runs a monitor, as the firmware of a robot would.
//!
//! It gets a program that was compiled elsewhere, then rows, on standard input, and steps the engine. Its heap is one array, from which
//! memory is only ever taken; it counts how often. `#![no_std]` alone would not prove much on a machine that has a standard library: here
//! a dependency that needs one does not link, as there are two panic handlers then.
//!
//! The input: the length of the program (32 bits, little-endian) and its bytes; how many cells a row has, and how many rows come before
//! memory is counted (32 bits each; the last row is not counted either); rows of a stamp in nanoseconds (64 bits) and cells, each a byte for its kind (0 none, 1 a truth value,
//! 2 a number) and the bits of a double.
//!
//! Code that is `unsafe` by name: the allocator, because that trait is; the entry point and the functions of C's library, by which a
//! program without a standard library begins, reads and writes.

#![no_std]
#![no_main]

extern crate alloc;

mod c;
mod heap;

use core::fmt::Write;

use lapwing_engine::{Ending, Program, State};
use lapwing_stream::{Sample, Time, Value, What};

use c::{Input, Output};

/// The most cells of a row.
const CELLS: usize = 8;
/// The most bytes of a program.
const LARGEST: usize = 1 << 16;

/// What C's library calls. Gives 0 where all went well.
#[unsafe(no_mangle)]
pub extern "C" fn main() -> i32 {
    match watch(&mut Input::default(), &mut Output) {
        Some(()) => 0,
        None => 1,
    }
}

/// `None` where the input breaks off or makes no sense.
fn watch(input: &mut Input, output: &mut Output) -> Option<()> {
    let mut bytes = [0; LARGEST];
    let bytes = bytes.get_mut(..input.number()? as usize)?;
    input.fill(bytes)?;
    let program = Program::load(bytes).ok()?;
    let mut state = State::new(&program);
    let cells = input.number()? as usize;
    let warm = input.number()?;
    let mut row: [Value; CELLS] = core::array::from_fn(|_| Value::Missing);
    let row = row.get_mut(..cells)?;
    let (mut rows, mut warmed, mut asked) = (0, 0, 0);
    while let Some(time) = input.stamp() {
        // What the last row asks for is counted by nobody: it may store a failure.
        asked = heap::asked();
        row.iter_mut().try_for_each(|cell| input.cell(cell))?;
        state.feed(&program, Sample { time: Time(time), what: What::Row { cells: row } }, &mut ());
        rows += 1;
        if rows == warm {
            warmed = heap::asked();
        }
    }
    // The last is not counted.
    let counted = rows.checked_sub(warm)?.checked_sub(1)?;
    writeln!(output, "asked {} in {} rows", asked.checked_sub(warmed)?, counted).ok()?;
    for outcome in state.finish(&program, &Ending::default(), &mut ()) {
        let first = outcome.episodes.first().map_or((0, 0), |e| (e.began.0, e.failed.0));
        let counts = (outcome.met, outcome.failed, outcome.open);
        writeln!(output, "{} {counts:?} {first:?}", outcome.verdict).ok()?;
    }
    Some(())
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    c::leave(101)
}
