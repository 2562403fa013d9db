//! The timer and the manager of a task (the paper's figures 4 and 5).

use super::builder::{Builder, Draft};
use super::plan::{Plan, TaskPlan, status};
use super::{Action, Automaton, Class, ClockGuard, Cond, LocId, Part};

/// The timer: at the end of each period it says that a turn is due. A task without a period has none.
pub(super) fn timer(plan: &Plan<'_>, task: &TaskPlan) -> Option<Automaton> {
    let declared = plan.component.tasks.get(task.id.0)?;
    let period = declared.period_ns?;
    let span = declared.span;
    let mut builder =
        Builder::new(format!("{}_{}_timer", plan.component.name, declared.name), Part::Timer, plan.number, span);
    let unspawned = plan.spawned.map(|spawned| (builder.location("unspawned", None, None, span), spawned));
    let delayed =
        declared.delay_ns.filter(|ns| *ns > 0).map(|ns| (builder.location("delayed", None, Some(ns), span), ns));
    let tick = builder.location("tick", None, Some(period), span);
    if let Some((from, spawned)) = unspawned {
        let to = delayed.map_or(tick, |(location, _)| location);
        let guard = Cond::Is(spawned, plan.spawns.len() as i64);
        builder.edge(Draft { from, to, class: Class::Tick, guard, actions: Vec::new(), span }).eager().resets(true);
    }
    if let Some((from, ns)) = delayed {
        let draft = Draft { from, to: tick, class: Class::Tick, guard: Cond::always(), actions: Vec::new(), span };
        builder.edge(draft).clock(ClockGuard::Exactly(ns)).resets(true);
    }
    let draft = Draft {
        from: tick,
        to: tick,
        class: Class::Tick,
        guard: Cond::always(),
        actions: vec![Action::Set(task.sig, 1)],
        span,
    };
    builder.named("tick", draft).clock(ClockGuard::Exactly(period)).resets(true);
    Some(builder.finish())
}

/// The manager: each turn it gives the control to the cells that have something to do, one after the other.
pub(super) fn manager(plan: &Plan<'_>, task: &TaskPlan) -> Automaton {
    let declared = plan.component.tasks.get(task.id.0);
    let (name, span) = declared.map_or(("", plan.component.span), |t| (t.name.as_str(), t.span));
    let mut builder = Builder::new(format!("{}_{name}_manager", plan.component.name), Part::Manager, plan.number, span);
    let wait = builder.location("wait", None, None, span);
    let manage = builder.location("manage", None, None, span);
    let mut edge = |name: &str, from: LocId, to: LocId, guard: Cond, actions: Vec<Action>| {
        builder.named(name, Draft { from, to, class: Class::Manage, guard, actions, span }).eager();
    };
    edge("begin", wait, manage, Cond::Is(task.sig, 1), vec![Action::Set(task.sig, 0), task.next(0)]);
    let (end, has_control) = (task.cells.len() as i64, Cond::Is(task.pi, 0));
    if !task.cells.is_empty() {
        // `Π := run[i].a`, with the table written out.
        let mut cells = task.cells.iter().enumerate().rev();
        let last = cells.next().map(|(_, cell)| Action::Set(task.pi, cell.turn));
        let pass = cells.fold(last, |rest, (number, cell)| {
            Some(Action::If(
                Cond::Is(task.i, number as i64),
                vec![Action::Set(task.pi, cell.turn)],
                rest.into_iter().collect(),
            ))
        });
        edge("pass", manage, manage, has_control.clone().and(Cond::Not(task.i, end)), pass.into_iter().collect());
    }
    let mut actions = vec![Action::Set(task.i, 0)];
    let ended: Vec<Cond> =
        task.cells.iter().filter(|c| c.activity.is_some()).map(|c| Cond::Is(c.run, status::ETHER)).collect();
    if !ended.is_empty() {
        // What has ended is reported at the end of the turn.
        actions.push(Action::If(Cond::Any(ended), vec![Action::Set(plan.sched, 1)], Vec::new()));
    }
    edge("finish", manage, wait, has_control.and(Cond::Is(task.i, end)), actions);
    builder.finish()
}
