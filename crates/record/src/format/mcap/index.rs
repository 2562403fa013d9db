//! The index of an MCAP file: which chunks, or ends of chunks, hold nothing that is wanted, so that nobody decompresses them.
//!
//! The summary says which channels each chunk has messages of; behind the chunk stand, for each of these, the times and the offsets of its
//! messages. That is all that is given of unwanted messages anyway. An index can lie. Where its times do not fit those of the chunk it
//! is not believed, and where messages of a wanted channel are missing in the end, against what the statistics of the file
//! promise, they are reported as lost.

use super::super::compression::{self, Compression};
use super::super::fields::Fields;
use super::super::{Channel, stamp};
use super::record::{self, ChunkHeader, Op};
use super::{FRAME, Head, Losses, Mcap, ReadError, Time, WALKED};

/// At most so many chunks are remembered; further ones are read whole.
const MOST: usize = 1 << 20;
/// The least that a message takes in a chunk, in bytes.
const LEAST_MESSAGE: u64 = 31;
/// No compression has a longer name, in bytes.
const LONGEST_NAME: u32 = 16;

/// What is known of messages without reading them.
#[derive(Debug, Default)]
pub(super) struct Index {
    /// Whether the messages of each channel are wanted; what is beyond them is.
    unwanted: Vec<bool>,
    /// Where the chunks stand that may be left out, at least in part; ascending.
    chunks: Vec<u64>,
    /// Messages of the current chunk that are left out, the first last.
    left_out: Vec<Entry>,
    /// Whether anything was left out so far.
    is_used: bool,
    /// How many messages were read, by channel.
    read: Vec<u64>,
    /// Whether the chunks are still to be looked for.
    is_due: bool,
}

/// A message as the index knows it.
#[derive(Clone, Copy, Debug)]
struct Entry {
    /// Where it stands in its chunk, uncompressed.
    offset: u64,
    channel: usize,
    time: u64,
}

impl Index {
    /// Of a file with those channels, only some of which are wanted.
    pub fn new(channels: &[Channel], is_wanted: &dyn Fn(&Channel) -> bool) -> Index {
        let unwanted: Vec<bool> = channels.iter().map(|channel| !is_wanted(channel)).collect();
        Index { is_due: unwanted.contains(&true), read: vec![0; unwanted.len()], unwanted, ..Index::default() }
    }

    /// Whether the chunks are still to be looked for; the second time it is answered they are not.
    #[inline]
    pub fn is_due(&mut self) -> bool {
        std::mem::take(&mut self.is_due)
    }

    fn is_unwanted(&self, channel: usize) -> bool {
        self.unwanted.get(channel).copied().unwrap_or_default()
    }

    /// A message was read.
    #[inline]
    pub fn count(&mut self, channel: usize) {
        if let Some(read) = self.read.get_mut(channel) {
            *read += 1;
        }
    }

    /// The next message that was left out.
    pub fn next(&mut self) -> Option<(Time, Head)> {
        let entry = self.left_out.pop()?;
        self.count(entry.channel);
        Some((stamp(entry.time), Head::Message(entry.channel)))
    }

    /// Nothing of the current chunk is left out.
    pub fn clear(&mut self) {
        self.left_out.clear();
    }
}

impl Mcap {
    /// Looks for chunks that need not be read whole.
    pub(super) fn find_chunks(&mut self) -> Result<(), ReadError> {
        let Some(start) = self.summary else { return Ok(()) };
        self.input.seek(start)?;
        let mut body = Vec::new();
        while let Some((op, length)) = self.next_frame()? {
            let end = self.input.at() + length;
            if op == Op::ChunkIndex as u8 && length <= self.limits.record && self.index.chunks.len() < MOST {
                self.input.read(length as usize, &mut body)?;
                let chunk = record::chunk_index(&body).filter(|chunk| self.can_leave_out(chunk));
                self.index.chunks.extend(chunk.map(|chunk| chunk.start));
            }
            self.input.seek(end)?;
        }
        self.index.chunks.sort_unstable();
        self.rewind()
    }

    /// The operation code and the length of the next record, if that is there as a whole.
    fn next_frame(&mut self) -> Result<Option<(u8, u64)>, ReadError> {
        if self.input.left() < FRAME {
            return Ok(None);
        }
        let mut frame = [0; FRAME as usize];
        self.input.read_array(&mut frame)?;
        let length = Fields(&frame[1..]).u64().unwrap_or(u64::MAX);
        Ok((length <= self.input.left()).then_some((frame[0], length)))
    }

    /// Whether a chunk is worth a look into its index: nothing in it is wanted, or it holds large messages, not all of which are.
    fn can_leave_out(&self, chunk: &record::ChunkIndex) -> bool {
        let unwanted = |id: &u16| self.channel_of(*id).is_some_and(|channel| self.index.is_unwanted(channel));
        let count = chunk.channels.iter().filter(|id| unwanted(id)).count();
        count > 0 && (count == chunk.channels.len() || !chunk.is_plain && chunk.size > WALKED)
    }

