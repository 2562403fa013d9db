//! What is published, what of it is wanted, and what stands in the way of seeing it: all that is known of the graph, without DDS.
//!
//! A stream is a topic with a type and the hash of that type. Publishers come to it and leave it. What is to be told of it comes out as
//! happenings; nothing here waits or sends.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::definitions::{Defined, undefined};
use super::description::TypeHash;
use super::graph::Gid;
use super::qos::Reading;
use crate::connector::{Cause, Happening, Offer, StreamId};

/// How long a topic may be without a publisher at first, or a type without its definition, before that is told.
pub const GRACE: Duration = Duration::from_secs(1);
/// After this time a definition that was not found is looked for again.
const AGAIN: Duration = Duration::from_secs(5);
/// How long messages may still come of a publisher that left.
const AFTERMATH: Duration = Duration::from_secs(10);

/// A publisher, as it was discovered.
#[derive(Clone, Debug)]
pub struct Publisher {
    /// Its GUID.
    pub gid: Gid,
    /// Its topic: `/odom`.
    pub topic: String,
    /// Its type: `nav_msgs/msg/Odometry`.
    pub type_name: String,
    /// The hash of its type, where it announces one.
    pub hash: Option<TypeHash>,
    /// How it is read, or why it cannot be.
    pub reading: Result<Reading, String>,
}

/// What became of the search for a definition.
#[derive(Clone, Debug)]
enum Search {
    /// Nobody wants it.
    Unwanted,
    /// Somebody wants it, since then.
    Wanted(Instant),
    /// It is asked for, since then.
    Asked(Instant, String),
    /// There it is.
    Found(Arc<Defined>),
    /// It was not found, for that reason, at that time.
    Missing(Instant, String),
}

#[derive(Debug)]
struct Stream {
    topic: String,
    type_name: String,
    hash: Option<TypeHash>,
    publishers: BTreeSet<Gid>,
    search: Search,
    is_told: bool,
}

#[derive(Debug)]
struct Known {
    publisher: Publisher,
    stream: usize,
    /// The number of its last message.
    last: Option<i64>,
    left: Option<Instant>,
}

#[derive(Debug)]
struct Wish {
    since: Instant,
    had_publisher: bool,
    told: BTreeSet<Cause>,
}

/// A stream whose definition is looked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quest {
    /// The stream.
    pub stream: StreamId,
    /// Its type.
    pub type_name: String,
    /// The hash that its publishers announce.
    pub hash: Option<TypeHash>,
    /// Its publishers: their nodes may know.
    pub publishers: Vec<Gid>,
    /// Since when.
    pub since: Instant,
}

/// What becomes of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrived {
    /// It belongs to a stream.
    Here {
        /// The stream.
        stream: StreamId,
        /// How many messages of its publisher are missing before it.
        missing: u64,
    },
    /// It is not to be delivered: another reader does that, or it came before, or it cannot be decoded, which is told otherwise.
    Elsewhere,
    /// Its publisher or its definition is not known yet.
    TooSoon,
}

/// All of it.
#[derive(Debug, Default)]
pub struct Catalogue {
    streams: Vec<Stream>,
    publishers: BTreeMap<Gid, Known>,
    wishes: BTreeMap<String, Wish>,
    /// Topics for which a reader is missing, with why it could not be made.
    unreadable: BTreeMap<String, BTreeSet<String>>,
}

impl Catalogue {
    /// Topics that are wanted from now on.
    pub fn want(&mut self, topics: &[String], now: Instant) {
        for topic in topics {
            let had_publisher = self.publishers.values().any(|k| k.left.is_none() && k.publisher.topic == *topic);
            let wish = Wish { since: now, had_publisher, told: BTreeSet::new() };
            self.wishes.entry(topic.clone()).or_insert(wish);
        }
        for stream in self.streams.iter_mut().filter(|s| topics.contains(&s.topic)) {
            if matches!(stream.search, Search::Unwanted) {
                stream.search = Search::Wanted(now);
            }
        }
    }

