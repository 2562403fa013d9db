//! The summary at the end of an MCAP file: its channels without reading its messages.

use super::super::fields::Fields;
use super::record::{self, Op};
use super::{FRAME, MAGIC, Mcap};
use crate::error::{Losses, ReadError};

/// The bytes of a footer: two offsets and a checksum.
const FOOTER: u64 = 20;

impl Mcap {
    /// Reads the channels from the summary. False where there is none, or it does not list all channels.
    pub(super) fn read_summary(&mut self) -> Result<bool, ReadError> {
        let Some(start) = self.summary_start()? else { return Ok(false) };
        self.summary = Some(start);
        self.input.seek(start)?;
        // Whatever is wrong here is found again, and noted, when the file is read.
        let mut losses = Losses::new(1);
        let mut statistics = None;
        while self.input.left() >= FRAME {
            let mut frame = [0; FRAME as usize];
            self.input.read_array(&mut frame)?;
            let (op, length) = (frame[0], Fields(&frame[1..]).u64().unwrap_or(u64::MAX));
            if op == Op::Footer as u8 || length > self.input.left() {
                break;
            }
            if op == Op::Statistics as u8 && length <= self.limits.record {
                let mut body = Vec::new();
                self.input.read(length as usize, &mut body)?;
                statistics = record::statistics(&body);
            } else {
                self.declaration(op, start, length, &mut losses)?;
            }
        }
        let Some((channels, counts)) = statistics else {
            self.summary = None;
            return Ok(false);
        };
        for (id, count) in counts {
            if let Some(channel) = self.channel_of(id) {
                self.channels[channel].messages = Some(count);
            }
        }
        let is_whole = self.channels.len() as u64 >= u64::from(channels).min(self.limits.names as u64);
        self.summary = self.summary.filter(|_| is_whole);
        Ok(is_whole)
    }

    /// Where the summary begins, as the last bytes of the file say.
    fn summary_start(&mut self) -> Result<Option<u64>, ReadError> {
        let tail = FRAME + FOOTER + MAGIC.len() as u64;
        let Some(at) = self.input.len().checked_sub(tail) else { return Ok(None) };
        self.input.seek(at)?;
        let mut bytes = Vec::new();
        self.input.read(tail as usize, &mut bytes)?;
        let footer = bytes.strip_suffix(MAGIC).and_then(record::frame).filter(|(op, _)| *op == Op::Footer as u8);
        let start = footer.and_then(|(_, body)| Fields(body).u64());
        Ok(start.filter(|start| *start >= MAGIC.len() as u64 && *start < at))
    }
}
