//! Quality of service: what to ask of a publisher so that its messages come, and what to offer to subscribers.

use rustdds::policy::{Durability, History, Reliability, ResourceLimits};
use rustdds::{Duration, QosPolicies, QosPolicyBuilder};

/// How a publisher is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Reading {
    /// What is lost on the way is sent again.
    pub is_reliable: bool,
    /// What was sent before the subscription is sent to it as well.
    pub is_kept: bool,
}

/// From the strongest to the weakest.
const READINGS: [Reading; 4] = [
    Reading { is_reliable: true, is_kept: true },
    Reading { is_reliable: true, is_kept: false },
    Reading { is_reliable: false, is_kept: true },
    Reading { is_reliable: false, is_kept: false },
];

impl Reading {
    /// The strongest reading that a publisher's offer allows. Where it allows none, which policy stands in the way.
    pub fn of(offered: &QosPolicies) -> Result<Reading, String> {
        let obstacle = |reading: &Reading| offered.compliance_failure_wrt(&reading.request(1));
        match READINGS.iter().find(|r| obstacle(r).is_none()) {
            Some(reading) => Ok(*reading),
            None => {
                Err(READINGS.last().and_then(obstacle).map_or_else(String::new, |id| obstacle_in_words(id, offered)))
            }
        }
    }

    /// What is asked of publishers, with room for so many messages that came and were not taken yet. The room is the cache's of
    /// the whole topic: it is bounded by their number alone.
    pub fn request(self, room: i32) -> QosPolicies {
        let limits = ResourceLimits { max_samples: room, max_instances: 1, max_samples_per_instance: room };
        let reliability = if self.is_reliable { reliable() } else { Reliability::BestEffort };
        let durability = if self.is_kept { Durability::TransientLocal } else { Durability::Volatile };
        let builder = QosPolicyBuilder::new().reliability(reliability).durability(durability);
        builder.history(History::KeepLast { depth: 1 }).resource_limits(limits).build()
    }
}

/// A write never waits for a slow reader: what is asked of a connector returns at once.
fn reliable() -> Reliability {
    Reliability::Reliable { max_blocking_time: Duration::ZERO }
}

fn obstacle_in_words(policy: rustdds::dds::qos::QosPolicyId, offered: &QosPolicies) -> String {
    use rustdds::dds::qos::QosPolicyId;
    match policy {
        QosPolicyId::Ownership => {
            "the publisher offers OWNERSHIP EXCLUSIVE, and nodes of ROS 2 read what is SHARED".to_owned()
        }
        QosPolicyId::Representation => {
            let offers = offered.data_representation().map(|r| r.value).unwrap_or_default();
            let names = offers.iter().map(|id| match id {
                0 => "XCDR1".to_owned(),
                1 => "XML".to_owned(),
                2 => "XCDR2".to_owned(),
                other => format!("number {other}"),
            });
            let names: Vec<String> = names.collect();
            format!("the publisher offers DATA_REPRESENTATION {}, and nodes of ROS 2 read XCDR1", names.join(", "))
        }
        other => format!("no reader is compatible with the {other:?} that the publisher offers"),
    }
}

/// Offers of the node's own publishers, with as many messages kept for readers that fall behind as `rmw` has by default.
pub fn offer(is_latched: bool) -> QosPolicies {
    let (durability, depth) = if is_latched { (Durability::TransientLocal, 1) } else { (Durability::Volatile, 10) };
    let builder = QosPolicyBuilder::new().reliability(reliable()).durability(durability);
    builder.history(History::KeepLast { depth }).build()
}

#[cfg(test)]
mod tests {
    use rustdds::policy::{DataRepresentation, Ownership};

    use super::*;

    #[test]
    fn the_strongest_that_is_offered_is_asked_for() {
        for reading in READINGS {
            assert_eq!(Reading::of(&reading.request(5)), Ok(reading));
        }
        let silent = QosPolicies::qos_none();
        assert_eq!(Reading::of(&silent).map(|r| r.is_kept), Ok(false));
    }

    #[test]
    fn what_cannot_match_is_named() {
        let exclusive = QosPolicyBuilder::new().ownership(Ownership::Exclusive { strength: 3 }).build();
        assert!(Reading::of(&exclusive).is_err_and(|e| e.contains("OWNERSHIP")));
        let newer = QosPolicies::qos_none().with_data_representation(DataRepresentation { value: vec![2] });
        assert!(Reading::of(&newer).is_err_and(|e| e.contains("XCDR2")));
    }
}
