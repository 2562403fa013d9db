//! One specification that is watched over: its properties, the topics that each reads, and the shifts that judge them.

use std::collections::{BTreeMap, BTreeSet};

use lapwing_check::checked::{self, Action, Body, EventSource, Expr, InputSource, Kind};
use lapwing_check::{Checked, TraceShape, compile};
use lapwing_diag::Code;
use lapwing_react::history::History;
use lapwing_react::shown::Origin;
use lapwing_react::{Property, Topic, Warning};
use lapwing_stream::{Duration, Time, Value, Verdict};

use super::blind::Ledger;
use super::course::Stand;
use super::graph::Graph;
use super::shift::Shift;
use crate::account;
use crate::losses::Damage;
use crate::meant::Met;
use crate::session::Options;
use crate::spec::Spec;

/// One specification that is watched over.
pub(crate) struct Post<'s> {
    pub spec: &'s Spec,
    /// The properties, as the latest look at the graph shows them.
    properties: Vec<Known>,
    /// The monitors, the oldest first.
    pub shifts: Vec<Shift<'s>>,
    /// The topics that it reads, with their types.
    topics: Vec<Topic>,
    /// For how long topics may be silent, where it says so.
    pub limits: BTreeMap<String, Duration>,
    /// Until when at least a property had no position.
    unstarted: BTreeMap<String, Time>,
    /// Whether its monitors note what the signals do, for whoever looks on.
    pub draws: bool,
    /// What has been said of the specification and this graph.
    said: BTreeSet<Said>,
}

/// What a warning says, and where it points.
type Said = (String, Option<(String, usize, usize)>);

/// What is known of a property.
struct Known {
    blank: Property,
    topics: BTreeSet<String>,
}

impl<'s> Post<'s> {
    /// Of a specification, on a graph of which nothing is known yet.
    pub fn new(spec: &'s Spec) -> Post<'s> {
        let mut post = Post {
            spec,
            properties: Vec::new(),
            shifts: Vec::new(),
            topics: Vec::new(),
            limits: BTreeMap::new(),
            unstarted: BTreeMap::new(),
            draws: false,
            said: BTreeSet::new(),
        };
        let shape = TraceShape { live: true, ..TraceShape::default() };
        post.look(&shape);
        post
    }

    /// The properties as they are before anything is known of them.
    pub fn blanks(&self) -> impl Iterator<Item = &Property> {
        self.properties.iter().map(|known| &known.blank)
    }

    /// The properties, each with the topics that it reads.
    pub fn known(&self) -> impl Iterator<Item = (&Property, &BTreeSet<String>)> {
        self.properties.iter().map(|known| (&known.blank, &known.topics))
    }

    /// Which of its properties cannot be judged though they wait for no topic, and why.
    pub fn idle(&self) -> impl Iterator<Item = String> {
        let idle = self.properties.iter().filter(|known| known.topics.is_empty());
        idle.filter_map(|known| Some(format!("{} cannot be judged: {}", known.blank.name, known.blank.cause.as_ref()?)))
    }

    /// The topics that it wants to read.
    pub fn topics(&self) -> &[Topic] {
        &self.topics
    }

    /// Whether it would be another one if that topic were there.
    pub fn minds(&self, topic: &str) -> bool {
        self.spec.runs_over_topics() || self.topics.iter().any(|t| t.name == topic)
    }

    /// Whether it counts publishers.
    pub fn counts_publishers(&self) -> bool {
        !self.spec.alone().spec.columns.is_empty()
    }

    /// Looks at the graph anew: what can be judged now and could not before gets a monitor, which begins at `at`. Gives what the graph
    /// shows of the specification and has not been said.
    pub fn refresh(&mut self, graph: &Graph, shape: &TraceShape, at: Time, options: &Options) -> Vec<Warning> {
        let shift = self.next_shift(shape, options);
        let warnings = self.revelations(&shift);
        if !shift.owned.is_empty() {
            self.begin(shift, graph, at);
        }
        warnings
    }

    /// What a graph of that shape shows of the specification and has not been said. Nothing begins yet.
    pub fn reveal(&mut self, shape: &TraceShape, options: &Options) -> Vec<Warning> {
        let shift = self.next_shift(shape, options);
        self.revelations(&shift)
    }

    /// A monitor of what can be judged on a graph of that shape and is not yet.
    fn next_shift(&mut self, shape: &TraceShape, options: &Options) -> Shift<'s> {
        let checked = self.look(shape);
        let is_owned = |name: &str| self.shifts.iter().any(|shift| shift.owned.contains(name));
        let judged = checked.spec.properties.iter().filter(|p| p.problem.is_none());
        let new: BTreeSet<String> = judged.map(|p| p.name.clone()).filter(|name| !is_owned(name)).collect();
        Shift::new(self.spec, checked, new, options)
    }

    fn begin(&mut self, mut shift: Shift<'s>, graph: &Graph, at: Time) {
        if self.draws {
            shift.run.draw();
        }
        shift.catch_up(graph);
        count_publishers(&mut shift, graph, at);
        self.shifts.push(shift);
    }