    /// The topics that are wanted.
    pub fn wanted(&self) -> impl Iterator<Item = &String> {
        self.wishes.keys()
    }

    /// Compares with all publishers that there are now: some may be new, some gone.
    pub fn compare(&mut self, now: Instant, found: Vec<Publisher>) -> Vec<Happening> {
        let present: BTreeSet<Gid> = found.iter().map(|p| p.gid).collect();
        let known = self.publishers.iter().filter(|(_, k)| k.left.is_none());
        let gone: Vec<Gid> = known.map(|(gid, _)| *gid).filter(|gid| !present.contains(gid)).collect();
        let mut told: Vec<Happening> = gone.into_iter().filter_map(|gid| self.leave(now, gid)).collect();
        told.extend(found.into_iter().filter_map(|publisher| self.come(now, publisher)));
        self.publishers.retain(|_, k| k.left.is_none_or(|left| now < left + AFTERMATH));
        told
    }

    fn come(&mut self, now: Instant, publisher: Publisher) -> Option<Happening> {
        if self.publishers.get(&publisher.gid).is_some_and(|k| k.left.is_none()) {
            return None;
        }
        let wish = self.wishes.get_mut(&publisher.topic);
        let is_wanted = wish.map(|w| w.had_publisher = true).is_some();
        let at = self.place(&publisher).unwrap_or_else(|| {
            let search = if is_wanted { Search::Wanted(now) } else { Search::Unwanted };
            self.streams.push(Stream {
                topic: publisher.topic.clone(),
                type_name: publisher.type_name.clone(),
                hash: publisher.hash,
                publishers: BTreeSet::new(),
                search,
                is_told: false,
            });
            self.streams.len() - 1
        });
        let gid = publisher.gid;
        self.publishers.insert(gid, Known { publisher, stream: at, last: None, left: None });
        let stream = self.streams.get_mut(at)?;
        stream.publishers.insert(gid);
        if stream.is_told { self.count(at) } else { (!is_wanted).then(|| self.offer(at)).flatten() }
    }

    fn leave(&mut self, now: Instant, gid: Gid) -> Option<Happening> {
        let known = self.publishers.get_mut(&gid)?;
        known.left = Some(now);
        let at = known.stream;
        let stream = self.streams.get_mut(at)?;
        stream.publishers.remove(&gid);
        if stream.is_told { self.count(at) } else { None }
    }

    /// The stream that a publisher belongs to. One without a hash joins any of its topic and type.
    fn place(&self, publisher: &Publisher) -> Option<usize> {
        let is_like = |s: &Stream| s.topic == publisher.topic && s.type_name == publisher.type_name;
        let has_hash = |s: &Stream| match (&s.search, s.hash) {
            (Search::Found(defined), None) => defined.hash == publisher.hash,
            (_, hash) => hash == publisher.hash,
        };
        let exact = self.streams.iter().position(|s| is_like(s) && has_hash(s));
        exact.or_else(|| if publisher.hash.is_none() { self.streams.iter().position(is_like) } else { None })
    }

    fn count(&self, at: usize) -> Option<Happening> {
        let count = self.streams.get(at)?.publishers.len();
        Some(Happening::Publishers { stream: id(at), count })
    }

    /// What there is to say of a stream.
    fn offer(&mut self, at: usize) -> Option<Happening> {
        let stream = self.streams.get_mut(at)?;
        stream.is_told = true;
        let (topic, type_name) = (&stream.topic, &stream.type_name);
        let channel = match &stream.search {
            Search::Found(defined) => defined.channel(topic, type_name),
            Search::Missing(_, why) => undefined(topic, type_name, why.clone()),
            _ => undefined(topic, type_name, "nobody subscribed to it yet".to_owned()),
        };
        let mut publishers = stream.publishers.iter().filter_map(|gid| self.publishers.get(gid));
        let latched = publishers.any(|k| k.publisher.reading.as_ref().is_ok_and(|r| r.is_kept));
        Some(Happening::Stream(Offer { stream: id(at), channel, latched }))
    }

