//! What the moves of the automata mean: periods begin, requests are taken, activities start, stop, end and are reported.

use lapwing_genom::automata::{ETHER, LocId, status};
use lapwing_genom::model::ServiceKind;
use lapwing_stream::Time;

use super::{Pending, Run, TOLERANCE_NS};
use crate::happening::{Outcome, What, Whose};
use crate::machine::{Change, Move, Offer, Way};

impl Run {
    pub(super) fn handle(&mut self, next: Move) {
        match next {
            Move::Begins { automaton, codel } => self.begin(automaton, codel),
            Move::Taken { automaton, edge } => self.taken(automaton, edge),
            Move::Listens { automaton } => self.listens(automaton),
        }
    }

    /// A timer has moved: its period began at `at`.
    pub(super) fn ticks(&mut self, at: Time, next: Move) {
        let Move::Taken { automaton, edge } = next else { return };
        let Some(number) = self.task_of_timer.get(automaton) else { return };
        self.figures.moves += 1;
        // The last edge of a timer is its period; those before only wait until it may begin.
        let is_period = self.machine.way(automaton, edge).is_some_and(|way| way.from == way.to);
        let Some(task) = self.system.tasks.get(number).copied().filter(|_| is_period) else { return };
        let changes = self.machine.take_changes();
        let is_missed = changes.is_empty();
        self.machine.give_back(changes);
        if is_missed {
            self.figures.miss((task.component, task.task));
            self.tell(What::Missed { component: task.component, task: task.task });
        }
        if let Some(ticked) = self.ticked.get_mut(number) {
            *ticked = Some(at);
        }
    }

    fn taken(&mut self, automaton: usize, number: usize) {
        self.figures.moves += 1;
        let Some(way) = self.machine.way(automaton, number) else { return };
        let Way { component, from, to, is_activity, .. } = way;
        if way.is_turn {
            self.turn(automaton);
        }
        if is_activity {
            self.activity(automaton, from, to);
        }
        let changes = self.machine.take_changes();
        changes.iter().for_each(|change| self.status(component, *change));
        self.machine.give_back(changes);
        if is_activity && to == ETHER && from != ETHER {
            self.ended(automaton);
        }
        if way.concludes {
            self.concluded(component, way.is_refusal);
        }
    }

    /// A turn of a task begins.
    fn turn(&mut self, automaton: usize) {
        let Some(number) = self.task_of_manager.get(automaton) else { return };
        let Some(task) = self.system.tasks.get(number).copied() else { return };
        let key = (task.component, task.task);
        self.figures.turn(key);
        let Some(ticked) = self.ticked.get(number).copied().flatten() else { return };
        let by = self.delay(ticked);
        let allowed = if self.setup.is_real { TOLERANCE_NS } else { 0 };
        if by.nanos() > allowed {
            self.figures.delay(key, by);
            self.tell(What::Late { component: task.component, task: task.task, by });
        }
    }

    fn activity(&mut self, automaton: usize, from: LocId, to: LocId) {
        if from == ETHER && to != ETHER {
            let Some(cell) = self.cell_of_automaton.get(automaton) else { return };
            let Some((whose, instance)) = self.whose(cell) else { return };
            let values = self.serving.get(cell).and_then(|s| s.pending.as_ref()).map(|p| p.values.clone());
            self.tell(What::Started { whose, instance, values: values.unwrap_or_default() });
        }
    }

    fn ended(&mut self, automaton: usize) {
        let Some(cell) = self.cell_of_automaton.get(automaton) else { return };
        let Some((whose, instance)) = self.whose(cell) else { return };
        let outcome = self.serving.get(cell).and_then(|s| s.outcome.clone()).unwrap_or(Outcome::Done);
        self.tell(What::Ended { whose, instance, outcome });
    }

    /// The activity of a cell and its instance; none for permanent ones.
    fn whose(&self, cell: usize) -> Option<(Whose, usize)> {
        let cell = self.system.cells.get(cell)?;
        Some((Whose { component: cell.component, service: cell.activity? }, cell.instance))
    }

