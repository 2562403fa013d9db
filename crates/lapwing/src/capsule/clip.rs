//! A part of a recording as an MCAP file: the original messages, with their definitions.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use lapwing_record::{HeaderStamp, RawChannel, RawReader, TimeSource, bundled_text, normal_name};
use lapwing_stream::Time;
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};

use super::window::Window;
use super::{CapsuleError, Subject, open};

/// The topic of the message that ends a clip: nobody reads it, but it shows that time went on.
const END: &str = "/lapwing/end";

/// Writes the messages of these topics that lie in the window.
pub(super) fn cut(subject: &Subject<'_>, topics: &[String], window: &Window, clip: &Path) -> Result<(), CapsuleError> {
    let mut stamps = Stamps::new(subject.options.recording.time);
    let first = if window.rate.is_some() { first_of(subject, topics, &mut stamps)? } else { None };
    let from = window.beginning(first);
    let mut reader = open(subject)?.read_raw(topics);
    let mut out = Clip::create(clip, profile(&reader))?;
    let mut latest: BTreeMap<usize, (Time, Vec<u8>)> = BTreeMap::new();
    let mut end = None;
    while let Some(message) = reader.next() {
        let message = message.map_err(CapsuleError::Read)?;
        let (number, logged) = (message.channel, message.time);
        if stamps.is_log() && logged > window.to {
            // Time went on: deadlines up to the end of the clip were over.
            end = Some(window.to);
            continue;
        }
        let bytes = message.payload.map(<[u8]>::to_vec);
        let Some(bytes) = bytes else {
            end = end.max(Some(logged).filter(|t| stamps.is_log() && window.has(from, *t)));
            continue;
        };
        let Some(channel) = reader.channel(number) else { continue };
        let time = stamps.of(number, channel, logged, &bytes);
        let is_before = from.is_some_and(|from| time < from);
        if is_before && window.carries {
            latest.insert(number, (logged, bytes));
        } else if window.has(from, time) {
            out.carry(&mut latest, from, &reader)?;
            out.message(number, channel, logged, &bytes)?;
            end = end.max(Some(logged));
        }
    }
    out.carry(&mut latest, from, &reader)?;
    out.finish(end)
}

/// What readers of MCAP are told to expect: some open nothing without it.
fn profile(reader: &RawReader) -> &'static str {
    let has = |encoding: &str| reader.channels().iter().any(|channel| channel.messages == encoding);
    match () {
        () if has("cdr") => "ros2",
        () if has("ros1") => "ros1",
        () => "",
    }
}

/// When the specification reads its first message.
fn first_of(subject: &Subject<'_>, topics: &[String], stamps: &mut Stamps) -> Result<Option<Time>, CapsuleError> {
    let mut reader = open(subject)?.read_raw(topics);
    while let Some(message) = reader.next() {
        let message = message.map_err(CapsuleError::Read)?;
        let (number, logged, bytes) = (message.channel, message.time, message.payload.map(<[u8]>::to_vec));
        if let (Some(bytes), Some(channel)) = (bytes, reader.channel(number)) {
            return Ok(Some(stamps.of(number, channel, logged, &bytes)));
        }
    }
    Ok(None)
}

/// Which stamp counts as the time of a message.
struct Stamps {
    source: TimeSource,
    /// Of each channel, where its messages have a header.
    stamps: BTreeMap<usize, Option<HeaderStamp>>,
}

impl Stamps {
    fn new(source: TimeSource) -> Stamps {
        Stamps { source, stamps: BTreeMap::new() }
    }

    fn is_log(&self) -> bool {
        self.source == TimeSource::Log
    }

    fn of(&mut self, number: usize, channel: &RawChannel, logged: Time, bytes: &[u8]) -> Time {
        if self.is_log() {
            return logged;
        }
        let stamp = || HeaderStamp::new(channel.ty.as_ref().ok()?);
        let stamp = self.stamps.entry(number).or_insert_with(stamp);
        stamp.as_mut().and_then(|stamp| stamp.read(bytes)).unwrap_or(logged)
    }
}

/// A clip that is being written.
pub(super) struct Clip {
    writer: Writer<BufWriter<File>>,
    path: std::path::PathBuf,
    channels: BTreeMap<usize, u16>,
    named: BTreeMap<String, u16>,
    sequence: u32,
    profile: &'static str,
}

impl Clip {
    pub fn create(path: &Path, profile: &'static str) -> Result<Clip, CapsuleError> {
        let file = File::create(path).map_err(|e| CapsuleError::Io(path.to_owned(), e))?;
        let how = WriteOptions::new().profile(profile).library("lapwing").compression(Some(Compression::Zstd));
        let writer = how.create(BufWriter::new(file)).map_err(|e| fault(path, &e))?;
        let path = path.to_owned();
        Ok(Clip { writer, path, channels: BTreeMap::new(), named: BTreeMap::new(), sequence: 0, profile })
    }

