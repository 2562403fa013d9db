//! What a specification means, needs and costs, property by property.

mod cost;
mod formula;
mod picture;
mod words;

#[cfg(feature = "recordings")]
use std::path::Path;

use lapwing_check::checked::{self, Body, InputSource, ObjectSource, ReadOf};
#[cfg(feature = "recordings")]
use lapwing_diag::{Style, render};
#[cfg(feature = "recordings")]
use lapwing_record::{OpenError, TopicInfo};
use lapwing_stream::{Duration, Type};

use crate::account;
#[cfg(feature = "recordings")]
use crate::session::Options;
#[cfg(feature = "recordings")]
use crate::shape;
use crate::spec::Spec;
pub(crate) use formula::{Printer, compare};

pub use picture::Picture;
pub(crate) use picture::diagram;

/// What a specification means, needs and costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Explanation {
    /// Where its instants come from, in words.
    pub clock: String,
    /// The topics that it reads, each with its type where that is known, and what is wanted of it.
    pub topics: Vec<String>,
    /// The properties, in the order of the text.
    pub properties: Vec<Explained>,
    /// What a recording revealed, as text with places.
    pub findings: Vec<String>,
}

/// What a property means, needs and costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Explained {
    /// Its name.
    pub name: String,
    /// Its line, from 1.
    pub line: usize,
    /// Its source text.
    pub text: String,
    /// What it means, in words.
    pub words: String,
    /// Its canonical formula: patterns expanded, implicit operators written out.
    pub formula: String,
    /// What must be there before it starts, with where it comes from.
    pub reads: Vec<String>,
    /// When a failure is known.
    pub known: String,
    /// What it has to remember.
    pub memory: String,
    /// What is done when it is violated, on a live robot.
    pub reactions: Vec<String>,
    /// Why it cannot be judged on this recording.
    pub problem: Option<String>,
}

/// Explains a specification, with the types of a recording where there is one.
#[cfg(feature = "recordings")]
pub fn explain(spec: &Spec, trace: Option<&Path>, options: &Options, style: Style) -> Result<Explanation, OpenError> {
    let Some(trace) = trace else { return Ok(explanation(spec, &spec.alone().spec, Vec::new(), &[])) };
    let recording = shape::open(std::slice::from_ref(spec), trace, &options.recording)?;
    let checked = spec.against(&shape::of(&recording));
    let findings =
        checked.beyond(&spec.findings().diagnostics).map(|d| render(&spec.findings().sources, d, style)).collect();
    Ok(explanation(spec, &checked.spec, findings, recording.topics()))
}

/// Draws a specification, with the instances that a recording has where there is one. `None` where there is nothing to draw.
#[cfg(feature = "recordings")]
pub fn draw(
    spec: &Spec,
    trace: Option<&Path>,
    options: &Options,
    picture: Picture,
) -> Result<Option<String>, OpenError> {
    let Some(trace) = trace else { return Ok(picture::draw(spec, &spec.alone().spec, picture)) };
    let recording = shape::open(std::slice::from_ref(spec), trace, &options.recording)?;
    Ok(picture::draw(spec, &spec.against(&shape::of(&recording)).spec, picture))
}

#[cfg(feature = "recordings")]
fn explanation(spec: &Spec, meaning: &checked::Spec, findings: Vec<String>, recorded: &[TopicInfo]) -> Explanation {
    Explanation {
        clock: clock(meaning),
        topics: meaning.topics.iter().enumerate().map(|(number, t)| topic(meaning, number, t, recorded)).collect(),
        properties: meaning.properties.iter().map(|p| explained(spec, meaning, p)).collect(),
        findings,
    }
}

fn clock(meaning: &checked::Spec) -> String {
    let clock = match meaning.clock {
        checked::Clock::Events => "every message, row or event that it reads is an instant".to_owned(),
        checked::Clock::Rate(hz) => format!("{hz} instants a second, from the first message that it reads"),
    };
    match meaning.timeout {
        Some(timeout) => format!("{clock}, for {timeout}"),
        None => clock,
    }
}

/// A topic: its type, how much of it is recorded, and the fields that are read with their types.
#[cfg(feature = "recordings")]
fn topic(meaning: &checked::Spec, number: usize, topic: &checked::Topic, recorded: &[TopicInfo]) -> String {
    let ty = topic.type_name.as_ref().map(|t| format!(" {t}")).unwrap_or_default();
    let is_same = |t: &&TopicInfo| t.name.trim_start_matches('/') == topic.name.trim_start_matches('/');
    let messages = recorded.iter().filter(is_same).filter_map(|t| t.messages).reduce(|a, b| a + b);
    let messages = messages.map(|n| format!(" ({n} messages)")).unwrap_or_default();
    let field = |(field, way): (usize, &checked::Path)| {
        let source = InputSource::Field { topic: number, field };
        let ty = meaning.inputs.iter().find(|i| i.source == source).map(|i| kind(&i.ty)).unwrap_or_default();
        format!("{}{}", path(way), ty.replacen(": ", ", ", 1))
    };
    let fields: Vec<String> = topic.fields.iter().enumerate().map(field).collect();
    let fields = if fields.is_empty() { String::new() } else { format!(": {}", fields.join("; ")) };
    format!("{}{ty}{messages}{fields}", topic.name)
}

