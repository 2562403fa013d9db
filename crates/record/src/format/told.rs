//! What a program told, in an MCAP file: the rows of its signals on the topic `/lapwing/rows`, its events on `/lapwing/events/NAME`, as JSON objects.
//!
//! Such a file is what NDJSON is, in a container that viewers open; so it is read as NDJSON: each message is a line of it. Other topics must be of
//! JSON too, and are messages of their topics.

use std::fmt::Write as _;
use std::io::{self, Read};

use lapwing_stream::json;

use super::{Channel, Head, Source};
use crate::error::Losses;

/// The topic of the rows.
const ROWS: &str = "/lapwing/rows";
/// What the topics of events begin with.
const EVENTS: &str = "/lapwing/events/";

/// Whether it is what a program told.
pub(crate) fn is_told(source: &dyn Source) -> bool {
    let has_json = |c: &Channel| c.declared.as_deref().is_some_and(|declared| declared.messages == "json");
    let is_ours = |c: &Channel| *c.topic == *ROWS || c.topic.starts_with(EVENTS);
    let channels = source.channels();
    channels.iter().any(is_ours) && channels.iter().all(has_json)
}

/// The lines, as a stream of text.
pub(crate) struct Told {
    source: Box<dyn Source>,
    losses: Losses,
    line: String,
    /// How much of the line was read.
    read: usize,
}

impl Told {
    pub fn new(source: Box<dyn Source>) -> Told {
        Told { source, losses: Losses::new(1), line: String::new(), read: 0 }
    }

    /// The next message becomes the line; an empty one after the last. What cannot be read ends the stream, with what is wrong.
    fn advance(&mut self) -> io::Result<()> {
        let Told { source, losses, line, read } = self;
        line.clear();
        *read = 0;
        let head = source.advance(losses).map_err(io::Error::other)?;
        if let Some(loss) = losses.list().first() {
            return Err(io::Error::other(loss.to_string()));
        }
        let Some((time, Head::Message(channel))) = head else { return Ok(()) };
        let channel = source.channels().get(channel).map(|channel| (channel.topic.clone(), channel.type_name.clone()));
        let Some((topic, type_name)) = channel else { return Ok(()) };
        // Writing to a text cannot fail.
        let _ = write!(line, "{{\"t_ns\":{}", time.0);
        let payload = source.payload().map_err(io::Error::other)?;
        // No line ends inside of a JSON text but between its tokens.
        let payload = String::from_utf8_lossy(payload).replace(['\n', '\r'], " ");
        if *topic == *ROWS {
            line.extend([",\"values\":", &payload]);
        } else if let Some(name) = topic.strip_prefix(EVENTS) {
            line.push_str(",\"event\":");
            json::text(line, name);
            let fields = payload.trim().strip_prefix('{').and_then(|rest| rest.strip_suffix('}')).unwrap_or(&payload);
            line.extend([if fields.trim().is_empty() { "" } else { "," }, fields]);
        } else {
            line.push_str(",\"topic\":");
            json::text(line, &topic);
            if !type_name.is_empty() {
                line.push_str(",\"type\":");
                json::text(line, &type_name);
            }
            line.extend([",\"msg\":", &payload]);
        }
        line.push_str("}\n");
        Ok(())
    }
}

impl Read for Told {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.read == self.line.len() {
            self.advance()?;
        }
        let rest = self.line.as_bytes().get(self.read..).unwrap_or_default();
        let length = rest.len().min(buffer.len());
        let (Some(to), Some(from)) = (buffer.get_mut(..length), rest.get(..length)) else { return Ok(0) };
        to.copy_from_slice(from);
        self.read += length;
        Ok(length)
    }
}
