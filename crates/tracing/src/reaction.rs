//! What is to be done about violations, and how often that was done.

use std::collections::BTreeMap;

use lapwing::News;
use lapwing_check::checked::{self, Action};
use lapwing_stream::{Duration, Time};

use crate::handlers::Handler;

/// The reactions of a specification, ready to be carried out.
pub(crate) struct Reactions {
    all: Vec<Reaction>,
    handlers: BTreeMap<String, Handler>,
}

/// One reaction.
#[derive(Debug)]
pub(crate) struct Reaction {
    /// The properties that it is to, by their numbers.
    properties: Vec<usize>,
    pub at_most_every: Option<Duration>,
    pub actions: Vec<Action>,
}

impl Reactions {
    pub fn new(meaning: &checked::Spec, handlers: BTreeMap<String, Handler>) -> Reactions {
        let reaction = |r: &checked::Reaction| Reaction {
            properties: (0..meaning.properties.len()).filter(|&p| r.is_of(&meaning.properties[p])).collect(),
            at_most_every: r.at_most_every,
            actions: r.actions.clone(),
        };
        Reactions { all: meaning.reactions.iter().map(reaction).collect(), handlers }
    }

    /// The reactions to a violation of a property, with their numbers.
    pub fn to(&self, property: usize) -> impl Iterator<Item = (usize, &Reaction)> {
        self.all.iter().enumerate().filter(move |(_, r)| r.properties.contains(&property))
    }

    pub fn handler(&self, name: &str) -> Option<&Handler> {
        self.handlers.get(name)
    }
}

/// What was done so far.
#[derive(Debug, Default)]
pub(crate) struct Done {
    /// When each reaction to each instance of a property was carried out last.
    last: BTreeMap<(usize, String), Time>,
    /// How often each action was, in words, by the name of the property or instance.
    counts: BTreeMap<String, Vec<(String, u64)>>,
}

impl Done {
    /// Whether a reaction may be carried out now, at most so often for each instance of a property. If so, it counts as done.
    pub fn may(&mut self, number: usize, every: Duration, news: &News, now: Time) -> bool {
        let key = (number, news.property.name.clone());
        let is_early = self.last.get(&key).is_some_and(|last| now >= *last && now.since(*last) < every);
        if !is_early {
            self.last.insert(key, now);
        }
        !is_early
    }

    /// Counts an action for the report.
    pub fn count(&mut self, news: &News, words: String) {
        let counts = self.counts.entry(news.property.name.clone()).or_default();
        match counts.iter_mut().find(|(known, _)| *known == words) {
            Some((_, count)) => *count += 1,
            None => counts.push((words, 1)),
        }
    }

    /// What was done about a property, in words.
    pub fn told(&self, property: &str) -> Vec<String> {
        let counts = self.counts.get(property).into_iter().flatten();
        counts
            .map(|(words, count)| if *count == 1 { words.clone() } else { format!("{words} ({count} times)") })
            .collect()
    }
}
