//! One specification's monitor over a graph from some moment on: it decodes what it reads, and judges.
//!
//! A topic may turn up late, or with another type than expected. What could not be read before is then judged by a further monitor, a
//! second *shift*, while the first goes on with what it has: no property is judged twice, and none loses its past.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use bytes::Bytes;
use lapwing_check::Checked;
use lapwing_check::checked::EventSource;
use lapwing_record::{Cells, Decoder, Item};
use lapwing_stream::{Sample, Time, Value, What};

use super::graph::Graph;
use crate::fitted::Fitted;
use crate::intake::{Intake, Wants};
use crate::run::Run;
use crate::session::Options;
use crate::spec::Spec;

/// A monitor over some properties of one specification.
pub(crate) struct Shift<'s> {
    /// The monitor.
    pub run: Run<'s>,
    /// The names of the properties that it judges.
    pub owned: BTreeSet<String>,
    wants: Wants,
    intake: Intake,
    /// The type that each topic was read with when this began.
    types: BTreeMap<String, String>,
    /// The topics whose messages are events, which do not happen once more because somebody begins to look.
    of_events: BTreeSet<String>,
    bindings: BTreeMap<u32, Binding>,
    elements: usize,
}

/// What is done with the messages of a stream.
enum Binding {
    /// Nothing: only their time matters.
    Unread,
    /// Some fields are decoded.
    Read(Box<Reading>),
    /// They cannot be decoded.
    Unreadable(String),
}

struct Reading {
    wanted: usize,
    decoder: Decoder,
    values: Vec<Value>,
}

impl<'s> Shift<'s> {
    /// A monitor of those properties of a checked specification. The others of it are judged elsewhere, or cannot be.
    pub fn new(spec: &'s Spec, mut checked: Checked, owned: BTreeSet<String>, options: &Options) -> Shift<'s> {
        for property in &mut checked.spec.properties {
            if !owned.contains(&property.name) && property.problem.is_none() {
                property.problem = Some("another monitor judges it".to_owned());
            }
        }
        let topics = checked.spec.topics.iter();
        let types = topics.filter_map(|t| Some((t.name.clone(), t.type_name.clone()?))).collect();
        let of_events = checked.spec.events.iter().filter_map(|event| match event.source {
            EventSource::Message { topic } => checked.spec.topics.get(topic).map(|t| t.name.clone()),
            _ => None,
        });
        let of_events = of_events.collect();
        let mut wants = Wants::default();
        let noting = options.noting();
        let fitted = Arc::new(Fitted::new(spec, checked, noting.open_limit));
        let run = Run::new(Cow::Borrowed(spec), fitted, noting);
        let intake = Intake::new(run.meaning(), &mut wants);
        let elements = options.recording.limits.elements;
        Shift { run, owned, wants, intake, types, of_events, bindings: BTreeMap::new(), elements }
    }

    /// The properties that it judges, with their numbers.
    pub fn own(&self) -> impl Iterator<Item = (usize, String)> {
        let named = self.run.blanks().iter().enumerate().map(|(number, blank)| (number, blank.name.clone()));
        named.filter(|(_, name)| self.owned.contains(name))
    }

    /// Takes in what is known of the past: the latest message of each stream, but for events.
    pub fn catch_up(&mut self, graph: &Graph) {
        for (at, number, payload) in graph.latest() {
            let is_event = graph.get(number).is_none_or(|stream| self.of_events.contains(&stream.topic));
            if !is_event {
                // Whoever received it has complained already if it could not be decoded.
                let _ = self.message(graph, at, number, &payload);
            }
        }
    }

    /// Time has come so far.
    pub fn pass(&mut self, at: Time) {
        self.run.take(Sample { time: at, what: What::Other });
    }

    /// A message came. An error says why it could not be decoded; then only its time counts. Gives whether it is read.
    pub fn message(&mut self, graph: &Graph, at: Time, number: u32, payload: &Bytes) -> Result<bool, String> {
        if !self.bindings.contains_key(&number) {
            let binding = self.bind(graph, number);
            self.bindings.insert(number, binding);
        }
        let decoded = match self.bindings.get_mut(&number) {
            Some(Binding::Read(reading)) => {
                let Reading { wanted, decoder, values } = &mut **reading;
                match decoder.decode(payload, values) {
                    Ok(()) => {
                        let topic = graph.get(number).map_or("", |s| s.topic.as_str());
                        let item = Item::Message { time: at, wanted: Some(*wanted), topic, values };
                        self.run.take(self.intake.sample(&item));
                        return Ok(true);
                    }
                    Err(why) => Err(why.to_string()),
                }
            }
            Some(Binding::Unreadable(why)) => Err(why.clone()),
            Some(Binding::Unread) | None => Ok(false),
        };
        self.pass(at);
        decoded
    }

    /// The columns that it reads: `publishers(/cmd_vel)`, and nothing else on a graph.
    pub fn columns(&self) -> &[lapwing_stream::Name] {
        self.wants.signals()
    }

    /// The values of its columns, one for each.
    pub fn row(&mut self, at: Time, values: &[Value]) {
        let Shift { run, wants, intake, .. } = self;
        run.take(intake.sample(&Item::Row { time: at, cells: Cells::new(wants.signals(), values) }));
    }

    /// More is known of a stream than before.
    pub fn unbind(&mut self, number: u32) {
        self.bindings.remove(&number);
    }

    /// Decides what is done with a stream.
    fn bind(&self, graph: &Graph, number: u32) -> Binding {
        let Some(stream) = graph.get(number) else { return Binding::Unread };
        let wanted = self.wants.list().iter().position(|w| w.topic == stream.topic);
        let Some((wanted, fields)) = wanted.and_then(|k| Some((k, &self.wants.list().get(k)?.fields))) else {
            return Binding::Unread;
        };
        // What was checked against another type, or against none, is not decoded by this one.
        if self.types.get(&stream.topic) != Some(&stream.type_name) {
            return Binding::Unread;
        }
        let ty = match &stream.channel.ty {
            Ok(ty) => ty,
            Err(why) => return Binding::Unreadable(why.clone()),
        };
        match Decoder::new(ty, fields, self.elements) {
            Ok(decoder) => {
                let values = decoder.slots();
                Binding::Read(Box::new(Reading { wanted, decoder, values }))
            }
            Err(why) => Binding::Unreadable(why.to_string()),
        }
    }
}
