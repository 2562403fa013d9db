//! Lines that end in a carriage return alone, as spreadsheets on old Macs write them: they are read as if they ended as all others do.

use std::io::{self, Read};

/// What ends lines elsewhere in place of carriage returns. No byte is added or taken, so that places stay what they are.
pub(crate) struct Returns<R>(R);

impl<R: Read> Returns<R> {
    /// A stream whose beginning, which was read already, is rewritten as well.
    pub fn new(start: &mut [u8], from: R) -> Returns<R> {
        rewrite(start);
        Returns(from)
    }
}

impl<R: Read> Read for Returns<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let read = self.0.read(into)?;
        rewrite(into.get_mut(..read).unwrap_or_default());
        Ok(read)
    }
}

fn rewrite(text: &mut [u8]) {
    text.iter_mut().filter(|b| **b == b'\r').for_each(|b| *b = b'\n');
}

/// Whether the first line of a text that is not blank ends in a carriage return, after which something else comes than the end of a
/// line.
pub(crate) fn end_lines_of(text: &[u8]) -> bool {
    let text = text.trim_ascii_start();
    let end = text.iter().position(|b| matches!(b, b'\r' | b'\n'));
    end.is_some_and(|at| text[at] == b'\r' && text.get(at + 1).is_some_and(|next| *next != b'\n'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_nothing_else_ends_is_rewritten() {
        for (text, ends) in
            [("a\rb", true), (" \r\r\na\r\rb\n", true), ("a\r\nb\rc", false), ("a\nb\rc", false), ("a\r", false)]
        {
            assert_eq!(end_lines_of(text.as_bytes()), ends, "{text:?}");
        }
        let mut start = *b"a\rb";
        let mut rest = String::new();
        Returns::new(&mut start, &b"c\r\rd"[..]).read_to_string(&mut rest).unwrap();
        assert_eq!((&start, &*rest), (b"a\nb", "c\n\nd"));
    }
}
