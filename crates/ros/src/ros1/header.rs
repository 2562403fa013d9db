//! The header with which a TCPROS connection begins: `name=value`, each with its length in front, and the length of all before that.

use std::fmt;
use std::io::{self, ErrorKind, Read};

/// A header is not longer, in bytes: the definition of the largest message is in it.
pub(crate) const MOST_BYTES: usize = 4 << 20;
/// It does not have more fields.
const MOST_FIELDS: usize = 256;

/// The fields of a header.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Header {
    fields: Vec<(String, String)>,
}

/// Bytes that are no header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Malformed(String);

impl fmt::Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "its connection header is malformed: {}", self.0)
    }
}

impl From<Malformed> for io::Error {
    fn from(error: Malformed) -> io::Error {
        io::Error::new(ErrorKind::InvalidData, error.to_string())
    }
}

impl Header {
    /// A header with those fields.
    pub fn of(fields: &[(&str, &str)]) -> Header {
        let owned = |(name, value): &(&str, &str)| ((*name).to_owned(), (*value).to_owned());
        Header { fields: fields.iter().map(owned).collect() }
    }

    /// The value of the field of that name, where there is one.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.fields.iter().find(|(n, _)| n == name).map(|(_, value)| value.as_str())
    }

    /// The value of a field without which nothing goes on.
    pub fn need(&self, name: &str) -> Result<&str, Malformed> {
        self.get(name).ok_or_else(|| Malformed(format!("it has no field `{name}`")))
    }

    /// Reads one as it comes over a connection.
    pub fn read(from: &mut impl Read) -> io::Result<Header> {
        let mut length = [0; 4];
        from.read_exact(&mut length).map_err(early)?;
        let length = u32::from_le_bytes(length) as usize;
        if length > MOST_BYTES {
            return Err(Malformed(format!("it is to have {length} bytes, and {MOST_BYTES} is the most")).into());
        }
        let mut bytes = Vec::new();
        from.take(length as u64).read_to_end(&mut bytes)?;
        if bytes.len() < length {
            return Err(early(ErrorKind::UnexpectedEof.into()));
        }
        Ok(Header::parse(&bytes)?)
    }

    /// Reads one without the length in front.
    pub fn parse(mut bytes: &[u8]) -> Result<Header, Malformed> {
        let malformed = |what: &str| Malformed(what.to_owned());
        let mut fields = Vec::new();
        while !bytes.is_empty() {
            let (length, rest) = bytes.split_first_chunk().ok_or_else(|| malformed("it ends within a length"))?;
            let length = u32::from_le_bytes(*length) as usize;
            let (field, rest) = rest.split_at_checked(length).ok_or_else(|| malformed("a field is longer than it"))?;
            // Not every publisher writes UTF-8 into the comments of a definition.
            let field = String::from_utf8_lossy(field);
            let (name, value) = field.split_once('=').ok_or_else(|| malformed("a field has no equals sign"))?;
            if fields.len() >= MOST_FIELDS {
                return Err(malformed("it has too many fields"));
            }
            fields.push((name.to_owned(), value.to_owned()));
            bytes = rest;
        }
        Ok(Header { fields })
    }

    /// Its bytes, with the length in front.
    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = vec![0; 4];
        for (name, value) in &self.fields {
            bytes.extend(length(name.len() + 1 + value.len()));
            bytes.extend(name.bytes().chain([b'=']).chain(value.bytes()));
        }
        let whole = length(bytes.len() - 4);
        bytes.splice(..4, whole);
        bytes
    }
}

fn length(bytes: usize) -> [u8; 4] {
    u32::try_from(bytes).unwrap_or(u32::MAX).to_le_bytes()
}

fn early(error: io::Error) -> io::Error {
    match error.kind() {
        ErrorKind::UnexpectedEof => {
            io::Error::new(ErrorKind::UnexpectedEof, "it closed the connection within its header")
        }
        _ => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let header = Header::of(&[("topic", "/odom"), ("message_definition", "a=b\nc"), ("empty", "")]);
        let bytes = header.bytes();
        assert_eq!(Header::read(&mut &bytes[..]).unwrap(), header);
        assert_eq!(header.get("message_definition"), Some("a=b\nc"));
        assert!(header.need("md5sum").unwrap_err().to_string().contains("`md5sum`"));
    }

    #[test]
    fn lies_about_lengths_are_refused() {
        for (bytes, why) in [
            (&[255, 255, 255, 255][..], "is the most"),
            (&[1, 0][..], "within its header"),
            (&[10, 0, 0, 0, 6, 0, 0, 0, b'a', b'='][..], "within its header"),
            (&[6, 0, 0, 0, 6, 0, 0, 0, b'a', b'='][..], "longer than it"),
            (&[2, 0, 0, 0, 6, 0][..], "within a length"),
            (&[5, 0, 0, 0, 1, 0, 0, 0, b'a'][..], "no equals sign"),
        ] {
            let error = Header::read(&mut &bytes[..]).unwrap_err().to_string();
            assert!(error.contains(why), "{bytes:?}: {error}");
        }
        let many = Header { fields: vec![("a".to_owned(), "b".to_owned()); 300] };
        assert!(Header::read(&mut &many.bytes()[..]).is_err());
    }
}
