//! The index: all recordings, what came of each, and a column for each property.

use lapwing_react::shown::{Origin, count};
use lapwing_react::{Property, Report, Standing};

use crate::html::{name, text};
use crate::property::{key, sign};
use crate::run::{Entry, headline, standing};

/// With more properties than this a row has no cell for each.
const COLUMNS: usize = 16;

/// What came of a recording, as cells of its row.
pub(crate) fn result(report: &Report) -> String {
    let origin = Origin::of(report);
    let first = report.properties.iter().flat_map(|p| p.violations.first()).map(|v| v.failed).min();
    let margin = report.properties.iter().filter_map(|p| p.margin).filter(|m| m.is_finite()).reduce(f64::min);
    format!(
        "<td class=\"{}\">{}</td><td>{}</td><td>{}</td>",
        standing(report.standing()),
        headline(report),
        first.map_or_else(|| "-".to_owned(), |t| origin.time(t)),
        margin.map_or_else(|| "-".to_owned(), |m| text(&lapwing_react::shown::cell(&m.into()))),
    )
}

/// A cell for each property: a sign, and the word for it.
pub(crate) fn marks(report: &Report) -> String {
    let mark = |p: &Property| {
        let (sign, word) = sign(p);
        format!(
            "<td class=\"mark {}\" title=\"{}\"><span role=\"img\" aria-label=\"{word}\">{sign}</span></td>",
            key(p),
            text(&p.name)
        )
    };
    report.properties.iter().map(mark).collect()
}

/// The table of all recordings.
pub(crate) fn table(entries: &[Entry]) -> String {
    let failed = entries.iter().filter(|e| e.standing == Standing::Failed).count();
    let open = entries.iter().filter(|e| e.standing == Standing::Open).count();
    let (class, headline) = match (failed, open) {
        (0, 0) => ("good", format!("All {} are well", count(entries.len() as u64, "recording", "recordings"))),
        (0, open) => ("open", format!("{open} of {} recordings could not be judged", entries.len())),
        (failed, 0) => ("failed", format!("{failed} of {} recordings failed", entries.len())),
        (failed, open) => {
            ("failed", format!("{failed} of {} recordings failed, {open} could not be judged", entries.len()))
        }
    };
    let names = shared_names(entries);
    let columns: String =
        names.iter().map(|n| format!("<th scope=\"col\" class=\"tilted\"><span>{}</span></th>", name(n))).collect();
    let row = |(number, entry): (usize, &Entry)| {
        format!(
            "<tr data-standing=\"{}\"><th scope=\"row\"><button type=\"button\" class=\"open-run\" data-run=\"{number}\">{}</button></th>\
             {}{}</tr>\n",
            standing(entry.standing),
            name(&entry.trace),
            entry.result,
            if names.is_empty() { "" } else { &entry.marks },
        )
    };
    let rows: String = entries.iter().enumerate().map(row).collect();
    format!(
        "<section class=\"index\">\n<header class=\"verdict {class}\"><h1>{headline}</h1></header>\n\
         <label class=\"filter\"><input type=\"checkbox\"> only those that are not well</label>\n\
         <div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\">recording</th><th scope=\"col\">result</th>\
         <th scope=\"col\">first failure</th><th scope=\"col\">worst margin</th>{columns}</tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n</section>\n"
    )
}

/// The names of the properties, where all recordings have the same few.
fn shared_names(entries: &[Entry]) -> &[String] {
    match entries.first() {
        Some(first) if (1..=COLUMNS).contains(&first.names.len()) && entries.iter().all(|e| e.names == first.names) => {
            &first.names
        }
        _ => &[],
    }
}
