//! ROS 1 bags, version 2.0: chunks of connections and messages.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use lapwing_stream::Time;

use super::compression::{self, Compression, Decompressor};
use super::fields::Fields;
use super::input::Input;
use super::types::{Said, message_type};
use super::{Channel, Head, Source, stamp};
use crate::definition::{Library, normal_name};
use crate::error::{Losses, OpenError, Place, Position, ReadError};
use crate::options::Limits;

/// What every bag of any version begins with.
pub(crate) const MAGIC: &[u8] = b"#ROSBAG V";
/// The first line of the version that is supported.
const VERSION: &[u8] = b"#ROSBAG V2.0\n";
/// Bytes of a record's header; real ones have a few hundred.
const MAX_HEADER: u32 = 1 << 20;

/// The operation codes of records.
mod op {
    pub const MESSAGE: u8 = 0x02;
    pub const BAG: u8 = 0x03;
    pub const CHUNK: u8 = 0x05;
    pub const CHUNK_INFO: u8 = 0x06;
    pub const CONNECTION: u8 = 0x07;
}

/// A ROS 1 bag.
pub(crate) struct Bag {
    input: Input,
    limits: Limits,
    library: Library,
    channels: Vec<Channel>,
    by_connection: BTreeMap<u32, usize>,
    decompressor: Decompressor,
    packed: Vec<u8>,
    header: Vec<u8>,
    chunk: Vec<u8>,
    chunk_at: usize,
    /// Where the chunk, or the message outside of one, stands in the file.
    chunk_start: u64,
    message: Range<usize>,
    /// Where the first record after the bag's own begins.
    first: u64,
    ended: bool,
    closed: bool,
    /// Where the bag was cut off, until that is told: once all that was there before the cut has been read.
    cut: Option<u64>,
}

impl Bag {
    pub fn open(path: &Path, library: &Library, limits: &Limits) -> Result<Bag, OpenError> {
        let mut bag = Bag {
            input: Input::open(path, path)?,
            limits: limits.clone(),
            library: library.clone(),
            channels: Vec::new(),
            by_connection: BTreeMap::new(),
            decompressor: Decompressor::default(),
            packed: Vec::new(),
            header: Vec::new(),
            chunk: Vec::new(),
            chunk_at: 0,
            chunk_start: 0,
            message: 0..0,
            first: 0,
            ended: false,
            closed: false,
            cut: None,
        };
        bag.check_version(path)?;
        bag.learn().map_err(|e| OpenError::Io { path: path.to_owned(), error: e.error })?;
        Ok(bag)
    }

    fn check_version(&mut self, path: &Path) -> Result<(), OpenError> {
        let mut line = vec![0; VERSION.len().min(self.input.left() as usize)];
        self.input.read_array(&mut line).map_err(|e| OpenError::Io { path: path.to_owned(), error: e.error })?;
        if line == VERSION {
            return Ok(());
        }
        let shown = String::from_utf8_lossy(&line).trim_end().to_owned();
        Err(OpenError::Unsupported {
            path: path.to_owned(),
            what: format!(
                "`{shown}` is a version of ROS 1 bags that is not supported: bring it to 2.0 by `rosbag fix`"
            ),
        })
    }

    /// Reads the bag's own record, then its connections: from the index at the end, else by reading it through.
    fn learn(&mut self) -> Result<(), ReadError> {
        let mut losses = Losses::new(1);
        let start = self.input.at();
        let index = match self.record(start)? {
            Some((header, length)) if header.op == op::BAG && length <= self.input.left() => {
                self.input.seek(self.input.at() + length)?;
                self.first = self.input.at();
                header.index
            }
            _ => {
                self.first = start;
                0
            }
        };
        self.closed = index != 0 && index <= self.input.len();
        if !self.closed || !self.read_index(index, &mut losses)? {
            self.rewind()?;
            self.read_through()?;
        }
        self.rewind()
    }

