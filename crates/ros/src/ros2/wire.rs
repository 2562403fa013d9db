//! RustDDS, as little of it as the rest needs: a participant, and readers and writers of bytes that know no types.

use std::net::Ipv4Addr;
use std::sync::{Arc, Mutex, PoisonError};

use bytes::Bytes;
use rustdds::no_key::{Decode, DefaultDecoder, DeserializerAdapter, SerializerAdapter, SimpleDataReader};
use rustdds::rpc::SampleIdentity;
use rustdds::with_key::WriteOptionsBuilder;
use rustdds::{
    DomainParticipant, DomainParticipantBuilder, GUID, Publisher, QosPolicies, RTPSEntity, RepresentationIdentifier,
    Subscriber, Timestamp, Topic, TopicKind,
};

use super::cdr::LITTLE;
use super::graph::{Gid, Node, Participant};
use super::reach::Reach;
use super::{graph, qos, room};
use crate::connector::Refused;

/// Payloads pass as they are, with their encapsulation in front.
#[derive(Clone, Copy, Debug)]
pub struct Raw;

/// Passing bytes on cannot fail.
#[derive(Debug)]
pub enum Never {}

impl std::fmt::Display for Never {
    fn fmt(&self, _: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match *self {}
    }
}

impl std::error::Error for Never {}

impl DeserializerAdapter<Bytes> for Raw {
    type Error = Never;
    type Decoded = Bytes;

    /// All that a message may be in: what is not plain CDR is refused by name where it is decoded.
    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        type Id = RepresentationIdentifier;
        &[
            Id::CDR_LE,
            Id::CDR_BE,
            Id::PL_CDR_LE,
            Id::PL_CDR_BE,
            Id::XCDR2_LE,
            Id::XCDR2_BE,
            Id::D_CDR2_LE,
            Id::D_CDR2_BE,
            Id::PL_XCDR2_LE,
            Id::PL_XCDR2_BE,
        ]
    }

    fn transform_decoded(decoded: Bytes) -> Bytes {
        decoded
    }
}

impl DefaultDecoder<Bytes> for Raw {
    type Decoder = Raw;
    const DECODER: Raw = Raw;
}

impl Decode<'_, Bytes> for Raw {
    type Error = Never;

    fn decode_bytes(self, body: &[u8], encoding: RepresentationIdentifier) -> Result<Bytes, Never> {
        let mut payload = Vec::with_capacity(LITTLE.len() + body.len());
        payload.extend_from_slice(&encoding.to_bytes());
        payload.extend_from_slice(&[0, 0]);
        payload.extend_from_slice(body);
        Ok(payload.into())
    }
}

impl SerializerAdapter<Bytes> for Raw {
    type Error = Never;

    fn output_encoding() -> RepresentationIdentifier {
        RepresentationIdentifier::CDR_LE
    }

    fn to_bytes(body: &Bytes) -> Result<Bytes, Never> {
        Ok(body.clone())
    }
}

/// A message as it came.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Who wrote it.
    pub writer: GUID,
    /// Its number among the writer's.
    pub number: i64,
    /// Of an answer: what it answers.
    pub related: Option<SampleIdentity>,
    /// Its bytes, with the encapsulation.
    pub payload: Bytes,
}

/// A reader or a writer of somebody else, as it was discovered.
#[derive(Clone, Debug)]
pub struct Endpoint {
    /// Its GUID.
    pub guid: GUID,
    /// Its topic on the wire.
    pub topic: String,
    /// Its type on the wire.
    pub type_name: String,
    /// What it offers, or asks for.
    pub qos: QosPolicies,
    /// What else it tells of itself.
    pub user_data: Vec<u8>,
}

/// Reads bytes.
pub struct RawReader {
    reader: SimpleDataReader<Bytes, Raw>,
}

impl RawReader {
    /// Says that what came is going to be taken: to be called before [`take`](RawReader::take), lest the next notice be missed.
    pub fn acknowledge(&self) {
        self.reader.drain_read_notifications();
    }

