//! Activities: Definition 1 of the paper, rule by rule.

use std::collections::BTreeMap;

use lapwing_diag::Span;

use super::builder::{Builder, Draft};
use super::plan::{Cell, Plan, TaskPlan, status};
use super::{Action, Automaton, Call, Class, ClockGuard, Cond, ETHER, EXCEPTION, Edge, LocId, Part, VarId};
use crate::model::{Codel, CodelId, Target, Transition};

/// Adds a variable of the activity's own: its name, its greatest value where it is a number, what it stands for.
pub(super) type NewVariable<'v> = &'v mut dyn FnMut(&str, Option<i64>, String) -> VarId;

/// The automaton of a cell.
pub(super) fn automaton(plan: &Plan<'_>, task: &TaskPlan, place: usize, variable: NewVariable<'_>) -> Automaton {
    let Some(cell) = task.cells.get(place) else {
        return Builder::new(String::new(), Part::Activity, plan.number, plan.component.span).finish();
    };
    let service = cell.activity.and_then(|a| plan.component.services.get(a.0));
    let declared = plan.component.tasks.get(task.id.0);
    let (codels, span) = match service {
        Some(service) => (service.codels.clone(), service.span),
        None => declared.map_or((Vec::new(), plan.component.span), |t| (t.codels.clone(), t.span)),
    };
    let part = if service.is_some() { Part::Activity } else { Part::Permanent };
    let mut activity = Activity {
        plan,
        task,
        place,
        cell,
        builder: Builder::new(cell.name.clone(), part, plan.number, span),
        ether: ETHER,
        states: BTreeMap::new(),
        events: BTreeMap::new(),
        stopping: None,
        next: None,
        span,
    };
    activity.locations(&codels);
    activity.variables(&codels, variable);
    activity.additional();
    for codel in &codels {
        activity.nominal(*codel);
    }
    activity.builder.finish()
}

/// The locations of a codel.
#[derive(Clone, Copy, Debug)]
struct State {
    /// Where it waits for its locks; without locks, where it runs.
    main: LocId,
    /// Where it runs.
    exec: LocId,
    /// Where it waits for the next turn, where a transition pauses before it.
    pause: Option<LocId>,
    /// Where what it returned is looked at.
    test: Option<LocId>,
    /// Where it has ended, if it is `async`, and waits for the control.
    done: Option<LocId>,
    lock: Option<VarId>,
    is_async: bool,
    span: Span,
}

struct Activity<'p, 'm> {
    plan: &'p Plan<'m>,
    task: &'p TaskPlan,
    place: usize,
    cell: &'p Cell,
    builder: Builder,
    ether: LocId,
    states: BTreeMap<CodelId, State>,
    /// The codel of each event.
    events: BTreeMap<String, CodelId>,
    /// Whether it is on its way from `stop` to `ether`, where it may pause there.
    stopping: Option<VarId>,
    /// What the last codel returned, where that is looked at.
    next: Option<VarId>,
    span: Span,
}

impl Activity<'_, '_> {
    fn codel(&self, id: CodelId) -> Option<&Codel> {
        self.plan.component.codels.get(id.0)
    }

    /// Rules 2 and 4: locations, and how long a codel may stay in its own.
    fn locations(&mut self, codels: &[CodelId]) {
        self.ether = self.builder.location("ether", None, None, self.span);
        for id in codels {
            for trigger in self.codel(*id).map(|c| c.triggers().to_vec()).unwrap_or_default() {
                self.events.insert(trigger, *id);
            }
        }
        let paused: Vec<CodelId> = codels
            .iter()
            .filter_map(|id| self.codel(*id))
            .flat_map(|c| c.yields())
            .filter(|t| t.pause)
            .filter_map(target)
            .collect();
        for id in codels {
            let Some(codel) = self.plan.component.codels.get(id.0) else { continue };
            let (name, span, lock) = (codel.label(), codel.span, self.plan.lock(*id));
            let limit = codel.wcet_ns.filter(|_| !self.plan.settings.runtime);
            let (main, exec) = match lock {
                None => {
                    let main = self.builder.location(name, Some(*id), limit, span);
                    (main, main)
                }
                Some(_) => {
                    let main = self.builder.location(name, None, None, span);
                    (main, self.builder.location(&format!("{name}_exec"), Some(*id), limit, span))
                }
            };
            let throws = self.plan.settings.runtime && self.plan.settings.exceptions;
            let mut extra = |wanted: bool, suffix: &str| {
                wanted.then(|| self.builder.location(&format!("{name}_{suffix}"), None, None, span))
            };
            let pause = extra(lock.is_none() && paused.contains(id), "pause").or(paused.contains(id).then_some(main));
            let is_open = self.plan.settings.runtime && (throws || successors(codel).len() > 1);
            let state = State {
                main,
                exec,
                pause,
                test: extra(is_open && !codel.is_async, "test"),
                done: extra(codel.is_async, "done"),
                lock,
                is_async: codel.is_async,
                span,
            };
            self.states.insert(*id, state);
        }
    }

