//! Automata as graphs.

use lapwing_draw::{Graph, Shape};

use super::Input;
use super::bip::{class, what};
use crate::automata::{Action, Automaton, ClockGuard, Cond, Edge};
use crate::check::shown;

/// A graph for each automaton.
pub fn automata_graphs(input: Input<'_>) -> Vec<Graph> {
    input.system.automata.iter().map(|automaton| graph(input, automaton)).collect()
}

fn graph(input: Input<'_>, automaton: &Automaton) -> Graph {
    let mut graph =
        Graph { title: format!("{}: {}", automaton.name, what(automaton)), is_machine: true, ..Graph::default() };
    for (number, location) in automaton.locations.iter().enumerate() {
        let shape = if number == 0 { Shape::Initial } else { Shape::State };
        let limit = location.invariant_ns.map(|ns| format!("\nx ≤ {}", shown(ns))).unwrap_or_default();
        graph.node(shape, format!("{}{limit}", location.name));
    }
    for edge in &automaton.edges {
        graph.edge(edge.from.0, edge.to.0, label(input, edge));
    }
    graph
}

/// Guards between brackets, then what is done; `!` where it is urgent.
fn label(input: Input<'_>, edge: &Edge) -> String {
    let guard = cond(input, &edge.guard);
    let time = edge.clock.map(|guard| match guard {
        ClockGuard::Positive => "x > 0".to_owned(),
        ClockGuard::Exactly(ns) => format!("x = {}", shown(ns)),
    });
    let conditions: Vec<String> = Some(guard).filter(|g| !g.is_empty()).into_iter().chain(time).collect();
    let mut actions: Vec<String> = edge.actions.iter().map(|a| action(input, a)).collect();
    if edge.resets {
        actions.push("x := 0".to_owned());
    }
    let mut parts = vec![format!("{}{}", class(edge.class), if edge.eager { " !" } else { "" })];
    if !conditions.is_empty() {
        parts.push(format!("[{}]", conditions.join(" ∧ ")));
    }
    if !actions.is_empty() {
        parts.push(actions.join("; "));
    }
    parts.join("\n")
}

fn name(input: Input<'_>, var: crate::automata::VarId) -> &str {
    input.system.variables.get(var.0).map_or("?", |v| v.name.as_str())
}

fn cond(input: Input<'_>, condition: &Cond) -> String {
    let joined = |parts: &[Cond], sign: &str| parts.iter().map(|p| cond(input, p)).collect::<Vec<_>>().join(sign);
    match condition {
        Cond::Is(var, value) => format!("{} = {value}", name(input, *var)),
        Cond::Not(var, value) => format!("{} ≠ {value}", name(input, *var)),
        Cond::Less(var, value) => format!("{} < {value}", name(input, *var)),
        Cond::All(parts) => joined(parts, " ∧ "),
        Cond::Any(parts) => format!("({})", joined(parts, " ∨ ")),
    }
}

fn action(input: Input<'_>, what: &Action) -> String {
    match what {
        Action::Set(var, value) => format!("{} := {value}", name(input, *var)),
        Action::Add(var, value) => format!("{} += {value}", name(input, *var)),
        Action::If(condition, then, otherwise) => {
            let list = |actions: &[Action]| actions.iter().map(|a| action(input, a)).collect::<Vec<_>>().join(", ");
            let rest = if otherwise.is_empty() { String::new() } else { format!(" else {}", list(otherwise)) };
            format!("if {} then {}{rest}", cond(input, condition), list(then))
        }
    }
}
