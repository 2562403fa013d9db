//! The world as generated code keeps it: the names of what it stores of signals, events, topics and machines.

use std::collections::{BTreeMap, BTreeSet};

use lapwing_check::checked::{InputSource, Spec};
use lapwing_engine::program::{Machine, Node, Op, Positions, Program, Read};
use lapwing_stream::Value;

use crate::code::{Expr, field};
use crate::interface::{From, Kind, Member, Names, Text, identifier};
use crate::kinds::{Kinds, each_positions};
use crate::objects::{handed, part_name, part_of};
use crate::texts::Codes;

/// What is read of the world, and under which names.
pub(crate) struct Scene<'a> {
    pub spec: &'a Spec,
    pub program: &'a Program,
    pub kinds: Kinds,
    /// What comes from outside, with the names of its members.
    pub members: BTreeMap<From, Member>,
    pub texts: Vec<Text>,
    pub codes: Codes,
    /// What is read of the ground truth: the names of the fields that hold it.
    parts: BTreeMap<usize, String>,
    /// The machines that something reads or judges.
    pub machines: Vec<usize>,
}

impl<'a> Scene<'a> {
    pub fn new(spec: &'a Spec, program: &'a Program) -> Scene<'a> {
        let kinds = Kinds::of(spec, program);
        let used = Used::of(program);
        let (members, parts) = (BTreeMap::new(), BTreeMap::new());
        let (texts, codes) = (Vec::new(), Codes::of(program, &kinds));
        let mut scene = Scene { spec, program, kinds, members, texts, codes, parts, machines: used.machines };
        let mut names = Names::default();
        let slots = used.froms.iter().filter_map(|from| match *from {
            From::Input(slot) => Some(slot),
            _ => None,
        });
        let handed = handed(spec, slots);
        let mut fields = Names::default();
        for from in used.froms {
            match from {
                From::Input(slot) if part_of(spec, slot).is_some() => {
                    scene.parts.insert(slot, format!("w_{}", fields.give(&spec.inputs[slot].label)));
                }
                from => scene.member(from, &mut names),
            }
        }
        handed.into_iter().for_each(|from| scene.member(from, &mut names));
        let mut taken = Names::default();
        for text in used.texts {
            let name = taken.give(&format!("TEXT_{}", identifier(&text).to_uppercase()));
            let code = codes.code(scene.texts.len(), &text);
            scene.texts.push(Text { text, name, code });
        }
        scene
    }

    fn member(&mut self, from: From, names: &mut Names) {
        let spec = self.spec;
        let (label, doc) = match from {
            From::Input(i) => {
                let input = &spec.inputs[i];
                let doc = match input.source {
                    InputSource::Field { topic, .. } => format!("`{}`, from {}.", input.label, spec.topics[topic].name),
                    _ => format!("`{}`.", input.label),
                };
                (input.label.clone(), doc)
            }
            From::Event(e) => {
                (spec.events[e].name.clone(), format!("Whether the event `{}` occurs.", spec.events[e].name))
            }
            From::EventField(e, f) => {
                let name = format!("{}_{}", spec.events[e].name, f_name(spec, e, f));
                (name, format!("The field `{}` of the event `{}`.", f_name(spec, e, f), spec.events[e].name))
            }
            From::Topic(t) => {
                let name = &spec.topics[t].name;
                (format!("got_{}", identifier(name)), format!("Whether a message of {name} came."))
            }
            From::Pose(o) => {
                let name = &spec.objects[o].name;
                (format!("has_{name}"), format!("Whether the pose of `{name}` came."))
            }
            From::Twist(o) => {
                let name = &spec.objects[o].name;
                (format!("has_{name}_twist"), format!("Whether the velocities of `{name}` came."))
            }
            From::Part(o, part) => {
                let name = part_name(&spec.objects[o].name, part);
                (name.clone(), format!("`{name}`, as it is handed over."))
            }
        };
        let is_value = matches!(from, From::Input(_) | From::EventField(..));
        let name = names.give(&label);
        let has = is_value.then(|| names.give(&format!("has_{name}")));
        let kind = match from {
            From::Part(..) => Kind::Number,
            _ if is_value => self.kinds.get(from),
            _ => Kind::Truth,
        };
        self.members.insert(from, Member { name, has, kind, from, doc, ty: kind.ty(self.codes) });
    }

    fn name(&self, from: From) -> &str {
        self.members.get(&from).map_or("", |m| &m.name)
    }

    /// The field of a signal's latest value.
    pub fn slot_field(&self, slot: usize) -> String {
        self.parts.get(&slot).cloned().unwrap_or_else(|| format!("s_{}", self.name(From::Input(slot))))
    }

    /// The objects of which something is read.
    pub fn objects(&self) -> BTreeSet<usize> {
        self.parts.keys().filter_map(|&slot| part_of(self.spec, slot)).map(|(object, _)| object).collect()
    }

    /// What is read of an object: the numbers of its parts, and the signals that they are.
    pub fn parts(&self, of: usize) -> impl Iterator<Item = (usize, usize)> {
        let read = self.parts.keys().filter_map(|&slot| Some((part_of(self.spec, slot)?, slot)));
        read.filter(move |((object, _), _)| *object == of).map(|((_, part), slot)| (part, slot))
    }

    /// Whether a signal has a value.
    pub fn is_known(&self, slot: usize) -> Expr {
        match self.program.slots[slot].default {
            Some(_) => Expr::Bool(true),
            None => field(format!("{}_known", self.slot_field(slot))),
        }
    }

    /// The value of a signal before anything has come.
    pub fn initial(&self, slot: usize) -> Expr {
        let default = self.program.slots[slot].default.as_ref();
        match (self.kinds.get(From::Input(slot)), default) {
            (Kind::Truth, Some(Value::Bool(b))) => Expr::Bool(*b),
            (Kind::Truth, Some(Value::Num(x))) => Expr::Bool(*x != 0.0 && !x.is_nan()),
            (Kind::Truth, _) => Expr::Bool(false),
            (Kind::Number, Some(Value::Num(x))) => Expr::Float(*x),
            (Kind::Number, _) => Expr::Float(f64::NAN),
            (Kind::Text, Some(Value::Str(text))) => Expr::Int(self.text(text)),
            (Kind::Text, _) => Expr::Int(0),
        }
    }

    /// Whether an event occurs at this instant.
    pub fn event_field(&self, event: usize) -> String {
        match self.members.get(&From::Event(event)) {
            Some(member) => format!("e_{}", member.name),
            None => format!("e{event}"),
        }
    }

    /// A field of its latest occurrence; with `_there` behind, whether it had that.
    pub fn event_value(&self, event: usize, f: usize) -> String {
        format!("e_{}", self.name(From::EventField(event, f)))
    }

    /// Whether a message of a topic came at this instant.
    pub fn topic_field(&self, topic: usize) -> String {
        format!("t_{}", self.name(From::Topic(topic)))
    }

    /// The code of a text that is written down.
    pub fn text(&self, text: &str) -> i64 {
        self.texts.iter().find(|t| t.text == text).map_or(0, |t| t.code)
    }

    /// The number by which a machine's state is stored.
    pub fn state_code(&self, machine: usize, state: Option<usize>) -> i64 {
        state.unwrap_or(self.program.machines[machine].states.len()) as i64
    }

    /// Whether what something waits for has come.
    pub fn is_defined(&self, read: Read) -> Expr {
        match read {
            Read::Slot(slot) => self.is_known(slot),
            Read::Topic(topic) => field(format!("{}_known", self.topic_field(topic))),
        }
    }
}

