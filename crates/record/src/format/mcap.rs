//! MCAP, read record by record. Memory is that of the largest chunk, whatever the length of the file.
//!
//! Own code rather than the `mcap` crate's reader, which stops at the first damage: here the frame around a damaged chunk
//! leads on to the next one, the offset of every loss is known, a cut-off chunk gives what it still holds, and messages of
//! unwanted topics outside of chunks are not read at all.
//!
//! Where the index of the file shows that nothing in a chunk is wanted, or nothing behind some place in it, it is read up to there
//! alone ([`index`]).
//!
//! The checksum of a chunk is checked wherever the chunk is read whole. An uncompressed one of more than a MiB, which means
//! large messages, is walked through instead, and of it only the wanted messages are read.

mod index;
mod record;
mod summary;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use lapwing_stream::Time;

use super::compression::{self, Compression, Decompressor};
use super::fields::Fields;
use super::input::Input;
use super::types::{Declared, Said, message_type};
use super::{Channel, Head, Source, stamp};
use crate::decode::MessageType;
use crate::definition::{Library, normal_name};
use crate::error::{Losses, OpenError, Place, ReadError};
use crate::options::Limits;
use index::Index;
use record::{ChunkHeader, Op, SchemaRecord};

/// The first and the last bytes of a file.
pub(crate) const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// The operation code and the length in front of every record.
const FRAME: u64 = 9;
/// Channel, sequence and two stamps in front of every message.
const MESSAGE_HEADER: usize = 22;
/// Uncompressed chunks larger than this are walked through, in bytes.
const WALKED: u64 = 1 << 20;
/// The mark of a channel number that was never declared.
const UNKNOWN: u32 = u32::MAX;

/// An MCAP file.
pub(crate) struct Mcap {
    input: Input,
    limits: Limits,
    library: Library,
    schemas: BTreeMap<u16, SchemaRecord>,
    /// Types already made, by schema and message encoding.
    types: BTreeMap<(u16, String), Typed>,
    channels: Vec<Channel>,
    /// The index of a channel by its number in the file.
    by_id: Vec<u32>,
    decompressor: Decompressor,
    packed: Vec<u8>,
    chunk: Vec<u8>,
    /// How far the chunk has been read.
    chunk_at: usize,
    /// Where the chunk stands in the file.
    chunk_start: u64,
    current: Current,
    /// The end of the chunk that is walked through, and of what follows it in its record.
    walked: Option<(u64, u64)>,
    /// Where the summary begins, if there is one and it lists all channels.
    summary: Option<u64>,
    index: Index,
    /// Whether no more messages follow.
    ended: bool,
    /// Where the file was cut off, until that is told: once all that was there before the cut has been read.
    cut: Option<u64>,
}

/// How messages are decoded, or why they cannot be, and what the file says of their type.
type Typed = (Result<MessageType, String>, Arc<Declared>);

/// Where the current message is.
enum Current {
    Nowhere,
    /// In the chunk.
    Chunk(Range<usize>),
    /// Next in the file, so many bytes.
    File(u64),
    /// In the buffer for compressed bytes, which holds nothing else between chunks.
    Buffer,
}

impl Mcap {
    /// Opens a file and finds its channels: from its summary, else by reading it through.
    pub fn open(path: &Path, shown: &Path, library: &Library, limits: &Limits) -> Result<Mcap, OpenError> {
        let mut mcap = Mcap {
            input: Input::open(path, shown)?,
            limits: limits.clone(),
            library: library.clone(),
            schemas: BTreeMap::new(),
            types: BTreeMap::new(),
            channels: Vec::new(),
            by_id: Vec::new(),
            decompressor: Decompressor::default(),
            packed: Vec::new(),
            chunk: Vec::new(),
            chunk_at: 0,
            chunk_start: 0,
            current: Current::Nowhere,
            walked: None,
            summary: None,
            index: Index::default(),
            ended: false,
            cut: None,
        };
        let found = mcap.learn().map_err(|e| OpenError::Io { path: shown.to_owned(), error: e.error });
        found.map(|()| mcap)
    }

    fn learn(&mut self) -> Result<(), ReadError> {
        if !self.read_summary()? {
            self.rewind()?;
            self.read_through()?;
        }
        self.rewind()
    }

    fn rewind(&mut self) -> Result<(), ReadError> {
        self.chunk.clear();
        self.chunk_at = 0;
        self.current = Current::Nowhere;
        self.walked = None;
        self.index.clear();
        (self.ended, self.cut) = (false, None);
        self.input.seek(MAGIC.len() as u64)
    }

