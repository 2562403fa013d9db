//! GenoM3 specifications of any bytes.

use std::collections::BTreeMap;
use std::path::PathBuf;

use lapwing_diag::{Style, render};
use lapwing_genom::automata::{Settings, build};
use lapwing_genom::emit::{Input, bip, uppaal};
use lapwing_genom::{Options, graph, load};

/// A specification, which may include itself: what is wrong with it can be shown, and what is right is written in every way, and read back.
pub(super) fn gen_file(data: &[u8]) {
    let text = String::from_utf8_lossy(data).into_owned();
    let files = BTreeMap::from([(PathBuf::from("a.gen"), text)]);
    let Ok(loaded) = load(&files, &[PathBuf::from("a.gen")], &Options::default()) else { panic!("the file is there") };
    for diagnostic in &loaded.diagnostics {
        assert!(!render(&loaded.sources, diagnostic, Style::Plain).is_empty());
    }
    assert!(graph::graphs(&loaded.model).len() > loaded.model.components.len());
    let Ok(system) = build(&loaded.model, Settings { instances: 1, ..Settings::default() }) else { return };
    let locations: usize = system.automata.iter().map(|a| a.locations.len()).sum();
    if loaded.has_errors() || system.automata.is_empty() || locations > 400 {
        return;
    }
    let input = Input { system: &system, sources: &loaded.sources };
    assert!(uppaal(input).ends_with("</nta>\n"));
    let text = lapwing_bip::print(&bip(input));
    let parsed = lapwing_bip::parse(lapwing_bip::FileId(0), &text);
    assert!(parsed.diagnostics.is_empty(), "{:?}\n{text}", parsed.diagnostics);
    let checked = lapwing_bip::check(&parsed.package, &[]);
    assert!(checked.diagnostics.is_empty(), "{:?}\n{text}", checked.diagnostics);
}
