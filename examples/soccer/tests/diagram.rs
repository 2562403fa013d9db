//! The state diagram as it is written: eight states, twelve transitions, and the drawing of the README.

mod common;

use common::readme_has;
use lapwing::explain::{Picture, draw};
use soccer::game::{SPEC, spec};
use soccer::watch::DIAGRAM;

#[test]
fn the_diagram_has_the_states_and_transitions_of_the_text() {
    let spec = spec().unwrap();
    let machine = spec.alone().spec.machines.iter().find(|m| m.name == DIAGRAM).unwrap().clone();
    assert_eq!((machine.states.len(), machine.edges.len()), (8, 12));
    let name = |state: usize| machine.states[state].name.as_str();
    assert_eq!(name(machine.initial), "init");
    let from: Vec<&str> = machine.edges.iter().map(|e| name(e.from)).collect();
    let to: Vec<&str> = machine.edges.iter().map(|e| name(e.to)).collect();
    assert!(!from.contains(&"game_over") && !to.contains(&"init") && to.contains(&"game_over"));
    assert!(!from.contains(&"undefined") && !to.contains(&"undefined"));
}

#[test]
fn the_specification_has_nothing_to_be_said_against_it() {
    let findings = spec().unwrap().findings().render(lapwing_diag::Style::Plain);
    assert_eq!(findings, "");
}

#[test]
fn the_readme_has_the_diagram() {
    let diagram = SPEC.split("\nevent ").next().unwrap();
    let alone = lapwing::Spec::parse("soccer.rv", diagram, &|_| None).unwrap();
    let drawn = draw(&alone, None, &lapwing::Options::default(), Picture::Mermaid).unwrap().unwrap();
    readme_has("diagram", &format!("```mermaid\n{}\n```\n", drawn.trim_end()), "diagram");
}