    /// Reads all messages for the sake of their channels and their number.
    fn read_through(&mut self) -> Result<(), ReadError> {
        let mut losses = Losses::new(1);
        let mut counts = vec![0u64; self.channels.len()];
        while let Some((_, head)) = self.advance(&mut losses)? {
            let Head::Message(channel) = head else { continue };
            if channel >= counts.len() {
                counts.resize(channel + 1, 0);
            }
            counts[channel] += 1;
        }
        counts.resize(self.channels.len(), 0);
        for (channel, count) in self.channels.iter_mut().zip(counts) {
            channel.messages = Some(count);
        }
        Ok(())
    }

    /// The next message of the chunk that was last read.
    fn next_in_chunk(&mut self, losses: &mut Losses) -> Option<(Time, Head)> {
        while self.chunk_at < self.chunk.len() {
            let rest = &self.chunk[self.chunk_at..];
            let Some((op, body)) = record::frame(rest) else {
                // Of a file that was cut off this is known already.
                if !self.ended {
                    losses.add(
                        self.input.place(self.chunk_start),
                        "a chunk ends within a record: the rest of the chunk is lost",
                    );
                }
                self.chunk_at = self.chunk.len();
                break;
            };
            let start = self.chunk_at + FRAME as usize;
            let end = start + body.len();
            self.chunk_at = end;
            if op != Op::Message as u8 {
                let body = self.chunk[start..end].to_vec();
                self.declare(op, &body, self.chunk_start, losses);
                continue;
            }
            let Some((channel, time)) = self.message_header(start..end, losses) else { continue };
            self.index.count(channel);
            self.current = Current::Chunk(start + MESSAGE_HEADER..end);
            return Some((time, Head::Message(channel)));
        }
        None
    }

    fn message_header(&mut self, body: Range<usize>, losses: &mut Losses) -> Option<(usize, Time)> {
        let header = record::message(&self.chunk[body]);
        let known = header.and_then(|(id, time)| Some((self.channel_of(id)?, stamp(time))));
        if known.is_none() {
            losses.add(self.input.place(self.chunk_start), no_such_channel(header.map(|(id, _)| id)));
        }
        known
    }

    fn channel_of(&self, id: u16) -> Option<usize> {
        let index = *self.by_id.get(usize::from(id))?;
        (index != UNKNOWN).then_some(index as usize)
    }

    /// The next record of the file: a message, a chunk to be read, a declaration. `None` where it brought no message itself.
    fn next_record(&mut self, losses: &mut Losses) -> Result<Option<(Time, Head)>, ReadError> {
        let start = self.input.at();
        if let Some((end, after)) = self.walked
            && start + FRAME > end
        {
            self.walked = None;
            return self.input.seek(after.min(self.input.len())).map(|()| None);
        }
        if self.input.left() < FRAME {
            return Ok(self.cut_off(start));
        }
        let mut frame = [0; FRAME as usize];
        self.input.read_array(&mut frame)?;
        let op = frame[0];
        let length = Fields(&frame[1..]).u64().unwrap_or(0);
        if let Some((end, after)) = self.walked
            && (length > end.saturating_sub(self.input.at()) || !Op::is_allowed_in_chunk(op))
        {
            losses.add(self.input.place(start), "a chunk is damaged here: the rest of it is lost");
            self.walked = None;
            return self.input.seek(after.min(self.input.len())).map(|()| None);
        }
        match op {
            _ if op == Op::DataEnd as u8 || op == Op::Footer as u8 => {
                self.ended = true;
                Ok(None)
            }
            _ if op == Op::Chunk as u8 => self.read_chunk(start, length, losses).map(|()| None),
            0 => {
                losses.add(
                    self.input.place(start),
                    "no record begins here: the file is damaged, and what follows is lost",
                );
                self.ended = true;
                Ok(None)
            }
            _ if length > self.input.left() => Ok(self.cut_off(start)),
            _ if op == Op::Message as u8 => self.message_in_file(start, length, losses),
            _ => {
                self.declaration(op, start, length, losses)?;
                Ok(None)
            }
        }
    }

    fn cut_off<T>(&mut self, start: u64) -> Option<T> {
        (self.ended, self.cut) = (true, Some(start));
        None
    }

