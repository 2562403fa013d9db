//! The text of a file. What is no UTF-8 is told with its place, since editors show it as if nothing were wrong.

use std::io;
use std::path::Path;

/// Reads a file. The error says what is wrong with it, but not the name of the file.
pub fn read_text(path: &Path) -> io::Result<String> {
    text(std::fs::read(path)?)
}

/// What was read, as text.
pub fn text(bytes: Vec<u8>) -> io::Result<String> {
    let invalid = |what: String| io::Error::new(io::ErrorKind::InvalidData, what);
    if is_utf16(&bytes) {
        return Err(invalid("it is UTF-16 text; save it as UTF-8".to_owned()));
    }
    String::from_utf8(bytes).map_err(|error| {
        let (before, rest) = error.as_bytes().split_at(error.utf8_error().valid_up_to());
        let line = before.iter().filter(|b| **b == b'\n').count() + 1;
        let in_line = before.rsplit(|b| *b == b'\n').next().unwrap_or_default();
        let column = String::from_utf8_lossy(in_line).chars().count() + 1;
        let wrong = rest.first().copied().unwrap_or_default();
        invalid(format!("line {line}, column {column}: the byte 0x{wrong:02x} is not UTF-8; save the file as UTF-8"))
    })
}

/// Whether it begins with the mark of UTF-16, or with a character of ASCII in two bytes.
fn is_utf16(bytes: &[u8]) -> bool {
    match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => true,
        [a, b, ..] => (*a == 0) != (*b == 0) && (a | b).is_ascii(),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wrong(bytes: &[u8]) -> String {
        text(bytes.to_vec()).unwrap_err().to_string()
    }

    #[test]
    fn what_is_no_text_is_told_with_its_place() {
        assert_eq!(text("né\u{feff}ver\n".into()).unwrap(), "né\u{feff}ver\n");
        assert!(wrong(b"a\n# \xc3\xa9 caf\xe9 b\n\xff").starts_with("line 2, column 8: the byte 0xe9 is not UTF-8"));
        assert!(wrong(b"\xc3").starts_with("line 1, column 1: the byte 0xc3"));
    }

    #[test]
    fn utf16_is_told_in_both_orders_with_a_mark_and_without() {
        for text in ["\u{feff}# ä\n", "# ä\n"] {
            for order in [u16::to_le_bytes, u16::to_be_bytes] {
                let bytes: Vec<u8> = text.encode_utf16().flat_map(order).collect();
                assert_eq!(wrong(&bytes), "it is UTF-16 text; save it as UTF-8");
            }
        }
    }
}
