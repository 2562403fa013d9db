//! Diagnostics as text, with source lines and carets.

use crate::{Diagnostic, FileId, Label, Severity, SourceMap, Span};
use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Patch, Renderer, Snippet};
use std::borrow::Cow;
use std::ops::Range;

/// Whether to use colour.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Style {
    /// No escape sequences.
    Plain,
    /// Colours for a terminal.
    Colour,
}

/// One diagnostic as text that ends in a newline: message, place, source lines, help, cure.
///
/// Places that lie outside their text, or in no text at all, are shown as well as can be; nothing makes it panic.
pub fn render(sources: &SourceMap, diagnostic: &Diagnostic, style: Style) -> String {
    let renderer = match style {
        Style::Plain => Renderer::plain(),
        Style::Colour => Renderer::styled(),
    };
    let mut report = vec![finding(sources, diagnostic)];
    report.extend(cure(sources, diagnostic));
    format!("{}\n", renderer.render(&report))
}

/// One diagnostic on one line, for editors and logs: `a.rv:3:7: error[unknown-name]: …`.
pub fn render_short(sources: &SourceMap, diagnostic: &Diagnostic) -> String {
    let span = diagnostic.primary.span;
    let (line, column) = sources.position(span);
    let severity = match diagnostic.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    };
    let (name, code) = (printable(sources.name(span.file)), diagnostic.code.name());
    format!("{name}:{line}:{column}: {severity}[{code}]: {}\n", printable(&diagnostic.message))
}

/// What is wrong, where, and the lines of advice.
fn finding<'a>(sources: &'a SourceMap, diagnostic: &'a Diagnostic) -> Group<'a> {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let mut group = Group::with_title(level.primary_title(printable(&diagnostic.message)).id(diagnostic.code.name()));
    for file in files(diagnostic) {
        group = group.element(snippet(sources, diagnostic, file));
    }
    for help in &diagnostic.help {
        group = group.element(Level::HELP.message(printable(help)));
    }
    group
}

/// The text that would cure it, where one is known.
fn cure<'a>(sources: &'a SourceMap, diagnostic: &'a Diagnostic) -> Option<Group<'a>> {
    let (span, replacement) = diagnostic.fix.as_ref()?;
    let window = Window::around(sources, span.file, std::iter::once(*span));
    let title = if replacement.is_empty() { "remove it" } else { "write" };
    let patch = Patch::new(window.place(*span), printable(replacement));
    let snippet =
        Snippet::source(window.text).line_start(window.first_line).path(name(sources, span.file)).patch(patch);
    Some(Group::with_title(Level::HELP.secondary_title(title)).element(snippet))
}

/// The files in which the diagnostic has places, that of the primary one first.
fn files(diagnostic: &Diagnostic) -> Vec<FileId> {
    let mut files = vec![diagnostic.primary.span.file];
    for label in &diagnostic.secondary {
        if !files.contains(&label.span.file) {
            files.push(label.span.file);
        }
    }
    files
}

/// The lines of one file that the diagnostic points at.
fn snippet<'a>(sources: &'a SourceMap, diagnostic: &'a Diagnostic, file: FileId) -> Snippet<'a, Annotation<'a>> {
    let labels = || std::iter::once(&diagnostic.primary).chain(&diagnostic.secondary).filter(|l| l.span.file == file);
    let window = Window::around(sources, file, labels().map(|label| label.span));
    let is_primary = |label: &Label| std::ptr::eq(label, &diagnostic.primary);
    let annotations = labels().map(|label| {
        let kind = if is_primary(label) { AnnotationKind::Primary } else { AnnotationKind::Context };
        let annotation = kind.span(window.place(label.span));
        if label.text.is_empty() { annotation } else { annotation.label(printable(&label.text)) }
    });
    Snippet::source(window.text).line_start(window.first_line).path(name(sources, file)).annotations(annotations)
}

fn name(sources: &SourceMap, file: FileId) -> Cow<'_, str> {
    printable(sources.name(file))
}

/// The part of a text that is shown: whole lines, so that a report costs as much as what it shows and not as the file.
struct Window<'a> {
    text: &'a str,
    first_line: usize,
    /// Where `text` begins in the file.
    start: usize,
}

impl<'a> Window<'a> {
    /// The lines from the first to the last place.
    fn around(sources: &'a SourceMap, file: FileId, spans: impl Iterator<Item = Span> + Clone) -> Window<'a> {
        let text = sources.text(file);
        let first = spans.clone().map(|s| s.start as usize).min().unwrap_or(0).min(text.len());
        let last = spans.map(|s| s.end.max(s.start) as usize).max().unwrap_or(0).min(text.len());
        let first_line = sources.line(file, first);
        let start = sources.line_start(file, first_line);
        let end = sources.line_start(file, sources.line(file, last) + 1);
        Window { text: text.get(start..end).unwrap_or(""), first_line, start }
    }

    /// Where a place lies in the window, moved to the beginnings of characters.
    fn place(&self, span: Span) -> Range<usize> {
        let inside = |byte: u32| (byte as usize).saturating_sub(self.start).min(self.text.len());
        let start = self.text.floor_char_boundary(inside(span.start));
        let end = self.text.ceil_char_boundary(inside(span.end));
        start..end.max(start)
    }
}

/// A text without signs that would disturb a terminal.
fn printable(text: &str) -> Cow<'_, str> {
    let disturbs = |c: char| c.is_control() && c != '\n';
    if !text.contains(disturbs) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| if disturbs(c) { c.escape_debug().to_string() } else { c.to_string() };
    Cow::Owned(text.chars().map(shown).collect())
}
