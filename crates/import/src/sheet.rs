//! What is written: events, state diagrams, properties and reactions, and their text.

use std::fmt::Write as _;

use lapwing_diag::Diagnostic;
use lapwing_syntax::ast::Expr;
use lapwing_syntax::print_expr;

use crate::expr;
use crate::names::{Taken, written};

/// A specification before it is text.
#[derive(Debug, Default)]
pub(crate) struct Sheet {
    /// The names of events, machines and properties.
    pub taken: Taken,
    pub events: Vec<Event>,
    /// Machines and properties, in the order of the original.
    pub items: Vec<Item>,
    pub reactions: Vec<Reaction>,
}

/// `event NAME = …`
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Event {
    pub name: String,
    /// Where it comes from; `None`: whoever runs the robot tells it by its name.
    pub source: Option<Source>,
    pub when: Option<Expr>,
    pub below: Option<Vec<String>>,
}

impl Event {
    /// Whether it occurs wherever the other does, and nowhere else.
    pub(crate) fn is_at_place_of(&self, other: &Event) -> bool {
        (&self.source, &self.when, &self.below) == (&other.source, &other.when, &other.below)
    }
}

/// Where an event comes from, by the parts of a path.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Source {
    Call(Vec<String>),
    Return(Vec<String>),
    Set(Vec<String>),
}

#[derive(Debug)]
pub(crate) enum Item {
    Machine(Machine),
    Property(Property),
}

/// `machine NAME { … }`
#[derive(Debug, Default)]
pub(crate) struct Machine {
    pub name: String,
    /// What is said above it, a line each.
    pub remarks: Vec<String>,
    pub sample: Option<Expr>,
    pub initial: String,
    pub states: Vec<State>,
    pub else_stay: bool,
    pub edges: Vec<Edge>,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct State {
    pub name: String,
    pub on: Option<String>,
    pub when: Option<Expr>,
    /// `at most 2 s`, as it is written.
    pub bounds: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Edge {
    pub from: String,
    pub to: String,
    pub on: Option<String>,
    pub when: Option<Expr>,
}

/// `property NAME over (…): for each …: FORMULA`
#[derive(Debug)]
pub(crate) struct Property {
    pub name: String,
    pub over: Vec<String>,
    /// Variable, event and field, outermost first.
    pub each: Vec<(String, String, String)>,
    pub body: Expr,
}

/// `on violation of NAME { … }`
#[derive(Debug)]
pub(crate) struct Reaction {
    pub property: String,
    /// The original in a line.
    pub remark: Option<String>,
    pub actions: Vec<Action>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Action {
    Run(String),
    Reset,
    Stop,
}

impl Sheet {
    /// Whether there is nothing to be judged.
    pub(crate) fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// The event, declared; what was declared alike before is the same event. Gives its name.
    pub(crate) fn event(&mut self, event: Event) -> String {
        if !self.events.contains(&event) {
            self.events.push(event.clone());
        }
        event.name
    }

    /// The text, as `lapwing fmt` lays it out; what is wrong with it where it cannot be read, which happens where a formula is too high.
    pub(crate) fn write(&self, origin: &str) -> Result<String, Vec<Diagnostic>> {
        let mut out = String::new();
        // A name of a file may have anything in it, a newline too.
        let origin: String = origin.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        let _ = writeln!(out, "# Imported from {origin} by `lapwing import`.\n");
        self.events.iter().for_each(|event| self::event(&mut out, event));
        for item in &self.items {
            out.push('\n');
            match item {
                Item::Machine(machine) => self::machine(&mut out, machine),
                Item::Property(property) => self::property(&mut out, property),
            }
        }
        for reaction in &self.reactions {
            out.push('\n');
            self::reaction(&mut out, reaction);
        }
        lapwing_syntax::format(&out)
    }
}

fn event(out: &mut String, event: &Event) {
    let _ = write!(out, "event {}", written(&event.name));
    let parts = |names: &[String], by: &str| names.iter().map(|n| written(n)).collect::<Vec<_>>().join(by);
    let _ = match &event.source {
        None => Ok(()),
        Some(Source::Call(path)) => write!(out, " = call {}", parts(path, "::")),
        Some(Source::Return(path)) => write!(out, " = return {}", parts(path, "::")),
        Some(Source::Set(path)) => write!(out, " = set {}", parts(path, ".")),
    };
    if let Some(when) = &event.when {
        let _ = write!(out, " when {}", print_expr(when));
    }
    if let Some(below) = &event.below {
        let _ = write!(out, " below {}", parts(below, "::"));
    }
    out.push('\n');
}

fn machine(out: &mut String, machine: &Machine) {
    machine.remarks.iter().for_each(|remark| comment(out, remark));
    let _ = writeln!(out, "machine {} {{", written(&machine.name));
    if let Some(sample) = &machine.sample {
        let _ = writeln!(out, "    sample when {}", print_expr(sample));
    }
    let _ = writeln!(out, "    initial {}", written(&machine.initial));
    for state in &machine.states {
        let _ = write!(out, "    state {}", written(&state.name));
        clauses(out, state.on.as_deref(), state.when.as_ref());
        state.bounds.iter().for_each(|bound| _ = write!(out, " {bound}"));
        out.push('\n');
    }
    if machine.else_stay {
        out.push_str("    else stay\n");
    }
    for edge in &machine.edges {
        let _ = write!(out, "    {} -> {}", written(&edge.from), written(&edge.to));
        clauses(out, edge.on.as_deref(), edge.when.as_ref());
        out.push('\n');
    }
    out.push_str("}\n");
}

fn clauses(out: &mut String, on: Option<&str>, when: Option<&Expr>) {
    if let Some(on) = on {
        let _ = write!(out, " on {}", written(on));
    }
    if let Some(when) = when {
        let _ = write!(out, " when {}", print_expr(when));
    }
}

fn property(out: &mut String, property: &Property) {
    let _ = write!(out, "property {}", written(&property.name));
    if !property.over.is_empty() {
        let over: Vec<String> = property.over.iter().map(|e| print_expr(&expr::name(e))).collect();
        let _ = write!(out, " over ({})", over.join(", "));
    }
    out.push(':');
    for (variable, event, field) in &property.each {
        let _ = write!(out, " for each {} of {}.{}:", written(variable), written(event), written(field));
    }
    let _ = writeln!(out, " {}", print_expr(&property.body));
}

fn reaction(out: &mut String, reaction: &Reaction) {
    reaction.remark.iter().for_each(|remark| comment(out, remark));
    let _ = writeln!(out, "on violation of {} {{", written(&reaction.property));
    for action in &reaction.actions {
        let _ = match action {
            Action::Run(handler) => writeln!(out, "    run {}", written(handler)),
            Action::Reset => writeln!(out, "    reset"),
            Action::Stop => writeln!(out, "    stop"),
        };
    }
    out.push_str("}\n");
}

/// A comment of one line, whatever the text has in it.
fn comment(out: &mut String, text: &str) {
    let line: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let _ = writeln!(out, "# {}", line.trim());
}
