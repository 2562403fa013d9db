//! Imports for the tests: what comes out is always a specification that the checker takes and the formatter leaves alone.

#![allow(dead_code, reason = "every test file uses a part of it")]

use lapwing_diag::{Severity, SourceMap};
use lapwing_import::{Format, Options, Parameters, import};

/// What came out of a file.
pub struct Came {
    pub text: String,
    /// `code: "source text"`, each on a line.
    pub found: String,
}

/// Imports a text under that name.
pub fn imported(name: &str, text: &str) -> Came {
    imported_with(name, text, Parameters::Auto)
}

pub fn imported_with(name: &str, text: &str, parameters: Parameters) -> Came {
    let mut sources = SourceMap::default();
    let file = sources.add(name, text);
    let format = Format::of(name.as_ref()).expect("a known format");
    let came = import(&sources, file, format, Options { parameters });
    assert_eq!(came.text, lapwing_syntax::format(&came.text).expect("no errors"), "`lapwing fmt` changes it");
    let one = |d: &lapwing_diag::Diagnostic| format!("{}: {:?}\n", d.code.name(), sources.slice(d.primary.span));
    let found = came.diagnostics.iter().map(one).collect();
    Came { found, text: came.text }
}

impl Came {
    /// The text, which the checker has nothing against.
    pub fn sound(self) -> Came {
        match lapwing::Spec::parse("imported.rv", &self.text, &|_| None) {
            Ok(spec) => {
                let loud = spec.findings().diagnostics.iter().filter(|d| d.severity <= Severity::Warning);
                let said: Vec<&str> = loud.map(|d| d.message.as_str()).collect();
                assert!(said.is_empty(), "{said:?}\n{}", self.text);
            }
            Err(lapwing::SpecError::Wrong(findings)) => {
                panic!("{}\n{}", findings.render(lapwing_diag::Style::Plain), self.text)
            }
            Err(_) => panic!("unreadable"),
        }
        self
    }
}
