//! rosbag2 folders: `metadata.yaml`, and files of one storage format that are read one after the other.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lapwing_stream::Time;
use tempfile::TempPath;

use super::compression::{self, Compression};
use super::mcap::Mcap;
use super::metadata::Metadata;
use super::sqlite::Sqlite;
use super::{Channel, Head, Source, mcap, sqlite};
use crate::definition::{Library, normal_name};
use crate::error::{Losses, OpenError, Place, Position, ReadError};
use crate::options::Limits;

/// What every Zstandard file begins with.
pub(crate) const ZSTD_MAGIC: &[u8] = b"\x28\xb5\x2f\xfd";
/// Bytes of a metadata file; real ones have a few thousand.
const MAX_METADATA: u64 = 1 << 26;

/// A rosbag2 folder.
pub(crate) struct Rosbag2 {
    folder: PathBuf,
    library: Library,
    limits: Limits,
    /// The files not yet opened.
    waiting: VecDeque<PathBuf>,
    current: Option<Part>,
    /// Whether each message is compressed by itself.
    packed_messages: bool,
    unpacked: Vec<u8>,
    channels: Vec<Channel>,
    by_name: BTreeMap<(String, String), usize>,
    /// The topics whose messages nobody looks at.
    unwanted: BTreeSet<Arc<str>>,
    files: u64,
}

/// One file of a bag.
pub(crate) struct Part {
    source: Box<dyn Source>,
    /// The bag's channel for each of the file's.
    map: Vec<usize>,
    /// The decompressed copy, removed when the file is done.
    _copy: Option<TempPath>,
}

impl Part {
    fn leave_out(&mut self, unwanted: &BTreeSet<Arc<str>>) {
        if !unwanted.is_empty() {
            self.source.leave_out(&|channel| !unwanted.contains(&channel.topic));
        }
    }
}

impl Rosbag2 {
    /// Opens a folder and finds its channels. Files are opened until every topic of the metadata is found.
    pub fn open(folder: &Path, library: &Library, limits: &Limits) -> Result<Rosbag2, OpenError> {
        let metadata = read_metadata(&folder.join("metadata.yaml"))?;
        let unsupported = |what: String| Err(OpenError::Unsupported { path: folder.to_owned(), what });
        if !matches!(metadata.compression_format.as_str(), "" | "zstd") {
            return unsupported(format!("compression `{}` is not supported: zstd is", metadata.compression_format));
        }
        if !matches!(metadata.storage.as_str(), "" | "sqlite3" | "mcap") {
            return unsupported(format!("storage `{}` is not supported: sqlite3 and mcap are", metadata.storage));
        }
        if metadata.files.is_empty() {
            return unsupported("its metadata.yaml lists no files".to_owned());
        }
        let paths: VecDeque<PathBuf> = metadata.files.iter().map(|file| within(folder, file)).collect();
        let mut bag = Rosbag2 {
            folder: folder.to_owned(),
            library: library.clone(),
            limits: limits.clone(),
            files: paths.len() as u64,
            waiting: paths,
            current: None,
            packed_messages: metadata.compression_mode == "message",
            unpacked: Vec::new(),
            channels: Vec::new(),
            by_name: BTreeMap::new(),
            unwanted: BTreeSet::new(),
        };
        bag.learn(&metadata)?;
        Ok(bag)
    }

    fn learn(&mut self, metadata: &Metadata) -> Result<(), OpenError> {
        let mut failed = None;
        let paths: Vec<PathBuf> = self.waiting.iter().cloned().collect();
        for (k, path) in paths.iter().enumerate() {
            match open_part(path, &self.library, &self.limits) {
                Ok(mut part) => {
                    self.adopt(&mut part);
                    if k == 0 {
                        self.current = Some(part);
                        self.waiting.pop_front();
                    }
                }
                Err(error) => failed = failed.or(Some(error)),
            }
            let missing = |t: &&(String, String, Option<u64>)| {
                t.2 != Some(0) && !self.by_name.contains_key(&(t.0.clone(), normal_name(&t.1)))
            };
            if metadata.topics.iter().find(missing).is_none() && !self.channels.is_empty() {
                break;
            }
        }
        if let (true, Some(error)) = (self.channels.is_empty(), failed) {
            return Err(error);
        }
        for channel in &mut self.channels {
            let known =
                metadata.topics.iter().find(|t| *t.0 == *channel.topic && normal_name(&t.1) == channel.type_name);
            channel.messages = known.and_then(|t| t.2);
        }
        Ok(())
    }

