//! The formats of reports, and how reports make a document.

use lapwing_diag::Style;

use crate::report::Report;
use crate::tally::Tally;
use crate::{json, junit, text};

/// A format of reports.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Format {
    /// For people.
    #[default]
    Text,
    /// An array with an object for each recording.
    Json,
    /// One object per line as things happen: [`line`](crate::line), not [`render`].
    Ndjson,
    /// JUnit's XML: a suite for each recording, a case for each property.
    Junit,
}

impl Format {
    /// What the document begins with.
    pub fn begin(self) -> &'static str {
        match self {
            Format::Text | Format::Ndjson => "",
            Format::Json => "[",
            Format::Junit => "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"lapwing\">\n",
        }
    }

    /// What stands between two reports.
    pub fn between(self) -> &'static str {
        match self {
            Format::Text => "\n",
            Format::Json => ",\n",
            Format::Ndjson | Format::Junit => "",
        }
    }
}

/// A report as a part of the document. Of [`Format::Ndjson`] the lines are told as things happen, and nothing is left to say.
pub fn render(report: &Report, format: Format, style: Style) -> String {
    match format {
        Format::Text => text::report(report, style),
        Format::Json => json::report(report).to_string(),
        Format::Ndjson => String::new(),
        Format::Junit => junit::suite(report),
    }
}

/// What the document ends with.
pub fn end(tally: &Tally, format: Format, style: Style) -> String {
    match format {
        Format::Text => text::summary(tally, style),
        Format::Json => "]\n".to_owned(),
        Format::Ndjson => String::new(),
        Format::Junit => "</testsuites>\n".to_owned(),
    }
}
