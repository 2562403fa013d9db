//! What the edges of the automata are to a specification: the messages of which a run would tell there, in their order.

use lapwing_genom::automata::{Automaton, ClockGuard, ETHER, Edge, Part, System};
use lapwing_genom::model::{CodelId, Direction, Model, Object};

/// A message that an edge comes to.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Letter {
    /// On this topic.
    Message(String),
    /// An instance more, or less, of an activity runs: what comes on its topic `running` depends on how many there were.
    Runs(String, bool),
}

/// What an edge comes to.
pub(super) fn letters(model: &Model, system: &System, automaton: usize, edge: &Edge) -> Vec<Letter> {
    let mut all = Vec::new();
    let Some(declared) = system.automata.get(automaton) else { return all };
    let Some(component) = model.components.get(declared.component) else { return all };
    if let Some(codel) = completed(declared, edge).and_then(|codel| component.codels.get(codel.0)) {
        for parameter in codel.parameters.iter().filter(|p| p.direction != Direction::In) {
            if let Object::Port(port) = parameter.object
                && let Some(port) = component.ports.get(port.0).filter(|p| p.is_out)
            {
                all.push(Letter::Message(format!("/{}/{}", component.name, port.name)));
            }
        }
    }
    match declared.part {
        Part::Activity => {
            let cell = system.cells.iter().find(|cell| cell.automaton == automaton);
            let service = cell.and_then(|cell| component.services.get(cell.activity?.0));
            let Some(service) = service.filter(|_| (edge.from == ETHER) != (edge.to == ETHER)) else { return all };
            let topic = |word: &str| format!("/{}/{}/{word}", component.name, service.name);
            let begins = edge.from == ETHER;
            all.push(Letter::Runs(topic("running"), begins));
            all.push(Letter::Message(topic(if begins { "start" } else { "end" })));
        }
        Part::Control => {
            for (service, word) in [(edge.request, "request"), (edge.concludes, "report")] {
                if let Some(service) = service.and_then(|id| component.services.get(id.0)) {
                    all.push(Letter::Message(format!("/{}/{}/{word}", component.name, service.name)));
                }
            }
        }
        _ => {}
    }
    all
}

/// The codel that has ended when an edge is taken.
fn completed(automaton: &Automaton, edge: &Edge) -> Option<CodelId> {
    if let Some(call) = &edge.call {
        return Some(call.codel);
    }
    let ends = edge.clock == Some(ClockGuard::Positive);
    automaton.locations.get(edge.from.0).and_then(|l| l.codel).filter(|_| ends)
}
