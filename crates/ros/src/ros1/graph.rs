//! What this node knows of the graph, shared by its threads: those that hear publishers, the one that asks the master, those that answer.

use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use lapwing_record::RawChannel;

use super::brake::Brake;
use super::definitions::Definitions;
use super::header::Header;
use super::link::Link;
use super::master::{Master, System};
use super::names::Names;
use super::offer::Offered;
use super::publication::Publication;
use super::streams::Streams;
use super::topic::{Failure, Topic};
use crate::connector::{Cause, Happening, Offer, StreamId};
use crate::inbox::Inbox;

/// The graph, as this node knows it.
#[derive(Debug)]
pub(crate) struct Graph {
    pub inbox: Inbox,
    pub names: Names,
    pub master: Master,
    pub definitions: Definitions,
    /// What others call this machine.
    pub host: String,
    /// Where this node's API is, as others see it.
    pub slave: String,
    /// Where its messages are to be had.
    pub port: u16,
    state: Mutex<State>,
    /// The one who asks the master is to do so now.
    stir: Condvar,
    /// The master has been asked.
    asked: Condvar,
}

/// What changes.
#[derive(Debug, Default)]
pub(crate) struct State {
    /// The topics that are subscribed to.
    pub topics: BTreeMap<String, Topic>,
    pub streams: Streams,
    /// What is published here, in the order of its numbers.
    pub publications: Vec<Arc<Publication>>,
    /// Why the master does not answer.
    pub no_master: Option<String>,
    /// Why this node was told to stop.
    pub told_to_stop: Option<String>,
    /// Whether nodes are to go by `/clock`, once that is known.
    pub sim_time: Option<bool>,
    pub is_over: bool,
    is_stirred: bool,
    /// Whether the master has been asked, with whatever result.
    was_asked: bool,
}

/// What a publisher is heard as.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Heard {
    pub stream: StreamId,
    /// Whether its messages carry a number that shows which were left out. What is latched is published, and numbered, anew for every subscriber.
    pub is_counted: bool,
}

/// What a graph is made with.
pub(crate) struct Place {
    pub names: Names,
    pub master: Master,
    pub definitions: Definitions,
    pub host: String,
    pub slave: String,
    pub port: u16,
}

impl Graph {
    pub fn new(place: Place) -> Graph {
        let Place { names, master, definitions, host, slave, port } = place;
        Graph {
            inbox: Inbox::default(),
            names,
            master,
            definitions,
            host,
            slave,
            port,
            state: Mutex::default(),
            stir: Condvar::new(),
            asked: Condvar::new(),
        }
    }

    /// Every change leaves the state whole, also where the thread that made it panics afterwards.
    pub fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Has the master asked at once.
    pub fn stir(&self) {
        self.lock().is_stirred = true;
        self.stir.notify_all();
    }

    /// Waits until it is to be asked, or is over; no longer than that. Whether somebody wants it at once.
    pub fn rest(&self, pause: Duration) -> bool {
        let waited = self.stir.wait_timeout_while(self.lock(), pause, |state| !state.is_stirred && !state.is_over);
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        std::mem::take(&mut state.is_stirred)
    }

    /// The master was asked, for the first time or again.
    pub fn was_asked(&self) {
        self.lock().was_asked = true;
        self.asked.notify_all();
    }

    /// Waits until it has been asked once, no longer than that.
    pub fn wait_until_asked(&self, patience: Duration) {
        drop(self.asked.wait_timeout_while(self.lock(), patience, |state| !state.was_asked));
    }

    /// Ends the threads that hear, and the one that asks.
    pub fn end(&self) {
        let mut state = self.lock();
        state.is_over = true;
        state.topics.values_mut().for_each(Topic::close);
        state.publications.iter().for_each(|publication| publication.close());
        drop(state);
        self.stir.notify_all();
    }

    pub fn note(&self, text: impl Into<String>) {
        self.inbox.push(Happening::Note(text.into()));
    }

    /// The master says who publishes a topic. An answer to a question is old where the master has said so since, by itself.
    pub fn list(self: &Arc<Self>, topic: &str, publishers: &[String], asked_at: Option<u64>) {
        let mut state = self.lock();
        if state.is_over || state.told_to_stop.is_some() {
            return;
        }
        let Some(known) = state.topics.get_mut(topic) else { return };
        if asked_at.is_some_and(|updates| updates != known.updates) {
            return;
        }
        let new = known.list(publishers, Instant::now());
        self.tell(&mut state, topic);
        drop(state);
        new.into_iter().for_each(|(uri, brake)| self.connect(topic, uri, brake));
    }

    fn connect(self: &Arc<Self>, topic: &str, uri: String, brake: Arc<Brake>) {
        let link = Link { graph: self.clone(), topic: topic.to_owned(), uri: uri.clone(), brake };
        if let Err(error) = thread::Builder::new().name("ros1-link".to_owned()).spawn(move || link.run()) {
            let cause = Cause::Disconnected(format!("there is no thread left for {uri}: {error}"));
            self.failed(topic, &uri, Failure { cause, is_gone: false });
        }
    }

    /// A publisher of a topic cannot be heard.
    pub fn failed(&self, topic: &str, uri: &str, failure: Failure) {
        let mut state = self.lock();
        if let Some(known) = state.topics.get_mut(topic) {
            known.failed(uri, failure, Instant::now());
        }
        self.tell(&mut state, topic);
    }

