//! Calls of services, by the two ways in which ROS 2 puts request and answer together over DDS.
//!
//! Fast DDS says in the sample's own metadata which request an answer belongs to ("DDS-RPC 1.0, enhanced mapping", section 7.6.2.1.2); Cyclone
//! DDS puts sixteen bytes in front of request and answer: half the client's GUID and a number. The vendor of a server is in the first bytes
//! of its GUID.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::time::{Duration, Instant};

use bytes::Bytes;
use rustdds::GUID;
use rustdds::rpc::SampleIdentity;

use super::cdr::LITTLE;
use super::name;
use super::qos::Reading;
use super::wire::{Endpoint, RawReader, RawWriter, Sample, Wire};
use crate::connector::Refused;

/// How many answers may wait to be taken.
const ROOM: i32 = 256;
/// How many calls may be on their way at once.
const MAX_CALLS: usize = 1 << 12;
/// How long a server gets to notice the client after the client has noticed the server. Fast DDS waits by itself with its answer
/// for whoever asked; Cyclone DDS does not.
const SETTLING: Duration = Duration::from_millis(20);
/// After this time a request is sent although DDS did not say that it can be: what it says may have been dropped.
const LONG: Duration = Duration::from_secs(2);

/// How a server tells its answers apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mapping {
    /// In the metadata.
    Enhanced,
    /// In sixteen bytes ahead of the message.
    Header,
}

impl Mapping {
    /// Vendors, by the first two bytes of a GUID: 01.10 is Eclipse Cyclone DDS.
    fn of(server: GUID) -> Mapping {
        match server.to_bytes() {
            [1, 0x10, ..] => Mapping::Header,
            _ => Mapping::Enhanced,
        }
    }
}

/// A call that has no answer yet.
struct Call<K> {
    key: K,
    request: Bytes,
    deadline: Instant,
    sent: Option<(Mapping, SampleIdentity)>,
}

/// The client of one service.
struct Client<K> {
    writer: RawWriter,
    reader: RawReader,
    /// The server, since when it is known to be there, and how it answers.
    server: Option<(GUID, Instant)>,
    /// The endpoints of others that DDS has connected with the client's, the last one when.
    matched: BTreeSet<GUID>,
    matched_at: Option<Instant>,
    calls: Vec<Call<K>>,
    number: i64,
}

/// The clients of all services that were called. `K` is what the caller calls a call.
pub struct Clients<K> {
    clients: BTreeMap<Called, Client<K>>,
}

/// A service and its type.
type Called = (String, String);

/// An answer, or why there is none.
pub type Answered<K> = (K, Result<Bytes, String>);

impl<K: Clone> Clients<K> {
    /// None yet.
    pub fn new() -> Clients<K> {
        Clients { clients: BTreeMap::new() }
    }

    /// Calls a service: the request goes out as soon as the server is there.
    pub fn call(
        &mut self,
        wire: &Wire,
        key: K,
        (service, type_name): (&str, &str),
        request: Bytes,
        deadline: Instant,
    ) -> Result<(), Refused> {
        if self.clients.values().map(|c| c.calls.len()).sum::<usize>() >= MAX_CALLS {
            return Err(Refused(format!("{MAX_CALLS} calls wait for an answer already")));
        }
        let called = (service.to_owned(), type_name.to_owned());
        let client = match self.clients.entry(called) {
            Entry::Occupied(client) => client.into_mut(),
            Entry::Vacant(place) => place.insert(Client::new(wire, service, type_name)?),
        };
        client.calls.push(Call { key, request, deadline, sent: None });
        Ok(())
    }

    /// Looks for servers among what was discovered: one that reads requests and writes answers.
    pub fn meet(&mut self, readers: &[Endpoint], writers: &[Endpoint], now: Instant) {
        for ((service, _), client) in &mut self.clients {
            let (requests, answers) = (name::requests_on_wire(service), name::answers_on_wire(service));
            let answers = |r: &&Endpoint| writers.iter().any(|w| w.guid.prefix == r.guid.prefix && w.topic == answers);
            let server = readers.iter().filter(|r| r.topic == requests).find(answers).map(|r| r.guid);
            if client.server.map(|(guid, _)| guid) != server {
                client.server = server.map(|guid| (guid, now));
            }
        }
    }

