//! From the checked specification to the engine's program: operators are lowered, equal ones shared, positions grouped.

mod ages;
mod expr;
mod formula;
mod looks;
mod machine;
mod margin;
mod replay;

use std::collections::BTreeMap;

use lapwing_engine::program as engine;

use crate::checked::{self, Body, EventSource, Expr, InputSource, Kind, ObjectSource, ReadOf};
use expr::Lowering;
pub use expr::{compare, func};
use formula::GroupLowering;

/// How many runs of open obligations a property may have, unless a caller changes [`engine::Program::open_limit`].
pub const OPEN_LIMIT: usize = 65_536;

/// How many values may be stored for the margin of a property, unless a caller changes [`engine::Program::margin_limit`]: 256 MiB.
pub const MARGIN_LIMIT: usize = 32 << 20;

/// Compiles a specification that was checked without errors. What has a [`checked::Property::problem`] is judged by nobody.
pub fn compile(spec: &checked::Spec) -> engine::Program {
    let mut counters = 0;
    let mut program = engine::Program {
        clock: match spec.clock {
            checked::Clock::Events => engine::Clock::Events,
            checked::Clock::Rate(hz) => engine::Clock::Rate(hz),
        },
        timeout: spec.timeout,
        slots: spec
            .inputs
            .iter()
            .map(|i| engine::Slot { default: i.default.clone(), ..engine::Slot::default() })
            .collect(),
        topics: topics(spec),
        columns: columns(spec),
        skim: None,
        objects: spec.objects.iter().enumerate().map(|(i, o)| object(spec, i, o)).collect(),
        events: spec.events.iter().map(|e| event(e, &mut counters)).collect(),
        machines: machine::machines(spec, &mut counters),
        groups: Vec::new(),
        properties: Vec::new(),
        open_limit: OPEN_LIMIT,
        margin_limit: MARGIN_LIMIT,
    };
    Grouping::of(spec, counters).into_program(&mut program);
    program.link();
    program
}

fn topics(spec: &checked::Spec) -> Vec<engine::Topic> {
    let mut topics: Vec<_> = spec
        .topics
        .iter()
        .map(|t| engine::Topic { fields: vec![Vec::new(); t.fields.len()], ..engine::Topic::default() })
        .collect();
    for (slot, input) in spec.inputs.iter().enumerate() {
        if let InputSource::Field { topic, field } = input.source {
            topics[topic].fields[field].push(slot);
        }
    }
    for (i, object) in spec.objects.iter().enumerate() {
        topics_of_object(object).into_iter().for_each(|t| topics[t].objects.push(i));
    }
    for (i, event) in spec.events.iter().enumerate() {
        if let EventSource::Message { topic } = event.source {
            topics[topic].events.push(i);
        }
    }
    for_each_expr(spec, &mut |e| {
        if let Kind::Frequency(topic, window) = e.kind {
            let longest = &mut topics[topic].window;
            *longest = (*longest).max(Some(window));
        }
    });
    topics
}

/// Visits every expression of the specification, and all below it.
fn for_each_expr(spec: &checked::Spec, visit: &mut impl FnMut(&Expr)) {
    let machines = spec.machines.iter().flat_map(checked::Machine::conditions);
    let properties = spec.properties.iter().filter_map(|p| match &p.body {
        Body::Formula(f) => Some(f),
        _ => None,
    });
    machines.chain(properties).for_each(|e| below(e, visit));
}

/// Visits an expression and all below it.
fn below(e: &Expr, visit: &mut impl FnMut(&Expr)) {
    visit(e);
    e.children().into_iter().for_each(|c| below(c, visit));
}

/// Which cell of a row fills which slot.
fn columns(spec: &checked::Spec) -> Vec<engine::Column> {
    let slots = spec.inputs.iter().enumerate();
    slots
        .filter_map(|(slot, input)| match input.source {
            InputSource::Column(cell) => Some(engine::Column { cell, slot }),
            _ => None,
        })
        .collect()
}

fn object(spec: &checked::Spec, number: usize, object: &checked::Object) -> engine::Object {
    let parts = spec.inputs.iter().enumerate().filter_map(|(slot, input)| match input.source {
        InputSource::World { object, part } if object == number => Some((part as usize, slot)),
        _ => None,
    });
    let source = match &object.source {
        &ObjectSource::ModelStates { name, pose, twist, .. } => engine::ObjectSource::ModelStates { name, pose, twist },
        &ObjectSource::Odometry { pose, twist, .. } => engine::ObjectSource::Odometry { pose, twist },
        &ObjectSource::Pose { pose, .. } => engine::ObjectSource::Pose { pose },
        ObjectSource::Tf { topics, fixed, frame } => {
            engine::ObjectSource::Tf { topics: topics.clone(), fixed: fixed.clone(), frame: frame.clone() }
        }
    };
    engine::Object { name: object.name.clone(), source, parts: parts.collect() }
}