    /// What was the latest before the beginning, in the order in which it came.
    fn carry(
        &mut self,
        latest: &mut BTreeMap<usize, (Time, Vec<u8>)>,
        from: Option<Time>,
        reader: &RawReader,
    ) -> Result<(), CapsuleError> {
        let mut messages: Vec<_> = std::mem::take(latest).into_iter().collect();
        messages.sort_by_key(|(_, (time, _))| *time);
        for (number, (logged, bytes)) in messages {
            if let Some(channel) = reader.channel(number) {
                self.message(number, channel, from.unwrap_or(logged), &bytes)?;
            }
        }
        Ok(())
    }

    fn message(&mut self, number: usize, channel: &RawChannel, time: Time, bytes: &[u8]) -> Result<(), CapsuleError> {
        let id = match self.channels.get(&number) {
            Some(id) => *id,
            None => {
                let id = self.declare(channel)?;
                self.channels.insert(number, id);
                id
            }
        };
        self.put(id, time, bytes)
    }

    fn declare(&mut self, channel: &RawChannel) -> Result<u16, CapsuleError> {
        let bundled = || bundled_text(&normal_name(&channel.type_name)).map(String::into_bytes);
        let (encoding, definition) = match channel.definition.is_empty() && channel.messages == "cdr" {
            true => ("ros2msg", bundled().unwrap_or_default()),
            false => (channel.encoding.as_str(), channel.definition.clone()),
        };
        let schema = match channel.type_name.is_empty() && definition.is_empty() {
            true => 0,
            false => {
                let added = self.writer.add_schema(&channel.type_name, encoding, &definition);
                added.map_err(|e| fault(&self.path, &e))?
            }
        };
        let added = self.writer.add_channel(schema, &channel.topic, &channel.messages, &BTreeMap::new());
        added.map_err(|e| fault(&self.path, &e))
    }

    /// A message in JSON, of a topic with that schema.
    pub fn json(&mut self, topic: &str, schema: &str, time: Time, text: &str) -> Result<(), CapsuleError> {
        let id = match self.named.get(topic) {
            Some(id) => *id,
            None => {
                let name = topic.trim_start_matches('/').replace('/', ".");
                let schema = self.writer.add_schema(&name, "jsonschema", schema.as_bytes());
                let schema = schema.map_err(|e| fault(&self.path, &e))?;
                let added = self.writer.add_channel(schema, topic, "json", &BTreeMap::new());
                let id = added.map_err(|e| fault(&self.path, &e))?;
                self.named.insert(topic.to_owned(), id);
                id
            }
        };
        self.put(id, time, text.as_bytes())
    }

    fn put(&mut self, channel_id: u16, time: Time, bytes: &[u8]) -> Result<(), CapsuleError> {
        // MCAP has no time before 1970.
        let stamp = u64::try_from(time.0).unwrap_or_default();
        self.sequence = self.sequence.wrapping_add(1);
        let header = MessageHeader { channel_id, sequence: self.sequence, log_time: stamp, publish_time: stamp };
        self.writer.write_to_known_channel(&header, bytes).map_err(|e| fault(&self.path, &e))
    }

    /// The end of the clip, at the time of the last message of any topic that lies in it.
    pub fn finish(mut self, end: Option<Time>) -> Result<(), CapsuleError> {
        if let Some(end) = end {
            self.mark_end(end)?;
        }
        self.writer.finish().map(drop).map_err(|e| fault(&self.path, &e))
    }
}

/// What the message says that ends a clip of ROS messages.
const END_TEXT: &[u8] = b"the clip ends";

impl Clip {
    /// A message of a type that every reader of such a file knows.
    fn mark_end(&mut self, end: Time) -> Result<(), CapsuleError> {
        let (name, encoding, messages) = match self.profile {
            "ros2" => ("std_msgs/msg/String", "ros2msg", "cdr"),
            "ros1" => ("std_msgs/String", "ros1msg", "ros1"),
            _ => return self.json(END, r#"{"type":"object"}"#, end, "{}"),
        };
        let mut bytes = Vec::new();
        if messages == "cdr" {
            bytes.extend([0, 1, 0, 0]);
        }
        let zero: &[u8] = if messages == "cdr" { &[0] } else { &[] };
        bytes.extend((END_TEXT.len() as u32 + zero.len() as u32).to_le_bytes());
        bytes.extend(END_TEXT);
        bytes.extend(zero);
        let schema = self.writer.add_schema(name, encoding, b"string data\n").map_err(|e| fault(&self.path, &e))?;
        let added = self.writer.add_channel(schema, END, messages, &BTreeMap::new());
        let id = added.map_err(|e| fault(&self.path, &e))?;
        self.put(id, end, &bytes)
    }
}

fn fault(path: &Path, error: &mcap::McapError) -> CapsuleError {
    CapsuleError::Other(format!("{}: {error}", path.display()))
}
