//! A state diagram as a graph.

use lapwing_check::checked::Machine;

use super::super::formula::Printer;
use lapwing_draw::{Graph, Shape};

/// The graph of a machine: an arrow says by which event and under which condition, its own or that of the state it leads to.
pub(super) fn graph(printer: &Printer<'_>, machine: &Machine) -> Option<Graph> {
    let mut graph = Graph { title: machine.name.clone(), is_machine: true, ..Graph::default() };
    for (number, state) in machine.states.iter().enumerate() {
        let stay = [(state.at_least, "at least"), (state.at_most, "at most")];
        let bounds = stay.iter().filter_map(|(bound, word)| bound.map(|d| format!("\n{word} {d}"))).collect::<String>();
        let shape = if number == machine.initial { Shape::Initial } else { Shape::State };
        graph.node(shape, format!("{}{bounds}", state.name));
    }
    let event = |number: usize| printer.meaning.events.get(number).map(|e| e.name.clone());
    for edge in &machine.edges {
        let target = machine.states.get(edge.to)?;
        let on = edge.on.or(target.on).and_then(event).map(|name| format!("on {name}"));
        let when = edge.when.as_ref().or(target.when.as_ref()).map(|w| printer.print(w));
        let parts: Vec<String> = on.into_iter().chain(when).collect();
        graph.edge(edge.from, edge.to, parts.join(" when "));
    }
    graph.remarks = remarks(printer, machine);
    Some(graph)
}

/// What the arrows do not show, as entries of the machine: with it the drawing can be imported again. A state's condition stands at the arrows that lead to
/// it, but an arrow may have one of its own, and to some states none leads.
fn remarks(printer: &Printer<'_>, machine: &Machine) -> Vec<String> {
    let event = |number: usize| printer.meaning.events.get(number).map(|e| format!(" on {}", e.name));
    let sample = machine.sample.iter().map(|s| format!("sample when {}", printer.print(s)));
    let states = machine.states.iter().filter(|s| s.on.is_some() || s.when.is_some()).map(|s| {
        let when = s.when.as_ref().map(|w| format!(" when {}", printer.print(w)));
        format!("state {}{}{}", s.name, s.on.and_then(event).unwrap_or_default(), when.unwrap_or_default())
    });
    let stay = machine.else_stay.then(|| "else stay".to_owned());
    [format!("machine {}", machine.name)].into_iter().chain(sample).chain(states).chain(stay).collect()
}
