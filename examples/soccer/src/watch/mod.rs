//! What watches the robot from outside: a log of what its program says, monitors made from `soccer.rv`, and what they do when something is
//! violated. The robot's program knows nothing of it.

#[cfg(feature = "field")]
mod listener;
#[cfg(feature = "field")]
mod log;
#[cfg(feature = "field")]
mod replay;
mod rescue;

use std::sync::Arc;

use lapwing_tracing::{BuildError, Monitor, Spec, SpecError};

use crate::robot::Kicker;
#[cfg(feature = "field")]
pub use listener::Listener;
#[cfg(feature = "field")]
pub use log::{Entry, Line, Log, What, lines, mcap, ndjson};
#[cfg(feature = "field")]
pub use replay::{DIAGRAM, Happening, Judged, Replay, replay};
pub use rescue::{Rescue, handlers};

/// The text of the specification.
pub const SPEC: &str = include_str!("../../soccer.rv");

/// The specification.
pub fn spec() -> Result<Spec, SpecError> {
    Spec::parse("soccer.rv", SPEC, &|_| None)
}

/// Watches a kicker from now on, by the machine's clock: all that a program needs that is monitored.
pub fn install(kicker: &Arc<Kicker>) -> Result<Monitor, BuildError> {
    Monitor::builder(spec()?).handlers(Rescue::new(kicker.clone(), None), handlers()).install()
}
