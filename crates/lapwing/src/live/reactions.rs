//! Reactions: what a specification wants done when a property is violated, made ready before the run and done after the step that found it.
//!
//! Messages are encoded beforehand, so that a reaction is a call of the transport, which queues and returns. Whatever cannot be made ready is
//! an error before anything is watched.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use lapwing_check::checked::{self, Action};
use lapwing_react::shown;
use lapwing_record::{Decoder, Dialect, Encoder, Layout, Library, MessageType, Path, RawChannel, normal_name};
use lapwing_ros::connector::{CallId, Connector, Definition, Encoding, PublisherId};
use lapwing_stream::{Name, Time, Value};

use super::course::Alarm;
use crate::spec::Spec;

/// How long the answer to a call is waited for.
const PATIENCE: Duration = Duration::from_secs(10);

/// An answer with more elements in arrays than this is not shown.
const MOST_ELEMENTS: usize = 1 << 16;

/// What a run may do to the robot.
#[derive(Clone, Debug, Default)]
pub struct Reach {
    /// Whether it only says what it would do.
    pub dry: bool,
    /// The only topics and services that it may touch; without a list, those that the specifications name.
    pub allowed: Option<Vec<String>>,
}

/// A topic or service that a specification may touch.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Touch {
    /// Its name.
    pub name: String,
    /// How.
    pub how: How,
    /// The type that is written to it, as far as it is known.
    pub type_name: String,
    /// The property that decides.
    pub property: String,
}

/// A way to touch a topic or a service.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum How {
    /// It calls a service.
    Call,
    /// It decides which messages pass to a topic.
    Guard,
    /// It publishes a topic.
    Publish,
}

impl How {
    /// What may be done: `may publish`.
    pub fn verb(self) -> &'static str {
        match self {
            How::Call => "call",
            How::Guard => "guard",
            How::Publish => "publish",
        }
    }
}

/// What a specification does: `it publishes`.
impl fmt::Display for How {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ending = if *self == How::Publish { "es" } else { "s" };
        write!(f, "{}{ending}", self.verb())
    }
}

/// Everything that specifications may touch, in the order of the names.
pub fn touches(specs: &[Spec]) -> Vec<Touch> {
    let mut touches = Vec::new();
    for reaction in specs.iter().flat_map(|spec| &spec.alone().spec.reactions) {
        let touch = |name: &str, how, type_name: &str| Touch {
            name: name.to_owned(),
            how,
            type_name: type_name.to_owned(),
            property: reaction.property.clone(),
        };
        touches.extend(reaction.actions.iter().filter_map(|action| match action {
            Action::Publish(message) => Some(touch(&message.to, How::Publish, &message.type_name)),
            Action::Call(message) => Some(touch(&message.to, How::Call, &message.type_name)),
            Action::Guard(guard) => Some(touch(&guard.to, How::Guard, "")),
            Action::Request(_) | Action::Run(_) | Action::Reset | Action::Stop => None,
        }));
    }
    touches.sort();
    touches.dedup();
    touches
}

/// The reactions of a run, ready to be carried out.
#[derive(Debug, Default)]
pub(crate) struct Reactions {
    list: Vec<Reaction>,
    /// What is published, each topic once.
    publishers: BTreeMap<String, PublisherId>,
    /// The calls that no answer has come to.
    calls: BTreeMap<u64, Asked>,
    is_dry: bool,
}

/// A reaction, ready.
#[derive(Debug)]
struct Reaction {
    spec: usize,
    property: String,
    pause: Option<lapwing_stream::Duration>,
    /// When it was carried out last.
    last: Option<Time>,
    actions: Vec<(String, Ready)>,
}

/// An action, ready.
#[derive(Clone, Debug)]
enum Ready {
    Publish(PublisherId, Vec<u8>),
    Call {
        service: String,
        type_name: String,
        request: Vec<u8>,
        answer: Option<MessageType>,
    },
    Stop,
    Reset,
    /// It is only told.
    Told,
}

/// A call that is on its way.
#[derive(Debug)]
struct Asked {
    service: String,
    answer: Option<MessageType>,
}

/// What reactions came to.
#[derive(Debug, Default)]
pub(crate) struct Done {
    /// Whether the run is to end.
    pub stops: bool,
    /// The properties whose monitors are to start afresh.
    pub resets: Vec<String>,
    /// How many things were handed to the transport.
    pub sent: usize,
    /// What is to be told.
    pub notes: Vec<String>,
}

