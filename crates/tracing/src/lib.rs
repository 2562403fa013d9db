//! Lapwing inside a Rust program.
//!
//! A well-kept Rust program has `#[instrument]` and `event!` already: its spans are the calls, its fields the values. A monitor made from a
//! specification becomes its subscriber by one line in `main`, and the rest of the program does not know of it:
//!
//! ```
//! use lapwing_tracing::{Handlers, Monitor, Spec};
//!
//! mod kicker {
//!     use tracing::instrument;
//!
//!     #[instrument(ret)]
//!     pub fn ready() -> bool {
//!         false
//!     }
//!
//!     #[instrument]
//!     pub fn play() {}
//! }
//!
//! let spec = "event ready = return Kicker::ready when result == true
//! event unready = return Kicker::ready when result == false
//! event play = call Kicker::play
//! property init over (ready, unready, play): ltl([](play => <*> ready))
//! on violation of init { run plug_in_cables  reset }
//! ";
//! let recoveries = Handlers::new().on("plug_in_cables", |violation, robot: &&str| println!("{robot}: {violation}"));
//! let monitor = Monitor::builder(Spec::parse("init.rv", spec, &|_| None)?).handlers("r1", recoveries).install()?;
//!
//! kicker::ready();
//! kicker::play(); // before its body runs, `plug_in_cables` does
//! let report = monitor.finish();
//! assert_eq!(report.properties[0].verdict.word(), "violated");
//! assert_eq!(report.properties[0].reactions, ["ran plug_in_cables", "reset"]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The way of an event: the plan of its call site is worked out when that registers (`wants`, `sites`, `site`). When it is passed, the `layer`
//! takes the values that the plan asks for (`scratch`, `literal`) and what the `spans` around it hand on. It arrives at the `desk`, where
//! it gets its stamp and is stepped; what it violates is answered (`reaction`, `handlers`) before the program goes on,
//! and before the other layers do (`aside`).

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod builder;
mod clock;
mod handlers;
mod monitor;

mod hints;
mod layer;
mod literal;
mod scratch;
mod site;
mod sites;
mod spans;
mod wants;

mod aside;
mod desk;
mod reaction;
mod recorder;

#[cfg(feature = "log")]
mod bridge;

#[cfg(feature = "log")]
pub use bridge::LogBridge;
pub use builder::{BuildError, Builder, MissingHandler};
pub use clock::{Clock, ManualClock, SystemClock};
pub use handlers::{Handlers, Violation};
pub use lapwing::{Spec, SpecError};
pub use lapwing_react::Report;
pub use lapwing_stream::{Time, Value};
pub use layer::{MonitorFilter, MonitorLayer};
pub use monitor::Monitor;
