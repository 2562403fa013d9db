//! The thread between DDS and the queue. It sleeps until something comes, takes it, and looks at the whole graph again whenever DDS says
//! that it changed.
//!
//! DDS tells of changes by events that it drops when there are too many. So an event is only a reason to look: what counts
//! is the list of all publishers, which is compared with what was known, twice a second in any case.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::mpsc::{Receiver, Sender, TryRecvError};
use std::time::{Duration, Instant};

use bytes::Bytes;
use rustdds::mio1::{Events, Interest, Poll, Token, Waker};
use rustdds::{DomainParticipantStatusEvent, DomainParticipantStatusListener, GUID, RTPSEntity, StatusEvented};

use super::catalogue::{Catalogue, Publisher, Quest};
use super::client::Clients;
use super::definitions::Definitions;
use super::description::TypeHash;
use super::feed::{Feed, Post};
use super::graph::{self, Gid, Graph, Participant};
use super::qos::Reading;
use super::wire::{Endpoint, RawReader, Wire};
use super::{describe, name, seek};
use crate::connector::{CallId, Cause, Definition, Happening, Refused, StreamId};
use crate::inbox::Inbox;

const STATUS: Token = Token(0);
const COMMANDS: Token = Token(1);
const GRAPH: Token = Token(2);
/// The tokens of readers of topics begin here. Answers of services are not watched: whoever waits for one looks every hundredth of a second.
const FIRST: usize = 3;

/// How many participants may tell of themselves at once.
const NODES: i32 = 1 << 12;
/// How long a look at the graph may wait for more changes to come.
const SETTLING: Duration = Duration::from_millis(20);
/// How long the thread sleeps at most, while nobody waits for anything and while somebody does.
const IDLE: Duration = Duration::from_millis(100);
const BUSY: Duration = Duration::from_millis(10);
/// After this time the graph, and the readers, are looked at although nothing was said.
const ANYWAY: Duration = Duration::from_millis(500);
/// How long a node gets to describe a type.
const DESCRIBING: Duration = Duration::from_secs(3);

/// What the thread is asked to do.
pub enum Command {
    /// To read these topics.
    Subscribe(Vec<String>),
    /// To call a service.
    Call {
        /// The number of the call.
        id: CallId,
        /// The service.
        service: String,
        /// Its type.
        type_name: String,
        /// The request.
        request: Bytes,
        /// When to give up.
        deadline: Instant,
    },
    /// To ask the graph for a definition.
    Define {
        /// The type of a message.
        type_name: String,
        /// When to give up.
        deadline: Instant,
        /// Where the answer goes.
        reply: Sender<Result<Definition, Refused>>,
    },
    /// To end.
    Stop,
}

/// What an answer is for.
#[derive(Clone)]
pub(super) enum Purpose {
    /// For whoever called.
    Call(CallId),
    /// To decode a stream whose type has that hash, which that node was asked for.
    Stream(StreamId, String, TypeHash, String),
    /// For whoever asked for a definition.
    Definition(String, TypeHash, Sender<Result<Definition, Refused>>),
}

/// The thread's state.
pub struct Worker {
    wire: Wire,
    inbox: Inbox,
    commands: Receiver<Command>,
    poll: Poll,
    status: DomainParticipantStatusListener,
    graph_reader: RawReader,
    graph: Graph,
    catalogue: Catalogue,
    definitions: Definitions,
    clients: Clients<Purpose>,
    seekers: Vec<seek::Seeker>,
    feeds: BTreeMap<usize, Feed>,
    next_token: usize,
    looked: Instant,
    swept: Instant,
    told: Instant,
    is_changed: bool,
    /// Whether something was learnt that may blind a topic, or let it be seen.
    is_news: bool,
}