impl Reactions {
    /// Makes the reactions of all specifications ready, with the publishers that there are already. An error says what cannot be, and why;
    /// notes are what will not be done.
    pub fn prepare(
        specs: &[Spec],
        reach: &Reach,
        publishers: BTreeMap<String, PublisherId>,
        connector: &mut dyn Connector,
    ) -> Result<(Reactions, Vec<String>), String> {
        refuse_what_is_not_allowed(specs, reach)?;
        let mut reactions = Reactions { is_dry: reach.dry, publishers, ..Reactions::default() };
        let mut notes = Vec::new();
        for (number, spec) in specs.iter().enumerate() {
            for reaction in &spec.alone().spec.reactions {
                let mut actions = Vec::new();
                for action in &reaction.actions {
                    let ready = reactions.ready(action, connector, &mut notes);
                    let ready = ready.map_err(|why| format!("{}: `{action}` cannot be done: {why}", spec.name()))?;
                    actions.extend(ready.map(|ready| (action.to_string(), ready)));
                }
                if !actions.is_empty() {
                    let (property, pause) = (reaction.property.clone(), reaction.at_most_every);
                    reactions.list.push(Reaction { spec: number, property, pause, last: None, actions });
                }
            }
        }
        notes.sort();
        notes.dedup();
        Ok((reactions, notes))
    }

    fn ready(
        &mut self,
        action: &Action,
        connector: &mut dyn Connector,
        notes: &mut Vec<String>,
    ) -> Result<Option<Ready>, String> {
        Ok(Some(match action {
            Action::Publish(message) => {
                let (channel, payload) = encoded(message, connector)?;
                match self.is_dry {
                    true => Ready::Told,
                    false => Ready::Publish(self.advertise(&channel, connector)?, payload),
                }
            }
            Action::Call(message) => {
                let (request, answer) = asked(message, connector)?;
                let (service, type_name) = (message.to.clone(), spelt(&message.type_name, "srv", connector.encoding()));
                if self.is_dry { Ready::Told } else { Ready::Call { service, type_name, request, answer } }
            }
            Action::Stop => Ready::Stop,
            Action::Reset => Ready::Reset,
            Action::Run(handler) => {
                notes.push(format!("`run {handler}` does nothing here: no host program has registered handlers"));
                return Ok(None);
            }
            Action::Request(activity) => {
                notes.push(format!("`request {activity}` does nothing here: a ROS graph has no activities"));
                return Ok(None);
            }
            Action::Guard(_) => return Ok(None),
        }))
    }

    /// The publishers, for the run after this one.
    pub fn into_publishers(self) -> BTreeMap<String, PublisherId> {
        self.publishers
    }

    /// The publisher of a topic, made once.
    pub fn advertise(&mut self, channel: &RawChannel, connector: &mut dyn Connector) -> Result<PublisherId, String> {
        if let Some(known) = self.publishers.get(&channel.topic) {
            return Ok(*known);
        }
        let publisher = connector.advertise(channel, false).map_err(|e| e.to_string())?;
        self.publishers.insert(channel.topic.clone(), publisher);
        Ok(publisher)
    }

    /// Carries out what violations ask for, at a time of the wall clock.
    pub fn carry_out(&mut self, alarms: &[Alarm], now: Time, connector: &mut dyn Connector) -> Done {
        let mut done = Done::default();
        let Reactions { list, calls, is_dry, .. } = self;
        for alarm in alarms {
            let base = alarm.property.name.split('[').next().unwrap_or_default();
            for reaction in list.iter_mut().filter(|r| r.spec == alarm.spec && r.property == base) {
                let is_soon = reaction.last.zip(reaction.pause).is_some_and(|(last, pause)| now.since(last) < pause);
                if is_soon {
                    continue;
                }
                reaction.last = Some(now);
                for (words, ready) in &reaction.actions {
                    let verb = if *is_dry { "would " } else { "" };
                    done.notes.push(format!("{verb}{words}, because {} is violated", alarm.property.name));
                    match carry_out(ready, connector) {
                        Ok(call) => {
                            done.sent += usize::from(matches!(ready, Ready::Publish(..) | Ready::Call { .. }));
                            calls.extend(call);
                        }
                        Err(why) => done.notes.push(format!("{words} failed: {why}")),
                    }
                    done.stops |= matches!(ready, Ready::Stop) && !*is_dry;
                    if matches!(ready, Ready::Reset) && !*is_dry {
                        done.resets.push(base.to_owned());
                    }
                }
            }
        }
        done
    }

    /// An answer to a call came: what is to be told of it.
    pub fn answered(&mut self, call: CallId, answer: Result<&[u8], &str>) -> Option<String> {
        let Asked { service, answer: ty } = self.calls.remove(&call.0)?;
        Some(match answer {
            Err(why) => format!("{service} did not answer: {why}"),
            Ok(bytes) => match ty.and_then(|ty| decoded(&ty, bytes)) {
                Some(value) => format!("{service} answered {}", shown::value(&value)),
                None => format!("{service} answered"),
            },
        })
    }
}

fn carry_out(ready: &Ready, connector: &mut dyn Connector) -> Result<Option<(u64, Asked)>, String> {
    match ready {
        Ready::Publish(publisher, payload) => {
            connector.publish(*publisher, payload).map(|()| None).map_err(|e| e.to_string())
        }
        Ready::Call { service, type_name, request, answer } => {
            let call = connector.call(service, type_name, request, PATIENCE).map_err(|e| e.to_string())?;
            Ok(Some((call.0, Asked { service: service.clone(), answer: answer.clone() })))
        }
        Ready::Stop | Ready::Reset | Ready::Told => Ok(None),
    }
}

