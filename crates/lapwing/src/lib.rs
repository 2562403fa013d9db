//! Lapwing as a library: a specification, and a session that checks a recording with it.
//!
//! ```
//! use lapwing::{Options, Session, Spec};
//!
//! let spec = Spec::parse("speed.rv", "never speed > 2.0\n", &|_| None)?;
//! let trace = std::env::temp_dir().join("lapwing-doc.csv");
//! std::fs::write(&trace, "time,speed\n0.0,1.5\n0.1,2.5\n")?;
//!
//! let specs = [spec];
//! let report = Session::open(&specs, &trace, &Options::default())?.run(&mut ());
//! let property = &report.properties[0];
//! assert_eq!(property.verdict.word(), "violated");
//! assert_eq!(property.violations[0].failed.seconds(), 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The way of a recording through a session: its topics and their types make a `shape` that every specification is checked
//! against once more; what is then wanted of it is read; each item goes to a `run` for each specification, which feeds the
//! engine, and whose `witness` keeps what a report will need; at the end an `account` of each property
//! is drawn up. Where a page is wanted, a `history` notes beside it how everything went over time.
//!
//! A running program takes the same way from the `run` on: its [`Monitor`] is handed samples instead of a recording. The feature
//! `recordings`, on by default, brings in what reads files; a program that is only monitored does without.

#![forbid(unsafe_code)]
#![warn(missing_docs)]
// What only sessions over recordings ask for lies idle without them.
#![cfg_attr(not(feature = "recordings"), allow(dead_code))]

mod monitor;
#[cfg(feature = "recordings")]
mod session;
mod spec;
mod types;
mod watch;

mod fitted;
mod instance;
#[cfg(feature = "recordings")]
mod intake;
mod losses;
mod needs;
mod run;
#[cfg(feature = "recordings")]
mod shape;

mod eval;
mod moment;
mod ring;
mod shown;
mod ticks;
mod trail;
mod witness;

mod history;

mod account;
mod hints;
mod meant;
mod words;

#[cfg(feature = "recordings")]
pub mod capsule;
pub mod explain;
#[cfg(feature = "recordings")]
pub mod live;
#[cfg(feature = "recordings")]
pub mod starter;
#[cfg(feature = "recordings")]
pub mod status;
pub mod tune;

pub use lapwing_check::{LIBRARIES, Library, ShippedPattern};
pub use lapwing_react::{Report, Standing};
#[cfg(feature = "recordings")]
pub use lapwing_record::{OpenError, TimeSource};
pub use monitor::{Monitor, News, Unseen};
#[cfg(feature = "recordings")]
pub use session::{Options, Session, unopened};
#[cfg(feature = "recordings")]
pub use shape::waits_for_end;
pub use spec::{Findings, Spec, SpecError};
pub use watch::Watch;