    /// The streams whose definition has to be looked for now.
    pub fn quests(&self, now: Instant) -> Vec<Quest> {
        let quest = |(at, stream): (usize, &Stream)| {
            let since = match stream.search {
                Search::Wanted(since) => since,
                Search::Missing(when, _) if now >= when + AGAIN => now,
                _ => return None,
            };
            let publishers: Vec<Gid> = stream.publishers.iter().copied().collect();
            let (type_name, hash) = (stream.type_name.clone(), stream.hash);
            (!publishers.is_empty()).then(|| Quest { stream: id(at), type_name, hash, publishers, since })
        };
        self.streams.iter().enumerate().filter_map(quest).collect()
    }

    /// Notes that a node was asked.
    pub fn asked(&mut self, stream: StreamId, node: &str, now: Instant) {
        if let Some(stream) = self.streams.get_mut(stream.0 as usize) {
            stream.search = Search::Asked(now, node.to_owned());
        }
    }

    /// Notes how the search ended. Gives what there is to tell: the offer, and the number of publishers where it is not one.
    pub fn searched(&mut self, stream: StreamId, result: Result<Arc<Defined>, String>, now: Instant) -> Vec<Happening> {
        let at = stream.0 as usize;
        let Some(stream) = self.streams.get_mut(at) else { return Vec::new() };
        let is_again = matches!(stream.search, Search::Missing(..)) && stream.is_told && result.is_err();
        stream.search = match result {
            Ok(defined) => Search::Found(defined),
            Err(why) => Search::Missing(now, why),
        };
        if is_again {
            return Vec::new();
        }
        let count = (stream.publishers.len() != 1).then(|| self.count(at)).flatten();
        self.offer(at).into_iter().chain(count).collect()
    }

    /// The readers that it takes to see all that is wanted: topic, type, and how.
    pub fn readers(&self) -> BTreeSet<(String, String, Reading)> {
        let live = self.publishers.values().filter(|k| k.left.is_none());
        let readable = live.filter_map(|k| {
            let stream = self.streams.get(k.stream)?;
            let (Search::Found(_), Ok(reading)) = (&stream.search, &k.publisher.reading) else { return None };
            self.wishes.contains_key(&stream.topic).then(|| (stream.topic.clone(), stream.type_name.clone(), *reading))
        });
        readable.collect()
    }

    /// The topics for which a reader is missing, with why: these, and no others.
    pub fn unreadable(&mut self, topics: BTreeMap<String, BTreeSet<String>>) {
        self.unreadable = topics;
    }

    /// A message came.
    ///
    /// A topic has one cache for all of its readers, so that each sees what came for any; a publisher is heard by the one that suits it best.
    pub fn arrived(&mut self, publisher: &Gid, by: Reading, number: i64) -> Arrived {
        let Some(known) = self.publishers.get_mut(publisher) else { return Arrived::TooSoon };
        if known.publisher.reading != Ok(by) {
            return Arrived::Elsewhere;
        }
        match self.streams.get(known.stream).map(|s| &s.search) {
            Some(Search::Found(_)) => {}
            Some(Search::Wanted(_) | Search::Asked(..)) => return Arrived::TooSoon,
            _ => return Arrived::Elsewhere,
        }
        let missing = match known.last {
            Some(last) if number <= last => return Arrived::Elsewhere,
            Some(last) => number.abs_diff(last) - 1,
            None => 0,
        };
        known.last = Some(number);
        Arrived::Here { stream: id(known.stream), missing }
    }

