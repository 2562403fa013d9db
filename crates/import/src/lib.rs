//! Specifications from elsewhere: JavaMOP's monitors, and state diagrams of Mermaid and SCXML, as the text of a `.rv`.
//!
//! ```text
//! FILE.mop ──java──▶ events, formulas, automata, handlers ──┐
//! FILE.mmd, FILE.md ──mermaid──▶ chart ──flat──▶ machines ──┴──▶ sheet ──▶ text
//! FILE.scxml ──scxml──▶ chart ──┘
//! ```
//!
//! What cannot be carried over is said, each with its place: a [`Diagnostic`] of a code that begins with `import-`. What would mean something else
//! without saying so is not written.
//!
//! To read: [`sheet`] is what comes out; [`java`] and [`chart`] are the two ways in; [`names`], [`expr`] and [`condition`] are what both need.
//!
//! ```
//! use lapwing_diag::SourceMap;
//! use lapwing_import::{Format, Options, import};
//!
//! let text = "Init(Kicker k) {\n  event ready after(Kicker k): call(void Kicker.Ready()) && target(k) {}\n\
//!             \x20 event play before(Kicker k): call(void Kicker.Play()) && target(k) {}\n  ltl: [](play => <*> ready)\n}\n";
//! let mut sources = SourceMap::default();
//! let file = sources.add("Init.mop", text);
//! let imported = import(&sources, file, Format::JavaMop, Options::default());
//! assert!(imported.text.contains("property init: ltl([] (play => <*> ready))"));
//! ```

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod sheet;

mod java;

mod chart;
mod markdown;
mod mermaid;
mod scxml;
mod xml;

mod condition;
mod expr;
mod names;

use std::path::Path;

use lapwing_diag::{Code, Diagnostic, FileId, SourceMap, Span, has_errors};

use sheet::Sheet;

/// Longer texts are refused: no monitor and no diagram that a person has written is as long, in bytes.
const MOST_TEXT: usize = 1 << 20;

/// What is read.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Format {
    /// A file of JavaMOP: `.mop`.
    JavaMop,
    /// A state diagram of Mermaid: `.mmd`, `.mermaid`.
    Mermaid,
    /// The state diagrams of Mermaid in a page: `.md`, `.markdown`.
    Markdown,
    /// A state chart of the W3C: `.scxml`.
    Scxml,
}

impl Format {
    /// What a file is, by the end of its name.
    pub fn of(path: &Path) -> Option<Format> {
        Some(match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "mop" => Format::JavaMop,
            "mmd" | "mermaid" => Format::Mermaid,
            "md" | "markdown" => Format::Markdown,
            "scxml" => Format::Scxml,
            _ => return None,
        })
    }
}

/// What becomes of the parameters of a monitor of JavaMOP.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Parameters {
    /// One parameter is one object, as on a robot; several are told apart by `for each`, since what binds them together is the point.
    #[default]
    Auto,
    /// `for each` over the values of each.
    Each,
    /// There is one object of each.
    One,
}

/// How to import.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Options {
    /// What becomes of the parameters of a monitor.
    pub parameters: Parameters,
}

/// What was read.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Imported {
    /// The text of a `.rv`, as `lapwing fmt` lays it out. Empty where nothing could be carried over.
    pub text: String,
    /// What could not be carried over, or means something else. An error is something that was left out as a whole.
    pub diagnostics: Vec<Diagnostic>,
}

impl Imported {
    /// Whether a whole property or diagram was left out.
    pub fn lacks_something(&self) -> bool {
        has_errors(&self.diagnostics)
    }
}

/// Reads a file of `sources` and writes what it says as a specification. It never fails: what it cannot read is in the diagnostics.
pub fn import(sources: &SourceMap, file: FileId, format: Format, options: Options) -> Imported {
    let (name, text) = (sources.name(file), sources.text(file));
    let mut report = Report { file, diagnostics: Vec::new() };
    if text.len() > MOST_TEXT {
        let message = format!("the file has {} bytes; at most {MOST_TEXT} are read", text.len());
        report.push(Diagnostic::new(Code::ImportSyntax, report.span(0, 0), message));
        return Imported { text: String::new(), diagnostics: report.diagnostics };
    }
    let stem = Path::new(name).file_stem().map_or("imported".to_owned(), |s| s.to_string_lossy().into_owned());
    let mut sheet = Sheet::default();
    match format {
        Format::JavaMop => java::read(text, options, &mut sheet, &mut report),
        Format::Mermaid => mermaid::read(text, 0, &stem, &mut sheet, &mut report),
        Format::Markdown => markdown::read(text, &stem, &mut sheet, &mut report),
        Format::Scxml => scxml::read(text, &stem, &mut sheet, &mut report),
    }
    let text = if sheet.is_empty() { Ok(String::new()) } else { sheet.write(&file_name(name)) };
    let text = text.unwrap_or_else(|wrong| {
        let why = wrong.first().map_or("", |d| d.message.as_str());
        let message = format!("what was made of this file is no specification: {why}");
        report.push(Diagnostic::new(Code::ImportRefused, report.span(0, 0), message));
        String::new()
    });
    Imported { text, diagnostics: report.diagnostics }
}

/// The last part of a path.
fn file_name(path: &str) -> String {
    Path::new(path).file_name().map_or(path.to_owned(), |n| n.to_string_lossy().into_owned())
}

/// What was found, in one file.
struct Report {
    file: FileId,
    diagnostics: Vec<Diagnostic>,
}

/// More diagnostics than this are not kept: nobody reads them, and a hostile file has one for every byte.
const MOST_DIAGNOSTICS: usize = 200;

impl Report {
    fn push(&mut self, diagnostic: Diagnostic) {
        if self.diagnostics.len() < MOST_DIAGNOSTICS {
            self.diagnostics.push(diagnostic);
        }
    }

    /// A place in the file.
    fn span(&self, start: usize, end: usize) -> Span {
        Span::new(self.file, start, end)
    }
}
