//! What a robot knows of itself and of its surroundings: measured, with the errors that measuring has.

mod battery;
mod odometry;
mod scan;
mod ticker;

pub use battery::{Charge, Charger};
pub use odometry::Encoders;
pub use scan::{LIMIT, scan};
pub use ticker::Ticker;
