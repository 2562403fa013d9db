//! `lapwing fmt`: specifications in their canonical layout.

use std::fs;
use std::io::{self, Read, Write};
use std::path::Path;

use lapwing::Findings;
use lapwing_diag::{SourceMap, Style, read_text, text};

use crate::args::Fmt;
use crate::complain::{Complaint, say, styles};
use crate::exit::Exit;

/// Runs the command. A specification that cannot be read is left alone, and the others are formatted all the same.
pub fn run(fmt: &Fmt) -> Result<Exit, Complaint> {
    let (_, style) = styles(clap::ColorChoice::Auto);
    let mut exit = Exit::Good;
    for spec in &fmt.specs {
        let one = if spec == "-" { standard(fmt.check, style) } else { file(Path::new(spec), fmt.check, style) };
        match one {
            Ok(true) if fmt.check && exit == Exit::Good => exit = Exit::Failed,
            Ok(_) => {}
            Err(complaint) => {
                complaint.tell();
                exit = Exit::Wrong;
            }
        }
    }
    Ok(exit)
}

/// Formats a file in place. Gives whether it was not as it should be.
fn file(path: &Path, only_check: bool, style: Style) -> Result<bool, Complaint> {
    let wrong = |e: io::Error| Complaint::new(format!("{}: {e}", path.display()));
    let text = read_text(path).map_err(wrong)?;
    let formatted = formatted(&path.to_string_lossy(), &text, style)?;
    let differs = formatted != text;
    match (differs, only_check) {
        (true, true) => say(&format!("{}: not formatted\n", path.display())),
        (true, false) => fs::write(path, formatted).map_err(wrong)?,
        (false, _) => {}
    }
    Ok(differs)
}

/// Formats standard input to standard output.
fn standard(only_check: bool, style: Style) -> Result<bool, Complaint> {
    let mut bytes = Vec::new();
    let read = io::stdin().read_to_end(&mut bytes).and_then(|_| text(bytes));
    let text = read.map_err(|e| Complaint::new(format!("standard input: {e}")))?;
    let formatted = formatted("-", &text, style)?;
    let differs = formatted != text;
    match only_check {
        true if differs => say("standard input: not formatted\n"),
        true => {}
        // Where nobody reads it there is nothing to be done.
        false => drop(io::stdout().write_all(formatted.as_bytes())),
    }
    Ok(differs)
}

fn formatted(name: &str, text: &str, style: Style) -> Result<String, Complaint> {
    lapwing_syntax::format(text).map_err(|diagnostics| {
        let mut sources = SourceMap::default();
        sources.add(name, text);
        Complaint::rendered(Findings { sources, diagnostics }.render(style))
    })
}
