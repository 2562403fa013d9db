//! The control task: it takes requests, has them validated, interrupts what they exclude, launches, and reports.

use std::collections::BTreeSet;

use lapwing_diag::Span;

use super::builder::{Builder, Draft};
use super::plan::{Cell, Plan, TaskPlan, required, status};
use super::{Action, Automaton, Class, ClockGuard, Cond, LocId, Part};
use crate::model::{CodelId, Service, ServiceId, ServiceKind};

/// The automaton of a component's control task.
pub(super) fn automaton(plan: &Plan<'_>) -> Automaton {
    let span = plan.component.span;
    let mut builder = Builder::new(format!("{}_control", plan.component.name), Part::Control, plan.number, span);
    let unspawned = plan.spawned.map(|spawned| (builder.location("unspawned", None, None, span), spawned));
    let receive = builder.location("receive", None, None, span);
    let finish = builder.location("finish", None, None, span);
    let mut control = Control { plan, builder, receive, finish };
    if let Some((from, spawned)) = unspawned {
        let guard = Cond::Is(spawned, plan.spawns.len() as i64);
        control.edge("spawned", from, receive, guard, Vec::new(), span);
    }
    control.edge("report", receive, finish, Cond::Is(plan.sched, 1), vec![Action::Set(plan.sched, 0)], span);
    for (number, service) in plan.component.services.iter().enumerate() {
        control.service(ServiceId(number), service);
    }
    let actions = control.launch();
    control.edge("done", finish, receive, Cond::always(), actions, span);
    control.builder.finish()
}

/// How a codel of the control task may end: the end's name, where it leads, and what it does besides giving its lock back.
type End<'e> = (&'e str, LocId, Vec<Action>);

struct Control<'p, 'm> {
    plan: &'p Plan<'m>,
    builder: Builder,
    receive: LocId,
    finish: LocId,
}

impl Control<'_, '_> {
    /// An eager edge of the control task.
    fn edge(&mut self, name: &str, from: LocId, to: LocId, guard: Cond, actions: Vec<Action>, span: Span) {
        self.builder.named(name, Draft { from, to, class: Class::Control, guard, actions, span }).eager();
    }

    /// What becomes of a request. One for a service that must wait for another's first success is refused: it changes nothing.
    fn service(&mut self, id: ServiceId, service: &Service) {
        let span = service.span;
        let is_empty = service.kind == ServiceKind::Activity && service.codels.is_empty();
        if is_empty {
            return;
        }
        let first = self.builder.location(&service.name, None, None, span);
        let needed = required(self.plan.component, id);
        let guard =
            Cond::All(needed.iter().filter_map(|s| self.plan.done.get(s)).map(|done| Cond::Is(*done, 1)).collect());
        let draft = Draft { from: self.receive, to: first, class: Class::Request, guard, actions: Vec::new(), span };
        self.builder.named(&format!("request_{}", service.name), draft).request = Some(id);
        let mut at = first;
        if let Some(validate) = service.validate {
            let accepted = self.builder.location(&format!("{}_accepted", service.name), None, None, span);
            let ends = [("accept", accepted, Vec::new()), ("reject", self.finish, Vec::new())];
            let concludes = Some(id).filter(|_| service.kind != ServiceKind::Activity);
            self.run(&format!("{}_validate", service.name), at, validate, &ends, concludes);
            at = accepted;
        }
        match service.kind {
            ServiceKind::Activity => self.manage(id, service, at),
            _ => self.serve(id, service, at),
        }
    }

    /// A function or an attribute: its codels under their locks, and then its interruptions.
    fn serve(&mut self, id: ServiceId, service: &Service, mut at: LocId) {
        let mut last = self.interruptions(service, None);
        last.extend(self.plan.done.get(&id).map(|done| Action::Set(*done, 1)));
        last.extend(self.plan.wake(None));
        let Some((final_codel, others)) = service.codels.split_last() else {
            let draft = Draft {
                from: at,
                to: self.finish,
                class: Class::Control,
                guard: Cond::always(),
                actions: last,
                span: service.span,
            };
            self.builder.named(&format!("{}_done", service.name), draft).eager().concludes = Some(id);
            return;
        };
        for codel in others {
            let next = self.builder.location(&format!("{}_then", service.name), None, None, service.span);
            self.serving(id, service, at, *codel, ("next", next, Vec::new()));
            at = next;
        }
        self.serving(id, service, at, *final_codel, ("done", self.finish, last));
    }

    /// Runs a codel of a function; where it may throw an exception, that is the function's end.
    fn serving(&mut self, id: ServiceId, service: &Service, at: LocId, codel: CodelId, end: End<'_>) {
        let throws = self.plan.settings.runtime && self.plan.settings.exceptions;
        let thrown = throws.then(|| ("throw", self.finish, Vec::new()));
        let ends: Vec<End<'_>> = std::iter::once(end).chain(thrown).collect();
        self.run(&format!("{}_run", service.name), at, codel, &ends, Some(id));
    }

