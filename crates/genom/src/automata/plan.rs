//! The variables of a system and what they stand for, laid out before any automaton is made.

use std::collections::{BTreeMap, BTreeSet};

use super::builder::unique;
use super::{Action, Automaton, Cond, Settings, System, TaskParts, VarId, Variable, activity, control, task};
use crate::model::{CodelId, Component, Model, Role, ServiceId, TaskId};
use crate::mutex::{Mutex, Which};

/// The statuses of a cell, as the UPPAAL templates number them: two more is an interruption.
pub mod status {
    /// The activity runs, or will in the next turn of its task.
    pub const RUN: i64 = 0;
    /// It waits until those that it interrupts have ended.
    pub const WAIT: i64 = 1;
    /// It was running and is to stop.
    pub const STOP: i64 = 2;
    /// It has ended, which has not been reported yet.
    pub const ETHER: i64 = 3;
    /// There is no such activity.
    pub const VOID: i64 = 4;
}

/// A cell of the table `run` of a task.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    /// The activity; none for the permanent one.
    pub activity: Option<ServiceId>,
    /// Which of the activity's instances it is, from 1.
    pub instance: usize,
    /// What its automaton is called.
    pub name: String,
    /// Its status.
    pub run: VarId,
    /// What the control is when the cell has it: its number in the table and one.
    pub turn: i64,
}

/// A task.
#[derive(Clone, Debug)]
pub(super) struct TaskPlan {
    pub id: TaskId,
    /// A period has begun that the manager has not seen.
    pub sig: VarId,
    /// Who has the control: 0 for the manager, else a cell's turn.
    pub pi: VarId,
    /// The cell that is being looked at.
    pub i: VarId,
    pub cells: Vec<Cell>,
    pub is_periodic: bool,
}

/// A component.
pub(super) struct Plan<'m> {
    pub number: usize,
    pub component: &'m Component,
    pub settings: Settings,
    pub mutex: &'m Mutex,
    /// For every codel that excludes others: whether it runs.
    pub locks: &'m BTreeMap<Which, VarId>,
    pub tasks: Vec<TaskPlan>,
    /// An activity has ended.
    pub sched: VarId,
    /// How many permanent activities have started, where there are any.
    pub spawned: Option<VarId>,
    /// Tasks whose permanent activity has a `start`, in the order in which they do.
    pub spawns: Vec<TaskId>,
    /// Services whose first success others wait for.
    pub done: BTreeMap<ServiceId, VarId>,
}

impl Plan<'_> {
    /// The lock of a codel, where it has one.
    pub(super) fn lock(&self, codel: CodelId) -> Option<VarId> {
        self.locks.get(&(self.number, codel)).copied()
    }

    /// None of the codels that a codel excludes runs.
    pub(super) fn is_free(&self, codel: CodelId) -> Cond {
        let others = self.mutex.of((self.number, codel)).iter();
        Cond::All(others.filter_map(|other| self.locks.get(other)).map(|lock| Cond::Is(*lock, 0)).collect())
    }

    /// Wakes the tasks that wait for something to happen, but for one.
    pub(super) fn wake(&self, except: Option<TaskId>) -> Vec<Action> {
        let waiting = self.tasks.iter().filter(|t| !t.is_periodic && Some(t.id) != except);
        waiting.map(|t| Action::Set(t.sig, 1)).collect()
    }

    /// All cells of activities with their tasks.
    pub(super) fn cells(&self) -> impl Iterator<Item = (&TaskPlan, &Cell)> {
        self.tasks
            .iter()
            .flat_map(|task| task.cells.iter().map(move |cell| (task, cell)))
            .filter(|(_, cell)| cell.activity.is_some())
    }
}

impl TaskPlan {
    /// `i := next(run, from)`: the first cell from there on that has something to do, or their number.
    pub(super) fn next(&self, from: usize) -> Action {
        let end = Action::Set(self.i, self.cells.len() as i64);
        let cells = self.cells.iter().enumerate().skip(from).rev();
        cells.fold(end, |rest, (number, cell)| {
            let is_active = Cond::Any(vec![Cond::Is(cell.run, status::RUN), Cond::Is(cell.run, status::STOP)]);
            Action::If(is_active, vec![Action::Set(self.i, number as i64)], vec![rest])
        })
    }
}