    fn variables(&mut self, codels: &[CodelId], variable: NewVariable<'_>) {
        if self.cell.activity.is_some() && self.pauses_while_stopping() {
            let meaning = format!("`{}` is on its way from `stop` to `ether`", self.cell.name);
            self.stopping = Some(variable(&format!("{}_stopping", self.cell.name), None, meaning));
        }
        let most = codels.iter().filter_map(|id| self.codel(*id)).map(|c| c.yields().len()).max().unwrap_or(0);
        if self.states.values().any(|s| s.test.is_some() || (s.done.is_some() && self.plan.settings.runtime)) {
            let meaning = format!("what the last codel of `{}` returned, by its place after `yield`", self.cell.name);
            self.next = Some(variable(&format!("{}_next", self.cell.name), Some(most as i64), meaning));
        }
    }

    /// Whether a way leads from `stop` to a pause.
    fn pauses_while_stopping(&self) -> bool {
        let mut waiting: Vec<CodelId> = self.events.get("stop").copied().into_iter().collect();
        let mut seen: Vec<CodelId> = Vec::new();
        while let Some(id) = waiting.pop() {
            if seen.contains(&id) {
                continue;
            }
            seen.push(id);
            let yields = self.codel(id).map_or(&[][..], |c| c.yields());
            if yields.iter().any(|t| t.pause) {
                return true;
            }
            waiting.extend(yields.iter().filter_map(target));
        }
        false
    }

    /// Whether codels may throw exceptions.
    fn throws(&self) -> bool {
        self.plan.settings.runtime && self.plan.settings.exceptions
    }

    /// The control is here.
    fn has_control(&self) -> Cond {
        Cond::Is(self.task.pi, self.cell.turn)
    }

    /// The activity is to go on, and not to be interrupted.
    fn is_busy(&self) -> Cond {
        let runs = Cond::Is(self.cell.run, status::RUN);
        match self.stopping {
            Some(stopping) => Cond::Any(vec![runs, Cond::Is(stopping, 1)]),
            None => runs,
        }
    }

    fn is_interrupted(&self) -> Cond {
        let stops = Cond::Is(self.cell.run, status::STOP);
        match self.stopping {
            Some(stopping) => stops.and(Cond::Is(stopping, 0)),
            None => stops,
        }
    }

    /// Rule 6: the control goes back, and the manager looks at the next cell.
    fn hand_back(&self) -> Vec<Action> {
        vec![Action::Set(self.task.pi, 0), self.task.next(self.place + 1)]
    }

    /// The end: reported by the control task, and the control goes back. A permanent activity is reported to nobody, and an exception is no
    /// success.
    fn end(&self, is_exception: bool) -> Vec<Action> {
        let mut actions = Vec::new();
        let done = self.cell.activity.and_then(|a| self.plan.done.get(&a));
        if let Some(done) = done.filter(|_| !is_exception) {
            actions.push(Action::If(Cond::Is(self.cell.run, status::RUN), vec![Action::Set(*done, 1)], Vec::new()));
        }
        let ended = if self.cell.activity.is_some() { status::ETHER } else { status::VOID };
        actions.push(Action::Set(self.cell.run, ended));
        actions.extend(self.stopping.map(|stopping| Action::Set(stopping, 0)));
        actions.extend(self.hand_back());
        actions
    }

    /// An edge that goes to where a codel begins: it resets the clock where the codel runs there, and gives the control back if nobody waits for the codel.
    fn begin(
        &mut self,
        from: LocId,
        state: State,
        class: Class,
        guard: Cond,
        mut actions: Vec<Action>,
        span: Span,
    ) -> &mut Edge {
        if state.is_async {
            actions.extend(self.hand_back());
        }
        let draft = Draft { from, to: state.main, class, guard, actions, span };
        self.builder.edge(draft).resets(state.main == state.exec)
    }

