//! `lapwing explain`: what a specification, a shipped pattern, or a diagnostic code means.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::PathBuf;

use lapwing::explain::{Explained, Explanation, Picture, draw, explain};
use lapwing::{Options, Spec};
use lapwing_diag::Code;

use crate::args::{self, Explain};
use crate::complain::{Complaint, say, styles};
use crate::exit::Exit;
use crate::library;
use crate::words;
use lapwing_diag::suggest::nearest;

/// Runs the command.
pub fn run(arguments: &Explain) -> Result<Exit, Complaint> {
    let text = match words::is_spec(&arguments.what) {
        true => specification(arguments)?,
        false if arguments.what.starts_with("std.") => library::page(&arguments.what)?,
        false => code(&arguments.what)?,
    };
    // Where nobody reads it there is nothing to be done.
    drop(io::stdout().write_all(text.as_bytes()));
    Ok(Exit::Good)
}

/// The page of a diagnostic code.
fn code(name: &str) -> Result<String, Complaint> {
    // As it stands in a message: `error[unknown-name]`.
    let name = name.split_once('[').map_or(name, |(_, rest)| rest.trim_end_matches(']'));
    if let Some(code) = Code::from_name(name) {
        return Ok(format!("{}\n", code.page().trim_end()));
    }
    let complaint = Complaint::new(format!(
        "`{name}` is neither a specification (*.rv) nor a pattern library (std.*) nor a diagnostic code"
    ));
    Err(complaint.help(match nearest(name, Code::ALL.iter().map(|c| c.name())) {
        Some(near) => format!("did you mean `{near}`?"),
        None => "a code is the word in brackets of a message: `error[unknown-name]`".to_owned(),
    }))
}

fn specification(arguments: &Explain) -> Result<String, Complaint> {
    let (_, style) = styles(clap::ColorChoice::Auto);
    let specs = words::specs(&[PathBuf::from(&arguments.what)], &arguments.reading.msgs, style)?;
    let Some(spec) = specs.first() else { return Ok(String::new()) };
    say(&spec.findings().render(style));
    let trace = arguments.trace.as_deref().map(words::recording).transpose()?;
    let options = Options { recording: arguments.reading.options(), ..Options::default() };
    let picture = match arguments.format {
        args::Picture::Text => None,
        args::Picture::Dot => Some(Picture::Dot),
        args::Picture::Mermaid => Some(Picture::Mermaid),
        args::Picture::Svg => Some(Picture::Svg),
    };
    if let Some(picture) = picture {
        let drawn = draw(spec, trace.as_deref(), &options, picture).map_err(|e| Complaint::new(e.to_string()))?;
        return drawn.ok_or_else(|| Complaint::new(format!("{}: it has no property to draw", arguments.what)));
    }
    let explanation = explain(spec, trace.as_deref(), &options, style).map_err(|e| Complaint::new(e.to_string()))?;
    explanation.findings.iter().for_each(|text| say(text));
    Ok(text(spec, &explanation))
}

fn text(spec: &Spec, explanation: &Explanation) -> String {
    let mut out = format!("{}: {}\n", spec.name(), explanation.clock);
    if !explanation.topics.is_empty() {
        out += "It reads:\n";
        explanation.topics.iter().for_each(|topic| out += &format!("  {topic}\n"));
    }
    explanation.properties.iter().for_each(|property| out += &one(property));
    if explanation.properties.is_empty() {
        out += "\nIt has no property: nothing would be checked.\n";
    }
    out
}

fn one(property: &Explained) -> String {
    let line = if property.name.starts_with("line ") { String::new() } else { format!(" (line {})", property.line) };
    let mut out = format!("\n{}{line}\n", property.name);
    property.text.lines().for_each(|line| out += &format!("    {line}\n"));
    let mut row = |what: &str, text: &str| {
        if !text.is_empty() {
            let _ = writeln!(out, "  {what:<8} {text}");
        }
    };
    row("means", &property.words);
    row("formula", &property.formula);
    property.reads.iter().enumerate().for_each(|(n, read)| row(if n == 0 { "reads" } else { "" }, read));
    if !property.known.is_empty() {
        row("known", &format!("a failure is known {}", property.known));
    }
    row("memory", &property.memory);
    property.reactions.iter().for_each(|reaction| row("then", reaction));
    row("problem", property.problem.as_deref().unwrap_or_default());
    out
}
