//! What has to be seen for a property to be judged: the events and columns that its formula and its machines read.

use std::collections::BTreeSet;

use lapwing_check::checked::{self, Body, EventSource, Expr, InputSource, Kind, Property};

/// The events and columns that a property reads, by their numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Needs {
    pub events: BTreeSet<usize>,
    pub columns: BTreeSet<usize>,
    machines: BTreeSet<usize>,
}

impl Needs {
    /// What one property needs.
    pub fn of(meaning: &checked::Spec, property: &Property) -> Needs {
        let mut needs = Needs::default();
        property.alphabet.iter().flatten().for_each(|&event| needs.event(meaning, event));
        property.slices.iter().for_each(|slice| needs.event(meaning, slice.event));
        property.machines.iter().for_each(|&machine| needs.machine(meaning, machine));
        match &property.body {
            Body::Formula(formula) => needs.expr(meaning, formula),
            Body::Machine(machine) => needs.machine(meaning, *machine),
            Body::None => {}
        }
        needs
    }

    fn expr(&mut self, meaning: &checked::Spec, e: &Expr) {
        match &e.kind {
            Kind::Input(input) => self.input(meaning, *input),
            Kind::Updated(inputs) => inputs.iter().for_each(|&input| self.input(meaning, input)),
            Kind::Event(event) | Kind::EventField { event, .. } => self.event(meaning, *event),
            Kind::InState { machine, .. } => self.machine(meaning, *machine),
            _ => {}
        }
        e.children().into_iter().for_each(|child| self.expr(meaning, child));
    }

    fn input(&mut self, meaning: &checked::Spec, input: usize) {
        if let Some(InputSource::Column(column)) = meaning.inputs.get(input).map(|i| &i.source) {
            self.columns.insert(*column);
        }
    }

    /// An event; of a machine's, the machine.
    fn event(&mut self, meaning: &checked::Spec, event: usize) {
        match meaning.events.get(event).map(|e| &e.source) {
            Some(EventSource::Entered { machine, .. } | EventSource::Left { machine, .. }) => {
                self.machine(meaning, *machine);
            }
            _ => _ = self.events.insert(event),
        }
    }

    fn machine(&mut self, meaning: &checked::Spec, number: usize) {
        let Some(machine) = meaning.machines.get(number).filter(|_| self.machines.insert(number)) else { return };
        machine.conditions().for_each(|e| self.expr(meaning, e));
        let triggers = machine.states.iter().filter_map(|s| s.on).chain(machine.edges.iter().filter_map(|e| e.on));
        triggers.for_each(|event| self.event(meaning, event));
    }
}
