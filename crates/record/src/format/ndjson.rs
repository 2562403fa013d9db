//! NDJSON: one object a line, which is a message, a row of values, or an event.

mod chosen;
mod form;
mod named;
mod others;
mod topics;

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::ops::Range;

use lapwing_stream::{Name, Time};

use super::lines::{Line, Lines};
use super::times::{self, like_time};
use super::{Channel, Head, Source};
use crate::cells::Cells;
use crate::decimal;
use crate::decode::{DecodeError, scan::Scanner};
use crate::definition::Library;
use crate::error::{Losses, Place, ReadError};
use crate::met::Met;
use crate::options::Limits;
use chosen::Chosen;
use named::Named;
use topics::Topics;

/// A stream of objects.
pub(crate) struct Ndjson {
    lines: Lines,
    limits: Limits,
    topics: Topics,
    row: Row,
    event: String,
    /// The names of the events met so far.
    events: BTreeSet<String>,
    fields: Named,
    /// Where the latest message is.
    message: Range<usize>,
    /// What came last.
    last: Head,
    /// Names of values that are known before the reading.
    names: Vec<Name>,
}

/// The values of the latest row.
#[expect(clippy::large_enum_variant, reason = "a reader has one, and takes every line into it")]
enum Row {
    All(Named),
    Chosen(Chosen),
}

impl Row {
    fn cells(&self) -> Cells<'_> {
        match self {
            Row::All(named) => named.cells(),
            Row::Chosen(chosen) => chosen.cells(),
        }
    }

    fn fill(&mut self, scanner: &mut Scanner<'_>, limits: &Limits) -> Result<(), DecodeError> {
        match self {
            Row::All(named) => named.fill(scanner, limits, |_| true),
            Row::Chosen(chosen) => chosen.fill(scanner, limits.elements),
        }
    }
}

impl Ndjson {
    pub fn new(lines: Lines, library: &Library, limits: &Limits) -> Ndjson {
        Ndjson {
            lines,
            limits: limits.clone(),
            topics: Topics::new(library, limits.names),
            row: Row::All(Named::default()),
            event: String::new(),
            events: BTreeSet::new(),
            fields: Named::default(),
            message: 0..0,
            last: Head::Row,
            names: Vec::new(),
        }
    }

    /// With the names of values that a look ahead has found.
    pub fn with_names(self, names: Vec<Name>) -> Ndjson {
        Ndjson { names, ..self }
    }

    /// Reads a row the quick way, where that is possible.
    #[inline]
    fn quick(&mut self) -> Option<Time> {
        let Row::Chosen(chosen) = &mut self.row else { return None };
        let (time, length) = chosen.quick(self.lines.ready())?;
        self.lines.pass(length);
        Some(time)
    }

    /// What a line holds.
    fn object(&mut self, line: &Range<usize>) -> Result<(Time, Head), DecodeError> {
        let text = self.lines.bytes(line);
        let Parts { time, topic, ty, message, values, event } = Parts::of(text, &mut self.row, &self.limits)?;
        let time = time.ok_or_else(|| without_time(text))?;
        let head = if let Some(name) = event {
            self.event.clear();
            self.event.push_str(&name);
            if self.events.len() < self.limits.names && !self.events.contains(&self.event) {
                self.events.insert(self.event.clone());
            }
            let is_field = |key: &str| !matches!(key, "t" | "t_ns" | "event");
            self.fields.fill(&mut Scanner::new(text), &self.limits, is_field)?;
            Head::Event
        } else if values {
            if let Row::Chosen(chosen) = &mut self.row {
                chosen.learn(text);
            }
            Head::Row
        } else {
            let (Some(topic), Some(message)) = (&topic, message) else {
                return Err(DecodeError::new(match topic {
                    Some(_) => {
                        "the object has \"topic\" but no \"msg\": write the fields of the message as an object, \"msg\": {…}"
                    }
                    None => "the object has neither \"topic\" and \"msg\", nor \"values\", nor \"event\"",
                }));
            };
            let found = self.topics.find(topic, &ty, &text[message.clone()])?;
            self.message = line.start + message.start..line.start + message.end;
            Head::Message(found)
        };
        Ok((time, head))
    }
}

/// The parts of a line, as far as they are there.
#[derive(Default)]
struct Parts<'t> {
    time: Option<Time>,
    topic: Option<Cow<'t, str>>,
    ty: Cow<'t, str>,
    message: Option<Range<usize>>,
    /// Whether there are values; they are in the row by then.
    values: bool,
    event: Option<Cow<'t, str>>,
}

