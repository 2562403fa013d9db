//! ROS 1: a node of its own, which speaks with the master and with other nodes as any node does. No ROS has to be installed.
//!
//! ```text
//!            keeper ──registers, asks twice a second──▶ master
//!                                                         │ publisherUpdate
//! node's API  ◀── slave ◀─────────────────────────────────┘
//!               │ a link for each publisher of each topic
//! publisher ──TCPROS──▶ link ──▶ inbox ──▶ next()
//! publish() ──▶ publication ──a queue for each subscriber──▶ subscriber
//! ```
//!
//! # Where to read on
//!
//! - `settings`: where the master is, and what others call this node; `names`: names on the graph.
//! - `graph`: what the threads share. `topic`: what keeps a topic from being seen. `streams`: their numbers.
//! - `link`: one publisher, heard out; `offer` what it offers, `header` and `frame` how it says it, `checksum` and `definitions` what it means,
//!   `sequence` what it left out.
//! - `publication`, `service`: what goes out.
//! - `keeper`, `master`, `slave`: the calls between nodes and master; `xml`, `http`, `net` and `brake` below them.
//!
//! Whatever comes from others has limits: headers, bodies, messages, publishers of a topic, nesting, time.

mod brake;
mod checksum;
mod definitions;
mod frame;
mod graph;
mod header;
mod http;
mod keeper;
mod link;
mod master;
mod names;
mod net;
mod offer;
mod publication;
mod sequence;
mod service;
mod settings;
mod slave;
mod streams;
mod topic;
mod xml;

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use lapwing_record::{RawChannel, normal_name};
use lapwing_stream::Time;

use crate::connector::{Arrival, CallId, Connector, Definition, Encoding, Happening, PublisherId, Refused};
use crate::server::Server;
use graph::{Graph, Place};
use master::Master;
use publication::Publication;
use service::{Call, plain};
use settings::Settings;
use topic::Topic;

/// For so long a new node waits for the master's first answer.
const FIRST_ANSWER: Duration = Duration::from_secs(1);
/// So many calls of services may be on their way at once.
const MOST_CALLS: usize = 64;
/// So many questions may be asked of this node at once, and so many subscribers may be connected.
const MOST_CONNECTIONS: (usize, usize) = (64, 1024);

/// Becomes a node of the graph of the master at that URI, else at `ROS_MASTER_URI`, else on this machine. A master that does not answer is waited
/// for: a second here, and then while the node lives.
///
/// A name without a slash in front is in the namespace of `ROS_NAMESPACE`. Refused are addresses and names that are none.
pub fn connect(master_uri: Option<&str>, node_name: &str) -> Result<Box<dyn Connector>, Refused> {
    let settings = Settings::read(master_uri, node_name, &|name| std::env::var(name).ok()).map_err(Refused)?;
    let node = Node::start(settings).map_err(|e| Refused(format!("this node cannot be reached by others: {e}")))?;
    Ok(Box::new(node))
}

/// The checksum of a message by its definition: what publishers and subscribers of ROS 1 compare before they talk. An error says what of the
/// definition cannot be understood, or is missing.
pub fn checksum(type_name: &str, definition: &str) -> Result<String, String> {
    checksum::of_message(&normal_name(type_name), definition)
}

/// Does with any bytes what is done with those of other nodes: the entry of a fuzzer, which looks for panics.
#[doc(hidden)]
pub fn fuzz(bytes: &[u8]) {
    let definitions = definitions::Definitions::default();
    if let Ok(header) = header::Header::parse(bytes) {
        assert_eq!(
            header::Header::read(&mut &header.bytes()[..]).ok().as_ref(),
            Some(&header),
            "a header is read otherwise"
        );
        drop(offer::Offered::read("/topic", &header, &definitions));
    }
    let mut from = bytes;
    while let Ok(Some(_)) = frame::read(&mut from) {}
    drop(http::read(bytes));
    if let Ok(text) = std::str::from_utf8(bytes) {
        if let Ok(value) = xml::read_answer(text) {
            let again = xml::read_answer(&xml::write_answer(&value));
            assert_eq!(format!("{:?}", again), format!("{:?}", Ok::<_, String>(value)), "a value is read otherwise");
        }
        drop(xml::read_call(text));
        drop(checksum::of_message("fuzz/Root", text));
        drop(net::Endpoint::parse(text));
    }
}

/// A node.
struct Node {
    graph: Arc<Graph>,
    keeper: Option<JoinHandle<()>>,
    calls: u64,
    calls_on_their_way: Arc<AtomicUsize>,
    /// They end with the node.
    _servers: [Server; 2],
}

impl Node {
    fn start(settings: Settings) -> std::io::Result<Node> {
        let (api, messages) = (settings.listen()?, settings.listen()?);
        let (api_port, port) = (api.local_addr()?.port(), messages.local_addr()?.port());
        let here = net::Endpoint { host: settings.host.clone(), port: api_port };
        let graph = Arc::new(Graph::new(Place {
            master: Master::new(settings.master, settings.names.node()),
            names: settings.names,
            definitions: settings.definitions,
            host: settings.host,
            slave: format!("http://{here}/"),
            port,
        }));
        let (asked, read, kept) = (graph.clone(), graph.clone(), graph.clone());
        let servers = [
            Server::start("ros1-api", api, MOST_CONNECTIONS.0, move |stream| slave::serve(&asked, &stream))?,
            Server::start("ros1-out", messages, MOST_CONNECTIONS.1, move |stream| publication::serve(&read, &stream))?,
        ];
        let keeper = thread::Builder::new().name("ros1-keeper".to_owned()).spawn(move || keeper::run(&kept))?;
        // Who asks at once what is published, and by which clock, is told what there is.
        graph.wait_until_asked(FIRST_ANSWER);
        Ok(Node { graph, keeper: Some(keeper), calls: 0, calls_on_their_way: Arc::default(), _servers: servers })
    }

