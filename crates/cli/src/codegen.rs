//! `lapwing codegen`: monitors as source text, for machines that have no room for Lapwing.

use std::io::{self, Write as _};
use std::path::PathBuf;

use clap::{Args, ColorChoice, ValueEnum};
use lapwing_codegen::{Generated, Language, Options, generate};
use lapwing_diag::render;

use crate::complain::{Complaint, say, styles};
use crate::exit::Exit;
use crate::words;
use lapwing_diag::suggest::nearest;

/// Arguments of `codegen`.
#[derive(Debug, Args)]
#[command(after_help = "\
What is written needs no library, no allocation and memory of one size that is known beforehand: Rust for crates without a standard library,
or C99. docs/embedded.md says what can be generated; what cannot is refused, at its place.

  lapwing codegen robot.rv --lang c -o firmware/
  lapwing codegen robot.rv --lang rust -o src/ --property no_rush --property answers
  lapwing codegen robot.rv --lang c                      to standard output")]
pub struct Codegen {
    /// The specification
    #[arg(value_name = "SPEC.rv")]
    pub spec: PathBuf,
    /// The language to write
    #[arg(long, value_name = "LANGUAGE")]
    pub lang: Lang,
    /// The folder to write to, made where it is not there; standard output without it
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// What the files and the names of C begin with [default: the name of the specification]
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// Only this property (repeatable)
    #[arg(long, value_name = "NAME")]
    pub property: Vec<String>,
    /// How many obligations with a deadline each property may have open, and how many stamps a window of the past may hold
    ///
    /// Where more would be needed the property is inconclusive from then on, and says so.
    #[arg(long, value_name = "N", default_value_t = lapwing_codegen::CAPACITY, value_parser = capacity)]
    pub capacity: usize,
    /// Whether to colour
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub color: ColorChoice,
}

/// The languages.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Lang {
    /// A module for crates without a standard library
    Rust,
    /// C99: a header and a source file
    C,
}

fn capacity(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|n| (4..=1 << 20).contains(n));
    number.ok_or_else(|| format!("`{text}` is no capacity: write a number from 4 to {}", 1 << 20))
}

/// Runs the command.
pub fn run(arguments: &Codegen) -> Result<Exit, Complaint> {
    let (_, style) = styles(arguments.color);
    let specs = words::specs(std::slice::from_ref(&arguments.spec), &[], style)?;
    let Some(spec) = specs.first() else { return Ok(Exit::Good) };
    say(&spec.findings().render(style));
    let checked = &spec.alone().spec;
    for name in &arguments.property {
        if !checked.properties.iter().any(|p| p.name == *name) {
            return Err(unknown(name, checked.properties.iter().map(|p| p.name.as_str())));
        }
    }
    let stem = arguments.spec.file_stem().map_or_else(|| "monitor".into(), |stem| stem.to_string_lossy());
    let options = Options {
        language: match arguments.lang {
            Lang::Rust => Language::Rust,
            Lang::C => Language::C,
        },
        name: arguments.name.clone().unwrap_or_else(|| stem.into_owned()),
        capacity: arguments.capacity,
        properties: arguments.property.clone(),
    };
    let sources = &spec.findings().sources;
    match generate(checked, spec.name(), &options) {
        Ok(generated) => write(arguments, &generated),
        Err(refusals) => {
            let text: String = refusals.iter().map(|d| render(sources, d, style)).collect();
            Err(Complaint::rendered(text))
        }
    }
}

fn unknown<'a>(name: &str, all: impl Iterator<Item = &'a str> + Clone) -> Complaint {
    let complaint = Complaint::new(format!("there is no property `{name}`"));
    match nearest(name, all.clone()) {
        Some(near) => complaint.help(format!("did you mean `{near}`?")),
        None => complaint.help(format!("there are: {}", all.collect::<Vec<_>>().join(", "))),
    }
}

fn write(arguments: &Codegen, generated: &Generated) -> Result<Exit, Complaint> {
    let Some(folder) = &arguments.output else {
        let text: String = generated.files.iter().map(|(_, text)| text.as_str()).collect();
        // Where nobody reads it there is nothing to be done.
        drop(io::stdout().write_all(text.as_bytes()));
        return Ok(Exit::Good);
    };
    let failed = |path: &std::path::Path, e: io::Error| Complaint::new(format!("{}: {e}", path.display()));
    std::fs::create_dir_all(folder).map_err(|e| failed(folder, e))?;
    for (name, text) in &generated.files {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|e| failed(&path, e))?;
        say(&format!("wrote {}\n", path.display()));
    }
    Ok(Exit::Good)
}
