//! Recognises a recording by its first bytes and opens it.

use std::fs::{self, File};
use std::io::{self, Cursor, Read};
use std::path::Path;

use crate::ahead;
use crate::definition::Library;
use crate::error::{OpenError, ReadError};
use crate::format::bag::{self, Bag};
use crate::format::csv::{self, Csv};
use crate::format::lines::{Line, Lines};
use crate::format::mcap::{self, Mcap};
use crate::format::ndjson::Ndjson;
use crate::format::returns::{self, Returns};
use crate::format::rosbag2::{self, Rosbag2};
use crate::format::sqlite::{self, Sqlite};
use crate::format::stream::Stream;
use crate::format::times::like_time;
use crate::format::told::{self, Told};
use crate::format::{Format, Source};
use crate::options::Limits;

/// How long the first line of a text format may be at most, in bytes, unless it is a JSON object.
const MAX_HEADER: usize = 1 << 20;
/// How much of an unknown file is shown.
const SHOWN: usize = 40;

/// An opened recording and its format.
pub(crate) type Opened = (Format, Box<dyn Source>);

/// Standard input or a pipe, which cannot be read twice: only what is read from its beginning to its end can come through it. `None`
/// for a file or a folder.
pub(crate) fn stream(path: &Path, stopped: fn() -> bool) -> Result<Option<Stream>, OpenError> {
    let error = |error| OpenError::Io { path: path.to_owned(), error };
    if path == Path::new("-") {
        return Stream::new(io::stdin(), stopped).map(Some).map_err(error);
    }
    let about = fs::metadata(path).map_err(error)?;
    if about.is_dir() || about.is_file() {
        return Ok(None);
    }
    File::open(path).and_then(|file| Stream::new(file, stopped)).map(Some).map_err(error)
}

/// A stream of text whose first line has been looked at.
pub(crate) struct Begun {
    /// Whether it is lines of NDJSON.
    pub is_lines: bool,
    /// All of it.
    pub text: Box<dyn Read + Send>,
}

/// Waits for the first line of a stream.
pub(crate) fn begin(mut stream: Stream, path: &Path, limits: &Limits) -> Result<Begun, OpenError> {
    let start = first_line(&mut stream, limits).map_err(|error| OpenError::Io { path: path.to_owned(), error })?;
    let text = start.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&start);
    let is_lines = text.trim_ascii_start().starts_with(b"{");
    Ok(Begun { is_lines, text: Box::new(Cursor::new(start).chain(stream)) })
}

/// Opens a file or a folder.
pub(crate) fn open(path: &Path, library: &Library, limits: &Limits) -> Result<Opened, OpenError> {
    let error = |error| OpenError::Io { path: path.to_owned(), error };
    let about = fs::metadata(path).map_err(error)?;
    if about.is_dir() {
        return folder(path, library, limits);
    }
    let begins = |magic| rosbag2::begins_with(path, magic);
    if begins(mcap::MAGIC)? {
        let mcap = Mcap::open(path, path, library, limits)?;
        if told::is_told(&mcap) {
            return text(Box::new(Told::new(Box::new(mcap))), path, about.len(), library, limits);
        }
        return Ok((Format::Mcap, Box::new(mcap)));
    }
    if begins(bag::MAGIC)? {
        return Ok((Format::Ros1Bag, Box::new(Bag::open(path, library, limits)?)));
    }
    if begins(sqlite::MAGIC)? {
        let mut sqlite = Sqlite::open(path, path, library, limits)?;
        sqlite.count();
        return Ok((Format::Rosbag2, Box::new(sqlite)));
    }
    if begins(rosbag2::ZSTD_MAGIC)? {
        return Ok((Format::Rosbag2, Box::new(rosbag2::open_packed(path, library, limits)?)));
    }
    text(Box::new(File::open(path).map_err(error)?), path, about.len(), library, limits)
}

fn folder(path: &Path, library: &Library, limits: &Limits) -> Result<Opened, OpenError> {
    if path.join("metadata.yaml").is_file() {
        return Ok((Format::Rosbag2, Box::new(Rosbag2::open(path, library, limits)?)));
    }
    Err(OpenError::Unrecognised { path: path.to_owned(), seen: "it is a folder without metadata.yaml".to_owned() })
}

