//! What is wrong, or unlikely to be meant, in a specification that can be read: times that do not fit, and codels that disturb each other.

use lapwing_diag::{Code, Diagnostic};

use crate::model::{Codel, CodelId, Component, Owner, ServiceId, Target, Task, TaskId};
use crate::mutex::{Rules, conflicts};

/// Codels are held against each other, each against each, so that a component must not have any number of them.
const MOST_CODELS: usize = 4_000;

/// Whether no component is larger than can be looked at.
pub(crate) fn are_of_a_size(components: &[Component], diagnostics: &mut Vec<Diagnostic>) -> bool {
    let before = diagnostics.len();
    for component in components.iter().filter(|c| c.codels.len() > MOST_CODELS) {
        let message =
            format!("`{}` has {} codels, and {MOST_CODELS} are the limit", component.name, component.codels.len());
        diagnostics.push(Diagnostic::new(Code::TooLarge, component.span, message));
    }
    diagnostics.len() == before
}

/// Looks at all components.
pub(crate) fn check(components: &[Component], diagnostics: &mut Vec<Diagnostic>) {
    for component in components {
        asynchronous(component, diagnostics);
        for (number, task) in component.tasks.iter().enumerate() {
            times(component, TaskId(number), task, diagnostics);
        }
    }
}

/// An `async` codel runs while its task and others go on: it must have its data for itself.
fn asynchronous(component: &Component, diagnostics: &mut Vec<Diagnostic>) {
    for (id, codel) in component.codels().filter(|(_, c)| c.is_async) {
        for other in conflicts(component, id, Rules::default()) {
            let Some(other) = component.codels.get(other.0) else { continue };
            // What a permanent activity does when it begins and ends does not meet the rest.
            let is_edge =
                matches!(other.owner, Owner::Task(_)) && other.triggers().iter().all(|t| t == "start" || t == "stop");
            if is_edge {
                continue;
            }
            let message = format!(
                "`{}` runs beside its task, and shares data with `{}`",
                component.codel_name(codel),
                component.codel_name(other)
            );
            diagnostics.push(
                Diagnostic::new(Code::AsyncSharesData, codel.span, message)
                    .also(other.span, "this codel uses the same data")
                    .help("leave the shared data to a codel before or after it that is not `async`"),
            );
        }
    }
}

/// Whether the codels of a task fit into its period.
fn times(component: &Component, id: TaskId, task: &Task, diagnostics: &mut Vec<Diagnostic>) {
    let own = |codel: &&Codel| component.task_of(codel) == Some(id);
    let Some(period) = task.period_ns else {
        // A task that waits in an `async` codel, or does something once, wants no period. One that pauses may have lost it.
        let mut pauses = component.codels.iter().filter(own).flat_map(Codel::yields).filter(|to| to.pause);
        if let Some(pause) = pauses.next() {
            let message = format!("the task `{}` has no period, and its codels pause", task.name);
            let help =
                "such a pause lasts until something happens in the component; for a steady rate write `period 10 ms;`";
            let diagnostic = Diagnostic::new(Code::TaskWithoutPeriod, task.span, message);
            diagnostics.push(diagnostic.also(pause.span, "a pause").help(help));
        }
        return;
    };
    for codel in component.codels.iter().filter(own) {
        if let Some(wcet) = codel.wcet_ns.filter(|wcet| *wcet > period && !codel.is_async) {
            let message = format!(
                "`{}` may take {}, and its task runs every {}",
                component.codel_name(codel),
                shown(wcet),
                shown(period)
            );
            diagnostics.push(Diagnostic::new(Code::WcetOverPeriod, codel.span, message).also(task.span, "the task"));
        }
    }
    let mut machines: Vec<Machine> = Vec::new();
    machines.extend(machine(component, &task.codels, None));
    for activity in component.activities(id) {
        let codels = component.services.get(activity.0).map_or(&[][..], |s| &s.codels);
        machines.extend(machine(component, codels, Some(activity)));
    }
    overrun(component, task, period, machines, diagnostics);
}

/// An activity, and what it takes in one period at worst.
struct Machine {
    name: String,
    activity: Option<ServiceId>,
    worst_ns: u64,
}

/// The activities of a task that may run together, the longest first, and whether they fit.
fn overrun(
    component: &Component,
    task: &Task,
    period: u64,
    mut machines: Vec<Machine>,
    diagnostics: &mut Vec<Diagnostic>,
) {
    machines.sort_by_key(|m| (m.activity.is_some(), std::cmp::Reverse(m.worst_ns)));
    let excludes = |a: Option<ServiceId>, b: Option<ServiceId>| {
        let interrupts =
            |a: ServiceId, b: ServiceId| component.services.get(a.0).is_some_and(|s| s.interrupts.contains(&b));
        matches!((a, b), (Some(a), Some(b)) if interrupts(a, b) || interrupts(b, a))
    };
    let mut together: Vec<&Machine> = Vec::new();
    for machine in machines.iter().filter(|m| m.worst_ns > 0) {
        if !together.iter().any(|other| excludes(other.activity, machine.activity)) {
            together.push(machine);
        }
    }
    let total = together.iter().fold(0_u64, |sum, m| sum.saturating_add(m.worst_ns));
    // One codel that is too long has been said already, and says this as well.
    let has_long = component.codels.iter().any(|c| c.wcet_ns.is_some_and(|w| w > period));
    if total <= period || has_long {
        return;
    }
    let parts: Vec<String> = together.iter().map(|m| format!("`{}` {}", m.name, shown(m.worst_ns))).collect();
    let message = format!(
        "the task `{}` runs every {}, and what it may have to do in one period takes up to {}",
        task.name,
        shown(period),
        shown(total)
    );
    diagnostics.push(
        Diagnostic::new(Code::PeriodOverrun, task.span, message)
            .help(format!("at worst, without a pause between: {}", parts.join(", ")))
            .help("make the period longer, pause in between, or give the activities tasks of their own"),
    );
}