fn event(event: &checked::Event, counters: &mut u32) -> engine::Event {
    let from_message = matches!(event.source, EventSource::Message { .. })
        .then(|| event.fields.iter().map(|f| f.wanted.unwrap_or(usize::MAX)).collect());
    let when = event.when.as_ref().map(|when| {
        let mut lowering = Lowering::new(counters);
        let node = lowering.expr(when);
        (lowering.into_positions(), node)
    });
    engine::Event { from_message, fields: event.fields.len(), when }
}

pub(crate) fn read((what, depth): (ReadOf, usize)) -> (engine::Read, usize) {
    match what {
        ReadOf::Input(i) => (engine::Read::Slot(i), depth),
        ReadOf::Topic(t) => (engine::Read::Topic(t), depth),
    }
}

/// What makes two properties have the same positions.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct SamePositions {
    reads: Vec<checked::Read>,
    alphabet: Option<Vec<usize>>,
    /// Ages, slices and the name of what stands alone, as text: they are compared for equality only.
    others: String,
}

/// The properties, gathered by their positions.
struct Grouping<'a> {
    spec: &'a checked::Spec,
    groups: BTreeMap<SamePositions, usize>,
    lowered: Vec<GroupLowering>,
    properties: Vec<engine::Property>,
    counters: u32,
}