/// The variables of a system while they are being laid out.
#[derive(Default)]
struct Variables {
    all: Vec<Variable>,
    names: BTreeSet<String>,
}

impl Variables {
    /// A truth value, false at first.
    fn flag(&mut self, name: &str, meaning: String) -> VarId {
        self.add(Variable { name: name.to_owned(), is_bool: true, range: (0, 1), initial: 0, meaning })
    }

    /// A number from 0.
    fn number(&mut self, name: &str, most: i64, initial: i64, meaning: String) -> VarId {
        self.add(Variable { name: name.to_owned(), is_bool: false, range: (0, most), initial, meaning })
    }

    fn add(&mut self, mut variable: Variable) -> VarId {
        variable.name = unique(&variable.name, |n| self.names.contains(n));
        self.names.insert(variable.name.clone());
        self.all.push(variable);
        VarId(self.all.len() - 1)
    }
}

/// The automata of a model.
pub(super) fn system(model: &Model, settings: Settings) -> System {
    let mutex = Mutex::symmetric(model, settings.rules);
    let mut variables = Variables::default();
    let mut locks = BTreeMap::new();
    for (number, component) in model.components.iter().enumerate() {
        for (id, codel) in component.codels().filter(|(id, _)| mutex.is_unsafe((number, *id))) {
            let name = component.codel_name(codel);
            let short = match codel.role {
                Role::Simple => name.split('.').next().unwrap_or("").to_owned(),
                _ => name.replace('.', "_"),
            };
            let lock =
                variables.flag(&format!("{}_r_{short}", component.name), format!("`{}.{name}` runs", component.name));
            locks.insert((number, id), lock);
        }
    }
    let plans: Vec<Plan<'_>> = model
        .components
        .iter()
        .enumerate()
        .map(|(number, component)| plan(number, component, settings, &mutex, &locks, &mut variables))
        .collect();
    let mut automata: Vec<Automaton> = Vec::new();
    let (mut cells, mut tasks) = (Vec::new(), Vec::new());
    for plan in &plans {
        automata.push(control::automaton(plan));
        for task in &plan.tasks {
            let timer = task::timer(plan, task);
            let parts = TaskParts {
                component: plan.number,
                task: task.id,
                timer: timer.is_some().then_some(automata.len()),
                manager: automata.len() + usize::from(timer.is_some()),
                sig: task.sig,
            };
            tasks.push(parts);
            automata.extend(timer);
            automata.push(task::manager(plan, task));
            for (place, cell) in task.cells.iter().enumerate() {
                cells.push(super::Cell {
                    automaton: automata.len(),
                    component: plan.number,
                    task: task.id,
                    activity: cell.activity,
                    instance: cell.instance,
                    status: cell.run,
                });
                automata.push(activity::automaton(plan, task, place, &mut |name, most, meaning| match most {
                    None => variables.flag(name, meaning),
                    Some(most) => variables.number(name, most, 0, meaning),
                }));
            }
        }
    }
    unique_names(&mut automata);
    let names: Vec<&str> = model.components.iter().map(|c| c.name.as_str()).collect();
    System { name: names.join("_"), variables: variables.all, automata, cells, tasks }
}

/// Two components may have names that come out alike once they are joined with those of their tasks.
fn unique_names(automata: &mut [Automaton]) {
    let mut taken = BTreeSet::new();
    for automaton in automata {
        automaton.name = unique(&automaton.name, |n| taken.contains(n));
        taken.insert(automaton.name.clone());
    }
}

