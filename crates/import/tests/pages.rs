//! The example on each page of a code has what the page is about; the examples of the document come out as they stand there.

mod common;

use common::imported;
use lapwing_diag::Code;

/// The fences of a page: what they are, what is in them.
fn fences(page: &str) -> Vec<(&str, String)> {
    let mut found = Vec::new();
    let mut open: Option<(&str, String)> = None;
    for line in page.lines() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(info)) => open = Some((info, String::new())),
            (Some(_), Some("")) => found.extend(open.take()),
            (Some((_, text)), _) => *text += &format!("{line}\n"),
            (None, None) => {}
        }
    }
    found
}

/// The name of a file of that kind.
fn file(info: &str) -> Option<&'static str> {
    Some(match info {
        "javamop" => "robot.mop",
        "mermaid" => "robot.mmd",
        "scxml" => "robot.scxml",
        _ => return None,
    })
}

#[test]
fn the_examples_of_the_codes_have_the_fault() {
    let ours: Vec<&Code> = Code::ALL.iter().filter(|c| c.name().starts_with("import-")).collect();
    assert_eq!(ours.len(), 9);
    for code in ours {
        let fences = fences(code.page());
        let (name, text) = fences.iter().find_map(|(info, text)| Some((file(info)?, text))).expect("an example");
        let found = imported(name, text).found;
        assert!(found.lines().any(|l| l.starts_with(&format!("{}:", code.name()))), "{}: {found}", code.name());
    }
}

#[test]
fn the_document_says_what_comes_out() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/import.md");
    let page = std::fs::read_to_string(path).unwrap();
    let fences = fences(&page);
    let pairs: Vec<_> = fences.windows(2).filter(|w| file(w[0].0).is_some() && w[1].0 == "rv").collect();
    assert!(pairs.len() >= 4, "{} examples", pairs.len());
    let mut blessed = page.clone();
    for pair in pairs {
        let came = imported(file(pair[0].0).unwrap(), &pair[0].1).sound();
        let text = came.text.split_once("\n\n").map_or("", |(_, rest)| rest);
        if std::env::var_os("BLESS").is_some() {
            blessed = blessed.replacen(&format!("```rv\n{}```", pair[1].1), &format!("```rv\n{text}```"), 1);
        } else {
            assert_eq!(
                text, pair[1].1,
                "docs/import.md is out of date: BLESS=1 cargo test -p lapwing-import --test pages"
            );
        }
    }
    if blessed != page {
        std::fs::write(path, blessed).unwrap();
    }
}
