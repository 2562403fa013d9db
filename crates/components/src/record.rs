//! A run written down, so that the specification that watched it can be checked again: as NDJSON, or as MCAP with messages in JSON.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::Path;

use lapwing_stream::{Field, Schema, Time, Type, json};
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};

use crate::signals::{Message, Signals};

/// A recording that is being written.
pub struct Recorder<W: Write + Seek> {
    to: To<W>,
    names: Vec<(String, String)>,
    line: String,
    count: u32,
    /// Why a message could not be written; none is written after it.
    trouble: Option<io::Error>,
}

enum To<W: Write + Seek> {
    Lines(BufWriter<W>),
    Mcap(Box<Writer<W>>, Vec<u16>),
}

impl Recorder<File> {
    /// A recording in a file: one line for each message where its name ends in `.ndjson` or `.jsonl`, else MCAP.
    ///
    /// # Errors
    ///
    /// It cannot be written: which file, and why.
    pub fn create(path: &Path, signals: &Signals) -> Result<Recorder<File>, String> {
        let cannot = |e: &dyn std::fmt::Display| format!("{} cannot be written: {e}", path.display());
        let file = File::create(path).map_err(|e| cannot(&e))?;
        match path.extension().is_some_and(|e| e == "ndjson" || e == "jsonl") {
            true => Ok(Recorder::lines(file, signals)),
            false => Recorder::mcap(file, signals).map_err(|e| cannot(&e)),
        }
    }
}

impl<W: Write + Seek> Recorder<W> {
    /// One line for each message.
    pub fn lines(to: W, signals: &Signals) -> Recorder<W> {
        Recorder {
            to: To::Lines(BufWriter::new(to)),
            names: names(signals),
            line: String::new(),
            count: 0,
            trouble: None,
        }
    }

    /// MCAP. All topics are in it, those without messages too.
    ///
    /// # Errors
    ///
    /// It cannot be written.
    pub fn mcap(to: W, signals: &Signals) -> mcap::McapResult<Recorder<W>> {
        // The library's usual name carries its version, which would make the bytes others.
        let how = WriteOptions::new().library("lapwing genom").compression(Some(Compression::Zstd));
        let mut writer = how.create(to)?;
        let mut channels = Vec::new();
        for topic in signals.topics() {
            let text = json_schema(&topic.schema);
            let schema = writer.add_schema(&topic.schema.name, "jsonschema", text.as_bytes())?;
            channels.push(writer.add_channel(schema, &topic.name, "json", &BTreeMap::new())?);
        }
        Ok(Recorder {
            to: To::Mcap(Box::new(writer), channels),
            names: names(signals),
            line: String::new(),
            count: 0,
            trouble: None,
        })
    }

    /// Writes messages of one time. Returns whether all of them could be written; if not, [`Recorder::finish`] says why.
    pub fn write(&mut self, time: Time, messages: &[Message]) -> bool {
        if self.trouble.is_none() {
            self.trouble = messages.iter().try_for_each(|message| self.write_one(time, message)).err();
        }
        self.trouble.is_none()
    }

    fn write_one(&mut self, time: Time, message: &Message) -> io::Result<()> {
        self.line.clear();
        match &mut self.to {
            To::Lines(out) => {
                let Some((topic, ty)) = self.names.get(message.topic) else { return Ok(()) };
                // Writing to a text cannot fail.
                let _ = write!(self.line, "{{\"t_ns\":{},\"topic\":{topic},\"type\":{ty},\"msg\":", time.0);
                json::value(&mut self.line, &message.value);
                self.line.push_str("}\n");
                out.write_all(self.line.as_bytes())
            }
            To::Mcap(writer, channels) => {
                let Some(channel_id) = channels.get(message.topic).copied() else { return Ok(()) };
                json::value(&mut self.line, &message.value);
                let stamp = u64::try_from(time.0).unwrap_or_default();
                let header = MessageHeader { channel_id, sequence: self.count, log_time: stamp, publish_time: stamp };
                self.count = self.count.wrapping_add(1);
                writer.write_to_known_channel(&header, self.line.as_bytes()).map_err(io::Error::other)
            }
        }
    }

    /// Everything is written.
    ///
    /// # Errors
    ///
    /// It cannot be, or a message could not.
    pub fn finish(self) -> io::Result<()> {
        if let Some(trouble) = self.trouble {
            return Err(trouble);
        }
        match self.to {
            To::Lines(mut out) => out.flush(),
            To::Mcap(mut writer, _) => writer.finish().map(drop).map_err(io::Error::other),
        }
    }
}

/// Names and types of all topics, as JSON has texts.
fn names(signals: &Signals) -> Vec<(String, String)> {
    let quoted = |s: &str| {
        let mut line = String::new();
        json::text(&mut line, s);
        line
    };
    signals.topics().iter().map(|t| (quoted(&t.name), quoted(&t.schema.name))).collect()
}

fn json_schema(schema: &Schema) -> String {
    let mut line = String::new();
    object(&mut line, &schema.fields);
    line
}

fn object(line: &mut String, fields: &[Field]) {
    line.push_str("{\"type\":\"object\",\"properties\":{");
    for (place, field) in fields.iter().enumerate() {
        if place > 0 {
            line.push(',');
        }
        json::text(line, &field.name);
        line.push(':');
        schema_of(line, &field.ty);
    }
    line.push_str("}}");
}

fn schema_of(line: &mut String, ty: &Type) {
    match ty {
        Type::Bool => line.push_str("{\"type\":\"boolean\"}"),
        Type::Num { float: true } => line.push_str("{\"type\":\"number\"}"),
        Type::Num { float: false } => line.push_str("{\"type\":\"integer\"}"),
        Type::Str => line.push_str("{\"type\":\"string\"}"),
        Type::Array(inner) => {
            line.push_str("{\"type\":\"array\",\"items\":");
            schema_of(line, inner);
            line.push('}');
        }
        Type::Message(schema) => object(line, &schema.fields),
        Type::Any => line.push_str("{}"),
    }
}
