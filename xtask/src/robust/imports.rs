//! Files from elsewhere, of any bytes.

use lapwing_diag::{SourceMap, Style, render};
use lapwing_import::{Format, Options, Parameters, import as read};

/// A byte for the format and for what becomes of parameters, then a file: what is wrong with it can be shown, and what comes out is a specification as
/// `lapwing fmt` would lay it out.
pub(super) fn import(data: &[u8]) {
    let Some((&choice, rest)) = data.split_first() else { return };
    let text = String::from_utf8_lossy(rest).into_owned();
    let format = [Format::JavaMop, Format::Mermaid, Format::Markdown, Format::Scxml][usize::from(choice % 4)];
    let parameters = [Parameters::Auto, Parameters::Each, Parameters::One][usize::from(choice / 4 % 3)];
    let mut sources = SourceMap::default();
    let file = sources.add("a.in", text);
    let imported = read(&sources, file, format, Options { parameters });
    for diagnostic in &imported.diagnostics {
        assert!(!render(&sources, diagnostic, Style::Plain).is_empty());
        assert!(diagnostic.code.name().starts_with("import-"));
    }
    assert!(!imported.text.is_empty() || !imported.diagnostics.is_empty(), "nothing comes of it, and nobody says why");
    if !imported.text.is_empty() {
        let again = lapwing_syntax::format(&imported.text).expect("what comes out is a specification");
        assert_eq!(again, imported.text);
    }
}
