//! The language's meaning as slow, obvious code: the oracle that the engine is tested against.
//!
//! [`evaluate`] takes a checked specification and a whole recorded trace and says what is true of each property, straight from the
//! definitions of the language reference: a formula's value at a position is computed by recursion over the whole trace, and the time
//! at which an obligation is decided is found by trying every moment in turn. Nothing here is fast, nothing is incremental, and
//! nothing is shared with the engine but the specification.
//!
//! In reading order: [`Trace`] and its pieces, the latest values and events of a piece, the instants and positions of a property,
//! expressions and past operators, the table of future operators, obligations, machines, verdicts.

#![forbid(unsafe_code)]

#[cfg(test)]
mod agreement;
mod course;
mod future;
pub mod generate;
mod instants;
mod machines;
mod margin;
mod obligations;
mod piece;
mod trace;
mod truth;
mod vacuity;
mod values;
mod verdict;
mod world;

pub use obligations::Episode;
pub use trace::{Arrival, Trace};
pub use verdict::{Outcome, evaluate};
pub use world::{Delivery, Tracked};
