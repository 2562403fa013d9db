//! An opened recording: what is in it, before any message is read.

use std::collections::BTreeSet;
use std::io::{Read, Seek};
use std::path::Path;
use std::sync::Arc;

use lapwing_stream::{Name, Schema};

use crate::ahead;
use crate::decode::MessageType;
use crate::definition::Library;
use crate::error::OpenError;
use crate::format::messages::{self, Messages};
use crate::format::{Channel, Format, Source};
use crate::options::{Limits, Options};
use crate::path;
use crate::raw::RawReader;
use crate::reader::Reader;

/// An opened recording.
pub struct Recording {
    format: Format,
    source: Box<dyn Source>,
    topics: Vec<TopicInfo>,
    columns: Vec<Name>,
    events: BTreeSet<Name>,
    options: Options,
}

/// One topic of a recording. A topic on which two types were recorded is listed twice.
#[derive(Clone, Debug, PartialEq)]
pub struct TopicInfo {
    /// Its name, as recorded.
    pub name: String,
    /// Its type, as [`normal_name`](crate::normal_name) spells it: `nav_msgs/Odometry`; empty where none is recorded.
    pub type_name: String,
    /// The shape of its messages, or why it is not known.
    pub schema: Result<Arc<Schema>, String>,
    /// How many messages it has, where that is known beforehand.
    pub messages: Option<u64>,
}

/// A topic to be read, and the fields of it. One per topic: of two for the same topic the first counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// The topic; a slash in front makes no difference.
    pub topic: String,
    /// The fields, in the order in which their values are given.
    pub fields: Vec<path::Path>,
}

/// Opens a recording, whatever its format: a file, a rosbag2 folder, or `-` for standard input (text formats only).
///
/// Opening reads what tells the topics: a summary or an index where there is one, else the whole file, but of an NDJSON
/// file only so much as [`Options::look_ahead`] says, and of a stream only its beginning (for which it waits),
/// unless all of its lines of NDJSON are to be looked through: then it is kept in a temporary file.
pub fn open(path: &Path, options: Options) -> Result<Recording, OpenError> {
    let library = Library::new(&options.msgs);
    let text = |from: Box<dyn Read + Send>| crate::open::text(from, path, 0, &library, &options.limits);
    let begin = |stream| crate::open::begin(stream, path, &options.limits);
    let (format, source, found) = match crate::open::stream(path, options.stopped)?.map(begin).transpose()? {
        Some(begun) if options.look_ahead == u64::MAX && begun.is_lines => {
            let mut file = ahead::spool(begun.text, path, &options.limits)?;
            let error = |error| OpenError::Io { path: path.to_owned(), error };
            let found = text(Box::new(file.try_clone().map_err(error)?))?;
            let found = Found::of(found, u64::MAX, &options.limits);
            file.rewind().map_err(error)?;
            let (format, source) = text(Box::new(file))?;
            (format, source, found)
        }
        Some(begun) => {
            let (format, source) = text(begun.text)?;
            let found = Found::at_once(&*source);
            (format, source, found)
        }
        None => {
            let open = || crate::open::open(path, &library, &options.limits);
            let (format, source) = open()?;
            let found = match format {
                Format::Ndjson => open()
                    .map_or_else(|_| Found::default(), |again| Found::of(again, options.look_ahead, &options.limits)),
                _ => Found::at_once(&*source),
            };
            (format, source, found)
        }
    };
    Ok(Recording { format, source, topics: found.topics, columns: found.columns, events: found.events, options })
}

/// What is known of a recording before it is read.
#[derive(Default)]
struct Found {
    topics: Vec<TopicInfo>,
    columns: Vec<Name>,
    events: BTreeSet<Name>,
}

impl Found {
    /// What an opened source tells, which is then of no further use: lines of NDJSON in so many bytes, any other at once.
    fn of((format, source): (Format, Box<dyn Source>), bytes: u64, limits: &Limits) -> Found {
        if format == Format::Ndjson { Found::ahead(source, bytes, limits) } else { Found::at_once(&*source) }
    }

