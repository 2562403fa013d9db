//! What a transport says and takes: the same for ROS 1, for ROS 2, and for what tests make up.
//!
//! A connector has threads of its own for what comes in; all of it goes through an [`Inbox`](crate::inbox::Inbox), which stamps it. It never calls a monitor and never
//! waits for one. What is asked of it (to publish, to call) returns at once.

use std::fmt;
use std::time::Duration;

use bytes::Bytes;
/// How messages are encoded on a graph.
pub use lapwing_record::Encoding;
use lapwing_record::RawChannel;
use lapwing_stream::Time;

/// A number by which a connector calls one stream of messages with one type: a topic has two if two types are offered on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct StreamId(pub u32);

/// A number by which a connector calls something that it publishes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PublisherId(pub u32);

/// A number by which a connector calls a request that it sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CallId(pub u64);

/// Something that happened, with its stamp on the clock of the inbox.
#[derive(Clone, Debug)]
pub struct Arrival {
    /// When, in nanoseconds since 1970; never less than that of the arrival before.
    pub at: Time,
    /// What.
    pub what: Happening,
}

/// What can happen on the graph.
#[derive(Clone, Debug)]
pub enum Happening {
    /// A stream is there: a first publisher of this topic with this type was found, and its messages can be told apart by the number.
    /// Comes before any message of the stream. Also for topics that nobody subscribed to: their channel then has no definition yet. Comes again
    /// when more is known: with the definition, once somebody subscribed.
    Stream(Offer),
    /// Somebody else publishes on a stream that is known already, or stopped to: so many do now.
    Publishers {
        /// The stream.
        stream: StreamId,
        /// How many there are.
        count: usize,
    },
    /// A message, as it came over the wire, without a transport's header: ROS 1's serialisation, or CDR with its four bytes of encapsulation.
    Message {
        /// The stream.
        stream: StreamId,
        /// Its bytes.
        payload: Bytes,
    },
    /// Messages of a stream were lost: the queue was full, or the transport says so.
    Lost {
        /// The stream.
        stream: StreamId,
        /// How many.
        count: u64,
    },
    /// From now on nothing, or not everything, of a topic can be seen.
    Blind {
        /// The topic, absolute.
        topic: String,
        /// Why.
        cause: Cause,
    },
    /// That cause is no more. Each [`Happening::Blind`] is followed by at most one of these.
    Sees {
        /// The topic, absolute.
        topic: String,
        /// Which cause.
        cause: Cause,
    },
    /// The answer to a call.
    Reply {
        /// The call.
        call: CallId,
        /// The answer's bytes, encoded as messages are, or why there is none.
        answer: Result<Bytes, String>,
    },
    /// Worth a line to the user, and nothing else: a node left, a master came back.
    Note(String),
}

/// A stream of messages on offer.
#[derive(Clone, Debug)]
pub struct Offer {
    /// Its number.
    pub stream: StreamId,
    /// Topic, type, definition and decoding. A recording of the run declares the channel with it.
    pub channel: RawChannel,
    /// Whether the last message is handed to those who come late (ROS 1: latched; ROS 2: transient local).
    pub latched: bool,
}

/// Why a topic cannot be seen.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// Nobody publishes it.
    NoPublisher,
    /// What the publisher offers cannot be had: `publisher offers VOLATILE, …`.
    Incompatible(String),
    /// There is no definition of its type.
    Undefined(String),
    /// The connection to a publisher, or to the master, is broken.
    Disconnected(String),
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cause::NoPublisher => f.write_str("nobody publishes it"),
            Cause::Incompatible(what) => write!(f, "quality of service does not fit: {what}"),
            Cause::Undefined(what) => write!(f, "its type has no definition: {what}"),
            Cause::Disconnected(what) => write!(f, "disconnected: {what}"),
        }
    }
}

/// What cannot be done on the graph, in words for the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused(pub String);

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Refused {}

/// A live graph.
pub trait Connector: Send {
    /// What reports call it: `ROS 2, domain 7`.
    fn name(&self) -> String;

    /// How messages are encoded that are published here.
    fn encoding(&self) -> Encoding;

    /// The time on the clock that stamps arrivals, read such that nothing that [`Connector::next`] will still give has an earlier stamp:
    /// [`Inbox::horizon`](crate::inbox::Inbox::horizon). Whoever waits for messages learns from it how far silence reaches.
    fn now(&self) -> Time;

    /// Whether the graph itself says that its nodes live by simulated time (ROS 1: the parameter `/use_sim_time`); `None` where only a
    /// publisher of `/clock` would show it.
    fn simulates_time(&mut self) -> Option<bool> {
        None
    }

    /// Topics to subscribe to from now on, by absolute name, whoever offers them and whenever. A topic that has no publisher within a second is
    /// [`Happening::Blind`].
    fn subscribe(&mut self, topics: &[String]);

    /// The next thing that happened, waiting for it no longer than that.
    fn next(&mut self, patience: Duration) -> Option<Arrival>;

    /// Prepares to publish a topic; `channel` has the type and its definition.
    fn advertise(&mut self, channel: &RawChannel, latched: bool) -> Result<PublisherId, Refused>;

    /// Publishes a message.
    fn publish(&mut self, publisher: PublisherId, payload: &[u8]) -> Result<(), Refused>;

    /// Sends a request to a service; the answer comes as [`Happening::Reply`], at the latest after the patience, as an error.
    fn call(&mut self, service: &str, type_name: &str, request: &[u8], patience: Duration) -> Result<CallId, Refused>;

    /// The definition of a service's or a message's type, where the graph or the machine has it: `std_srvs/srv/Trigger`.
    /// Of a service, its request's and its answer's.
    fn definition(&mut self, type_name: &str) -> Result<Definition, Refused>;
}

/// The definition of a type, in the text form of its dialect, with those that it depends on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Definition {
    /// Of a message.
    Message(String),
    /// Of a service: request, answer.
    Service(String, String),
}
