//! Codels of a run: how one is called, how long it takes, and what becomes of its answer.

use std::cmp::Reverse;

use lapwing_genom::model::CodelId;
use lapwing_stream::{Duration, Time};

use super::known::Known;
use super::stage::{Job, Lane, Returned, between, guarded};
use super::{Done, Run};
use crate::codel::{Answer, Call, Trouble, TroubleKind};
use crate::happening::{Failure, What};
use crate::store::Written;

/// How long a codel takes for which nobody has said anything.
const UNKNOWN_TIME: i64 = 1_000;

impl Run {
    /// An automaton calls a codel.
    pub(super) fn begin(&mut self, automaton: usize, codel: CodelId) {
        let Some(component) = self.system.automata.get(automaton).map(|a| a.component) else { return };
        self.tell(What::Called { component, codel });
        let is_logical = !self.setup.is_real;
        let at = (component, codel.0);
        let Some(known) = self.known(at) else { return };
        let (wcet, is_async) = (known.wcet, known.is_async);
        let Some(written) = known.written.clone() else {
            let answer = self.invent(at);
            return self.takes_off(automaton, codel, wcet, None, answer);
        };
        let locals = match self.cell_of_automaton.get(automaton) {
            Some(cell) => self.serving.get(cell).and_then(|s| s.pending.as_ref()),
            None => self.controls.get(component).and_then(|c| c.current.as_ref()),
        };
        let call = self.store.prepare(at, locals.map(|p| &p.locals), self.now, is_logical);
        let Some(mut call) = call else { return };
        if is_logical {
            return match guarded(&*written, &mut call) {
                Ok(answer) => self.takes_off(automaton, codel, wcet, Some(call), answer),
                Err(trouble) => self.fail(component, codel, trouble),
            };
        }
        self.note(automaton, codel, None);
        self.away.push((self.now.0, automaton));
        let lane = self.lane(automaton, component, is_async);
        self.jobs.push(Job { lane, automaton, at, call, codel: written });
    }

    fn known(&self, at: (usize, usize)) -> Option<&Known> {
        self.codels.get(at.0)?.get(at.1)
    }

    /// A codel has been carried out already: it takes its time, and is known to have ended then.
    fn takes_off(
        &mut self,
        automaton: usize,
        codel: CodelId,
        wcet: Option<Duration>,
        call: Option<Call>,
        answer: Answer,
    ) {
        let drawn = match wcet.map(|wcet| wcet.nanos()) {
            Some(wcet) => (((self.unit() * wcet as f64) as i64) + 1).min(wcet.max(1)),
            None => UNKNOWN_TIME,
        };
        let took = Duration::from_nanos(drawn.saturating_add(call.as_ref().map_or(0, |call| call.busy.nanos())));
        self.calls += 1;
        self.returns.push(Reverse((self.now.0.saturating_add(took.nanos()), self.calls, automaton)));
        self.note(automaton, codel, Some(Done { call, answer, took }));
    }

    /// In real time: there is no thread for a codel.
    pub(super) fn stranded(&mut self, automaton: usize) {
        let codel = self.land_from(automaton);
        let component = self.system.automata.get(automaton).map(|a| a.component);
        if let (Some(component), Some(codel)) = (component, codel) {
            self.fail(component, codel, Trouble::wrong("there is no thread to run it on"));
        }
    }

    /// In real time: when the codel that has been away for longest counts as hung.
    pub(super) fn hangs_at(&self) -> Option<i64> {
        let away = self.away.iter().map(|(began, _)| *began).min();
        away.map(|began| began.saturating_add(self.setup.patience.nanos()))
    }

    fn note(&mut self, automaton: usize, codel: CodelId, done: Option<Done>) {
        if let (Some(place), Some(held)) = (self.flights.get_mut(automaton), self.held.get_mut(automaton)) {
            (*place, *held) = (Some(codel), done);
        }
    }

    /// A codel is not away any more.
    fn land_from(&mut self, automaton: usize) -> Option<CodelId> {
        self.away.retain(|(_, other)| *other != automaton);
        self.flights.get_mut(automaton)?.take()
    }

    /// What a codel answers that nobody has written: it does not end its activity if it need not.
    fn invent(&mut self, at: (usize, usize)) -> Answer {
        let lot = self.unit();
        let all = self.known(at).map_or(&[][..], |known| &known.answers);
        all.get((lot * all.len() as f64) as usize).cloned().unwrap_or(Answer::Ok)
    }

    fn lane(&self, automaton: usize, component: usize, is_async: bool) -> Lane {
        match self.cell_of_automaton.get(automaton).and_then(|cell| self.system.cells.get(cell)) {
            None => Lane::Control(component),
            Some(_) if is_async => Lane::Beside(automaton),
            Some(cell) => Lane::Task(component, cell.task.0),
        }
    }

    /// In logical time: the time of a codel is over.
    pub(super) fn land(&mut self, automaton: usize) {
        let Some(codel) = self.flights.get_mut(automaton).and_then(Option::take) else { return };
        let Some(done) = self.held.get_mut(automaton).and_then(Option::take) else { return };
        self.ends(automaton, codel, done);
    }

