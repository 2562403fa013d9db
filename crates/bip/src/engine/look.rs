//! What is possible: how long time may pass, and what can be made within that.

use super::{Engine, Fault, MoveId};
use crate::ast::Urgency;
use crate::host::Host;
use crate::model::Model;
use crate::time::{Time, Window};
use std::sync::Arc;

/// A move, and when it can be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Offer {
    /// The move.
    pub id: MoveId,
    /// When it can be made, as things stand now.
    pub window: Window,
}

/// How a state stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// Something is possible: see [`Engine::offers`].
    Open,
    /// Nothing is possible, now or later.
    Deadlock,
    /// Nothing is possible, and time may not pass either.
    TimeLock {
        /// The last moment, or the first that cannot be reached.
        at: Time,
        /// Whether that moment cannot be reached.
        before: bool,
    },
}

/// Until when a move lets time pass, as long as it is not over.
///
/// What is eager may not wait while it is possible, nor step over the end at which it becomes possible; what is delayable may not wait
/// beyond its last moment, if it has one.
pub(super) fn due(window: Window, urgency: Urgency) -> i64 {
    match urgency {
        Urgency::Delayable if !window.open_right => window.last,
        Urgency::Lazy | Urgency::Delayable => i64::MAX,
        Urgency::Eager => window.left(),
    }
}

impl<H> Engine<H> {
    /// What is possible, in the order of the model: what [`Engine::look`] has found, until the next step.
    pub fn offers(&self) -> &[Offer] {
        &self.scratch.offers
    }
}

impl<H: Host> Engine<H> {
    /// Looks at the state: what is possible is in [`Engine::offers`] afterwards.
    ///
    /// # Errors
    /// Where priorities go in a circle, and where a guard fails.
    pub fn look(&mut self) -> Result<Standing, Fault> {
        let model = Arc::clone(&self.model);
        loop {
            let wait = self.wait(&model);
            // Before ports change by themselves, nothing that comes later can be promised.
            let change = self.next_change().filter(|at| *at <= wait.last);
            let until = change.map_or(wait, |at| wait.and(Window::until(at - 1)));
            self.offer(&model, until)?;
            if !self.scratch.offers.is_empty() {
                self.scratch.wait = Some(wait);
                return Ok(Standing::Open);
            }
            match change {
                Some(at) => self.pass(&model, at)?,
                None => {
                    self.scratch.wait = Some(wait);
                    return Ok(standing(wait, self.now));
                }
            }
        }
    }

    /// Until when time may pass without a step, as [`Engine::look`] has found it; [`Time::MAX`] where there is no limit.
    pub fn patience(&self) -> Time {
        Time(self.scratch.wait.map_or(i64::MAX, |w| w.last))
    }

    /// Moments until which time may pass.
    fn wait(&mut self, model: &Model) -> Window {
        self.judge_inner(model);
        let mut live = std::mem::take(&mut self.scratch.live);
        live.clear();
        // PERF: all that is enabled is looked at in every step, so this is as short as can be (example `steps`).
        let mut due = i64::MAX;
        for id in self.enabled.iter() {
            let Some(one) = self.moves.get(id as usize).filter(|one| one.window.last >= self.now) else { continue };
            live.push(id);
            due = due.min(one.due);
        }
        if (model.first_inner as usize) < model.moves.len() {
            due = self.without_hidden(model, &mut live);
        }
        self.scratch.live = live;
        let last = if due == i64::MAX { due } else { due.max(self.now) };
        let mut wait = Window { last, ..Window::from(self.now) };
        for atom in self.bounded.iter() {
            if let Some(bound) = self.bounds.get(atom as usize)
                && (bound.last <= wait.last || bound.first > wait.first)
            {
                wait = wait.and(*bound);
            }
        }
        wait
    }

    /// Takes away inner moves, and those that are not seen. Gives the moment until which the others let time pass.
    fn without_hidden(&mut self, model: &Model, live: &mut Vec<u32>) -> i64 {
        live.retain(|id| *id < model.first_inner && !self.is_hidden(model, *id));
        let due = |id: &u32| self.moves.get(*id as usize).map_or(i64::MAX, |one| one.due);
        live.iter().map(due).min().unwrap_or(i64::MAX)
    }

    /// When ports of some atom change although nothing happens.
    fn next_change(&self) -> Option<i64> {
        self.changing.iter().filter_map(|atom| self.atoms.get(atom as usize)).map(|a| a.changes_at).min()
    }

    /// Lets time pass to the moment at which ports change.
    fn pass(&mut self, model: &Model, at: i64) -> Result<(), Fault> {
        self.now = self.now.max(at);
        let due: Vec<u32> = self.changing.iter().collect();
        for atom in due {
            if self.atoms.get(atom as usize).is_some_and(|a| a.changes_at <= self.now) {
                self.refresh(model, atom)?;
            }
        }
        self.update_moves(model)
    }

    /// Lists the moves that can be made while time may pass.
    fn offer(&mut self, model: &Model, wait: Window) -> Result<(), Fault> {
        self.scratch.offers.clear();
        if !model.rules.is_empty() {
            self.judge_rules(model)?;
        }
        let live = std::mem::take(&mut self.scratch.live);
        for (place, id) in live.iter().enumerate() {
            let Some(mut window) = self.moves.get(*id as usize).map(|m| m.window) else { continue };
            if window.first > wait.last {
                continue;
            }
            if model.moves.get(*id as usize).is_some_and(|m| m.has_rivals) {
                window = self.left_by_rivals(model, &live, place, window);
            }
            let window = window.and(wait);
            if !window.is_empty() {
                self.scratch.offers.push(Offer { id: MoveId(*id), window });
            }
        }
        self.scratch.live = live;
        Ok(())
    }
}

fn standing(wait: Window, now: i64) -> Standing {
    match wait.last {
        i64::MAX => Standing::Deadlock,
        // Invariants may forbid this very moment.
        _ => Standing::TimeLock { at: Time(wait.right().max(now)), before: wait.open_right },
    }
}
