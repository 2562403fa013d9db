//! A part of a recording of text, as text, and as MCAP for viewers.
//!
//! The text is what replays, since it is of the format that the recording was. The MCAP file is read as the same rows and events.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use lapwing_record::{Cells, Format, Item, Part, Wanted};
use lapwing_stream::{Name, Time, Value as Sampled};
use serde_json::{Map, Value, json};

use super::clip::Clip;
use super::window::Window;
use super::{CapsuleError, Subject, open};

/// The topic of rows in the MCAP file.
const ROWS: &str = "/lapwing/rows";

/// Writes what lies in the window, to an MCAP file and to a text of that format.
pub(super) fn cut(
    subject: &Subject<'_>,
    topics: &[String],
    window: &Window,
    (clip, text): (&Path, &Path),
    format: Format,
) -> Result<(), CapsuleError> {
    let first = if window.rate.is_some() { first_of(subject, topics)? } else { None };
    let from = window.beginning(first);
    let recording = open(subject)?;
    let types: Vec<(String, String)> =
        recording.topics().iter().map(|t| (t.name.clone(), t.type_name.clone())).collect();
    let columns: Vec<Name> = recording.columns().to_vec();
    let mut reader = recording.read(&wanted(topics));
    let mut out = Out { clip: Clip::create(clip, "")?, text: Text::create(text, format, &columns)?, types };
    let mut latest: Vec<(Name, Sampled)> = Vec::new();
    let mut end = None;
    while let Some(item) = reader.next() {
        let item = item.map_err(CapsuleError::Read)?;
        let time = item.time();
        let is_first_beyond = time > window.to && end.is_none_or(|end| end < window.to);
        if from.is_some_and(|from| time < from) {
            if let (true, Item::Row { cells, .. }) = (window.carries, item) {
                carry(&mut latest, cells);
            }
        } else if window.has(from, time) || (is_first_beyond && out.text.columns.is_some()) {
            if let Some(from) = from.filter(|_| !latest.is_empty()) {
                let (names, values): (Vec<Name>, Vec<Sampled>) = std::mem::take(&mut latest).into_iter().unzip();
                out.row(from, Cells::new(&names, &values))?;
            }
            end = end.max(Some(time));
            match item {
                Item::Row { cells, .. } => out.row(time, cells)?,
                Item::Event { name, fields, .. } => out.event(time, name, fields)?,
                Item::Message { topic, wanted: Some(_), values, .. } => out.message(time, topic, values)?,
                Item::Message { .. } => {}
            }
        } else if is_first_beyond {
            // Time went on: deadlines up to the end of the clip were over.
            end = Some(window.to);
        }
    }
    out.finish(end)
}

/// Whole messages of these topics.
fn wanted(topics: &[String]) -> Vec<Wanted> {
    let whole = |topic: &String| Wanted {
        topic: topic.clone(),
        fields: vec![lapwing_record::Path::new(std::iter::empty::<Part>())],
    };
    topics.iter().map(whole).collect()
}

fn first_of(subject: &Subject<'_>, topics: &[String]) -> Result<Option<Time>, CapsuleError> {
    let mut reader = open(subject)?.read(&wanted(topics));
    while let Some(item) = reader.next() {
        match item.map_err(CapsuleError::Read)? {
            Item::Message { wanted: None, .. } => {}
            item => return Ok(Some(item.time())),
        }
    }
    Ok(None)
}

/// The signals that have a value become the latest.
fn carry(latest: &mut Vec<(Name, Sampled)>, cells: Cells<'_>) {
    cells.signals(&mut |name, value| match latest.iter_mut().find(|(n, _)| **n == *name) {
        _ if *value == Sampled::Missing => {}
        Some((_, known)) => known.clone_from(value),
        None => latest.push((name.into(), value.clone())),
    });
}

/// Both files.
struct Out {
    clip: Clip,
    text: Text,
    types: Vec<(String, String)>,
}

impl Out {
    fn row(&mut self, time: Time, cells: Cells<'_>) -> Result<(), CapsuleError> {
        let object = object(cells);
        self.clip.json(ROWS, &schema(&object), time, &object.to_string())?;
        self.text.row(time, cells)
    }

    fn event(&mut self, time: Time, name: &str, fields: Cells<'_>) -> Result<(), CapsuleError> {
        let object = object(fields);
        self.clip.json(&format!("/lapwing/events/{name}"), &schema(&object), time, &object.to_string())?;
        let mut line = json!({ "t_ns": time.0, "event": name });
        if let (Some(line), Value::Object(fields)) = (line.as_object_mut(), object) {
            line.extend(fields);
        }
        self.text.line(&line)
    }

