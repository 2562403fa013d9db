//! A client as an atom: it makes the requests of a list, each at its time, and nobody else makes any.

use lapwing_bip::ast::{
    AtomType, BinaryOp, Clock, DeclKind, Expr as Code, Initial, Name, Package, TimeUnit, Transition, Urgency,
};
use lapwing_genom::Model;
use lapwing_genom::automata::{Class, System};
use lapwing_genom::emit::parts;
use lapwing_genom::model::ServiceId;

use super::Draft;
use super::guard::{exported, path};
use crate::request::Timed;

/// The atom.
const CLIENT: &str = "client";

/// The model with a client that makes these requests, in the order of their times. What they ask with is not in the model.
pub fn with_requests(package: Package, system: &System, model: &Model, requests: &[Timed]) -> Package {
    let mut draft = Draft::new(package, system);
    let place = |number: usize| Name::from(format!("after_{number}"));
    let mut wanted: Vec<(String, usize, ServiceId)> = Vec::new();
    let mut transitions = Vec::new();
    for (number, (time, request)) in requests.iter().enumerate() {
        let Some(component) = model.components.get(request.component) else { continue };
        let Some(service) = component.services.get(request.service.0) else { continue };
        let port = format!("ask_{}_{}", component.name, service.name);
        if !wanted.iter().any(|(known, ..)| *known == port) {
            wanted.push((port.clone(), request.component, request.service));
        }
        let is_time = Code::binary(BinaryOp::GreaterEqual, Code::path("t"), Code::int(time.0));
        transitions.push(Transition {
            port: Some(port.into()),
            from: vec![place(number)],
            to: vec![place(number + 1)],
            guard: Some(is_time),
            urgency: Some(Urgency::Eager),
            ..Transition::default()
        });
    }
    let atom = AtomType {
        name: format!("{CLIENT}_type").into(),
        clocks: vec![Clock { name: "t".into(), unit: TimeUnit::Nanosecond }],
        ports: wanted.iter().map(|(name, ..)| exported(name)).collect(),
        places: (0..=requests.len()).map(place).collect(),
        initial: Initial { places: vec![place(0)], ..Initial::default() },
        transitions,
        ..AtomType::default()
    };
    draft.declare(parts::noted(DeclKind::Atom(atom), "The client: it makes the requests of a mission."));
    draft.component(&format!("{CLIENT}_type"), CLIENT);
    let open: Vec<String> = system
        .automata
        .iter()
        .flat_map(|a| a.edges.iter().filter(|e| e.class == Class::Request).map(|e| parts::connector(a, &e.name)))
        .collect();
    for (port, component, service) in wanted {
        let Some((_, control)) = draft.control(component) else { continue };
        let Some(edge) = control.request(service) else { continue };
        let (name, own) = (parts::connector(control, &edge.name), parts::port_path(control, &edge.name));
        let ty = draft.rendezvous(2);
        if let Some(root) = draft.root()
            && let Some(connector) = root.connectors.iter_mut().find(|c| c.name.text == name)
        {
            connector.ty = ty.into();
            connector.ports = vec![own, path(CLIENT, &port)];
        }
    }
    if let Some(root) = draft.root() {
        // What nobody asks for is not asked for.
        root.connectors.retain(|c| c.ports.len() > 1 || !open.contains(&c.name.text));
    }
    draft.finish()
}