    /// The next message. An error is a message that is lost.
    pub fn take(&self) -> Result<Option<Sample>, String> {
        let taken = self.reader.try_take_one().map_err(|e| format!("{e:?}"))?;
        Ok(taken.map(|change| Sample {
            writer: change.writer_guid,
            number: change.sequence_number.into(),
            related: change.related_sample_identity(),
            payload: change.sample,
        }))
    }

    /// Its GUID.
    pub fn guid(&self) -> GUID {
        self.reader.guid()
    }

    /// What a poll watches.
    pub fn source(&mut self) -> &mut impl rustdds::mio1::event::Source {
        &mut self.reader
    }
}

/// Writes bytes.
pub struct RawWriter {
    writer: rustdds::no_key::DataWriter<Bytes, Raw>,
}

impl RawWriter {
    /// Writes a message: its bytes with the encapsulation, which has to be that of little-endian plain CDR. Gives what the message is called.
    pub fn write(&self, message: &[u8], related: Option<SampleIdentity>) -> Result<SampleIdentity, Refused> {
        let Some((&LITTLE, body)) = message.split_first_chunk() else {
            return Err(Refused("only little-endian plain CDR is published".to_owned()));
        };
        let options =
            WriteOptionsBuilder::new().source_timestamp(Timestamp::now()).related_sample_identity_opt(related);
        let written = self.writer.write_with_options(Bytes::copy_from_slice(body), options.build());
        written.map_err(|_| Refused("a subscriber does not keep up, and the queue to it is full".to_owned()))
    }

    /// Its GUID.
    pub fn guid(&self) -> GUID {
        self.writer.guid()
    }
}

/// The participant, and the one node that it is on the graph.
#[derive(Clone)]
pub struct Wire {
    /// The participant itself.
    pub participant: DomainParticipant,
    subscriber: Subscriber,
    publisher: Publisher,
    presence: Arc<Mutex<Presence>>,
}

/// What others are told of the node.
struct Presence {
    node: Node,
    writer: RawWriter,
}

impl Wire {
    /// Joins a domain as a node of that name: `/lapwing`, `/robot1/lapwing`.
    pub fn join(reach: Reach, node: &str) -> Result<Wire, Refused> {
        let mut builder = DomainParticipantBuilder::new(reach.domain).socket_receive_buffer_size(room::WANTED);
        if reach.loopback_only {
            builder = builder.with_only_networks([Ipv4Addr::LOCALHOST]);
        }
        let participant = builder.build().map_err(|e| failed("join the domain", &e))?;
        let none = QosPolicies::qos_none();
        let subscriber = participant.create_subscriber(&none).map_err(|e| failed("subscribe", &e))?;
        let publisher = participant.create_publisher(&none).map_err(|e| failed("publish", &e))?;
        let topic = topic(&participant, graph::TOPIC, graph::TYPE, &qos::offer(true))?;
        let writer = raw_writer(&publisher, &topic)?;
        let (namespace, name) = node.rsplit_once('/').unwrap_or(("", node));
        let namespace = format!("/{}", namespace.trim_start_matches('/'));
        let node = Node { namespace, name: name.to_owned(), ..Node::default() };
        let wire =
            Wire { participant, subscriber, publisher, presence: Arc::new(Mutex::new(Presence { node, writer })) };
        wire.tell(|_| {});
        Ok(wire)
    }

    /// The GUID of the participant.
    pub fn gid(&self) -> Gid {
        self.participant.guid().to_bytes()
    }

    /// Whether an endpoint is of this very participant.
    pub fn is_own(&self, endpoint: GUID) -> bool {
        endpoint.prefix == self.participant.guid().prefix
    }

    /// All writers of others.
    pub fn writers(&self) -> Vec<Endpoint> {
        let endpoint = |found: rustdds::discovery::DiscoveredWriterData| Endpoint {
            guid: found.writer_proxy.remote_writer_guid,
            qos: found.publication_topic_data.qos(),
            topic: found.publication_topic_data.topic_name,
            type_name: found.publication_topic_data.type_name,
            user_data: found.user_data,
        };
        self.others(self.participant.discovered_writers().into_iter().map(endpoint))
    }

