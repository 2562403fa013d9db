//! What there is to say of one recording, as data.

use lapwing_stream::{Time, Value, Verdict};

/// What was said of one recording by one or several specifications.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// The files of the specifications, as they were named.
    pub specs: Vec<String>,
    /// The recording, as it was named.
    pub trace: String,
    /// The earliest and the latest stamp; `None` where there was no message.
    pub span: Option<(Time, Time)>,
    /// How many instants were looked at; of several specifications, by the one with the most.
    pub instants: u64,
    /// The topics that the specifications read.
    pub topics: Vec<Topic>,
    /// The properties, in the order of the text, file by file.
    pub properties: Vec<Property>,
    /// What else its reader should know.
    pub warnings: Vec<Warning>,
    /// Why not everything in the recording was looked at, where that is so: it broke off, could not be decoded, was interrupted.
    pub gaps: Vec<String>,
}

/// A topic that is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Topic {
    /// Its name.
    pub name: String,
    /// Its type, where known.
    pub type_name: Option<String>,
    /// How many messages came.
    pub messages: u64,
    /// How many of them no instant saw.
    pub unseen: u64,
}

/// What was said of a property.
#[derive(Clone, Debug, PartialEq)]
pub struct Property {
    /// Its name, with its instance: `line 12`, `calm[robot1]`.
    pub name: String,
    /// The file that it stands in.
    pub file: String,
    /// The line of its first token, from 1.
    pub line: usize,
    /// The column of its first token, from 1.
    pub column: usize,
    /// Its source text.
    pub text: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Why it is inconclusive.
    pub cause: Option<String>,
    /// Whether a success has a scope that was never triggered.
    pub vacuous: bool,
    /// What became of its obligations.
    pub obligations: Obligations,
    /// By how much it missed changing its verdict, at its worst; negative where it failed. `None` where it was not computed, and where
    /// what is compared has different dimensions.
    pub margin: Option<f64>,
    /// The episodes of failures, in the order of time.
    pub violations: Vec<Violation>,
    /// Its scopes and `whenever`s, in the order of the text.
    pub scopes: Vec<Scope>,
    /// How many comparisons met a NaN.
    pub nans: u64,
    /// Where it is unmet: since when something had to happen.
    pub unmet_since: Option<Time>,
    /// Where it is unmet: the values at the end.
    pub at_end: Vec<Reading>,
    /// What the specification wants done on a violation, in words.
    pub reactions: Vec<String>,
    /// What to look at.
    pub hints: Vec<String>,
}

impl Property {
    /// A property of which nothing is known yet but its name, the file with the line and column where it stands, and its text.
    pub fn new(name: &str, file: &str, (line, column): (usize, usize), text: &str) -> Property {
        Property {
            name: name.to_owned(),
            file: file.to_owned(),
            line,
            column,
            text: text.to_owned(),
            verdict: Verdict::Inconclusive,
            cause: None,
            vacuous: false,
            obligations: Obligations::default(),
            margin: None,
            violations: Vec::new(),
            scopes: Vec::new(),
            nans: 0,
            unmet_since: None,
            at_end: Vec::new(),
            reactions: Vec::new(),
            hints: Vec::new(),
        }
    }
}

/// What became of the obligations of a property.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Obligations {
    /// Met.
    pub met: u64,
    /// Failed.
    pub failed: u64,
    /// Neither when the recording ended.
    pub open: u64,
}

/// An episode of failures.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// When the obligation that failed first began.
    pub began: Time,
    /// When it failed.
    pub failed: Time,
    /// When the last one of the episode failed.
    pub until: Time,
    /// How many failed.
    pub count: u64,
    /// The values when it failed; `None` where there were too many violations to keep them.
    pub values: Option<Vec<Reading>>,
    /// The values when it began; `None` where they were no longer kept.
    pub began_values: Option<Vec<Reading>>,
    /// The values on the way to the failure, oldest first.
    pub history: Vec<Row>,
    /// What happened, where the values do not say it: a machine's move.
    pub why: Option<String>,
}

/// A value of something that a property reads, under the name that the specification gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// The name or the expression.
    pub name: String,
    /// Its value, [`Value::Missing`] where it has none or it is not known.
    pub value: Value,
    /// What it is to the reader.
    pub role: Role,
}

/// What a [`Reading`] is to its reader.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Role {
    /// A signal, an event, a machine, or a number that is computed and compared.
    #[default]
    Value,
    /// A part of such a number, or the only condition: for programs; people see the number, the signals, and that it failed.
    Part,
    /// A condition that is a part of the property.
    Condition,
}

/// The values at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// When.
    pub time: Time,
    /// The values, in the order of the [`Violation::values`].
    pub values: Vec<Value>,
}

/// A scope or `whenever` of a property.
#[derive(Clone, Debug, PartialEq)]
pub struct Scope {
    /// How it begins, as written: `whenever cmd > 0.03`.
    pub text: String,
    /// How often it was entered.
    pub entered: u64,
}

/// Something that its reader should know.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// The code, where there is a page on it.
    pub code: Option<&'static str>,
    /// One sentence without a full stop.
    pub message: String,
    /// The place in a specification that it is about, where there is one: file, line and column.
    pub place: Option<(String, usize, usize)>,
    /// When it arose, where it did at a moment.
    pub at: Option<Time>,
    /// Whether people have been shown it before the report, with the line that it is about.
    pub is_shown: bool,
}

impl Property {
    /// Whether it is a failure: something went wrong, or what had to happen did not.
    pub fn has_failed(&self) -> bool {
        matches!(self.verdict, Verdict::Violated | Verdict::Unmet)
    }
}

impl Warning {
    /// A warning with a page.
    pub fn with_code(code: lapwing_diag::Code, message: impl Into<String>) -> Warning {
        Warning { code: Some(code.name()), message: message.into(), place: None, at: None, is_shown: false }
    }

    /// A warning of which the message says everything.
    pub fn plain(message: impl Into<String>) -> Warning {
        Warning { code: None, message: message.into(), place: None, at: None, is_shown: false }
    }
}
