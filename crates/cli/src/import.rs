//! `lapwing import`: specifications from elsewhere.

use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Args, ColorChoice, ValueEnum};
use lapwing::Findings;
use lapwing_diag::SourceMap;
use lapwing_import::{Format, Options, import};

use crate::complain::{Complaint, say, styles};
use crate::exit::Exit;

/// Arguments of `import`.
#[derive(Debug, Args)]
#[command(after_help = "\
A monitor of JavaMOP becomes events, a property for each formula, and a reaction for each handler; a state diagram becomes a machine.
What cannot be carried over, or means something else, is said on standard error with its place.

  lapwing import Init.mop -o init.rv
  lapwing import door.scxml > door.rv
  lapwing explain robot.rv --format mermaid > robot.mmd; lapwing import robot.mmd

Exit codes: 0 written, though perhaps with warnings; 2 nothing could be carried over, and nothing is written; 3 written, but a whole
property or diagram was left out.")]
pub struct Import {
    /// A file of JavaMOP (.mop), Mermaid (.mmd, .mermaid, or .md with fences) or SCXML (.scxml)
    pub file: PathBuf,
    /// The file to write; standard output without it
    #[arg(short, long, value_name = "OUT.rv")]
    pub output: Option<PathBuf>,
    /// What becomes of the parameters of JavaMOP's monitors
    #[arg(long, value_name = "HOW", default_value = "auto")]
    pub parameters: Parameters,
    /// Whether to colour
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub color: ColorChoice,
}

/// What becomes of parameters.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Parameters {
    /// One parameter is one object; several become `for each`
    Auto,
    /// Each becomes a `for each` over a field of its name
    Each,
    /// There is one object of each
    One,
}

impl From<Parameters> for lapwing_import::Parameters {
    fn from(parameters: Parameters) -> lapwing_import::Parameters {
        match parameters {
            Parameters::Auto => lapwing_import::Parameters::Auto,
            Parameters::Each => lapwing_import::Parameters::Each,
            Parameters::One => lapwing_import::Parameters::One,
        }
    }
}

/// Runs the command.
pub fn run(arguments: &Import) -> Result<Exit, Complaint> {
    let path = &arguments.file;
    let name = path.display().to_string();
    let format = Format::of(path).ok_or_else(|| {
        let help = "its name ends in .mop (JavaMOP), .mmd, .mermaid or .md (Mermaid), or .scxml";
        Complaint::new(format!("{name} is nothing that can be imported, by its name")).help(help)
    })?;
    let bytes = fs::read(path).map_err(|e| Complaint::new(format!("{name} cannot be read: {e}")))?;
    let mut sources = SourceMap::default();
    let file = sources.add(name.clone(), String::from_utf8_lossy(&bytes));
    let imported = import(&sources, file, format, Options { parameters: arguments.parameters.into() });
    let (_, style) = styles(arguments.color);
    let lacks_something = imported.lacks_something();
    say(&Findings { sources, diagnostics: imported.diagnostics }.render(style));
    if imported.text.is_empty() {
        return Err(Complaint::new(format!("nothing of {name} could be carried over")));
    }
    match &arguments.output {
        Some(output) => fs::write(output, imported.text)
            .map_err(|e| Complaint::new(format!("{} cannot be written: {e}", output.display())))?,
        // Where nobody reads it there is nothing to be done.
        None => drop(io::stdout().write_all(imported.text.as_bytes())),
    }
    Ok(if lacks_something { Exit::Open } else { Exit::Good })
}