fn path(path: &checked::Path) -> String {
    if path.is_empty() { "the whole message".to_owned() } else { checked::part("", path) }
}

fn explained(spec: &Spec, meaning: &checked::Spec, property: &checked::Property) -> Explained {
    let printer = Printer { spec, meaning };
    let (words, formula, cost) = match &property.body {
        Body::Formula(formula) => (
            words::of(&printer, formula),
            printer.judged(formula),
            (cost::known(formula, meaning.clock), cost::memory(formula, meaning.clock)),
        ),
        Body::Machine(machine) => {
            let (words, formula) = words::of_machine(meaning, *machine);
            (words, formula, cost::of_machine(meaning, *machine))
        }
        Body::None => Default::default(),
    };
    Explained {
        name: property.name.clone(),
        line: property.line,
        text: property.text.clone(),
        words,
        formula,
        reads: property.reads.iter().map(|r| read(meaning, r)).collect(),
        known: cost.0,
        memory: cost.1,
        reactions: account::reactions(meaning, &property.name),
        problem: property.problem.clone(),
    }
}

/// How long after it began a failure of a property is known at the latest; `None` where nothing bounds that.
pub(crate) fn latency(meaning: &checked::Spec, property: &checked::Property) -> Option<Duration> {
    match &property.body {
        Body::Formula(formula) => cost::latency(formula),
        Body::Machine(machine) => Some(cost::longest_stay(meaning, *machine).unwrap_or(Duration::ZERO)),
        Body::None => Some(Duration::ZERO),
    }
}

/// What a property means, in words.
pub(crate) fn meant(spec: &Spec, meaning: &checked::Spec, property: &checked::Property) -> String {
    match &property.body {
        Body::Formula(formula) => words::of(&Printer { spec, meaning }, formula),
        Body::Machine(machine) => words::of_machine(meaning, *machine).0,
        Body::None => String::new(),
    }
}

/// Something that a property needs, with where it comes from and its type.
fn read(meaning: &checked::Spec, read: &checked::Read) -> String {
    let back = match read.depth {
        0 => String::new(),
        n => format!(", {n} back"),
    };
    let topic = |number: usize| meaning.topics.get(number).map_or("?", |t| t.name.as_str());
    let what = match read.what {
        ReadOf::Topic(number) => format!("messages of {}", topic(number)),
        ReadOf::Input(number) => match meaning.inputs.get(number) {
            Some(input) => format!("{} from {}{}", input.label, source(meaning, input), kind(&input.ty)),
            None => String::new(),
        },
    };
    what + &back
}

fn source(meaning: &checked::Spec, input: &checked::Input) -> String {
    match &input.source {
        InputSource::Field { topic, field } => match meaning.topics.get(*topic) {
            Some(t) => format!("{} ({})", t.name, t.fields.get(*field).map(path).unwrap_or_default()),
            None => String::new(),
        },
        InputSource::Column(column) => format!("column {}", meaning.columns.get(*column).map_or("?", String::as_str)),
        InputSource::World { object, .. } => match meaning.objects.get(*object) {
            Some(object) => format!("the ground truth of {}, {}", object.name, world(meaning, &object.source)),
            None => String::new(),
        },
    }
}

fn world(meaning: &checked::Spec, source: &ObjectSource) -> String {
    let name = |topic: usize| meaning.topics.get(topic).map_or("?", |t| t.name.as_str());
    match source {
        ObjectSource::ModelStates { topic, .. }
        | ObjectSource::Odometry { topic, .. }
        | ObjectSource::Pose { topic, .. } => name(*topic).to_owned(),
        ObjectSource::Tf { fixed, frame, .. } => format!("the transforms from {fixed} to {frame}"),
    }
}

fn kind(ty: &Type) -> String {
    match ty {
        Type::Bool => ": a boolean".to_owned(),
        Type::Num { .. } => ": a number".to_owned(),
        Type::Str => ": a text".to_owned(),
        Type::Array(of) => format!(": an array{}", kind(of).replacen(": a", " of a", 1)),
        Type::Message(schema) => format!(": {}", schema.name),
        Type::Any => String::new(),
    }
}