    /// Rules 3, 7, 8 and 9: the edges that no specification writes down. All are eager.
    fn additional(&mut self) {
        if let Some(start) = self.events.get("start").and_then(|id| self.states.get(id)).copied() {
            let guard = match (self.order(), self.plan.spawned) {
                (Some(order), Some(spawned)) => Cond::Is(spawned, order),
                _ => self.has_control().and(Cond::Is(self.cell.run, status::RUN)),
            };
            self.begin(self.ether, start, Class::Start, guard, Vec::new(), start.span).eager();
        }
        if self.cell.activity.is_some() {
            self.interruptions();
        }
        for (id, state) in self.states.clone() {
            if let Some(lock) = state.lock {
                let mut guard = self.plan.is_free(id);
                let mut actions = vec![Action::Set(lock, 1)];
                if state.pause.is_some() {
                    let goes_on = self.has_control().and(self.is_busy());
                    // Before the timers run nobody gives a permanent activity the control.
                    let goes_on = match self.plan.spawned.zip(self.order()).filter(|_| self.is_spawning(id)) {
                        Some((spawned, order)) => Cond::Any(vec![goes_on, Cond::Is(spawned, order)]),
                        None => goes_on,
                    };
                    guard = goes_on.and(guard);
                }
                if state.is_async && state.pause.is_some() {
                    actions.extend(self.hand_back());
                }
                let draft =
                    Draft { from: state.main, to: state.exec, class: Class::Mutex, guard, actions, span: state.span };
                self.builder.edge(draft).eager().resets(true);
            } else if let Some(pause) = state.pause {
                let guard = self.has_control().and(self.is_busy());
                self.begin(pause, state, Class::Resume, guard, Vec::new(), state.span).eager();
            }
            if state.is_async {
                let draft = Draft {
                    from: state.exec,
                    to: state.exec,
                    class: Class::Async,
                    guard: self.has_control(),
                    actions: self.hand_back(),
                    span: state.span,
                };
                self.builder.edge(draft).eager();
            }
        }
    }

    /// From `ether` and from wherever it may pause to `stop`; without `stop`, to the end.
    fn interruptions(&mut self) {
        let states: Vec<State> = self.states.values().copied().collect();
        let paused = states.iter().filter_map(|s| s.pause.map(|at| (at, s.span)));
        let done = states.iter().filter_map(|s| s.done.map(|at| (at, s.span)));
        let from: Vec<(LocId, Span)> = std::iter::once((self.ether, self.span)).chain(paused).chain(done).collect();
        let stop = self.events.get("stop").and_then(|id| self.states.get(id)).copied();
        for (from, span) in from {
            let guard = self.has_control().and(self.is_interrupted());
            match stop {
                Some(stop) => {
                    let actions = self.stopping.map(|stopping| Action::Set(stopping, 1)).into_iter().collect();
                    self.begin(from, stop, Class::Interruption, guard, actions, span).eager();
                }
                None => {
                    let draft = Draft {
                        from,
                        to: self.ether,
                        class: Class::Interruption,
                        guard,
                        actions: self.end(false),
                        span,
                    };
                    self.builder.edge(draft).eager();
                }
            }
        }
    }

