//! State diagrams.

use lapwing_engine::program as engine;

use super::expr::Lowered;
use super::{ages, read};
use crate::checked::{self, Body, EventSource};

pub(crate) fn machines(spec: &checked::Spec, counters: &mut u32) -> Vec<engine::Machine> {
    spec.machines.iter().enumerate().map(|(number, m)| machine(spec, number, m, counters)).collect()
}

fn machine(spec: &checked::Spec, number: usize, machine: &checked::Machine, counters: &mut u32) -> engine::Machine {
    let positions = engine::Positions {
        reads: machine.reads.iter().map(|r| read((r.what, r.depth))).collect(),
        alphabet: machine.alphabet.clone(),
        ages: ages::of_machine(spec, machine),
        ..engine::Positions::default()
    };
    let mut lowering = Lowered::new(positions).resume(counters);
    let mut condition = |when: &Option<checked::Expr>| when.as_ref().map(|e| lowering.formula(e));
    let sample = condition(&machine.sample);
    let event_of = |source: EventSource| spec.events.iter().position(|e| e.source == source);
    let states = machine.states.iter().enumerate().map(|(state, s)| engine::MachineState {
        name: s.name.clone(),
        when: condition(&s.when),
        on: s.on,
        at_most: s.at_most,
        at_least: s.at_least,
        entered: event_of(EventSource::Entered { machine: number, state }),
        left: event_of(EventSource::Left { machine: number, state }),
    });
    let states = states.collect();
    let edges = machine.edges.iter();
    let edges = edges.map(|e| engine::Edge { from: e.from, to: e.to, on: e.on, when: condition(&e.when) }).collect();
    engine::Machine {
        sample,
        initial: machine.initial,
        states,
        else_stay: machine.else_stay,
        edges,
        property: spec.properties.iter().position(|p| p.body == Body::Machine(number)).unwrap_or(usize::MAX),
        at: lowering.into_positions(),
    }
}
