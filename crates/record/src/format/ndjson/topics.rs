//! The topics of a stream, which come to be known with their first message.

use std::collections::BTreeMap;
use std::sync::Arc;

use lapwing_stream::Value;

use super::super::Channel;
use crate::cells::fields;
use crate::decode::{DecodeError, MessageType, json_value, scan::Scanner};
use crate::definition::{Library, normal_name};
use crate::met::MetField;

/// The topics of a stream, with the types that its lines say.
pub(super) struct Topics {
    library: Library,
    /// There may be no more.
    most: usize,
    channels: Vec<Channel>,
    /// The type of each as its lines say it.
    said: Vec<String>,
    by_name: BTreeMap<String, BTreeMap<String, usize>>,
    /// The fields of the first message of each.
    fields: Vec<MetField>,
    /// The one that was found last.
    last: usize,
}

/// So many fields are remembered.
const MOST_FIELDS: usize = 4096;
/// An array with more elements is remembered by its own name, and so is what comes after it.
const ELEMENTS: usize = 1000;

impl Topics {
    pub fn new(library: &Library, most: usize) -> Topics {
        Topics {
            library: library.clone(),
            most,
            channels: Vec::new(),
            said: Vec::new(),
            by_name: BTreeMap::new(),
            fields: Vec::new(),
            last: 0,
        }
    }

    /// Those met so far.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The fields that their first messages had: for who asks for one without a declaration.
    pub fn fields(&self) -> &[MetField] {
        &self.fields
    }

    /// The channel of a topic and a type, which may be empty, and of which that is a message.
    pub fn find(&mut self, topic: &str, ty: &str, message: &[u8]) -> Result<usize, DecodeError> {
        // PERF: the next line is often one of the same topic.
        if self.channels.get(self.last).is_some_and(|c| *c.topic == *topic) && self.said[self.last] == ty {
            return Ok(self.last);
        }
        self.last = match self.by_name.get(topic).and_then(|types| types.get(ty)) {
            Some(known) => *known,
            None => {
                let added = self.add(topic, ty)?;
                // What is wrong with a message is said where it is decoded.
                let _ = self.look_into(message, topic, &normal_name(ty));
                added
            }
        };
        Ok(self.last)
    }

    fn look_into(&mut self, message: &[u8], topic: &str, type_name: &str) -> Result<(), DecodeError> {
        let (mut scanner, mut first, mut value) = (Scanner::new(message), true, Value::Missing);
        scanner.open(b'{')?;
        while scanner.more(b'}', &mut first)? {
            let key = scanner.key()?;
            if json_value(&mut scanner.clone(), &mut { ELEMENTS }, &mut value).is_err() {
                value = Value::Missing;
            }
            fields(&key, &value, &mut |path, _| {
                if self.fields.len() < MOST_FIELDS {
                    let (topic, type_name, path) = (topic.to_owned(), type_name.to_owned(), path.to_owned());
                    self.fields.push(MetField { topic, type_name, path });
                }
            });
            scanner.skip()?;
        }
        Ok(())
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
