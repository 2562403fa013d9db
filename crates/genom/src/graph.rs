//! Components as pictures: who writes what for whom, which task runs what, and the state machine of every activity.

use lapwing_draw::{Graph, Shape};

use crate::ast::Direction;
use crate::check::shown;
use crate::model::{Codel, CodelId, Component, Model, Object, ServiceKind, Target, TaskId};

/// All pictures of a model: the components together, then each of them, then its state machines.
pub fn graphs(model: &Model) -> Vec<Graph> {
    let mut all = vec![components(model)];
    for component in &model.components {
        all.push(inside(component));
        for (number, task) in component.tasks.iter().enumerate().filter(|(_, t)| !t.codels.is_empty()) {
            all.push(machine(
                component,
                &format!("{}.{}: the permanent activity of a task", component.name, task.name),
                &component.tasks[number].codels,
            ));
        }
        for service in component.services.iter().filter(|s| s.kind == ServiceKind::Activity && !s.codels.is_empty()) {
            all.push(machine(component, &format!("{}.{}", component.name, service.name), &service.codels));
        }
    }
    all
}

/// Components, the ports that they write, and who reads them.
fn components(model: &Model) -> Graph {
    let mut graph = Graph { title: "Components and ports".to_owned(), ..Graph::default() };
    let boxes: Vec<usize> = model.components.iter().map(|c| graph.node(Shape::Component, &*c.name)).collect();
    let mut ports = Vec::new();
    for (number, component) in model.components.iter().enumerate() {
        for (id, port) in component.ports.iter().enumerate() {
            let reader = (number, crate::model::PortId(id));
            let is_linked = model.links.iter().any(|l| l.reader == reader);
            if port.is_out || !is_linked {
                let node = graph.node(Shape::Port, &*port.name);
                ports.push((reader, node));
                let (from, to) = if port.is_out { (boxes[number], node) } else { (node, boxes[number]) };
                graph.edge(from, to, "");
            }
        }
    }
    for link in &model.links {
        let writer = ports.iter().find(|(port, _)| *port == link.writer);
        if let (Some((_, node)), Some(reader)) = (writer, boxes.get(link.reader.0)) {
            graph.edge(*node, *reader, "");
        }
    }
    graph
}

/// The tasks of a component, what they run, and the ports that this uses.
fn inside(component: &Component) -> Graph {
    let mut graph = Graph { title: component.name.clone(), ..Graph::default() };
    let control = graph.node(Shape::Task, "control task");
    let period = |ns: Option<u64>| ns.map_or("no period".to_owned(), |ns| format!("every {}", shown(ns)));
    let tasks: Vec<usize> = component
        .tasks
        .iter()
        .map(|t| graph.node(Shape::Task, format!("{}\n{}", t.name, period(t.period_ns))))
        .collect();
    let ports: Vec<usize> = component.ports.iter().map(|p| graph.node(Shape::Port, &*p.name)).collect();
    for (number, task) in component.tasks.iter().enumerate() {
        uses(component, &task.codels, tasks[number], &ports, &mut graph);
    }
    for service in &component.services {
        let runner = service.task.and_then(|TaskId(t)| tasks.get(t)).copied().unwrap_or(control);
        let node = graph.below(runner, "", Shape::Operator, format!("{}\n{}", service.name, service.kind.word()));
        uses(component, &service.codels, node, &ports, &mut graph);
    }
    graph
}

/// Arrows from what is read and to what is written, one of each.
fn uses(component: &Component, codels: &[CodelId], node: usize, ports: &[usize], graph: &mut Graph) {
    let codels = codels.iter().filter_map(|id| component.codels.get(id.0));
    let mut known = Vec::new();
    for parameter in codels.flat_map(|c| &c.parameters) {
        let Object::Port(port) = &parameter.object else { continue };
        let Some(other) = ports.get(port.0).copied() else { continue };
        let writes = parameter.direction != Direction::In;
        let (from, to) = if writes { (node, other) } else { (other, node) };
        if !known.contains(&(from, to)) {
            known.push((from, to));
            graph.edge(from, to, "");
        }
    }
}

/// The states of an activity, as they are written.
fn machine(component: &Component, title: &str, codels: &[CodelId]) -> Graph {
    let mut graph = Graph { title: title.to_owned(), is_machine: true, ..Graph::default() };
    let found: Vec<(CodelId, &Codel)> =
        codels.iter().filter_map(|id| Some((*id, component.codels.get(id.0)?))).collect();
    for (_, codel) in &found {
        let is_start = codel.triggers().iter().any(|t| t == "start");
        let wcet = codel.wcet_ns.map(|ns| format!("\nup to {}", shown(ns))).unwrap_or_default();
        let beside = if codel.is_async { "\nbeside its task" } else { "" };
        let label = format!("{}\n{}(){wcet}{beside}", codel.triggers().join(", "), codel.function);
        graph.node(if is_start { Shape::Initial } else { Shape::State }, label);
    }
    let has_end = found.iter().flat_map(|(_, c)| c.yields()).any(|t| t.to == Target::Ether);
    let end = has_end.then(|| graph.node(Shape::State, "ether"));
    for (number, (_, codel)) in found.iter().enumerate() {
        for transition in codel.yields() {
            let to = match transition.to {
                Target::Ether => end,
                Target::Codel(target) => found.iter().position(|(id, _)| *id == target),
            };
            if let Some(to) = to {
                graph.edge(number, to, if transition.pause { "pause" } else { "" });
            }
        }
    }
    graph
}