    /// The numbers of publishers may have changed.
    pub fn count_publishers(&mut self, graph: &Graph, at: Time) {
        self.shifts.iter_mut().for_each(|shift| count_publishers(shift, graph, at));
    }

    /// Checks the specification against a graph of that shape.
    fn look(&mut self, shape: &TraceShape) -> Checked {
        let mut checked = self.spec.against(shape);
        blame_foreign_events(&mut checked.spec);
        let meaning = &checked.spec;
        let program = compile::compile(meaning);
        let name = |topic: &usize| meaning.topics.get(*topic).map(|t| t.name.clone());
        let known = |(property, compiled): (&checked::Property, &lapwing_engine::program::Property)| Known {
            blank: account::blank(self.spec, meaning, property),
            topics: compiled.topics.iter().filter_map(name).collect(),
        };
        self.properties = meaning.properties.iter().zip(&program.properties).map(known).collect();
        self.topics = topics(meaning);
        self.limits.clear();
        for input in &meaning.inputs {
            if let (InputSource::Field { topic, .. }, Some(limit)) = (&input.source, input.stale)
                && let Some(topic) = name(topic)
            {
                let least = self.limits.entry(topic).or_insert(limit);
                *least = (*least).min(limit);
            }
        }
        checked
    }

    /// What the graph shows of the specification. That topics are not there is told as blindness, when it is.
    fn revelations(&mut self, shift: &Shift<'s>) -> Vec<Warning> {
        let mut warnings = shift.run.revelations();
        warnings.retain(|w| w.code != Some(Code::MissingTopic.name()));
        warnings.retain(|w| self.said.insert((w.message.clone(), w.place.clone())));
        warnings
    }

    /// A topic was published by nobody until `at`: who waits for it has missed nothing.
    pub fn had_nobody(&mut self, topic: &str, at: Time) {
        for known in self.properties.iter().filter(|known| known.topics.contains(topic)) {
            let name = &known.blank.name;
            let owner = self.shifts.iter().find(|shift| shift.owned.contains(name));
            let has_started = owner.is_some_and(|shift| shift.run.standing(name).started);
            if !has_started {
                self.unstarted.insert(name.clone(), at);
            }
        }
    }

    /// How things stand of a property with all of its instances, of which each must be judged; `sees` says whether a topic can be seen.
    pub fn stand(&self, property: &str, sees: impl Fn(&String) -> bool) -> Stand {
        let is_it = |known: &&Known| known.blank.name.split('[').next() == Some(property);
        let instances: Vec<&Known> = self.properties.iter().filter(is_it).collect();
        let mut stand = Stand { is_judged: !instances.is_empty(), failed: 0 };
        for known in instances {
            let name = &known.blank.name;
            let owner = self.shifts.iter().find(|shift| shift.owned.contains(name));
            let now = owner.map(|shift| shift.run.standing(name)).unwrap_or_default();
            stand.is_judged &= now.started && now.given_up.is_none() && known.topics.iter().all(&sees);
            stand.failed += now.failed;
        }
        stand
    }

    /// Whether a property reads a topic.
    pub fn is_concerned(&self, topic: &str) -> bool {
        self.properties.iter().any(|known| known.topics.contains(topic))
    }

    /// The monitor of a property starts afresh, if a reaction of this specification says so; that of one with slices in all of them.
    pub fn reset(&mut self, property: &str) {
        let says_so = |r: &checked::Reaction| r.property == property && r.actions.contains(&Action::Reset);
        if !self.spec.alone().spec.reactions.iter().any(says_so) {
            return;
        }
        for run in self.shifts.iter_mut().map(|shift| &mut shift.run) {
            let is_of = |name: &str| name.split('[').next() == Some(property);
            let numbers: Vec<usize> = (0..run.blanks().len()).filter(|k| is_of(&run.blanks()[*k].name)).collect();
            numbers.into_iter().for_each(|number| _ = run.reset(number, &[]));
        }
    }

    /// What becomes of its properties; times in words are counted from that origin.
    pub fn finish(&mut self, damage: &Damage, ledger: &Ledger, origin: Origin) -> Vec<Property> {
        let mut judged: BTreeMap<String, Vec<Property>> = BTreeMap::new();
        for shift in &mut self.shifts {
            for (number, property) in shift.run.finish(damage, &Met::default()) {
                let name = shift.run.blanks().get(number).map(|blank| blank.name.clone()).unwrap_or_default();
                if shift.owned.contains(&name) {
                    judged.entry(name).or_default().push(property);
                }
            }
        }
        let mut all = Vec::new();
        for known in &self.properties {
            let name = &known.blank.name;
            let doubts = ledger.doubts(&known.topics, self.unstarted.get(name).copied(), origin);
            let mut found =
                judged.remove(name).unwrap_or_else(|| vec![Property { reactions: Vec::new(), ..known.blank.clone() }]);
            found.iter_mut().for_each(|property| doubt(property, doubts.as_deref()));
            all.extend(found);
        }
        all
    }

