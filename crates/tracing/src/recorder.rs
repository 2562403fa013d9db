//! What arrives, written down as NDJSON: `lapwing check` with the same specification gives the same verdicts on it.

use std::fmt::Write as _;
use std::io::{self, Write};

use lapwing_check::checked::{self, EventSource};
use lapwing_stream::{Time, Value, json};

use crate::wants::field_name;

/// Keys of a line that say what it is: a field of such a name is left out.
const RESERVED: [&str; 6] = ["t", "t_ns", "event", "topic", "values", "msg"];

/// The event that says that time has passed and nothing else has happened; no specification can declare it.
const TIME: &str = "lapwing/time";

/// Writes down what arrives.
pub(crate) struct Recorder {
    out: Box<dyn Write + Send>,
    columns: Vec<String>,
    events: Vec<Option<Event>>,
    /// The line in the making.
    line: String,
    /// Why nothing more is written.
    error: Option<io::Error>,
}

/// How an event is written: its name, and those of the fields that are read of it.
struct Event {
    name: String,
    fields: Vec<Option<String>>,
}

impl Recorder {
    /// A recorder of what a specification reads.
    pub fn new(out: Box<dyn Write + Send>, meaning: &checked::Spec) -> Recorder {
        Recorder {
            out,
            columns: meaning.columns.clone(),
            events: meaning.events.iter().map(Event::of).collect(),
            line: String::new(),
            error: None,
        }
    }

    /// Signals got values.
    pub fn row(&mut self, time: Time, cells: &[Value]) {
        let Recorder { line, columns, .. } = self;
        begin(line, time);
        line.push_str(",\"values\":{");
        let start = line.len();
        for (name, value) in columns.iter().zip(cells) {
            pair(line, start, name, value);
        }
        line.push('}');
        self.end();
    }

    /// An event occurred.
    pub fn event(&mut self, time: Time, event: usize, values: &[Value]) {
        let Recorder { line, events, .. } = self;
        let Some(Some(event)) = events.get(event) else { return };
        begin(line, time);
        line.push_str(",\"event\":");
        json::text(line, &event.name);
        for (name, value) in event.fields.iter().zip(values) {
            name.iter().for_each(|name| pair(line, 0, name, value));
        }
        self.end();
    }

    /// Time has passed.
    pub fn time(&mut self, time: Time) {
        begin(&mut self.line, time);
        self.line.push_str(",\"event\":");
        json::text(&mut self.line, TIME);
        self.end();
    }

    /// Everything is written. An error says why it is not.
    pub fn finish(&mut self) -> Option<io::Error> {
        let flushed = self.out.flush().err();
        self.error.take().or(flushed)
    }

    fn end(&mut self) {
        self.line.push_str("}\n");
        if self.error.is_none() {
            self.error = self.out.write_all(self.line.as_bytes()).err();
        }
    }
}

impl Event {
    /// `None` for those of machines, which follow from the rest.
    fn of(event: &checked::Event) -> Option<Event> {
        let is_told = matches!(&event.source, EventSource::Named | EventSource::Point(_));
        let written = |name: &String| !RESERVED.contains(&name.as_str());
        let fields = || event.fields.iter().map(|f| Some(field_name(&f.path)).filter(written)).collect();
        is_told.then(|| Event { name: event.name.clone(), fields: fields() })
    }
}

fn begin(line: &mut String, time: Time) {
    line.clear();
    // Writing to a text cannot fail.
    let _ = write!(line, "{{\"t_ns\":{}", time.0);
}

/// A key with its value, unless that is missing; `start` is where the first of its object stands.
fn pair(line: &mut String, start: usize, name: &str, value: &Value) {
    if matches!(value, Value::Missing) {
        return;
    }
    if line.len() > start {
        line.push(',');
    }
    json::text(line, name);
    line.push(':');
    json::value(line, value);
}
