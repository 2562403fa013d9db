//! The instances of a group, under `for each` over the values of events.

use alloc::vec::Vec;

use lapwing_stream::Value;
use serde::{Deserialize, Serialize};

use crate::automaton::Automaton;
use crate::group::Core;
use crate::index::Index;
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
    /// The moves that all of them make.
    #[serde(skip)]
    pub(crate) automaton: Automaton,
    #[serde(skip)]
    index: Index,
    /// A buffer: those that the events of an instant concern.
    #[serde(skip)]
    concerned: Vec<usize>,
}

/// The only instance of the only group, where that is all there is.
#[inline]
pub(crate) fn only<'a>(
    plans: &'a [Group],
    groups: &'a mut [Instances],
) -> Option<(&'a Group, &'a mut Automaton, &'a mut Core)> {
    let ([plan], [Instances { cores, automaton, .. }]) = (plans, groups) else { return None };
    let [core] = &mut cores[..] else { return None };
    Some((plan, automaton, core))
}

impl Instances {
    pub fn new(plan: &Group, inputs: &Inputs, counters: usize) -> Instances {
        Instances {
            cores: alloc::vec![Core::new(plan, inputs, counters)],
            seen: if plan.at.slices.is_empty() { alloc::vec![0] } else { Vec::new() },
            too_many: false,
            automaton: Automaton::default(),
            index: Index::default(),
            concerned: Vec::new(),
        }
    }

    /// Calls with each instance whose position this instant may be: not with those that see none of its events.
    #[inline]
    pub fn for_each_concerned(
        &mut self,
        at: &Positions,
        inputs: &Inputs,
        mut step: impl FnMut(&mut Core, &mut Automaton),
    ) {
        if at.slices.is_empty() || !self.find_concerned(at, inputs) {
            return self.cores.iter_mut().for_each(|core| step(core, &mut self.automaton));
        }
        for &number in &self.concerned {
            if let Some(core) = self.cores.get_mut(number) {
                step(core, &mut self.automaton);
            }
        }
    }

    /// Finds those that see an event of this instant. Returns whether that may be fewer than all.
    #[inline(never)]
    fn find_concerned(&mut self, at: &Positions, inputs: &Inputs) -> bool {
        let (Some(slice), Some(alphabet)) = (at.slices.first(), &at.alphabet) else { return false };
        let Instances { cores, index, concerned, .. } = self;
        index.catch_up(cores);
        concerned.clear();
        concerned.extend(index.others());
        for event in alphabet.iter().filter_map(|&event| inputs.events.get(event).map(|state| (event, state))) {
            let (event, state) = event;
            let field = slice.hides.iter().find(|(hidden, _)| *hidden == event).map(|(_, field)| *field);
            for fields in state.iter() {
                let value = field.and_then(|field| fields.get(field));
                let Some(numbers) = value.and_then(|value| index.with(cores, value)) else { return false };
                concerned.extend(numbers);
            }
            if state.is_unclear {
                return false;
            }
        }
        concerned.sort_unstable();
        concerned.dedup();
        true
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
        let Instances { cores, seen, index, .. } = self;
        index.catch_up(cores);
        let mut mark = |number: usize, cores: &mut [Core]| {
            let core = &mut cores[number];
            if core.key[i].as_ref() == Some(value) && !core.is_seen[i] {
                core.is_seen[i] = true;
                if core.is_instance() {
                    seen.push(number);
                }
            }
        };
        match index.with(cores, value).filter(|_| i == 0) {
            Some(found) => found.iter().for_each(|&number| mark(number, cores)),
            None => (0..cores.len()).for_each(|number| mark(number, cores)),
        }
    }

    /// Instances for a value of the `i`-th slice, unless there are some.
    fn make_for(&mut self, i: usize, value: &Value) {
        self.index.catch_up(&self.cores);
        let found = if i == 0 { self.index.with(&self.cores, value) } else { None };
        let are_some = |core: &Core| core.key[i].as_ref() == Some(value);
        if found.map_or_else(|| self.cores.iter().any(are_some), |found| !found.is_empty()) {
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
