//! CSV: a header of column names, then rows, each at its time.
//!
//! Own code rather than the `csv` crate: a quote that is never closed costs one line here and not the rest of the file,
//! a line has a limit, and a row is split and read in one pass, of which only the wanted columns are kept.

mod cells;
mod plan;
mod quick;

use lapwing_stream::{Name, Time, Value};

use super::lines::{Line, Lines};
use super::signals::Signals;
use super::times;
use super::{Channel, Head, Source};
use crate::cells::Cells;
use crate::decimal;
use crate::error::{Losses, OpenError, Place, ReadError};
use crate::options::Limits;
use plan::{Column, Plan};

/// A file of rows.
pub(crate) struct Csv {
    lines: Lines,
    /// The column of the time, and the decimal places that its unit has in nanoseconds.
    time: (usize, i64),
    /// One per column but that of the time.
    columns: Vec<Name>,
    plan: Plan,
    /// What is read of a row: all columns, unless some were chosen.
    signals: Signals,
    values: Vec<Value>,
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
        let header = &*header;
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
        let signals = Signals::new(&columns);
        Ok(Csv { lines, time, plan: Plan::new(&columns, time, &signals), values: signals.blank(), signals, columns })
    }

    /// Reads a row the quick way, where that is possible.
    #[inline]
    fn quick(&mut self) -> Option<Time> {
        let (time, length) = quick::row(self.lines.ready(), &self.plan, &mut self.values)?;
        self.lines.pass(length);
        self.signals.copy(&mut self.values);
        Some(time)
    }

    /// Reads a row whatever its cells are; an error is a column, from 0, and what is wrong there.
    fn row(&mut self, line: &std::ops::Range<usize>) -> Result<Time, (u64, String)> {
        let mut time = None;
        let mut columns = self.plan.columns.iter();
        let mut cells = cells::Cells::of(self.lines.bytes(line));
        let mut count = 0;
        while let Some(cell) = cells.next() {
            let cell = cell.map_err(|at| (at, "a quote is not closed in its line".to_owned()))?;
            count += 1;
            match columns.next() {
                Some(Column::Time) => time = Some(stamp(&cell, self.plan.unit)?),
                Some(Column::Value(slot)) => {
                    if let Some(value) = self.values.get_mut(*slot) {
                        cells::set(value, &cell.text, cell.quoted);
                    }
                }
                Some(Column::Unread) => {}
                None => break,
            }
        }
        let wanted = self.plan.columns.len();
        if count != wanted {
            let have = if count > wanted { "more".to_owned() } else { count.to_string() };
            return Err((0, format!("the row has {have} cells where the header has {wanted}")));
        }
        self.signals.copy(&mut self.values);
        time.ok_or((0, "the row has no time".to_owned()))
    }
}

fn stamp(cell: &cells::Cell<'_>, unit: i64) -> Result<Time, (u64, String)> {
    let time = decimal::scaled(cell.text.trim_ascii(), unit);
    let wrong = |e| times::wrong(cell.text.trim_ascii(), unit, "time_ns", e);
    time.map(Time).map_err(|e| (cell.at, format!("the time `{}` {}", String::from_utf8_lossy(&cell.text), wrong(e))))
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
    let mut cells = cells::Cells::of(header);
    let mut names = Vec::new();
    while let Some(cell) = cells.next() {
        names.push(String::from_utf8_lossy(cell.ok()?.text.trim_ascii()).into_owned());
    }
    Some(names)
}

impl Source for Csv {
    fn channels(&self) -> &[Channel] {
        &[]
    }

    fn advance(&mut self, losses: &mut Losses) -> Result<Option<(Time, Head)>, ReadError> {
        loop {
            if let Some(time) = self.quick() {
                return Ok(Some((time, Head::Row)));
            }
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

    fn choose(&mut self, signals: &[Name]) {
        self.signals = Signals::new(signals);
        self.plan = Plan::new(&self.columns, self.time, &self.signals);
        self.values = self.signals.blank();
    }

    fn cells(&self) -> Cells<'_> {
        Cells::new(self.signals.names(), &self.values)
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
