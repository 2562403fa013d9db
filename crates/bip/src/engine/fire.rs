//! Making a move: data goes down, atoms make their transitions.

use super::{Engine, Fault, MoveId, computation};
use crate::code::Stmt;
use crate::host::Host;
use crate::model::{Atom, Model};
use crate::template::Transition;
use crate::time::{Time, Window};
use std::sync::Arc;

/// How many internal transitions an atom may take in a row.
const MAX_INTERNAL: usize = 100_000;

impl<H: Host> Engine<H> {
    /// Makes a move at a moment: one that [`Engine::look`] has offered, within its window.
    ///
    /// The actions of its atoms are carried out. Atoms whose actions end only later (`resume`) show nothing until [`Engine::settle`] is called.
    ///
    /// # Errors
    /// Where an action fails, where the state afterwards breaks a rule of the language, and where the move is not possible then.
    pub fn make(&mut self, id: MoveId, at: Time) -> Result<(), Fault> {
        let offered = self.scratch.offers.iter().find(|o| o.id == id).is_some_and(|o| o.window.holds(at.0));
        if !offered {
            return Err(Fault::NotOffered);
        }
        let model = Arc::clone(&self.model);
        let Some(one) = model.moves.get(id.0 as usize) else { return Err(Fault::NotOffered) };
        self.scratch.offers.clear();
        self.now = at.0;
        self.run_down(&model, one)?;
        self.take_event(&model, id.0);
        for leaf in &one.leaves {
            let Some(port) = model.ports.get(*leaf as usize) else { continue };
            if let Some(here) = self.transition_of(port.atom, port.index, *leaf) {
                self.fire(&model, port.atom, here)?;
                self.run_internal(&model, port.atom)?;
            }
        }
        for leaf in &one.leaves {
            if let Some(port) = model.ports.get(*leaf as usize) {
                self.refresh(&model, port.atom)?;
            }
        }
        self.update_moves(&model)
    }

    /// An atom at its beginning.
    pub(super) fn begin_atom(&mut self, model: &Model, id: u32) -> Result<(), Fault> {
        let Some(atom) = model.atoms.get(id as usize) else { return Ok(()) };
        let Some(ty) = model.atom_type(atom) else { return Ok(()) };
        let mut cx = self.context(Some(id));
        Stmt::run(&ty.init, atom.base, &mut cx).map_err(computation(&atom.path))?;
        Stmt::run(&ty.begin, atom.base, &mut cx).map_err(computation(&atom.path))?;
        if let Some(state) = self.atoms.get_mut(id as usize) {
            ty.initial.iter().for_each(|place| state.marking.add(*place));
            state.table = Some(self.tables.get(atom.ty, ty, &state.marking));
        }
        if let Some(resume) = &ty.begin_resume {
            let window = resume.window(atom.base, &mut self.context(Some(id))).map_err(computation(&atom.path))?;
            self.suspend(id, window);
        }
        self.run_internal(model, id)
    }

    /// Makes a transition of an atom: the one at that place among those of its marking.
    fn fire(&mut self, model: &Model, id: u32, here: u32) -> Result<(), Fault> {
        let Some(atom) = model.atoms.get(id as usize) else { return Ok(()) };
        let Some(ty) = model.atom_type(atom) else { return Ok(()) };
        let table = self.atoms.get(id as usize).and_then(|s| s.table.as_ref());
        let transition = table.and_then(|t| t.here.get(here as usize)).and_then(|t| ty.transitions.get(*t as usize));
        let Some(transition) = transition else { return Ok(()) };
        if !transition.body.is_empty() {
            let mut cx = self.context(Some(id));
            Stmt::run(&transition.body, atom.base, &mut cx).map_err(computation(&atom.path))?;
        }
        if transition.from != transition.to {
            self.mark(atom, ty, id, transition)?;
        }
        if let Some(resume) = &transition.resume {
            let window = resume.window(atom.base, &mut self.context(Some(id))).map_err(computation(&atom.path))?;
            self.suspend(id, window);
        }
        Ok(())
    }

    fn mark(&mut self, atom: &Atom, ty: &crate::template::Atom, id: u32, transition: &Transition) -> Result<(), Fault> {
        let Some(state) = self.atoms.get_mut(id as usize) else { return Ok(()) };
        for place in &transition.from {
            state.marking.remove(*place);
        }
        for place in &transition.to {
            if state.marking.has(*place) {
                let place = ty.places.get(*place as usize).cloned().unwrap_or_default();
                return Err(Fault::NotSafe { atom: atom.path.clone(), place });
            }
            state.marking.add(*place);
        }
        state.table = Some(self.tables.get(atom.ty, ty, &state.marking));
        Ok(())
    }

    /// An atom waits for the end of its action.
    fn suspend(&mut self, id: u32, window: Window) {
        if let Some(state) = self.atoms.get_mut(id as usize) {
            state.resume = Some(window);
        }
        if !self.pending.contains(&id) {
            self.pending.push(id);
        }
    }

    /// Takes internal transitions until there is none left to take.
    fn run_internal(&mut self, model: &Model, id: u32) -> Result<(), Fault> {
        let Some(atom) = model.atoms.get(id as usize) else { return Ok(()) };
        let Some(ty) = model.atom_type(atom) else { return Ok(()) };
        for _ in 0..MAX_INTERNAL {
            let Some(table) = self.atoms.get(id as usize).and_then(|s| s.table.clone()) else { return Ok(()) };
            let mut chosen = None;
            for here in &table.internals {
                let transition = table.here.get(*here as usize).and_then(|t| ty.transitions.get(*t as usize));
                let guard = transition.and_then(|t| t.guard.as_ref());
                let window = match guard {
                    None => Window::ALL,
                    Some(guard) => {
                        guard.window(atom.base, &mut self.context(Some(id))).map_err(computation(&atom.path))?
                    }
                };
                if window.holds(self.now) && chosen.replace(*here).is_some() {
                    return Err(Fault::NonDeterministic { atom: atom.path.clone(), port: None });
                }
            }
            match chosen {
                Some(here) => self.fire(model, id, here)?,
                None => return Ok(()),
            }
        }
        Err(Fault::Endless { atom: atom.path.clone() })
    }
}
