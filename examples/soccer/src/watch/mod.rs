//! What watches the robot from outside: a log of what its program says, monitors made from `soccer.rv`, and what they do when something is
//! violated. The robot's program knows nothing of it.

mod listener;
mod log;
mod replay;
mod rescue;

pub use listener::Listener;
pub use log::{Entry, Log, What, ndjson};
pub use replay::{DIAGRAM, Happening, Judged, Replay, replay};
pub use rescue::{Rescue, handlers};
