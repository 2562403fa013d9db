//! A state of a model, and how it goes on.
//!
//! After each step only what it touched is looked at again: the atoms that took part, of these the ports whose state changed, and of these the
//! moves. A move keeps count of the ports that it still misses, and where it misses none, the window in which it can be made.
//!
//! ```text
//! make ──▶ down ──▶ transitions ──▶ refresh atoms ──▶ ports that changed ──▶ moves that changed
//!                                        ▲
//! settle: actions have been carried out ─┘          look ──▶ offers ──▶ the caller chooses
//! ```

mod atom;
mod event;
mod fault;
mod fire;
mod look;
mod moves;
mod priority;
mod settle;
mod show;
mod table;

pub use fault::Fault;
pub use look::{Offer, Standing};
pub use settle::Violation;
pub(crate) use show::MoveKind;

use crate::ast::Urgency;
use crate::bits::Bits;
use crate::code::{Context, Memory, Trap};
use crate::host::Host;
use crate::model::Model;
use crate::time::{Time, Window};
use crate::value::Value;
use atom::AtomState;
use event::Queue;
use std::sync::Arc;
use table::Tables;

/// What makes one move different from another: its number in the model.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct MoveId(pub(crate) u32);

/// How a model is run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rules {
    /// Whether an interaction can happen although a larger one of its connector can.
    pub without_maximal_progress: bool,
}

/// A model in a state.
pub struct Engine<H> {
    model: Arc<Model>,
    host: H,
    rules: Rules,
    now: i64,
    memory: Memory,
    atoms: Vec<AtomState>,
    ports: Vec<PortState>,
    moves: Vec<MoveState>,
    /// Moves that miss no port and whose guards hold, whenever their windows are.
    enabled: Bits,
    /// Moves that have to be looked at again.
    dirty: Vec<u32>,
    is_dirty: Bits,
    /// Atoms whose invariants bound time.
    bounded: Bits,
    /// What the invariants of each atom allow.
    bounds: Vec<Window>,
    /// Atoms whose ports change when time merely passes.
    changing: Bits,
    /// Atoms that wait for the end of an action.
    pending: Vec<u32>,
    queues: Vec<Queue>,
    tables: Tables,
    scratch: Scratch,
}

/// A port of an atom that is on.
#[derive(Clone, Copy, Debug)]
struct PortState {
    window: Window,
    urgency: Urgency,
    /// The transition: its place among those of the marking.
    here: u32,
}

/// What an engine knows of a move.
#[derive(Clone, Copy, Debug)]
struct MoveState {
    window: Window,
    /// Until when it lets time pass, if it is not over then; as late as now where this has passed.
    due: i64,
    /// How many ports, or events, are missing.
    missing: u32,
}

/// Lists that are filled anew in each step: kept, so that a step needs no memory.
#[derive(Default)]
struct Scratch {
    found: Vec<atom::Found>,
    live: Vec<u32>,
    offers: Vec<Offer>,
    masks: Vec<Window>,
    active: Vec<bool>,
    reached: Vec<u32>,
    /// Inner moves that are seen outside of their compounds.
    seen: Bits,
    wait: Option<Window>,
}

impl<H: Host> Engine<H> {
    /// A model at its beginning: its variables have their first values, and its initial actions have been done.
    ///
    /// # Errors
    /// Where an initial action fails, or the initial state breaks a rule of the language.
    pub fn new(model: Arc<Model>, host: H, rules: Rules) -> Result<Engine<H>, Fault> {
        let port = PortState { window: Window::NONE, urgency: Urgency::Lazy, here: u32::MAX };
        let missing = |(id, m): (usize, &crate::model::Move)| MoveState {
            window: Window::NONE,
            due: i64::MAX,
            // An external port misses an event as well.
            missing: m.leaves.len() as u32
                + u32::from((model.first_external..model.first_inner).contains(&(id as u32))),
        };
        let mut engine = Engine {
            host,
            rules,
            now: 0,
            memory: model.memory.clone(),
            atoms: model.atoms.iter().map(|a| AtomState::new(&model, a)).collect(),
            ports: vec![port; model.ports.len()],
            moves: model.moves.iter().enumerate().map(missing).collect(),
            enabled: Bits::new(model.moves.len()),
            dirty: Vec::with_capacity(model.moves.len()),
            is_dirty: Bits::new(model.moves.len()),
            bounded: Bits::new(model.atoms.len()),
            bounds: vec![Window::ALL; model.atoms.len()],
            changing: Bits::new(model.atoms.len()),
            pending: Vec::new(),
            queues: (model.first_external..model.first_inner).map(|_| Queue::default()).collect(),
            tables: Tables::new(&model),
            scratch: Scratch { seen: Bits::new(model.moves.len()), ..Scratch::default() },
            model,
        };
        engine.begin()?;
        Ok(engine)
    }

    fn begin(&mut self) -> Result<(), Fault> {
        let model = Arc::clone(&self.model);
        for atom in 0..model.atoms.len() as u32 {
            self.begin_atom(&model, atom)?;
        }
        for atom in 0..model.atoms.len() as u32 {
            self.refresh(&model, atom)?;
        }
        self.update_moves(&model)
    }

    /// Model time: that of the last step.
    pub fn now(&self) -> Time {
        Time(self.now)
    }

    /// The model that runs.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Who answers the calls of external functions.
    pub fn host(&self) -> &H {
        &self.host
    }

    /// Who answers the calls of external functions.
    pub fn host_mut(&mut self) -> &mut H {
        &mut self.host
    }

    /// The places of an atom that are marked.
    pub fn places(&self, atom: u32) -> Vec<&str> {
        let Some(state) = self.atoms.get(atom as usize) else { return Vec::new() };
        let ty = self.model.atoms.get(atom as usize).and_then(|a| self.model.atom_type(a));
        let places = ty.map_or(&[][..], |t| t.places.as_slice());
        state.marking.iter().filter_map(|place| places.get(place as usize)).map(String::as_str).collect()
    }

    /// A variable of an atom, or a parameter.
    pub fn variable(&self, atom: u32, name: &str) -> Option<Value> {
        let atom = self.model.atoms.get(atom as usize)?;
        let var = self.model.atom_type(atom)?.frame.vars.iter().find(|v| v.name == name)?;
        let base = if var.ty.is_plain() { atom.base.cells } else { atom.base.objects };
        Some(self.memory.get(var.ty, base + var.slot))
    }

    /// What code of an atom or a connector runs in.
    fn context(&mut self, atom: Option<u32>) -> Context<'_> {
        Context { memory: &mut self.memory, host: &mut self.host, atom, now: self.now }
    }
}

/// Code that came to nothing, as a fault of whoever it belongs to.
fn computation(path: &str) -> impl FnOnce(Box<Trap>) -> Fault + '_ {
    move |trap| Fault::Computation { whose: path.to_owned(), what: trap.what, at: trap.at }
}
