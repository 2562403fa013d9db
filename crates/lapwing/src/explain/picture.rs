//! State diagrams as pictures: Graphviz and Mermaid.

use std::fmt::Write;

use lapwing_check::checked::{Machine, Spec as Meaning};

use super::formula::Printer;
use crate::spec::Spec;

/// All state diagrams of a specification for Graphviz; `None` where there is none.
pub fn dot(spec: &Spec) -> Option<String> {
    let meaning = &spec.alone().spec;
    let machines = meaning.machines.iter().enumerate().map(|(number, machine)| {
        let mut out = format!("  subgraph \"cluster_{number}\" {{\n    label={:?};\n", machine.name);
        let id = |state: usize| format!("\"{number}.{state}\"");
        for (state, s) in machine.states.iter().enumerate() {
            let border = if state == machine.initial { ", peripheries=2" } else { "" };
            let _ = writeln!(out, "    {} [label={:?}{border}];", id(state), s.name);
        }
        for edge in labelled(spec, meaning, machine) {
            let _ = writeln!(out, "    {} -> {} [label={:?}];", id(edge.from), id(edge.to), edge.label);
        }
        out + "  }\n"
    });
    let body: String = machines.collect();
    (!body.is_empty()).then(|| format!("digraph {{\n{body}}}\n"))
}

/// All state diagrams of a specification for Mermaid; `None` where there is none.
pub fn mermaid(spec: &Spec) -> Option<String> {
    let meaning = &spec.alone().spec;
    let mut out = String::from("stateDiagram-v2\n");
    for machine in &meaning.machines {
        let id =
            |state: usize| format!("{}_{}", machine.name, machine.states.get(state).map_or("", |s| s.name.as_str()));
        let _ = writeln!(out, "  state {} {{", machine.name);
        for (state, s) in machine.states.iter().enumerate() {
            let _ = writeln!(out, "    {} : {}", id(state), s.name);
        }
        let _ = writeln!(out, "    [*] --> {}", id(machine.initial));
        for edge in labelled(spec, meaning, machine) {
            let label = if edge.label.is_empty() { String::new() } else { format!(" : {}", edge.label) };
            let _ = writeln!(out, "    {} --> {}{label}", id(edge.from), id(edge.to));
        }
        out += "  }\n";
    }
    (!meaning.machines.is_empty()).then_some(out)
}

/// An edge and what it says.
struct Labelled {
    from: usize,
    to: usize,
    label: String,
}

/// The edges of a machine, each with its event and condition, else with those that enter the state that it leads to.
fn labelled(spec: &Spec, meaning: &Meaning, machine: &Machine) -> Vec<Labelled> {
    let printer = Printer { spec, meaning };
    let event = |number: usize| meaning.events.get(number).map(|e| e.name.clone());
    let edges = machine.edges.iter().map(|edge| {
        let target = machine.states.get(edge.to);
        let on = edge.on.or(target.and_then(|s| s.on)).and_then(event);
        let when = edge.when.as_ref().or(target.and_then(|s| s.when.as_ref())).map(|w| printer.print(w));
        let parts: Vec<String> = on.into_iter().chain(when).collect();
        Labelled { from: edge.from, to: edge.to, label: parts.join(" when ") }
    });
    edges.collect()
}
