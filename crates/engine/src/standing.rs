//! How things stand of a property while the trace goes on, for whoever acts on it at once: without ending anything, and without a
//! copy of the state.

use serde::{Deserialize, Serialize};

use crate::feed::State;
use crate::group::Core;
use crate::piece::Piece;
use crate::program::{At, Group, Judge, Judged, Program};

/// How things stand of a property, all of its instances together.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Standing {
    /// Whether it has had its position 0 since the trace began, or since time jumped.
    pub started: bool,
    /// How many of its obligations have failed since then. Two equal numbers with an instant between them: none failed there.
    pub failed: u64,
    /// Why nothing is judged any more, where that is so.
    pub given_up: Option<GivenUp>,
}

/// Why a property is not judged any more. Failures that were counted stand.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub enum GivenUp {
    /// A value was of another kind than its formula needs.
    Spoilt,
    /// More runs of obligations were open at once than allowed: [`Program::open_limit`].
    Overflowed,
}

impl State {
    /// How things stand of a property now.
    pub fn standing(&self, program: &Program, property: usize) -> Standing {
        self.piece.standing(program, property)
    }
}

impl Piece {
    fn standing(&self, program: &Program, number: usize) -> Standing {
        let Some(property) = program.properties.get(number) else { return Standing::default() };
        match property.judge {
            Judge::Nobody => Standing::default(),
            Judge::Machine(machine) => self.machines.get(machine).map_or_else(Standing::default, |memory| Standing {
                started: memory.walk.started,
                failed: memory.failed,
                given_up: (!memory.walk.faults.is_empty()).then_some(GivenUp::Spoilt),
            }),
            Judge::Group(group) => {
                let (Some(instances), Some(plan)) = (self.groups.get(group), program.groups.get(group)) else {
                    return Standing::default();
                };
                let mut all = Standing::default();
                instances.look_at_each(|_, core| all = all.join(core.standing(plan, number, self.instants)));
                all
            }
        }
    }
}

impl Core {
    /// A group that rests counts what fails meanwhile only when it wakes: here that is made up for without waking it.
    fn standing(&self, plan: &Group, property: usize, instants: u64) -> Standing {
        let rested = if plan.rests { instants.saturating_sub(self.stepped) } else { 0 };
        let trackers = plan.trackers.iter().zip(&self.trackers).filter(|(tracker, _)| tracker.property == property);
        let mut standing = Standing { started: self.walk.started, ..Standing::default() };
        for (tracker, state) in trackers {
            let fails_at_rest = match (tracker.formula, tracker.at) {
                (Judged::State(formula), At::All) => state.given_up().is_none() && !self.walk.registers.bit(formula),
                _ => false,
            };
            standing.failed += state.failed + if fails_at_rest { rested } else { 0 };
            standing.given_up = standing.given_up.or(state.given_up());
        }
        standing
    }
}

impl Standing {
    fn join(self, other: Standing) -> Standing {
        Standing {
            started: self.started || other.started,
            failed: self.failed + other.failed,
            given_up: self.given_up.or(other.given_up),
        }
    }
}
