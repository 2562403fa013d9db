//! What is wrong with a scenario file: where, what, and what was probably meant.

use std::fmt;
use std::ops::Range;

/// What is wrong with a scenario file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScenarioError {
    name: String,
    what: String,
    help: Option<String>,
    place: Option<Place>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Place {
    /// Both from 1.
    line: usize,
    column: usize,
    /// The text of the line, and how many characters of it are meant.
    text: String,
    width: usize,
}

impl ScenarioError {
    /// Something that is wrong at a place of the text, or with all of it.
    pub fn new(name: &str, text: &str, span: Option<Range<usize>>, what: impl Into<String>) -> ScenarioError {
        ScenarioError { name: name.to_owned(), what: what.into(), help: None, place: span.and_then(|s| place(text, s)) }
    }

    /// What the parser of TOML found.
    pub fn of_toml(name: &str, text: &str, error: &toml::de::Error) -> ScenarioError {
        let help = meant(error.message()).map(|word| format!("did you mean `{word}`?"));
        ScenarioError { help, ..ScenarioError::new(name, text, error.span(), error.message()) }
    }

    /// What is wrong, with a proposal.
    pub fn with_help(self, help: Option<String>) -> ScenarioError {
        ScenarioError { help, ..self }
    }
}

fn place(text: &str, span: Range<usize>) -> Option<Place> {
    let before = text.get(..span.start)?;
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    let line = text.get(start..)?.lines().next().unwrap_or_default();
    let end = span.end.min(start + line.len()).max(span.start);
    Some(Place {
        line: before.matches('\n').count() + 1,
        column: text.get(start..span.start)?.chars().count() + 1,
        text: line.to_owned(),
        width: text.get(span.start..end)?.chars().count().max(1),
    })
}

/// The name that an unknown one was meant to be. The parser says: unknown field `a`, expected one of `b`, `c`.
fn meant(message: &str) -> Option<&str> {
    if !message.starts_with("unknown field") && !message.starts_with("unknown variant") {
        return None;
    }
    let mut names = message.split('`').skip(1).step_by(2);
    let wrong = names.next()?;
    similar(wrong, names)
}

/// The name that is most like another one, where one is like it.
pub fn similar<'n>(wrong: &str, names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    let far = |name: &str| strsim::damerau_levenshtein(wrong, name);
    let most = 1 + wrong.chars().count() / 3;
    names.filter(|name| far(name) <= most).min_by_key(|name| far(name))
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            None => write!(f, "{}: {}", self.name, self.what)?,
            Some(Place { line, column, text, width }) => {
                let margin = " ".repeat(line.to_string().len());
                let (indent, carets) = (" ".repeat(column - 1), "^".repeat(*width));
                write!(f, "{}:{line}:{column}: {}", self.name, self.what)?;
                write!(f, "\n{margin} |\n{line} | {text}\n{margin} | {indent}{carets}")?;
            }
        }
        self.help.as_ref().map_or(Ok(()), |help| write!(f, "\n  help: {help}"))
    }
}

impl std::error::Error for ScenarioError {}
