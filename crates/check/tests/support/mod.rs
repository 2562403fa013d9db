//! What the tests of this crate share: specifications from text, shapes of traces, and checked specifications as short texts.

#![allow(dead_code)]

pub mod dump;
pub mod examples;
pub mod shapes;

use lapwing_check::{Checked, TraceShape, check, load};
use lapwing_diag::{Diagnostic, SourceMap};

/// A specification that has been read and checked.
pub struct Spec {
    pub sources: SourceMap,
    pub parse: Vec<Diagnostic>,
    pub checked: Checked,
}

/// Checks a text; files that it uses come from `files`.
pub fn check_with(text: &str, trace: Option<&TraceShape>, files: &[(&str, &str)]) -> Spec {
    let mut sources = SourceMap::default();
    let file = sources.add("test.rv", text);
    let parsed = lapwing_syntax::parse(file, text);
    let resolve = |path: &str| files.iter().find(|(name, _)| *name == path).map(|(_, text)| (*text).to_owned());
    let mut loaded = load(&mut sources, parsed.file, &resolve);
    loaded.define(&shapes::Common);
    let checked = check(&sources, &loaded, trace);
    Spec { sources, parse: parsed.diagnostics, checked }
}

/// Checks a text without a trace.
pub fn alone(text: &str) -> Spec {
    check_with(text, None, &[])
}

/// Checks a text against a trace.
pub fn against(text: &str, trace: &TraceShape) -> Spec {
    check_with(text, Some(trace), &[])
}

/// The diagnostics of a text without a trace are these.
pub fn faults(text: &str, expected: expect_test::Expect) {
    expected.assert_eq(&alone(text).codes());
}

/// A text without a trace has no diagnostics.
pub fn clean(text: &str) {
    let spec = alone(text);
    assert_eq!(spec.messages(), "", "{text}");
}

/// What the diagnostics say, with what stands beside the carets and the help.
pub fn said(spec: &Spec) -> String {
    let diagnostics = spec.checked.diagnostics.iter();
    let help = |d: &Diagnostic| d.help.iter().map(|h| format!("  {h}\n")).collect::<String>();
    diagnostics.map(|d| format!("{}\n  {}\n{}", d.message, d.primary.text, help(d))).collect()
}

impl Spec {
    /// Every diagnostic as `code: text under the carets`, one a line.
    pub fn codes(&self) -> String {
        let line =
            |d: &Diagnostic| format!("{}: {}\n", d.code.name(), self.sources.slice(d.primary.span).replace('\n', "⏎"));
        self.parse.iter().chain(&self.checked.diagnostics).map(line).collect()
    }

    /// Every diagnostic as `code: message`, one a line.
    pub fn messages(&self) -> String {
        let line = |d: &Diagnostic| format!("{}: {}\n", d.code.name(), d.message);
        self.parse.iter().chain(&self.checked.diagnostics).map(line).collect()
    }

    /// The problems of properties, one a line.
    pub fn problems(&self) -> String {
        let properties = self.checked.spec.properties.iter();
        properties.filter_map(|p| Some(format!("{}: {}\n", p.name, p.problem.as_ref()?))).collect()
    }
}
