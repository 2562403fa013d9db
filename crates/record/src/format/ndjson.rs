//! NDJSON: one object a line, which is a message, a row of values, or an event.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use lapwing_stream::{Name, Time, Value};

use super::lines::{Line, Lines};
use super::{Channel, Head, Source};
use crate::decimal;
use crate::decode::{DecodeError, MessageType, json_value, scan::Scanner};
use crate::definition::{Library, normal_name};
use crate::error::{Losses, Place, ReadError};
use crate::options::Limits;

/// A stream of objects.
pub(crate) struct Ndjson {
    lines: Lines,
    library: Library,
    limits: Limits,
    channels: Vec<Channel>,
    by_name: BTreeMap<String, BTreeMap<String, usize>>,
    cells: Vec<(Name, Value)>,
    /// Names of values and fields met so far.
    names: BTreeMap<String, Name>,
    event: String,
    line: Range<usize>,
    message: Range<usize>,
}

impl Ndjson {
    pub fn new(lines: Lines, library: &Library, limits: &Limits) -> Ndjson {
        Ndjson {
            lines,
            library: library.clone(),
            limits: limits.clone(),
            channels: Vec::new(),
            by_name: BTreeMap::new(),
            cells: Vec::new(),
            names: BTreeMap::new(),
            event: String::new(),
            line: 0..0,
            message: 0..0,
        }
    }

    /// What a line holds.
    fn object(&mut self, line: &Range<usize>) -> Result<(Time, Head), DecodeError> {
        self.line = line.clone();
        let mut fill = Fill { cells: &mut self.cells, names: &mut self.names, limits: &self.limits };
        let Parts { time, topic, ty, message, values, event } = Parts::of(self.lines.bytes(line), &mut fill)?;
        let time =
            time.ok_or_else(|| DecodeError::new("the object has no time: write \"t\" in seconds or \"t_ns\""))?;
        if let Some(name) = event {
            self.event = name;
            self.fields()?;
            return Ok((time, Head::Event));
        }
        if values {
            return Ok((time, Head::Row));
        }
        let (Some(topic), Some(message)) = (topic, message) else {
            return Err(DecodeError::new(
                "the object has neither \"topic\" and \"msg\", nor \"values\", nor \"event\"",
            ));
        };
        let channel = self.channel(&topic, &ty)?;
        self.message = line.start + message.start..line.start + message.end;
        Ok((time, Head::Message(channel)))
    }

    /// The channel of a topic and a type, which may be empty.
    fn channel(&mut self, topic: &str, ty: &str) -> Result<usize, DecodeError> {
        if let Some(index) = self.by_name.get(topic).and_then(|types| types.get(ty)) {
            return Ok(*index);
        }
        if self.channels.len() >= self.limits.names {
            return Err(DecodeError::new("there are more topics than Limits::names allows"));
        }
        let (schema, note) = match ty {
            "" => (None, "its lines say no \"type\"".to_owned()),
            ty => match self.library.installed(ty) {
                Ok(layout) => (Some(layout.schema().clone()), String::new()),
                Err(error) => (None, error.to_string()),
            },
        };
        self.channels.push(Channel {
            topic: Arc::from(topic),
            type_name: normal_name(ty),
            ty: Ok(MessageType::Json(schema)),
            note,
            messages: None,
        });
        let index = self.channels.len() - 1;
        self.by_name.entry(topic.to_owned()).or_default().insert(ty.to_owned(), index);
        Ok(index)
    }

    /// All of an event's keys but its name and its time.
    fn fields(&mut self) -> Result<(), DecodeError> {
        let text = self.lines.bytes(&self.line);
        let mut fill = Fill { cells: &mut self.cells, names: &mut self.names, limits: &self.limits };
        fill.object(&mut Scanner::new(text), |key| !matches!(key, "t" | "t_ns" | "event"))
    }
}

/// Fills cells from an object, reusing names and buffers.
struct Fill<'a> {
    cells: &'a mut Vec<(Name, Value)>,
    names: &'a mut BTreeMap<String, Name>,
    limits: &'a Limits,
}

