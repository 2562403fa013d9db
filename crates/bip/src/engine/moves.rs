//! What changes of ports mean for moves.

use super::look::due;
use super::{Engine, Fault, PortState, computation};
use crate::ast::Urgency;
use crate::code::{Stmt, Table};
use crate::host::Host;
use crate::model::{Atom, Model, Move, Node};
use crate::time::Window;

impl<H: Host> Engine<H> {
    /// A port is in a state; whether it was on before says the caller.
    pub(super) fn port_on(&mut self, model: &Model, id: u32, state: PortState, was_on: bool) {
        let (Some(place), Some(port)) = (self.ports.get_mut(id as usize), model.ports.get(id as usize)) else { return };
        let is_same = was_on && place.window == state.window && place.urgency == state.urgency;
        *place = state;
        if is_same {
            return;
        }
        for id in &port.moves {
            let Some(one) = self.moves.get_mut(*id as usize) else { continue };
            if !was_on {
                one.missing = one.missing.saturating_sub(1);
            }
            if one.missing == 0 {
                self.touch(*id);
            }
        }
    }

    pub(super) fn port_off(&mut self, model: &Model, id: u32) {
        let Some(port) = model.ports.get(id as usize) else { return };
        for id in &port.moves {
            let Some(one) = self.moves.get_mut(*id as usize) else { continue };
            one.missing += 1;
            self.enabled.remove(*id);
        }
    }

    /// Notes that a move has to be looked at again.
    pub(super) fn touch(&mut self, id: u32) {
        if !self.is_dirty.has(id) {
            self.is_dirty.add(id);
            self.dirty.push(id);
        }
    }

    /// Notes the moves whose code reads what an atom shows.
    pub(super) fn touch_coded(&mut self, atom: &Atom) {
        for id in &atom.coded {
            if self.moves.get(*id as usize).is_some_and(|m| m.missing == 0) {
                self.touch(*id);
            }
        }
    }

    /// Looks at the moves again that have been touched.
    pub(super) fn update_moves(&mut self, model: &Model) -> Result<(), Fault> {
        while let Some(id) = self.dirty.pop() {
            self.is_dirty.remove(id);
            let is_complete = self.moves.get(id as usize).is_some_and(|m| m.missing == 0);
            if let Some(one) = model.moves.get(id as usize).filter(|_| is_complete) {
                self.update_move(model, id, one)?;
            }
        }
        Ok(())
    }

    fn update_move(&mut self, model: &Model, id: u32, one: &Move) -> Result<(), Fault> {
        let (mut window, mut urgency) = (Window::ALL, Urgency::Lazy);
        for leaf in &one.leaves {
            if let Some(port) = self.ports.get(*leaf as usize) {
                window = window.and(port.window);
                urgency = urgency.max(port.urgency);
            }
        }
        if let Some(event) = self.next_event(model, id) {
            window = window.and(Window::from(event));
        }
        let holds = !window.is_empty() && self.run_up(model, one)?;
        if let Some(state) = self.moves.get_mut(id as usize) {
            state.window = window;
            state.due = due(window, urgency);
        }
        match holds {
            true => self.enabled.add(id),
            false => self.enabled.remove(id),
        }
        Ok(())
    }

    /// Runs guards and `up` of connectors, those first that others are made of. False where a guard does not hold.
    fn run_up(&mut self, model: &Model, one: &Move) -> Result<bool, Fault> {
        for node in &one.nodes {
            let Some(action) = action(model, node) else { continue };
            let at = Table { cells: &node.cells, objects: &node.objects };
            let path = || model.connectors.get(one.connector as usize).map_or("", |c| c.path.as_str());
            let mut cx = self.context(None);
            if let Some(guard) = &action.guard
                && !guard.eval(at, &mut cx).map_err(computation(path()))?
            {
                return Ok(false);
            }
            Stmt::run(&action.up, at, &mut cx).map_err(computation(path()))?;
        }
        Ok(true)
    }

    /// Runs `down` of connectors, in the opposite order.
    pub(super) fn run_down(&mut self, model: &Model, one: &Move) -> Result<(), Fault> {
        for node in one.nodes.iter().rev() {
            let Some(action) = action(model, node) else { continue };
            let at = Table { cells: &node.cells, objects: &node.objects };
            let path = || model.connectors.get(one.connector as usize).map_or("", |c| c.path.as_str());
            Stmt::run(&action.down, at, &mut self.context(None)).map_err(computation(path()))?;
        }
        Ok(())
    }
}

/// What a connector does in a move.
fn action<'m>(model: &'m Model, node: &Node) -> Option<&'m crate::template::Action> {
    model.connector_types.get(node.ty as usize)?.actions.get(node.action as usize)
}