    /// Notes that DDS has connected an endpoint of one of the clients with one of somebody else.
    pub fn matched(&mut self, own: GUID, other: GUID, now: Instant) {
        for client in self.clients.values_mut().filter(|c| [c.writer.guid(), c.reader.guid()].contains(&own)) {
            client.matched.insert(other);
            client.matched_at = Some(now);
        }
    }

    /// Sends what can be sent by now, takes what came, and gives up what waited for too long.
    pub fn tend(&mut self, now: Instant) -> Vec<Answered<K>> {
        self.clients.iter_mut().flat_map(|((service, _), client)| client.tend(service, now)).collect()
    }

    /// When something is due although nothing comes.
    pub fn is_waiting(&self) -> bool {
        self.clients.values().any(|c| !c.calls.is_empty())
    }
}

impl<K: Clone> Client<K> {
    fn new(wire: &Wire, service: &str, type_name: &str) -> Result<Client<K>, Refused> {
        let no_type = || Refused(format!("`{type_name}` is no type of a service: write it as `std_srvs/srv/Trigger`"));
        let (package, ty) = name::service_type(type_name).ok_or_else(no_type)?;
        let on_wire = |end: &str| name::type_on_wire(&format!("{package}/srv/{ty}_{end}")).ok_or_else(no_type);
        let qos = Reading { is_reliable: true, is_kept: false }.request(ROOM);
        let reader = wire.read(&name::answers_on_wire(service), &on_wire("Response")?, &qos)?;
        let writer = wire.write(&name::requests_on_wire(service), &on_wire("Request")?, &qos)?;
        Ok(Client {
            writer,
            reader,
            server: None,
            matched: BTreeSet::new(),
            matched_at: None,
            calls: Vec::new(),
            number: 0,
        })
    }

    fn tend(&mut self, service: &str, now: Instant) -> Vec<Answered<K>> {
        let mut answered = self.take();
        answered.extend(self.send(now));
        let is_late = |call: &Call<K>| call.deadline <= now;
        let found = self.server.is_some();
        for call in self.calls.extract_if(.., |call| is_late(call)) {
            let what = if found { "did not answer in time" } else { "is offered by nobody" };
            answered.push((call.key, Err(format!("the service {service} {what}"))));
        }
        answered
    }

    fn take(&mut self) -> Vec<Answered<K>> {
        let mut answered = Vec::new();
        self.reader.acknowledge();
        loop {
            match self.reader.take() {
                Ok(Some(sample)) => answered.extend(self.answered(&sample)),
                Ok(None) => return answered,
                // What cannot be read answers nobody: the call runs into its deadline.
                Err(_) => {}
            }
        }
    }

    /// The call that a message answers, if it is one of ours: on the topic are the answers to all clients.
    fn answered(&mut self, sample: &Sample) -> Option<Answered<K>> {
        let (identity, body) = match Mapping::of(sample.writer) {
            Mapping::Enhanced => (sample.related?, sample.payload.clone()),
            Mapping::Header => unwrap(&sample.payload, self.writer.guid())?,
        };
        let own = [self.writer.guid(), self.reader.guid()];
        let is_meant = |call: &Call<K>| {
            call.sent.is_some_and(|(_, sent)| sent.sequence_number == identity.sequence_number)
                && own.contains(&identity.writer_guid)
        };
        let at = self.calls.iter().position(is_meant)?;
        Some((self.calls.remove(at).key, Ok(body)))
    }

    /// Whether a request reaches the server, and its answer the client: a moment after DDS has connected both of the server's endpoints.
    fn is_connected(&self, server: GUID, now: Instant) -> bool {
        let answers = self.matched.iter().any(|guid| guid.prefix == server.prefix && *guid != server);
        let is_settled = self.matched_at.is_some_and(|at| now >= at + SETTLING);
        self.matched.contains(&server) && answers && is_settled
    }

