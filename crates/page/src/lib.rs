//! The report page: one HTML file with everything in it, that asks the network for nothing; and its sibling, the [`live`] page of a run that goes on.
//!
//! ```text
//! Report, History ──▶ Entry: the text of a recording (`run`, `property`) and what its charts draw (`data`)
//! entries ──▶ write: the index where there are several (`index`), styles and scripts (`assets`), all in one document (`document`)
//! ```
//!
//! What is to be read is HTML, there for whoever has no scripts or does not see; charts are drawn into it by the scripts in `assets`, with
//! plotly.js. Names and texts come from specifications and recordings, which may be hostile: everything goes through [`mod@html`], and the
//! document's content security policy lets no script run but ours.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod document;
mod index;

mod data;
mod diagram;
mod property;
mod run;

mod assets;
mod html;

mod live;

pub use diagram::figure as diagram;
pub use document::{points, write};
pub use live::{live, live_policy};
pub use run::{Entry, entry};
