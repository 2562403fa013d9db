//! The records of MCAP that say something of messages. `None` is a record too short for what it promises.

use super::super::fields::Fields;

/// The operation codes of those records.
#[derive(Clone, Copy)]
pub(super) enum Op {
    Footer = 0x02,
    Schema = 0x03,
    Channel = 0x04,
    Message = 0x05,
    Chunk = 0x06,
    MessageIndex = 0x07,
    ChunkIndex = 0x08,
    Statistics = 0x0b,
    DataEnd = 0x0f,
}

impl Op {
    /// Whether a record of that code may stand within a chunk.
    pub fn is_allowed_in_chunk(op: u8) -> bool {
        [Op::Schema, Op::Channel, Op::Message].iter().any(|allowed| *allowed as u8 == op)
    }
}

/// The operation code and the body of the record at the beginning of `bytes`.
pub(super) fn frame(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let mut fields = Fields(bytes);
    let op = fields.u8()?;
    let length = usize::try_from(fields.u64()?).ok()?;
    Some((op, fields.take(length)?))
}

/// The channel and the log time of a message.
pub(super) fn message(body: &[u8]) -> Option<(u16, u64)> {
    let mut fields = Fields(body.get(..super::MESSAGE_HEADER)?);
    let (channel, _sequence, time) = (fields.u16()?, fields.u32()?, fields.u64()?);
    Some((channel, time))
}

/// A type.
pub(super) struct SchemaRecord {
    pub name: String,
    pub encoding: String,
    pub definition: Vec<u8>,
}

/// A type and its number.
pub(super) fn schema(body: &[u8]) -> Option<(u16, SchemaRecord)> {
    let mut fields = Fields(body);
    let id = fields.u16()?;
    let (name, encoding) = (fields.text()?, fields.text()?);
    Some((id, SchemaRecord { name, encoding, definition: fields.counted()?.to_vec() }))
}

/// A topic.
pub(super) struct ChannelRecord {
    pub id: u16,
    pub schema: u16,
    pub topic: String,
    pub encoding: String,
}

pub(super) fn channel(body: &[u8]) -> Option<ChannelRecord> {
    let mut fields = Fields(body);
    Some(ChannelRecord { id: fields.u16()?, schema: fields.u16()?, topic: fields.text()?, encoding: fields.text()? })
}

/// What stands before the compressed bytes of a chunk.
pub(super) struct ChunkHeader<'a> {
    /// Bytes after decompression.
    pub size: u64,
    /// The checksum of these; 0 is none.
    pub crc: u32,
    pub compression: &'a [u8],
    /// Bytes before decompression.
    pub packed: u64,
}

impl ChunkHeader<'_> {
    /// The bytes of a header that names no compression.
    pub const UNCOMPRESSED: usize = 8 + 8 + 8 + 4 + 4 + 8;

    /// The header and what follows it.
    pub fn parse(body: &[u8]) -> Option<(ChunkHeader<'_>, &[u8])> {
        let mut fields = Fields(body);
        let (_first, _last) = (fields.u64()?, fields.u64()?);
        let (size, crc) = (fields.u64()?, fields.u32()?);
        let compression = fields.counted()?;
        let packed = fields.u64()?;
        Some((ChunkHeader { size, crc, compression, packed }, fields.0))
    }
}

/// How many messages each channel has, and how many channels there are.
pub(super) fn statistics(body: &[u8]) -> Option<(u32, Vec<(u16, u64)>)> {
    let mut fields = Fields(body);
    let (_messages, _schemas, channels) = (fields.u64()?, fields.u16()?, fields.u32()?);
    fields.take(4 + 4 + 4 + 8 + 8)?;
    let mut pairs = Fields(fields.counted()?);
    let mut counts = Vec::new();
    while let (Some(channel), Some(count)) = (pairs.u16(), pairs.u64()) {
        counts.push((channel, count));
    }
    Some((channels, counts))
}

/// What the summary says of a chunk.
pub(super) struct ChunkIndex {
    /// Where its record stands in the file.
    pub start: u64,
    /// Those that it has messages of.
    pub channels: Vec<u16>,
    /// Whether it is not compressed.
    pub is_plain: bool,
    /// Bytes before compression.
    pub size: u64,
}

pub(super) fn chunk_index(body: &[u8]) -> Option<ChunkIndex> {
    let mut fields = Fields(body);
    let (_first, _last) = (fields.u64()?, fields.u64()?);
    let (start, _length) = (fields.u64()?, fields.u64()?);
    let mut offsets = Fields(fields.counted()?);
    let mut channels = Vec::new();
    while let (Some(channel), Some(_offset)) = (offsets.u16(), offsets.u64()) {
        channels.push(channel);
    }
    let (_index_length, compression, _packed, size) = (fields.u64()?, fields.counted()?, fields.u64()?, fields.u64()?);
    Some(ChunkIndex { start, channels, is_plain: compression.is_empty(), size })
}

/// A channel, and the times and offsets of its messages in a chunk.
pub(super) fn message_index(body: &[u8]) -> Option<(u16, Vec<(u64, u64)>)> {
    let mut fields = Fields(body);
    let channel = fields.u16()?;
    let mut pairs = Fields(fields.counted()?);
    let mut entries = Vec::new();
    while let (Some(time), Some(offset)) = (pairs.u64(), pairs.u64()) {
        entries.push((time, offset));
    }
    Some((channel, entries))
}