fn refuse_what_is_not_allowed(specs: &[Spec], reach: &Reach) -> Result<(), String> {
    let Some(allowed) = &reach.allowed else { return Ok(()) };
    let is_allowed = |touch: &Touch| allowed.iter().any(|name| super::graph::absolute(name) == touch.name);
    let refused: Vec<String> = touches(specs)
        .iter()
        .filter(|touch| !is_allowed(touch))
        .map(|touch| format!("{} {} on violation of {}", touch.how, touch.name, touch.property))
        .collect();
    match refused.is_empty() {
        true => Ok(()),
        false => Err(format!("what is not allowed is not run: the specification {}", refused.join(", and "))),
    }
}

/// The bytes of a message, and the channel that it is published on.
pub(crate) fn encoded(
    message: &checked::Message,
    connector: &mut dyn Connector,
) -> Result<(RawChannel, Vec<u8>), String> {
    let type_name = spelt(&message.type_name, "msg", connector.encoding());
    let text = match connector.definition(&type_name).map_err(|e| e.to_string())? {
        Definition::Message(text) => text,
        Definition::Service(..) => return Err(format!("{type_name} is a service, not a message")),
    };
    let (ty, payload) = encode(&message.type_name, &text, &message.value, connector.encoding())?;
    let (encoding, messages) = match connector.encoding() {
        Encoding::Ros1 => ("ros1msg", "ros1"),
        Encoding::Cdr => ("ros2msg", "cdr"),
    };
    let channel = RawChannel {
        topic: message.to.clone(),
        type_name,
        encoding: encoding.to_owned(),
        definition: text.into_bytes(),
        messages: messages.to_owned(),
        ty: Ok(ty),
    };
    Ok((channel, payload))
}

/// The bytes of a request, and how its answer is decoded.
fn asked(message: &checked::Message, connector: &mut dyn Connector) -> Result<(Vec<u8>, Option<MessageType>), String> {
    let type_name = spelt(&message.type_name, "srv", connector.encoding());
    let type_name = if type_name.contains("/srv/") { type_name } else { type_name.replacen('/', "/srv/", 1) };
    let (request, answer) = match connector.definition(&type_name).map_err(|e| e.to_string())? {
        Definition::Service(request, answer) => (request, answer),
        Definition::Message(_) => return Err(format!("{type_name} is a message, not a service")),
    };
    let name = normal_name(&message.type_name);
    let (_, payload) = encode(&format!("{name}_Request"), &request, &message.value, connector.encoding())?;
    let answer = layout(&format!("{name}_Response"), &answer, connector.encoding()).ok().map(|(ty, _)| ty);
    Ok((payload, answer))
}

fn encode(name: &str, text: &str, value: &Value, encoding: Encoding) -> Result<(MessageType, Vec<u8>), String> {
    let (ty, encoder) = layout(name, text, encoding)?;
    let payload = encoder.encode(value).map_err(|e| e.to_string())?;
    Ok((ty, payload))
}

/// An encoder of messages of a type with that definition.
pub(crate) fn encoder(name: &str, text: &str, encoding: Encoding) -> Result<Encoder, String> {
    layout(name, text, encoding).map(|(_, encoder)| encoder)
}

fn layout(name: &str, text: &str, encoding: Encoding) -> Result<(MessageType, Encoder), String> {
    let (dialect, ty): (Dialect, fn(Arc<Layout>) -> MessageType) = match encoding {
        Encoding::Ros1 => (Dialect::Ros1, MessageType::Ros1),
        Encoding::Cdr => (Dialect::Ros2, MessageType::Cdr),
    };
    let layout = Library::default().layout(dialect, &normal_name(name), text).map_err(|e| e.to_string())?;
    Ok((ty(layout.clone()), Encoder::new(layout, encoding)))
}

/// All fields of an answer.
fn decoded(ty: &MessageType, bytes: &[u8]) -> Option<Value> {
    let names: Vec<Name> = ty.schema()?.fields.iter().map(|field| field.name.clone()).collect();
    let paths: Vec<Path> = names.iter().map(|name| Path::of_names([&**name])).collect();
    let mut decoder = Decoder::new(ty, &paths, MOST_ELEMENTS).ok()?;
    let mut values = decoder.slots();
    decoder.decode(bytes, &mut values).ok()?;
    Some(Value::Record(names.into_iter().zip(values).collect()))
}

/// The name of a type as the graph spells it.
fn spelt(name: &str, kind: &str, encoding: Encoding) -> String {
    match (encoding, name.split('/').collect::<Vec<_>>().as_slice()) {
        (Encoding::Cdr, [package, short]) => format!("{package}/{kind}/{short}"),
        (Encoding::Ros1, [package, _, short]) => format!("{package}/{short}"),
        _ => name.to_owned(),
    }
}
