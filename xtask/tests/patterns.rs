//! Every shipped pattern is described, and has its cases.

use std::path::{Path, PathBuf};

use lapwing_check::{LIBRARIES, Library};
use xtask::generated;
use xtask::patterns::page;
use xtask::suite::pages;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[test]
fn the_page_of_patterns_is_up_to_date() {
    generated::holds(&root().join("docs/patterns.md"), &page(), "patterns").unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn every_pattern_is_described() {
    for pattern in LIBRARIES.iter().flat_map(Library::patterns) {
        assert!(pattern.words.concat().len() > 8, "{} has nothing said of it", pattern.name);
        assert!(!pattern.body.is_empty() && !pattern.call.is_empty(), "{}", pattern.name);
        if pattern.section.is_empty() {
            let listed: String = pattern.words.iter().copied().filter(|line| line.starts_with("- `")).collect();
            let parameters = pattern.call.split(['(', ')']).nth(1).unwrap_or_default().split(", ");
            for parameter in parameters {
                assert!(listed.contains(&format!("`{parameter}`")), "{}: nothing is said of {parameter}", pattern.name);
            }
        }
    }
}

#[test]
fn every_pattern_has_a_case() {
    let text: String =
        pages(&root().join("suite/std")).iter().filter_map(|page| std::fs::read_to_string(page).ok()).collect();
    for pattern in LIBRARIES.iter().flat_map(Library::patterns) {
        let uses = text.matches(&format!(": {}(", pattern.name)).count();
        assert!(uses > 0, "no case of suite/std uses {}", pattern.name);
    }
}
