//! The literate tests of `suite/`, and the examples of the documents, in every home.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use xtask::suite::{cases, pages, run};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Runs the cases of these pages; `SUITE=word` runs only those whose file or heading has the word.
fn check(pages: &[PathBuf]) {
    let root = root();
    let only = std::env::var("SUITE").unwrap_or_default();
    let folder = tempfile::tempdir().expect("a folder to write traces to");
    let (mut wrong, mut count) = (Vec::new(), 0);
    for page in pages {
        let text = std::fs::read_to_string(page).expect("a page that can be read");
        let name = page.strip_prefix(&root).unwrap_or(page).to_string_lossy().into_owned();
        for case in cases(&name, &text) {
            if !case.heading.contains(&only) && !name.contains(&only) {
                continue;
            }
            count += 1;
            wrong.extend(run(&case, folder.path()));
        }
    }
    assert!(count > 0 || !only.is_empty(), "no cases at all");
    assert!(wrong.is_empty(), "{} of {count} cases are not as written:\n\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn the_suite_says_what_is_written() {
    check(&pages(&root().join("suite")));
}

#[test]
fn the_examples_of_the_documents_say_what_is_written() {
    let mut all = pages(&root().join("docs"));
    all.push(root().join("README.md"));
    check(&all);
}

#[test]
fn every_case_has_a_name_of_its_own() {
    let mut seen = BTreeSet::new();
    for page in pages(&root().join("suite")) {
        let text = std::fs::read_to_string(&page).expect("a page that can be read");
        for case in cases(&page.to_string_lossy(), &text) {
            assert!(
                seen.insert(case.heading.clone()),
                "{}:{}: `{}` is there twice",
                case.file,
                case.line,
                case.heading
            );
            let expects = case.parts.iter().any(|p| p.info == "verdicts" || p.info == "errors");
            assert!(expects, "{}:{}: `{}` expects nothing", case.file, case.line, case.heading);
        }
    }
}