    /// Takes over the channels that a file has met since the last time.
    fn adopt(&mut self, part: &mut Part) {
        for channel in &part.source.channels()[part.map.len()..] {
            let key = (channel.topic.to_string(), channel.type_name.clone());
            let index = *self.by_name.entry(key).or_insert_with(|| {
                self.channels.push(channel.clone());
                self.channels.len() - 1
            });
            if self.channels[index].ty.is_err() {
                self.channels[index].ty = channel.ty.clone();
            }
            part.map.push(index);
        }
    }

    /// Opens the next file that can be opened. A file that cannot is a loss.
    fn next_part(&mut self, losses: &mut Losses) -> Option<Part> {
        loop {
            let path = self.waiting.pop_front()?;
            match open_part(&path, &self.library, &self.limits) {
                Ok(mut part) => {
                    part.leave_out(&self.unwanted);
                    return Some(part);
                }
                Err(error) => {
                    losses.add(Place::new(&path, Position::Whole), format!("this file of the bag is lost: {error}"))
                }
            }
        }
    }
}

/// A file by the name that the metadata has for it: below the folder, whatever else the name says.
fn within(folder: &Path, file: &str) -> PathBuf {
    let name = Path::new(file);
    let inside = name.components().all(|c| matches!(c, std::path::Component::Normal(_) | std::path::Component::CurDir));
    let whole = folder.join(name);
    match name.file_name() {
        // Old versions write the folder's own name in front.
        Some(last) if !inside || !whole.exists() => folder.join(last),
        _ => whole,
    }
}

fn read_metadata(path: &Path) -> Result<Metadata, OpenError> {
    let error = |error| OpenError::Io { path: path.to_owned(), error };
    let mut text = Vec::new();
    fs::File::open(path).map_err(error)?.take(MAX_METADATA).read_to_end(&mut text).map_err(error)?;
    Ok(Metadata::parse(&String::from_utf8_lossy(&text)))
}

/// Opens one file of a bag, decompressed before where it was compressed as a whole.
fn open_part(path: &Path, library: &Library, limits: &Limits) -> Result<Part, OpenError> {
    let copy = if begins_with(path, ZSTD_MAGIC)? { Some(unpack(path, limits)?) } else { None };
    let file: &Path = copy.as_deref().unwrap_or(path);
    let source: Box<dyn Source> = if begins_with(file, mcap::MAGIC)? {
        Box::new(Mcap::open(file, path, library, limits)?)
    } else if begins_with(file, sqlite::MAGIC)? {
        Box::new(Sqlite::open(file, path, library, limits)?)
    } else {
        return Err(OpenError::Damaged {
            at: Place::new(path, Position::Byte(0)),
            what: "it is neither an MCAP file nor an SQLite database".to_owned(),
        });
    };
    Ok(Part { source, map: Vec::new(), _copy: copy })
}

/// Whether a file begins with those bytes.
pub(crate) fn begins_with(path: &Path, magic: &[u8]) -> Result<bool, OpenError> {
    let error = |error| OpenError::Io { path: path.to_owned(), error };
    let mut head = Vec::new();
    fs::File::open(path).map_err(error)?.take(magic.len() as u64).read_to_end(&mut head).map_err(error)?;
    Ok(head == magic)
}