fn f_name(spec: &Spec, event: usize, f: usize) -> String {
    let steps = spec.events[event].fields[f].path.iter().map(|step| match step {
        lapwing_check::checked::Step::Field(name) => name.clone(),
        lapwing_check::checked::Step::Index(i) => i.to_string(),
    });
    steps.collect::<Vec<_>>().join("_")
}

/// What a program reads of the world.
#[derive(Default)]
struct Used {
    froms: BTreeSet<From>,
    texts: Vec<String>,
    machines: Vec<usize>,
}

impl Used {
    fn of(program: &Program) -> Used {
        let mut used = Used::default();
        let judged = program.machines.iter().enumerate().filter(|(_, m)| m.property != usize::MAX).map(|(i, _)| i);
        used.machines = judged.collect();
        program.groups.iter().for_each(|g| used.positions(program, &g.at));
        // A machine comes after those that it reads.
        for number in (0..program.machines.len()).rev() {
            if used.machines.contains(&number) {
                used.machine(program, &program.machines[number]);
            }
        }
        used.machines.sort_unstable();
        for silence in program.properties.iter().flat_map(|p| &p.stale) {
            used.read(silence.of);
        }
        for from in used.froms.clone() {
            if let From::Input(slot) = from
                && let Some(Value::Str(text)) = &program.slots[slot].default
            {
                used.text(text);
            }
        }
        used
    }

