//! CSV: a header of column names, then rows, each at its time.
//!
//! Own code rather than the `csv` crate: a quote that is never closed costs one line here and not the rest of the file,
//! a line has a limit, and a row is split and read in one pass.

use std::borrow::Cow;

use lapwing_stream::{Name, Time, Value};

use super::lines::{Line, Lines};
use super::{Channel, Head, Source};
use crate::decimal;
use crate::error::{Losses, OpenError, Place, ReadError};
use crate::options::Limits;

/// A file of rows.
pub(crate) struct Csv {
    lines: Lines,
    /// One per column but that of the time.
    columns: Vec<Name>,
    cells: Vec<(Name, Value)>,
    /// The column of the time, and the decimal places that its unit has in nanoseconds.
    time: (usize, i64),
}

impl Csv {
    /// Reads the header.
    pub fn open(mut lines: Lines, limits: &Limits) -> Result<Csv, OpenError> {
        let header = loop {
            match lines.next().map_err(|e| OpenError::Io { path: e.at.file, error: e.error })? {
                Line::Found(line) if lines.bytes(&line).trim_ascii().is_empty() => {}
                Line::Found(line) => break lines.bytes(&line).to_vec(),
                _ => break Vec::new(),
            }
        };
        let damaged = |what: String| OpenError::Damaged { at: lines.place(0), what };
        let header = header.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&header);
        let names = names(header).ok_or_else(|| damaged("a quote in the header is not closed".to_owned()))?;
        let time = time_column(&names).ok_or_else(|| damaged(no_time(header)))?;
        if names.len() > limits.names {
            return Err(damaged(format!("it has {} columns, more than Limits::names allows", names.len())));
        }
        let mut columns: Vec<Name> = Vec::new();
        let mut sorted: Vec<&String> = names.iter().collect();
        sorted.sort_unstable();
        if let Some(twice) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(damaged(format!("two columns are named `{}`: rename one", twice[0])));
        }
        columns
            .extend(names.iter().enumerate().filter(|(k, _)| *k != time.0).map(|(_, name)| Name::from(name.as_str())));
        let cells = columns.iter().map(|name| (name.clone(), Value::Missing)).collect();
        Ok(Csv { lines, columns, cells, time })
    }

    /// Reads a row into the cells; an error is a column, from 0, and what is wrong there.
    fn row(&mut self, line: &std::ops::Range<usize>) -> Result<Time, (u64, String)> {
        let text = self.lines.bytes(line);
        let mut time = None;
        let (mut column, mut place) = (0, 0);
        let mut cells = Cells { rest: Some(text), at: 0 };
        while let Some(cell) = cells.next() {
            let cell = cell.map_err(|at| (at, "a quote is not closed in its line".to_owned()))?;
            column += 1;
            if column == self.time.0 + 1 {
                let nanos = decimal::scaled(cell.text.trim_ascii(), self.time.1).map_err(|e| {
                    (cell.at, format!("the time `{}` {}", String::from_utf8_lossy(&cell.text), e.reason()))
                })?;
                time = Some(Time(nanos));
            } else {
                let Some((_, value)) = self.cells.get_mut(place) else { break };
                set(value, &cell);
                place += 1;
            }
        }
        let wanted = self.columns.len() + 1;
        if column != wanted {
            let have = if column > wanted { "more".to_owned() } else { column.to_string() };
            return Err((0, format!("the row has {have} cells where the header has {wanted}")));
        }
        time.ok_or((0, "the row has no time".to_owned()))
    }
}

/// The column of the time and its unit: `time_ns` rather than `time`.
pub(crate) fn time_column(names: &[String]) -> Option<(usize, i64)> {
    let column = |name: &str| names.iter().position(|n| n == name);
    let seconds = || column("time").map(|k| (k, decimal::SECONDS));
    column("time_ns").map(|k| (k, decimal::NANOSECONDS)).or_else(seconds)
}

fn no_time(header: &[u8]) -> String {
    let separators = header.iter().any(|b| matches!(b, b';' | b'\t')) && !header.contains(&b',');
    let hint = if separators { "; columns are separated by commas" } else { "" };
    format!("the header has no column `time` (in seconds) or `time_ns`{hint}")
}

