//! Names that never came, and what was probably meant by them: a stream of lines tells its names only as it goes, so that a misspelt one is
//! found out at its end.

use lapwing_check::checked::{self, EventSource, InputSource, Property, ReadOf};
use lapwing_diag::Code;
use lapwing_diag::suggest::nearest;
use lapwing_engine::inputs::Inputs;
use lapwing_react::Warning;
use lapwing_stream::Value;

/// The names of what came, as far as they were noticed.
#[derive(Debug, Default)]
pub(crate) struct Met {
    pub signals: Vec<String>,
    pub topics: Vec<String>,
    pub events: Vec<String>,
}

#[cfg(feature = "recordings")]
impl From<lapwing_record::Met> for Met {
    fn from(met: lapwing_record::Met) -> Met {
        let lapwing_record::Met { signals, topics, events } = met;
        Met { signals, topics, events }
    }
}

/// What the engine says of a wait in vain, before the names of what never came.
const WAITED: &str = "no value ever came: ";

/// The cause of a property that waited in vain, each name once, and, where messages of a topic came, by the fields that they lack.
pub(crate) fn exactly(meaning: &checked::Spec, property: &Property, cause: &str, inputs: &Inputs) -> Option<String> {
    let mut names: Vec<String> = Vec::new();
    for name in cause.strip_prefix(WAITED)?.split(", ") {
        let lacking = lacking(meaning, property, name, inputs);
        let exact = if lacking.is_empty() { vec![name.to_owned()] } else { lacking };
        for one in exact {
            if !names.contains(&one) {
                names.push(one);
            }
        }
    }
    Some(format!("{WAITED}{}", names.join(", ")))
}

/// The fields that a property reads and that no message of a topic had although there were some.
fn lacking(meaning: &checked::Spec, property: &Property, topic: &str, inputs: &Inputs) -> Vec<String> {
    let field = |read: &checked::Read| {
        let ReadOf::Input(input) = read.what else { return None };
        let InputSource::Field { topic: number, field } = meaning.inputs.get(input)?.source else { return None };
        let came = meaning.topics.get(number).filter(|came| came.name == topic && inputs.last(number).is_some())?;
        (*inputs.value(input) == Value::Missing).then_some(())?;
        Some(format!("{topic}{}", written(came.fields.get(field)?)))
    };
    property.reads.iter().filter_map(field).collect()
}

/// A way into a value, as it is written behind the name of the whole: `.gaps[0]`.
fn written(path: &[checked::Step]) -> String {
    let step = |step: &checked::Step| match step {
        checked::Step::Field(name) => format!(".{name}"),
        checked::Step::Index(index) => format!("[{index}]"),
    };
    path.iter().map(step).collect()
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
    let all = || met.signals.iter().chain(&met.topics).chain(&met.events).map(String::as_str);
    let near: Vec<(&str, &str)> = others.into_iter().filter_map(|name| Some((name, nearest(name, all())?))).collect();
    let mut hints: Vec<String> =
        events.iter().map(|name| format!("`{name}` came as an event: declare it, `event {name}`")).collect();
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
