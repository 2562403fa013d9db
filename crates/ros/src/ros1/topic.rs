//! A topic that is subscribed to: the connections to its publishers, and what keeps it from being seen.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::brake::Brake;
use crate::connector::{Cause, StreamId};

/// For so long a topic may be without a publisher, and a publisher without a connection, before that is told.
pub(crate) const PATIENCE: Duration = Duration::from_secs(1);
/// A topic does not have more publishers.
pub(crate) const MOST_LINKS: usize = 256;

/// A topic.
#[derive(Debug)]
pub(crate) struct Topic {
    /// Whether the master knows that its publishers are wanted.
    pub is_registered: bool,
    /// How often the master said who publishes it.
    pub updates: u64,
    links: BTreeMap<String, Link>,
    /// Since when it has no publisher.
    empty_since: Instant,
    /// What was told to keep it from being seen.
    told: BTreeSet<Cause>,
}

/// A connection to a publisher, or the attempts at one.
#[derive(Debug)]
struct Link {
    standing: Standing,
    /// Whether the master that is there now knows of the publisher. One that a former master named is kept for as long as it is connected.
    is_listed: bool,
    brake: Arc<Brake>,
}

#[derive(Debug)]
enum Standing {
    Connecting(Instant),
    Up(StreamId),
    Failing(Failure),
}

/// Why a publisher cannot be heard.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Failure {
    pub cause: Cause,
    /// Whether nobody is there any more: then it says nothing either that could be missed.
    pub is_gone: bool,
}

impl Topic {
    pub fn new(now: Instant) -> Topic {
        Topic { is_registered: false, updates: 0, links: BTreeMap::new(), empty_since: now, told: BTreeSet::new() }
    }

    /// Takes over who publishes it, by their addresses; gives those to connect to. Who is not among them any more is let go.
    pub fn list(&mut self, publishers: &[String], now: Instant) -> Vec<(String, Arc<Brake>)> {
        let had_links = !self.links.is_empty();
        self.updates += 1;
        self.links.retain(|uri, link| {
            let stays = !link.is_listed || publishers.contains(uri);
            if !stays {
                link.brake.pull();
            }
            stays
        });
        let mut new = Vec::new();
        for uri in publishers.iter().take(MOST_LINKS) {
            let link = self.links.entry(uri.clone()).or_insert_with(|| {
                let brake = Arc::new(Brake::default());
                new.push((uri.clone(), brake.clone()));
                Link { standing: Standing::Connecting(now), is_listed: true, brake }
            });
            link.is_listed = true;
        }
        self.note_emptiness(had_links, now);
        new
    }

    /// Another master is there, which knows of nobody.
    pub fn forget_listing(&mut self) {
        self.is_registered = false;
        self.links.values_mut().for_each(|link| link.is_listed = false);
    }

    /// How many publishers the master has named.
    pub fn listed(&self) -> usize {
        self.links.values().filter(|link| link.is_listed).count()
    }

    /// A publisher is connected. Whether it still is one.
    pub fn connected(&mut self, uri: &str, stream: StreamId) -> bool {
        self.set(uri, Standing::Up(stream))
    }

    /// A publisher cannot be heard.
    pub fn failed(&mut self, uri: &str, failure: Failure, now: Instant) {
        let is_orphan = self.links.get(uri).is_some_and(|link| !link.is_listed);
        if is_orphan && let Some(link) = self.links.remove(uri) {
            link.brake.pull();
            self.note_emptiness(true, now);
        }
        self.set(uri, Standing::Failing(failure));
    }

    fn set(&mut self, uri: &str, standing: Standing) -> bool {
        let link = self.links.get_mut(uri);
        link.map(|link| link.standing = standing).is_some()
    }

    fn note_emptiness(&mut self, had_links: bool, now: Instant) {
        if had_links && self.links.is_empty() {
            self.empty_since = now;
        }
    }

    /// How many publishers of a stream are connected.
    pub fn count(&self, stream: StreamId) -> usize {
        self.links.values().filter(|link| matches!(link.standing, Standing::Up(s) if s == stream)).count()
    }

    /// The publishers that are connected, by their addresses.
    pub fn connections(&self) -> impl Iterator<Item = &str> {
        self.links.iter().filter(|(_, link)| matches!(link.standing, Standing::Up(_))).map(|(uri, _)| uri.as_str())
    }

