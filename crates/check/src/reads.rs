//! What a formula reads: signals and topics with how far back, machines, events.

use std::collections::{BTreeMap, BTreeSet};

use crate::checked::{Event, Expr, Input, Kind, Read, ReadOf};
use crate::machine::MachineTable;

/// What expressions read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Uses {
    depths: BTreeMap<ReadOf, usize>,
    /// Of what steps on events alone: what the machines read whose events these are.
    behind: BTreeMap<ReadOf, usize>,
    /// The machines whose state is read, and those that these read.
    pub machines: BTreeSet<usize>,
    /// The events that are named.
    pub events: BTreeSet<usize>,
    /// Whether anything but events is read: then every instant of the trace is a position.
    pub signals: bool,
}

impl Uses {
    /// What one expression reads.
    pub fn of(inputs: &[Input], machines: &MachineTable, expr: &Expr) -> Uses {
        let mut uses = Uses::default();
        uses.add(inputs, machines, expr);
        uses
    }

    /// What one more expression reads.
    pub fn add(&mut self, inputs: &[Input], machines: &MachineTable, expr: &Expr) {
        let mut open = vec![(expr, 0usize)];
        while let Some((expr, depth)) = open.pop() {
            let below = match &expr.kind {
                Kind::Lookback(_, n) => depth.saturating_add(*n),
                Kind::Delta(_) | Kind::Rate(_) => depth.saturating_add(1),
                _ => depth,
            };
            match &expr.kind {
                Kind::Input(input) => self.input(inputs, *input, depth),
                Kind::Updated(updated) => updated.iter().for_each(|&input| self.input(inputs, input, depth)),
                Kind::Age(topic) | Kind::Frequency(topic, _) | Kind::Fresh(topic) => {
                    self.need(ReadOf::Topic(*topic), depth)
                }
                Kind::Event(event) | Kind::EventField { event, .. } => _ = self.events.insert(*event),
                Kind::InState { machine, .. } => self.machine(machines, *machine, depth),
                _ => {}
            }
            open.extend(expr.children().into_iter().map(|child| (child, below)));
        }
    }

    /// What reads signals and names the events of machines waits for what these read. What steps on events alone does not, but what
    /// reads its state does.
    pub fn wait_for_machines(&mut self, machines: &MachineTable, events: &[Event]) {
        let mut named = Uses::default();
        let of_machines = self.events.iter().filter_map(|&event| events.get(event)?.source.machine());
        of_machines.for_each(|machine| named.machine(machines, machine, 0));
        if self.signals {
            self.machines.append(&mut named.machines);
            named.depths.into_iter().for_each(|(what, depth)| self.need(what, depth));
        } else {
            self.behind = named.depths;
        }
    }

    /// The reads, in order.
    pub fn reads(&self) -> Vec<Read> {
        self.depths.iter().map(|(&what, &depth)| Read { what, depth }).collect()
    }

    fn input(&mut self, inputs: &[Input], input: usize, depth: usize) {
        match inputs.get(input) {
            // What has a default is always defined.
            Some(Input { default: Some(_), .. }) => self.signals = true,
            _ => self.need(ReadOf::Input(input), depth),
        }
    }

    fn need(&mut self, what: ReadOf, depth: usize) {
        self.signals = true;
        let known = self.depths.entry(what).or_default();
        *known = (*known).max(depth);
    }

    fn machine(&mut self, machines: &MachineTable, machine: usize, depth: usize) {
        self.signals = true;
        self.machines.insert(machine);
        let Some(entry) = machines.get(machine) else { return };
        self.machines.extend(&entry.uses.machines);
        for (&what, &own) in entry.uses.depths.iter().chain(&entry.uses.behind) {
            self.need(what, own.saturating_add(depth));
        }
    }
}