    fn message(&mut self, time: Time, topic: &str, values: &[Sampled]) -> Result<(), CapsuleError> {
        let message = values.first().map_or(Value::Null, value);
        self.clip.json(topic, &schema(&message), time, &message.to_string())?;
        let ty = self.types.iter().find(|(name, _)| name == topic).map(|(_, ty)| ty.as_str()).filter(|t| !t.is_empty());
        let mut line = json!({ "t_ns": time.0, "topic": topic, "msg": message });
        if let (Some(line), Some(ty)) = (line.as_object_mut(), ty) {
            line.insert("type".to_owned(), json!(ty));
        }
        self.text.line(&line)
    }

    fn finish(mut self, end: Option<Time>) -> Result<(), CapsuleError> {
        if let Some(end) = end.filter(|_| self.text.columns.is_none()) {
            // Time went on so far, though nothing may have come that is read.
            self.text.line(&json!({ "t_ns": end.0, "event": "the clip ends" }))?;
        }
        self.text.finish()?;
        self.clip.finish(end)
    }
}

/// The text.
struct Text {
    out: BufWriter<File>,
    path: std::path::PathBuf,
    /// Of CSV, the columns.
    columns: Option<Vec<Name>>,
}

impl Text {
    fn create(path: &Path, format: Format, columns: &[Name]) -> Result<Text, CapsuleError> {
        let file = File::create(path).map_err(|e| CapsuleError::Io(path.to_owned(), e))?;
        let columns = (format == Format::Csv).then(|| columns.to_vec());
        let mut text = Text { out: BufWriter::new(file), path: path.to_owned(), columns };
        if let Some(columns) = &text.columns {
            let head: Vec<String> = columns.iter().map(|c| quoted(c)).collect();
            text.write(&format!("time_ns,{}\n", head.join(",")))?;
        }
        Ok(text)
    }

    fn row(&mut self, time: Time, cells: Cells<'_>) -> Result<(), CapsuleError> {
        match &self.columns {
            None => self.line(&json!({ "t_ns": time.0, "values": object(cells) })),
            Some(columns) => {
                let cells: Vec<String> = columns.iter().map(|c| cells.get(c).map(cell).unwrap_or_default()).collect();
                self.write(&format!("{},{}\n", time.0, cells.join(",")))
            }
        }
    }

    fn line(&mut self, line: &Value) -> Result<(), CapsuleError> {
        self.write(&format!("{line}\n"))
    }

    fn write(&mut self, text: &str) -> Result<(), CapsuleError> {
        self.out.write_all(text.as_bytes()).map_err(|e| CapsuleError::Io(self.path.clone(), e))
    }

    fn finish(&mut self) -> Result<(), CapsuleError> {
        self.out.flush().map_err(|e| CapsuleError::Io(self.path.clone(), e))
    }
}

/// A value in a cell.
fn cell(value: &Sampled) -> String {
    match value {
        Sampled::Bool(b) => b.to_string(),
        Sampled::Num(x) => x.to_string(),
        Sampled::Str(s) => quoted(s),
        _ => String::new(),
    }
}

/// A text between quotes, so that it is taken for nothing else.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

fn object(cells: Cells<'_>) -> Value {
    let there = cells.iter().filter(|(_, v)| **v != Sampled::Missing);
    Value::Object(there.map(|(name, v)| (name.to_string(), value(v))).collect::<Map<_, _>>())
}

fn value(sampled: &Sampled) -> Value {
    match sampled {
        Sampled::Missing => Value::Null,
        Sampled::Bool(b) => json!(b),
        Sampled::Num(x) => json!(x),
        Sampled::Str(s) => json!(s),
        Sampled::Nums(xs) => json!(xs),
        Sampled::List(xs) => xs.iter().map(value).collect(),
        Sampled::Record(fields) => Value::Object(fields.iter().map(|(n, v)| (n.to_string(), value(v))).collect()),
    }
}

/// A JSON schema of a value, as viewers want one.
fn schema(of: &Value) -> String {
    fn shape(of: &Value) -> Value {
        match of {
            Value::Null => json!({}),
            Value::Bool(_) => json!({ "type": "boolean" }),
            Value::Number(_) => json!({ "type": "number" }),
            Value::String(_) => json!({ "type": "string" }),
            Value::Array(all) => json!({ "type": "array", "items": all.first().map_or(json!({}), shape) }),
            Value::Object(fields) => {
                let properties: Map<String, Value> = fields.iter().map(|(n, v)| (n.clone(), shape(v))).collect();
                json!({ "type": "object", "properties": properties })
            }
        }
    }
    shape(of).to_string()
}