    /// What only the whole run shows.
    pub fn warnings(&self, properties: &[Property]) -> Vec<Warning> {
        let mut all: Vec<Warning> = Vec::new();
        for (number, shift) in self.shifts.iter().enumerate() {
            // Of what no instant saw the first shift has seen the most.
            let is_told = |w: &Warning| number == 0 || w.code != Some(Code::SamplingUnseen.name());
            all.extend(shift.run.warnings(properties, &Met::default()).into_iter().filter(is_told));
        }
        all
    }

    /// How its signals and properties went, where that was asked for and one monitor saw all of it.
    pub fn into_history(self) -> Option<History> {
        let mut shifts = self.shifts.into_iter();
        let first = shifts.next()?;
        if shifts.next().is_some() { None } else { first.run.into_history() }
    }
}

/// A verdict that rests on what could not be seen is none. A violation that was seen stands.
fn doubt(property: &mut Property, doubts: Option<&str>) {
    let Some(doubts) = doubts.filter(|_| property.verdict != Verdict::Violated) else { return };
    let cause = match property.cause.take() {
        Some(cause) if property.verdict == Verdict::Inconclusive => format!("{doubts}; {cause}"),
        _ => doubts.to_owned(),
    };
    (property.verdict, property.cause, property.vacuous) = (Verdict::Inconclusive, Some(cause), false);
}

/// The topics that it reads: what only a reaction writes to is not listened to.
fn topics(meaning: &checked::Spec) -> Vec<Topic> {
    let is_written = |topic: &checked::Topic| {
        meaning
            .reactions
            .iter()
            .any(|r| r.span.file == topic.span.file && r.span.start <= topic.span.start && topic.span.end <= r.span.end)
    };
    let is_guarded = |name: &str| {
        let mut actions = meaning.reactions.iter().flat_map(|r| &r.actions);
        actions.any(|action| matches!(action, Action::Guard(guard) if guard.from == name))
    };
    let read = meaning.topics.iter().filter(|t| !t.fields.is_empty() || !is_written(t) || is_guarded(&t.name));
    let topic = |t: &checked::Topic| Topic { name: t.name.clone(), type_name: t.type_name.clone(), ..Topic::default() };
    read.filter(|t| !t.name.contains('{')).map(topic).collect()
}

/// The numbers of publishers that a monitor reads, as they are now.
fn count_publishers(shift: &mut Shift<'_>, graph: &Graph, at: Time) {
    let topic = |column: &str| column.strip_prefix("publishers(")?.strip_suffix(')').map(str::to_owned);
    let count = |column: &lapwing_stream::Name| {
        topic(column).map_or(Value::Missing, |topic| Value::Num(graph.publishers(&topic) as f64))
    };
    let values: Vec<Value> = shift.columns().iter().map(count).collect();
    if !values.is_empty() {
        shift.row(at, &values);
    }
}

/// A graph has messages, and no events by name, calls or activities: what needs those cannot be judged there.
fn blame_foreign_events(meaning: &mut checked::Spec) {
    let foreign = |event: &usize| match &meaning.events.get(*event)?.source {
        EventSource::Named => Some(format!("`{}`", meaning.events.get(*event)?.name)),
        EventSource::Point(_) => Some(format!("`{}`, for it has no calls", meaning.events.get(*event)?.name)),
        EventSource::Program(text) => Some(format!("`{text}`")),
        EventSource::Message { .. } | EventSource::Entered { .. } | EventSource::Left { .. } => None,
    };
    let problems: Vec<Option<String>> = meaning
        .properties
        .iter()
        .map(|p| events_of(meaning, p).iter().find_map(foreign).map(|what| format!("a ROS graph has no event {what}")))
        .collect();
    for (property, problem) in meaning.properties.iter_mut().zip(problems) {
        property.problem = property.problem.take().or(problem);
    }
}

/// The events that a property needs.
fn events_of(meaning: &checked::Spec, property: &checked::Property) -> BTreeSet<usize> {
    let mut events: BTreeSet<usize> = property.alphabet.iter().flatten().copied().collect();
    let mut machines: Vec<usize> = property.machines.clone();
    match &property.body {
        Body::Formula(formula) => gather(formula, &mut events),
        Body::Machine(machine) => machines.push(*machine),
        Body::None => {}
    }
    for machine in machines.iter().filter_map(|m| meaning.machines.get(*m)) {
        machine.conditions().for_each(|e| gather(e, &mut events));
        events.extend(machine.states.iter().filter_map(|s| s.on));
        events.extend(machine.edges.iter().filter_map(|e| e.on));
    }
    events
}

fn gather(e: &Expr, events: &mut BTreeSet<usize>) {
    if let Kind::Event(event) | Kind::EventField { event, .. } = e.kind {
        events.insert(event);
    }
    e.children().into_iter().for_each(|child| gather(child, events));
}