    /// It has had no publisher since then.
    pub fn empty_since(&mut self, then: Instant) {
        self.empty_since = then;
    }

    /// Lets all publishers go.
    pub fn close(&mut self) {
        self.links.values().for_each(|link| link.brake.pull());
        self.links.clear();
    }

    /// What has to be told now: causes that are new, and causes that are no more. `elsewhere` is why no publisher could be heard of.
    pub fn news(&mut self, elsewhere: Option<&str>, now: Instant) -> (Vec<Cause>, Vec<Cause>) {
        let causes = self.causes(elsewhere, now);
        let new = causes.difference(&self.told).cloned().collect();
        let over = self.told.difference(&causes).cloned().collect();
        self.told = causes;
        (new, over)
    }

    fn causes(&self, elsewhere: Option<&str>, now: Instant) -> BTreeSet<Cause> {
        let is_any_up = self.links.values().any(|link| matches!(link.standing, Standing::Up(_)));
        let is_late = |since: Instant| now.saturating_duration_since(since) >= PATIENCE;
        let cause = |(uri, link): (&String, &Link)| match &link.standing {
            Standing::Failing(failure) if !(failure.is_gone && is_any_up) => Some(failure.cause.clone()),
            Standing::Connecting(since) if is_late(*since) => {
                Some(Cause::Disconnected(format!("the publisher at {uri} has not answered yet")))
            }
            _ => None,
        };
        let mut causes: BTreeSet<Cause> = self.links.iter().filter_map(cause).collect();
        if self.links.is_empty() && is_late(self.empty_since) {
            causes.insert(elsewhere.map_or(Cause::NoPublisher, |why| Cause::Disconnected(why.to_owned())));
        }
        causes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UP: StreamId = StreamId(3);

    fn uris(all: &[&str]) -> Vec<String> {
        all.iter().map(|u| (*u).to_owned()).collect()
    }

    fn failure(is_gone: bool) -> Failure {
        Failure { cause: Cause::Disconnected("x".to_owned()), is_gone }
    }

    #[test]
    fn nobody_publishing_is_told_after_a_second_and_taken_back_at_once() {
        let start = Instant::now();
        let mut topic = Topic::new(start);
        assert_eq!(topic.news(None, start), (vec![], vec![]));
        assert_eq!(topic.news(None, start + PATIENCE), (vec![Cause::NoPublisher], vec![]));
        assert_eq!(topic.list(&uris(&["a"]), start + PATIENCE).len(), 1);
        assert_eq!(topic.news(None, start + PATIENCE), (vec![], vec![Cause::NoPublisher]));
        assert_eq!(topic.news(None, start + 2 * PATIENCE).0.len(), 1, "it did not answer either");
        assert!(topic.connected("a", UP));
        assert_eq!((topic.news(None, start + 3 * PATIENCE).0.len(), topic.count(UP)), (0, 1));
        assert!(topic.list(&[], start + 3 * PATIENCE).is_empty());
        let (new, _) = topic.news(Some("no master"), start + 4 * PATIENCE);
        assert_eq!(new, [Cause::Disconnected("no master".to_owned())]);
    }

    #[test]
    fn who_is_gone_is_not_missed_while_another_is_there() {
        let now = Instant::now();
        let mut topic = Topic::new(now);
        topic.list(&uris(&["a", "b"]), now);
        topic.connected("a", UP);
        topic.failed("b", failure(true), now);
        assert_eq!(topic.news(None, now).0, []);
        topic.failed("b", failure(false), now);
        assert_eq!(topic.news(None, now).0, [failure(false).cause]);
        topic.failed("a", failure(true), now);
        assert_eq!(topic.count(UP), 0);
    }

    #[test]
    fn a_new_master_does_not_cost_connections_that_stand() {
        let now = Instant::now();
        let mut topic = Topic::new(now);
        topic.list(&uris(&["a"]), now);
        topic.connected("a", UP);
        topic.forget_listing();
        topic.list(&uris(&["b"]), now);
        assert_eq!((topic.count(UP), topic.listed()), (1, 1));
        topic.failed("a", failure(false), now);
        assert_eq!((topic.count(UP), topic.news(None, now).0), (0, vec![]), "nobody knows it any more");
    }
}
