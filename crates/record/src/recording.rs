//! An opened recording: what is in it, before any message is read.

use std::path::Path;
use std::sync::Arc;

use lapwing_stream::{Name, Schema};

use crate::definition::Library;
use crate::error::{Losses, OpenError};
use crate::format::{Channel, Format, Source};
use crate::options::Options;
use crate::path;
use crate::reader::Reader;

/// An opened recording.
pub struct Recording {
    format: Format,
    source: Box<dyn Source>,
    topics: Vec<TopicInfo>,
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
/// file only so much as [`Options::look_ahead`] says, and of a stream only its first line (for which it waits).
pub fn open(path: &Path, options: Options) -> Result<Recording, OpenError> {
    let library = Library::new(&options.msgs);
    let (format, source) = crate::open::open(path, &library, &options.limits)?;
    let topics = match format {
        Format::Ndjson => look_ahead(path, &library, &options),
        _ => topics(source.channels()),
    };
    Ok(Recording { format, source, topics, options })
}

/// The topics at the beginning of an NDJSON file. A stream cannot be read twice, and is not waited for.
fn look_ahead(path: &Path, library: &Library, options: &Options) -> Vec<TopicInfo> {
    if !path.is_file() {
        return Vec::new();
    }
    let Ok((_, mut source)) = crate::open::open(path, library, &options.limits) else { return Vec::new() };
    let mut losses = Losses::new(1);
    while let Ok(Some(_)) = source.advance(&mut losses) {
        if source.progress().0 >= options.look_ahead {
            break;
        }
    }
    topics(source.channels())
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

    /// The columns of a CSV file but that of the time, in order: the cells of every row have this order.
    pub fn columns(&self) -> &[Name] {
        self.source.columns()
    }

    /// Starts reading. Of topics that are not wanted only the times are given.
    pub fn read(self, wanted: &[Wanted]) -> Reader {
        Reader::new(self.source, wanted, &self.options)
    }
}

impl std::fmt::Debug for Recording {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recording").field("format", &self.format).field("topics", &self.topics).finish_non_exhaustive()
    }
}
