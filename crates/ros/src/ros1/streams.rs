//! The numbers of streams: a topic has one for each type, and each definition of it, that is offered there.

use crate::connector::StreamId;

/// All streams that were ever seen. None is forgotten, as their numbers may stand in a queue.
#[derive(Debug, Default)]
pub(crate) struct Streams {
    list: Vec<Stream>,
}

/// A stream.
#[derive(Debug)]
pub(crate) struct Stream {
    pub topic: String,
    pub type_name: String,
    /// The checksum of its definition, once a publisher has said it.
    pub checksum: Option<String>,
    /// The definition.
    pub definition: String,
    /// How many publishers were told of; nothing before the stream itself was.
    pub told: Option<usize>,
}

impl Streams {
    /// The number of a stream that a publisher offers, and whether that offer says anything new.
    pub fn offered(&mut self, topic: &str, type_name: &str, checksum: &str, definition: &str) -> (StreamId, bool) {
        let same = |s: &Stream| s.topic == topic && s.type_name == type_name;
        if let Some(at) = self.list.iter().position(|s| same(s) && s.checksum.as_deref() == Some(checksum)) {
            return (number(at), false);
        }
        // What the master said of the topic is said again, with a definition.
        let unsaid = self.list.iter().position(|s| same(s) && s.checksum.is_none());
        let at = unsaid.unwrap_or_else(|| self.add(topic, type_name));
        if let Some(stream) = self.list.get_mut(at) {
            stream.checksum = Some(checksum.to_owned());
            stream.definition = definition.to_owned();
        }
        (number(at), true)
    }

    /// The number of a stream that the master speaks of, and whether it is new.
    pub fn rumoured(&mut self, topic: &str, type_name: &str) -> (StreamId, bool) {
        match self.list.iter().position(|s| s.topic == topic && s.type_name == type_name) {
            Some(at) => (number(at), false),
            None => (number(self.add(topic, type_name)), true),
        }
    }

    fn add(&mut self, topic: &str, type_name: &str) -> usize {
        self.list.push(Stream {
            topic: topic.to_owned(),
            type_name: type_name.to_owned(),
            checksum: None,
            definition: String::new(),
            told: None,
        });
        self.list.len() - 1
    }

    /// All of them, with their numbers.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (StreamId, &mut Stream)> {
        self.list.iter_mut().enumerate().map(|(at, stream)| (number(at), stream))
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Stream> {
        self.list.iter()
    }
}

fn number(at: usize) -> StreamId {
    StreamId(u32::try_from(at).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_topic_has_a_stream_for_each_type_and_definition() {
        let mut streams = Streams::default();
        assert_eq!(streams.rumoured("/a", "p/T"), (StreamId(0), true));
        assert_eq!(streams.rumoured("/a", "p/T"), (StreamId(0), false));
        assert_eq!(streams.offered("/a", "p/T", "1", "int8 x"), (StreamId(0), true), "its definition is new");
        assert_eq!(streams.offered("/a", "p/T", "1", "int8 x"), (StreamId(0), false));
        assert_eq!(streams.offered("/a", "p/T", "2", "int16 x"), (StreamId(1), true));
        assert_eq!(streams.offered("/a", "p/U", "1", "int8 x"), (StreamId(2), true));
        assert_eq!(streams.rumoured("/a", "p/T"), (StreamId(0), false));
    }
}
