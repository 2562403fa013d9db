//! Tables of values over time.

use lapwing_stream::{Time, Value};

use crate::report::{Role, Violation};
use crate::shown::{Origin, cell};

/// The widest that a column may be; what is longer is cut.
const WIDEST: usize = 40;

/// The most columns: what comes later in the text of the property is left out.
const COLUMNS: usize = 8;

/// What led to a failure: a row for each of the moments that were noted and one for the failure, under the names of the values,
/// right-aligned. Empty where there is nothing to show.
pub(crate) fn table(violation: &Violation, origin: Origin) -> String {
    let values = violation.values.as_deref().unwrap_or_default();
    let tabled = values.iter().enumerate().filter(|(_, r)| r.role == Role::Value);
    let columns: Vec<usize> = tabled.map(|(column, _)| column).take(COLUMNS).collect();
    if columns.is_empty() || violation.history.is_empty() {
        return String::new();
    }
    let head = Line::new("time".to_owned(), columns.iter().map(|c| values[*c].name.replace('\n', " ")), "");
    let row = |time: Time, values: &[Value]| {
        let cells = columns.iter().map(|c| values.get(*c).map_or_else(String::new, cell));
        Line::new(origin.time(time), cells, mark(violation, time))
    };
    let before = violation.history.iter().filter(|r| r.time < violation.failed).map(|r| row(r.time, &r.values));
    let failing: Vec<Value> = values.iter().map(|r| r.value.clone()).collect();
    let lines: Vec<Line> = std::iter::once(head).chain(before).chain([row(violation.failed, &failing)]).collect();
    let width = |column: usize| lines.iter().filter_map(|l| Some(l.cells.get(column)?.chars().count())).max();
    let widths: Vec<usize> = (0..=columns.len()).map(|c| width(c).unwrap_or(0)).collect();
    lines.iter().map(|line| line.aligned(&widths)).collect()
}

/// What happened at that time.
fn mark(violation: &Violation, time: Time) -> &'static str {
    match () {
        () if time == violation.failed => "failed",
        () if time == violation.began => "began",
        () => "",
    }
}

struct Line {
    cells: Vec<String>,
    mark: &'static str,
}

impl Line {
    fn new(time: String, cells: impl Iterator<Item = String>, mark: &'static str) -> Line {
        Line { cells: std::iter::once(time).chain(cells).map(short).collect(), mark }
    }

    fn aligned(&self, widths: &[usize]) -> String {
        let cells = self.cells.iter().zip(widths).map(|(text, width)| format!("  {text:>width$}"));
        let mark = if self.mark.is_empty() { String::new() } else { format!("  {}", self.mark) };
        cells.collect::<String>() + &mark + "\n"
    }
}

fn short(text: String) -> String {
    match text.chars().count() > WIDEST {
        true => text.chars().take(WIDEST - 1).chain(['…']).collect(),
        false => text,
    }
}
