//! Messages as they lie in a recording, without decoding: for those who copy a part of one.

use lapwing_stream::Time;

use crate::decode::MessageType;
use crate::error::{Loss, Losses, ReadError};
use crate::format::{Channel, Head, Source};

/// A stream of messages as the recording declares it.
#[derive(Clone, Debug)]
pub struct RawChannel {
    /// The topic, as recorded.
    pub topic: String,
    /// The type, as recorded: `nav_msgs/msg/Odometry`; empty where none is.
    pub type_name: String,
    /// How the definition is written: `ros2msg`, `ros1msg`, `jsonschema`, …; empty where there is none.
    pub encoding: String,
    /// The definition.
    pub definition: Vec<u8>,
    /// How the messages are encoded: `cdr`, `ros1`, `json`, `protobuf`; empty where the recording has no bytes of them.
    pub messages: String,
    /// How to decode them, or why that is not possible.
    pub ty: Result<MessageType, String>,
}

/// A message, which may be looked at until the next one is asked for.
#[derive(Clone, Copy, Debug)]
pub struct RawMessage<'a> {
    /// When it was recorded.
    pub time: Time,
    /// The number of its channel, see [`RawReader::channel`].
    pub channel: usize,
    /// Its bytes; `None` where it is of no wanted topic, or could not be read.
    pub payload: Option<&'a [u8]>,
}

/// Reads the messages of some topics as they lie in a recording, in the order of the file. Rows and events are passed over.
pub struct RawReader {
    source: Box<dyn Source>,
    topics: Vec<String>,
    /// Those of the source, as far as they are known.
    channels: Vec<RawChannel>,
    losses: Losses,
}

impl RawReader {
    pub(crate) fn new(mut source: Box<dyn Source>, topics: &[String], losses: usize) -> RawReader {
        source.leave_out(&|channel| topics.iter().any(|t| is_same(t, &channel.topic)));
        let channels = source.channels().iter().map(raw).collect();
        RawReader { source, topics: topics.to_vec(), channels, losses: Losses::new(losses) }
    }

    /// The next message, of whatever topic. After an error there are no more.
    #[expect(clippy::should_implement_trait, reason = "a message borrows from the reader, which no iterator can say")]
    pub fn next(&mut self) -> Option<Result<RawMessage<'_>, ReadError>> {
        let (time, channel) = loop {
            match self.source.advance(&mut self.losses) {
                Ok(Some((time, Head::Message(channel)))) => break (time, channel),
                Ok(Some(_)) => {}
                Ok(None) => return None,
                Err(error) => return Some(Err(error)),
            }
        };
        let known = self.channels.len();
        self.channels.extend(self.source.channels().iter().skip(known).map(raw));
        let topic = self.channels.get(channel).map_or("", |channel| &channel.topic);
        if !self.topics.iter().any(|t| is_same(t, topic)) {
            return Some(Ok(RawMessage { time, channel, payload: None }));
        }
        let place = self.source.place();
        let payload = match self.source.payload() {
            Ok(payload) => Some(payload),
            Err(what) => {
                self.losses.add_of(place, topic, format!("a message is lost: {what}"));
                None
            }
        };
        Some(Ok(RawMessage { time, channel, payload }))
    }

    /// What is known of a channel.
    pub fn channel(&self, number: usize) -> Option<&RawChannel> {
        self.channels.get(number)
    }

    /// The channels that are known so far.
    pub fn channels(&self) -> &[RawChannel] {
        &self.channels
    }

    /// What could not be read so far.
    pub fn losses(&self) -> &[Loss] {
        self.losses.list()
    }
}

fn raw(channel: &Channel) -> RawChannel {
    let declared = channel.declared.as_deref();
    RawChannel {
        topic: channel.topic.to_string(),
        type_name: declared.map(|d| d.name.clone()).unwrap_or_default(),
        encoding: declared.map(|d| d.encoding.clone()).unwrap_or_default(),
        definition: declared.map(|d| d.definition.clone()).unwrap_or_default(),
        messages: declared.map(|d| d.messages.clone()).unwrap_or_default(),
        ty: channel.ty.clone(),
    }
}

fn is_same(a: &str, b: &str) -> bool {
    a.trim_start_matches('/') == b.trim_start_matches('/')
}