impl Fill<'_> {
    fn object(&mut self, scanner: &mut Scanner<'_>, wanted: impl Fn(&str) -> bool) -> Result<(), DecodeError> {
        let mut budget = self.limits.elements;
        let (mut first, mut count) = (true, 0);
        scanner.open(b'{')?;
        while scanner.more(b'}', &mut first)? {
            let key = scanner.key()?;
            if !wanted(&key) {
                scanner.skip()?;
                continue;
            }
            self.name(count, &key)?;
            json_value(scanner, &mut budget, &mut self.cells[count].1)?;
            count += 1;
        }
        self.cells.truncate(count);
        Ok(())
    }

    /// Makes the cell at that place one of that name.
    fn name(&mut self, at: usize, key: &str) -> Result<(), DecodeError> {
        if self.cells.get(at).is_some_and(|(name, _)| **name == *key) {
            return Ok(());
        }
        let name = match self.names.get(key) {
            Some(name) => name.clone(),
            None if self.names.len() >= self.limits.names => {
                return Err(DecodeError::new("there are more names than Limits::names allows"));
            }
            None => self.names.entry(key.to_owned()).or_insert_with(|| Name::from(key)).clone(),
        };
        match self.cells.get_mut(at) {
            Some(cell) => cell.0 = name,
            None => self.cells.push((name, Value::Missing)),
        }
        Ok(())
    }
}

/// The parts of a line, as far as they are there.
#[derive(Default)]
struct Parts {
    time: Option<Time>,
    topic: Option<String>,
    ty: String,
    message: Option<Range<usize>>,
    /// Whether there are values; they are in the cells by then.
    values: bool,
    event: Option<String>,
}

impl Parts {
    fn of(text: &[u8], cells: &mut Fill<'_>) -> Result<Parts, DecodeError> {
        let mut parts = Parts::default();
        let mut scanner = Scanner::new(text);
        let mut first = true;
        scanner.open(b'{')?;
        while scanner.more(b'}', &mut first)? {
            match &*scanner.key()? {
                "t" => parts.time = Some(time(&mut scanner, decimal::SECONDS)?),
                "t_ns" => parts.time = Some(time(&mut scanner, decimal::NANOSECONDS)?),
                "topic" => parts.topic = Some(scanner.text()?.into_owned()),
                "type" if scanner.peek() == Some(b'"') => parts.ty = scanner.text()?.into_owned(),
                "event" => parts.event = Some(scanner.text()?.into_owned()),
                "msg" => parts.message = Some(range(&mut scanner)?),
                "values" => {
                    cells.object(&mut scanner, |_| true)?;
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
    let digits = scanner.digits()?;
    decimal::scaled(digits, unit)
        .map(Time)
        .map_err(|e| DecodeError::new(format!("the time `{}` {}", String::from_utf8_lossy(digits), e.reason())))
}

impl Source for Ndjson {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn advance(&mut self, losses: &mut Losses) -> Result<Option<(Time, Head)>, ReadError> {
        loop {
            match self.lines.next()? {
                Line::End => return Ok(None),
                Line::TooLong => losses.add(self.place(), "the line is longer than Limits::line allows: it is lost"),
                Line::Found(line) if self.lines.bytes(&line).trim_ascii().is_empty() => {}
                Line::Found(line) => match self.object(&line) {
                    Ok(found) => return Ok(Some(found)),
                    Err(error) => losses.add(self.place(), format!("the line is lost: {error}")),
                },
            }
        }
    }

    fn payload(&mut self) -> Result<&[u8], String> {
        Ok(self.lines.bytes(&self.message))
    }

    fn cells(&self) -> &[(Name, Value)] {
        &self.cells
    }

    fn event(&self) -> &str {
        &self.event
    }

    fn place(&self) -> Place {
        self.lines.place(0)
    }

    fn progress(&self) -> (u64, u64) {
        self.lines.progress()
    }
}
