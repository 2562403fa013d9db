//! How a recording is to be read: which clock, which definitions, and how much a file may ask for.

use std::path::PathBuf;

use lapwing_stream::Duration;

/// How a recording is to be read.
#[derive(Clone, Debug)]
pub struct Options {
    /// Which stamp counts as the time of a message.
    pub time: TimeSource,
    /// With [`TimeSource::Header`], how far apart in header time two messages may be and still be put in order.
    pub reorder: Duration,
    /// Trees of installed message definitions, asked before the bundled ones:
    /// `DIR/<pkg>/msg`, `DIR/share/<pkg>/msg` or `DIR/<pkg>/share/<pkg>/msg`.
    pub msgs: Vec<PathBuf>,
    /// How many bytes of an NDJSON file are looked through for topics and names before it is read; `u64::MAX` for all of it. Other
    /// formats tell theirs at once. A stream is only waited for, and kept in a temporary file, with `u64::MAX`.
    pub look_ahead: u64,
    /// Asked while a stream has nothing to give. Once it is true the stream is not waited for any longer: reading it fails.
    pub stopped: fn() -> bool,
    /// How much memory and disk a file may ask for.
    pub limits: Limits,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            time: TimeSource::Log,
            reorder: Duration::from_nanos(1_000_000_000),
            msgs: Vec::new(),
            look_ahead: 1 << 20,
            stopped: || false,
            limits: Limits::default(),
        }
    }
}

/// Which stamp counts as the time of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum TimeSource {
    /// When it was recorded. Messages come in the order of the file, even where that goes back in time.
    #[default]
    Log,
    /// The stamp of its header, where it has one that is not zero; messages are sorted within [`Options::reorder`].
    Header,
}

/// How much a file may ask for. A file that wants more gets a [`Loss`](crate::Loss) for the part that asked, never memory.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Bytes of one chunk, compressed or not: a chunk is held in memory whole.
    pub chunk: u64,
    /// Bytes of one message or other record, after decompression.
    pub record: u64,
    /// Bytes of a whole file that was compressed as one, after decompression into a temporary file.
    pub file: u64,
    /// Array elements, of all the wanted fields of one message together.
    pub elements: usize,
    /// Bytes of one line of a text format.
    pub line: usize,
    /// Channels, connections, columns or names that one file may have.
    pub names: usize,
    /// Messages held back while they are sorted by header time.
    pub held: usize,
    /// Losses that are listed; what goes beyond is counted in the last one.
    pub losses: usize,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            chunk: 1 << 30,
            record: 1 << 30,
            file: 1 << 38,
            elements: 1 << 26,
            line: 1 << 28,
            names: 1 << 16,
            held: 1 << 20,
            losses: 1000,
        }
    }
}
