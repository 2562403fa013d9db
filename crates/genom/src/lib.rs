//! GenoM3 components: their specifications read, checked, and turned into timed automata, BIP and UPPAAL.
//!
//! ```text
//! files ──cpp──▶ tokens ──parser──▶ ast ──resolve──▶ model ──automata──▶ System ──emit──▶ BIP, UPPAAL, DOT
//!                                                      └──graph──▶ pictures of components and activities
//! ```
//!
//! To read: [`mod@model`] says what a specification comes to; [`automata`] how it behaves; the rest is the way there and back. [`load`] reads files.

#![forbid(unsafe_code)]

pub mod ast;
pub mod model;
pub mod mutex;

pub mod automata;
pub mod emit;
pub mod graph;

mod check;
mod cpp;
mod extra;
mod lexer;
mod parser;
mod resolve;
mod token;

use std::io;
use std::path::{Path, PathBuf};

use lapwing_diag::{Diagnostic, SourceMap, has_errors};

pub use check::shown;
pub use cpp::{Disk, Files, GENOM_VERSION};
pub use extra::duration;
pub use model::Model;

/// How to read specifications.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Where to look for includes (`-I`).
    pub folders: Vec<PathBuf>,
    /// Macros (`-D`): `NAME` or `NAME=VALUE`.
    pub defines: Vec<String>,
    /// A file of execution times.
    pub wcet: Option<PathBuf>,
    /// A file that links ports.
    pub ports: Option<PathBuf>,
}

/// What was read.
#[derive(Clone, Debug, Default)]
pub struct Loaded {
    /// The texts.
    pub sources: SourceMap,
    /// What is wrong with them.
    pub diagnostics: Vec<Diagnostic>,
    /// What they mean. Where something is wrong it is what could be understood.
    pub model: Model,
}

impl Loaded {
    /// Whether the specifications cannot be used as they stand.
    pub fn has_errors(&self) -> bool {
        has_errors(&self.diagnostics)
    }
}

/// Reads specifications as one text, in the order of the files.
///
/// # Errors
///
/// A file that the caller names cannot be read. What is wrong with what is in the files, or with their includes, is in [`Loaded::diagnostics`].
pub fn load(files: &dyn Files, paths: &[PathBuf], options: &Options) -> Result<Loaded, (PathBuf, io::Error)> {
    let mut loaded = Loaded::default();
    let Loaded { sources, diagnostics, model } = &mut loaded;
    let mut cpp = cpp::Cpp::new(files, &options.folders, &options.defines, sources, diagnostics);
    for path in paths {
        cpp.file(path).map_err(|e| (path.clone(), e))?;
    }
    let read = cpp.finish();
    let items = parser::parse(read.tokens, diagnostics);
    // What could not be read declares names as well.
    let incomplete = read.incomplete || has_errors(diagnostics);
    *model = resolve::resolve(&items, incomplete, diagnostics);
    if let Some(path) = &options.wcet {
        let file = add(files, sources, path)?;
        extra::apply_wcet(model, sources, file, diagnostics);
    }
    if let Some(path) = &options.ports {
        let file = add(files, sources, path)?;
        extra::apply_ports(model, sources, file, diagnostics);
    }
    if check::are_of_a_size(&model.components, diagnostics) {
        extra::link_by_name(model, diagnostics);
        check::check(&model.components, diagnostics);
    }
    Ok(loaded)
}

fn add(files: &dyn Files, sources: &mut SourceMap, path: &Path) -> Result<lapwing_diag::FileId, (PathBuf, io::Error)> {
    let bytes = files.read(path).map_err(|e| (path.to_owned(), e))?;
    Ok(sources.add(path.display().to_string(), String::from_utf8_lossy(&bytes).into_owned()))
}
