//! As which messages monitors and recordings see what happens: a topic for each port, and for what activities and services do.
//!
//! | topic | message |
//! | --- | --- |
//! | `/C/P` | what is written to the port `P`; of many ports under one name, `name` and `value` |
//! | `/C/A/running` | `data`: whether an instance of the activity runs |
//! | `/C/A/start` | the parameters of the request |
//! | `/C/A/end` | `outcome`: `done`, `interrupted`, or the exception |
//! | `/C/S/request` | the parameters |
//! | `/C/S/report` | `outcome`, and the parameters as they are then; of a request that was refused, `refused` and why |
//! | `/C/overrun` | `codel` (`Acquire.read`), `function`, and in seconds `took` and `wcet` |
//! | `/C/missed` | `task`: a turn of it was left out |
//! | `/C/late` | `task`, and in seconds `by` how much its turn began late |
//! | `/lapwing/components` | `names`, and `ended`: false at the beginning, true at the end |

use std::collections::BTreeMap;
use std::sync::Arc;

use lapwing_check::{COMPONENTS, TraceShape, TraceTopic};
use lapwing_genom::model::{Component, Model, Parameter, Service, ServiceKind};
use lapwing_stream::{Field, Name, Schema, Type, Value};

use crate::datum::Datum;
use crate::happening::{Happening, What, Whose};
use crate::types::Types;

/// A topic.
#[derive(Clone, Debug)]
pub struct Topic {
    /// Its name.
    pub name: String,
    /// The type of its messages.
    pub schema: Arc<Schema>,
}

/// A message.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// The number of its topic.
    pub topic: usize,
    /// What it says: a record.
    pub value: Value,
}

/// What can be said of an activity or another service.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Phase {
    Running,
    Start,
    End,
    Request,
    Report,
}

/// What can go wrong in a component.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
enum Fault {
    Overrun,
    Missed,
    Late,
}

/// The topics of a system.
#[derive(Clone, Debug)]
pub struct Signals {
    model: Arc<Model>,
    types: Types,
    topics: Vec<Topic>,
    ports: BTreeMap<(usize, usize), usize>,
    services: BTreeMap<(Whose, Phase), usize>,
    faults: BTreeMap<(usize, Fault), usize>,
    /// By topic: whether anybody wants to know what its messages say, and not only when they come.
    wanted: Vec<bool>,
    /// How many instances of each activity run.
    running: BTreeMap<Whose, u64>,
}

impl Signals {
    /// Those of a model.
    pub fn new(model: &Arc<Model>, types: &Types) -> Signals {
        let mut signals = Signals {
            model: model.clone(),
            types: types.clone(),
            topics: Vec::new(),
            ports: BTreeMap::new(),
            services: BTreeMap::new(),
            faults: BTreeMap::new(),
            wanted: Vec::new(),
            running: BTreeMap::new(),
        };
        let names = Type::Array(Box::new(Type::Str));
        signals.add(
            COMPONENTS.to_owned(),
            "lapwing/Components",
            vec![field("names", names), field("ended", Type::Bool)],
        );
        for (number, component) in model.components.iter().enumerate() {
            signals.ports(number, component);
            signals.faults(number, &component.name);
            for (service, declared) in component.services.iter().enumerate() {
                signals.service(Whose::new(number, lapwing_genom::model::ServiceId(service)), component, declared);
            }
        }
        signals
    }

    fn add(&mut self, name: String, type_name: &str, fields: Vec<Field>) -> usize {
        let schema = Schema { name: type_name.to_owned(), fields, constants: Vec::new() };
        self.wanted.push(true);
        self.topics.push(Topic { name, schema: Arc::new(schema) });
        self.topics.len() - 1
    }

    fn faults(&mut self, number: usize, name: &str) {
        let (text, seconds) = (|name| field(name, Type::Str), |name| field(name, Type::Num { float: true }));
        for (fault, fields) in [
            (Fault::Overrun, vec![text("codel"), text("function"), seconds("took"), seconds("wcet")]),
            (Fault::Missed, vec![text("task")]),
            (Fault::Late, vec![text("task"), seconds("by")]),
        ] {
            let word = format!("{fault:?}");
            let topic = self.add(format!("/{name}/{}", word.to_lowercase()), &format!("lapwing/{word}"), fields);
            self.faults.insert((number, fault), topic);
        }
    }

