//! What can go wrong: errors that stop the reading, and losses that do not.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use lapwing_stream::Time;

/// A place in a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file, `-` for standard input.
    pub file: PathBuf,
    /// Where in it.
    pub position: Position,
}

/// Where in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Position {
    /// Nowhere in particular.
    Whole,
    /// At that byte, from 0.
    Byte(u64),
    /// At that line, from 1, and byte of the line, from 1 (0: the line as a whole).
    Line {
        /// The line, from 1.
        line: u64,
        /// The byte in the line, from 1; 0 is the line as a whole.
        column: u64,
    },
    /// At that row of a database.
    Row(i64),
}

impl Place {
    /// A place in a file.
    pub fn new(file: &Path, position: Position) -> Place {
        Place { file: file.to_owned(), position }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        match self.position {
            Position::Whole => Ok(()),
            Position::Byte(byte) => write!(f, ", byte {byte}"),
            Position::Line { line, column: 0 } => write!(f, ", line {line}"),
            Position::Line { line, column } => write!(f, ", line {line}, column {column}"),
            Position::Row(row) => write!(f, ", row {row}"),
        }
    }
}

/// A recording that cannot be read at all.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OpenError {
    /// The operating system refused.
    #[error("{}: {error}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What it said.
        #[source]
        error: io::Error,
    },
    /// It is none of the formats that can be read.
    #[error(
        "{}: no recording: {seen}; accepted are MCAP, rosbag2 (a folder with metadata.yaml, or a .db3), ROS 1 bags (2.0), \
         CSV with a column `time` or `time_ns`, and NDJSON",
        path.display()
    )]
    Unrecognised {
        /// The file or folder.
        path: PathBuf,
        /// What was found instead.
        seen: String,
    },
    /// It is a known format, but damaged where nothing can be read without it.
    #[error("{at}: {what}")]
    Damaged {
        /// Where.
        at: Place,
        /// What is wrong, and what to do.
        what: String,
    },
    /// It is a known format, or a variant of one, that is not supported.
    #[error("{}: {what}", path.display())]
    Unsupported {
        /// The file or folder.
        path: PathBuf,
        /// What is not supported, and what to do.
        what: String,
    },
}

/// The operating system stopped the reading. What a damaged file lacks is a [`Loss`], not an error.
#[derive(Debug, thiserror::Error)]
#[error("{at}: {error}")]
pub struct ReadError {
    /// Where.
    pub at: Place,
    /// What the operating system said.
    #[source]
    pub error: io::Error,
}

/// A part of a recording that could not be read.
#[derive(Clone, Debug, PartialEq)]
pub struct Loss {
    /// Where it is.
    pub at: Place,
    /// The topic, where only that one lost something.
    pub topic: Option<String>,
    /// What is lost, why, and what can be done.
    pub what: String,
    /// The time of the last message before it.
    pub after: Option<Time>,
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.at, self.what)?;
        match &self.topic {
            Some(topic) => write!(f, " (topic {topic})"),
            None => Ok(()),
        }
    }
}

/// The losses so far, bounded: what exceeds the limit is counted in the last one.
#[derive(Debug, Default)]
pub(crate) struct Losses {
    list: Vec<Loss>,
    limit: usize,
    beyond: u64,
    /// The time of the last message read, for [`Loss::after`].
    pub last: Option<Time>,
}

impl Losses {
    pub fn new(limit: usize) -> Losses {
        Losses { limit: limit.max(1), ..Losses::default() }
    }

    /// Notes a loss of every topic.
    pub fn add(&mut self, at: Place, what: impl Into<String>) {
        self.push(at, None, what.into());
    }

    /// Notes a loss of one topic.
    pub fn add_of(&mut self, at: Place, topic: &str, what: impl Into<String>) {
        self.push(at, Some(topic.to_owned()), what.into());
    }

    fn push(&mut self, at: Place, topic: Option<String>, what: String) {
        if self.list.len() < self.limit {
            self.list.push(Loss { at, topic, what, after: self.last });
            return;
        }
        self.beyond += 1;
        let beyond = self.beyond;
        if let Some(last) = self.list.last_mut() {
            let end = last.what.find(" (and ").unwrap_or(last.what.len());
            last.what.truncate(end);
            last.what.push_str(&format!(" (and {beyond} more losses after this one)"));
            last.topic = None;
        }
    }

    pub fn list(&self) -> &[Loss] {
        &self.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_are_bounded_and_counted() {
        let mut losses = Losses::new(2);
        for byte in 0..5 {
            losses.add_of(Place::new(Path::new("a.mcap"), Position::Byte(byte)), "/odom", "gone");
        }
        assert_eq!(losses.list().len(), 2);
        assert_eq!(losses.list()[0].to_string(), "a.mcap, byte 0: gone (topic /odom)");
        assert_eq!(losses.list()[1].to_string(), "a.mcap, byte 1: gone (and 3 more losses after this one)");
    }
}
