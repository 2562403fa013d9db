//! Where text came from, and what is wrong with it.
//!
//! A diagnostic is data: a stable code, a sentence, places in the source, hints. Whoever finds a fault builds a [`Diagnostic`]
//! and pushes it; rendering happens at the edge, in [`render`]. Each code has a page in `codes/`, which `lapwing explain CODE` prints.

#![forbid(unsafe_code)]

mod code;
mod diagnostic;
mod render;
mod source;
pub mod suggest;
mod text;

pub use code::Code;
pub use diagnostic::{Diagnostic, Label, Severity, has_errors};
pub use render::{Style, render, render_short};
pub use source::{FileId, SourceMap, Span};
pub use text::{read_text, text};
