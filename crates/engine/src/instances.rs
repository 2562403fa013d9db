//! The instances of a group, under `for each` over the values of events.

use alloc::vec::Vec;

use lapwing_stream::Value;
use serde::{Deserialize, Serialize};

use crate::group::Core;
use crate::inputs::Inputs;
use crate::program::{Group, Positions};

/// At most so many instances of a property under `for each` over values.
pub(crate) const INSTANCES: usize = 65_536;

/// The instances of a group: one, or with slices one per value seen, beside the template of those to come.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Instances {
    pub(crate) cores: Vec<Core>,
    /// Those that count as instances, in the order in which their values were seen.
    pub(crate) seen: Vec<usize>,
    pub(crate) too_many: bool,
}

/// The only instance of the only group, where that is all there is.
#[inline]
pub(crate) fn only<'a>(plans: &'a [Group], groups: &'a mut [Instances]) -> Option<(&'a Group, &'a mut Core)> {
    let ([plan], [Instances { cores, .. }]) = (plans, groups) else { return None };
    let [core] = &mut cores[..] else { return None };
    Some((plan, core))
}

impl Instances {
    pub fn new(plan: &Group, inputs: &Inputs, counters: usize) -> Instances {
        let seen = if plan.at.slices.is_empty() { alloc::vec![0] } else { Vec::new() };
        Instances { cores: alloc::vec![Core::new(plan, inputs, counters)], seen, too_many: false }
    }

    /// Makes instances for values that are seen for the first time: each goes on from where its template stands.
    ///
    /// Any event with the field makes one, since from then on its slice differs from the others; it counts as an instance once the
    /// slice's own event has had the value.
    pub fn make(&mut self, at: &Positions, inputs: &Inputs) {
        for (i, slice) in at.slices.iter().enumerate() {
            for &(event, field) in &slice.hides {
                let Some(state) = inputs.events.get(event) else { continue };
                for value in state.iter().filter_map(|fields| fields.get(field)).filter(|v| **v != Value::Missing) {
                    self.make_for(i, value);
                    if event == slice.event {
                        self.mark(i, value);
                    }
                }
            }
        }
    }

    /// The `i`-th slice's own event had the value.
    fn mark(&mut self, i: usize, value: &Value) {
        for (number, core) in self.cores.iter_mut().enumerate() {
            if core.key[i].as_ref() == Some(value) && !core.is_seen[i] {
                core.is_seen[i] = true;
                if core.is_instance() {
                    self.seen.push(number);
                }
            }
        }
    }

    /// Instances for a value of the `i`-th slice, unless there are some.
    fn make_for(&mut self, i: usize, value: &Value) {
        if self.cores.iter().any(|c| c.key[i].as_ref() == Some(value)) {
            return;
        }
        let templates: Vec<_> = self.cores.iter().filter(|c| c.key[i].is_none()).cloned().collect();
        for mut core in templates {
            if self.cores.len() >= INSTANCES {
                self.too_many = true;
                return;
            }
            core.key[i] = Some(value.clone());
            if let Some(margins) = &mut core.margins {
                margins.share(self.cores.len() + 1);
            }
            self.cores.push(core);
        }
    }
}