    fn machine(&mut self, program: &Program, machine: &Machine) {
        self.positions(program, &machine.at);
        let events = machine.states.iter().filter_map(|s| s.on).chain(machine.edges.iter().filter_map(|e| e.on));
        events.for_each(|e| self.event(program, e));
    }

    fn read(&mut self, read: Read) {
        self.froms.insert(match read {
            Read::Slot(slot) => From::Input(slot),
            Read::Topic(topic) => From::Topic(topic),
        });
    }

    fn text(&mut self, text: &str) {
        if !self.texts.iter().any(|t| t == text) {
            self.texts.push(text.to_owned());
        }
    }

    fn event(&mut self, program: &Program, event: usize) {
        if let Some(machine) = emitter(program, event) {
            self.of_machine(machine);
        } else if self.froms.insert(From::Event(event))
            && let Some((at, _)) = &program.events[event].when
        {
            self.positions(program, at);
        }
    }

    fn of_machine(&mut self, machine: usize) {
        if !self.machines.contains(&machine) {
            self.machines.push(machine);
        }
    }

    fn positions(&mut self, program: &Program, at: &Positions) {
        at.reads.iter().for_each(|(read, _)| self.read(*read));
        at.ages.iter().for_each(|ages| self.read(Read::Topic(ages.topic)));
        at.alphabet.iter().flatten().for_each(|&e| self.event(program, e));
        for op in &at.ops {
            match op {
                Op::Slot { slot, .. } => self.read(Read::Slot(*slot)),
                Op::Event(event) => self.event(program, *event),
                _ => {}
            }
        }
        for node in &at.nodes {
            match node {
                Node::Slot(slot) => self.read(Read::Slot(*slot)),
                Node::Updated(slots) => slots.iter().for_each(|s| self.read(Read::Slot(*s))),
                Node::Fresh(topic) | Node::Age(topic) | Node::Frequency(topic, _) => self.read(Read::Topic(*topic)),
                Node::Event(event) => self.event(program, *event),
                Node::EventField { event, field } => {
                    self.event(program, *event);
                    self.froms.insert(From::EventField(*event, *field));
                }
                Node::InState { machine, .. } => self.of_machine(*machine),
                Node::Str(text) => self.text(text),
                _ => {}
            }
        }
    }
}

/// The machine that emits an event, where one does.
pub(crate) fn emitter(program: &Program, event: usize) -> Option<usize> {
    let emits = |m: &Machine| m.states.iter().any(|s| [s.entered, s.left].contains(&Some(event)));
    program.machines.iter().position(emits)
}

/// Whether anything asks if a signal of a machine was updated.
pub(crate) fn updated_slots(at: &Positions) -> Vec<usize> {
    let mut slots: Vec<usize> = at
        .nodes
        .iter()
        .flat_map(|node| match node {
            Node::Updated(slots) => slots.as_slice(),
            _ => &[],
        })
        .copied()
        .collect();
    slots.sort_unstable();
    slots.dedup();
    slots
}

/// Comparisons of values of two kinds.
pub(crate) fn has_odd_comparisons(program: &Program, kinds: &Kinds) -> bool {
    let mut found = false;
    each_positions(program, |at| {
        for node in &at.nodes {
            if let Node::CompareAny { left, right, .. } = node {
                found |= kinds.settled(at, *left) != kinds.settled(at, *right);
            }
        }
    });
    found
}
