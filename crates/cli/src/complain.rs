//! What is wrong with the command line, said on stderr.

use std::io::Write;

use anstream::ColorChoice;
use lapwing_diag::Style;

/// Why a command cannot be carried out.
#[derive(Debug)]
pub struct Complaint {
    what: String,
    help: Vec<String>,
    /// Rendered already, with places of its own.
    rendered: bool,
}

impl Complaint {
    /// One sentence without a full stop.
    pub fn new(what: impl Into<String>) -> Complaint {
        Complaint { what: what.into(), help: Vec::new(), rendered: false }
    }

    /// Diagnostics that say everything themselves.
    pub fn rendered(text: String) -> Complaint {
        Complaint { what: text, help: Vec::new(), rendered: true }
    }

    /// One line of advice.
    pub fn help(mut self, help: impl Into<String>) -> Complaint {
        self.help.push(help.into());
        self
    }

    /// Says it.
    pub fn tell(&self) {
        say(&self.text());
    }

    /// What is to be said, line by line.
    pub fn text(&self) -> String {
        let mut text = match self.rendered {
            true => self.what.clone(),
            false => format!("error: {}\n", self.what),
        };
        text.extend(self.help.iter().map(|help| format!("  help: {help}\n")));
        text
    }
}

/// Says something on stderr. Where nobody listens there is nothing to be done about it.
pub fn say(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// Whether what goes to stdout, and what goes to stderr, is coloured.
pub fn styles(choice: clap::ColorChoice) -> (Style, Style) {
    let style = |automatic: ColorChoice| match (choice, automatic) {
        (clap::ColorChoice::Always, _) => Style::Colour,
        (clap::ColorChoice::Never, _) | (_, ColorChoice::Never) => Style::Plain,
        _ => Style::Colour,
    };
    let stdout = anstream::AutoStream::choice(&std::io::stdout());
    let stderr = anstream::AutoStream::choice(&std::io::stderr());
    (style(stdout), style(stderr))
}
