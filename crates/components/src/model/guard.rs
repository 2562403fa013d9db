//! Monitors as atoms.

use std::collections::BTreeMap;

use lapwing::Spec;
use lapwing_bip::ast::{
    AtomPort, AtomType, BinaryOp, Clock, Data, DeclKind, Expr as Code, Initial, Name, Package, Path, Stmt, TimeUnit,
    Transition, Urgency,
};
use lapwing_check::checked::{self, Action, Body, EventSource, Property};
use lapwing_diag::{Code as Error, Diagnostic, Style, render};
use lapwing_genom::Model;
use lapwing_genom::automata::{Class, System};
use lapwing_genom::emit::{bip_name, parts};
use lapwing_genom::model::ServiceId;

use super::Draft;
use super::formula::{Beyond, Reader, Shape, and, not, set};
use super::letters::{Letter, letters};
use super::past::{Past, Turn};
use super::ring::{NEWS, OLDS, Ring};
use crate::request::service_of;
use crate::signals::Signals;
use crate::watch::Mismatch;

/// The model with a monitor for each property of a specification, and its reactions.
///
/// # Errors
///
/// The specification does not go with the components, or speaks of what the model does not have, as values, or of more than an atom can keep.
pub fn with_monitors(
    package: Package,
    system: &System,
    model: &Model,
    spec: &Spec,
    signals: &Signals,
    style: Style,
) -> Result<Package, Mismatch> {
    let checked = spec.against(&signals.shape());
    let earlier = &spec.findings().diagnostics;
    let mut wrong: Vec<Diagnostic> = checked.beyond(earlier).filter(|d| crate::watch::is_fatal(d)).cloned().collect();
    let mut draft = Draft::new(package, system);
    for property in &checked.spec.properties {
        if let Err(found) = monitor(&mut draft, model, &checked.spec, property) {
            let message = format!("`{}` cannot be a monitor in BIP: that has no {}", property.name, found.what);
            let elsewhere = "`lapwing genom run --spec` judges it, and `lapwing check` on what that records";
            let split = "for a model, put properties that it can watch into a specification of their own";
            wrong.push(Diagnostic::new(Error::Misplaced, found.span, message).help(elsewhere).help(split));
        }
    }
    if wrong.is_empty() {
        return Ok(draft.finish());
    }
    let sources = &spec.findings().sources;
    Err(Mismatch(wrong.iter().map(|d| render(sources, d, style)).collect()))
}

/// Adds the monitor of a property.
fn monitor(draft: &mut Draft<'_>, model: &Model, spec: &checked::Spec, property: &Property) -> Result<(), Beyond> {
    let beyond = |what: &str| Beyond { span: property.span, what: what.to_owned() };
    let Body::Formula(formula) = &property.body else { return Err(beyond("state diagrams")) };
    if !property.slices.is_empty() {
        return Err(beyond("instances for values"));
    }
    let mut reader = Reader { spec: Some(spec), model: Some(model), ..Reader::default() };
    let shape = reader.shape(formula)?;
    let name = identifier(&property.name);
    let mut atom = Monitor {
        name: format!("{name}_monitor"),
        reader,
        shape,
        topics: topics(spec, property),
        ports: BTreeMap::new(),
    };
    let system = draft.system;
    let mut watched = Vec::new();
    for (number, automaton) in system.automata.iter().enumerate() {
        for (place, edge) in automaton.edges.iter().enumerate() {
            let all = letters(model, system, number, edge);
            let all: Vec<Letter> = all.into_iter().filter(|letter| atom.hears(letter)).collect();
            if all.is_empty() {
                continue;
            }
            let port = atom.port(all);
            draft.watch(number, place, path(&atom.name, &port));
            watched.push(parts::connector(automaton, &edge.name));
        }
    }
    draft.declare(parts::noted(
        DeclKind::Atom(atom.declaration()),
        &format!("The monitor of `{}`: {}", property.name, one_line(&property.text)),
    ));
    draft.component(&format!("{}_type", atom.name), &atom.name);
    let (turns, links, monitor) = (atom.turns(), atom.links(), atom.name.clone());
    let mut firsts = vec![name.clone()];
    let mut ports = vec![path(&atom.name, "report")];
    for (action, at) in reactions(spec, property).into_iter().zip(1_usize..) {
        let Action::Request(wanted) = action else { continue };
        let (component, service) = service_of(model, wanted).map_err(|why| beyond(&format!("such service: {why}")))?;
        ports.push(debt(draft, &format!("{name}_debt_{at}"), component, service));
    }
    draft.connect(&name, ports, format!("`{}` is violated", property.name));
    for Turn { port, note, .. } in turns {
        let connector = format!("{name}_{port}");
        draft.connect(&connector, vec![path(&monitor, &port)], note.to_owned());
        firsts.push(connector);
    }
    if links {
        let connector = format!("{name}_again");
        draft.connect(&connector, vec![path(&atom.name, "again")], "The violation goes on.".to_owned());
        firsts.push(connector);
    }
    for (place, (high, low)) in firsts.iter().flat_map(|high| watched.iter().map(move |low| (high, low))).enumerate() {
        draft.priority(format!("{name}_goes_first_{}", place + 1), low, high);
    }
    draft.firsts.insert(monitor, firsts);
    Ok(())
}