    /// All readers of others.
    pub fn readers(&self) -> Vec<Endpoint> {
        let endpoint = |found: rustdds::discovery::DiscoveredReaderData| Endpoint {
            guid: found.reader_proxy.remote_reader_guid,
            qos: found.subscription_topic_data.qos(),
            topic: found.subscription_topic_data.topic_name().clone(),
            type_name: found.subscription_topic_data.type_name().clone(),
            user_data: found.user_data,
        };
        self.others(self.participant.discovered_readers().into_iter().map(endpoint))
    }

    fn others(&self, endpoints: impl Iterator<Item = Endpoint>) -> Vec<Endpoint> {
        let own = self.participant.guid().prefix;
        endpoints.filter(|e| e.guid.prefix != own).collect()
    }

    /// Reads a topic on the wire, as the node.
    pub fn read(&self, topic_name: &str, type_name: &str, qos: &QosPolicies) -> Result<RawReader, Refused> {
        let reader = self.read_quietly(topic_name, type_name, qos)?;
        self.tell(|node| node.readers.push(reader.guid().to_bytes()));
        Ok(reader)
    }

    /// Reads a topic on the wire, as the node, instead of a reader that is to end.
    pub fn read_instead(
        &self,
        topic_name: &str,
        type_name: &str,
        qos: &QosPolicies,
        before: &RawReader,
    ) -> Result<RawReader, Refused> {
        let reader = self.read_quietly(topic_name, type_name, qos)?;
        let (old, new) = (before.guid().to_bytes(), reader.guid().to_bytes());
        self.tell(|node| node.readers.iter_mut().filter(|gid| **gid == old).for_each(|gid| *gid = new));
        Ok(reader)
    }

    /// Reads a topic on the wire that is no node's business.
    pub fn read_quietly(&self, topic_name: &str, type_name: &str, qos: &QosPolicies) -> Result<RawReader, Refused> {
        let topic = topic(&self.participant, topic_name, type_name, qos)?;
        let reader = self.subscriber.create_simple_datareader_no_key(&topic, None);
        Ok(RawReader { reader: reader.map_err(|e| failed("read", &e))? })
    }

    /// Writes a topic on the wire, as the node.
    pub fn write(&self, topic_name: &str, type_name: &str, qos: &QosPolicies) -> Result<RawWriter, Refused> {
        let topic = topic(&self.participant, topic_name, type_name, qos)?;
        let writer = raw_writer(&self.publisher, &topic)?;
        self.tell(|node| node.writers.push(writer.guid().to_bytes()));
        Ok(writer)
    }

    /// Gives what comes on a topic more room until it is taken. The cache of a topic takes the largest room that it was ever given.
    pub fn enlarge(&self, topic_name: &str, type_name: &str, qos: &QosPolicies) -> Result<(), Refused> {
        topic(&self.participant, topic_name, type_name, qos).map(drop)
    }

    /// Changes the node and tells all others what it is now. Should that not go out, it goes out with the next change:
    /// nothing but lists of nodes depends on it.
    fn tell(&self, change: impl FnOnce(&mut Node)) {
        let mut presence = self.presence.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut presence.node);
        let participant = Participant { gid: self.gid(), nodes: vec![presence.node.clone()] };
        let _ = presence.writer.write(&participant.encode(), None);
    }
}

fn topic(participant: &DomainParticipant, name: &str, type_name: &str, qos: &QosPolicies) -> Result<Topic, Refused> {
    let topic = participant.create_topic(name.to_owned(), type_name.to_owned(), qos, TopicKind::NoKey);
    topic.map_err(|e| failed("create a topic", &e))
}

fn raw_writer(publisher: &Publisher, topic: &Topic) -> Result<RawWriter, Refused> {
    let writer = publisher.create_datawriter_no_key(topic, None).map_err(|e| failed("write", &e))?;
    Ok(RawWriter { writer })
}

fn failed(what: &str, error: &dyn std::fmt::Debug) -> Refused {
    Refused(format!("DDS could not {what}: {error:?}"))
}
