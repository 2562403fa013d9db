//! What it takes to take in rows of truth values by a comparison with the row before: see [`crate::skim`].

use alloc::vec::Vec;

use crate::inputs::Due;
use crate::skim::Row;

use super::wiring::bits;
use super::{Clock, Node, Program, Slot, Wake};

/// For so few columns it is worked out beforehand what each set of them makes due.
const FEW: usize = 6;

/// How rows of truth values are taken in, where all of a program is one group that may rest.
#[derive(Clone, Debug)]
pub struct Skim {
    /// What each column makes due where it toggles.
    each: Vec<Due>,
    /// What each set of columns does, where they are few: the sets are the numbers of a word.
    sets: Vec<Due>,
    /// The operators that are judged, as bits.
    verdicts: u64,
}

impl Skim {
    /// Nothing where the program has more to do at a row than to step its group, or rows are not of truth values: nobody compares those.
    pub(super) fn of(program: &Program) -> Option<Skim> {
        let Program { groups, slots, columns, machines, properties, .. } = program;
        let waits = program.clock != Clock::Events || program.timeout.is_some() || !machines.is_empty();
        let minds = program.counts_values() || properties.iter().any(|property| !property.stale.is_empty());
        let [group] = &groups[..] else { return None };
        let compares = group.at.nodes.iter().any(|node| matches!(node, Node::Compare { .. } | Node::CompareAny { .. }));
        // Each column fills the slot of its own number, and there are no others.
        let fills = columns.iter().map(|column| column.slot).eq(0..slots.len());
        if waits
            || minds
            || compares
            || !group.at.ages.is_empty()
            || !fills
            || !group.rests
            || !group.at.slices.is_empty()
            || !(1..=Row::COLUMNS).contains(&columns.len())
        {
            return None;
        }
        let due = |slot: &Slot| together(slot.wakes.iter().map(Due::from));
        let each: Vec<Due> = slots.iter().map(due).collect();
        let count = if each.len() <= FEW { 1 << each.len() } else { 0 };
        let sets = (0..count).map(|set| of_set(&each, set)).collect();
        Some(Skim { each, sets, verdicts: group.heard })
    }

    /// Whether the verdicts are the same where the registers hold these words.
    #[inline(always)]
    pub(crate) fn is_same(&self, a: u64, b: u64) -> bool {
        (a ^ b) & self.verdicts == 0
    }

    /// What is due where these columns toggle.
    #[inline(always)]
    pub(crate) fn due(&self, toggled: u64) -> Due {
        let known = usize::try_from(toggled).ok().and_then(|set| self.sets.get(set));
        known.map_or_else(|| of_set(&self.each, toggled), |due| *due)
    }
}

fn of_set(each: &[Due], set: u64) -> Due {
    together(bits(set).filter_map(|i| each.get(i).copied()))
}

fn together(all: impl Iterator<Item = Due>) -> Due {
    all.fold(Due::default(), Due::and)
}

impl From<&Wake> for Due {
    fn from(wake: &Wake) -> Due {
        Due { ops: wake.ops, letter: wake.letter }
    }
}