/// Adds an atom that keeps a request until the control task takes it. Gives the port by which it is told.
fn debt(draft: &mut Draft<'_>, name: &str, component: usize, service: ServiceId) -> Path {
    let owed = || Code::path("owed");
    let step = |port: &str, guard: Option<Code>, urgency, by: i64| Transition {
        port: Some(port.into()),
        from: vec!["idle".into()],
        to: vec!["idle".into()],
        guard,
        urgency,
        body: vec![Stmt::assign("owed", Code::binary(BinaryOp::Add, owed(), Code::int(by)))],
        ..Transition::default()
    };
    let is_owed = Code::binary(BinaryOp::Greater, owed(), Code::int(0));
    let atom = AtomType {
        name: format!("{name}_type").into(),
        data: vec![data("int", "owed")],
        ports: ["owe", "ask"].map(exported).to_vec(),
        places: vec!["idle".into()],
        initial: Initial {
            places: vec!["idle".into()],
            body: vec![Stmt::assign("owed", Code::int(0))],
            ..Initial::default()
        },
        transitions: vec![step("owe", None, None, 1), step("ask", Some(is_owed), Some(Urgency::Eager), -1)],
        ..AtomType::default()
    };
    draft.declare(parts::noted(DeclKind::Atom(atom), "Requests that a violation asks for, until they can be made."));
    draft.component(&format!("{name}_type"), name);
    if let Some((number, control)) = draft.control(component)
        && let Some(wanted) = control.request(service)
    {
        let others: Vec<String> = control
            .edges
            .iter()
            .filter(|e| e.class == Class::Request)
            .map(|e| parts::connector(control, &e.name))
            .collect();
        let ports = vec![parts::port_path(control, &wanted.name), path(name, "ask")];
        let connector = format!("{name}_request");
        draft.connect(&connector, ports, "The request is made, before those of others.".to_owned());
        draft.beside(number, wanted, &connector);
        for (number, low) in others.iter().enumerate() {
            draft.priority(format!("{name}_first_{}", number + 1), low, &connector);
        }
    }
    path(name, "owe")
}

fn reactions<'s>(spec: &'s checked::Spec, property: &Property) -> Vec<&'s Action> {
    spec.reactions.iter().filter(|r| r.is_of(property)).flat_map(|r| &r.actions).collect()
}

/// The topics at whose messages a property has positions: those of its events where it is over events alone, else all that the specification
/// reads.
fn topics(spec: &checked::Spec, property: &Property) -> Vec<String> {
    let name = |topic: &usize| spec.topics.get(*topic).map(|t| t.name.clone());
    match &property.alphabet {
        Some(events) => {
            let topic = |event: &usize| match spec.events.get(*event).map(|e| &e.source) {
                Some(EventSource::Message { topic }) => name(topic),
                _ => None,
            };
            events.iter().filter_map(topic).collect()
        }
        None => spec.topics.iter().map(|t| t.name.clone()).collect(),
    }
}