    fn ports(&mut self, number: usize, component: &Component) {
        for (place, port) in component.ports.iter().enumerate().filter(|(_, p)| p.is_out) {
            let name = format!("/{}/{}", component.name, port.name);
            let topic = match self.types.stream_type(&port.ty) {
                ty if port.multiple => {
                    self.add(name, "lapwing/Ports", vec![field("name", Type::Str), field("value", ty)])
                }
                Type::Message(schema) => self.add(name, &schema.name, schema.fields.clone()),
                ty => self.add(name, "lapwing/Value", vec![field("data", ty)]),
            };
            self.ports.insert((number, place), topic);
        }
    }

    fn service(&mut self, whose: Whose, component: &Component, service: &Service) {
        let is_activity = service.kind == ServiceKind::Activity;
        let phases = [Phase::Running, Phase::Start, Phase::End, Phase::Request, Phase::Report];
        for phase in phases.into_iter().filter(|p| is_activity || *p >= Phase::Request) {
            let (word, type_name) = match phase {
                Phase::Running => ("running", "lapwing/Running".to_owned()),
                Phase::Start => ("start", format!("{}/{}", component.name, service.name)),
                Phase::Request => ("request", format!("{}/{}", component.name, service.name)),
                Phase::End => ("end", "lapwing/End".to_owned()),
                Phase::Report => ("report", format!("{}/{}_report", component.name, service.name)),
            };
            let parameters =
                service.parameters.iter().filter_map(|p| Some(field(&p.name, self.types.stream_type(p.ty.as_ref()?))));
            let fields = match phase {
                Phase::Running => vec![field("data", Type::Bool)],
                Phase::End => vec![field("outcome", Type::Str)],
                Phase::Start | Phase::Request => parameters.collect(),
                Phase::Report => {
                    [field("outcome", Type::Str), field("refused", Type::Str)].into_iter().chain(parameters).collect()
                }
            };
            let topic = self.add(format!("/{}/{}/{word}", component.name, service.name), &type_name, fields);
            self.services.insert((whose, phase), topic);
        }
    }

    /// Of topics that are not among these, messages say nothing from now on.
    pub(crate) fn want_only(&mut self, wanted: impl Fn(usize) -> bool) {
        self.wanted.iter_mut().enumerate().for_each(|(topic, is_wanted)| *is_wanted = wanted(topic));
    }

    fn is_wanted(&self, topic: usize) -> bool {
        self.wanted.get(topic).copied().unwrap_or(true)
    }

    /// All topics.
    pub fn topics(&self) -> &[Topic] {
        &self.topics
    }

    /// What a specification is checked against.
    pub fn shape(&self) -> TraceShape {
        let topic = |topic: &Topic| TraceTopic {
            name: topic.name.clone(),
            type_name: topic.schema.name.clone(),
            schema: Some(topic.schema.clone()),
        };
        TraceShape { topics: self.topics.iter().map(topic).collect(), ..TraceShape::default() }
    }

    /// What is said before anything happens: who is there, and that nothing runs.
    pub fn first(&self) -> Vec<Message> {
        let names = self.model.components.iter().map(|c| Value::Str(c.name.clone())).collect();
        let began = record([("names", Value::List(names)), ("ended", Value::Bool(false))]);
        let quiet = self.services.iter().filter(|((_, phase), _)| *phase == Phase::Running);
        let quiet = quiet.map(|(_, topic)| Message { topic: *topic, value: record([("data", Value::Bool(false))]) });
        std::iter::once(Message { topic: 0, value: began }).chain(quiet).collect()
    }

    /// What is said when everything is over.
    pub fn last(&self) -> Message {
        let names = self.model.components.iter().map(|c| Value::Str(c.name.clone())).collect();
        Message { topic: 0, value: record([("names", Value::List(names)), ("ended", Value::Bool(true))]) }
    }