    /// What stands in the way of each wanted topic, as far as it was not told yet, or was told and is no more.
    pub fn tell(&mut self, now: Instant) -> Vec<Happening> {
        let mut told = Vec::new();
        for (topic, wish) in &mut self.wishes {
            let mut causes = causes(&self.streams, &self.publishers, topic, wish, now);
            causes.extend(self.unreadable.get(topic).into_iter().flatten().cloned().map(Cause::Disconnected));
            let over = wish.told.difference(&causes).cloned();
            told.extend(over.map(|cause| Happening::Sees { topic: topic.clone(), cause }));
            let new = causes.difference(&wish.told).cloned();
            told.extend(new.map(|cause| Happening::Blind { topic: topic.clone(), cause }));
            wish.told = causes;
        }
        told
    }
}

fn causes(
    streams: &[Stream],
    publishers: &BTreeMap<Gid, Known>,
    topic: &str,
    wish: &Wish,
    now: Instant,
) -> BTreeSet<Cause> {
    let mut causes = BTreeSet::new();
    let live: Vec<&Stream> = streams.iter().filter(|s| s.topic == topic && !s.publishers.is_empty()).collect();
    if live.is_empty() && (wish.had_publisher || now >= wish.since + GRACE) {
        causes.insert(Cause::NoPublisher);
    }
    for stream in live {
        let known = stream.publishers.iter().filter_map(|gid| publishers.get(gid));
        let obstacles = known.filter_map(|k| k.publisher.reading.as_ref().err());
        causes.extend(obstacles.map(|why| Cause::Incompatible(why.clone())));
        causes.extend(obscurity(&stream.search, now).map(Cause::Undefined));
    }
    causes
}

/// Why nothing is known of a type.
fn obscurity(search: &Search, now: Instant) -> Option<String> {
    match search {
        Search::Missing(_, why) => Some(why.clone()),
        Search::Found(defined) => defined.ty.as_ref().err().cloned(),
        Search::Asked(since, node) => {
            (now >= *since + GRACE).then(|| format!("{node} was asked for it and is silent so far"))
        }
        Search::Wanted(since) => {
            (now >= *since + GRACE).then(|| "the node of its publisher is not known yet".to_owned())
        }
        Search::Unwanted => None,
    }
}