    /// Sends the requests that wait for their server. Gives those that cannot be sent.
    fn send(&mut self, now: Instant) -> Vec<Answered<K>> {
        let Some((server, since)) = self.server else { return Vec::new() };
        if !self.is_connected(server, now) && now < since + LONG {
            return Vec::new();
        }
        let mapping = Mapping::of(server);
        let mut failed = Vec::new();
        for call in self.calls.iter_mut().filter(|c| c.sent.is_none()) {
            self.number += 1;
            match request(&self.writer, &self.reader, mapping, self.number, &call.request) {
                Ok(identity) => call.sent = Some((mapping, identity)),
                Err(Refused(why)) => {
                    call.deadline = now;
                    failed.push((call.key.clone(), Err(why)));
                }
            }
        }
        if !failed.is_empty() {
            self.calls.retain(|c| c.sent.is_some() || c.deadline > now);
        }
        failed
    }
}

/// Sends a request. Gives what its answer will refer to.
fn request(
    writer: &RawWriter,
    reader: &RawReader,
    mapping: Mapping,
    number: i64,
    request: &[u8],
) -> Result<SampleIdentity, Refused> {
    match mapping {
        Mapping::Enhanced => {
            // Names who reads the answer, so that the server waits until it can reach that reader.
            let asker = SampleIdentity { writer_guid: reader.guid(), ..SampleIdentity::default() };
            writer.write(request, Some(asker))
        }
        Mapping::Header => {
            let identity = SampleIdentity { writer_guid: writer.guid(), sequence_number: number.into() };
            writer.write(&wrap(request, identity)?, None)?;
            Ok(identity)
        }
    }
}

/// Puts Cyclone's header in front: the last eight bytes of the client's GUID, and the number of the request.
fn wrap(request: &[u8], identity: SampleIdentity) -> Result<Vec<u8>, Refused> {
    let Some((&LITTLE, body)) = request.split_first_chunk() else {
        return Err(Refused("only little-endian plain CDR is sent".to_owned()));
    };
    let [.., a, b, c, d, e, f, g, h] = identity.writer_guid.to_bytes();
    let number: i64 = identity.sequence_number.into();
    Ok([&LITTLE[..], &[a, b, c, d, e, f, g, h], &number.to_le_bytes(), body].concat())
}

/// Takes the header off an answer to that client. Its sixteen bytes do not change the alignment of what follows.
fn unwrap(answer: &[u8], client: GUID) -> Option<(SampleIdentity, Bytes)> {
    let (head, rest) = answer.split_first_chunk::<4>()?;
    let (half, rest) = rest.split_first_chunk::<8>()?;
    let (number, body) = rest.split_first_chunk::<8>()?;
    let number = match head {
        [0, 1, ..] => i64::from_le_bytes(*number),
        [0, 0, ..] => i64::from_be_bytes(*number),
        _ => return None,
    };
    let [.., a, b, c, d, e, f, g, h] = client.to_bytes();
    let identity = SampleIdentity { writer_guid: client, sequence_number: number.into() };
    (*half == [a, b, c, d, e, f, g, h]).then(|| (identity, [&head[..], body].concat().into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cyclone_puts_a_header_in_front() {
        let client = GUID::from_bytes([1, 0x12, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16]);
        let identity = SampleIdentity { writer_guid: client, sequence_number: 77.into() };
        let message = [0, 1, 0, 0, 42, 43];
        let wrapped = wrap(&message, identity).unwrap();
        assert_eq!(wrapped.len(), message.len() + 16);
        assert_eq!(wrapped[4..12], client.to_bytes()[8..]);
        let (back, body) = unwrap(&wrapped, client).unwrap();
        assert_eq!((back, &body[..]), (identity, &message[..]));
        let other = GUID::from_bytes([9; 16]);
        assert!(unwrap(&wrapped, other).is_none());
        for cut in 0..20 {
            assert!(unwrap(&wrapped[..cut], client).is_none());
        }
        assert!(wrap(&[0, 0, 0, 0], identity).is_err());
        assert_eq!(Mapping::of(GUID::from_bytes([1, 0x10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0])), Mapping::Header);
        assert_eq!(Mapping::of(client), Mapping::Enhanced);
    }
}