impl Worker {
    /// Ready to run; also what wakes it when a command was sent.
    pub fn new(
        wire: Wire,
        inbox: Inbox,
        definitions: Definitions,
        commands: Receiver<Command>,
    ) -> Result<(Worker, Waker), Refused> {
        let poll = Poll::new().map_err(|e| unwatched(&e))?;
        let waker = Waker::new(poll.registry(), COMMANDS).map_err(|e| unwatched(&e))?;
        let mut status = wire.participant.status_listener();
        watch(&poll, status.as_status_source_mio1(), STATUS)?;
        let kept = Reading { is_reliable: true, is_kept: true };
        let mut graph_reader = wire.read_quietly(graph::TOPIC, graph::TYPE, &kept.request(NODES))?;
        watch(&poll, graph_reader.source(), GRAPH)?;
        let worker = Worker {
            wire,
            inbox,
            commands,
            poll,
            status,
            graph_reader,
            graph: Graph::default(),
            catalogue: Catalogue::default(),
            definitions,
            clients: Clients::new(),
            seekers: Vec::new(),
            feeds: BTreeMap::new(),
            next_token: FIRST,
            looked: Instant::now(),
            swept: Instant::now(),
            told: Instant::now(),
            is_changed: true,
            is_news: false,
        };
        Ok((worker, waker))
    }

    /// Works until it is told to stop, or nobody can tell it any more.
    pub fn run(mut self) {
        let mut events = Events::with_capacity(256);
        loop {
            // An error is an interruption by a signal: what came is found in any case.
            let _ = self.poll.poll(&mut events, Some(self.patience()));
            for event in &events {
                if let Some(feed) = self.feeds.get_mut(&event.token().0) {
                    feed.is_ready = true;
                }
            }
            if !self.obey() {
                return;
            }
            self.hear_of_nodes();
            self.take_all();
            self.hear_of_changes();
            let now = Instant::now();
            if now >= self.looked + ANYWAY || (self.is_changed && now >= self.looked + SETTLING) {
                self.look(now);
            }
            self.tend_calls(now);
            self.tell(now);
        }
    }

    /// Tells what can be seen and what cannot: at once where something was learnt, and now and then, for patience ends by time alone.
    fn tell(&mut self, now: Instant) {
        if self.is_news || now >= self.told + BUSY {
            (self.told, self.is_news) = (now, false);
            self.catalogue.tell(now).into_iter().for_each(|what| self.inbox.push(what));
        }
    }

    fn patience(&self) -> Duration {
        if self.feeds.values().any(|f| f.is_ready) {
            Duration::ZERO
        } else if self.is_changed || self.clients.is_waiting() || !self.seekers.is_empty() {
            BUSY
        } else {
            IDLE
        }
    }

    /// Does what it was told. False at the end.
    fn obey(&mut self) -> bool {
        loop {
            match self.commands.try_recv() {
                Ok(Command::Subscribe(topics)) => {
                    self.catalogue.want(&topics, Instant::now());
                    (self.is_changed, self.is_news) = (true, true);
                }
                Ok(Command::Call { id, service, type_name, request, deadline }) => {
                    if let Err(Refused(why)) = self.call(Purpose::Call(id), (&service, &type_name), request, deadline) {
                        self.inbox.push(Happening::Reply { call: id, answer: Err(why) });
                    }
                }
                Ok(Command::Define { type_name, deadline, reply }) => {
                    self.seekers.push(seek::Seeker { type_name, deadline, reply });
                    self.is_changed = true;
                }
                Ok(Command::Stop) | Err(TryRecvError::Disconnected) => return false,
                Err(TryRecvError::Empty) => return true,
            }
        }
    }

    fn call(
        &mut self,
        purpose: Purpose,
        service: (&str, &str),
        request: Bytes,
        deadline: Instant,
    ) -> Result<(), Refused> {
        self.clients.call(&self.wire, purpose, service, request, deadline)?;
        self.is_changed = true;
        Ok(())
    }

    /// Takes what participants tell of their nodes.
    fn hear_of_nodes(&mut self) {
        self.graph_reader.acknowledge();
        // What does not decode is some other version's: then its nodes stay nameless, which is told where it matters.
        while let Ok(Some(sample)) = self.graph_reader.take() {
            if let Ok(participant) = Participant::decode(&sample.payload) {
                let left = self.graph.note(participant);
                self.is_changed = true;
                self.say_goodbye(left);
            }
        }
    }

    fn say_goodbye(&self, nodes: Vec<String>) {
        nodes.into_iter().for_each(|node| self.inbox.push(Happening::Note(format!("the node {node} left"))));
    }

