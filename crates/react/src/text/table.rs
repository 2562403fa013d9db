//! Tables of values over time.

use crate::report::{Reading, Row};
use crate::shown::{Origin, cell};

/// The widest that a column may be; what is longer is cut.
const WIDEST: usize = 40;

/// Rows under the names of their columns, right-aligned; empty where there is nothing to show.
pub(crate) fn table(names: &[Reading], rows: &[Row], origin: Origin) -> String {
    if names.is_empty() || rows.is_empty() {
        return String::new();
    }
    let head = std::iter::once("time".to_owned()).chain(names.iter().map(|n| n.name.replace('\n', " ")));
    let body =
        rows.iter().map(|row| std::iter::once(origin.time(row.time)).chain(row.values.iter().map(cell)).collect());
    let lines: Vec<Vec<String>> = std::iter::once(head.collect()).chain(body).map(cut).collect();
    let columns = names.len() + 1;
    let widths: Vec<usize> =
        (0..columns).map(|c| lines.iter().filter_map(|l| Some(l.get(c)?.chars().count())).max().unwrap_or(0)).collect();
    lines.iter().map(|line| aligned(line, &widths)).collect()
}

fn cut(line: Vec<String>) -> Vec<String> {
    let short = |text: String| match text.chars().count() > WIDEST {
        true => text.chars().take(WIDEST - 1).chain(['…']).collect(),
        false => text,
    };
    line.into_iter().map(short).collect()
}

fn aligned(line: &[String], widths: &[usize]) -> String {
    let cells = line.iter().zip(widths).map(|(text, width)| format!("  {text:>width$}"));
    cells.collect::<String>() + "\n"
}
