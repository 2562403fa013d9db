//! What a run saw, as an MCAP file: the messages with their definitions, and what else was seen on [`TOPIC`]. A thread of its own
//! compresses and writes, so that judging does not wait for a disk.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use lapwing_record::{RawChannel, bundled_text, normal_name};
use lapwing_stream::Time;
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};

use super::course::{Seen, Sight};
use crate::status::{SCHEMA, Status, Stream, TOPIC};

/// So many things wait for the disk; where there are more, the monitor waits, and its own queue counts what is lost then.
const WAITING: usize = 1 << 16;

/// A recording that is being written.
#[derive(Debug)]
pub(crate) struct Tape {
    sender: SyncSender<Sight>,
    writer: JoinHandle<Result<(), String>>,
}

impl Tape {
    /// Begins a file; `profile` is what readers are told to expect, `ros1` or `ros2`.
    pub fn create(path: &Path, profile: &'static str) -> Result<Tape, String> {
        let file = Reel::create(path, profile)?;
        let (sender, receiver) = sync_channel(WAITING);
        let writer = std::thread::Builder::new().name("lapwing-record".to_owned());
        let writer =
            writer.spawn(move || file.write(&receiver)).map_err(|e| format!("no thread for the recording: {e}"))?;
        Ok(Tape { sender, writer })
    }

    /// Writes down what was seen. `false` where the file cannot be written any more.
    pub fn put(&self, sight: Sight) -> bool {
        self.sender.send(sight).is_ok()
    }

    /// Completes the file.
    pub fn finish(self) -> Result<(), String> {
        drop(self.sender);
        self.writer.join().unwrap_or_else(|_| Err("the recording was given up".to_owned()))
    }
}

/// The file, on the thread that writes it.
struct Reel {
    writer: Writer<BufWriter<File>>,
    path: PathBuf,
    status: u16,
    /// The channels of the streams, and what they are called.
    channels: BTreeMap<u32, u16>,
    sequence: u32,
}

impl Reel {
    fn create(path: &Path, profile: &'static str) -> Result<Reel, String> {
        let file = File::create(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let how = WriteOptions::new().profile(profile).library("lapwing").compression(Some(Compression::Zstd));
        let mut writer = how.create(BufWriter::new(file)).map_err(|e| fault(path, &e))?;
        let schema =
            writer.add_schema("lapwing.status", "jsonschema", SCHEMA.as_bytes()).map_err(|e| fault(path, &e))?;
        let status = writer.add_channel(schema, TOPIC, "json", &BTreeMap::new()).map_err(|e| fault(path, &e))?;
        Ok(Reel { writer, path: path.to_owned(), status, channels: BTreeMap::new(), sequence: 0 })
    }

    fn write(mut self, sights: &Receiver<Sight>) -> Result<(), String> {
        for Sight { at, what } in sights {
            match what {
                Seen::Offered { stream, channel, latched } => self.offered(at, stream, &channel, latched)?,
                Seen::Message { stream, payload } => {
                    if let Some(channel) = self.channels.get(&stream).copied() {
                        self.put(channel, at, &payload)?;
                    }
                }
                Seen::Status(status) => self.put(self.status, at, status.text().as_bytes())?,
            }
        }
        self.writer.finish().map(drop).map_err(|e| fault(&self.path, &e))
    }

    fn offered(&mut self, at: Time, stream: u32, channel: &RawChannel, is_latched: bool) -> Result<(), String> {
        let is_defined = channel.ty.is_ok();
        if is_defined && !self.channels.contains_key(&stream) {
            let id = self.declare(channel).map_err(|e| fault(&self.path, &e))?;
            self.channels.insert(stream, id);
        }
        let of = Stream { topic: channel.topic.clone(), type_name: channel.type_name.clone() };
        let status = Status::Offered { of, is_defined, is_latched };
        self.put(self.status, at, status.text().as_bytes())
    }

    fn declare(&mut self, channel: &RawChannel) -> mcap::McapResult<u16> {
        let bundled = || bundled_text(&normal_name(&channel.type_name)).map(String::into_bytes);
        let (encoding, definition) = match channel.definition.is_empty() && channel.messages == "cdr" {
            true => ("ros2msg", bundled().unwrap_or_default()),
            false => (channel.encoding.as_str(), channel.definition.clone()),
        };
        let schema = self.writer.add_schema(&channel.type_name, encoding, &definition)?;
        self.writer.add_channel(schema, &channel.topic, &channel.messages, &BTreeMap::new())
    }

    fn put(&mut self, channel_id: u16, at: Time, bytes: &[u8]) -> Result<(), String> {
        // MCAP has no time before 1970.
        let stamp = u64::try_from(at.0).unwrap_or_default();
        self.sequence = self.sequence.wrapping_add(1);
        let header = MessageHeader { channel_id, sequence: self.sequence, log_time: stamp, publish_time: stamp };
        self.writer.write_to_known_channel(&header, bytes).map_err(|e| fault(&self.path, &e))
    }
}

fn fault(path: &Path, error: &mcap::McapError) -> String {
    format!("{}: {error}", path.display())
}