    /// Takes what DDS tells of changes.
    fn hear_of_changes(&mut self) {
        while let Some(event) = self.status.try_recv_status() {
            self.is_changed = true;
            match event {
                DomainParticipantStatusEvent::ParticipantLost { id, .. } => {
                    let participant = GUID { prefix: id, ..self.wire.participant.guid() };
                    let left = self.graph.forget(participant.to_bytes());
                    self.say_goodbye(left);
                }
                DomainParticipantStatusEvent::RemoteReaderMatched { local_writer: own, remote_reader: other }
                | DomainParticipantStatusEvent::RemoteWriterMatched { local_reader: own, remote_writer: other } => {
                    self.clients.matched(own, other, Instant::now());
                }
                DomainParticipantStatusEvent::RemoteReaderQosIncompatible {
                    remote_reader,
                    offered_qos,
                    requested_qos,
                    ..
                } => {
                    let policy = offered_qos.compliance_failure_wrt(&requested_qos);
                    let who = self.graph.owner(&remote_reader.to_bytes()).unwrap_or("a subscriber");
                    let policy = policy.map_or_else(String::new, |p| format!(": it asks for another {p:?}"));
                    let note = format!("{who} cannot hear what is published here{policy}");
                    self.inbox.push(Happening::Note(note));
                }
                _ => {}
            }
        }
    }

    /// Compares the graph with what was known of it, and does what follows from that.
    fn look(&mut self, now: Instant) {
        (self.looked, self.is_changed, self.is_news) = (now, false, true);
        let writers = self.wire.writers();
        let readers = self.wire.readers();
        let found = writers.iter().filter_map(|w| self.publisher(w)).collect();
        self.catalogue.compare(now, found).into_iter().for_each(|what| self.inbox.push(what));
        self.clients.meet(&readers, &writers, now);
        self.seek(&readers, &writers, now);
        for quest in self.catalogue.quests(now) {
            self.pursue(&quest, now);
        }
        self.open_feeds();
    }

    fn publisher(&self, writer: &Endpoint) -> Option<Publisher> {
        let gid = writer.guid.to_bytes();
        Some(Publisher {
            gid,
            topic: name::topic(&writer.topic)?,
            type_name: name::type_name(&writer.type_name),
            hash: TypeHash::announced(&writer.user_data),
            reading: readable(gid).and_then(|()| Reading::of(&writer.qos)),
        })
    }

    /// Looks for the definition of a stream: at hand, else with the node of one of its publishers.
    fn pursue(&mut self, quest: &Quest, now: Instant) {
        let (stream, type_name) = (quest.stream, quest.type_name.as_str());
        if let Some(defined) = self.definitions.fitting(type_name, quest.hash) {
            return self.searched(stream, Ok(defined), now);
        }
        let missing = self.definitions.mismatch(type_name, quest.hash);
        let Some(hash) = quest.hash else { return self.searched(stream, Err(missing), now) };
        let node = quest.publishers.iter().find_map(|gid| self.graph.owner(gid)).map(str::to_owned);
        let Some(node) = node else {
            // Which node it is may come a moment later than the publisher.
            self.is_changed = true;
            if now >= quest.since + DESCRIBING {
                self.searched(stream, Err(format!("{missing}; the publisher is of no node that could be asked")), now);
            }
            return;
        };
        let purpose = Purpose::Stream(stream, type_name.to_owned(), hash, node.clone());
        let request = describe::request(type_name, hash).into();
        match self.call(purpose, (&describe::service(&node), describe::TYPE), request, now + DESCRIBING) {
            Ok(()) => self.catalogue.asked(stream, &node, now),
            Err(Refused(why)) => self.searched(stream, Err(why), now),
        }
    }

    fn searched(
        &mut self,
        stream: StreamId,
        result: Result<std::sync::Arc<super::definitions::Defined>, String>,
        now: Instant,
    ) {
        self.catalogue.searched(stream, result, now).into_iter().for_each(|what| self.inbox.push(what));
        self.is_news = true;
        self.open_feeds();
    }

    /// Asks nodes for the definitions that somebody waits for.
    fn seek(&mut self, readers: &[Endpoint], writers: &[Endpoint], now: Instant) {
        for seeker in std::mem::take(&mut self.seekers) {
            let endpoint = seek::endpoint(&seeker.type_name, readers, writers);
            let known = endpoint.and_then(|(gid, hash)| Some((self.graph.owner(&gid)?.to_owned(), hash)));
            match known {
                Some((node, hash)) => {
                    let seek::Seeker { type_name, deadline, reply } = seeker;
                    let request = describe::request(&type_name, hash).into();
                    let purpose = Purpose::Definition(type_name, hash, reply.clone());
                    if let Err(refused) =
                        self.call(purpose, (&describe::service(&node), describe::TYPE), request, deadline)
                    {
                        let _ = reply.send(Err(refused));
                    }
                }
                None if now < seeker.deadline => {
                    self.is_changed = true;
                    self.seekers.push(seeker);
                }
                None => seeker.give_up(),
            }
        }
    }

