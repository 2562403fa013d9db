//! GenoM3 components that run.
//!
//! ```text
//! model ──automata──▶ System ──machine──▶ moves ──run──▶ happenings ──watch──▶ verdicts, reactions
//!                                   ▲         │              └──record──▶ NDJSON, MCAP
//!                       clocks, requests   codels: Rust, C, or none, which only take time
//! ```
//!
//! To read: [`Run`] has the loop; `machine` takes the automata from move to move; [`codel`] is what a codel sees; [`Watch`] has the monitors, and
//! `signals` says as which messages they see what happens.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod codel;
mod run;

mod machine;

mod access;
mod store;

mod datum;
mod types;

mod figures;
mod happening;
pub mod request;

pub mod model;
mod record;
mod signals;
mod tell;
mod watch;

pub use codel::{Answer, Call, Codel, Codels, Trouble, TroubleKind};
pub use datum::Datum;
pub use figures::{Count, Figures};
pub use happening::{CodelPlace, Failure, Happening, Outcome, What, Whose, line, place};
pub use record::Recorder;
pub use request::{Request, RequestError};
pub use run::{CannotRun, Client, Observer, Run, Setup};
pub use signals::{Message, Signals, Topic};
pub use tell::{Teller, stamp};
pub use types::{Layout, Types};
pub use watch::{Mismatch, Watch};
