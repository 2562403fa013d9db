//! The language RT-BIP: its text, its meaning, and an engine that runs models.
//!
//! A text is parsed into a [`ast::Package`] ([`parse`]), its names and types are checked ([`check`]), and from a root a [`Model`] is made
//! ([`Checked::model`]): atoms, and the moves that they can make together. An [`Engine`] runs a model step by step: it says what is
//! possible ([`Engine::offers`]), and does what its caller decides ([`Engine::make`]). [`Run`] is a caller that draws lots, in simulated or real
//! time, and writes the log. [`print`] writes trees as text, for programs that make models.
//!
//! Neither the model nor the engine knows a thread or a clock: time comes from the caller, functions are answered by a [`Host`], and what
//! happens outside comes in as events of external ports ([`Engine::notify`]).

#![forbid(unsafe_code)]

pub mod ast;
mod lexer;
mod parser;
mod printer;

mod check;
mod template;

mod bits;
mod code;
mod time;
mod value;

mod flatten;
mod model;

mod engine;
mod schedule;

mod log;
mod run;

mod host;
mod library;

pub use check::{Checked, check};
pub use engine::{Engine, Fault, MoveId, Offer, Rules, Standing, Violation};
pub use host::{Bound, Host, Registry, Signature};
pub use lapwing_diag::FileId;
pub use library::{Pace, standard};
pub use log::{Detail, Log, Sink};
pub use model::{Atom, External, Model};
pub use parser::{Parsed, parse};
pub use printer::print;
pub use run::{Ending, Event, Monotonic, Options, Policy, Run, Simulated, Woken, World};
pub use schedule::{Schedule, Scheduler};
pub use time::{Time, Window};
pub use value::{Opaque, Type, Value};
