//! The end of actions: whether they took no longer than the model allows.

use super::{Engine, Fault, MoveId, MoveState};
use crate::host::Host;
use crate::model::Model;
use crate::time::{Time, Window};
use std::sync::Arc;

/// Something that had to be over before it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Violation {
    /// An action ended outside of its `resume`.
    Resume {
        /// The atom.
        atom: u32,
        /// When it had to end.
        window: Window,
    },
    /// Time went on further than an atom's invariants allow.
    Invariant {
        /// The atom.
        atom: u32,
        /// What they allow.
        window: Window,
    },
    /// Time went on further than a pressing move allows.
    Deadline {
        /// The move.
        id: MoveId,
        /// When it can be made.
        window: Window,
    },
}

impl<H: Host> Engine<H> {
    /// The actions of the last step have been carried out, and by the clock outside it is so late. In simulated time it is as late as the model
    /// says: `settle(engine.now(), 0)`.
    ///
    /// Atoms that waited for the end of their actions go on, and with them model time goes on to that moment. What of it came too late is
    /// listed. A deadline or an invariant that is missed by at most `tolerance` nanoseconds is not, since no clock wakes anyone to the
    /// nanosecond; and a deadline that had come already when the step was made is not missed by the time that the step took.
    ///
    /// # Errors
    /// Where the state breaks a rule of the language now that ports show what they can do.
    pub fn settle(&mut self, actual: Time, tolerance: i64) -> Result<Vec<Violation>, Fault> {
        let late = actual.0.saturating_sub(tolerance);
        let mut violations = Vec::new();
        for atom in &self.pending {
            let Some(state) = self.atoms.get(*atom as usize) else { continue };
            if let Some(window) = state.resume.filter(|w| !w.holds(actual.0)) {
                violations.push(Violation::Resume { atom: *atom, window });
            }
        }
        if late > self.now {
            let model = Arc::clone(&self.model);
            self.judge_inner(&model);
            self.missed(&model, late, &mut violations);
        }
        if !self.pending.is_empty() {
            self.resume(actual.0)?;
        }
        Ok(violations)
    }

    /// Invariants and deadlines that are over at a moment.
    fn missed(&mut self, model: &Model, late: i64, violations: &mut Vec<Violation>) {
        for atom in self.bounded.iter() {
            if let Some(window) = self.bounds.get(atom as usize).copied().filter(|w| late > w.last) {
                violations.push(Violation::Invariant { atom, window });
            }
        }
        let is_missed = |one: &MoveState| one.window.last >= self.now && one.due > self.now && one.due < late;
        let ids = self.enabled.iter().take_while(|id| *id < model.first_inner);
        let moves = ids.filter_map(|id| Some((id, *self.moves.get(id as usize)?)));
        let missed: Vec<(u32, MoveState)> = moves.filter(|(_, one)| is_missed(one)).collect();
        for (id, one) in missed {
            if !self.is_hidden(model, id) {
                violations.push(Violation::Deadline { id: MoveId(id), window: one.window });
            }
        }
    }

    /// Atoms whose actions have been carried out show their ports again.
    fn resume(&mut self, actual: i64) -> Result<(), Fault> {
        let model = Arc::clone(&self.model);
        self.now = self.now.max(actual);
        let mut pending = std::mem::take(&mut self.pending);
        for atom in &pending {
            if let Some(state) = self.atoms.get_mut(*atom as usize) {
                state.resume = None;
            }
        }
        for atom in &pending {
            self.refresh(&model, *atom)?;
        }
        pending.clear();
        self.pending = pending;
        self.update_moves(&model)
    }

    /// Whether an atom waits for the end of its action.
    pub fn is_unsettled(&self) -> bool {
        !self.pending.is_empty()
    }

    /// A violation as a line of the log: `ROOT.A resume [ -INFTY, 7s ]`.
    pub fn show_violation(&self, violation: &Violation) -> String {
        let path = |atom: u32| self.model.atoms.get(atom as usize).map_or("", |a| a.path.as_str());
        match violation {
            Violation::Resume { atom, window } => format!("{} resume {window}", path(*atom)),
            Violation::Invariant { atom, window } => format!("{} invariant {window}", path(*atom)),
            Violation::Deadline { id, window } => format!("{} {window}", self.show_move(*id)),
        }
    }

    /// Whose violation it is: `ROOT.A`.
    pub fn violator(&self, violation: &Violation) -> String {
        match violation {
            Violation::Resume { atom, .. } | Violation::Invariant { atom, .. } => {
                self.model.atoms.get(*atom as usize).map_or_else(String::new, |a| a.path.clone())
            }
            Violation::Deadline { id, .. } => self.move_path(*id),
        }
    }
}
