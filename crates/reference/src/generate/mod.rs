//! Specifications and traces at random, all of them of small grids so that deadlines meet stamps; all short formulas on all short
//! traces; and a way to make a disagreement small.
//!
//! A [`Case`] is text and data: it depends on neither the parser nor the checker. Its trace is bound to a checked specification by
//! name, with [`Case::trace`].

pub mod exhaustive;
mod formulas;
mod rng;
mod samples;
mod shrink;
mod term;

pub use formulas::generate;
pub use samples::Raw;
pub use shrink::shrink;
pub use term::{Sort, Term};

use crate::trace::{Arrival, Trace};
use lapwing_check::TraceShape;
use lapwing_check::checked::{Path, Spec, Step};
use lapwing_stream::{Time, Value};

/// A specification, and a trace to check it on.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Settings, declarations, events, machines: a statement each.
    pub statements: Vec<String>,
    /// The properties.
    pub properties: Vec<Statement>,
    /// What arrives, by name.
    pub samples: Vec<(Time, Raw)>,
    /// Why the recording ends early, if it does.
    pub broke_off: Option<String>,
    /// What the trace carries.
    pub shape: TraceShape,
}

/// A property: what stands before its formula, and the formula.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// `property p1 over (kick):`
    pub head: String,
    /// The formula.
    pub body: Term,
}

impl Case {
    /// The text of the specification.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for statement in &self.statements {
            text.push_str(statement);
            text.push('\n');
        }
        for property in &self.properties {
            text.push_str(&format!("{} {}\n", property.head, property.body));
        }
        text
    }

    /// The trace, in the numbers of a checked specification; what that does not read becomes [`Arrival::Other`].
    pub fn trace(&self, spec: &Spec) -> Trace {
        let samples = self.samples.iter().map(|(time, raw)| (*time, bind(raw, spec))).collect();
        Trace { samples, broke_off: self.broke_off.clone(), lost: Vec::new() }
    }
}

fn bind(raw: &Raw, spec: &Spec) -> Arrival {
    match raw {
        Raw::Other => Arrival::Other,
        Raw::Row(cells) => {
            let cell = |name: &String| cells.iter().find(|(n, _)| n == name).map(|(_, v)| v.clone());
            Arrival::Row { cells: spec.columns.iter().map(|c| cell(c).unwrap_or_default()).collect() }
        }
        Raw::Message(name, message) => match spec.topics.iter().position(|t| t.name == *name) {
            Some(topic) => {
                let fields = &spec.topics[topic].fields;
                Arrival::Message { topic, values: fields.iter().map(|path| follow(message, path)).collect() }
            }
            None => Arrival::Other,
        },
        Raw::Event(name, body) => match spec.events.iter().position(|e| e.name == *name) {
            Some(event) => {
                let fields = &spec.events[event].fields;
                Arrival::Event { event, values: fields.iter().map(|f| follow(body, &f.path)).collect() }
            }
            None => Arrival::Other,
        },
    }
}

/// The part of a value that a path leads to.
fn follow(value: &Value, path: &Path) -> Value {
    let mut at = value.clone();
    for step in path {
        at = match step {
            Step::Field(name) => at.field(name).cloned().unwrap_or_default(),
            Step::Index(n) => match &at {
                Value::List(list) => list.get(*n).cloned().unwrap_or_default(),
                Value::Nums(list) => list.get(*n).copied().map(Value::Num).unwrap_or_default(),
                _ => Value::Missing,
            },
        };
    }
    at
}