    fn message_in_file(
        &mut self,
        start: u64,
        length: u64,
        losses: &mut Losses,
    ) -> Result<Option<(Time, Head)>, ReadError> {
        let end = self.input.at() + length;
        if length < MESSAGE_HEADER as u64 {
            losses.add(self.input.place(start), "a message is shorter than its header: it is lost");
            self.input.seek(end)?;
            return Ok(None);
        }
        let mut header = [0; MESSAGE_HEADER];
        self.input.read_array(&mut header)?;
        let header = record::message(&header);
        let known = header.and_then(|(id, time)| Some((self.channel_of(id)?, stamp(time))));
        let Some((channel, time)) = known else {
            losses.add(self.input.place(start), no_such_channel(header.map(|(id, _)| id)));
            self.input.seek(end)?;
            return Ok(None);
        };
        self.chunk_start = start;
        self.index.count(channel);
        self.current = Current::File(length - MESSAGE_HEADER as u64);
        Ok(Some((time, Head::Message(channel))))
    }

    /// A record that declares something, or says nothing of messages.
    fn declaration(&mut self, op: u8, start: u64, length: u64, losses: &mut Losses) -> Result<(), ReadError> {
        let end = self.input.at() + length;
        let of_interest = op == Op::Schema as u8 || op == Op::Channel as u8;
        if of_interest && length <= self.limits.record {
            let mut body = std::mem::take(&mut self.packed);
            self.input.read(length as usize, &mut body)?;
            self.declare(op, &body, start, losses);
            self.packed = body;
            return Ok(());
        }
        if of_interest {
            losses.add(self.input.place(start), too_large("a definition", length, "record"));
        }
        self.input.seek(end)
    }

    fn declare(&mut self, op: u8, body: &[u8], start: u64, losses: &mut Losses) {
        let understood = match op {
            _ if op == Op::Schema as u8 => record::schema(body).map(|(id, schema)| {
                self.schemas.entry(id).or_insert(schema);
            }),
            _ if op == Op::Channel as u8 => self.declare_channel(body),
            _ => Some(()),
        };
        if understood.is_none() {
            losses.add(self.input.place(start), "a definition here is damaged: its topic is lost");
        }
    }

    fn declare_channel(&mut self, body: &[u8]) -> Option<()> {
        let declared = record::channel(body)?;
        if self.channel_of(declared.id).is_some() || self.channels.len() >= self.limits.names {
            return Some(());
        }
        let schema = self.schemas.get(&declared.schema);
        let key = (declared.schema, declared.encoding);
        let library = &self.library;
        let (ty, described) = self.types.entry(key).or_insert_with_key(|(_, messages)| {
            let (name, encoding, definition) =
                schema.map_or(("", "", &[][..]), |s| (&*s.name, &*s.encoding, &*s.definition));
            let said = Said { name, encoding, definition, messages };
            (message_type(&said, library), Arc::new(said.declared()))
        });
        self.channels.push(Channel {
            topic: Arc::from(declared.topic),
            type_name: schema.map(|s| normal_name(&s.name)).unwrap_or_default(),
            ty: ty.clone(),
            note: "the recording has no schema for it, or one that names no fields".to_owned(),
            messages: None,
            declared: Some(described.clone()),
        });
        let id = usize::from(declared.id);
        if self.by_id.len() <= id {
            self.by_id.resize(id + 1, UNKNOWN);
        }
        self.by_id[id] = self.channels.len() as u32 - 1;
        Some(())
    }

    /// Reads a chunk and decompresses it. A damaged one is lost; one that is cut off gives what it still holds.
    fn read_chunk(&mut self, start: u64, length: u64, losses: &mut Losses) -> Result<(), ReadError> {
        self.chunk.clear();
        self.chunk_at = 0;
        self.chunk_start = start;
        let there = length.min(self.input.left());
        let end = self.input.at() + there;
        if self.read_in_part(start, length)? {
            return Ok(());
        }
        if there == length && length > WALKED && self.walk(length)? {
            return Ok(());
        }
        if there > self.limits.chunk {
            losses.add(self.input.place(start), too_large("a chunk", length, "chunk"));
            return self.input.seek(end);
        }
        let mut packed = std::mem::take(&mut self.packed);
        self.input.read(there as usize, &mut packed)?;
        let unpacked = match ChunkHeader::parse(&packed) {
            Some((header, data)) => {
                let offset = packed.len() - data.len();
                self.unpack(&header, data, there < length).map(|how| (how, offset..offset + header.size as usize))
            }
            None => Err("its header is damaged".to_owned()),
        };
        if let Ok((Compression::None, data)) = &unpacked
            && there == length
        {
            // What is not compressed is read where it lies.
            std::mem::swap(&mut self.chunk, &mut packed);
            self.chunk.truncate(data.end);
            self.chunk_at = data.start;
        }
        self.packed = packed;
        if let Err(what) = unpacked {
            losses.add(self.input.place(start), format!("the messages of a chunk are lost: {what}"));
            self.chunk.clear();
        }
        if there < length {
            self.cut_off::<()>(start);
        }
        Ok(())
    }

