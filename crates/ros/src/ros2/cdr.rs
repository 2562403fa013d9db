//! The little of CDR that the graph's own messages need, read and written by hand: who is on the graph, and what a node's
//! types are. What a specification reads is decoded by `lapwing-record`.
//!
//! XCDR version 1, plain: DDS-XTypes 1.3, section 7.4.3.2. The bytes come from the network: every length is checked against what is left.

/// The encapsulation of little-endian plain CDR.
pub const LITTLE: [u8; 4] = [0, 1, 0, 0];

/// Bytes that are not what they should be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Malformed(pub &'static str);

/// Reads values one after the other.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    /// What follows the encapsulation: alignment counts from here.
    body: &'a [u8],
    at: usize,
    little: bool,
}

impl<'a> Reader<'a> {
    /// Of a message with its encapsulation.
    pub fn new(message: &'a [u8]) -> Result<Reader<'a>, Malformed> {
        let (head, body) = message.split_at_checked(4).ok_or(Malformed("it has no encapsulation"))?;
        let little = match head {
            [0, 0, ..] => false,
            [0, 1, ..] => true,
            _ => return Err(Malformed("it is not in plain CDR")),
        };
        Ok(Reader { body, at: 0, little })
    }

    /// So many bytes.
    pub fn bytes(&mut self, count: usize) -> Result<&'a [u8], Malformed> {
        let rest = self.body.get(self.at..).unwrap_or_default();
        let taken = rest.get(..count).ok_or(Malformed("it ends early"))?;
        self.at += count;
        Ok(taken)
    }

    /// A number of so many bytes, aligned.
    fn number<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
        self.at = self.at.next_multiple_of(N);
        let mut number = [0; N];
        number.copy_from_slice(self.bytes(N)?);
        if !self.little {
            number.reverse();
        }
        Ok(number)
    }

    /// `uint8`.
    pub fn u8(&mut self) -> Result<u8, Malformed> {
        self.number().map(u8::from_le_bytes)
    }

    /// `bool`.
    pub fn bool(&mut self) -> Result<bool, Malformed> {
        self.u8().map(|b| b != 0)
    }

    /// `uint32`.
    pub fn u32(&mut self) -> Result<u32, Malformed> {
        self.number().map(u32::from_le_bytes)
    }

    /// `uint64`.
    pub fn u64(&mut self) -> Result<u64, Malformed> {
        self.number().map(u64::from_le_bytes)
    }

    /// `string`.
    pub fn text(&mut self) -> Result<String, Malformed> {
        let length = self.u32()? as usize;
        let bytes = self.bytes(length)?;
        let text = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        std::str::from_utf8(text).map(str::to_owned).map_err(|_| Malformed("a text is not UTF-8"))
    }

    /// The elements of a sequence, each of which takes at least `least` bytes: so a count that cannot be true is
    /// refused before anything is read, and memory stays in proportion to the message.
    pub fn sequence<T>(
        &mut self,
        least: usize,
        mut element: impl FnMut(&mut Self) -> Result<T, Malformed>,
    ) -> Result<Vec<T>, Malformed> {
        let count = self.u32()? as usize;
        let left = self.body.len().saturating_sub(self.at);
        if count.saturating_mul(least.max(1)) > left {
            return Err(Malformed("a sequence is longer than the message"));
        }
        (0..count).map(|_| element(self)).collect()
    }

    /// Whether nothing is left but what pads to four bytes.
    pub fn is_done(&self) -> bool {
        self.body.len().saturating_sub(self.at) < 4
    }
}

/// Writes values one after the other, little-endian.
#[derive(Clone, Debug)]
pub struct Writer {
    message: Vec<u8>,
}

impl Default for Writer {
    fn default() -> Writer {
        Writer { message: LITTLE.to_vec() }
    }
}

impl Writer {
    /// Bytes as they are.
    pub fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        self.message.extend_from_slice(bytes);
        self
    }

    /// `bool`.
    pub fn bool(&mut self, value: bool) -> &mut Self {
        self.bytes(&[u8::from(value)])
    }

    /// `uint32`.
    pub fn u32(&mut self, value: u32) -> &mut Self {
        let body = self.message.len() - LITTLE.len();
        self.message.resize(LITTLE.len() + body.next_multiple_of(4), 0);
        self.bytes(&value.to_le_bytes())
    }

    /// `string`. What is longer than four gigabytes is cut: nothing here is.
    pub fn text(&mut self, text: &str) -> &mut Self {
        self.u32(u32::try_from(text.len() + 1).unwrap_or(u32::MAX)).bytes(text.as_bytes()).bytes(&[0])
    }

    /// The message.
    pub fn finish(self) -> Vec<u8> {
        self.message
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let mut writer = Writer::default();
        writer.text("ab").u32(7).bool(true).text("").u32(9);
        let message = writer.finish();
        assert_eq!(message.len() % 4, 0);
        let mut reader = Reader::new(&message).unwrap();
        assert_eq!(reader.text().unwrap(), "ab");
        assert_eq!(reader.u32(), Ok(7));
        assert_eq!(reader.bool(), Ok(true));
        assert_eq!(reader.text().unwrap(), "");
        assert_eq!(reader.u32(), Ok(9));
        assert!(reader.is_done());
        assert_eq!(reader.u8(), Err(Malformed("it ends early")));
    }

    #[test]
    fn both_orders_of_bytes() {
        let mut big = Reader::new(&[0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 3]).unwrap();
        assert_eq!((big.u8(), big.u32(), big.u64()), (Ok(1), Ok(2), Ok(3)));
    }

    #[test]
    fn lengths_that_cannot_be_true_are_refused() {
        let mut long = Reader::new(&[0, 1, 0, 0, 255, 255, 255, 255, 0]).unwrap();
        assert!(long.clone().text().is_err());
        assert!(long.sequence(1, Reader::u8).is_err());
        assert!(Reader::new(&[0, 1]).is_err());
        assert!(Reader::new(&[0, 7, 0, 0]).is_err());
    }
}