/// The names in a header; `None` where a quote is not closed.
pub(crate) fn names(header: &[u8]) -> Option<Vec<String>> {
    let mut cells = Cells { rest: Some(header), at: 0 };
    let mut names = Vec::new();
    while let Some(cell) = cells.next() {
        names.push(String::from_utf8_lossy(cell.ok()?.text.trim_ascii()).into_owned());
    }
    Some(names)
}

/// The cells of a line.
struct Cells<'a> {
    /// What follows the last comma; `None` after the last cell.
    rest: Option<&'a [u8]>,
    /// The byte of the line at which that begins, from 1.
    at: u64,
}

/// One cell.
struct Cell<'a> {
    text: Cow<'a, [u8]>,
    quoted: bool,
    /// The byte of the line at which it begins, from 1.
    at: u64,
}

impl<'a> Cells<'a> {
    /// The next cell; an error is where a quote begins that is not closed.
    #[inline]
    fn next(&mut self) -> Option<Result<Cell<'a>, u64>> {
        let rest = self.rest?;
        let at = self.at + 1;
        if rest.first() == Some(&b'"') {
            return Some(self.quoted(rest, at).ok_or(at));
        }
        let end = rest.iter().position(|b| *b == b',').unwrap_or(rest.len());
        self.go_on(rest, end);
        Some(Ok(Cell { text: Cow::Borrowed(rest[..end].trim_ascii()), quoted: false, at }))
    }

    /// Past the comma after `end`, or to the end of the line.
    fn go_on(&mut self, rest: &'a [u8], end: usize) {
        self.rest = rest.get(end + 1..);
        self.at += end as u64 + 1;
    }

    /// A cell in quotes, in which two quotes stand for one.
    fn quoted(&mut self, rest: &'a [u8], at: u64) -> Option<Cell<'a>> {
        let mut text = Vec::new();
        let mut from = 1;
        loop {
            let quote = from + memchr::memchr(b'"', &rest[from..])?;
            text.extend_from_slice(&rest[from..quote]);
            if rest.get(quote + 1) != Some(&b'"') {
                let after = &rest[quote + 1..];
                let end = quote + 1 + after.iter().position(|b| *b == b',').unwrap_or(after.len());
                self.go_on(rest, end);
                return Some(Cell { text: Cow::Owned(text), quoted: true, at });
            }
            text.push(b'"');
            from = quote + 2;
        }
    }
}

/// Overwrites a value by a cell: nothing, a boolean, a number, or else a text. What is quoted is a text.
fn set(value: &mut Value, cell: &Cell<'_>) {
    let text = &*cell.text;
    *value = match text {
        b"" => Value::Missing,
        b"true" if !cell.quoted => Value::Bool(true),
        b"false" if !cell.quoted => Value::Bool(false),
        _ => match number(text).filter(|_| !cell.quoted) {
            Some(number) => Value::Num(number),
            None => {
                let text = String::from_utf8_lossy(text);
                match value {
                    Value::Str(old) => {
                        old.clear();
                        old.push_str(&text);
                        return;
                    }
                    _ => Value::Str(text.into_owned()),
                }
            }
        },
    };
}

/// A number, also `nan`, `inf` and `infinity` in any case, with a sign or without.
fn number(text: &[u8]) -> Option<f64> {
    std::str::from_utf8(text).ok()?.parse().ok()
}

impl Source for Csv {
    fn channels(&self) -> &[Channel] {
        &[]
    }

    fn advance(&mut self, losses: &mut Losses) -> Result<Option<(Time, Head)>, ReadError> {
        loop {
            match self.lines.next()? {
                Line::End => return Ok(None),
                Line::TooLong => losses.add(self.place(), "the row is longer than Limits::line allows: it is lost"),
                Line::Found(line) if line.is_empty() => {}
                Line::Found(line) => match self.row(&line) {
                    Ok(time) => return Ok(Some((time, Head::Row))),
                    Err((column, what)) => losses.add(self.lines.place(column), format!("{what}: it is lost")),
                },
            }
        }
    }

    fn payload(&mut self) -> Result<&[u8], String> {
        Err("a row has no message".to_owned())
    }

    fn cells(&self) -> &[(Name, Value)] {
        &self.cells
    }

    fn columns(&self) -> &[Name] {
        &self.columns
    }

    fn place(&self) -> Place {
        self.lines.place(0)
    }

    fn progress(&self) -> (u64, u64) {
        self.lines.progress()
    }
}