fn machine(component: &Component, codels: &[CodelId], activity: Option<ServiceId>) -> Option<Machine> {
    let first = codels.iter().find_map(|id| component.codels.get(id.0))?;
    let name = match (first.owner, activity.and_then(|a| component.services.get(a.0))) {
        (_, Some(service)) => service.name.clone(),
        (Owner::Task(task), None) => component.tasks.get(task.0).map(|t| t.name.clone()).unwrap_or_default(),
        (Owner::Service(_), None) => String::new(),
    };
    Some(Machine { name, activity, worst_ns: worst(component, codels) })
}

/// The longest time from a state that a period can begin in to a pause or the end.
///
/// States that lead back to each other without a pause are counted once each: how often they are run nobody knows.
fn worst(component: &Component, codels: &[CodelId]) -> u64 {
    let place = |id: CodelId| codels.iter().position(|c| *c == id);
    let next: Vec<Vec<usize>> = codels
        .iter()
        .map(|id| {
            let yields = component.codels.get(id.0).map_or(&[][..], Codel::yields);
            let target = |t: &crate::model::Transition| match t.to {
                Target::Codel(codel) if !t.pause => place(codel),
                _ => None,
            };
            yields.iter().filter_map(target).collect()
        })
        .collect();
    // An `async` codel is waited for by nobody.
    let cost = |codel: &Codel| if codel.is_async { 0 } else { codel.wcet_ns.unwrap_or(0) };
    let costs: Vec<u64> = codels.iter().map(|id| component.codels.get(id.0).map_or(0, cost)).collect();
    let rings = rings(&next);
    let weight = |ring: usize| {
        rings.iter().zip(&costs).filter(|(r, _)| **r == ring).map(|(_, c)| *c).fold(0, u64::saturating_add)
    };
    // Rings are numbered so that what follows one has a smaller number.
    let count = rings.iter().max().map_or(0, |r| r + 1);
    let mut longest = vec![0_u64; count];
    for ring in 0..count {
        let members = rings.iter().enumerate().filter(|(_, r)| **r == ring).map(|(n, _)| n);
        let after = members
            .flat_map(|n| next.get(n).into_iter().flatten())
            .filter_map(|to| rings.get(*to))
            .filter(|r| **r != ring);
        let best = after.filter_map(|r| longest.get(*r)).max().copied().unwrap_or(0);
        longest[ring] = best.saturating_add(weight(ring));
    }
    longest.into_iter().max().unwrap_or(0)
}

/// The strongly connected components of a graph, by Tarjan's algorithm without recursion: for each node the number of its component.
fn rings(next: &[Vec<usize>]) -> Vec<usize> {
    let count = next.len();
    let (mut order, mut low, mut ring) = (vec![usize::MAX; count], vec![0; count], vec![usize::MAX; count]);
    let (mut stack, mut time, mut found) = (Vec::new(), 0, 0);
    for root in 0..count {
        let mut work = vec![(root, 0)];
        while let Some((node, step)) = work.pop() {
            if step == 0 {
                if order[node] != usize::MAX {
                    continue;
                }
                (order[node], low[node]) = (time, time);
                time += 1;
                stack.push(node);
            }
            if let Some(&to) = next[node].get(step) {
                work.push((node, step + 1));
                if order[to] == usize::MAX {
                    work.push((to, 0));
                } else if ring[to] == usize::MAX {
                    low[node] = low[node].min(order[to]);
                }
                continue;
            }
            if low[node] == order[node] {
                while let Some(member) = stack.pop() {
                    ring[member] = found;
                    if member == node {
                        break;
                    }
                }
                found += 1;
            }
            if let Some((parent, _)) = work.last() {
                low[*parent] = low[*parent].min(low[node]);
            }
        }
    }
    ring
}

/// A time in nanoseconds as people write it: `1.5 ms`.
pub fn shown(ns: u64) -> String {
    let units = [(1_000_000_000, "s"), (1_000_000, "ms"), (1_000, "us"), (1, "ns")];
    let (unit, name) = units.into_iter().find(|(unit, _)| ns >= *unit).unwrap_or((1, "ns"));
    let (whole, rest) = (ns / unit, ns % unit);
    if rest == 0 {
        return format!("{whole} {name}");
    }
    let digits = format!("{rest:0width$}", width = (unit as f64).log10() as usize);
    format!("{whole}.{} {name}", digits.trim_end_matches('0'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_shown_in_their_unit() {
        assert_eq!(
            [0, 999, 1_500, 10_000_000, 1_500_000, 2_000_000_000, 1_000_001].map(shown),
            ["0 ns", "999 ns", "1.5 us", "10 ms", "1.5 ms", "2 s", "1.000001 ms"]
        );
    }

    #[test]
    fn rings_of_a_graph() {
        let found = rings(&[vec![1], vec![2], vec![1, 3], vec![]]);
        assert_eq!(found[1], found[2]);
        assert!(found[3] < found[1] && found[1] < found[0], "{found:?}");
    }
}
