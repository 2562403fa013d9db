//! What is there on a graph: streams of messages, as they are met.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use bytes::Bytes;
use lapwing_check::{TraceShape, TraceTopic};
use lapwing_diag::suggest;
use lapwing_record::{RawChannel, normal_name};
use lapwing_stream::Time;

/// So many messages of a topic that hands its last ones to those who come late are kept for monitors that begin later.
const LATCHED: usize = 64;

/// And of these so many bytes.
const LATCHED_BYTES: usize = 16 << 20;

/// All streams that were met, by number.
#[derive(Debug, Default)]
pub(crate) struct Graph {
    streams: BTreeMap<u32, Stream>,
}

/// Messages of one type on one topic.
#[derive(Debug)]
pub(crate) struct Stream {
    /// Topic, type and definition.
    pub channel: RawChannel,
    /// The topic, absolute.
    pub topic: String,
    /// The type without ROS 2's `msg`.
    pub type_name: String,
    /// Whether those who come late are handed its last message.
    pub latched: bool,
    /// When it was met.
    pub met: Time,
    /// How many publish it.
    pub publishers: u64,
    /// How many messages came.
    pub messages: u64,
    /// The latest message, or, where it is latched, the latest few.
    latest: VecDeque<(Time, Bytes)>,
}

impl Graph {
    /// A stream is there, or more is known of it.
    pub fn offer(&mut self, at: Time, number: u32, channel: RawChannel, latched: bool) {
        let (topic, type_name) = (absolute(&channel.topic), normal_name(&channel.type_name));
        let stream = self.streams.entry(number).or_insert_with(|| Stream {
            channel: channel.clone(),
            topic,
            type_name,
            latched,
            met: at,
            publishers: 1,
            messages: 0,
            latest: VecDeque::new(),
        });
        (stream.channel, stream.latched) = (channel, latched);
    }

    /// The stream of that number.
    pub fn get(&self, number: u32) -> Option<&Stream> {
        self.streams.get(&number)
    }

    /// The number of the stream of a topic with a type.
    pub fn find(&self, topic: &str, type_name: &str) -> Option<u32> {
        let is_it = |s: &Stream| s.topic == topic && s.type_name == normal_name(type_name);
        self.streams.iter().find(|(_, s)| is_it(s)).map(|(number, _)| *number)
    }

    /// So many publish a stream now.
    pub fn publish(&mut self, number: u32, count: u64) {
        if let Some(stream) = self.streams.get_mut(&number) {
            stream.publishers = count;
        }
    }

    /// How many publish a topic, with whatever type.
    pub fn publishers(&self, topic: &str) -> u64 {
        self.streams.values().filter(|s| s.topic == topic).map(|s| s.publishers).sum()
    }

    /// How many messages of a topic came.
    pub fn messages(&self, topic: &str) -> u64 {
        self.streams.values().filter(|s| s.topic == topic).map(|s| s.messages).sum()
    }

    /// A message came.
    pub fn message(&mut self, number: u32, at: Time, payload: &Bytes) {
        let Some(stream) = self.streams.get_mut(&number) else { return };
        stream.messages += 1;
        let most = if stream.latched { LATCHED } else { 1 };
        while stream.latest.len() >= most || stream.has_too_much(payload.len()) {
            stream.latest.pop_front();
        }
        stream.latest.push_back((at, payload.clone()));
    }

    /// The latest messages of all streams, in the order in which they came.
    pub fn latest(&self) -> Vec<(Time, u32, Bytes)> {
        let of =
            |(number, s): (&u32, &Stream)| s.latest.iter().map(|(at, m)| (*at, *number, m.clone())).collect::<Vec<_>>();
        let mut all: Vec<_> = self.streams.iter().flat_map(of).collect();
        all.sort_by_key(|(at, number, _)| (*at, *number));
        all
    }

    /// Time went back: what came before means nothing any more. What is latched stands.
    pub fn forget(&mut self, at: Time) {
        for stream in self.streams.values_mut() {
            match stream.latched {
                true => stream.latest.iter_mut().for_each(|(stamp, _)| *stamp = (*stamp).min(at)),
                false => stream.latest.clear(),
            }
        }
    }

    /// The stream that a topic is read by: one that can be decoded, that somebody publishes, and that was met first.
    pub fn read_by(&self, topic: &str) -> Option<u32> {
        let readable = |s: &Stream| s.topic == topic && s.channel.ty.is_ok();
        let of_topic = self.streams.iter().filter(|(_, s)| readable(s));
        of_topic.min_by_key(|(number, s)| (s.publishers == 0, **number)).map(|(number, _)| *number)
    }

    /// The types that somebody publishes a topic with, besides the one that it is read with.
    pub fn other_types(&self, topic: &str) -> Vec<String> {
        let read_by = self.read_by(topic);
        let others = self.streams.iter().filter(|(n, s)| s.topic == topic && s.publishers > 0 && Some(**n) != read_by);
        others.filter(|(_, s)| s.channel.ty.is_ok()).map(|(_, s)| s.type_name.clone()).collect()
    }

    /// What the graph carries, in the terms of the check.
    pub fn shape(&self) -> TraceShape {
        let mut topics: Vec<TraceTopic> = Vec::new();
        for (number, stream) in &self.streams {
            if self.read_by(&stream.topic) == Some(*number) {
                let schema = stream.channel.ty.as_ref().ok().and_then(|ty| ty.schema()).cloned();
                topics.push(TraceTopic { name: stream.topic.clone(), type_name: stream.type_name.clone(), schema });
            }
        }
        let is_unread = |s: &&Stream| !topics.iter().any(|topic| topic.name == s.topic);
        let unread: BTreeSet<String> = self.streams.values().filter(is_unread).map(|s| s.topic.clone()).collect();
        TraceShape { topics, live: true, unread: unread.into_iter().collect(), ..TraceShape::default() }
    }

    /// Whether somebody had published a topic before that time.
    pub fn had(&self, topic: &str, before: Time) -> bool {
        self.streams.values().any(|s| s.topic == topic && s.met < before)
    }

    /// The topic on the graph that a name was probably meant to be which nothing on it has, nor ever had.
    pub fn meant_by(&self, topic: &str) -> Option<&str> {
        let is_there = self.streams.values().any(|s| s.topic == topic);
        if is_there { None } else { suggest::nearest(topic, self.streams.values().map(|s| s.topic.as_str())) }
    }

    /// What the graph carries, with what cannot be read yet: each topic by its name alone.
    pub fn whole_shape(&self) -> TraceShape {
        let mut shape = self.shape();
        for stream in self.streams.values() {
            if shape.topic(&stream.topic).is_none() {
                let (name, type_name) = (stream.topic.clone(), stream.type_name.clone());
                shape.topics.push(TraceTopic { name, type_name, schema: None });
            }
        }
        shape
    }
}

impl Stream {
    fn has_too_much(&self, with: usize) -> bool {
        !self.latest.is_empty() && self.latest.iter().map(|(_, m)| m.len()).sum::<usize>() + with > LATCHED_BYTES
    }
}

/// A topic's name with its leading slash.
pub(crate) fn absolute(name: &str) -> String {
    if name.starts_with('/') { name.to_owned() } else { format!("/{name}") }
}
