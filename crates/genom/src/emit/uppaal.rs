//! UPPAAL's XML, after its document type `flat-1_6`.
//!
//! Variables are global, an automaton is a template. An eager edge synchronises on the urgent broadcast channel `hurry`, to which nobody listens:
//! UPPAAL then lets no time pass while it can be taken. That works because no eager edge waits for the clock.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::bip::{class, what};
use super::{Input, names};
use crate::automata::{Action, Automaton, ClockGuard, Cond, Edge, Part, System, VarId};
use crate::check::shown;

/// The document.
pub fn uppaal(input: Input<'_>) -> String {
    let writer = Writer { input, system: input.system, unit_ns: unit(input.system) };
    let mut out = String::from(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<!DOCTYPE nta PUBLIC '-//Uppaal Team//DTD Flat System 1.6//EN' \
         'http://www.it.uu.se/research/group/darts/uppaal/flat-1_6.dtd'>\n<nta>\n",
    );
    let _ = writeln!(out, "  <declaration>{}</declaration>", escaped(&writer.declaration()));
    let mut next_id = 0;
    for automaton in &input.system.automata {
        writer.template(automaton, &mut next_id, &mut out);
    }
    let all: Vec<String> = input.system.automata.iter().map(|a| names::uppaal(&a.name)).collect();
    let _ = writeln!(out, "  <system>{}</system>", escaped(&format!("system {};", all.join(", "))));
    writer.queries(&mut out);
    out + "</nta>\n"
}

/// The greatest length of which all times are multiples: UPPAAL counts in whole numbers.
fn unit(system: &System) -> u64 {
    let mut times: BTreeSet<u64> = BTreeSet::new();
    for automaton in &system.automata {
        times.extend(automaton.locations.iter().filter_map(|l| l.invariant_ns));
        times.extend(automaton.edges.iter().filter_map(|e| match e.clock {
            Some(ClockGuard::Exactly(ns)) => Some(ns),
            _ => None,
        }));
    }
    let common = |mut a: u64, mut b: u64| {
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let unit = times.into_iter().fold(0, common);
    if unit == 0 { 1_000_000 } else { unit }
}

struct Writer<'a> {
    input: Input<'a>,
    system: &'a System,
    unit_ns: u64,
}

