//! Colours, where they are wanted.

use anstyle::{AnsiColor, Style as Ansi};
use lapwing_diag::Style;
use lapwing_stream::Verdict;

/// Whether and how to colour.
#[derive(Clone, Copy)]
pub(crate) struct Paint(pub Style);

impl Paint {
    /// What went wrong.
    pub fn alarm(self, text: &str) -> String {
        self.with(Ansi::new().bold().fg_color(Some(AnsiColor::Red.into())), text)
    }

    /// What may be wrong.
    pub fn doubt(self, text: &str) -> String {
        self.with(Ansi::new().fg_color(Some(AnsiColor::Yellow.into())), text)
    }

    /// What begins a part.
    pub fn heading(self, text: &str) -> String {
        self.with(Ansi::new().bold(), text)
    }

    /// Something in the colour of a verdict.
    pub fn verdict(self, verdict: Verdict, text: &str) -> String {
        match verdict {
            Verdict::Violated | Verdict::Unmet => self.alarm(text),
            Verdict::Inconclusive => self.doubt(text),
            Verdict::Holds | Verdict::Satisfied => self.with(Ansi::new().fg_color(Some(AnsiColor::Green.into())), text),
        }
    }

    fn with(self, ansi: Ansi, text: &str) -> String {
        match self.0 {
            Style::Plain => text.to_owned(),
            Style::Colour => format!("{ansi}{text}{ansi:#}"),
        }
    }
}
