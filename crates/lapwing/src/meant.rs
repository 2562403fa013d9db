//! Names that never came, and what was probably meant by them: a stream of lines tells its names only as it goes, so that a misspelt one is
//! found out at its end.

use lapwing_check::checked::{self, EventSource, InputSource, Property, ReadOf};
use lapwing_diag::Code;
use lapwing_diag::suggest::nearest;
use lapwing_engine::inputs::Inputs;
use lapwing_react::Warning;
use lapwing_stream::Value;
use lapwing_syntax::{FileId, parse};

/// The names of what came, as far as they were noticed.
#[derive(Debug, Default)]
pub(crate) struct Met {
    pub signals: Vec<String>,
    pub topics: Vec<String>,
    pub events: Vec<String>,
    /// Fields of messages, where only the messages tell them.
    pub fields: Vec<Field>,
}

/// A field of the messages of a topic.
#[derive(Debug)]
pub(crate) struct Field {
    pub topic: String,
    /// Empty where none is known.
    pub type_name: String,
    pub path: String,
}

#[cfg(feature = "recordings")]
impl From<lapwing_record::Met> for Met {
    fn from(met: lapwing_record::Met) -> Met {
        let lapwing_record::Met { signals, topics, events, fields } = met;
        let field = |lapwing_record::MetField { topic, type_name, path }| Field { topic, type_name, path };
        Met { signals, topics, events, fields: fields.into_iter().map(field).collect() }
    }
}

/// What to add to the cause of a property that waited in vain: for each name in it that never came, one that did.
pub(crate) fn instead(
    meaning: &checked::Spec,
    property: &Property,
    cause: &str,
    inputs: &Inputs,
    met: &Met,
) -> Option<String> {
    let waited = property.reads.iter().filter_map(|read| missing(meaning, read.what, inputs));
    // Other causes go before that of a wait: what it waited for stands in this one.
    let mut names: Vec<&str> = waited.filter(|name| cause.split([' ', ',']).any(|word| word == *name)).collect();
    names.sort_unstable();
    names.dedup();
    let absent = names.iter().copied().filter(|name| !met.signals.iter().chain(&met.topics).any(|met| met == name));
    let (events, others): (Vec<&str>, Vec<&str>) = absent.partition(|name| met.events.iter().any(|met| met == name));
    let (fields, others): (Vec<_>, Vec<_>) = others.into_iter().partition(|name| met.fields.iter().any(|f| f.is(name)));
    let all = || met.signals.iter().chain(&met.topics).chain(&met.events).map(String::as_str);
    let near: Vec<(&str, &str)> = others.into_iter().filter_map(|name| Some((name, nearest(name, all())?))).collect();
    let mut hints: Vec<String> =
        events.iter().map(|name| format!("`{name}` came as an event: declare it, `event {name}`")).collect();
    hints.extend(fields.iter().filter_map(|name| declaration(name, &met.fields)));
    match near.as_slice() {
        [] => {}
        [(_, near)] if names.len() == 1 => hints.push(format!("did you mean `{near}`?")),
        several => {
            let pairs: Vec<String> = several.iter().map(|(name, near)| format!("`{near}` for `{name}`")).collect();
            hints.push(format!("did you mean {}?", pairs.join(", ")));
        }
    }
    (!hints.is_empty()).then(|| hints.join("; "))
}

impl Field {
    /// Whether it is what a name without a declaration was to be: the field itself, or one of that name farther down.
    fn is(&self, name: &str) -> bool {
        let above = self.path.strip_suffix(name);
        !name.contains('.') && above.is_some_and(|above| above.is_empty() || above.ends_with('.'))
    }
}

/// The declaration that a name lacks which is a field of messages; one that cannot be written is not proposed.
fn declaration(name: &str, fields: &[Field]) -> Option<String> {
    let shortest = fields.iter().filter(|f| f.is(name)).min_by_key(|f| f.path.matches('.').count())?;
    let Field { topic, type_name, path } = shortest;
    let ty = if type_name.is_empty() { "TYPE" } else { type_name };
    let line = format!("decl {name} /{} {ty}.{path}", topic.trim_start_matches('/'));
    let is_fine = parse(FileId(0), &format!("{line}\n")).diagnostics.is_empty();
    is_fine.then(|| format!("messages on {topic} have a field `{path}`: declare it, `{line}`"))
}

/// The name under which something would have come that a property reads and that has no value.
fn missing<'m>(meaning: &'m checked::Spec, what: ReadOf, inputs: &Inputs) -> Option<&'m str> {
    let topic = |topic: usize| Some(meaning.topics.get(topic)?.name.as_str());
    match what {
        ReadOf::Input(number) if *inputs.value(number) == Value::Missing => match meaning.inputs.get(number)?.source {
            InputSource::Column(column) => meaning.columns.get(column).map(String::as_str),
            InputSource::Field { topic: number, .. } => topic(number),
            InputSource::World { .. } => None,
        },
        ReadOf::Topic(number) if inputs.last(number).is_none() => topic(number),
        _ => None,
    }
}

/// Events that never occurred although one with a name much like theirs did, which nothing declares.
pub(crate) fn events(meaning: &checked::Spec, met: &Met) -> Vec<Warning> {
    let named = || meaning.events.iter().filter(|e| e.source == EventSource::Named).map(|e| e.name.as_str());
    let strangers = || met.events.iter().map(String::as_str).filter(|name| named().all(|known| known != *name));
    let absent = named().filter(|name| met.events.iter().all(|came| came != name));
    let warning = |name: &str| {
        let near = nearest(name, strangers())?;
        let message =
            format!("no event `{name}` came, but `{near}` did, which nothing declares; did you mean `{near}`?");
        Some(Warning::with_code(Code::MissingEvent, message))
    };
    absent.filter_map(warning).collect()
}