    /// What is said of something that happens.
    pub fn of(&mut self, happening: &Happening) -> Vec<Message> {
        match &happening.what {
            What::Requested { whose, values, .. } => self.said(*whose, Phase::Request, &[], values),
            What::Replied { whose, refused: Some(why), .. } => {
                self.said(*whose, Phase::Report, &[("outcome", "refused"), ("refused", why)], &[])
            }
            What::Reported { whose, outcome, values, .. } => {
                self.said(*whose, Phase::Report, &[("outcome", &outcome.to_string())], values)
            }
            What::Started { whose, values, .. } => {
                let mut all = self.runs(*whose, true);
                all.extend(self.said(*whose, Phase::Start, &[], values));
                all
            }
            What::Ended { whose, outcome, .. } => {
                let mut all = self.runs(*whose, false);
                all.extend(self.said(*whose, Phase::End, &[("outcome", &outcome.to_string())], &[]));
                all
            }
            What::Written { component, port, name, value } => self.port(*component, port.0, name.as_deref(), value),
            What::Overrun { component, codel, took, wcet } => {
                let found = self.model.components.get(*component).and_then(|c| Some((c, c.codels.get(codel.0)?)));
                let Some((declared, codel)) = found else { return Vec::new() };
                let (name, function) = (declared.codel_name(codel), codel.function.clone());
                let times = [("took", Value::Num(took.seconds())), ("wcet", Value::Num(wcet.seconds()))];
                let texts = [("codel", Value::Str(name)), ("function", Value::Str(function))];
                self.fault(*component, Fault::Overrun, texts.into_iter().chain(times).collect())
            }
            What::Missed { component, task } => {
                self.fault(*component, Fault::Missed, vec![("task", self.task(*component, task.0))])
            }
            What::Late { component, task, by } => {
                let by = Value::Num(by.seconds());
                self.fault(*component, Fault::Late, vec![("task", self.task(*component, task.0)), ("by", by)])
            }
            _ => Vec::new(),
        }
    }

    fn task(&self, component: usize, task: usize) -> Value {
        let found = self.model.components.get(component).and_then(|c| c.tasks.get(task));
        Value::Str(found.map(|t| t.name.clone()).unwrap_or_default())
    }

    fn fault(&self, component: usize, fault: Fault, parts: Vec<(&str, Value)>) -> Vec<Message> {
        let topic = self.faults.get(&(component, fault)).copied();
        let value = Value::Record(parts.into_iter().map(|(name, value)| (Name::from(name), value)).collect());
        topic.map(|topic| Message { topic, value }).into_iter().collect()
    }

    /// One more instance runs, or one less. It is said where the first begins or the last ends.
    fn runs(&mut self, whose: Whose, more: bool) -> Vec<Message> {
        let count = self.running.entry(whose).or_default();
        let before = *count;
        *count = if more { before + 1 } else { before.saturating_sub(1) };
        let is_news = (before == 0) != (*count == 0);
        let topic = self.services.get(&(whose, Phase::Running)).filter(|_| is_news);
        let value = record([("data", Value::Bool(*count > 0))]);
        topic.map(|topic| Message { topic: *topic, value }).into_iter().collect()
    }

    fn said(&self, whose: Whose, phase: Phase, words: &[(&str, &str)], values: &[Datum]) -> Vec<Message> {
        let Some(topic) = self.services.get(&(whose, phase)).copied() else { return Vec::new() };
        let service = self.model.components.get(whose.component).and_then(|c| c.services.get(whose.service.0));
        let parameters = service.map_or(&[][..], |s| &s.parameters);
        let words = words.iter().map(|(name, text)| (Name::from(*name), Value::Str((*text).to_owned())));
        let named = |(parameter, value): (&Parameter, &Datum)| {
            let value = self.types.to_value(parameter.ty.as_ref()?, value);
            Some((Name::from(parameter.name.as_str()), value))
        };
        let values = parameters.iter().zip(values).filter_map(named);
        vec![Message { topic, value: Value::Record(words.chain(values).collect()) }]
    }

    fn port(&self, component: usize, port: usize, name: Option<&str>, value: &Datum) -> Vec<Message> {
        let Some(topic) = self.ports.get(&(component, port)).copied() else { return Vec::new() };
        if !self.is_wanted(topic) {
            return vec![Message { topic, value: Value::Missing }];
        }
        let declared = self.model.components.get(component).and_then(|c| c.ports.get(port));
        let Some(declared) = declared else { return Vec::new() };
        let value = self.types.to_value(&declared.ty, value);
        let value = match (name, value) {
            (Some(name), value) => record([("name", Value::Str(name.to_owned())), ("value", value)]),
            (None, value @ Value::Record(_)) => value,
            (None, value) => record([("data", value)]),
        };
        vec![Message { topic, value }]
    }
}

fn field(name: &str, ty: Type) -> Field {
    Field { name: name.into(), ty }
}

fn record<const N: usize>(parts: [(&str, Value); N]) -> Value {
    Value::Record(parts.into_iter().map(|(name, value)| (Name::from(name), value)).collect())
}
