//! From what a recording gives to what one specification reads of it: topics, columns and events by its own numbers.

use std::collections::BTreeMap;
use std::ops::Range;

use lapwing_check::checked::{self, EventSource, Step};
use lapwing_record::{Cells, Item, Part, Path, Signal, Wanted};
use lapwing_stream::{Name, Sample, Value, What};

/// What all specifications of a session want of the recording. Each one's fields of a topic lie side by side, and so do its columns, so
/// that they can be handed on as they are.
#[derive(Debug, Default)]
pub(crate) struct Wants {
    list: Vec<Wanted>,
    signals: Vec<Name>,
}

impl Wants {
    /// What the recording is to be asked for.
    pub fn list(&self) -> &[Wanted] {
        &self.list
    }

    /// The columns of rows that it is to be asked for.
    pub fn signals(&self) -> &[Name] {
        &self.signals
    }

    /// Adds columns. Gives where they are.
    fn add_columns(&mut self, columns: &[String]) -> Range<usize> {
        let start = self.signals.len();
        self.signals.extend(columns.iter().map(|column| Name::from(column.as_str())));
        start..self.signals.len()
    }

    /// Adds fields of a topic. Gives the number of the topic here, and where its fields are.
    fn add(&mut self, topic: &str, fields: &[checked::Path]) -> (usize, Range<usize>) {
        let number = self.list.iter().position(|w| w.topic == topic).unwrap_or_else(|| {
            self.list.push(Wanted { topic: topic.to_owned(), fields: Vec::new() });
            self.list.len() - 1
        });
        let all = &mut self.list[number].fields;
        let start = all.len();
        all.extend(fields.iter().map(path));
        (number, start..all.len())
    }
}

fn path(path: &checked::Path) -> Path {
    Path::new(path.iter().map(|step| match step {
        Step::Field(name) => Part::Name(name.as_str().into()),
        Step::Index(index) => Part::Index(*index),
    }))
}

/// What one specification reads.
#[derive(Debug)]
pub(crate) struct Intake {
    /// For each wanted topic of the session: its number here, and where its fields are.
    topics: Vec<Option<(usize, Range<usize>)>>,
    /// Where its columns are among those of the session.
    columns: Range<usize>,
    events: BTreeMap<String, Fields>,
    /// The values of the current event.
    values: Vec<Value>,
}

/// The fields that are wanted of an event, and its number.
#[derive(Debug)]
struct Fields {
    event: usize,
    fields: Vec<Signal>,
}

impl Intake {
    /// What `spec` reads; its topics and columns are added to `wants`.
    pub fn new(spec: &checked::Spec, wants: &mut Wants) -> Intake {
        let mut topics = Vec::new();
        for (number, topic) in spec.topics.iter().enumerate() {
            let (wanted, fields) = wants.add(&topic.name, &topic.fields);
            if topics.len() <= wanted {
                topics.resize(wanted + 1, None);
            }
            topics[wanted] = Some((number, fields));
        }
        let by_name = |source: &EventSource| matches!(source, EventSource::Named | EventSource::Point(_));
        let named = spec.events.iter().enumerate().filter(|(_, e)| by_name(&e.source));
        let events = named.map(|(event, e)| {
            let fields = e.fields.iter().map(|f| Signal::new(&path(&f.path).to_string())).collect();
            (e.name.clone(), Fields { event, fields })
        });
        Intake { topics, columns: wants.add_columns(&spec.columns), events: events.collect(), values: Vec::new() }
    }

    /// An item as a sample.
    #[inline]
    pub fn sample<'a>(&'a mut self, item: &Item<'a>) -> Sample<'a> {
        let what = match *item {
            Item::Message { wanted, values, .. } => self.message(wanted, values),
            Item::Row { cells, .. } => {
                What::Row { cells: cells.values().get(self.columns.clone()).unwrap_or_default() }
            }
            Item::Event { name, fields, .. } => self.event(name, fields),
        };
        Sample { time: item.time(), what }
    }

    fn message<'a>(&self, wanted: Option<usize>, values: &'a [Value]) -> What<'a> {
        let route = wanted.and_then(|w| self.topics.get(w)?.as_ref());
        match route.and_then(|(topic, fields)| Some((*topic, values.get(fields.clone())?))) {
            Some((topic, values)) => What::Message { topic, values },
            None => What::Other,
        }
    }

    fn event(&mut self, name: &str, cells: Cells<'_>) -> What<'_> {
        let Some(Fields { event, fields }) = self.events.get(name) else { return What::Other };
        self.values.resize_with(fields.len(), Value::default);
        for (field, value) in fields.iter().zip(&mut self.values) {
            match field.find_in(cells) {
                Some(found) => value.clone_from(&found),
                None => *value = Value::Missing,
            }
        }
        What::Event { event: *event, values: &self.values }
    }
}
