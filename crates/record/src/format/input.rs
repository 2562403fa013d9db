//! A file that is read forwards, with its position and its length known: nothing is asked for that is not there.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use crate::error::{OpenError, Place, Position, ReadError};

/// Bytes read ahead.
const BUFFER: usize = 1 << 18;

/// A regular file.
#[derive(Debug)]
pub(crate) struct Input {
    file: BufReader<File>,
    path: PathBuf,
    at: u64,
    len: u64,
}

impl Input {
    /// Opens a file. `shown` is what it is called in messages: a decompressed copy goes by the name of its original.
    pub fn open(path: &Path, shown: &Path) -> Result<Input, OpenError> {
        let error = |error| OpenError::Io { path: shown.to_owned(), error };
        let file = File::open(path).map_err(error)?;
        let len = file.metadata().map_err(error)?.len();
        Ok(Input { file: BufReader::with_capacity(BUFFER, file), path: shown.to_owned(), at: 0, len })
    }

    /// The position, in bytes.
    pub fn at(&self) -> u64 {
        self.at
    }

    /// The length of the file when it was opened, in bytes.
    pub fn len(&self) -> u64 {
        self.len
    }

    /// The bytes not yet read.
    pub fn left(&self) -> u64 {
        self.len.saturating_sub(self.at)
    }

    /// A place in this file.
    pub fn place(&self, byte: u64) -> Place {
        Place::new(&self.path, Position::Byte(byte))
    }

    /// So many bytes, in place of those in `into`. The caller has made sure that they are there.
    pub fn read(&mut self, bytes: usize, into: &mut Vec<u8>) -> Result<(), ReadError> {
        into.resize(bytes, 0);
        self.read_array(into)
    }

    /// As many bytes as `into` holds.
    pub fn read_array(&mut self, into: &mut [u8]) -> Result<(), ReadError> {
        self.file.read_exact(into).map_err(|e| self.error(e))?;
        self.at += into.len() as u64;
        Ok(())
    }

    /// The next bytes, so many and no more, as a stream.
    pub fn part(&mut self, bytes: u64) -> impl Read {
        Part { input: self, left: bytes }
    }

    /// To that byte.
    pub fn seek(&mut self, to: u64) -> Result<(), ReadError> {
        let by = i128::from(to) - i128::from(self.at);
        let moved = match i64::try_from(by) {
            Ok(by) => self.file.seek_relative(by),
            Err(_) => self.file.seek(SeekFrom::Start(to)).map(drop),
        };
        moved.map_err(|e| self.error(e))?;
        self.at = to;
        Ok(())
    }

    fn error(&self, error: io::Error) -> ReadError {
        ReadError { at: self.place(self.at), error }
    }
}

/// A part of a file, read through its position.
struct Part<'i> {
    input: &'i mut Input,
    left: u64,
}

impl Read for Part<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let most = into.len().min(usize::try_from(self.left).unwrap_or(usize::MAX));
        let read = self.input.file.read(&mut into[..most])?;
        self.left -= read as u64;
        self.input.at += read as u64;
        Ok(read)
    }
}
