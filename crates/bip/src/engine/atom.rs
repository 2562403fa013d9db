//! What an atom shows: which of its ports are on, when, and how pressing they are.

use super::table::Table;
use super::{Engine, Fault, PortState, computation};
use crate::ast::Urgency;
use crate::bits::{Bits, ones};
use crate::code::Guard;
use crate::host::Host;
use crate::model::{Atom, Model};
use crate::template;
use crate::time::Window;
use std::sync::Arc;

/// The state of an atom, its variables aside.
pub(super) struct AtomState {
    pub marking: Bits,
    pub table: Option<Arc<Table>>,
    /// Ports that are on.
    pub on: Bits,
    /// Of these those whose state comes from a guard.
    pub guarded: Bits,
    /// Within which moments the action that is being carried out has to come to its end.
    pub resume: Option<Window>,
    /// When its ports have to be looked at again although nothing happened.
    pub changes_at: i64,
}

/// A transition that a guard lets through.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub port: u32,
    pub window: Window,
    pub urgency: Urgency,
    pub here: u32,
}

impl AtomState {
    pub fn new(model: &Model, atom: &Atom) -> AtomState {
        let (ports, places) = model.atom_type(atom).map_or((0, 0), |t| (t.ports.len(), t.places.len()));
        AtomState {
            marking: Bits::new(places),
            table: None,
            on: Bits::new(ports),
            guarded: Bits::new(ports),
            resume: None,
            changes_at: i64::MAX,
        }
    }
}

impl<H: Host> Engine<H> {
    /// Looks at an atom again: its invariants, and its ports.
    pub(super) fn refresh(&mut self, model: &Model, id: u32) -> Result<(), Fault> {
        let Some(atom) = model.atoms.get(id as usize) else { return Ok(()) };
        let Some(ty) = model.atom_type(atom) else { return Ok(()) };
        let Some(table) = self.atoms.get(id as usize).and_then(|s| s.table.clone()) else { return Ok(()) };
        self.check_invariants(atom, ty, &table, id)?;
        let mut found = std::mem::take(&mut self.scratch.found);
        found.clear();
        let is_stable = self.atoms.get(id as usize).is_some_and(|s| s.resume.is_none());
        let result = match is_stable {
            true => self.find(atom, ty, &table, id, &mut found),
            false => Ok(()),
        };
        if result.is_ok() {
            let by_rule = !ty.priorities.is_empty() && is_stable;
            if by_rule {
                self.find_plain(&table, &mut found);
                let ruled = self.apply_priorities(atom, ty, id, &mut found);
                self.show_ports(model, id, None, &found);
                self.scratch.found = found;
                return ruled.map(|()| self.touch_coded(atom));
            }
            self.show_ports(model, id, is_stable.then_some(&*table), &found);
            self.touch_coded(atom);
        }
        self.scratch.found = found;
        result
    }

    fn check_invariants(&mut self, atom: &Atom, ty: &template::Atom, table: &Table, id: u32) -> Result<(), Fault> {
        if ty.invariants.is_empty() {
            return Ok(());
        }
        let mut window = Window::ALL;
        for invariant in table.invariants.iter().filter_map(|i| ty.invariants.get(*i as usize)) {
            let mut cx = self.context(Some(id));
            let one = invariant.guard.window(atom.base, &mut cx).map_err(computation(&atom.path))?;
            if one.is_empty() && invariant.guard.fails(atom.base, &mut cx).map_err(computation(&atom.path))? {
                return Err(Fault::Invariant { atom: atom.path.clone(), name: invariant.name.clone() });
            }
            window = window.and(one);
        }
        if let Some(bound) = self.bounds.get_mut(id as usize) {
            *bound = window;
        }
        match window == Window::ALL {
            true => self.bounded.remove(id),
            false => self.bounded.add(id),
        }
        Ok(())
    }

