//! What becomes of a verdict: reports as text, JSON, NDJSON and JUnit.
//!
//! A [`Report`] is plain data about one recording: what was read of it, what was said of each property, and why. Whoever checks fills
//! one in; the renderers here turn it into text and compute nothing. What happens on the way is an [`Event`].
//!
//! Reports of several recordings go into one document: [`Format::begin`], then what [`render`] gives for each with
//! [`Format::between`] between two, then [`end`].

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod backtest;
mod event;
mod format;
pub mod history;
mod json;
mod junit;
mod ndjson;
mod report;
pub mod shown;
mod tally;
mod text;

pub use event::Event;
pub use format::{Format, end, render};
pub use lapwing_diag::Style;
pub use ndjson::line;
pub use report::{Obligations, Property, Reading, Report, Role, Row, Scope, Topic, Violation, Warning};
pub use tally::{Standing, Tally};
pub use text::details;
pub use text::explanation;

#[cfg(test)]
mod tests;
