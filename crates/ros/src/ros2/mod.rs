//! ROS 2 over DDS, with no ROS installed and no types known at compile time.
//!
//! - [`reach`]: which domain, and how far.
//! - [`name`]: names of ROS and names on the wire.
//! - [`qos`]: what to ask of a publisher.
//! - [`description`]: what a type is, and its hash; [`describe`]: a node asked for it; [`definitions`]: those at hand.
//! - [`graph`]: nodes and their endpoints.
//! - [`catalogue`]: publishers, streams, and what stands in the way.
//! - [`client`]: services; [`seek`]: definitions that were asked for by name.
//! - [`feed`]: a reader of a topic; [`room`]: what a socket holds for it.
//! - [`wire`]: DDS itself, by RustDDS; [`cdr`]: the messages of the graph.
//! - [`worker`]: the thread that does it all.

mod catalogue;
pub mod cdr;
mod client;
mod definitions;
pub mod describe;
pub mod description;
mod feed;
pub mod graph;
mod name;
mod qos;
mod reach;
mod room;
mod seek;
mod wire;
mod worker;

use std::path::PathBuf;
use std::sync::mpsc::{Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use bytes::Bytes;
use lapwing_record::RawChannel;
use lapwing_stream::Time;
use rustdds::mio1::Waker;

use crate::connector::{Arrival, CallId, Connector, Definition, Encoding, PublisherId, Refused};
use crate::inbox::Inbox;
use definitions::Definitions;
use reach::Reach;
use wire::{RawWriter, Wire};
use worker::{Command, Worker};

/// How long the graph is asked for a definition that the machine does not have: from the start on, as nodes have to be found first, and later.
const ASKING: Duration = Duration::from_secs(5);
const ASKING_LATER: Duration = Duration::from_secs(1);

/// Joins the ROS 2 graph as a node of that name (`/lapwing`), on the domain given or that of `ROS_DOMAIN_ID`, with the definitions of
/// `AMENT_PREFIX_PATH`.
///
/// Only this machine is spoken to, unless `ROS_AUTOMATIC_DISCOVERY_RANGE` says otherwise. An error says what to change.
pub fn connect(domain: Option<u16>, node_name: &str) -> Result<Box<dyn Connector>, Refused> {
    connect_with(domain, node_name, &[])
}

/// [`connect`], with definitions from some share trees before those of `AMENT_PREFIX_PATH`.
pub fn connect_with(domain: Option<u16>, node_name: &str, trees: &[PathBuf]) -> Result<Box<dyn Connector>, Refused> {
    let reach = Reach::new(domain, |name| std::env::var(name).ok())?;
    let mut trees = trees.to_vec();
    if let Some(prefixes) = std::env::var_os("AMENT_PREFIX_PATH") {
        trees.extend(std::env::split_paths(&prefixes).filter(|p| !p.as_os_str().is_empty()));
    }
    let wire = Wire::join(reach, node_name)?;
    let (inbox, definitions) = (Inbox::default(), Definitions::new(trees.clone()));
    let (commands, receiver) = channel();
    let (worker, waker) = Worker::new(wire.clone(), inbox.clone(), definitions, receiver)?;
    let thread = thread::Builder::new().name("ros2".to_owned()).spawn(|| worker.run());
    let thread = thread.map_err(|e| Refused(format!("no thread can be started: {e}")))?;
    Ok(Box::new(Ros2 {
        domain: reach.domain,
        joined: Instant::now(),
        wire,
        inbox,
        definitions: Definitions::new(trees),
        publishers: Vec::new(),
        commands,
        waker,
        thread: Some(thread),
        calls: 0,
    }))
}

/// A ROS 2 graph.
struct Ros2 {
    domain: u16,
    joined: Instant,
    wire: Wire,
    inbox: Inbox,
    definitions: Definitions,
    publishers: Vec<RawWriter>,
    commands: Sender<Command>,
    waker: Waker,
    thread: Option<JoinHandle<()>>,
    calls: u64,
}

impl Ros2 {
    fn tell(&self, command: Command) -> Result<(), Refused> {
        let gone = || Refused("the thread of the ROS 2 client is gone".to_owned());
        self.commands.send(command).map_err(|_| gone())?;
        self.waker.wake().map_err(|_| gone())
    }
}

impl Connector for Ros2 {
    fn name(&self) -> String {
        format!("ROS 2, domain {}", self.domain)
    }

    fn encoding(&self) -> Encoding {
        Encoding::Cdr
    }

    fn now(&self) -> Time {
        self.inbox.horizon()
    }

    fn subscribe(&mut self, topics: &[String]) {
        // A thread that is gone has said so itself, of every topic.
        let _ = self.tell(Command::Subscribe(topics.to_vec()));
    }

    fn next(&mut self, patience: Duration) -> Option<Arrival> {
        self.inbox.pop(patience)
    }

    fn advertise(&mut self, channel: &RawChannel, latched: bool) -> Result<PublisherId, Refused> {
        let Some(ty) = name::type_on_wire(&channel.type_name) else {
            return Err(Refused(format!(
                "`{}` is no type of a message: write it as `std_msgs/msg/String`",
                channel.type_name
            )));
        };
        let id = u32::try_from(self.publishers.len()).map_err(|_| Refused("too many publishers".to_owned()))?;
        let writer = self.wire.write(&name::topic_on_wire(&channel.topic), &ty, &qos::offer(latched))?;
        self.publishers.push(writer);
        Ok(PublisherId(id))
    }

    fn publish(&mut self, publisher: PublisherId, payload: &[u8]) -> Result<(), Refused> {
        let writer = self.publishers.get(publisher.0 as usize);
        writer.ok_or_else(|| Refused("nothing is advertised by that number".to_owned()))?.write(payload, None)?;
        Ok(())
    }

    fn call(&mut self, service: &str, type_name: &str, request: &[u8], patience: Duration) -> Result<CallId, Refused> {
        self.calls += 1;
        let id = CallId(self.calls);
        self.tell(Command::Call {
            id,
            service: service.to_owned(),
            type_name: type_name.to_owned(),
            request: Bytes::copy_from_slice(request),
            deadline: Instant::now() + patience,
        })?;
        Ok(id)
    }

    fn definition(&mut self, type_name: &str) -> Result<Definition, Refused> {
        if let Some(definition) = self.definitions.by_name(type_name) {
            return Ok(definition);
        }
        if type_name.contains("/srv/") {
            return Err(Refused(seek::nowhere(type_name)));
        }
        let (reply, answer) = channel();
        let deadline = (self.joined + ASKING).max(Instant::now() + ASKING_LATER);
        self.tell(Command::Define { type_name: type_name.to_owned(), deadline, reply })?;
        let nobody = |_| Refused(format!("nobody on the graph described {type_name}"));
        answer.recv_timeout(ASKING * 2).map_err(nobody)?
    }
}

impl Drop for Ros2 {
    fn drop(&mut self) {
        let _ = self.tell(Command::Stop);
        if let Some(thread) = self.thread.take() {
            // It has told itself if it panicked.
            let _ = thread.join();
        }
    }
}