    fn rewind(&mut self) -> Result<(), ReadError> {
        self.chunk.clear();
        self.chunk_at = 0;
        (self.ended, self.cut) = (false, None);
        self.input.seek(self.first)
    }

    /// Reads the connections and the number of their messages. False where the index is damaged.
    fn read_index(&mut self, index: u64, losses: &mut Losses) -> Result<bool, ReadError> {
        self.input.seek(index)?;
        let mut counts: BTreeMap<u32, u64> = BTreeMap::new();
        while self.input.left() > 0 {
            let start = self.input.at();
            let Some((header, length)) = self.record(start)? else { return Ok(false) };
            if length > self.input.left() || length > self.limits.record {
                return Ok(false);
            }
            let mut data = Vec::new();
            self.input.read(length as usize, &mut data)?;
            match header.op {
                op::CONNECTION => self.connect(header.connection, &data, start, losses),
                op::CHUNK_INFO => {
                    let mut pairs = Fields(&data);
                    while let (Some(connection), Some(count)) = (pairs.u32(), pairs.u32()) {
                        *counts.entry(connection).or_default() += u64::from(count);
                    }
                }
                _ => {}
            }
        }
        for (connection, channel) in &self.by_connection {
            self.channels[*channel].messages = Some(counts.get(connection).copied().unwrap_or(0));
        }
        Ok(true)
    }

    fn read_through(&mut self) -> Result<(), ReadError> {
        let mut losses = Losses::new(1);
        let mut counts: BTreeMap<usize, u64> = BTreeMap::new();
        while let Some((_, head)) = self.advance(&mut losses)? {
            if let Head::Message(channel) = head {
                *counts.entry(channel).or_default() += 1;
            }
        }
        for (k, channel) in self.channels.iter_mut().enumerate() {
            channel.messages = Some(counts.get(&k).copied().unwrap_or(0));
        }
        Ok(())
    }

    /// The header of the next record of the file and the length of its data, which comes next.
    fn record(&mut self, start: u64) -> Result<Option<(Header, u64)>, ReadError> {
        let Some(length) = self.number()? else { return Ok(self.cut_off(start)) };
        if length > MAX_HEADER || u64::from(length) > self.input.left() {
            return Ok(self.cut_off(start));
        }
        let mut bytes = std::mem::take(&mut self.header);
        self.input.read(length as usize, &mut bytes)?;
        let header = Header::parse(&bytes);
        self.header = bytes;
        let (Some(header), Some(data)) = (header, self.number()?) else { return Ok(self.cut_off(start)) };
        Ok(Some((header, u64::from(data))))
    }

    fn number(&mut self) -> Result<Option<u32>, ReadError> {
        if self.input.left() < 4 {
            return Ok(None);
        }
        let mut bytes = [0; 4];
        self.input.read_array(&mut bytes)?;
        Ok(Some(u32::from_le_bytes(bytes)))
    }

    fn cut_off<T>(&mut self, start: u64) -> Option<T> {
        (self.ended, self.cut) = (true, Some(start));
        None
    }

    fn end(&mut self, losses: &mut Losses) {
        if !self.closed {
            let what = "the bag was never closed: messages that were not yet written when the recording ended are lost; `rosbag reindex` closes it";
            losses.add(self.input.place(self.input.len()), what);
        }
        self.ended = true;
    }

    /// The next record of the file: a chunk, a message outside of one, or something to pass over.
    fn next_record(&mut self, losses: &mut Losses) -> Result<Option<(Time, Head)>, ReadError> {
        let start = self.input.at();
        if self.input.left() == 0 {
            self.end(losses);
            return Ok(None);
        }
        let Some((header, length)) = self.record(start)? else { return Ok(None) };
        match header.op {
            op::CHUNK => self.read_chunk(&header, start, length, losses).map(|()| None),
            _ if length > self.input.left() => Ok(self.cut_off(start)),
            op::MESSAGE | op::CONNECTION => self.lone(start, length, losses, &header),
            _ => self.input.seek(self.input.at() + length).map(|()| None),
        }
    }