fn id(at: usize) -> StreamId {
    StreamId(u32::try_from(at).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::super::definitions::Definitions;
    use super::*;

    const ODOM: &str = "/odom";
    const TYPE: &str = "nav_msgs/msg/Odometry";
    const BEST: Reading = Reading { is_reliable: true, is_kept: true };
    const LEAST: Reading = Reading { is_reliable: false, is_kept: false };

    fn publisher(k: u8) -> Publisher {
        let (topic, type_name) = (ODOM.to_owned(), TYPE.to_owned());
        Publisher { gid: [k; 16], topic, type_name, hash: None, reading: Ok(BEST) }
    }

    fn found() -> Arc<Defined> {
        Definitions::new(Vec::new()).fitting(TYPE, None).unwrap()
    }

    fn here(missing: u64) -> Arrived {
        Arrived::Here { stream: StreamId(0), missing }
    }

    fn soon(seconds: f64) -> Duration {
        Duration::from_secs_f64(seconds)
    }

    /// A catalogue in which `/odom` is wanted and published by one, and its definition is known.
    fn seeing(now: Instant) -> Catalogue {
        let mut catalogue = Catalogue::default();
        catalogue.want(&[ODOM.to_owned()], now);
        assert!(catalogue.compare(now, vec![publisher(1)]).is_empty(), "told only with its definition");
        let quests = catalogue.quests(now);
        assert_eq!(quests.len(), 1);
        let told = catalogue.searched(quests[0].stream, Ok(found()), now);
        assert!(
            matches!(&told[..], [Happening::Stream(offer)] if offer.latched && offer.channel.ty.is_ok()),
            "{told:?}"
        );
        assert!(catalogue.quests(now).is_empty());
        catalogue
    }

    #[test]
    fn what_nobody_wants_is_offered_without_a_definition() {
        let (mut catalogue, now) = (Catalogue::default(), Instant::now());
        let told = catalogue.compare(now, vec![publisher(1)]);
        assert!(matches!(&told[..], [Happening::Stream(offer)] if offer.channel.ty.is_err()), "{told:?}");
        assert!(catalogue.quests(now).is_empty() && catalogue.readers().is_empty());
        let told = catalogue.compare(now, vec![publisher(1), publisher(2)]);
        assert!(matches!(told[..], [Happening::Publishers { stream: StreamId(0), count: 2 }]), "{told:?}");
        catalogue.want(&[ODOM.to_owned()], now);
        assert_eq!(catalogue.quests(now).len(), 1);
        let told = catalogue.searched(StreamId(0), Ok(found()), now);
        assert!(matches!(told[..], [Happening::Stream(_), Happening::Publishers { count: 2, .. }]), "{told:?}");
        assert_eq!(catalogue.readers().len(), 1);
    }

    #[test]
    fn a_topic_is_given_a_second_to_be_found() {
        let (mut catalogue, now) = (Catalogue::default(), Instant::now());
        catalogue.want(&[ODOM.to_owned()], now);
        assert!(catalogue.tell(now + soon(0.9)).is_empty());
        let told = catalogue.tell(now + soon(1.0));
        assert!(matches!(&told[..], [Happening::Blind { cause: Cause::NoPublisher, .. }]), "{told:?}");
        assert!(catalogue.tell(now + soon(2.0)).is_empty(), "once is enough");
        catalogue.compare(now, vec![publisher(1)]);
        let told = catalogue.tell(now + soon(2.0));
        assert!(matches!(&told[0], Happening::Sees { cause: Cause::NoPublisher, .. }), "{told:?}");
    }

    #[test]
    fn a_publisher_that_left_is_missed_at_once() {
        let now = Instant::now();
        let mut catalogue = seeing(now);
        assert!(catalogue.tell(now).is_empty());
        let told = catalogue.compare(now, Vec::new());
        assert!(matches!(told[..], [Happening::Publishers { count: 0, .. }]), "{told:?}");
        let told = catalogue.tell(now);
        assert!(matches!(&told[..], [Happening::Blind { cause: Cause::NoPublisher, .. }]), "{told:?}");
        // Its last messages may come after it left.
        assert_eq!(catalogue.arrived(&[1; 16], BEST, 8), here(0));
        let told = catalogue.compare(now, vec![publisher(2)]);
        assert!(matches!(told[..], [Happening::Publishers { count: 1, .. }]), "{told:?}");
        catalogue.compare(now + soon(11.0), vec![publisher(2)]);
        assert_eq!(catalogue.arrived(&[1; 16], BEST, 9), Arrived::TooSoon);
    }

    #[test]
    fn numbers_that_are_missing_are_counted_by_publisher() {
        let mut catalogue = seeing(Instant::now());
        catalogue.compare(Instant::now(), vec![publisher(1), publisher(2)]);
        let cases = [
            (1, 5, here(0)),
            (1, 6, here(0)),
            (2, 1, here(0)),
            (1, 9, here(2)),
            (1, 9, Arrived::Elsewhere),
            (1, 7, Arrived::Elsewhere),
            (2, 2, here(0)),
            (1, i64::MIN, Arrived::Elsewhere),
            (2, i64::MAX, here(i64::MAX as u64 - 3)),
            (3, 1, Arrived::TooSoon),
        ];
        for (k, number, expected) in cases {
            assert_eq!(catalogue.arrived(&[k; 16], BEST, number), expected, "{k} {number}");
        }
        assert_eq!(catalogue.arrived(&[1; 16], LEAST, 10), Arrived::Elsewhere, "another reader delivers it");
    }

    #[test]
    fn a_message_may_come_before_its_definition() {
        let (mut catalogue, now) = (Catalogue::default(), Instant::now());
        catalogue.want(&[ODOM.to_owned()], now);
        catalogue.compare(now, vec![publisher(1)]);
        assert_eq!(catalogue.arrived(&[1; 16], BEST, 1), Arrived::TooSoon);
        catalogue.asked(StreamId(0), "/n1", now);
        assert_eq!(catalogue.arrived(&[1; 16], BEST, 1), Arrived::TooSoon);
        catalogue.searched(StreamId(0), Ok(found()), now);
        assert_eq!(catalogue.arrived(&[1; 16], BEST, 1), here(0));
    }

    #[test]
    fn what_stands_in_the_way_is_told_as_long_as_it_does() {
        let now = Instant::now();
        let mut catalogue = seeing(now);
        let odd = Publisher { reading: Err("OWNERSHIP".to_owned()), ..publisher(2) };
        catalogue.compare(now, vec![publisher(1), odd]);
        let told = catalogue.tell(now);
        assert!(matches!(&told[..], [Happening::Blind { cause: Cause::Incompatible(_), .. }]), "{told:?}");
        assert_eq!(catalogue.readers().len(), 1);
        catalogue.compare(now, vec![publisher(1)]);
        let told = catalogue.tell(now);
        assert!(matches!(&told[..], [Happening::Sees { cause: Cause::Incompatible(_), .. }]), "{told:?}");
    }

    #[test]
    fn a_reader_that_could_not_be_made_blinds_until_it_is_there() {
        let now = Instant::now();
        let mut catalogue = seeing(now);
        let without = || BTreeMap::from([(ODOM.to_owned(), BTreeSet::from(["no socket".to_owned()]))]);
        catalogue.unreadable(without());
        let told = catalogue.tell(now);
        let [Happening::Blind { cause: Cause::Disconnected(why), .. }] = &told[..] else { panic!("{told:?}") };
        assert_eq!(why, "no socket");
        catalogue.unreadable(without());
        assert!(catalogue.tell(now + soon(0.5)).is_empty(), "once is enough");
        catalogue.unreadable(BTreeMap::new());
        let told = catalogue.tell(now + soon(1.0));
        assert!(matches!(&told[..], [Happening::Sees { cause: Cause::Disconnected(_), .. }]), "{told:?}");
    }

    #[test]
    fn a_definition_that_is_missing_is_looked_for_again() {
        let (mut catalogue, now) = (Catalogue::default(), Instant::now());
        catalogue.want(&[ODOM.to_owned()], now);
        catalogue.compare(now, vec![publisher(1)]);
        catalogue.asked(StreamId(0), "/n1", now);
        assert!(catalogue.tell(now + soon(0.5)).is_empty());
        let told = catalogue.tell(now + soon(1.0));
        let [Happening::Blind { cause: Cause::Undefined(why), .. }] = &told[..] else { panic!("{told:?}") };
        assert!(why.contains("/n1"), "{why}");
        let told = catalogue.searched(StreamId(0), Err("nobody knows".to_owned()), now + soon(3.0));
        assert!(matches!(&told[..], [Happening::Stream(offer)] if offer.channel.ty.is_err()), "{told:?}");
        assert!(catalogue.readers().is_empty());
        assert!(catalogue.quests(now + soon(4.0)).is_empty());
        assert_eq!(catalogue.quests(now + soon(8.0)).len(), 1);
        assert!(catalogue.searched(StreamId(0), Err("nobody knows".to_owned()), now + soon(8.0)).is_empty());
        assert_eq!(catalogue.searched(StreamId(0), Ok(found()), now + soon(13.0)).len(), 1);
        assert_eq!(catalogue.readers().len(), 1);
    }

    #[test]
    fn two_hashes_are_two_streams() {
        let (mut catalogue, now) = (Catalogue::default(), Instant::now());
        let with = |k: u8, digit: Option<&str>| {
            let hash = digit.and_then(|d| TypeHash::parse(&format!("RIHS01_{}", d.repeat(64))));
            Publisher { hash, ..publisher(k) }
        };
        let told =
            catalogue.compare(now, vec![with(1, Some("a")), with(2, Some("b")), with(3, None), with(4, Some("a"))]);
        let streams = told.iter().filter(|w| matches!(w, Happening::Stream(_))).count();
        assert_eq!((streams, told.len()), (2, 4), "one without a hash joins the first: {told:?}");
    }
}
