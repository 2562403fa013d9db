//! The examples on the pages of the codes show what they say they show.

use lapwing_diag::Code;
use lapwing_syntax::{FileId, parse};

/// The codes that the lexer and the parser report.
const OURS: &[Code] = &[
    Code::Syntax,
    Code::UnclosedBracket,
    Code::UnknownWord,
    Code::ReservedWord,
    Code::MissingComma,
    Code::ForeignOperator,
    Code::LtlNotation,
    Code::SingleEquals,
    Code::ChainedComparison,
    Code::BareMargin,
    Code::BareDuration,
    Code::DurationRange,
    Code::BoundNotAllowed,
    Code::BadNumber,
    Code::UnknownUnit,
    Code::BadText,
    Code::BadName,
    Code::BadSetting,
    Code::StrayCharacter,
];

#[test]
fn the_first_example_of_a_page_has_the_fault() {
    for code in OURS {
        let example = code.page().split("```\n").nth(1).unwrap_or("");
        let found: Vec<Code> = parse(FileId(0), example).diagnostics.iter().map(|d| d.code).collect();
        assert!(!found.is_empty() && found.iter().all(|c| c == code), "{}: {found:?}\n{example}", code.name());
        assert!(example.contains("machine") || found.len() >= example.lines().count(), "{}: {found:?}", code.name());
    }
}
