//! The monitors.
//!
//! A [`Program`] is what a checked specification compiles to: immutable, shareable. A [`State`] belongs to the caller: cloning it is
//! a snapshot, and stepping the clone gives the verdicts that stepping the original would have given.
//!
//! The way through a sample, from the outside in:
//!
//! 1. [`State::feed`] takes a sample ([`mod@feed`]). A [`piece`] of the trace keeps time: the clock of the specification, deadlines in their
//!    order; the sample's content becomes the latest of everything ([`intake`]).
//! 2. At an instant the signals have their latest values ([`inputs`]), then the machines move ([`machine`]).
//! 3. Each [`Group`](program::Group) of properties with the same positions walks on to the position, where the past operators that
//!    are due are evaluated ([`walk`], [`past`]), then its graph of future operators ([`future`]), whose decisions end obligations
//!    ([`tracker`]). A property with too many of them open is given up ([`overflow`]).
//!    Of many instances of a group only those that see the event are unpacked and stepped ([`mod@instances`], [`pack`]).
//! 4. Where it is asked for, margins are computed beside ([`mod@margin`]).
//!
//! The monitor of one property can start afresh ([`reset`](State::reset)).
//!
//! A state can be written as bytes and read back, and so can a program ([`saved`]); a state can be asked how a property stands so far ([`State::standing`]).
//!
//! There is no I/O here, no clock, no thread, no randomness and no iteration in hash order: time comes with the sample, and
//! [`State::next_deadline`] tells a live caller when to wake up. After warm-up a step does not allocate.

#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

pub mod program;

mod automaton;
mod earliest;
pub mod feed;
mod functions;
mod future;
mod group;
mod idle;
pub mod inputs;
mod instances;
mod intake;
mod judge;
mod keys;
mod lanes;
mod latest;
mod looks;
mod machine;
pub mod margin;
mod node;
pub mod outcome;
mod overflow;
mod pack;
mod past;
mod piece;
mod reset;
mod runs;
pub mod saved;
mod skim;
mod standing;
mod times;
mod tracker;
mod walk;
mod world;

pub use feed::{Ending, State};
pub use functions::{compare, numeric};
pub use outcome::{Alarm, Episode, Move, Observer, Outcome, Output};
pub use program::Program;
pub use saved::{NotLoaded, NotResumed};
pub use standing::{GivenUp, Standing};
