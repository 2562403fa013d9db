//! A reader of a topic, and how what it takes gets into the queue.

use std::time::{Duration, Instant};

use super::catalogue::{Arrived, Catalogue};
use super::qos::Reading;
use super::wire::{RawReader, Sample, Wire};
use super::{name, room};
use crate::connector::{Happening, Refused};
use crate::inbox::Inbox;

/// How many bytes of messages of a topic may wait inside of DDS, and between which numbers of messages that has to lie: the cache counts only
/// messages.
const WAITING: usize = 32 << 20;
const ROOMS: (i32, i32) = (4, 1 << 14);
/// How many messages of one reader are taken before others have their turn.
const TURN: usize = 512;
/// How many messages wait, and how long, for their publisher to be discovered and their definition to be found.
const HELD: usize = 256;
const HELD_FOR: Duration = Duration::from_secs(5);

/// After so many bytes of large messages, or so many of them, a reader is followed by another one, and stays for that long beside it.
///
/// RustDDS keeps what comes twice of a large message as one that never becomes whole, for ten seconds, and stops when there are 128 of them: only a
/// reader's end frees it of them. What both readers hear is delivered once, as messages are numbered.
const WORN: usize = 160 << 20;
const WORN_BY: usize = 48;
const OVERLAP: Duration = Duration::from_secs(1);

/// A reader of a topic.
pub struct Feed {
    /// The reader.
    pub reader: RawReader,
    /// Its topic: `/odom`.
    pub topic: String,
    /// Its type.
    pub type_name: String,
    /// How it reads: only publishers that are to be read so are heard by it.
    pub reading: Reading,
    /// Whether there may be more to take.
    pub is_ready: bool,
    /// The room that its topic has.
    room: i32,
    held: Vec<(Instant, Sample)>,
    is_advised: bool,
    /// How much the reader has read of large messages, in bytes.
    worn: usize,
    /// The reader before, and since when it is only beside.
    before: Option<(Instant, RawReader)>,
}

/// What a feed delivers to, and when.
pub struct Post<'a> {
    /// Who knows the publishers.
    pub catalogue: &'a mut Catalogue,
    /// The queue.
    pub inbox: &'a Inbox,
    /// DDS.
    pub wire: &'a Wire,
    /// The time.
    pub now: Instant,
}

impl Feed {
    /// A feed of a reader that was made with the [room](Feed::ROOM) of the beginning.
    pub fn new(reader: RawReader, topic: &str, type_name: &str, reading: Reading) -> Feed {
        let (topic, type_name) = (topic.to_owned(), type_name.to_owned());
        Feed {
            reader,
            topic,
            type_name,
            reading,
            is_ready: true,
            room: Feed::ROOM,
            held: Vec::new(),
            is_advised: false,
            worn: 0,
            before: None,
        }
    }

    /// For so many messages there is room before the first one has come.
    pub const ROOM: i32 = ROOMS.0;

    /// Delivers what was held, then a turn of what came.
    pub fn deliver_all(&mut self, post: &mut Post<'_>) {
        for (since, sample) in std::mem::take(&mut self.held) {
            self.deliver(since, sample, post);
        }
        if !self.is_ready {
            return;
        }
        self.reader.acknowledge();
        for _ in 0..TURN {
            match self.reader.take() {
                Ok(Some(sample)) => self.deliver(post.now, sample, post),
                Ok(None) => {
                    self.is_ready = false;
                    return;
                }
                Err(why) => {
                    let note = format!("a message on {} cannot be read: {why}", self.topic);
                    post.inbox.push(Happening::Note(note));
                }
            }
        }
    }

    /// Whether messages wait until more is known of the graph.
    pub fn is_holding(&self) -> bool {
        !self.held.is_empty()
    }

    fn deliver(&mut self, since: Instant, sample: Sample, post: &mut Post<'_>) {
        match post.catalogue.arrived(&sample.writer.to_bytes(), self.reading, sample.number) {
            Arrived::Here { stream, missing } => {
                if missing > 0 {
                    post.inbox.push(Happening::Lost { stream, count: missing });
                    self.advise(sample.payload.len(), post.inbox);
                }
                if room::is_large(sample.payload.len()) {
                    self.worn += sample.payload.len().max(WORN.div_ceil(WORN_BY));
                }
                self.make_room(post.wire, sample.payload.len());
                post.inbox.push(Happening::Message { stream, payload: sample.payload });
            }
            Arrived::Elsewhere => {}
            // What the node itself publishes is not watched.
            Arrived::TooSoon if post.wire.is_own(sample.writer) => {}
            Arrived::TooSoon if self.held.len() < HELD && post.now < since + HELD_FOR => {
                self.held.push((since, sample));
            }
            Arrived::TooSoon => {
                let note = format!("a message on {} is left out: its publisher does not make itself known", self.topic);
                post.inbox.push(Happening::Note(note));
            }
        }
    }

    /// Has a reader followed that has read so much of large messages; `watch` has the next one watched. Should it not be made, it is tried again with
    /// the next messages.
    pub fn renew(&mut self, now: Instant, wire: &Wire, watch: impl FnOnce(&mut RawReader) -> Result<(), Refused>) {
        if self.before.as_ref().is_some_and(|(since, _)| now >= *since + OVERLAP) {
            self.before = None;
        }
        if self.worn < WORN || self.before.is_some() {
            return;
        }
        self.worn = 0;
        let ty = name::type_on_wire(&self.type_name).unwrap_or_else(|| self.type_name.clone());
        let request = self.reading.request(self.room);
        let Ok(mut next) = wire.read_instead(&name::topic_on_wire(&self.topic), &ty, &request, &self.reader) else {
            return;
        };
        if watch(&mut next).is_ok() {
            self.before = Some((now, std::mem::replace(&mut self.reader, next)));
            self.is_ready = true;
        }
    }

    /// Says once what helps, where messages are lost because they are large.
    fn advise(&mut self, size: usize, inbox: &Inbox) {
        if !std::mem::replace(&mut self.is_advised, true) {
            let advice = room::allowed().and_then(|allowed| room::advice(&self.topic, size, allowed));
            advice.into_iter().for_each(|text| inbox.push(Happening::Note(text)));
        }
    }

    /// Gives the topic more room, if its messages are small enough for that.
    fn make_room(&mut self, wire: &Wire, size: usize) {
        let fitting = i32::try_from(WAITING / size.max(1)).unwrap_or(i32::MAX).clamp(ROOMS.0, ROOMS.1);
        if fitting < self.room.saturating_mul(2) {
            return;
        }
        let ty = name::type_on_wire(&self.type_name).unwrap_or_else(|| self.type_name.clone());
        // It is tried once: without, a burst may be lost, which is counted and told.
        self.room = fitting;
        let _ = wire.enlarge(&name::topic_on_wire(&self.topic), &ty, &self.reading.request(fitting));
    }
}
