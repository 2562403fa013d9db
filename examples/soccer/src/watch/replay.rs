//! Goes through a log once more, with the specification: which events there were, in which states the diagram stood, and what was violated.

use lapwing::{Monitor, Spec, Unseen};
use lapwing_react::Property;
use lapwing_stream::{Sample, Time, Value, What as Sampled};
use serde::{Deserialize, Serialize};

use super::log::{Entry, What};

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Happening {
    /// When, in nanoseconds since the kickoff.
    pub time: i64,
    /// An event by its name in the specification, `entered(soccer.STATE)` among them; or `!PROPERTY` where that was violated in the match.
    pub name: String,
}

/// What became of a property.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Judged {
    /// Its name.
    pub name: String,
    /// The verdict.
    pub verdict: String,
    /// When each episode of failures began to fail, in nanoseconds since the kickoff.
    pub failed: Vec<i64>,
}

/// A log with what the specification makes of it.
#[derive(Clone, Debug)]
pub struct Replay {
    /// What happened, in order.
    pub happenings: Vec<Happening>,
    /// The states of the diagram, each with when it was entered.
    pub states: Vec<(i64, String)>,
    /// What becomes of each property where no handler resets it: what `lapwing check` says of the same log.
    pub judged: Vec<Judged>,
}

/// The name of the state diagram.
pub const DIAGRAM: &str = "soccer";

/// The name of the event of entering a state.
pub fn entered(state: &str) -> String {
    format!("entered({DIAGRAM}.{state})")
}

/// Goes through a log.
pub fn replay(entries: &[Entry], spec: &Spec) -> Replay {
    let mut monitor = Monitor::new(spec.clone());
    let conditions = conditions(spec);
    let state_of = |monitor: &Monitor| monitor.state(DIAGRAM).map(str::to_owned);
    let mut state = state_of(&monitor);
    let mut happenings = Vec::new();
    let mut states: Vec<_> = state.clone().map(|state| (0, state)).into_iter().collect();
    for entry in entries {
        let mut names = feed(&mut monitor, entry, &conditions);
        let now = state_of(&monitor);
        if let Some(name) = now.as_deref().filter(|_| now != state) {
            states.push((entry.time, name.to_owned()));
            names.insert(0, entered(name));
        }
        state = now;
        happenings.extend(names.into_iter().map(|name| Happening { time: entry.time, name }));
    }
    let judged = monitor.finish(&Unseen::default()).properties.iter().map(Judged::of).collect();
    Replay { happenings, states, judged }
}

impl Judged {
    /// What a report says of a property.
    pub fn of(property: &Property) -> Judged {
        Judged {
            name: property.name.clone(),
            verdict: property.verdict.to_string(),
            failed: property.violations.iter().map(|v| v.failed.0).collect(),
        }
    }
}

/// What stands after `when` in each event's declaration.
fn conditions(spec: &Spec) -> Vec<Option<String>> {
    let text = |span| spec.findings().sources.slice(span).to_owned();
    spec.alone().spec.events.iter().map(|event| event.when.as_ref().map(|when| text(when.span))).collect()
}

/// Gives an entry to the monitor. Returns the names of what happened.
fn feed(monitor: &mut Monitor, entry: &Entry, conditions: &[Option<String>]) -> Vec<String> {
    let time = Time(entry.time);
    match &entry.what {
        What::Violation(property) => return vec![format!("!{property}")],
        What::Set(fields) => {
            let value = |column: &String| fields.iter().find(|(name, _)| name == column).map(|(_, v)| v.clone());
            let cells: Vec<Value> = monitor.meaning().columns.iter().map(|c| value(c).unwrap_or_default()).collect();
            if cells.iter().any(|cell| *cell != Value::Missing) {
                monitor.feed(Sample { time, what: Sampled::Row { cells: &cells } });
            }
        }
        What::Call(_) | What::Return(..) => {}
    }
    let events: Vec<(usize, Option<bool>)> = entry.what.events(monitor.meaning()).collect();
    let mut names = Vec::new();
    for (event, result) in events {
        let Some(declared) = monitor.meaning().events.get(event) else { continue };
        let values: Vec<Value> = declared.fields.iter().map(|_| result.map_or(Value::Missing, Value::Bool)).collect();
        // The events of `soccer.rv` ask for nothing but the result.
        let asks = conditions.get(event).and_then(|c| c.as_deref());
        if asks.is_none_or(|when| result.is_some_and(|result| when == format!("result == {result}"))) {
            names.push(declared.name.clone());
        }
        monitor.feed(Sample { time, what: Sampled::Event { event, values: &values } });
    }
    names
}
