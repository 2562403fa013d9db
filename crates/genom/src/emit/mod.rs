//! Automata as texts for other tools: RT-BIP, UPPAAL, pictures.
//!
//! The same system gives the same text, byte by byte.

mod bip;
mod c;
mod names;
pub mod parts;
mod picture;
mod share;
mod uppaal;

use lapwing_diag::{SourceMap, Span};

use crate::automata::System;

pub use bip::bip;
pub use c::{CFile, NotInC, c_codels, c_files, fingerprint};
pub use names::bip as bip_name;
pub use picture::automata_graphs;
pub use share::Sharing;
pub use uppaal::uppaal;

/// What the writers need beside the automata.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The automata.
    pub system: &'a System,
    /// The texts that they come from, for comments that name their lines.
    pub sources: &'a SourceMap,
}

impl Input<'_> {
    /// A place as comments name it: `ImuDriver.gen:12`.
    fn line(&self, span: Span) -> String {
        let name = self.sources.name(span.file);
        let name = name.rsplit(['/', '\\']).next().unwrap_or(name);
        format!("{name}:{}", self.sources.position(span).0)
    }
}