impl<'a> Grouping<'a> {
    fn of(spec: &'a checked::Spec, counters: u32) -> Grouping<'a> {
        let mut grouping =
            Grouping { spec, groups: BTreeMap::new(), lowered: Vec::new(), properties: Vec::new(), counters };
        for (number, property) in spec.properties.iter().enumerate() {
            let lowered = grouping.property(number, property);
            grouping.properties.push(lowered);
        }
        grouping
    }

    fn into_program(self, program: &mut engine::Program) {
        program.groups = self.lowered.into_iter().map(GroupLowering::into_group).collect();
        program.properties = self.properties;
    }

    fn property(&mut self, number: usize, property: &checked::Property) -> engine::Property {
        let mut lowered = engine::Property {
            name: property.name.clone(),
            problem: property.problem.clone(),
            topics: topics_of(self.spec, property),
            stale: stale(self.spec, property),
            waits_for: waits_for(self.spec, &property.reads),
            rests_on: rests_on(self.spec, property.alphabet.as_deref()),
            ..engine::Property::default()
        };
        match &property.body {
            _ if property.problem.is_some() => {}
            Body::None => {}
            Body::Machine(machine) => lowered.judge = engine::Judge::Machine(*machine),
            Body::Formula(formula) => {
                let group = self.group(property, formula);
                lowered.judge = engine::Judge::Group(group);
                let into = &mut self.lowered[group];
                lowered.counters = into.property(number, formula, &mut self.counters);
                lowered.scopes = into.looks(number, formula);
                into.margin(number, formula, &mut self.counters);
            }
        }
        lowered
    }

    /// The group of a property, made where there is none yet.
    fn group(&mut self, property: &checked::Property, formula: &Expr) -> usize {
        let mut reads = property.reads.clone();
        reads.sort();
        let ages = ages::of_property(self.spec, property, formula);
        let slices: Vec<_> = property.slices.iter().map(slice).collect();
        // What starts afresh on its own shares nothing with others.
        let alone = resets(self.spec, property).then_some(property.name.as_str());
        let others = format!("{ages:?} {slices:?} {alone:?}");
        let key = SamePositions { reads, alphabet: property.alphabet.clone(), others };
        let next = self.lowered.len();
        let group = self.groups.get(&key).copied().filter(|&group| !self.lowered[group].is_full()).unwrap_or(next);
        self.groups.insert(key, group);
        if group == next {
            let positions = engine::Positions {
                reads: property.reads.iter().map(|r| read((r.what, r.depth))).collect(),
                alphabet: property.alphabet.clone(),
                ages,
                slices,
                ..engine::Positions::default()
            };
            self.lowered.push(GroupLowering::new(positions));
        }
        group
    }
}

/// Whether a reaction to a property's violations is `reset`.
fn resets(spec: &checked::Spec, property: &checked::Property) -> bool {
    let mut reactions = spec.reactions.iter().filter(|r| r.is_of(property));
    reactions.any(|r| r.actions.contains(&checked::Action::Reset))
}

fn slice(slice: &checked::Slice) -> engine::Slice {
    let own = slice.fields.iter().find(|(event, _)| *event == slice.event);
    engine::Slice { event: slice.event, field: own.map_or(usize::MAX, |(_, f)| *f), hides: slice.fields.clone() }
}

/// The topics that a property reads: by signals, by objects, by events.
fn topics_of(spec: &checked::Spec, property: &checked::Property) -> Vec<usize> {
    let mut topics = Vec::new();
    for read in &property.reads {
        match read.what {
            ReadOf::Topic(topic) => topics.push(topic),
            ReadOf::Input(i) => match spec.inputs[i].source {
                InputSource::Field { topic, .. } => topics.push(topic),
                InputSource::Column(_) => {}
                InputSource::World { object, .. } => topics.extend(topics_of_object(&spec.objects[object])),
            },
        }
    }
    let mut events = |e: &Expr| {
        if let Kind::Event(event) | Kind::EventField { event, .. } = e.kind
            && let EventSource::Message { topic } = spec.events[event].source
        {
            topics.push(topic);
        }
    };
    match &property.body {
        Body::Formula(formula) => below(formula, &mut events),
        Body::Machine(machine) => spec.machines[*machine].conditions().for_each(|e| below(e, &mut events)),
        Body::None => {}
    }
    topics.sort_unstable();
    topics.dedup();
    topics
}

fn topics_of_object(object: &checked::Object) -> Vec<usize> {
    match &object.source {
        ObjectSource::ModelStates { topic, .. }
        | ObjectSource::Odometry { topic, .. }
        | ObjectSource::Pose { topic, .. } => {
            vec![*topic]
        }
        ObjectSource::Tf { topics, .. } => topics.iter().map(|(topic, _)| *topic).collect(),
    }
}

/// The silences that a property minds: of the signals in its formula and in the machines that it reads, with a default or without.
fn stale(spec: &checked::Spec, property: &checked::Property) -> Vec<engine::Silence> {
    let mut stale = Vec::new();
    let mut visit = |e: &Expr| {
        if let Kind::Input(i) = e.kind
            && let Some(silence) = silence(spec, i)
            && !stale.contains(&silence)
        {
            stale.push(silence);
        }
    };
    let mut machines = match &property.body {
        Body::Formula(formula) => {
            below(formula, &mut visit);
            property.machines.clone()
        }
        Body::Machine(machine) => vec![*machine],
        Body::None => Vec::new(),
    };
    rests_on(spec, property.alphabet.as_deref()).into_iter().for_each(|m| add_with_those_read(spec, m, &mut machines));
    machines.iter().flat_map(|&m| spec.machines[m].conditions()).for_each(|e| below(e, &mut visit));
    stale
}

/// Adds a machine and those that it reads, by their states or by their events.
fn add_with_those_read(spec: &checked::Spec, machine: usize, all: &mut Vec<usize>) {
    if all.contains(&machine) {
        return;
    }
    all.push(machine);
    let machine = &spec.machines[machine];
    let mut read = rests_on(spec, machine.alphabet.as_deref());
    let mut by_state = |e: &Expr| {
        if let Kind::InState { machine, .. } = e.kind {
            read.push(machine);
        }
    };
    machine.conditions().for_each(|e| below(e, &mut by_state));
    read.into_iter().for_each(|m| add_with_those_read(spec, m, all));
}

/// The silence that an input minds: its topic's, or, where it comes in rows, its own.
fn silence(spec: &checked::Spec, input: usize) -> Option<engine::Silence> {
    let limit = spec.inputs[input].stale?;
    let (of, name) = match spec.inputs[input].source {
        InputSource::Field { topic, .. } => (engine::Read::Topic(topic), spec.topics[topic].name.clone()),
        InputSource::Column(column) => (engine::Read::Slot(input), spec.columns[column].clone()),
        InputSource::World { .. } => return None,
    };
    Some(engine::Silence { of, name, limit })
}

/// The machines whose events make the positions of what steps on these events alone.
fn rests_on(spec: &checked::Spec, alphabet: Option<&[usize]>) -> Vec<usize> {
    let events = alphabet.unwrap_or_default().iter();
    let mut machines: Vec<usize> = events.filter_map(|&event| spec.events[event].source.machine()).collect();
    machines.sort_unstable();
    machines.dedup();
    machines
}

/// What a property waits for.
fn waits_for(spec: &checked::Spec, reads: &[checked::Read]) -> Vec<engine::Awaited> {
    let named = |name: &str| engine::Awaited { name: name.to_owned(), in_messages: None };
    let of_input = |input: usize| match spec.inputs[input].source {
        InputSource::Field { topic: number, field } => {
            let topic = &spec.topics[number];
            let part = checked::part(&topic.name, &topic.fields[field]);
            engine::Awaited { in_messages: Some((number, part)), ..named(&topic.name) }
        }
        InputSource::Column(column) => named(&spec.columns[column]),
        InputSource::World { object, .. } => named(&format!("ground truth of {}", spec.objects[object].name)),
    };
    let awaited = |read: &checked::Read| match read.what {
        ReadOf::Input(input) => of_input(input),
        ReadOf::Topic(topic) => named(&spec.topics[topic].name),
    };
    reads.iter().map(awaited).collect()
}