    /// The status of a cell has changed.
    fn status(&mut self, component: usize, change: Change) {
        let Some(cell) = self.cell_of_var.get(change.var.0) else { return };
        let Some((whose, instance)) = self.whose(cell) else { return };
        match (change.before, change.after) {
            (status::VOID, status::WAIT) => {
                let pending = self.controls.get_mut(component).and_then(|c| c.current.take());
                if let (Some(pending), Some(serving)) = (pending, self.serving.get_mut(cell)) {
                    let id = pending.id;
                    *serving = super::Serving { pending: Some(pending), outcome: None, thrown: None };
                    self.tell(What::Replied { id, whose, refused: None, instance: Some(instance) });
                }
            }
            (status::RUN, status::STOP) => self.tell(What::Interrupted { whose, instance }),
            (before, status::ETHER) => {
                if before == status::WAIT {
                    self.tell(What::Interrupted { whose, instance });
                }
                let Some(serving) = self.serving.get_mut(cell) else { return };
                serving.outcome = Some(match serving.thrown.take() {
                    Some(thrown) => Outcome::Exception(thrown),
                    None if before == status::RUN => Outcome::Done,
                    None => Outcome::Interrupted,
                });
            }
            (_, status::VOID) => {
                let Some(serving) = self.serving.get_mut(cell).map(std::mem::take) else { return };
                if let Some(pending) = serving.pending {
                    self.report(&pending, serving.outcome.unwrap_or(Outcome::Done));
                }
            }
            _ => {}
        }
    }

    /// A control task is done with a request, unless an activity has taken it over.
    fn concluded(&mut self, component: usize, refuses: bool) {
        let Some(control) = self.controls.get_mut(component) else { return };
        let Some(pending) = control.current.take() else { return };
        let thrown = control.thrown.take();
        let (id, whose) = (pending.id, pending.whose);
        let kind = self.service(whose).map(|s| (s.kind, s.validate.is_some(), s.codels.len()));
        let refused = match (refuses, kind) {
            // What a function's own codel throws ends it; what `validate` throws refuses it.
            (true, Some((ServiceKind::Function, validates, codels)))
                if codels > 0 && (!validates || self.served(whose)) =>
            {
                self.tell(What::Replied { id, whose, refused: None, instance: None });
                return self.report(&pending, Outcome::Exception(thrown.unwrap_or_default()));
            }
            (true, _) => Some(thrown.unwrap_or_else(|| "refused".to_owned())),
            (false, Some((ServiceKind::Activity, ..))) => Some("too_many_activities".to_owned()),
            (false, _) => None,
        };
        let is_refused = refused.is_some();
        self.tell(What::Replied { id, whose, refused, instance: None });
        if !is_refused {
            self.report(&pending, Outcome::Done);
        }
    }

    /// Whether the last codel that the control task has run for a service was none that validates.
    fn served(&self, whose: Whose) -> bool {
        let last = self.controls.get(whose.component).and_then(|c| c.last);
        let service = self.service(whose);
        last.is_some_and(|last| service.is_some_and(|s| s.validate != Some(last)))
    }

    fn report(&mut self, pending: &Pending, outcome: Outcome) {
        let whose = pending.whose;
        let count = self.service(whose).map_or(0, |s| s.parameters.len());
        let values = pending.locals.parameters(count).to_vec();
        self.tell(What::Reported { id: pending.id, whose, outcome, values });
    }

    /// A control task could take a request.
    fn listens(&mut self, automaton: usize) {
        let Some(component) = self.system.automata.get(automaton).map(|a| a.component) else { return };
        let Some(pending) = self.controls.get_mut(component).and_then(|c| c.waiting.pop_front()) else { return };
        let (id, whose) = (pending.id, pending.whose);
        match self.machine.offer(automaton, whose.service, self.now) {
            Offer::Taken(edge) => {
                if let Some(control) = self.controls.get_mut(component) {
                    control.current = Some(pending);
                    control.thrown = None;
                    control.last = None;
                }
                self.taken(automaton, edge);
            }
            refused => {
                let why = if refused == Offer::Disallowed { "disallowed" } else { "there is nothing to run" };
                self.tell(What::Replied { id, whose, refused: Some(why.to_owned()), instance: None });
                self.machine.rouse(automaton);
            }
        }
    }
}