impl Writer<'_> {
    fn declaration(&self) -> String {
        let mut out = format!("// One unit of time is {}.\nurgent broadcast chan hurry;\n", shown(self.unit_ns));
        for variable in &self.system.variables {
            let (low, high) = variable.range;
            let name = names::uppaal(&variable.name);
            let _ = match variable.is_bool {
                true => writeln!(out, "bool {name} = {}; // {}", variable.initial != 0, variable.meaning),
                false => writeln!(out, "int[{low},{high}] {name} = {}; // {}", variable.initial, variable.meaning),
            };
        }
        out
    }

    fn template(&self, automaton: &Automaton, next_id: &mut usize, out: &mut String) {
        let first = *next_id;
        *next_id += automaton.locations.len();
        let _ = writeln!(out, "  <template>\n    <name>{}</name>", names::uppaal(&automaton.name));
        let mut local = format!("// {}: {}\nclock x;\n", self.input.line(automaton.span), what(automaton));
        for edge in automaton.edges.iter().filter(|e| needs_function(e)) {
            let _ = write!(local, "void {}() {{\n{}}}\n", function(edge), self.block(&edge.actions, 1));
        }
        let _ = writeln!(out, "    <declaration>{}</declaration>", escaped(&local));
        for (number, location) in automaton.locations.iter().enumerate() {
            let (x, y) = place(number);
            let _ = writeln!(out, "    <location id=\"id{}\" x=\"{x}\" y=\"{y}\">", first + number);
            let _ = writeln!(out, "      <name>{}</name>", names::uppaal(&location.name));
            if let Some(ns) = location.invariant_ns {
                let _ = writeln!(
                    out,
                    "      <label kind=\"invariant\">{}</label>",
                    escaped(&format!("x <= {}", ns / self.unit_ns))
                );
            }
            let _ = writeln!(
                out,
                "      <label kind=\"comments\">{}</label>\n    </location>",
                escaped(&self.input.line(location.span))
            );
        }
        let _ = writeln!(out, "    <init ref=\"id{first}\"/>");
        for edge in &automaton.edges {
            self.transition(edge, first, out);
        }
        out.push_str("  </template>\n");
    }

    fn transition(&self, edge: &Edge, first: usize, out: &mut String) {
        let _ = writeln!(
            out,
            "    <transition>\n      <source ref=\"id{}\"/>\n      <target ref=\"id{}\"/>",
            first + edge.from.0,
            first + edge.to.0
        );
        let mut label = |kind: &str, text: &str| {
            if !text.is_empty() {
                let _ = writeln!(out, "      <label kind=\"{kind}\">{}</label>", escaped(text));
            }
        };
        let time = edge.clock.map(|guard| match guard {
            ClockGuard::Positive => "x > 0".to_owned(),
            ClockGuard::Exactly(ns) => format!("x == {}", ns / self.unit_ns),
        });
        let data = Some(self.cond(&edge.guard, true)).filter(|text| !text.is_empty());
        label("guard", &data.into_iter().chain(time).collect::<Vec<_>>().join(" && "));
        label("synchronisation", if edge.eager { "hurry!" } else { "" });
        let mut actions: Vec<String> = match needs_function(edge) {
            true => vec![format!("{}()", function(edge))],
            false => edge.actions.iter().map(|a| self.assignment(a)).collect(),
        };
        if edge.resets {
            actions.push("x = 0".to_owned());
        }
        label("assignment", &actions.join(", "));
        label("comments", &format!("{}: {}, {}", self.input.line(edge.span), edge.name, class(edge.class)));
        out.push_str("    </transition>\n");
    }

    /// Can everything go on for ever, and does no task miss the beginning of a period?
    fn queries(&self, out: &mut String) {
        out.push_str("  <queries>\n");
        let mut query = |formula: &str, comment: &str| {
            let _ = writeln!(
                out,
                "    <query>\n      <formula>{}</formula>\n      <comment>{}</comment>\n    </query>",
                escaped(formula),
                escaped(comment)
            );
        };
        query("A[] not deadlock", "Something can always happen.");
        for manager in self.system.automata.iter().filter(|a| a.part == Part::Manager) {
            // The manager's first edge takes the signal.
            let signal = manager.edges.first().map(|edge| self.cond(&edge.guard, true)).unwrap_or_default();
            let name = names::uppaal(&manager.name);
            query(
                &format!("A[] (not {name}.wait imply not {signal})"),
                "No period begins before the work of the last one is done.",
            );
        }
        out.push_str("  </queries>\n");
    }

    fn name(&self, id: VarId) -> String {
        self.system.variables.get(id.0).map(|v| names::uppaal(&v.name)).unwrap_or_default()
    }

    fn value(&self, id: VarId, value: i64) -> String {
        match self.system.variables.get(id.0) {
            Some(variable) if variable.is_bool => (value != 0).to_string(),
            _ => value.to_string(),
        }
    }

    /// A condition; at the top nothing where it always holds.
    fn cond(&self, cond: &Cond, is_top: bool) -> String {
        let joined =
            |parts: &[Cond], sign: &str| parts.iter().map(|p| self.cond(p, false)).collect::<Vec<_>>().join(sign);
        match cond {
            Cond::Is(var, value) if self.system.variables.get(var.0).is_some_and(|v| v.is_bool) => {
                format!("{}{}", if *value == 0 { "!" } else { "" }, self.name(*var))
            }
            Cond::Is(var, value) => format!("{} == {}", self.name(*var), self.value(*var, *value)),
            Cond::Not(var, value) => format!("{} != {}", self.name(*var), self.value(*var, *value)),
            Cond::Less(var, value) => format!("{} < {value}", self.name(*var)),
            Cond::All(parts) if parts.is_empty() => {
                if is_top {
                    String::new()
                } else {
                    "true".to_owned()
                }
            }
            Cond::All(parts) if is_top => joined(parts, " && "),
            Cond::All(parts) => format!("({})", joined(parts, " && ")),
            Cond::Any(parts) if parts.is_empty() => "false".to_owned(),
            Cond::Any(parts) => format!("({})", joined(parts, " || ")),
        }
    }

    fn assignment(&self, action: &Action) -> String {
        match action {
            Action::Set(var, value) => format!("{} = {}", self.name(*var), self.value(*var, *value)),
            Action::Add(var, value) => format!("{} += {value}", self.name(*var)),
            Action::If(..) => String::new(),
        }
    }

    fn block(&self, actions: &[Action], depth: usize) -> String {
        let indent = "  ".repeat(depth);
        let mut out = String::new();
        for action in actions {
            match action {
                Action::If(cond, then, otherwise) => {
                    let _ = write!(
                        out,
                        "{indent}if ({}) {{\n{}{indent}}}",
                        self.cond(cond, false),
                        self.block(then, depth + 1)
                    );
                    if !otherwise.is_empty() {
                        let _ = write!(out, " else {{\n{}{indent}}}", self.block(otherwise, depth + 1));
                    }
                    out.push('\n');
                }
                simple => {
                    let _ = writeln!(out, "{indent}{};", self.assignment(simple));
                }
            }
        }
        out
    }
}

/// What an edge does is a function where it chooses.
fn needs_function(edge: &Edge) -> bool {
    edge.actions.iter().any(|a| matches!(a, Action::If(..)))
}

fn function(edge: &Edge) -> String {
    format!("do_{}", edge.name)
}

/// Where a location is drawn: on a grid.
fn place(number: usize) -> (usize, usize) {
    ((number % 4) * 240, (number / 4) * 160)
}

/// A text as XML has it.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