    fn tend_calls(&mut self, now: Instant) {
        for (purpose, answer) in self.clients.tend(now) {
            match purpose {
                Purpose::Call(call) => self.inbox.push(Happening::Reply { call, answer }),
                Purpose::Stream(stream, type_name, hash, node) => {
                    let described = answer.and_then(|bytes| describe::answer(&bytes));
                    let learnt = described.and_then(|a| self.definitions.learn(&type_name, hash, &node, &a));
                    let missing = self.definitions.mismatch(&type_name, Some(hash));
                    self.searched(
                        stream,
                        learnt.map_err(|why| format!("{missing}; {node} was asked for it: {why}")),
                        now,
                    );
                }
                Purpose::Definition(type_name, hash, reply) => {
                    let found = answer.and_then(|bytes| describe::answer(&bytes));
                    let found = found.and_then(|a| seek::definition(&type_name, hash, &a));
                    // Whoever asked may be gone by now.
                    let _ = reply.send(found.map_err(Refused));
                }
            }
        }
    }

    /// Opens the readers that are missing. One that cannot be opened is in the way of its topic until it can.
    fn open_feeds(&mut self) {
        let mut unreadable: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (topic, type_name, reading) in self.catalogue.readers() {
            let is_this = |f: &Feed| f.topic == topic && f.type_name == type_name && f.reading == reading;
            if self.feeds.values().any(is_this) {
                continue;
            }
            if let Err(Refused(why)) = self.open_feed(&topic, &type_name, reading) {
                unreadable.entry(topic).or_default().insert(why);
            }
        }
        self.catalogue.unreadable(unreadable);
    }

    fn open_feed(&mut self, topic: &str, type_name: &str, reading: Reading) -> Result<(), Refused> {
        let on_wire = name::topic_on_wire(topic);
        let ty = name::type_on_wire(type_name).unwrap_or_else(|| type_name.to_owned());
        let mut reader = self.wire.read(&on_wire, &ty, &reading.request(Feed::ROOM))?;
        let token = self.next_token;
        self.next_token += 1;
        watch(&self.poll, reader.source(), Token(token))?;
        self.feeds.insert(token, Feed::new(reader, topic, type_name, reading));
        Ok(())
    }

    /// Takes what came on topics: of each reader a turn. Now and then all are looked at, whatever was said.
    fn take_all(&mut self) {
        let now = Instant::now();
        let is_due = now >= self.swept + ANYWAY;
        if is_due {
            self.swept = now;
        }
        let mut post = Post { catalogue: &mut self.catalogue, inbox: &self.inbox, wire: &self.wire, now };
        for (token, feed) in &mut self.feeds {
            feed.is_ready |= is_due;
            feed.deliver_all(&mut post);
            feed.renew(now, &self.wire, |reader| watch(&self.poll, reader.source(), Token(*token)));
            self.is_changed |= feed.is_holding();
        }
    }
}

/// Should the thread panic, then because DDS did in another of its own. That must not look like silence.
impl Drop for Worker {
    fn drop(&mut self) {
        if std::thread::panicking() {
            for topic in self.catalogue.wanted() {
                let cause = Cause::Disconnected("the DDS client stopped by a fault of its own".to_owned());
                self.inbox.push(Happening::Blind { topic: topic.clone(), cause });
            }
        }
    }
}

/// The last byte of a GUID says whether a writer's topic has keys (RTPS 2.5, table 9.1).
fn readable(writer: Gid) -> Result<(), String> {
    match writer {
        [.., 2] => Err("the publisher's type has keys, and types of ROS 2 have none".to_owned()),
        _ => Ok(()),
    }
}

fn watch(poll: &Poll, source: &mut (impl rustdds::mio1::event::Source + ?Sized), token: Token) -> Result<(), Refused> {
    poll.registry().register(source, token, Interest::READABLE).map_err(|e| unwatched(&e))
}

fn unwatched(error: &std::io::Error) -> Refused {
    Refused(format!("what comes from DDS cannot be watched: {error}"))
}
