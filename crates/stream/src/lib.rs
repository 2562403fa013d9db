//! What flows through Lapwing: time, values, message schemas and verdicts.
//!
//! Every connector (a recording, a live robot, a program, a simulator) speaks in these types, and so does the engine.
//! The crate needs an allocator and nothing else; it knows no file and no clock, and of texts only how a value is written as [JSON](json).

#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

pub mod json;
mod sample;
mod schema;
mod time;
mod value;
mod verdict;

pub use sample::{Sample, What};
pub use schema::{Constant, Field, Schema, Type};
pub use time::{Duration, Time};
pub use value::{Name, Value};
pub use verdict::Verdict;