    /// Rules 3, 5, 6 and 9: the transitions of a codel.
    fn nominal(&mut self, id: CodelId) {
        let (Some(state), Some(codel)) = (self.states.get(&id).copied(), self.codel(id)) else { return };
        let (successors, wcet_ns) = (successors(codel), codel.wcet_ns);
        let release: Vec<Action> = state.lock.map(|lock| Action::Set(lock, 0)).into_iter().collect();
        let runtime = self.plan.settings.runtime;
        let call = |result| runtime.then_some(Call { codel: id, wcet_ns, result });
        let mut events: Vec<String> = successors.iter().map(Transition::text).collect();
        events.extend(self.throws().then(|| EXCEPTION.to_owned()));
        let result = self.next.map(|next| (next, events));
        let last = state.done.or(state.test);
        if let Some(last) = last {
            // Not before the codel has ended may others have what it used.
            let mut actions = if state.test.is_some() { Vec::new() } else { release.clone() };
            if state.is_async && !self.task.is_periodic {
                actions.push(Action::Set(self.task.sig, 1));
            }
            let class = if state.is_async { Class::Async } else { Class::Call };
            let edge = self.builder.edge(Draft {
                from: state.exec,
                to: last,
                class,
                guard: Cond::always(),
                actions,
                span: state.span,
            });
            edge.call = call(result.clone());
            if runtime {
                edge.eager()
            } else {
                edge.clock(ClockGuard::Positive)
            };
        }
        for (number, transition) in successors.iter().enumerate() {
            let mut actions = if state.done.is_some() { Vec::new() } else { release.clone() };
            let (to, class) = self.arrival(transition, &mut actions);
            if self.is_spawning(id) {
                actions.extend(self.spawn());
            }
            let mut guard = Cond::always();
            if state.done.is_some() {
                guard = self.has_control().and(self.is_busy());
            }
            if let (Some(next), Some(_), true) = (self.next, last, runtime) {
                guard = guard.and(Cond::Is(next, number as i64));
            }
            let target = target(transition).and_then(|id| self.states.get(&id)).copied();
            let runs = target.is_some_and(|t| to == t.exec);
            let edge = self
                .builder
                .edge(Draft { from: last.unwrap_or(state.exec), to, class, guard, actions, span: transition.span })
                .resets(runs);
            match (last, runtime) {
                (Some(_), _) => drop(edge.eager()),
                (None, true) => edge.eager().call = call(None),
                (None, false) => drop(edge.clock(ClockGuard::Positive)),
            }
        }
        if let (Some(from), Some(next), true) = (last, self.next, self.throws()) {
            self.exception(id, state, from, Cond::Is(next, successors.len() as i64));
        }
    }

    /// What a codel throws ends its activity.
    fn exception(&mut self, id: CodelId, state: State, from: LocId, mut guard: Cond) {
        let release = state.lock.filter(|_| state.done.is_none()).map(|lock| Action::Set(lock, 0));
        let mut actions: Vec<Action> = release.into_iter().chain(self.end(true)).collect();
        actions.extend(self.plan.wake(Some(self.task.id)));
        if self.is_spawning(id) {
            actions.extend(self.spawn());
        }
        if state.done.is_some() {
            guard = self.has_control().and(self.is_busy()).and(guard);
        }
        let draft = Draft { from, to: self.ether, class: Class::Termination, guard, actions, span: state.span };
        self.builder.edge(draft).eager();
    }

    /// Where a transition leads, and what it does besides.
    fn arrival(&self, transition: &Transition, actions: &mut Vec<Action>) -> (LocId, Class) {
        let Some(state) = target(transition).and_then(|id| self.states.get(&id)) else {
            actions.extend(self.end(false));
            actions.extend(self.plan.wake(Some(self.task.id)));
            return (self.ether, Class::Termination);
        };
        if let Some(pause) = state.pause.filter(|_| transition.pause) {
            actions.extend(self.hand_back());
            return (pause, Class::Pause);
        }
        if state.is_async {
            actions.extend(self.hand_back());
        }
        actions.extend(self.plan.wake(Some(self.task.id)));
        (state.main, Class::Execution)
    }

    /// Whether it is with this codel that a permanent activity has started.
    fn is_spawning(&self, id: CodelId) -> bool {
        self.cell.activity.is_none() && self.events.get("start") == Some(&id)
    }

    /// The place of a permanent activity among those that start.
    fn order(&self) -> Option<i64> {
        let order = self.plan.spawns.iter().position(|t| *t == self.task.id).filter(|_| self.cell.activity.is_none());
        order.map(|order| order as i64)
    }

    /// The next permanent activity may start. The codel may be called again later.
    fn spawn(&self) -> Option<Action> {
        let (order, spawned) = (self.order()?, self.plan.spawned?);
        Some(Action::If(Cond::Is(spawned, order), vec![Action::Set(spawned, order + 1)], Vec::new()))
    }
}

fn target(transition: &Transition) -> Option<CodelId> {
    match transition.to {
        Target::Codel(codel) => Some(codel),
        Target::Ether => None,
    }
}

/// The transitions of a codel that lead to different places: two events of one codel are one.
pub(super) fn successors(codel: &Codel) -> Vec<Transition> {
    let mut all: Vec<Transition> = Vec::new();
    for transition in codel.yields() {
        if !all.iter().any(|t| (t.pause, t.to) == (transition.pause, transition.to)) {
            all.push(transition.clone());
        }
    }
    all
}