/// Decompresses a file into a temporary one. One that was cut off gives what was there.
pub(crate) fn unpack(path: &Path, limits: &Limits) -> Result<TempPath, OpenError> {
    let error = |error| OpenError::Io { path: path.to_owned(), error };
    let mut copy = tempfile::NamedTempFile::new().map_err(error)?;
    let packed = fs::File::open(path).map_err(error)?;
    let mut unpacked = zstd::stream::read::Decoder::new(packed).map_err(error)?.take(limits.file);
    let mut buffer = vec![0; 1 << 17];
    let mut total = 0;
    loop {
        match unpacked.read(&mut buffer) {
            Ok(0) => break,
            Ok(n) => {
                io::Write::write_all(&mut copy, &buffer[..n]).map_err(error)?;
                total += n as u64;
            }
            Err(_) if total > 0 => break,
            Err(e) => return Err(error(e)),
        }
    }
    if total >= limits.file {
        let what =
            format!("decompressed, it has more than {} bytes: raise Limits::file if it can be trusted", limits.file);
        return Err(OpenError::Unsupported { path: path.to_owned(), what });
    }
    Ok(copy.into_temp_path())
}

impl Source for Rosbag2 {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn advance(&mut self, losses: &mut Losses) -> Result<Option<(Time, Head)>, ReadError> {
        loop {
            let Some(mut part) = self.current.take().or_else(|| self.next_part(losses)) else { return Ok(None) };
            let Some((time, head)) = part.source.advance(losses)? else { continue };
            if part.map.len() < part.source.channels().len() {
                self.adopt(&mut part);
            }
            let head = match head {
                Head::Message(channel) => Head::Message(part.map.get(channel).copied().unwrap_or(usize::MAX)),
                other => other,
            };
            self.current = Some(part);
            return Ok(Some((time, head)));
        }
    }

    fn payload(&mut self) -> Result<&[u8], String> {
        let Some(part) = &mut self.current else { return Err("there is no message here".to_owned()) };
        let message = part.source.payload()?;
        if !self.packed_messages {
            return Ok(message);
        }
        let limit = self.limits.record;
        compression::part(Compression::Zstd, message, limit, &mut self.unpacked)
            .map_err(|e| format!("it cannot be decompressed ({e})"))?;
        if self.unpacked.len() as u64 >= limit {
            return Err(
                "decompressed, it is larger than the limit: raise Limits::record if the file can be trusted".to_owned()
            );
        }
        Ok(&self.unpacked)
    }

    fn leave_out(&mut self, is_wanted: &dyn Fn(&Channel) -> bool) {
        let (wanted, unwanted): (Vec<&Channel>, Vec<&Channel>) = self.channels.iter().partition(|c| is_wanted(c));
        self.unwanted = unwanted.into_iter().map(|channel| channel.topic.clone()).collect();
        // One topic may have been recorded with two types.
        wanted.iter().for_each(|channel| _ = self.unwanted.remove(&channel.topic));
        if let Some(part) = &mut self.current {
            part.leave_out(&self.unwanted);
        }
    }

    fn place(&self) -> Place {
        self.current.as_ref().map_or_else(|| Place::new(&self.folder, Position::Whole), |part| part.source.place())
    }

    /// In thousandths of a file: files differ in how they count.
    fn progress(&self) -> (u64, u64) {
        let opened = self.files - self.waiting.len() as u64;
        let within = match &self.current {
            Some(part) => match part.source.progress() {
                (_, 0) => 0,
                (done, total) => 1000 - (u128::from(done) * 1000 / u128::from(total)).min(1000) as u64,
            },
            None => 0,
        };
        (opened * 1000 - within.min(opened * 1000), self.files * 1000)
    }
}

/// A single file that was compressed as a whole: `x.db3.zstd` or `x.mcap.zstd`.
pub(crate) fn open_packed(path: &Path, library: &Library, limits: &Limits) -> Result<Rosbag2, OpenError> {
    let mut bag = Rosbag2 {
        folder: path.to_owned(),
        library: library.clone(),
        limits: limits.clone(),
        waiting: VecDeque::new(),
        current: None,
        packed_messages: false,
        unpacked: Vec::new(),
        channels: Vec::new(),
        by_name: BTreeMap::new(),
        unwanted: BTreeSet::new(),
        files: 1,
    };
    let mut part = open_part(path, library, limits)?;
    bag.adopt(&mut part);
    bag.current = Some(part);
    Ok(bag)
}
