//! The example on the page of each code has the fault that the page explains.

mod support;

use lapwing_diag::{Code, Severity};
use support::shapes::{csv, robot};
use support::{against, alone};

/// Codes that are found while a monitor runs or when one is generated, or whose example is a trace.
const ELSEWHERE: &[Code] = &[
    Code::LatchedAfter,
    Code::SamplingUnseen,
    Code::AssumedFlat,
    Code::LibraryProperty,
    Code::TooLarge,
    Code::NotGenerated,
];

/// The first example on a page.
fn example(page: &str) -> &str {
    page.split("```\n").nth(1).unwrap_or("")
}

#[test]
fn examples_have_the_fault() {
    let ours = Code::ALL.iter().skip_while(|c| **c != Code::UnknownName).take_while(|c| **c <= Code::AssumedFlat);
    for code in ours.filter(|c| !ELSEWHERE.contains(c)) {
        let text = example(code.page());
        let found = [alone(text), against(text, &robot()), against(text, &csv(&["x"]))]
            .iter()
            .any(|spec| spec.checked.diagnostics.iter().any(|d| d.code == *code));
        assert!(found, "{}:\n{text}{}", code.name(), against(text, &robot()).messages());
        assert!(code.severity() != Severity::Note);
    }
}