/// A text format, by its first line that is not blank.
pub(crate) fn text(
    mut from: Box<dyn Read + Send>,
    path: &Path,
    total: u64,
    library: &Library,
    limits: &Limits,
) -> Result<Opened, OpenError> {
    let unrecognised = |seen: String| OpenError::Unrecognised { path: path.to_owned(), seen };
    let mut start = first_line(&mut *from, limits).map_err(|error| OpenError::Io { path: path.to_owned(), error })?;
    if is_utf16(&start) {
        let what = "it is UTF-16 text; save it as UTF-8".to_owned();
        return Err(OpenError::Unsupported { path: path.to_owned(), what });
    }
    if is_table(&start) && returns::end_lines_of(&start) {
        from = Box::new(Returns::new(&mut start, from));
    }
    let again = || Lines::new(Box::new(Cursor::new(start.clone()).chain(from)), path, total, limits.line);
    let mut head = Lines::new(Box::new(Cursor::new(start.clone())), path, 0, limits.line);
    let first = first(&mut head).map_err(|e| OpenError::Io { path: path.to_owned(), error: e.error })?;
    let Some(first) = first else { return Err(unrecognised("it is empty".to_owned())) };
    if first.trim_ascii_start().starts_with(b"{") {
        let ahead = Lines::new(Box::new(Cursor::new(start.clone())), path, 0, limits.line);
        let names = ahead::names(&mut Ndjson::new(ahead, library, limits), u64::MAX, limits.names).values;
        return Ok((Format::Ndjson, Box::new(Ndjson::new(again(), library, limits).with_names(names))));
    }
    let is_text = std::str::from_utf8(&first).is_ok() && !first.contains(&0);
    if is_text && csv::names(&first).is_some_and(|names| csv::time_column(&names).is_some()) {
        return Ok((Format::Csv, Box::new(Csv::open(again(), limits)?)));
    }
    Err(unrecognised(format!("it begins with {}{}", shown(&first), hint(&first))))
}

/// Whether it is no JSON, in which a carriage return is a blank like any other.
fn is_table(start: &[u8]) -> bool {
    !start.strip_prefix("\u{feff}".as_bytes()).unwrap_or(start).trim_ascii_start().starts_with(b"{")
}

/// Whether a text begins with the mark of UTF-16, or with a character of ASCII in two bytes.
fn is_utf16(start: &[u8]) -> bool {
    let is_wide = |a: u8, b: u8| a == 0 && (b.is_ascii_graphic() || b.is_ascii_whitespace());
    match start {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => true,
        [a, b, c, d, ..] => (is_wide(*a, *b) && is_wide(*c, *d)) || (is_wide(*b, *a) && is_wide(*d, *c)),
        _ => false,
    }
}

/// What would have made a table of it, where little is missing.
fn hint(header: &[u8]) -> String {
    let mut others = header.split(|b| matches!(b, b';' | b'\t')).map(<[u8]>::trim_ascii);
    if others.any(|name| matches!(name, b"time" | b"time_ns")) && !header.contains(&b',') {
        return ", and its columns are not separated by commas".to_owned();
    }
    let Some(names) = csv::names(header) else { return ", and a quote in it is not closed".to_owned() };
    match like_time(names.iter().map(String::as_str)) {
        Some(name) => format!(
            ": is its column `{}` the time? Name it `time` if it is in seconds, `time_ns` if in nanoseconds",
            name.escape_debug()
        ),
        None => String::new(),
    }
}

/// The bytes of a stream up to the end of its first line that is not blank: no more is asked for than comes.
fn first_line(from: &mut dyn Read, limits: &Limits) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut buffer = [0; 4096];
    loop {
        let text = bytes.trim_ascii_start();
        let limit = if text.starts_with(b"{") { limits.line } else { MAX_HEADER };
        let is_whole = text.contains(&b'\n') || (is_table(&bytes) && returns::end_lines_of(text));
        if is_whole || bytes.len() > limit {
            return Ok(bytes);
        }
        match from.read(&mut buffer) {
            Ok(0) => return Ok(bytes),
            Ok(read) => bytes.extend_from_slice(&buffer[..read]),
            Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
}

fn first(lines: &mut Lines) -> Result<Option<Vec<u8>>, ReadError> {
    loop {
        match lines.next()? {
            Line::Found(line) if lines.bytes(&line).trim_ascii().is_empty() => {}
            Line::Found(line) => return Ok(Some(lines.bytes(&line).to_vec())),
            Line::TooLong | Line::End => return Ok(None),
        }
    }
}

/// The beginning of a line, printable.
fn shown(line: &[u8]) -> String {
    let end = line.len().min(SHOWN);
    let dots = if end < line.len() { "…" } else { "" };
    format!("`{}{dots}`", line[..end].escape_ascii())
}
