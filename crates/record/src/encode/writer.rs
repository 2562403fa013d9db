//! Puts numbers and texts behind one another, as ROS 1 or CDR has them.

use super::{Encoded, Encoding};
use crate::definition::Prim;

/// A message does not get longer, in bytes.
const MOST_BYTES: usize = 256 << 20;
/// It does not have more array elements, counted at every depth: some take no byte.
const MOST_ELEMENTS: usize = 1 << 26;
/// Plain CDR, little-endian.
const CDR_HEAD: [u8; 4] = [0, 1, 0, 0];

/// A message being written.
pub(super) struct Writer {
    bytes: Vec<u8>,
    encoding: Encoding,
    elements: usize,
}

impl Writer {
    pub fn new(encoding: Encoding) -> Writer {
        let head: &[u8] = if encoding == Encoding::Cdr { &CDR_HEAD } else { &[] };
        Writer { bytes: head.to_vec(), encoding, elements: 0 }
    }

    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// A message without fields, which CDR has a byte for.
    pub fn nothing(&mut self) -> Encoded {
        if self.encoding == Encoding::Cdr { self.put(&[0]) } else { Ok(()) }
    }

    pub fn number(&mut self, prim: Prim, number: f64) -> Encoded {
        self.align(prim.size());
        // It was checked that it fits.
        match prim {
            Prim::Bool | Prim::U8 => self.put(&(number as u8).to_le_bytes()),
            Prim::I8 => self.put(&(number as i8).to_le_bytes()),
            Prim::I16 => self.put(&(number as i16).to_le_bytes()),
            Prim::U16 => self.put(&(number as u16).to_le_bytes()),
            Prim::I32 => self.put(&(number as i32).to_le_bytes()),
            Prim::U32 => self.put(&(number as u32).to_le_bytes()),
            Prim::I64 => self.put(&(number as i64).to_le_bytes()),
            Prim::U64 => self.put(&(number as u64).to_le_bytes()),
            Prim::F32 => self.put(&(number as f32).to_le_bytes()),
            Prim::F64 => self.put(&number.to_le_bytes()),
        }
    }

    /// A length or a count.
    pub fn length(&mut self, length: usize) -> Encoded {
        let length = u32::try_from(length).map_err(|_| format!("{length} elements are too many"))?;
        self.align(4);
        self.put(&length.to_le_bytes())
    }

    /// A text. CDR counts a zero byte at its end, ROS 1 has none.
    pub fn text(&mut self, text: &str) -> Encoded {
        let end: &[u8] = if self.encoding == Encoding::Cdr { &[0] } else { &[] };
        self.length(text.len() + end.len())?;
        self.put(text.as_bytes())?;
        self.put(end)
    }

    /// A wide text: the number of its UTF-16 units, then these.
    pub fn wide_text(&mut self, text: &str) -> Encoded {
        self.length(text.encode_utf16().count())?;
        text.encode_utf16().try_for_each(|unit| self.put(&unit.to_le_bytes()))
    }

    /// Counts array elements against the limit.
    pub fn spend(&mut self, elements: usize) -> Encoded {
        self.elements = self.elements.saturating_add(elements);
        if self.elements > MOST_ELEMENTS {
            return Err(format!("the message has more than {MOST_ELEMENTS} array elements"));
        }
        Ok(())
    }

    fn align(&mut self, size: usize) {
        if self.encoding == Encoding::Cdr {
            let body = self.bytes.len() - CDR_HEAD.len();
            self.bytes.resize(CDR_HEAD.len() + body.next_multiple_of(size), 0);
        }
    }

    fn put(&mut self, bytes: &[u8]) -> Encoded {
        if self.bytes.len() + bytes.len() > MOST_BYTES {
            return Err(format!("the message gets longer than {MOST_BYTES} bytes"));
        }
        self.bytes.extend_from_slice(bytes);
        Ok(())
    }
}
