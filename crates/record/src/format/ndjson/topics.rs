//! The topics of a stream, which come to be known with their first message.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::super::Channel;
use crate::decode::{DecodeError, MessageType};
use crate::definition::{Library, normal_name};

/// The topics of a stream, with the types that its lines say.
pub(super) struct Topics {
    library: Library,
    /// There may be no more.
    most: usize,
    channels: Vec<Channel>,
    /// The type of each as its lines say it.
    said: Vec<String>,
    by_name: BTreeMap<String, BTreeMap<String, usize>>,
    /// The one that was found last.
    last: usize,
}

impl Topics {
    pub fn new(library: &Library, most: usize) -> Topics {
        Topics {
            library: library.clone(),
            most,
            channels: Vec::new(),
            said: Vec::new(),
            by_name: BTreeMap::new(),
            last: 0,
        }
    }

    /// Those met so far.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The channel of a topic and a type, which may be empty.
    pub fn find(&mut self, topic: &str, ty: &str) -> Result<usize, DecodeError> {
        // PERF: the next line is often one of the same topic.
        if self.channels.get(self.last).is_some_and(|c| *c.topic == *topic) && self.said[self.last] == ty {
            return Ok(self.last);
        }
        self.last = match self.by_name.get(topic).and_then(|types| types.get(ty)) {
            Some(known) => *known,
            None => self.add(topic, ty)?,
        };
        Ok(self.last)
    }

    fn add(&mut self, topic: &str, ty: &str) -> Result<usize, DecodeError> {
        if self.channels.len() >= self.most {
            return Err(DecodeError::new("there are more topics than Limits::names allows"));
        }
        let (schema, note) = match ty {
            "" => (None, "its lines say no \"type\"".to_owned()),
            ty => match self.library.installed(ty) {
                Ok(layout) => (Some(layout.schema().clone()), String::new()),
                Err(error) => (None, error.to_string()),
            },
        };
        self.channels.push(Channel {
            topic: Arc::from(topic),
            type_name: normal_name(ty),
            ty: Ok(MessageType::Json(schema)),
            note,
            messages: None,
            declared: None,
        });
        self.said.push(ty.to_owned());
        let index = self.channels.len() - 1;
        self.by_name.entry(topic.to_owned()).or_default().insert(ty.to_owned(), index);
        Ok(index)
    }
}
