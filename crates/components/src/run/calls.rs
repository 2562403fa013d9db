//! Codels of a run: how one is called, how long it takes, and what becomes of its answer.

use std::cmp::Reverse;

use lapwing_genom::automata::Part;
use lapwing_genom::model::{Codel as Declared, CodelId, Role};
use lapwing_stream::{Duration, Time};

use super::known::Known;
use super::stage::{Job, Lane, Returned, between, guarded};
use super::{Done, Flight, Run};
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
        let model = self.model.clone();
        let Some(declared) = model.components.get(component).and_then(|c| c.codels.get(codel.0)) else { return };
        let Some(written) = self.known(at).and_then(|known| known.written.clone()) else {
            let answer = self.invent(at);
            return self.takes_off(automaton, codel, declared, None, answer);
        };
        let locals = match self.cell_of_automaton.get(automaton) {
            Some(cell) => self.serving.get(cell).and_then(|s| s.pending.as_ref()),
            None => self.controls.get(component).and_then(|c| c.current.as_ref()),
        };
        let call = self.store.prepare(at, locals.map(|p| &p.locals), self.now, is_logical);
        let Some(mut call) = call else { return };
        if is_logical {
            return match guarded(&*written, &mut call) {
                Ok(answer) => self.takes_off(automaton, codel, declared, Some(call), answer),
                Err(trouble) => self.fail(component, codel, trouble),
            };
        }
        self.note(automaton, Flight { codel, began: self.now, held: None });
        let lane = self.lane(automaton, component, declared);
        self.jobs.push(Job { lane, automaton, at, call, codel: written });
    }

    fn known(&self, at: (usize, usize)) -> Option<&Known> {
        self.codels.get(at.0)?.get(at.1)
    }

    /// A codel has been carried out already: it takes its time, and is known to have ended then.
    fn takes_off(&mut self, automaton: usize, codel: CodelId, declared: &Declared, call: Option<Call>, answer: Answer) {
        let drawn = match declared.wcet_ns.map(|ns| i64::try_from(ns).unwrap_or(i64::MAX)) {
            Some(wcet) => (((self.unit() * wcet as f64) as i64) + 1).min(wcet.max(1)),
            None => UNKNOWN_TIME,
        };
        let took = Duration::from_nanos(drawn.saturating_add(call.as_ref().map_or(0, |call| call.busy.nanos())));
        self.calls += 1;
        self.returns.push(Reverse((self.now.0.saturating_add(took.nanos()), self.calls, automaton)));
        self.note(automaton, Flight { codel, began: self.now, held: Some(Done { call, answer, took }) });
    }

    /// In real time: there is no thread for a codel.
    pub(super) fn stranded(&mut self, automaton: usize) {
        let codel = self.flights.get_mut(automaton).and_then(Option::take).map(|flight| flight.codel);
        let component = self.system.automata.get(automaton).map(|a| a.component);
        if let (Some(component), Some(codel)) = (component, codel) {
            self.fail(component, codel, Trouble::wrong("there is no thread to run it on"));
        }
    }

    /// In real time: when the codel that has been away for longest counts as hung.
    pub(super) fn hangs_at(&self) -> Option<i64> {
        let away = self.flights.iter().flatten().filter(|f| f.held.is_none()).map(|f| f.began.0).min();
        away.map(|began| began.saturating_add(self.setup.patience.nanos()))
    }

    fn note(&mut self, automaton: usize, flight: Flight) {
        if let Some(place) = self.flights.get_mut(automaton) {
            *place = Some(flight);
        }
    }

    /// What a codel answers that nobody has written: it does not end its activity if it need not.
    fn invent(&mut self, at: (usize, usize)) -> Answer {
        let lot = self.unit();
        let all = self.known(at).map_or(&[][..], |known| &known.answers);
        all.get((lot * all.len() as f64) as usize).cloned().unwrap_or(Answer::Ok)
    }

    fn lane(&self, automaton: usize, component: usize, declared: &Declared) -> Lane {
        let is_control = self.system.automata.get(automaton).is_some_and(|a| a.part == Part::Control);
        let task = self.cell_of_automaton.get(automaton).and_then(|cell| self.system.cells.get(cell));
        match (is_control, declared.is_async, task) {
            (true, ..) | (_, _, None) => Lane::Control(component),
            (_, true, _) => Lane::Beside(automaton),
            (_, false, Some(cell)) => Lane::Task(component, cell.task.0),
        }
    }

    /// In logical time: the time of a codel is over.
    pub(super) fn land(&mut self, automaton: usize) {
        let Some(flight) = self.flights.get_mut(automaton).and_then(Option::take) else { return };
        let Some(done) = flight.held else { return };
        self.ends(automaton, flight.codel, done);
    }

    /// In real time: a thread is done with a codel.
    pub(super) fn returned(&mut self, returned: Returned) {
        let Returned { automaton, call, answer, began, ended } = returned;
        let Some(flight) = self.flights.get_mut(automaton).and_then(Option::take) else { return };
        let Some(component) = self.system.automata.get(automaton).map(|a| a.component) else { return };
        match answer {
            Ok(answer) => {
                let done = Done { call: Some(call), answer, took: between(began, ended) };
                self.ends(automaton, flight.codel, done);
            }
            Err(trouble) => self.fail(component, flight.codel, trouble),
        }
    }

    /// In real time: whether a codel has been away for too long.
    pub(super) fn hung(&mut self) {
        let (now, patience) = (self.now, self.setup.patience);
        let late = |flight: &Flight| flight.held.is_none() && between(flight.began, now) >= patience;
        let found = self.flights.iter().enumerate().find(|(_, f)| f.as_ref().is_some_and(late));
        let Some((automaton, codel)) = found.and_then(|(n, f)| Some((n, f.as_ref()?.codel))) else { return };
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
        let model = self.model.clone();
        let Some(component) = self.system.automata.get(automaton).map(|a| a.component) else { return };
        let Some(declared) = model.components.get(component).and_then(|c| c.codels.get(codel.0)) else { return };
        self.figures.return_of((component, codel), took);
        let words = words(&answer);
        self.tell(What::Returned { component, codel, answer: words, took });
        if let Some(wcet) = declared.wcet_ns.map(|ns| Duration::from_nanos(i64::try_from(ns).unwrap_or(i64::MAX)))
            && took > wcet
        {
            self.figures.overrun((component, codel), took);
            self.tell(What::Overrun { component, codel, took, wcet });
        }
        let locals = match self.cell_of_automaton.get(automaton) {
            Some(cell) => self.serving.get_mut(cell).and_then(|s| s.pending.as_mut()),
            None => self.controls.get_mut(component).and_then(|c| c.current.as_mut()),
        };
        let locals = locals.map(|pending| &mut pending.locals);
        let at = (component, codel.0);
        let written = match (&declared.role, call) {
            (Role::Attribute, _) => {
                let service = model.components.get(component).and_then(|c| c.service_of(declared.owner));
                if let (Some(service), Some(locals)) = (service, locals) {
                    self.store.attribute(at, service, locals);
                }
                Vec::new()
            }
            (_, Some(call)) => self.store.commit(at, call, locals),
            (_, None) => self.store.rewrite(at),
        };
        for Written { port, name, value } in written {
            self.tell(What::Written { component, port, name, value });
        }
        self.answered(automaton, component, codel, declared, answer);
    }

    /// What a codel has answered says where its automaton goes.
    fn answered(&mut self, automaton: usize, component: usize, codel: CodelId, declared: &Declared, answer: Answer) {
        let exception = self.exception((component, codel), declared, &answer);
        match self.cell_of_automaton.get(automaton) {
            Some(cell) => {
                let Some(known) = self.known((component, codel.0)) else { return };
                let branch = match (&answer, &exception) {
                    (Answer::Event(event), None) => known.branch(event),
                    _ => None,
                };
                let branch = branch.unwrap_or(known.thrown);
                if let Some(serving) = self.serving.get_mut(cell) {
                    serving.thrown = exception;
                }
                self.complete(automaton, branch, false);
            }
            None => {
                let refuses = exception.is_some();
                if let Some(control) = self.controls.get_mut(component) {
                    (control.thrown, control.last) = (exception, Some(codel));
                }
                self.complete(automaton, 0, refuses);
            }
        }
    }

    /// The exception that an answer comes to: its own, or `bad_transition` where it answered what its codel does not declare.
    fn exception(&self, (component, codel): (usize, CodelId), declared: &Declared, answer: &Answer) -> Option<String> {
        let model = &self.model;
        let known = |name: &str| {
            let component = model.components.get(component)?;
            let own = component.service_of(declared.owner).map_or(&[][..], |s| &s.throws);
            let of_task =
                component.task_of(declared).and_then(|t| component.tasks.get(t.0)).map_or(&[][..], |t| &t.throws);
            let all = own.iter().chain(of_task).chain(&component.throws);
            let mut names = all.filter_map(|id| model.types.get(id.0)?.path.last());
            names.find(|n| *n == name).cloned()
        };
        match answer {
            Answer::Exception(name) => Some(known(name).unwrap_or_else(|| format!("bad_transition ({name})"))),
            Answer::Event(event) if declared.is_state() => {
                let branch = self.known((component, codel.0)).and_then(|known| known.branch(event));
                branch.is_none().then(|| format!("bad_transition ({event})"))
            }
            Answer::Ok if declared.is_state() => Some("bad_transition (ok)".to_owned()),
            Answer::Event(event) => Some(format!("bad_transition ({event})")),
            Answer::Ok => None,
        }
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

fn words(answer: &Answer) -> String {
    match answer {
        Answer::Ok => "ok".to_owned(),
        Answer::Event(event) => event.clone(),
        Answer::Exception(name) => format!("exception {name}"),
    }
}
