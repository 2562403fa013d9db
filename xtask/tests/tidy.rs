//! The rules of the repository, as tests.

use std::path::{Path, PathBuf};

use xtask::{generated, tidy};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the root of the repository")
}

fn none(wrong: &[String]) {
    assert!(wrong.is_empty(), "{} times:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn crates_know_only_what_is_above_them() {
    none(&tidy::layers(&tidy::files(&root())));
}

#[test]
fn every_module_says_what_it_is_for() {
    none(&tidy::silent_modules(&tidy::files(&root())));
}

#[test]
fn no_file_is_too_long() {
    none(&tidy::long_files(&tidy::files(&root())));
}

#[test]
fn nothing_is_left_unfinished() {
    none(&tidy::unfinished(&tidy::files(&root())));
}

#[test]
fn the_project_speaks_of_itself_alone() {
    none(&tidy::foreign(&tidy::files(&root())));
}

#[test]
fn code_that_may_panic_only_gets_less() {
    let found = tidy::panics(&tidy::files(&root()));
    assert!(found.len() <= tidy::PANICS, "{} places, {} are allowed:\n{}", found.len(), tidy::PANICS, found.join("\n"));
    assert!(found.len() == tidy::PANICS, "only {} places are left: lower `PANICS` in xtask/src/tidy.rs", found.len());
}

#[test]
fn the_engine_has_no_clock_and_no_environment() {
    none(&tidy::impure_engine(&tidy::files(&root())));
}

#[test]
fn the_simulator_gives_the_same_bits_everywhere() {
    none(&tidy::inexact_simulator(&tidy::files(&root())));
}

#[test]
fn every_code_has_a_page_and_a_test() {
    none(&tidy::codes(&tidy::files(&root())));
}

#[test]
fn the_list_of_codes_is_up_to_date() {
    let page = root().join("docs/errors.md");
    generated::holds(&page, &tidy::errors_page(), "tidy").unwrap_or_else(|e| panic!("{e}"));
}

#[test]
fn links_lead_somewhere() {
    none(&tidy::dead_links(&root(), &tidy::files(&root())));
}
