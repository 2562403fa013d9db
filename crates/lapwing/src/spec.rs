//! A specification: its text, the files that it uses, and what is wrong with them.

use std::fmt;
use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lapwing_check::{Checked, Loaded, TraceShape, check, load};
use lapwing_diag::{Code, Diagnostic, SourceMap, Span, Style, has_errors, read_text};

use crate::fitted::{Fitted, Latest};
use crate::types::Known;

/// A specification without errors.
#[derive(Clone, Debug)]
pub struct Spec {
    name: String,
    loaded: Loaded,
    findings: Findings,
    alone: Checked,
    latest: Latest,
}

/// What was found in a specification, with the texts that it is about.
#[derive(Clone, Debug)]
pub struct Findings {
    /// The texts.
    pub sources: SourceMap,
    /// What was found, in the order of the text.
    pub diagnostics: Vec<Diagnostic>,
}

/// A specification that cannot be used.
#[derive(Debug)]
pub enum SpecError {
    /// Its file cannot be read.
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        error: io::Error,
    },
    /// It has errors.
    Wrong(Findings),
}

impl Spec {
    /// Reads and checks a file. Files that it uses are looked for beside it.
    pub fn load(path: &Path) -> Result<Spec, SpecError> {
        Spec::load_with(path, &[])
    }

    /// Reads and checks a file, with the message definitions of share trees, as [`lapwing_record::Options::msgs`] has them, for what its
    /// reactions write.
    pub fn load_with(path: &Path, msgs: &[PathBuf]) -> Result<Spec, SpecError> {
        let text = read_text(path).map_err(|error| SpecError::Unreadable { path: path.to_owned(), error })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let resolve = |used: &str| std::fs::read_to_string(folder.join(used)).ok();
        Spec::parse_with(&path.to_string_lossy(), &text, &resolve, msgs)
    }

    /// Whether it has instances over topics, all of which must be known before a recording is judged.
    pub fn runs_over_topics(&self) -> bool {
        self.loaded.runs_over_topics()
    }

    /// Reads and checks a text. `name` is what reports call it; `resolve` gives the text of a file that it uses.
    pub fn parse(name: &str, text: &str, resolve: &dyn Fn(&str) -> Option<String>) -> Result<Spec, SpecError> {
        Spec::parse_with(name, text, resolve, &[])
    }

    fn parse_with(
        name: &str,
        text: &str,
        resolve: &dyn Fn(&str) -> Option<String>,
        msgs: &[PathBuf],
    ) -> Result<Spec, SpecError> {
        let mut sources = SourceMap::default();
        let file = sources.add(name, text);
        let parsed = lapwing_syntax::parse(file, text);
        let mut loaded = load(&mut sources, parsed.file, resolve);
        loaded.define(&Known::of(msgs));
        let alone = check(&sources, &loaded, None);
        let diagnostics = all(parsed.diagnostics, &alone.diagnostics);
        let findings = Findings { sources, diagnostics };
        match has_errors(&findings.diagnostics) {
            true => Err(SpecError::Wrong(findings)),
            false => Ok(Spec { name: name.to_owned(), loaded, findings, alone, latest: Latest::default() }),
        }
    }

    /// What reports call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Warnings and notes.
    pub fn findings(&self) -> &Findings {
        &self.findings
    }

    /// What it means, as far as that is known without a recording.
    pub fn alone(&self) -> &Checked {
        &self.alone
    }

    /// What it means for recordings of that shape.
    pub fn against(&self, shape: &TraceShape) -> Checked {
        check(&self.findings.sources, &self.loaded, Some(shape))
    }

    /// The same, ready to run, with a limit of how many runs of obligations a property may have open.
    pub(crate) fn fitted(&self, shape: &TraceShape, open_limit: Option<NonZeroUsize>) -> Arc<Fitted> {
        self.latest.get(shape, open_limit, || Fitted::new(self, self.against(shape), open_limit))
    }

    /// The names and texts of the files that it consists of, its own first.
    pub(crate) fn texts(&self) -> impl Iterator<Item = (&str, &str)> {
        self.findings.sources.files()
    }

    /// The text under a place.
    pub(crate) fn slice(&self, span: Span) -> &str {
        self.findings.sources.slice(span)
    }

    /// Line and column of a place, from 1.
    pub(crate) fn position(&self, span: Span) -> (usize, usize) {
        self.findings.sources.position(span)
    }
}

/// What parser and check found. What the parser could not read is not there for the check: names that seem unknown then are left out.
fn all(parsed: Vec<Diagnostic>, checked: &[Diagnostic]) -> Vec<Diagnostic> {
    let follows =
        |code| matches!(code, Code::UnknownName | Code::UnknownFunction | Code::UnknownState | Code::UnusedName);
    let broken = has_errors(&parsed);
    let mut all = parsed;
    all.extend(checked.iter().filter(|d| !broken || !follows(d.code)).cloned());
    all.sort_by_key(|d| (d.primary.span.file, d.primary.span.start));
    all
}

impl Findings {
    /// All of them as text.
    pub fn render(&self, style: Style) -> String {
        self.diagnostics.iter().map(|d| lapwing_diag::render(&self.sources, d, style)).collect()
    }
}

impl fmt::Display for SpecError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SpecError::Unreadable { path, error } => write!(f, "{}: {error}", path.display()),
            SpecError::Wrong(findings) => f.write_str(findings.render(Style::Plain).trim_end()),
        }
    }
}

impl std::error::Error for SpecError {}