impl<'t> Parts<'t> {
    fn of(text: &'t [u8], row: &mut Row, limits: &Limits) -> Result<Parts<'t>, DecodeError> {
        let mut parts = Parts::default();
        let mut scanner = Scanner::new(text);
        let mut first = true;
        scanner.open(b'{')?;
        while scanner.more(b'}', &mut first)? {
            match &*scanner.key()? {
                "t" => parts.time = Some(time(&mut scanner, decimal::SECONDS)?),
                "t_ns" => parts.time = Some(time(&mut scanner, decimal::NANOSECONDS)?),
                "topic" => parts.topic = Some(scanner.text()?),
                "type" if scanner.peek() == Some(b'"') => parts.ty = scanner.text()?,
                "event" => parts.event = Some(scanner.text()?),
                "msg" => parts.message = Some(range(&mut scanner)?),
                "values" => {
                    row.fill(&mut scanner, limits)?;
                    parts.values = true;
                }
                _ => scanner.skip()?,
            }
        }
        scanner.end()?;
        Ok(parts)
    }
}

fn range(scanner: &mut Scanner<'_>) -> Result<Range<usize>, DecodeError> {
    let length = scanner.raw()?.len();
    Ok(scanner.at - length..scanner.at)
}

fn time(scanner: &mut Scanner<'_>, unit: i64) -> Result<Time, DecodeError> {
    let start = scanner.clone();
    let digits = scanner.digits()?;
    decimal::scaled(digits, unit).map(Time).map_err(|e| no_time(digits, start, unit, e))
}

/// What to say of an object that has no time under the names by which it is read.
fn without_time(text: &[u8]) -> DecodeError {
    let keys = keys(text).unwrap_or_default();
    let found = match like_time(keys.iter().map(String::as_str)) {
        Some(key) => {
            format!(": is its \"{key}\" the time? Name it \"t\" if it is in seconds, \"t_ns\" if in nanoseconds")
        }
        None => ": write \"t\" in seconds or \"t_ns\"".to_owned(),
    };
    DecodeError::new(format!("the object has no time{found}"))
}

/// The keys of an object.
fn keys(text: &[u8]) -> Result<Vec<String>, DecodeError> {
    let (mut scanner, mut first, mut keys) = (Scanner::new(text), true, Vec::new());
    scanner.open(b'{')?;
    while scanner.more(b'}', &mut first)? {
        keys.push(scanner.key()?.into_owned());
        scanner.skip()?;
    }
    Ok(keys)
}

/// So many bytes of what is no time are shown.
const SHOWN: usize = 40;

/// What to say of the value that begins there with these digits, which is no time.
fn no_time(digits: &[u8], mut value: Scanner<'_>, unit: i64, error: decimal::DecimalError) -> DecodeError {
    let written = match value.raw() {
        Ok(written) => written,
        Err(_) if !digits.is_empty() => digits,
        Err(broken) => return broken,
    };
    let shown = String::from_utf8_lossy(written.get(..SHOWN).unwrap_or(written));
    let more = if written.len() > SHOWN { "…" } else { "" };
    DecodeError::new(format!("the time `{shown}{more}` {}", times::wrong(digits, unit, "t_ns", error)))
}

impl Source for Ndjson {
    fn channels(&self) -> &[Channel] {
        self.topics.channels()
    }

    fn advance(&mut self, losses: &mut Losses) -> Result<Option<(Time, Head)>, ReadError> {
        loop {
            if let Some(time) = self.quick() {
                self.last = Head::Row;
                return Ok(Some((time, Head::Row)));
            }
            match self.lines.next()? {
                Line::End => return Ok(None),
                Line::TooLong => losses.add(self.place(), "the line is longer than Limits::line allows: it is lost"),
                Line::Found(line) if self.lines.bytes(&line).trim_ascii().is_empty() => {}
                Line::Found(line) => match self.object(&line) {
                    Ok((time, head)) => {
                        self.last = head;
                        return Ok(Some((time, head)));
                    }
                    Err(error) => losses.add(self.place(), format!("the line is lost: {error}")),
                },
            }
        }
    }

    fn payload(&mut self) -> Result<&[u8], String> {
        Ok(self.lines.bytes(&self.message))
    }

    fn choose(&mut self, signals: &[Name]) {
        self.row = Row::Chosen(Chosen::new(signals));
    }

    fn cells(&self) -> Cells<'_> {
        match self.last {
            Head::Event => self.fields.cells(),
            _ => self.row.cells(),
        }
    }

    fn columns(&self) -> &[Name] {
        &self.names
    }

    fn event(&self) -> &str {
        &self.event
    }

    fn met(&self) -> Met {
        let mut signals: BTreeSet<String> = self.names.iter().map(|name| name.to_string()).collect();
        if let Row::Chosen(chosen) = &self.row {
            signals.extend(chosen.others().names().map(str::to_owned));
        }
        let events = self.events.iter().cloned().collect();
        let fields = self.topics.fields().to_vec();
        Met { signals: signals.into_iter().collect(), events, fields, ..Met::of(self.channels()) }
    }

    fn place(&self) -> Place {
        self.lines.place(0)
    }

    fn progress(&self) -> (u64, u64) {
        self.lines.progress()
    }
}
