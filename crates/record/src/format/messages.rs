//! Messages that a program gives one by one, read as those of a file are: a simulator needs no file to be checked.

use std::path::PathBuf;
use std::sync::Arc;

use lapwing_stream::{Time, Value};

use super::{Channel, Head, Source};
use crate::decode::MessageType;
use crate::definition::normal_name;
use crate::error::{Losses, Place, Position, ReadError};
use crate::path::Path;

/// Messages that a program gives one by one, in the order in which they are published.
pub trait Messages: Send {
    /// Goes to the next message: its time, and the number of its topic among those that [`Recording::of`](crate::Recording::of) got.
    fn advance(&mut self) -> Option<(Time, usize)>;

    /// The bytes of that message. Only asked for where someone wants them, and then once.
    fn payload(&mut self) -> &[u8];

    /// Whether it can tell these fields of the messages of a topic as they are, without bytes: then [`tell`](Messages::tell) is asked for
    /// them in place of [`payload`](Messages::payload). They are fields that the type has. Asked once for a topic, before its first message.
    fn tells(&mut self, _topic: usize, _fields: &[Path]) -> bool {
        false
    }

    /// Overwrites values by the fields of that message that its topic was asked for: what decoding its bytes would give. Asked once.
    fn tell(&mut self, _values: &mut [Value]) {}

    /// How much has been given, and of how much; the second is 0 where that is not known.
    fn progress(&self) -> (u64, u64);
}

/// The program as a source.
pub(crate) struct Program {
    pub name: PathBuf,
    pub channels: Vec<Channel>,
    pub messages: Box<dyn Messages>,
}

/// The channels of a program: names of topics, and the types of their messages.
pub(crate) fn channels(topics: Vec<(String, MessageType)>) -> Vec<Channel> {
    let channel = |(topic, ty): (String, MessageType)| Channel {
        topic: Arc::from(topic),
        type_name: ty.schema().map(|s| normal_name(&s.name)).unwrap_or_default(),
        ty: Ok(ty),
        note: "its type has no schema".to_owned(),
        messages: None,
        declared: None,
    };
    topics.into_iter().map(channel).collect()
}

impl Source for Program {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn advance(&mut self, _losses: &mut Losses) -> Result<Option<(Time, Head)>, ReadError> {
        Ok(self.messages.advance().map(|(time, channel)| (time, Head::Message(channel))))
    }

    fn payload(&mut self) -> Result<&[u8], String> {
        Ok(self.messages.payload())
    }

    fn tells(&mut self, channel: usize, fields: &[Path]) -> bool {
        self.messages.tells(channel, fields)
    }

    fn tell(&mut self, values: &mut [Value]) {
        self.messages.tell(values);
    }

    fn place(&self) -> Place {
        Place::new(&self.name, Position::Whole)
    }

    fn progress(&self) -> (u64, u64) {
        self.messages.progress()
    }
}