/// The atom of a property.
struct Monitor<'s> {
    name: String,
    reader: Reader<'s>,
    shape: Shape,
    topics: Vec<String>,
    /// What is heard at once, and the port for it.
    ports: BTreeMap<Vec<Letter>, String>,
}

/// The place in which a monitor always is.
const WATCH: &str = "watch";

/// What every monitor keeps: whether something is owed, since this very moment; whether the position before this one failed, and whether that before
/// what is owed did; whether there were positions since; whether a condition has failed.
///
/// Failures at positions that follow each other are one violation: who is `linked` to one before is not reported again.
const OWN: [&str; 6] = ["open", "fresh", "fell", "linked", "followed", "bad"];

impl Monitor<'_> {
    fn hears(&self, letter: &Letter) -> bool {
        let (Letter::Message(topic) | Letter::Runs(topic, _)) = letter;
        self.topics.contains(topic)
    }

    fn port(&mut self, letters: Vec<Letter>) -> String {
        if let Some(port) = self.ports.get(&letters) {
            return port.clone();
        }
        let word = |letter: &Letter| match letter {
            Letter::Message(topic) => topic.trim_start_matches('/').replace('/', "_"),
            Letter::Runs(topic, more) => {
                let name = topic.trim_start_matches('/').trim_end_matches("/running").replace('/', "_");
                format!("{name}_{}", if *more { "up" } else { "down" })
            }
        };
        let port = format!("see_{}", letters.iter().map(word).collect::<Vec<_>>().join("_"));
        self.ports.insert(letters, port.clone());
        port
    }

    /// What it does because time has passed. What is answered at the moment itself is not answered a moment later.
    fn turns(&self) -> Vec<Turn> {
        let passed = Code::binary(BinaryOp::GreaterEqual, Code::path("y"), Code::int(1));
        let lapse = Turn {
            port: "lapse".to_owned(),
            guard: and(Code::path("fresh"), passed),
            body: vec![set("fresh", false)],
            note: "Time has passed since the clock was set.",
        };
        let lapses = matches!(self.shape, Shape::Responds { at_once: false, .. });
        let of_ring = self.ring().map(Ring::turns).unwrap_or_default();
        lapses
            .then_some(lapse)
            .into_iter()
            .chain(self.reader.pasts.iter().flat_map(Past::turns))
            .chain(of_ring)
            .collect()
    }

    fn ring(&self) -> Option<&Ring> {
        match &self.shape {
            Shape::Each(ring) => Some(ring),
            _ => None,
        }
    }

    /// Whether one of its failures can belong to the violation before.
    fn links(&self) -> bool {
        matches!(self.shape, Shape::Responds { .. } | Shape::Each(_))
    }

    fn declaration(&self) -> AtomType {
        let flags = self.reader.events.iter().map(|(_, name)| data("bool", name));
        let counts = self.reader.running.iter().map(|(_, name)| data("int", name));
        let before = self.reader.before.iter().map(|(name, _)| data("bool", name));
        let own = OWN.map(|name| data("bool", name));
        let mut ports: Vec<AtomPort> = self.ports.values().map(|name| exported(name)).collect();
        ports.push(exported("report"));
        let mut transitions: Vec<Transition> =
            self.ports.iter().map(|(letters, port)| transition(port, None, None, self.heard(letters))).collect();
        let eager = Some(Urgency::Eager);
        let [(is_news, told), (is_old, told_again)] = self.reports();
        transitions.push(transition("report", Some(is_news), eager, told));
        if self.links() {
            ports.push(exported("again"));
            transitions.push(transition("again", Some(is_old), eager, told_again));
        }
        for Turn { port, guard, body, .. } in self.turns() {
            ports.push(exported(&port));
            transitions.push(transition(&port, Some(guard), eager, body));
        }
        let past = self.flags().map(|name| data("bool", &name));
        let numbers = self.ring().map(Ring::numbers).into_iter().flatten().map(|(name, _)| data("int", name));
        let clocks =
            ["x".to_owned(), "y".to_owned()].into_iter().chain(self.reader.pasts.iter().flat_map(Past::clocks));
        let clocks = clocks.chain(self.ring().map(Ring::clocks).unwrap_or_default());
        AtomType {
            name: format!("{}_type", self.name).into(),
            data: flags.chain(counts).chain(before).chain(past).chain(numbers).chain(own).collect(),
            clocks: clocks.map(|name| Clock { name: name.into(), unit: TimeUnit::Nanosecond }).collect(),
            ports,
            places: vec![WATCH.into()],
            initial: Initial { places: vec![WATCH.into()], body: self.first(), ..Initial::default() },
            transitions,
            ..AtomType::default()
        }
    }

    /// When it tells of a violation, and of what belongs to the one before, and what it does then.
    fn reports(&self) -> [(Code, Vec<Stmt>); 2] {
        if self.ring().is_some() {
            return [NEWS, OLDS].map(|name| {
                let is_some = Code::binary(BinaryOp::Greater, Code::path(name), Code::int(0));
                let one_less = Code::binary(BinaryOp::Subtract, Code::path(name), Code::int(1));
                (is_some, vec![Stmt::assign(name, one_less)])
            });
        }
        let over = || vec![set("open", false), Stmt::assign("fell", not(Code::path("followed")))];
        let linked = Code::path("linked");
        [not(linked.clone()), linked].map(|which| (and(which, self.violated()), over()))
    }

    /// What it keeps of the past, and of requests that are open.
    fn flags(&self) -> impl Iterator<Item = String> {
        let of_ring = self.ring().map(Ring::flags).unwrap_or_default();
        self.reader.pasts.iter().flat_map(Past::flags).chain(of_ring)
    }

    /// Before anything happens: nothing runs, and that is the first position.
    fn first(&self) -> Vec<Stmt> {
        let flags = self.reader.events.iter().map(|(_, name)| set(name, false));
        let counts = self.reader.running.iter().map(|(_, name)| Stmt::assign(name.as_str(), Code::int(0)));
        let before = self.reader.before.iter().map(|(name, _)| set(name, false));
        let own = OWN.map(|name| set(name, false));
        let past = self.flags().map(|name| set(&name, false));
        let numbers = self.ring().map(Ring::numbers).into_iter().flatten();
        let numbers = numbers.map(|(name, value)| Stmt::assign(name, Code::int(value)));
        let mut all: Vec<Stmt> = flags.chain(counts).chain(before).chain(past).chain(numbers).chain(own).collect();
        // Over events alone there is no position before the first of them.
        if !self.reader.running.is_empty() {
            all.extend(self.step(None));
        }
        all
    }

    /// What is done where something is heard, letter by letter.
    fn heard(&self, letters: &[Letter]) -> Vec<Stmt> {
        letters
            .iter()
            .flat_map(|letter| match letter {
                Letter::Message(topic) => {
                    let flag = self.reader.events.iter().find(|(t, _)| t == topic).map(|(_, name)| name.as_str());
                    let mut all: Vec<Stmt> = flag.map(|flag| set(flag, true)).into_iter().collect();
                    all.extend(self.step(Some(topic)));
                    all.extend(flag.map(|flag| set(flag, false)));
                    all
                }
                Letter::Runs(topic, more) => {
                    let count = self.reader.running.iter().find(|(t, _)| t == topic).map(|(_, name)| name.as_str());
                    let Some(count) = count else { return self.step(Some(topic)) };
                    let (edge, by) = if *more { (0, 1) } else { (1, -1) };
                    let moved = Stmt::assign(count, Code::binary(BinaryOp::Add, Code::path(count), Code::int(by)));
                    let is_edge = Code::binary(BinaryOp::Equal, Code::path(count), Code::int(edge));
                    let mut told = vec![moved.clone()];
                    told.extend(self.step(Some(topic)));
                    vec![Stmt::choice(is_edge, told, vec![moved])]
                }
            })
            .collect()
    }

    /// A position.
    fn step(&self, topic: Option<&str>) -> Vec<Stmt> {
        let zero = |clock: &str| Stmt::assign(clock, Code::int(0));
        let open = || Code::path("open");
        let mut all: Vec<Stmt> = self.reader.pasts.iter().flat_map(Past::step).collect();
        all.extend(match &self.shape {
            Shape::Always(condition) => {
                let first = and(not(condition.clone()), not(Code::path("bad")));
                vec![
                    Stmt::choice(first, vec![set("open", true)], Vec::new()),
                    Stmt::choice(condition.clone(), vec![set("bad", false)], vec![set("bad", true)]),
                ]
            }
            Shape::Responds { asked, answer, at_once, .. } => {
                let opened = vec![
                    set("open", true),
                    zero("x"),
                    Stmt::assign("linked", Code::path("fell")),
                    set("followed", false),
                ];
                let followed = || vec![set("followed", true)];
                let mut asks = vec![Stmt::choice(not(open()), opened, followed())];
                let idle = vec![Stmt::choice(open(), followed(), Vec::new())];
                let mut all = if *at_once {
                    let asked = Stmt::choice(asked.clone(), asks, idle);
                    vec![Stmt::choice(answer.clone(), vec![set("open", false)], vec![asked])]
                } else {
                    // What was asked at this very moment is not answered by it.
                    let stays = Stmt::choice(Code::path("fresh"), vec![zero("x")], vec![set("open", false)]);
                    asks.extend([set("fresh", true), zero("y")]);
                    vec![Stmt::choice(answer.clone(), vec![stays], Vec::new()), Stmt::choice(asked.clone(), asks, idle)]
                };
                all.push(set("fell", false));
                all
            }
            Shape::Each(ring) => ring.step(),
            Shape::Fresh { topic: own, .. } if topic == Some(own) => vec![set("open", true), zero("x")],
            Shape::Fresh { .. } => Vec::new(),
        });
        all.extend(self.reader.before.iter().map(|(name, condition)| Stmt::assign(name.as_str(), condition.clone())));
        all
    }

    /// When it is violated.
    fn violated(&self) -> Code {
        let (within, closed) = match &self.shape {
            Shape::Always(_) | Shape::Each(_) => return Code::path("open"),
            Shape::Responds { within, closed, .. } | Shape::Fresh { within, closed, .. } => (*within, *closed),
        };
        // An eager move needs a first moment, which `x > T` does not have: one nanosecond later is one.
        let first = within.nanos().saturating_add(i64::from(closed));
        let is_over = Code::binary(BinaryOp::GreaterEqual, Code::path("x"), Code::int(first));
        and(Code::path("open"), is_over)
    }
}

fn transition(port: &str, guard: Option<Code>, urgency: Option<Urgency>, body: Vec<Stmt>) -> Transition {
    Transition {
        port: Some(port.into()),
        from: vec![WATCH.into()],
        to: vec![WATCH.into()],
        guard,
        urgency,
        body,
        ..Transition::default()
    }
}

pub(super) fn data(ty: &str, name: &str) -> Data {
    Data { notes: Vec::new(), is_exported: false, ty: ty.into(), name: name.into(), value: None }
}

/// A port that others join.
pub(super) fn exported(name: &str) -> AtomPort {
    parts::port(name, true, Vec::new())
}

pub(super) fn path(component: &str, port: &str) -> Path {
    Path { parts: vec![Name::from(component), Name::from(port)] }
}

/// A property's name as BIP has names.
fn identifier(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let plain = plain.trim_end_matches('_').to_owned();
    let begins = plain.starts_with(|c: char| c.is_ascii_alphabetic());
    bip_name(&if begins { plain } else { format!("p_{plain}") })
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
