//! Who is on the graph: which nodes a participant has, and which endpoints are whose. Each participant tells that of itself on the topic
//! `ros_discovery_info`, as `rmw_dds_common/msg/ParticipantEntitiesInfo`.

use std::collections::BTreeMap;

use super::cdr::{Malformed, Reader, Writer};

/// The topic on the wire, which has no prefix.
pub const TOPIC: &str = "ros_discovery_info";
/// Its type on the wire.
pub const TYPE: &str = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";

/// What is known of more participants than this is forgotten.
const MAX_PARTICIPANTS: usize = 1 << 12;
/// Up to Humble a GID has bytes after those of the GUID.
const OLD_GID: usize = 24;

/// A DDS GUID.
pub type Gid = [u8; 16];

/// A node of a participant.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Node {
    /// Its namespace: `/` or `/robot1`.
    pub namespace: String,
    /// Its name.
    pub name: String,
    /// Its readers.
    pub readers: Vec<Gid>,
    /// Its writers.
    pub writers: Vec<Gid>,
}

impl Node {
    /// Its name with the namespace: `/robot1/driver`.
    pub fn full_name(&self) -> String {
        format!("{}/{}", self.namespace.trim_end_matches('/'), self.name)
    }
}

/// What a participant tells of itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Participant {
    /// Its GUID.
    pub gid: Gid,
    /// Its nodes.
    pub nodes: Vec<Node>,
}

impl Participant {
    /// Reads the message: with GIDs of 16 bytes, else of 24 as they were up to Humble. Only one of the two fits.
    pub fn decode(message: &[u8]) -> Result<Participant, Malformed> {
        decode(message, size_of::<Gid>()).or_else(|new| decode(message, OLD_GID).map_err(|_| new))
    }

    /// Writes the message, with GIDs of 16 bytes.
    pub fn encode(&self) -> Vec<u8> {
        let mut writer = Writer::default();
        writer.bytes(&self.gid).u32(count(&self.nodes));
        for node in &self.nodes {
            writer.text(&node.namespace).text(&node.name);
            for gids in [&node.readers, &node.writers] {
                writer.u32(count(gids));
                gids.iter().for_each(|gid| {
                    writer.bytes(gid);
                });
            }
        }
        writer.finish()
    }
}

fn count<T>(items: &[T]) -> u32 {
    u32::try_from(items.len()).unwrap_or(u32::MAX)
}

fn decode(message: &[u8], gid_size: usize) -> Result<Participant, Malformed> {
    let mut reader = Reader::new(message)?;
    let gid = |r: &mut Reader<'_>| -> Result<Gid, Malformed> {
        let mut gid = Gid::default();
        gid.copy_from_slice(r.bytes(gid_size)?.get(..16).unwrap_or(&[0; 16]));
        Ok(gid)
    };
    let own = gid(&mut reader)?;
    let nodes = reader.sequence(16, |r| {
        Ok(Node {
            namespace: r.text()?,
            name: r.text()?,
            readers: r.sequence(gid_size, gid)?,
            writers: r.sequence(gid_size, gid)?,
        })
    })?;
    if !reader.is_done() {
        return Err(Malformed("bytes are left"));
    }
    Ok(Participant { gid: own, nodes })
}

/// All participants that were heard of.
#[derive(Debug, Default)]
pub struct Graph {
    participants: BTreeMap<Gid, Vec<Node>>,
    owners: BTreeMap<Gid, String>,
}

impl Graph {
    /// Notes what a participant tells of itself, in place of what it told before. Gives the names of nodes that it has no more.
    pub fn note(&mut self, participant: Participant) -> Vec<String> {
        let is_new = !self.participants.contains_key(&participant.gid);
        if is_new && self.participants.len() >= MAX_PARTICIPANTS {
            return Vec::new();
        }
        let mut left = self.forget(participant.gid);
        for node in &participant.nodes {
            let name = node.full_name();
            left.retain(|gone| *gone != name);
            for endpoint in node.readers.iter().chain(&node.writers) {
                self.owners.insert(*endpoint, name.clone());
            }
        }
        self.participants.insert(participant.gid, participant.nodes);
        left
    }

    /// Forgets a participant that is gone. Gives the names of its nodes.
    pub fn forget(&mut self, participant: Gid) -> Vec<String> {
        let nodes = self.participants.remove(&participant).unwrap_or_default();
        for endpoint in nodes.iter().flat_map(|n| n.readers.iter().chain(&n.writers)) {
            self.owners.remove(endpoint);
        }
        nodes.iter().map(Node::full_name).collect()
    }

    /// The node that an endpoint belongs to: `/turtlebot/driver`.
    pub fn owner(&self, endpoint: &Gid) -> Option<&str> {
        self.owners.get(endpoint).map(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Participant {
        let node = |name: &str, k: u8| Node {
            namespace: "/r1".to_owned(),
            name: name.to_owned(),
            readers: vec![[k; 16]],
            writers: vec![[k + 1; 16], [k + 2; 16]],
        };
        Participant { gid: [9; 16], nodes: vec![node("driver", 10), node("planner", 20)] }
    }

    #[test]
    fn what_is_told_comes_back() {
        let participant = sample();
        assert_eq!(Participant::decode(&participant.encode()), Ok(participant));
    }

    #[test]
    fn older_distributions_have_longer_identifiers() {
        let mut writer = Writer::default();
        writer.bytes(&[7; 24]).u32(1).text("/").text("old").u32(1).bytes(&[8; 24]).u32(0);
        let participant = Participant::decode(&writer.finish()).unwrap();
        assert_eq!(participant.gid, [7; 16]);
        assert_eq!(participant.nodes[0].full_name(), "/old");
        assert_eq!(participant.nodes[0].readers, [[8; 16]]);
    }

    #[test]
    fn no_bytes_make_it_panic() {
        let message = sample().encode();
        for cut in 0..message.len() {
            assert!(Participant::decode(&message[..cut]).is_err(), "{cut}");
        }
        for at in 0..message.len() {
            let mut broken = message.clone();
            broken[at] ^= 0xff;
            let _ = Participant::decode(&broken);
        }
    }

    #[test]
    fn nodes_come_and_go() {
        let mut graph = Graph::default();
        let mut participant = sample();
        assert!(graph.note(participant.clone()).is_empty());
        assert_eq!(graph.owner(&[12; 16]), Some("/r1/driver"));
        participant.nodes.remove(0);
        assert_eq!(graph.note(participant), ["/r1/driver"]);
        assert_eq!(graph.owner(&[12; 16]), None);
        assert_eq!(graph.forget([9; 16]), ["/r1/planner"]);
        assert_eq!(graph.owner(&[22; 16]), None);
    }
}