    /// Runs a codel from a location: it takes its lock, takes its time, and leads to one of `ends`. At the finish it concludes a service.
    fn run(&mut self, name: &str, from: LocId, codel: CodelId, ends: &[End<'_>], concludes: Option<ServiceId>) {
        let declared = self.plan.component.codels.get(codel.0);
        let (wcet_ns, span) = declared.map_or((None, self.plan.component.span), |c| (c.wcet_ns, c.span));
        let exec = self.builder.location(&format!("{name}_exec"), Some(codel), wcet_ns, span);
        let lock = self.plan.lock(codel);
        let take = lock.map(|lock| Action::Set(lock, 1)).into_iter().collect();
        let draft = Draft { from, to: exec, class: Class::Mutex, guard: self.plan.is_free(codel), actions: take, span };
        self.builder.named(&format!("{name}_begin"), draft).eager().resets(true);
        let finish = self.finish;
        for (end, to, actions) in ends {
            let release = lock.map(|lock| Action::Set(lock, 0)).into_iter();
            let draft = Draft {
                from: exec,
                to: *to,
                class: Class::Control,
                guard: Cond::always(),
                actions: release.chain(actions.clone()).collect(),
                span,
            };
            let edge = self.builder.named(&format!("{name}_{end}"), draft).clock(ClockGuard::Positive);
            edge.is_refusal = matches!(*end, "reject" | "throw");
            edge.concludes = concludes.filter(|_| *to == finish);
        }
    }

    /// An activity: the first free cell of it waits, and what it excludes is interrupted. Without a free cell it is refused.
    fn manage(&mut self, id: ServiceId, service: &Service, at: LocId) {
        let own: Vec<Cell> =
            self.plan.cells().map(|(_, cell)| cell).filter(|c| c.activity == Some(id)).cloned().collect();
        let mut action = None;
        for cell in own.iter().rev() {
            let mut taken = vec![Action::Set(cell.run, status::WAIT)];
            taken.extend(self.interruptions(service, Some(cell)));
            action = Some(Action::If(Cond::Is(cell.run, status::VOID), taken, action.into_iter().collect()));
        }
        let actions = action.into_iter().collect();
        self.edge(&format!("{}_manage", service.name), at, self.finish, Cond::always(), actions, service.span);
    }

    /// Interrupts every cell, but for one, that runs or waits for an activity that a service interrupts. A task without a period is woken for that.
    fn interruptions(&self, service: &Service, except: Option<&Cell>) -> Vec<Action> {
        let is_other = |cell: &Cell| except.is_none_or(|e| e.run != cell.run);
        let excluded = |cell: &Cell| cell.activity.is_some_and(|a| service.interrupts.contains(&a));
        let cells = self.plan.cells().filter(|(_, cell)| excluded(cell) && is_other(cell));
        let one = |(task, cell): (&TaskPlan, &Cell)| {
            let mut actions = vec![Action::Add(cell.run, 2)];
            if !task.is_periodic {
                actions.push(Action::Set(task.sig, 1));
            }
            Action::If(Cond::Less(cell.run, status::STOP), actions, Vec::new())
        };
        cells.map(one).collect()
    }

    /// Reports what has ended, and launches what waits and excludes nothing that is still there.
    fn launch(&self) -> Vec<Action> {
        let cells: Vec<(&TaskPlan, &Cell)> = self.plan.cells().collect();
        let mut actions: Vec<Action> = Vec::new();
        for (_, cell) in &cells {
            actions.push(Action::If(
                Cond::Is(cell.run, status::ETHER),
                vec![Action::Set(cell.run, status::VOID)],
                Vec::new(),
            ));
        }
        for (task, cell) in &cells {
            let interrupts: BTreeSet<ServiceId> =
                self.service_of(cell).into_iter().flat_map(|s| s.interrupts.iter().copied()).collect();
            let others = cells
                .iter()
                .filter(|(_, other)| other.run != cell.run && other.activity.is_some_and(|a| interrupts.contains(&a)));
            let guard = others.fold(Cond::Is(cell.run, status::WAIT), |guard, (_, other)| {
                guard.and(Cond::Is(other.run, status::VOID))
            });
            let mut launched = vec![Action::Set(cell.run, status::RUN)];
            if !task.is_periodic {
                launched.push(Action::Set(task.sig, 1));
            }
            actions.push(Action::If(guard, launched, Vec::new()));
        }
        actions
    }

    fn service_of(&self, cell: &Cell) -> Option<&Service> {
        self.plan.component.services.get(cell.activity?.0)
    }
}