    /// A connection or a message that stands outside of a chunk: read as if it were the only thing in one.
    fn lone(
        &mut self,
        start: u64,
        length: u64,
        losses: &mut Losses,
        header: &Header,
    ) -> Result<Option<(Time, Head)>, ReadError> {
        if length > self.limits.record {
            losses.add(self.input.place(start), too_large("a record", length, "record"));
            return self.input.seek(self.input.at() + length).map(|()| None);
        }
        self.chunk_start = start;
        let mut data = std::mem::take(&mut self.chunk);
        self.input.read(length as usize, &mut data)?;
        self.chunk = data;
        self.chunk_at = self.chunk.len();
        Ok(self.found(header, 0..length as usize, losses))
    }

    fn read_chunk(&mut self, header: &Header, start: u64, length: u64, losses: &mut Losses) -> Result<(), ReadError> {
        self.chunk.clear();
        self.chunk_at = 0;
        self.chunk_start = start;
        let there = length.min(self.input.left());
        if there > self.limits.chunk {
            losses.add(self.input.place(start), too_large("a chunk", length, "chunk"));
            return self.input.seek(self.input.at() + there);
        }
        let mut packed = std::mem::take(&mut self.packed);
        self.input.read(there as usize, &mut packed)?;
        if let Err(what) = self.unpack(header, &packed, there < length) {
            losses.add(self.input.place(start), format!("the messages of a chunk are lost: {what}"));
            self.chunk.clear();
        }
        self.packed = packed;
        if there < length {
            self.cut_off::<()>(start);
        }
        Ok(())
    }

    fn unpack(&mut self, header: &Header, data: &[u8], cut: bool) -> Result<(), String> {
        let how = Compression::of(&header.compression).filter(|how| *how != Compression::Zstd).ok_or_else(|| {
            format!(
                "compression `{}` is not supported: none, lz4 and bz2 are",
                String::from_utf8_lossy(&header.compression)
            )
        })?;
        let size = u64::from(header.size);
        if size > self.limits.chunk {
            return Err(too_large("decompressed, it", size, "chunk"));
        }
        if cut {
            // What can be had of it is had; that the rest is lost is said by the caller.
            let _ = compression::part(how, data, size, &mut self.chunk);
            return Ok(());
        }
        self.decompressor.whole(how, data, size as usize, &mut self.chunk)
    }

    fn next_in_chunk(&mut self, losses: &mut Losses) -> Option<(Time, Head)> {
        while self.chunk_at < self.chunk.len() {
            let mut fields = Fields(&self.chunk[self.chunk_at..]);
            let whole = fields.0.len();
            let header = fields.counted().and_then(Header::parse);
            let data = fields.counted().map(<[u8]>::len);
            let (Some(header), Some(length)) = (header, data) else {
                // Of a bag that was cut off this is known already.
                if !self.ended {
                    losses.add(
                        self.input.place(self.chunk_start),
                        "a chunk ends within a record: the rest of the chunk is lost",
                    );
                }
                self.chunk_at = self.chunk.len();
                break;
            };
            self.chunk_at += whole - fields.0.len();
            let data = self.chunk_at - length..self.chunk_at;
            if let Some(found) = self.found(&header, data, losses) {
                return Some(found);
            }
        }
        None
    }

    /// What a record with that header is; its data is in the chunk.
    fn found(&mut self, header: &Header, data: Range<usize>, losses: &mut Losses) -> Option<(Time, Head)> {
        match header.op {
            op::CONNECTION => {
                let data = self.chunk[data].to_vec();
                self.connect(header.connection, &data, self.chunk_start, losses);
                None
            }
            op::MESSAGE => {
                let Some(channel) = self.by_connection.get(&header.connection) else {
                    let what = format!(
                        "a message belongs to connection {}, which is not declared: it is lost",
                        header.connection
                    );
                    losses.add(self.input.place(self.chunk_start), what);
                    return None;
                };
                self.message = data;
                Some((header.time, Head::Message(*channel)))
            }
            _ => None,
        }
    }