    /// What a source tells at once.
    fn at_once(source: &dyn Source) -> Found {
        Found { topics: topics(source.channels()), columns: source.columns().to_vec(), events: BTreeSet::new() }
    }

    /// What so many bytes of a source tell, which is then of no further use.
    fn ahead(mut source: Box<dyn Source>, bytes: u64, limits: &Limits) -> Found {
        let names = ahead::names(&mut *source, bytes, limits.names);
        Found { topics: topics(source.channels()), columns: names.values, events: names.events }
    }
}

fn topics(channels: &[Channel]) -> Vec<TopicInfo> {
    let mut topics: Vec<TopicInfo> = Vec::new();
    let mut places = std::collections::BTreeMap::new();
    for channel in channels {
        let place = *places.entry((&channel.topic, &channel.type_name)).or_insert_with(|| {
            topics.push(TopicInfo {
                name: channel.topic.to_string(),
                type_name: channel.type_name.clone(),
                schema: schema(channel),
                messages: Some(0),
            });
            topics.len() - 1
        });
        let topic = &mut topics[place];
        topic.messages = topic.messages.zip(channel.messages).map(|(a, b)| a + b);
        if topic.schema.is_err() {
            topic.schema = schema(channel);
        }
    }
    topics
}

fn schema(channel: &Channel) -> Result<Arc<Schema>, String> {
    let ty = channel.ty.as_ref().map_err(String::clone)?;
    ty.schema().cloned().ok_or_else(|| channel.note.clone())
}

impl Recording {
    /// What a program says, read as a recording: its topics with the types of their messages, and the messages. `name` stands where
    /// the path of a file would.
    pub fn of(
        name: &Path,
        topics: Vec<(String, MessageType)>,
        messages: Box<dyn Messages>,
        options: Options,
    ) -> Recording {
        let channels = messages::channels(topics);
        let topics = self::topics(&channels);
        let source = Box::new(messages::Program { name: name.to_owned(), channels, messages });
        let (columns, events) = (Vec::new(), BTreeSet::new());
        Recording { format: Format::Messages, source, topics, columns, events, options }
    }

    /// Its format.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Its topics, in the order in which they are met. Of an NDJSON file those that its first [`Options::look_ahead`] bytes name, of standard input
    /// none: later ones are read all the same.
    pub fn topics(&self) -> &[TopicInfo] {
        &self.topics
    }

    /// Whether its signals are columns or names rather than fields of topics: CSV, and NDJSON, which may also have topics.
    pub fn is_schemaless(&self) -> bool {
        matches!(self.format, Format::Csv | Format::Ndjson)
    }

    /// The columns of a CSV file but that of the time, in order. Of NDJSON the names of signals that are known beforehand, as the
    /// [topics](Recording::topics) are; of a stream those of its first line. An object is its fields, by names with dots.
    pub fn columns(&self) -> &[Name] {
        &self.columns
    }

    /// The names of the events of an NDJSON file, as far as they are known beforehand, as the [topics](Recording::topics) are.
    pub fn events(&self) -> &BTreeSet<Name> {
        &self.events
    }

    /// Starts reading. Of topics that are not wanted only the times are given; of rows all cells are.
    pub fn read(self, wanted: &[Wanted]) -> Reader {
        Reader::new(self.source, wanted, None, &self.options)
    }

    /// Starts reading the messages of some topics as they lie there, by log time.
    pub fn read_raw(self, topics: &[String]) -> RawReader {
        RawReader::new(self.source, topics, self.options.limits.losses)
    }

    /// Starts reading as [`read`](Recording::read) does, but of rows only those signals, as [`Signal`](crate::Signal) finds
    /// them: every row has exactly these cells, in this order, [`Value::Missing`](lapwing_stream::Value::Missing) where there is none of that name. The others are not even decoded.
    pub fn read_signals(self, wanted: &[Wanted], signals: &[Name]) -> Reader {
        Reader::new(self.source, wanted, Some(signals), &self.options)
    }
}

impl std::fmt::Debug for Recording {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recording").field("format", &self.format).field("topics", &self.topics).finish_non_exhaustive()
    }
}
