//! `lapwing new`: a specification to start from.

use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::Path;

use lapwing::{Options, starter};

use crate::args::New;
use crate::complain::{Complaint, say};
use crate::exit::Exit;
use crate::words;

/// Runs the command. A file that is there already is not overwritten.
pub fn run(new: &New) -> Result<Exit, Complaint> {
    let text = match &new.trace {
        None => starter::blank(),
        Some(word) => {
            let trace = words::recording(word)?;
            let options = Options { recording: new.reading.options(), ..Options::default() };
            starter::of(&trace, &options).map_err(|e| Complaint::new(e.to_string()))?
        }
    };
    match &new.output {
        // Where nobody reads it there is nothing to be done.
        None => drop(io::stdout().write_all(text.as_bytes())),
        Some(path) => {
            write(path, &text)?;
            let trace = new.trace.as_deref().unwrap_or("RECORDING");
            say(&format!("wrote {}; edit it, then: lapwing check {} {trace}\n", path.display(), path.display()));
        }
    }
    Ok(Exit::Good)
}

fn write(path: &Path, text: &str) -> Result<(), Complaint> {
    let file = OpenOptions::new().write(true).create_new(true).open(path);
    let written = file.and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|e| match e.kind() {
        io::ErrorKind::AlreadyExists => {
            Complaint::new(format!("{}: there is such a file already, and it is not overwritten", path.display()))
        }
        _ => Complaint::new(format!("{}: {e}", path.display())),
    })
}
