//! What the world looked like at one moment, and which parts of it someone wants to know.

use lapwing_check::checked::{Expr, Kind, Read, ReadOf};
use lapwing_engine::inputs::Inputs;
use lapwing_stream::{Time, Value};

use crate::trail::Point;

/// What the world looked like at one moment, by the numbers of a checked specification. Who knows only the signals says so of the rest.
pub(crate) trait Moment {
    /// The value of a signal, [`Value::Missing`] where it has none.
    fn value(&self, input: usize) -> &Value;

    /// The fields of an event, where it occurred.
    fn event(&self, _event: usize) -> Option<&[Value]> {
        None
    }

    /// The state of a machine, `None` where it is undefined.
    fn state(&self, _machine: usize) -> Option<usize> {
        None
    }

    /// The stamp of a topic's last message.
    fn last(&self, _topic: usize) -> Option<Time> {
        None
    }

    /// Whether a message of it came.
    fn is_fresh(&self, _topic: usize) -> bool {
        false
    }

    /// How many messages of it came after that time, where that is known.
    fn messages_after(&self, _topic: usize, _time: Time) -> Option<usize> {
        None
    }

    /// The value of a slice.
    fn param(&self, _number: usize) -> Option<&Value> {
        None
    }

    /// The moment as a part of a course of them, where it is one.
    fn point(&self) -> Option<Point<'_>> {
        None
    }
}

/// What the world looks like to the engine now.
#[derive(Clone, Copy)]
pub(crate) struct Now<'i>(pub &'i Inputs);

impl Moment for Now<'_> {
    fn value(&self, input: usize) -> &Value {
        self.0.value(input)
    }

    fn event(&self, event: usize) -> Option<&[Value]> {
        self.0.event(event)
    }

    fn state(&self, machine: usize) -> Option<usize> {
        self.0.state(machine)
    }

    fn last(&self, topic: usize) -> Option<Time> {
        self.0.last(topic)
    }

    fn is_fresh(&self, topic: usize) -> bool {
        self.0.is_fresh(topic)
    }

    fn messages_after(&self, topic: usize, time: Time) -> Option<usize> {
        Some(self.0.messages_after(topic, time))
    }
}

/// Parts of a [`Moment`], by number, in ascending order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Kept {
    /// Signals.
    pub inputs: Vec<usize>,
    /// Events.
    pub events: Vec<usize>,
    /// Machines.
    pub machines: Vec<usize>,
    /// Topics.
    pub topics: Vec<usize>,
}

impl Kept {
    /// Adds what an expression reads.
    pub fn add(&mut self, e: &Expr) {
        match &e.kind {
            Kind::Input(input) => insert(&mut self.inputs, *input),
            Kind::Event(event) | Kind::EventField { event, .. } => insert(&mut self.events, *event),
            Kind::InState { machine, .. } => insert(&mut self.machines, *machine),
            Kind::Age(topic) | Kind::Frequency(topic, _) | Kind::Fresh(topic) => insert(&mut self.topics, *topic),
            _ => {}
        }
        e.children().into_iter().for_each(|c| self.add(c));
    }

    /// Adds something that must be defined before a property starts.
    pub fn add_read(&mut self, read: Read) {
        match read.what {
            ReadOf::Input(input) => insert(&mut self.inputs, input),
            ReadOf::Topic(topic) => insert(&mut self.topics, topic),
        }
    }

    /// Adds a machine.
    pub fn add_machine(&mut self, machine: usize) {
        insert(&mut self.machines, machine);
    }

    /// Adds an event.
    pub fn add_event(&mut self, event: usize) {
        insert(&mut self.events, event);
    }
}

fn insert(list: &mut Vec<usize>, number: usize) {
    if let Err(place) = list.binary_search(&number) {
        list.insert(place, number);
    }
}

/// A moment that a test makes up.
#[cfg(test)]
#[derive(Default)]
pub(crate) struct Fixed {
    pub values: Vec<Value>,
    pub events: Vec<Option<Vec<Value>>>,
    pub states: Vec<Option<usize>>,
    pub topics: Vec<(Option<Time>, bool)>,
}

#[cfg(test)]
impl Moment for Fixed {
    fn value(&self, input: usize) -> &Value {
        self.values.get(input).unwrap_or(&Value::Missing)
    }

    fn event(&self, event: usize) -> Option<&[Value]> {
        self.events.get(event)?.as_deref()
    }

    fn state(&self, machine: usize) -> Option<usize> {
        self.states.get(machine).copied().flatten()
    }

    fn last(&self, topic: usize) -> Option<Time> {
        self.topics.get(topic)?.0
    }

    fn is_fresh(&self, topic: usize) -> bool {
        self.topics.get(topic).is_some_and(|t| t.1)
    }
}
