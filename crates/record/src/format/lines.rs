//! Lines of a stream that may still grow: each is given as soon as it is whole.

use std::io::{self, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::error::{Place, Position, ReadError};

/// Bytes asked for at a time.
const BUFFER: usize = 1 << 17;

/// The mark that some programs write before a text in UTF-8.
const MARK: &[u8] = "\u{feff}".as_bytes();

/// Lines, numbered from 1.
pub(crate) struct Lines {
    from: Box<dyn Read + Send>,
    path: PathBuf,
    buffer: Vec<u8>,
    /// What of the buffer is filled and not yet given away.
    ready: Range<usize>,
    number: u64,
    done: u64,
    total: u64,
    limit: usize,
    ended: bool,
}

/// A line of the stream.
#[derive(Debug, PartialEq)]
pub(crate) enum Line {
    /// Where it is in the buffer, without its end.
    Found(Range<usize>),
    /// It is longer than the limit and was passed over.
    TooLong,
    /// There is no other.
    End,
}

impl Lines {
    /// The lines of a stream of `total` bytes, 0 where that is not known.
    pub fn new(from: Box<dyn Read + Send>, path: &Path, total: u64, limit: usize) -> Lines {
        Lines {
            from,
            path: path.to_owned(),
            buffer: Vec::new(),
            ready: 0..0,
            number: 0,
            done: 0,
            total,
            limit,
            ended: false,
        }
    }

    /// The bytes of a line that was just found.
    pub fn bytes(&self, line: &Range<usize>) -> &[u8] {
        self.buffer.get(line.clone()).unwrap_or_default()
    }

    /// What was read and not yet given away: any number of lines, and the beginning of one.
    #[inline]
    pub fn ready(&self) -> &[u8] {
        self.buffer.get(self.ready.clone()).unwrap_or_default()
    }

    /// Gives the next line away, which takes so many bytes, its end included.
    #[inline]
    pub fn pass(&mut self, length: usize) {
        self.ready.start = self.ready.end.min(self.ready.start + length);
        self.number += 1;
        self.done += length as u64;
    }

    /// The next line. It may be looked at until the next call.
    pub fn next(&mut self) -> Result<Line, ReadError> {
        let mut looked = 0;
        loop {
            let rest = &self.buffer[self.ready.start + looked..self.ready.end];
            if let Some(at) = memchr::memchr(b'\n', rest) {
                return Ok(Line::Found(self.give(looked + at, 1)));
            }
            looked = self.ready.len();
            if self.ended {
                return Ok(if looked == 0 { Line::End } else { Line::Found(self.give(looked, 0)) });
            }
            if looked > self.limit {
                self.pass_over()?;
                return Ok(Line::TooLong);
            }
            self.fill()?;
        }
    }

    /// Gives a line of that length away, with what ends it; a mark in front of the first one is no part of it.
    fn give(&mut self, length: usize, end: usize) -> Range<usize> {
        let start = self.ready.start;
        self.ready.start += length + end;
        self.number += 1;
        self.done += (length + end) as u64;
        let mut line = start..start + length;
        if self.buffer[line.clone()].ends_with(b"\r") {
            line.end -= 1;
        }
        if self.number == 1 && self.buffer[line.clone()].starts_with(MARK) {
            line.start += MARK.len();
        }
        line
    }

    /// To the end of a line that is too long, holding none of it.
    fn pass_over(&mut self) -> Result<(), ReadError> {
        self.number += 1;
        loop {
            let rest = &self.buffer[self.ready.clone()];
            if let Some(at) = memchr::memchr(b'\n', rest) {
                self.done += at as u64 + 1;
                self.ready.start += at + 1;
                return Ok(());
            }
            self.done += rest.len() as u64;
            self.ready = 0..0;
            if self.ended {
                return Ok(());
            }
            self.fill()?;
        }
    }

    fn fill(&mut self) -> Result<(), ReadError> {
        if self.ready.start > 0 {
            self.buffer.copy_within(self.ready.clone(), 0);
            self.ready = 0..self.ready.len();
        }
        if self.buffer.len() - self.ready.end < BUFFER {
            self.buffer.resize((self.ready.end + BUFFER).max(self.buffer.len()).next_power_of_two(), 0);
        }
        loop {
            match self.from.read(&mut self.buffer[self.ready.end..]) {
                Ok(0) => self.ended = true,
                Ok(read) => self.ready.end += read,
                Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(ReadError { at: self.place(0), error }),
            }
            return Ok(());
        }
    }

    /// A place in the current line; column 0 is the line as a whole.
    pub fn place(&self, column: u64) -> Place {
        Place::new(&self.path, Position::Line { line: self.number, column })
    }

    /// Bytes given away, and bytes in all.
    pub fn progress(&self) -> (u64, u64) {
        (self.done, self.total)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives one byte at a time, as a slow pipe does.
    struct Drip(io::Cursor<Vec<u8>>);

    impl Read for Drip {
        fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
            let one = into.len().min(1);
            self.0.read(&mut into[..one])
        }
    }

    #[test]
    fn lines_come_whole_and_numbered() {
        let text = "\u{feff}a\r\n\nbcd\nlast".as_bytes().to_vec();
        let mut lines = Lines::new(Box::new(Drip(io::Cursor::new(text))), Path::new("-"), 0, 100);
        let mut got = Vec::new();
        while let Line::Found(line) = lines.next().unwrap() {
            got.push(String::from_utf8_lossy(lines.bytes(&line)).into_owned());
        }
        assert_eq!(got, ["a", "", "bcd", "last"]);
        assert_eq!(lines.place(0).to_string(), "-, line 4");
    }

    #[test]
    fn a_line_beyond_the_limit_is_passed_over() {
        let text = format!("a\n{}\nb\n", "x".repeat(1_000_000)).into_bytes();
        let mut lines = Lines::new(Box::new(io::Cursor::new(text)), Path::new("-"), 0, 1000);
        assert!(matches!(lines.next().unwrap(), Line::Found(_)));
        assert_eq!(lines.next().unwrap(), Line::TooLong);
        let Line::Found(b) = lines.next().unwrap() else { panic!() };
        assert_eq!(lines.bytes(&b), b"b");
        assert_eq!(lines.next().unwrap(), Line::End);
        assert!(lines.buffer.len() < 1_000_000);
    }
}
