//! Topics, and what is published on them in a step.

use std::collections::BTreeMap;

use lapwing_stream::Time;

use crate::message::{Kind, Message};

/// The topics of a simulation; a topic is known by its place in the list.
#[derive(Clone, Debug, Default)]
pub struct Topics {
    list: Vec<Topic>,
}

/// A topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topic {
    /// Its name, with a slash.
    pub name: String,
    /// The type of its messages.
    pub kind: Kind,
}

impl Topics {
    /// The place of the topic of that name, which is added where it is new.
    pub fn add(&mut self, name: String, kind: Kind) -> usize {
        self.list.iter().position(|t| t.name == name).unwrap_or_else(|| {
            self.list.push(Topic { name, kind });
            self.list.len() - 1
        })
    }

    /// All of them.
    pub fn list(&self) -> &[Topic] {
        &self.list
    }
}

/// What the names of topics begin with, from what a scenario says: with a slash in front, and none at the end.
pub fn prefix_of(text: &str) -> String {
    match text.trim_matches('/') {
        "" => String::new(),
        inner => format!("/{inner}"),
    }
}

/// What is published.
#[derive(Clone, Debug)]
pub enum Content {
    /// A message as it is.
    Message(Message),
    /// The scan of that number by the robot of that number, with that stamp. It takes long to make, and often nobody wants it.
    Scan { robot: usize, number: u64, stamp: Time },
    /// The ground truth as it is now.
    Models,
    /// The ground truth as transforms.
    Transforms,
}

/// A message on its way.
#[derive(Clone, Debug)]
pub struct Publication {
    /// On which topic.
    pub topic: usize,
    /// What.
    pub content: Content,
}

/// What is published in this step, and what is held up until a later one.
#[derive(Debug, Default)]
pub struct Outbox {
    /// In the order of their steps, then of their publication.
    waiting: BTreeMap<(u64, u64), Publication>,
    count: u64,
    step: u64,
}

impl Outbox {
    /// A step begins.
    pub fn begin(&mut self, step: u64) {
        self.step = step;
    }

    /// Publishes a message.
    pub fn send(&mut self, topic: usize, message: Message) {
        self.send_later(topic, Content::Message(message), 0);
    }

    /// Publishes something a number of steps from now.
    pub fn send_later(&mut self, topic: usize, content: Content, steps: u64) {
        self.waiting.insert((self.step + steps, self.count), Publication { topic, content });
        self.count += 1;
    }

    /// The next publication that is due in this step.
    pub fn next(&mut self) -> Option<Publication> {
        let entry = self.waiting.first_entry()?;
        if entry.key().0 > self.step { None } else { Some(entry.remove()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_up_comes_in_its_step_and_in_order() {
        let mut outbox = Outbox::default();
        outbox.begin(1);
        outbox.send_later(0, Content::Models, 2);
        outbox.send(1, Message::Bool(true));
        outbox.send(2, Message::Bool(true));
        let mut due = |step| {
            outbox.begin(step);
            std::iter::from_fn(|| outbox.next()).map(|p| p.topic).collect::<Vec<_>>()
        };
        assert_eq!([due(1), due(2), due(3)], [vec![1, 2], vec![], vec![0]]);
    }
}
