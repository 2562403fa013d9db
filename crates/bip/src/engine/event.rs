//! What comes in through external ports.

use super::{Engine, Fault};
use crate::ast::EventPolicy;
use crate::host::Host;
use crate::model::{External, Model};
use crate::time::Time;
use crate::value::Value;
use std::collections::VecDeque;
use std::sync::Arc;

/// Events that wait at a port, the oldest first.
#[derive(Debug, Default)]
pub(super) struct Queue {
    events: VecDeque<(i64, Vec<Value>)>,
}

/// How many events wait at a port at most.
const MAX_EVENTS: usize = 1 << 16;

impl<H: Host> Engine<H> {
    /// Something happened outside: the atom may react from that moment on. Values are given to the variables of the port, in their
    /// order; missing ones leave theirs as they are.
    ///
    /// What becomes of an event for which the atom does not wait is a matter of the port: it is kept, or it is ignored, or it is an error.
    /// An atom that waits for the end of an action does not count as waiting for events.
    ///
    /// # Errors
    /// Where the port takes no event then, and where too many wait.
    pub fn notify(&mut self, external: External, values: &[Value], at: Time) -> Result<(), Fault> {
        let model = Arc::clone(&self.model);
        let id = model.first_external + external.0;
        let Some(leaf) = model.moves.get(id as usize).and_then(|m| m.leaves.first().copied()) else { return Ok(()) };
        let Some((_, port)) = model.port(leaf) else { return Ok(()) };
        let waits = self.is_on(&model, leaf);
        match port.external {
            Some(EventPolicy::Ignore) if !waits => return Ok(()),
            Some(EventPolicy::Error) if !waits => {
                return Err(Fault::UnexpectedEvent { port: model.port_path(leaf), at });
            }
            _ => {}
        }
        let Some(queue) = self.queues.get_mut(external.0 as usize) else { return Ok(()) };
        if queue.events.len() >= MAX_EVENTS {
            return Err(Fault::TooManyEvents { port: model.port_path(leaf) });
        }
        queue.events.push_back((at.0, values.to_vec()));
        if queue.events.len() == 1
            && let Some(state) = self.moves.get_mut(id as usize)
        {
            state.missing = state.missing.saturating_sub(1);
            if state.missing == 0 {
                self.touch(id);
            }
        }
        self.update_moves(&model)
    }

    /// Whether some atom waits for an event: where nothing else is possible, the run is not at its end then.
    pub fn awaits_events(&self) -> bool {
        let range = self.model.first_external as usize..self.model.first_inner as usize;
        let externals = self.model.moves.get(range).unwrap_or(&[]);
        externals.iter().flat_map(|m| m.leaves.iter()).any(|leaf| self.is_on(&self.model, *leaf))
    }

    fn is_on(&self, model: &Model, leaf: u32) -> bool {
        let Some(port) = model.ports.get(leaf as usize) else { return false };
        self.atoms.get(port.atom as usize).is_some_and(|a| a.on.has(port.index))
    }

    fn queue(&self, model: &Model, id: u32) -> Option<usize> {
        id.checked_sub(model.first_external).map(|at| at as usize)
    }

    /// When the event came that the move of an external port would take.
    pub(super) fn next_event(&self, model: &Model, id: u32) -> Option<i64> {
        self.queues.get(self.queue(model, id)?)?.events.front().map(|(at, _)| *at)
    }

    /// Takes the event of the move of an external port, if it is one: its values are the atom's now.
    pub(super) fn take_event(&mut self, model: &Model, id: u32) {
        let Some(queue) = self.queue(model, id).and_then(|at| self.queues.get_mut(at)) else { return };
        let Some((_, values)) = queue.events.pop_front() else { return };
        let is_empty = queue.events.is_empty();
        let leaf = model.moves.get(id as usize).and_then(|m| m.leaves.first());
        if let Some((atom, port)) = leaf.and_then(|leaf| model.port(*leaf)) {
            for (var, value) in port.vars.iter().zip(&values) {
                let base = if var.ty.is_plain() { atom.base.cells } else { atom.base.objects };
                self.memory.set(var.ty, base + var.slot, value);
            }
        }
        if is_empty {
            if let Some(state) = self.moves.get_mut(id as usize) {
                state.missing += 1;
            }
            self.enabled.remove(id);
        } else {
            self.touch(id);
        }
    }
}
