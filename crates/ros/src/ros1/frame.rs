//! Messages on a TCPROS connection, each behind its length.

use std::io::{self, ErrorKind, Read};

use bytes::Bytes;

/// A message is not longer, in bytes.
pub(crate) const MOST_BYTES: usize = 256 << 20;
/// No more is asked of memory before that much has really come.
const STEP: usize = 1 << 20;

/// The next message; nothing where the connection ended between two.
pub(crate) fn read(from: &mut impl Read) -> io::Result<Option<Bytes>> {
    let mut length = [0; 4];
    let mut have = 0;
    while have < length.len() {
        match from.read(&mut length[have..]) {
            Ok(0) if have == 0 => return Ok(None),
            Ok(0) => return Err(broken()),
            Ok(more) => have += more,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    body(from, u32::from_le_bytes(length)).map(Some)
}

/// So many bytes.
pub(crate) fn body(from: &mut impl Read, length: u32) -> io::Result<Bytes> {
    let length = length as usize;
    if length > MOST_BYTES {
        let what = format!("it announces a message of {length} bytes, and {MOST_BYTES} is the most");
        return Err(io::Error::new(ErrorKind::InvalidData, what));
    }
    let mut message = Vec::with_capacity(length.min(STEP));
    from.take(length as u64).read_to_end(&mut message)?;
    if message.len() < length { Err(broken()) } else { Ok(Bytes::from(message)) }
}

/// A message behind its length.
pub(crate) fn write(payload: &[u8]) -> Bytes {
    let mut framed = Vec::with_capacity(payload.len() + 4);
    framed.extend(u32::try_from(payload.len()).unwrap_or(u32::MAX).to_le_bytes());
    framed.extend(payload);
    Bytes::from(framed)
}

fn broken() -> io::Error {
    io::Error::new(ErrorKind::UnexpectedEof, "its connection broke within a message")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_come_one_after_the_other_until_the_end() {
        let mut bytes = [write(b"one"), write(b""), write(&[7; 3000])].concat();
        let mut from = &bytes[..];
        let lengths: Vec<usize> = std::iter::from_fn(|| read(&mut from).unwrap()).map(|m| m.len()).collect();
        assert_eq!(lengths, [3, 0, 3000]);
        bytes.truncate(20);
        let mut from = &bytes[..];
        assert!(read(&mut from).unwrap().is_some() && read(&mut from).unwrap().is_some());
        assert!(read(&mut from).unwrap_err().to_string().contains("within a message"));
        assert!(read(&mut &[1, 0][..]).is_err());
        assert!(read(&mut &[255; 8][..]).unwrap_err().to_string().contains("is the most"));
    }
}