    /// The transitions that guards let through, now or later: of each port the one whose window comes first.
    fn find(
        &mut self,
        atom: &Atom,
        ty: &template::Atom,
        table: &Table,
        id: u32,
        found: &mut Vec<Found>,
    ) -> Result<(), Fault> {
        let clash = |port: u32| Fault::NonDeterministic {
            atom: atom.path.clone(),
            port: ty.ports.get(port as usize).map(|p| p.name.clone()),
        };
        if let Some(port) = table.clash {
            return Err(clash(port));
        }
        let mut changes_at = i64::MAX;
        for here in &table.guarded {
            let transition = table.here.get(*here as usize).and_then(|t| ty.transitions.get(*t as usize));
            let Some((transition, port)) = transition.and_then(|t| Some((t, t.port?))) else { continue };
            let window = self.window(atom, id, transition.guard.as_ref())?;
            if window.is_empty() || window.last < self.now {
                continue;
            }
            let one = Found { port, window, urgency: transition.urgency, here: *here };
            if table.plain_ports.has(port) {
                return Err(clash(port));
            }
            match found.iter_mut().find(|f| f.port == port) {
                None => found.push(one),
                Some(other) if !other.window.and(window).is_empty() => return Err(clash(port)),
                Some(other) => {
                    // Two transitions of a port, one after the other: the later one is looked for when its time has come.
                    let (first, later) = if other.window.first < window.first { (*other, one) } else { (one, *other) };
                    changes_at = changes_at.min(later.window.first);
                    *other = first;
                }
            }
        }
        self.set_change(id, changes_at);
        Ok(())
    }

    /// Notes when the ports of an atom have to be looked at again.
    pub(super) fn set_change(&mut self, id: u32, at: i64) {
        if let Some(state) = self.atoms.get_mut(id as usize) {
            state.changes_at = at;
        }
        match at == i64::MAX {
            true => self.changing.remove(id),
            false => self.changing.add(id),
        }
    }

    fn window(&mut self, atom: &Atom, id: u32, guard: Option<&Guard>) -> Result<Window, Fault> {
        match guard {
            None => Ok(Window::ALL),
            Some(guard) => guard.window(atom.base, &mut self.context(Some(id))).map_err(computation(&atom.path)),
        }
    }

    /// The transitions that are always possible, as ones that a guard lets through: priorities may forbid them.
    fn find_plain(&self, table: &Table, found: &mut Vec<Found>) {
        let all =
            |(port, here): &(u32, u32)| Found { port: *port, window: Window::ALL, urgency: Urgency::Lazy, here: *here };
        found.extend(table.plain.iter().map(all));
        found.sort_by_key(|f| f.port);
    }

    /// Makes the ports of an atom those that were found, and those that a table says are always possible. What is as it was is passed over.
    fn show_ports(&mut self, model: &Model, id: u32, table: Option<&Table>, found: &[Found]) {
        let Some(first) = model.atoms.get(id as usize).map(|a| a.first_port) else { return };
        let words = self.atoms.get(id as usize).map_or(0, |s| s.on.words());
        for place in 0..words {
            let Some(state) = self.atoms.get_mut(id as usize) else { return };
            let plain = table.map_or(0, |t| t.plain_ports.word(place));
            let in_word = |f: &&Found| f.port as usize / 64 == place;
            let by_guard = found.iter().filter(in_word).fold(0_u64, |word, f| word | 1 << (f.port % 64));
            let (on, guarded) = (state.on.word(place), state.guarded.word(place));
            let gone = on & !(plain | by_guard);
            let fresh = plain & !(on & !guarded);
            for port in ones(gone, place) {
                state.on.remove(port);
                state.guarded.remove(port);
            }
            for port in ones(fresh, place) {
                state.on.add(port);
                state.guarded.remove(port);
            }
            for port in ones(by_guard, place) {
                state.on.add(port);
                state.guarded.add(port);
            }
            for port in ones(gone, place) {
                self.port_off(model, first + port);
            }
            let always = PortState { window: Window::ALL, urgency: Urgency::Lazy, here: u32::MAX };
            for port in ones(fresh, place) {
                self.port_on(model, first + port, always, on >> (port % 64) & 1 == 1);
            }
            for f in found.iter().filter(in_word) {
                let state = PortState { window: f.window, urgency: f.urgency, here: f.here };
                self.port_on(model, first + f.port, state, on >> (f.port % 64) & 1 == 1);
            }
        }
    }

    /// The transition that a port stands for: its place among those of the marking.
    pub(super) fn transition_of(&self, atom: u32, port: u32, id: u32) -> Option<u32> {
        let state = self.atoms.get(atom as usize)?;
        if state.guarded.has(port) {
            return self.ports.get(id as usize).map(|p| p.here);
        }
        state.table.as_ref()?.plain(port)
    }
}