    /// Reads of a chunk only as much as is wanted. False, and back at the beginning of its record, where that has to be all of it.
    pub(super) fn read_in_part(&mut self, start: u64, length: u64) -> Result<bool, ReadError> {
        self.index.clear();
        if self.index.chunks.binary_search(&start).is_err() || length > self.input.left() {
            return Ok(false);
        }
        let body = self.input.at();
        let is_read = match self.entries(body, length)? {
            Some(size) => self.read_beginning(body, length, size)?,
            None => false,
        };
        if is_read {
            self.index.is_used = true;
            self.input.seek(body + length)?;
        } else {
            self.index.clear();
            self.chunk.clear();
            self.input.seek(body)?;
        }
        Ok(is_read)
    }

    /// Reads what stands behind a chunk of its messages, the first last. Gives the bytes of the chunk before compression; `None` where
    /// the index does not fit the chunk.
    fn entries(&mut self, body: u64, length: u64) -> Result<Option<u64>, ReadError> {
        let mut head = [0; ChunkHeader::UNCOMPRESSED];
        if length < head.len() as u64 {
            return Ok(None);
        }
        self.input.read_array(&mut head)?;
        let mut fields = Fields(&head);
        let (Some(first), Some(last), Some(size)) = (fields.u64(), fields.u64(), fields.u64()) else { return Ok(None) };
        self.input.seek(body + length)?;
        let mut bytes = Vec::new();
        while let Some((op, length)) = self.next_frame()? {
            if op != Op::MessageIndex as u8 || length > self.limits.record {
                break;
            }
            self.input.read(length as usize, &mut bytes)?;
            if self.take_entries(&bytes, size).is_none() {
                return Ok(None);
            }
        }
        let entries = &mut self.index.left_out;
        entries.sort_unstable_by_key(|entry| std::cmp::Reverse(entry.offset));
        let times = || entries.iter().map(|entry| entry.time);
        Ok((times().min() == Some(first) && times().max() == Some(last)).then_some(size))
    }

    fn take_entries(&mut self, bytes: &[u8], size: u64) -> Option<()> {
        let (id, entries) = record::message_index(bytes)?;
        let channel = self.channel_of(id)?;
        for (time, offset) in entries {
            if offset >= size || self.index.left_out.len() as u64 > size / LEAST_MESSAGE {
                return None;
            }
            self.index.left_out.push(Entry { offset, channel, time });
        }
        Some(())
    }

    /// Reads a chunk up to its last wanted message. False where that is not worth while, or cannot be done.
    fn read_beginning(&mut self, body: u64, length: u64, size: u64) -> Result<bool, ReadError> {
        let is_wanted = |entry: &Entry| !self.index.is_unwanted(entry.channel);
        let all = self.index.left_out.len();
        let after = self.index.left_out.iter().position(is_wanted).unwrap_or(all);
        self.index.left_out.truncate(after);
        let Some(first) = self.index.left_out.last() else { return Ok(false) };
        // Where nothing is wanted, declarations before the first message need not be read either: the summary has them.
        let end = if after == all { 0 } else { first.offset };
        if end > 0 && size - end <= WALKED || end > self.limits.chunk {
            return Ok(false);
        }
        self.input.seek(body)?;
        Ok(end == 0 || self.decompress_beginning(body + length, end)?)
    }

    /// Decompresses so many bytes of the chunk whose record begins here, and ends at `after`. False where that fails.
    fn decompress_beginning(&mut self, after: u64, end: u64) -> Result<bool, ReadError> {
        let mut head = [0; ChunkHeader::UNCOMPRESSED - 8];
        self.input.read_array(&mut head)?;
        let name = Fields(&head[head.len() - 4..]).u32().filter(|length| *length <= LONGEST_NAME);
        let Some(name) = name else { return Ok(false) };
        let mut rest = vec![0; name as usize + 8];
        if self.input.at() + rest.len() as u64 > after {
            return Ok(false);
        }
        self.input.read_array(&mut rest)?;
        let (name, packed) = rest.split_at(name as usize);
        let how = Compression::of(name).filter(|how| !matches!(how, Compression::None | Compression::Bz2));
        let (Some(how), Some(packed)) = (how, Fields(packed).u64()) else { return Ok(false) };
        let packed = packed.min(after - self.input.at());
        let done = compression::part(how, self.input.part(packed), end, &mut self.chunk);
        Ok(done.is_ok() && self.chunk.len() as u64 == end)
    }

    /// At the end of the file: whether all wanted messages that it promises were read. What is lost elsewhere was said already.
    pub(super) fn check_index(&mut self, losses: &mut Losses) {
        if !std::mem::take(&mut self.index.is_used) || !losses.list().is_empty() {
            return;
        }
        for (number, (channel, read)) in self.channels.iter().zip(&self.index.read).enumerate() {
            let promised = channel.messages.unwrap_or_default();
            if *read < promised && !self.index.is_unwanted(number) {
                let what =
                    format!("the file says that it has {promised} messages, and {read} were found: its index is wrong");
                losses.add_of(self.input.place(self.chunk_start), &channel.topic, what);
            }
        }
    }
}