    /// In real time: a thread is done with a codel.
    pub(super) fn returned(&mut self, returned: Returned) {
        let Returned { automaton, call, answer, began, ended } = returned;
        let Some(codel) = self.land_from(automaton) else { return };
        let Some(component) = self.system.automata.get(automaton).map(|a| a.component) else { return };
        match answer {
            Ok(answer) => {
                let done = Done { call: Some(call), answer, took: between(began, ended) };
                self.ends(automaton, codel, done);
            }
            Err(trouble) => self.fail(component, codel, trouble),
        }
    }

    /// In real time: whether a codel has been away for too long.
    pub(super) fn hung(&mut self) {
        let (now, patience) = (self.now, self.setup.patience);
        let is_late = |(began, _): &&(i64, usize)| between(Time(*began), now) >= patience;
        let Some((_, automaton)) = self.away.iter().find(is_late).copied() else { return };
        let Some(codel) = self.flights.get(automaton).copied().flatten() else { return };
        let Some(component) = self.system.automata.get(automaton).map(|a| a.component) else { return };
        let message = format!("it has not returned for {} s", patience.seconds());
        self.fail(component, codel, Trouble { kind: TroubleKind::Hung, message });
    }

    pub(super) fn fail(&mut self, component: usize, codel: CodelId, trouble: Trouble) {
        self.tell(What::Failed(Box::new(Failure { component, codel, trouble })));
        self.end();
    }

    /// A codel has ended: what it has done is there from now on, its lock is given back, and its automaton goes on.
    fn ends(&mut self, automaton: usize, codel: CodelId, done: Done) {
        let Done { call, answer, took } = done;
        let Some(component) = self.system.automata.get(automaton).map(|a| a.component) else { return };
        let at = (component, codel.0);
        let Some(known) = self.known(at) else { return };
        let (words, wcet, is_attribute) = (known.words(&answer), known.wcet, known.is_attribute);
        self.figures.return_of((component, codel), took);
        self.tell(What::Returned { component, codel, answer: words, took });
        if let Some(wcet) = wcet.filter(|wcet| took > *wcet) {
            self.figures.overrun((component, codel), took);
            self.tell(What::Overrun { component, codel, took, wcet });
        }
        let locals = match self.cell_of_automaton.get(automaton) {
            Some(cell) => self.serving.get_mut(cell).and_then(|s| s.pending.as_mut()),
            None => self.controls.get_mut(component).and_then(|c| c.current.as_mut()),
        };
        let locals = locals.map(|pending| &mut pending.locals);
        let written = match call {
            _ if is_attribute => {
                let component = self.model.components.get(component);
                let owner = component.and_then(|c| c.service_of(c.codels.get(codel.0)?.owner));
                if let (Some(service), Some(locals)) = (owner, locals) {
                    self.store.attribute(at, service, locals);
                }
                Vec::new()
            }
            Some(call) => self.store.commit(at, call, locals),
            None => self.store.rewrite(at),
        };
        for Written { port, name, value } in written {
            self.tell(What::Written { component, port, name, value });
        }
        self.answered(automaton, at, &answer);
    }

    /// What a codel has answered says where its automaton goes.
    fn answered(&mut self, automaton: usize, at: (usize, usize), answer: &Answer) {
        let Some(known) = self.known(at) else { return };
        let branch = match answer {
            Answer::Event(event) => known.branch(event).filter(|_| known.is_state),
            _ => None,
        };
        let (is_state, thrown) = (known.is_state, known.thrown);
        let exception = if branch.is_some() { None } else { self.exception(at, is_state, answer) };
        match self.cell_of_automaton.get(automaton) {
            Some(cell) => {
                if let Some(serving) = self.serving.get_mut(cell) {
                    serving.thrown = exception;
                }
                self.complete(automaton, branch.unwrap_or(thrown), false);
            }
            None => {
                let refuses = exception.is_some();
                if let Some(control) = self.controls.get_mut(at.0) {
                    (control.thrown, control.last) = (exception, Some(CodelId(at.1)));
                }
                self.complete(automaton, 0, refuses);
            }
        }
    }

    /// The exception that an answer comes to that is no event that its codel declares: its own, or `bad_transition`.
    fn exception(&self, at: (usize, usize), is_state: bool, answer: &Answer) -> Option<String> {
        match answer {
            Answer::Exception(name) => {
                Some(self.thrown(at, name).unwrap_or_else(|| format!("bad_transition ({name})")))
            }
            Answer::Event(event) => Some(format!("bad_transition ({event})")),
            Answer::Ok => is_state.then(|| "bad_transition (ok)".to_owned()),
        }
    }

    /// An exception that the service of a codel, its task or its component declares.
    fn thrown(&self, at: (usize, usize), name: &str) -> Option<String> {
        let component = self.model.components.get(at.0)?;
        let declared = component.codels.get(at.1)?;
        let own = component.service_of(declared.owner).map_or(&[][..], |s| &s.throws);
        let of_task = component.task_of(declared).and_then(|t| component.tasks.get(t.0)).map_or(&[][..], |t| &t.throws);
        let all = own.iter().chain(of_task).chain(&component.throws);
        let mut names = all.filter_map(|id| self.model.types.get(id.0)?.path.last());
        names.find(|n| *n == name).cloned()
    }

    fn complete(&mut self, automaton: usize, branch: usize, refuses: bool) {
        if let Some(next) = self.machine.complete(automaton, branch, refuses, self.now) {
            self.handle(next);
        }
    }

    /// The time of a turn's beginning after that of its period.
    pub(super) fn delay(&self, since: Time) -> Duration {
        between(since, self.now)
    }
}
