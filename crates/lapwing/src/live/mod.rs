//! Live robots: specifications over a [`Connector`] while things happen.
//!
//! What arrives is put into one stream of stamped *sights*: messages, and beside them whatever else decides what can be judged, such as who
//! publishes and what was lost. The [`course`] of a run is a function of that stream and of nothing else. A [`Station`] makes the stream: it asks the
//! connector, stamps by the [`clock`] in use, keeps a recording ([`tape`]), and wakes the course up when a deadline
//! passes in silence. A recording holds the same stream, so that checking it ([`replay`]) gives the same verdicts.
//!
//! Inside the course, the [`graph`] is what was met; each specification has a [`post`] whose [`shift`]s judge; the [`blind`]ness ledger
//! and the [`rhythm`] of topics see to it that nothing is missed in silence; [`order`] sorts where time is that of headers.
//!
//! What a run does to the robot stands beside the course, since no recording repeats it: [`reactions`], [`guard`]s,
//! and what the [`herald`] says on the graph. A [`view`] is how things stand at a moment.

mod blind;
mod clock;
mod course;
mod figures;
mod graph;
mod guard;
mod herald;
mod order;
mod post;
mod reactions;
pub(crate) mod replay;
mod rhythm;
mod shift;
mod station;
mod tape;
mod view;

pub use clock::ClockChoice;
pub use figures::{Figures, Latency};
pub use reactions::{How, Reach, Touch, touches};
pub use station::{Ended, LiveOptions, Onlooker, Outcome, Station};
pub use view::{PropertyView, StateNow, TopicView, TrackView, View};
