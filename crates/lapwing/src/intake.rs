//! From what a recording gives to what one specification reads of it: topics, columns and events by its own numbers.

use std::collections::BTreeMap;
use std::ops::Range;

use lapwing_check::checked::{self, EventSource, Step};
use lapwing_record::{Item, Part, Path, Wanted};
use lapwing_stream::{Name, Sample, Value, What};

/// What all specifications of a session want of the recording. Each one's fields of a topic lie side by side, so that they can be
/// handed on as they are.
#[derive(Debug, Default)]
pub(crate) struct Wants {
    list: Vec<Wanted>,
}

impl Wants {
    /// What the recording is to be asked for.
    pub fn list(&self) -> &[Wanted] {
        &self.list
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
    columns: Vec<String>,
    /// Where each column was found last.
    places: Vec<usize>,
    events: BTreeMap<String, Fields>,
    /// The values of the current row or event.
    values: Vec<Value>,
}

/// The fields that are wanted of an event, and its number.
#[derive(Debug)]
struct Fields {
    event: usize,
    paths: Vec<checked::Path>,
}

impl Intake {
    /// What `spec` reads; its topics are added to `wants`.
    pub fn new(spec: &checked::Spec, wants: &mut Wants) -> Intake {
        let mut topics = Vec::new();
        for (number, topic) in spec.topics.iter().enumerate() {
            let (wanted, fields) = wants.add(&topic.name, &topic.fields);
            if topics.len() <= wanted {
                topics.resize(wanted + 1, None);
            }
            topics[wanted] = Some((number, fields));
        }
        let named = spec.events.iter().enumerate().filter(|(_, e)| e.source == EventSource::Named);
        let events = named.map(|(event, e)| {
            let paths = e.fields.iter().map(|f| f.path.clone()).collect();
            (e.name.clone(), Fields { event, paths })
        });
        Intake {
            topics,
            columns: spec.columns.clone(),
            places: vec![0; spec.columns.len()],
            events: events.collect(),
            values: Vec::new(),
        }
    }

    /// An item as a sample.
    pub fn sample<'a>(&'a mut self, item: &Item<'a>) -> Sample<'a> {
        let what = match *item {
            Item::Message { wanted, values, .. } => self.message(wanted, values),
            Item::Row { cells, .. } => self.row(cells),
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

    fn row(&mut self, cells: &[(Name, Value)]) -> What<'_> {
        self.values.resize_with(self.columns.len(), Value::default);
        for ((name, place), value) in self.columns.iter().zip(&mut self.places).zip(&mut self.values) {
            match cell(cells, name, place) {
                Some(found) => value.clone_from(found),
                None => *value = Value::Missing,
            }
        }
        What::Row { cells: &self.values }
    }

    fn event(&mut self, name: &str, fields: &[(Name, Value)]) -> What<'_> {
        let Some(Fields { event, paths }) = self.events.get(name) else { return What::Other };
        self.values.resize_with(paths.len(), Value::default);
        for (path, value) in paths.iter().zip(&mut self.values) {
            match follow(fields, path) {
                Some(found) => value.clone_from(found),
                None => *value = Value::Missing,
            }
        }
        What::Event { event: *event, values: &self.values }
    }
}

/// The cell of that name; it is looked for first where it was last.
fn cell<'a>(cells: &'a [(Name, Value)], name: &str, place: &mut usize) -> Option<&'a Value> {
    let is_there = |at: usize| cells.get(at).is_some_and(|(n, _)| **n == *name);
    if !is_there(*place) {
        *place = (0..cells.len()).find(|at| is_there(*at))?;
    }
    cells.get(*place).map(|(_, value)| value)
}

/// The value at the end of a way.
fn follow<'a>(fields: &'a [(Name, Value)], path: &[Step]) -> Option<&'a Value> {
    let (Step::Field(first), rest) = path.split_first()? else { return None };
    let value = fields.iter().find(|(n, _)| **n == **first).map(|(_, v)| v)?;
    rest.iter().try_fold(value, |value, step| match (step, value) {
        (Step::Field(name), value) => value.field(name),
        (Step::Index(index), Value::List(list)) => list.get(*index),
        (Step::Index(_), _) => None,
    })
}