    /// Goes into a chunk that is not compressed, without reading it: its records are framed as those of the file are.
    /// False, and back at its beginning, where it is compressed or damaged.
    fn walk(&mut self, length: u64) -> Result<bool, ReadError> {
        let start = self.input.at();
        let mut head = [0; ChunkHeader::UNCOMPRESSED];
        self.input.read_array(&mut head)?;
        let data = start + ChunkHeader::UNCOMPRESSED as u64;
        let fits = ChunkHeader::parse(&head).is_some_and(|(h, _)| {
            h.compression.is_empty() && h.packed == h.size && h.size <= length - ChunkHeader::UNCOMPRESSED as u64
        });
        match ChunkHeader::parse(&head) {
            Some((header, _)) if fits => self.walked = Some((data + header.size, start + length)),
            _ => self.input.seek(start)?,
        }
        Ok(fits)
    }

    fn unpack(&mut self, header: &ChunkHeader<'_>, data: &[u8], cut: bool) -> Result<Compression, String> {
        let how = Compression::of(header.compression).filter(|how| *how != Compression::Bz2).ok_or_else(|| {
            format!(
                "compression `{}` is not supported: none, lz4 and zstd are",
                String::from_utf8_lossy(header.compression)
            )
        })?;
        if header.size > self.limits.chunk {
            return Err(too_large("decompressed, it", header.size, "chunk"));
        }
        if cut {
            // What can be had of it is had; that the rest is lost is said by the caller.
            let _ = compression::part(how, data, header.size, &mut self.chunk);
            return Ok(how);
        }
        let data =
            usize::try_from(header.packed).ok().and_then(|n| data.get(..n)).ok_or("it is longer than its record")?;
        let records = match how {
            Compression::None if header.size != header.packed => {
                return Err("its two sizes differ, though it is not compressed".to_owned());
            }
            Compression::None => data,
            _ => {
                self.decompressor.whole(how, data, header.size as usize, &mut self.chunk)?;
                &self.chunk
            }
        };
        if header.crc != 0 && crc32fast::hash(records) != header.crc {
            return Err("its checksum is wrong".to_owned());
        }
        Ok(how)
    }
}

fn no_such_channel(id: Option<u16>) -> String {
    match id {
        Some(id) => format!("a message belongs to channel {id}, which is not declared before it: it is lost"),
        None => "a message is shorter than its header: it is lost".to_owned(),
    }
}

fn too_large(what: &str, bytes: u64, limit: &str) -> String {
    format!("{what} has {bytes} bytes, more than the limit: raise Limits::{limit} if the file can be trusted")
}

impl Source for Mcap {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn advance(&mut self, losses: &mut Losses) -> Result<Option<(Time, Head)>, ReadError> {
        if self.index.is_due() {
            self.find_chunks()?;
        }
        if let Current::File(unread) = self.current {
            self.input.seek(self.input.at() + unread)?;
        }
        self.current = Current::Nowhere;
        loop {
            if let Some(found) = self.next_in_chunk(losses).or_else(|| self.index.next()) {
                return Ok(Some(found));
            }
            if self.ended {
                if let Some(start) = self.cut.take() {
                    let what = "the file was cut off here, or is damaged: what would follow is lost";
                    losses.add(self.input.place(start), what);
                }
                self.check_index(losses);
                return Ok(None);
            }
            if let Some(found) = self.next_record(losses)? {
                return Ok(Some(found));
            }
        }
    }

    fn payload(&mut self) -> Result<&[u8], String> {
        if let Current::File(length) = self.current {
            if length > self.limits.record {
                return Err(too_large("it", length, "record"));
            }
            self.input.read(length as usize, &mut self.packed).map_err(|e| e.to_string())?;
            self.current = Current::Buffer;
        }
        match &self.current {
            Current::Chunk(range) => Ok(self.chunk.get(range.clone()).unwrap_or_default()),
            Current::Buffer => Ok(&self.packed),
            Current::File(_) | Current::Nowhere => Err("there is no message here".to_owned()),
        }
    }

    fn leave_out(&mut self, is_wanted: &dyn Fn(&Channel) -> bool) {
        self.index = Index::new(&self.channels, is_wanted);
    }

    fn place(&self) -> Place {
        self.input.place(self.chunk_start)
    }

    fn progress(&self) -> (u64, u64) {
        (self.input.at(), self.input.len())
    }
}
