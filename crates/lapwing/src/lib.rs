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

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod session;
mod spec;
mod types;
mod watch;

mod intake;
mod losses;
mod run;
mod shape;

mod eval;
mod moment;
mod ring;
mod shown;
mod trail;
mod witness;

mod history;

mod account;
mod hints;
mod words;

pub mod capsule;
pub mod explain;
pub mod starter;
pub mod tune;

pub use lapwing_check::{LIBRARIES, Library, ShippedPattern};
pub use lapwing_react::{Report, Standing};
pub use lapwing_record::{OpenError, TimeSource};
pub use session::{Options, Session, unopened};
pub use spec::{Findings, Spec, SpecError};
pub use watch::Watch;
