//! `lapwing explain std.robot`: the shipped patterns.

use std::fmt::Write as _;

use lapwing::{LIBRARIES, Library, ShippedPattern};

use crate::complain::Complaint;
use lapwing_diag::suggest::nearest;

/// What a library offers (`std.robot`), or what one of its patterns means (`std.robot.tracks`).
pub fn page(name: &str) -> Result<String, Complaint> {
    let mut parts = name.splitn(3, '.').skip(1);
    let library = parts.next().and_then(|of| LIBRARIES.iter().find(|l| l.name.strip_prefix("std.") == Some(of)));
    let Some(library) = library else {
        let names: Vec<&str> = LIBRARIES.iter().map(|l| l.name).collect();
        return Err(missing(format!("there is no pattern library `{name}`"), name, &names));
    };
    let Some(wanted) = parts.next() else { return Ok(overview(library)) };
    let patterns = library.patterns();
    let names: Vec<&str> = patterns.iter().map(|p| p.name).collect();
    let found = patterns.iter().find(|p| p.name == wanted);
    found.map(chapter).ok_or_else(|| missing(format!("{} has no pattern `{wanted}`", library.name), wanted, &names))
}

fn missing(what: String, name: &str, names: &[&str]) -> Complaint {
    Complaint::new(what).help(match nearest(name, names.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("there is {}", names.join(", ")),
    })
}

/// The patterns with the first sentence of each.
fn overview(library: &Library) -> String {
    let mut out = format!("{}\n\n{}\n", library.name, library.preface().join("\n"));
    let mut section = "";
    for pattern in library.patterns() {
        if pattern.section != section {
            section = pattern.section;
            let _ = write!(out, "\n{section}\n");
        }
        let words = pattern.words.join(" ");
        let sentence = words.split_once(". ").map_or(&*words, |(first, _)| first);
        let _ = write!(out, "\n  {}\n      {}\n", pattern.call, sentence.trim_end_matches('.'));
    }
    let _ = write!(
        out,
        "\n`use {0}` in a specification brings them in; `lapwing explain {0}.NAME` says more of one.\n",
        library.name
    );
    out
}

fn chapter(pattern: &ShippedPattern) -> String {
    let mut out = format!("{}\n\n{}\n", pattern.call, pattern.words.join("\n"));
    if let Some(formula) = pattern.formula {
        let _ = write!(out, "\nAs a formula: {formula}\n");
    }
    if let Some(example) = pattern.example {
        let _ = write!(out, "\nFor example: {example}\n");
    }
    let _ = write!(out, "\nIt stands for:\n    {}\n", pattern.body.join("\n    "));
    out
}