fn plan<'m>(
    number: usize,
    component: &'m Component,
    settings: Settings,
    mutex: &'m Mutex,
    locks: &'m BTreeMap<Which, VarId>,
    variables: &mut Variables,
) -> Plan<'m> {
    let name = &component.name;
    let begins = |codels: &[CodelId]| {
        codels.iter().filter_map(|c| component.codels.get(c.0)).any(|c| c.triggers().iter().any(|t| t == "start"))
    };
    let spawns: Vec<TaskId> =
        component.tasks.iter().enumerate().filter(|(_, t)| begins(&t.codels)).map(|(n, _)| TaskId(n)).collect();
    let tasks = (0..component.tasks.len())
        .map(|n| task_plan(component, TaskId(n), spawns.contains(&TaskId(n)), settings, variables))
        .collect();
    let sched = variables.flag(&format!("{name}_sched"), format!("an activity of `{name}` has ended"));
    let spawned = (!spawns.is_empty()).then(|| {
        let meaning = format!("how many permanent activities of `{name}` have started");
        variables.number(&format!("{name}_spawned"), spawns.len() as i64, 0, meaning)
    });
    let waited: BTreeSet<ServiceId> =
        (0..component.services.len()).flat_map(|n| required(component, ServiceId(n))).collect();
    let done = waited
        .into_iter()
        .filter_map(|id| {
            let service = component.services.get(id.0)?;
            let meaning = format!("`{name}.{}` has succeeded once", service.name);
            Some((id, variables.flag(&format!("{name}_done_{}", service.name), meaning)))
        })
        .collect();
    Plan { number, component, settings, mutex, locks, tasks, sched, spawned, spawns, done }
}

fn task_plan(
    component: &Component,
    id: TaskId,
    has_permanent: bool,
    settings: Settings,
    variables: &mut Variables,
) -> TaskPlan {
    let task = component.tasks.get(id.0);
    let name = task.map_or("", |t| t.name.as_str());
    let prefix = format!("{}_{name}", component.name);
    let mut owners: Vec<(Option<ServiceId>, usize, String)> = Vec::new();
    if has_permanent {
        owners.push((None, 1, format!("{prefix}_permanent")));
    }
    for activity in component.activities(id) {
        let Some(service) = component.services.get(activity.0).filter(|s| !s.codels.is_empty()) else { continue };
        for instance in 1..=settings.instances {
            let number = if settings.instances > 1 { format!("_{instance}") } else { String::new() };
            owners.push((Some(activity), instance, format!("{}_{}{number}", component.name, service.name)));
        }
    }
    let count = owners.len() as i64;
    let sig = variables.flag(&format!("{prefix}_sig"), format!("a turn of the task `{name}` is due"));
    let pi = variables.number(
        &format!("{prefix}_pi"),
        count,
        0,
        format!("who has the control in the task `{name}`: 0 its manager, else a cell and one"),
    );
    let i =
        variables.number(&format!("{prefix}_i"), count, 0, format!("the cell that the manager of `{name}` looks at"));
    let cells = owners
        .into_iter()
        .enumerate()
        .map(|(number, (activity, instance, owner))| {
            let initial = if activity.is_none() { status::RUN } else { status::VOID };
            let meaning =
                format!("the status of `{owner}`: 0 runs, 1 waits, 2 is to stop, 3 has ended, 4 is not there");
            let run = variables.number(&format!("{prefix}_run_{number}_s"), status::VOID, initial, meaning);
            Cell { activity, instance, name: owner, run, turn: number as i64 + 1 }
        })
        .collect();
    TaskPlan { id, sig, pi, i, cells, is_periodic: task.is_some_and(|t| t.period_ns.is_some()) }
}

/// The services that must have succeeded before one is accepted: what it comes after, and what says that it comes before it.
pub(super) fn required(component: &Component, service: ServiceId) -> Vec<ServiceId> {
    let after = component.services.get(service.0).map_or(&[][..], |s| &s.after);
    let before =
        component.services.iter().enumerate().filter(|(_, s)| s.before.contains(&service)).map(|(n, _)| ServiceId(n));
    let mut all: Vec<ServiceId> = after.iter().copied().chain(before).collect();
    all.sort();
    all.dedup();
    all
}