    /// The definition of a message as ROS 1 has it: one that a publisher sent, else one that is installed or bundled.
    fn message(&self, type_name: &str) -> Option<String> {
        let wanted = normal_name(type_name);
        let state = self.graph.lock();
        let sent = state.streams.iter().find(|s| s.checksum.is_some() && s.type_name == wanted);
        sent.map(|stream| stream.definition.clone())
    }
}

impl Drop for Node {
    fn drop(&mut self) {
        self.graph.end();
        if let Some(keeper) = self.keeper.take() {
            // Where it panicked there is nothing to take back any more.
            drop(keeper.join());
        }
    }
}

impl Connector for Node {
    fn name(&self) -> String {
        format!("ROS 1, master {}", self.graph.master.endpoint())
    }

    fn encoding(&self) -> Encoding {
        Encoding::Ros1
    }

    fn now(&self) -> Time {
        self.graph.inbox.horizon()
    }

    fn simulates_time(&mut self) -> Option<bool> {
        self.graph.lock().sim_time
    }

    fn subscribe(&mut self, topics: &[String]) {
        let mut state = self.graph.lock();
        for topic in topics {
            let name = self.graph.names.resolve(topic);
            state.topics.entry(name).or_insert_with(|| Topic::new(Instant::now()));
        }
        drop(state);
        self.graph.stir();
    }

    fn next(&mut self, patience: Duration) -> Option<Arrival> {
        self.graph.inbox.pop(patience)
    }

    fn advertise(&mut self, channel: &RawChannel, latched: bool) -> Result<PublisherId, Refused> {
        let topic = self.graph.names.resolve(&channel.topic);
        let type_name = normal_name(&channel.type_name);
        if channel.encoding != "ros1msg" {
            let what = if channel.encoding.is_empty() { "no definition" } else { &channel.encoding };
            return Err(Refused(format!(
                "{topic}: ROS 1 needs a definition in its own form (ros1msg), and there is {what}"
            )));
        }
        let definition = String::from_utf8_lossy(&channel.definition).into_owned();
        let checksum = checksum::of_message(&type_name, &definition)
            .map_err(|what| Refused(format!("{topic}: {type_name}: {what}")))?;
        let mut state = self.graph.lock();
        if state.publications.iter().any(|p| p.topic == topic) {
            return Err(Refused(format!("{topic} is published here already")));
        }
        let other = state.streams.iter().find(|s| s.topic == topic && s.type_name != type_name);
        if let Some(other) = other {
            return Err(Refused(format!(
                "{topic} is {} on this graph, not {type_name}: its subscribers would refuse it",
                other.type_name
            )));
        }
        let number = u32::try_from(state.publications.len()).unwrap_or(u32::MAX);
        state.publications.push(Arc::new(Publication::new(topic, type_name, checksum, definition, latched)));
        drop(state);
        self.graph.stir();
        Ok(PublisherId(number))
    }

    fn publish(&mut self, publisher: PublisherId, payload: &[u8]) -> Result<(), Refused> {
        let publication = self.graph.lock().publications.get(publisher.0 as usize).cloned();
        let publication = publication.ok_or_else(|| Refused("that was never advertised".to_owned()))?;
        if payload.len() > frame::MOST_BYTES {
            return Err(Refused(format!("{}: a message of {} bytes is too long", publication.topic, payload.len())));
        }
        publication.publish(payload);
        Ok(())
    }

    fn call(&mut self, service: &str, type_name: &str, request: &[u8], patience: Duration) -> Result<CallId, Refused> {
        if self.calls_on_their_way.load(Ordering::Acquire) >= MOST_CALLS {
            return Err(Refused(format!("{MOST_CALLS} calls are on their way already, and none has been answered")));
        }
        let checksum = match self.graph.definitions.find(type_name) {
            Some(Definition::Service(request, answer)) => {
                checksum::of_service(&plain(type_name), &request, &answer).ok()
            }
            _ => None,
        };
        let call = Call {
            service: self.graph.names.resolve(service),
            type_name: type_name.to_owned(),
            checksum: checksum.unwrap_or_else(|| "*".to_owned()),
            request: request.to_vec(),
            patience,
        };
        self.calls += 1;
        let id = CallId(self.calls);
        let (graph, open) = (self.graph.clone(), self.calls_on_their_way.clone());
        open.fetch_add(1, Ordering::AcqRel);
        let spawned = thread::Builder::new().name("ros1-call".to_owned()).spawn(move || {
            let answer = call.carry_out(&graph);
            open.fetch_sub(1, Ordering::AcqRel);
            graph.inbox.push(Happening::Reply { call: id, answer });
        });
        match spawned {
            Ok(_) => Ok(id),
            Err(error) => {
                self.calls_on_their_way.fetch_sub(1, Ordering::AcqRel);
                Err(Refused(format!("there is no thread left for a call: {error}")))
            }
        }
    }

    fn definition(&mut self, type_name: &str) -> Result<Definition, Refused> {
        if !type_name.contains("/srv/")
            && let Some(text) = self.message(type_name)
        {
            return Ok(Definition::Message(text));
        }
        self.graph.definitions.find(type_name).ok_or_else(|| {
            Refused(format!(
                "no definition of {type_name} is on this graph, installed or bundled; set ROS_PACKAGE_PATH to where its package is"
            ))
        })
    }
}