    fn connect(&mut self, connection: u32, data: &[u8], start: u64, losses: &mut Losses) {
        if self.by_connection.contains_key(&connection) || self.channels.len() >= self.limits.names {
            return;
        }
        let text = |name: &[u8]| field(data, name).map(|v| String::from_utf8_lossy(v).into_owned());
        let (Some(topic), Some(name)) = (text(b"topic"), text(b"type")) else {
            losses.add(
                self.input.place(start),
                format!("connection {connection} has no topic or no type: its messages are lost"),
            );
            return;
        };
        let definition = field(data, b"message_definition").unwrap_or_default();
        let said = Said { name: &name, encoding: "ros1msg", definition, messages: "ros1" };
        self.channels.push(Channel {
            topic: Arc::from(topic),
            type_name: normal_name(&name),
            ty: message_type(&said, &self.library),
            note: String::new(),
            messages: None,
            declared: Some(Arc::new(said.declared())),
        });
        self.by_connection.insert(connection, self.channels.len() - 1);
    }
}

fn too_large(what: &str, bytes: u64, limit: &str) -> String {
    format!("{what} has {bytes} bytes, more than the limit: raise Limits::{limit} if the file can be trusted")
}

/// What a record's header says.
#[derive(Default)]
struct Header {
    op: u8,
    connection: u32,
    time: Time,
    compression: Vec<u8>,
    /// Bytes of a chunk after decompression.
    size: u32,
    /// Where the index begins; 0 in a bag that was never closed.
    index: u64,
}

impl Header {
    fn parse(bytes: &[u8]) -> Option<Header> {
        let mut header = Header::default();
        for (name, value) in pairs(bytes) {
            let mut value = Fields(value);
            match name {
                b"op" => header.op = value.u8()?,
                b"conn" => header.connection = value.u32()?,
                b"time" => header.time = stamp(u64::from(value.u32()?) * 1_000_000_000 + u64::from(value.u32()?)),
                b"compression" => header.compression = value.0.to_vec(),
                b"size" => header.size = value.u32()?,
                b"index_pos" => header.index = value.u64()?,
                _ => {}
            }
        }
        (header.op != 0).then_some(header)
    }
}

/// The `name=value` pairs of a header, each after its length.
fn pairs(bytes: &[u8]) -> impl Iterator<Item = (&[u8], &[u8])> {
    let mut fields = Fields(bytes);
    std::iter::from_fn(move || {
        let pair = fields.counted()?;
        let equals = memchr::memchr(b'=', pair)?;
        Some((&pair[..equals], &pair[equals + 1..]))
    })
}

fn field<'a>(bytes: &'a [u8], name: &[u8]) -> Option<&'a [u8]> {
    pairs(bytes).find(|(n, _)| *n == name).map(|(_, value)| value)
}

impl Source for Bag {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn advance(&mut self, losses: &mut Losses) -> Result<Option<(Time, Head)>, ReadError> {
        loop {
            if let Some(found) = self.next_in_chunk(losses) {
                return Ok(Some(found));
            }
            if self.ended {
                if let Some(start) = self.cut.take() {
                    let what = "the bag was cut off here, or is damaged: what would follow is lost";
                    losses.add(self.input.place(start), what);
                }
                return Ok(None);
            }
            if let Some(found) = self.next_record(losses)? {
                return Ok(Some(found));
            }
        }
    }

    fn payload(&mut self) -> Result<&[u8], String> {
        Ok(self.chunk.get(self.message.clone()).unwrap_or_default())
    }

    fn place(&self) -> Place {
        Place { position: Position::Byte(self.chunk_start), ..self.input.place(0) }
    }

    fn progress(&self) -> (u64, u64) {
        (self.input.at(), self.input.len())
    }
}