    /// A publisher of a topic says what it offers: as what it is heard, unless it was let go meanwhile.
    pub fn offered(&self, topic: &str, uri: &str, header: &Header) -> Result<Option<Heard>, Failure> {
        let offered = Offered::read(topic, header, &self.definitions)?;
        let is_counted = offered.is_numbered && !offered.latched;
        let mut state = self.lock();
        let (stream, is_new) = state.streams.offered(topic, &offered.type_name, &offered.checksum, &offered.definition);
        if !state.topics.get_mut(topic).is_some_and(|known| known.connected(uri, stream)) {
            return Ok(None);
        }
        if is_new {
            if let Some(note) = contradiction(&state, topic, &offered) {
                self.note(note);
            }
            let Offered { channel, latched, .. } = offered;
            self.inbox.push(Happening::Stream(Offer { stream, channel, latched }));
            if let Some((_, known)) = state.streams.iter_mut().find(|(id, _)| *id == stream) {
                known.told = known.told.or(Some(1));
            }
        }
        self.tell(&mut state, topic);
        Ok(Some(Heard { stream, is_counted }))
    }

    /// What the master knows: topics that nobody subscribed to here, and how many publish them.
    pub fn observe(&self, system: &System, types: &BTreeMap<String, String>) {
        let mut state = self.lock();
        let State { topics, streams, .. } = &mut *state;
        let me = self.names.node();
        let others = |topic: &str| {
            let nodes = system.publishers.get(topic).map(Vec::as_slice).unwrap_or_default();
            nodes.iter().filter(|node| *node != me).collect::<Vec<_>>()
        };
        for (topic, type_name) in types.iter().filter(|(topic, _)| !topics.contains_key(*topic)) {
            if !others(topic).is_empty()
                && let (stream, true) = streams.rumoured(topic, type_name)
            {
                let channel = rumour(topic, type_name);
                self.inbox.push(Happening::Stream(Offer { stream, channel, latched: false }));
                streams.iter_mut().filter(|(id, _)| *id == stream).for_each(|(_, known)| known.told = Some(1));
            }
        }
        for (stream, known) in streams.iter_mut().filter(|(_, known)| !topics.contains_key(&known.topic)) {
            let is_its = types.get(&known.topic) == Some(&known.type_name);
            let count = if is_its { others(&known.topic).len() } else { 0 };
            if known.told.is_some_and(|told| told != count) {
                known.told = Some(count);
                self.inbox.push(Happening::Publishers { stream, count });
            }
        }
    }

    /// Tells of every topic what has become late, or is no more.
    pub fn tell_all(&self) {
        let mut state = self.lock();
        let topics: Vec<String> = state.topics.keys().cloned().collect();
        topics.iter().for_each(|topic| self.tell(&mut state, topic));
    }

    /// Tells what has changed of a topic. What is new comes first: there is no moment between two causes at which it could be seen.
    fn tell(&self, state: &mut State, topic: &str) {
        let State { topics, streams, no_master, told_to_stop, .. } = state;
        let Some(known) = topics.get_mut(topic) else { return };
        let elsewhere = told_to_stop.as_deref().or(no_master.as_deref());
        let (new, over) = known.news(elsewhere, Instant::now());
        for cause in new {
            self.inbox.push(Happening::Blind { topic: topic.to_owned(), cause });
        }
        for cause in over {
            self.inbox.push(Happening::Sees { topic: topic.to_owned(), cause });
        }
        // Of hearsay nobody is connected yet, and yet there are some.
        for (stream, its) in streams.iter_mut().filter(|(_, its)| its.topic == topic && its.checksum.is_some()) {
            let count = known.count(stream);
            if its.told.is_some_and(|told| told != count) {
                its.told = Some(count);
                self.inbox.push(Happening::Publishers { stream, count });
            }
        }
    }

    /// Somebody wants this node to stop: nothing is heard from now on, and everybody is to know.
    pub fn told_to_stop(&self, who: &str, why: &str) {
        let reason = format!("{who} told this node to stop: {why}");
        let mut state = self.lock();
        if state.told_to_stop.is_some() {
            return;
        }
        self.note(reason.clone());
        state.told_to_stop = Some(reason);
        let topics: Vec<String> = state.topics.keys().cloned().collect();
        for topic in topics {
            // Whoever published it is let go; that it was is told at once, not when it becomes late.
            let gone_since = Instant::now().checked_sub(super::topic::PATIENCE).unwrap_or_else(Instant::now);
            if let Some(known) = state.topics.get_mut(&topic) {
                known.close();
                known.empty_since(gone_since);
            }
            self.tell(&mut state, &topic);
        }
    }
}

/// A channel of which only its type is known, and that by hearsay.
fn rumour(topic: &str, type_name: &str) -> RawChannel {
    RawChannel {
        topic: topic.to_owned(),
        type_name: type_name.to_owned(),
        encoding: String::new(),
        definition: Vec::new(),
        messages: "ros1".to_owned(),
        ty: Err("nobody subscribed to it yet, and its publishers send its definition only to subscribers".to_owned()),
    }
}

/// In what an offer differs from another one on the same topic.
fn contradiction(state: &State, topic: &str, offered: &Offered) -> Option<String> {
    let mut others = state.streams.iter().filter(|s| s.topic == topic);
    let other =
        others.find(|s| s.checksum.as_deref() != Some(&offered.checksum) || s.type_name != offered.type_name)?;
    let node = offered.node.as_deref().unwrap_or("a publisher");
    let sum = other.checksum.as_deref().unwrap_or("not known");
    Some(format!(
        "{topic} is not the same everywhere: {node} publishes {} (checksum {}), and it was {} (checksum {sum}) before; each is taken for itself",
        offered.type_name, offered.checksum, other.type_name
    ))
}
