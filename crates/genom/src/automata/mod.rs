//! Components as timed automata with data and urgencies: what Foughali et al. (MEMOCODE 2020, section III-B1) call their DUTA implementation.
//!
//! A [`System`] is automata over shared variables. Every task is a timer, a manager, the permanent activity if it has one, and its
//! activities; every component has a control task besides. All is plain data: guards compare a variable with a number, actions set one.
//!
//! ```text
//! timer ──sig──▶ manager ──Π──▶ activity   runs until it pauses or ends, then gives Π back
//!                   ▲              │
//!                   └──sched──▶ control ──run──▶ (which activities the manager finds)
//! ```
//!
//! What the paper leaves to its prose is written out here as guards:
//!
//! - Starting, resuming and taking a lock after a pause need the status `RUN`; interrupting needs `STOP`.
//! - An activity without `stop` that is interrupted goes to `ether` as if it had ended.
//! - An activity that pauses on its way from `stop` to `ether` resumes there; `stopping` tells it from one that is to be interrupted.
//! - Locks exclude each other both ways, and across components where they share a port.
//! - A codel without an execution time takes some time, and nobody knows how much.
//!
//! And what it does not have:
//!
//! - Several instances of an activity, each an automaton with a cell of its own in the task's table `run`.
//! - Permanent activities: the first cell of their task. They start one after the other, before timers and the control task do.
//! - Tasks without a period: their manager wakes when an activity of theirs is launched, and when a codel of another task makes a transition that is no pause.
//! - `async` codels: the activity gives the control back when one begins, and takes part again in the first turn of its task after it has ended.
//! - The control task, after the UPPAAL templates of Foughali and Ingrand, with statuses numbered as there.

mod activity;
mod builder;
mod control;
mod plan;
mod task;

use std::fmt;

use lapwing_diag::Span;

use crate::model::{Codel, CodelId, Model, ServiceId, TaskId, Transition};
use crate::mutex::Rules;

pub use plan::status;

/// How to make automata of components.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Settings {
    /// How many instances of an activity can be there at once; at least one.
    pub instances: usize,
    /// What excludes what.
    pub rules: Rules,
    /// Whether codels are called, as the paper's section III-B4 extends the automata; else they only take time.
    pub runtime: bool,
    /// Whether what is called may also throw an exception, which ends its activity or service. Without `runtime` it makes no difference.
    pub exceptions: bool,
}

impl Default for Settings {
    /// Two instances, as GenoM3's published models have: one that ends, and one that waits for that.
    fn default() -> Settings {
        Settings { instances: 2, rules: Rules::default(), runtime: false, exceptions: false }
    }
}

/// The number of a variable in [`System::variables`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct VarId(pub usize);
/// The number of a location in its automaton.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct LocId(pub usize);

/// The location in which every activity begins and ends.
pub const ETHER: LocId = LocId(0);

/// Automata over shared variables.
#[derive(Clone, Debug, Default)]
pub struct System {
    /// What it is called: the names of its components.
    pub name: String,
    /// The variables.
    pub variables: Vec<Variable>,
    /// The automata.
    pub automata: Vec<Automaton>,
    /// The cells of the tables `run`: which automaton is which instance of what.
    pub cells: Vec<Cell>,
    /// The tasks: which automata and variables are theirs.
    pub tasks: Vec<TaskParts>,
}

/// An entry of a task's table `run`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Cell {
    /// Its automaton.
    pub automaton: usize,
    /// The number of the component.
    pub component: usize,
    /// The task.
    pub task: TaskId,
    /// The activity; none for the permanent one.
    pub activity: Option<ServiceId>,
    /// Which of the activity's instances it is, from 1.
    pub instance: usize,
    /// Its status, as [`status`] numbers them.
    pub status: VarId,
}

/// The automata and variables of a task.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TaskParts {
    /// The number of the component.
    pub component: usize,
    /// The task.
    pub task: TaskId,
    /// Its timer, where it has a period.
    pub timer: Option<usize>,
    /// Its manager; that waits for a turn where it begins.
    pub manager: usize,
    /// A turn is due.
    pub sig: VarId,
}

/// A variable: an integer with bounds, or a truth value as 0 and 1.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Its name, which no other has.
    pub name: String,
    /// Whether it is a truth value.
    pub is_bool: bool,
    /// Its least and greatest values.
    pub range: (i64, i64),
    /// Its first value.
    pub initial: i64,
    /// What it stands for.
    pub meaning: String,
}

/// An automaton with one clock, `x`.
#[derive(Clone, Debug)]
pub struct Automaton {
    /// Its name, which no other has.
    pub name: String,
    /// What it stands for.
    pub part: Part,
    /// The number of its component.
    pub component: usize,
    /// Where that stands in the specification.
    pub span: Span,
    /// Its locations; the first is where it begins.
    pub locations: Vec<Location>,
    /// Its edges.
    pub edges: Vec<Edge>,
}

impl Automaton {
    /// The edge by which a control task takes a request for a service.
    pub fn request(&self, service: ServiceId) -> Option<&Edge> {
        self.edges.iter().find(|e| e.request == Some(service))
    }
}

/// What an automaton stands for.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Part {
    /// The control task.
    Control,
    /// The timer of a task.
    Timer,
    /// The manager of a task.
    Manager,
    /// The permanent activity of a task.
    Permanent,
    /// An instance of an activity.
    Activity,
}

/// A location.
#[derive(Clone, Debug)]
pub struct Location {
    /// Its name in its automaton.
    pub name: String,
    /// How long the clock may run in it, in nanoseconds.
    pub invariant_ns: Option<u64>,
    /// The codel that runs in it, if one does.
    pub codel: Option<CodelId>,
    /// Where the specification has it.
    pub span: Span,
}

/// What an edge is for: the sets of the paper's Definition 1, and those of the other automata.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Class {
    /// `P`: a transition that pauses.
    Pause,
    /// `T`: a transition to `ether`.
    Termination,
    /// `X`: any other transition.
    Execution,
    /// `S`: from `ether` to `start`.
    Start,
    /// `I`: to `stop`.
    Interruption,
    /// `M`: taking a lock.
    Mutex,
    /// `R`: going on after a pause.
    Resume,
    /// Asking a codel where to go.
    Call,
    /// An `async` codel: letting the control pass by, or its end.
    Async,
    /// A period begins.
    Tick,
    /// What a manager does.
    Manage,
    /// A request arrives.
    Request,
    /// What else the control task does.
    Control,
}

/// An edge.
#[derive(Clone, Debug)]
pub struct Edge {
    /// Its name, which no other edge of the automaton has.
    pub name: String,
    /// Where it begins.
    pub from: LocId,
    /// Where it leads.
    pub to: LocId,
    /// What it is for.
    pub class: Class,
    /// The service for which a request arrives, where its class is [`Class::Request`].
    pub request: Option<ServiceId>,
    /// What must hold of variables.
    pub guard: Cond,
    /// What must hold of the clock.
    pub clock: Option<ClockGuard>,
    /// Whether time may not pass while it can be taken.
    pub eager: bool,
    /// What it does, in order.
    pub actions: Vec<Action>,
    /// Whether it sets the clock to zero.
    pub resets: bool,
    /// The codel that it calls, and within which time that must have returned.
    pub call: Option<Call>,
    /// Whether it leaves a codel of the control task that has refused, or has thrown an exception.
    pub is_refusal: bool,
    /// The function or attribute on which it is reported, as done or as refused. Activities are reported together, when they have ended.
    pub concludes: Option<ServiceId>,
    /// Where the specification has it.
    pub span: Span,
}

/// A call of a codel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Call {
    /// Which.
    pub codel: CodelId,
    /// Its execution time in nanoseconds, where it has one.
    pub wcet_ns: Option<u64>,
    /// Where the number of the event that it returns is kept, where that matters, and the events by their numbers.
    pub result: Option<(VarId, Vec<String>)>,
}

/// What must hold of the clock.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ClockGuard {
    /// Some time has passed.
    Positive,
    /// That many nanoseconds have passed.
    Exactly(u64),
}

/// A condition on variables.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Cond {
    /// The variable has the value.
    Is(VarId, i64),
    /// It has another.
    Not(VarId, i64),
    /// It has a lesser one.
    Less(VarId, i64),
    /// All hold; with none in it, always.
    All(Vec<Cond>),
    /// One holds at least.
    Any(Vec<Cond>),
}

impl Cond {
    /// Always.
    pub fn always() -> Cond {
        Cond::All(Vec::new())
    }

    /// Both.
    pub fn and(self, other: Cond) -> Cond {
        let parts = |cond| match cond {
            Cond::All(parts) => parts,
            one => vec![one],
        };
        let mut all = parts(self);
        all.extend(parts(other));
        if all.len() == 1 { all.swap_remove(0) } else { Cond::All(all) }
    }

    /// Whether it holds where variables have these values.
    pub fn holds(&self, values: &[i64]) -> bool {
        let value = |var: &VarId| values.get(var.0).copied().unwrap_or(0);
        match self {
            Cond::Is(var, wanted) => value(var) == *wanted,
            Cond::Not(var, wanted) => value(var) != *wanted,
            Cond::Less(var, bound) => value(var) < *bound,
            Cond::All(parts) => parts.iter().all(|p| p.holds(values)),
            Cond::Any(parts) => parts.iter().any(|p| p.holds(values)),
        }
    }

    /// Calls `see` with every variable in it.
    pub fn variables(&self, see: &mut impl FnMut(VarId)) {
        match self {
            Cond::Is(var, _) | Cond::Not(var, _) | Cond::Less(var, _) => see(*var),
            Cond::All(parts) | Cond::Any(parts) => parts.iter().for_each(|p| p.variables(see)),
        }
    }
}

/// What an edge does.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Action {
    /// Gives a variable a value.
    Set(VarId, i64),
    /// Adds to a variable.
    Add(VarId, i64),
    /// One of two lists.
    If(Cond, Vec<Action>, Vec<Action>),
}

impl Action {
    /// Carries it out.
    pub fn apply(&self, values: &mut [i64]) {
        match self {
            Action::Set(var, value) => {
                if let Some(place) = values.get_mut(var.0) {
                    *place = *value;
                }
            }
            Action::Add(var, value) => {
                if let Some(place) = values.get_mut(var.0) {
                    *place += value;
                }
            }
            Action::If(cond, then, otherwise) => {
                let actions = if cond.holds(values) { then } else { otherwise };
                actions.iter().for_each(|action| action.apply(values));
            }
        }
    }

    /// Calls `see` with every variable that it may change.
    pub fn writes(&self, see: &mut impl FnMut(VarId)) {
        match self {
            Action::Set(var, _) | Action::Add(var, _) => see(*var),
            Action::If(_, then, otherwise) => then.iter().chain(otherwise).for_each(|a| a.writes(see)),
        }
    }

    /// Calls `see` with every variable on which depends what it does.
    pub fn reads(&self, see: &mut impl FnMut(VarId)) {
        match self {
            Action::Set(..) => {}
            Action::Add(var, _) => see(*var),
            Action::If(cond, then, otherwise) => {
                cond.variables(see);
                then.iter().chain(otherwise).for_each(|a| a.reads(see));
            }
        }
    }
}

/// What a [`Call`] returns for an exception, as its list of events has it.
pub const EXCEPTION: &str = "an exception";

/// The place of an event, `main` or `pause::main`, among those that a call of the codel can return: events that lead to the same place are one.
pub fn branch(codel: &Codel, event: &str) -> Option<usize> {
    let transition = codel.yields().iter().find(|t| t.text() == event)?;
    let is_same = |t: &Transition| (t.pause, t.to) == (transition.pause, transition.to);
    activity::successors(codel).iter().position(is_same)
}

/// The place of an exception among what a call of the codel can return, where exceptions are [set](Settings::exceptions).
pub fn branch_of_exception(codel: &Codel) -> usize {
    activity::successors(codel).len()
}

/// A task with more activities, times their instances, than a manager written out as nested conditions can have.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct TooLarge {
    /// The component and the task.
    pub task: String,
    /// How many cells its table would have.
    pub cells: usize,
}

/// The table of a task has no more cells.
pub const MOST_CELLS: usize = 128;

impl fmt::Display for TooLarge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the task `{}` would have {} instances of activities, and {MOST_CELLS} are the limit",
            self.task, self.cells
        )
    }
}

impl std::error::Error for TooLarge {}

/// The automata of a model.
///
/// # Errors
///
/// A task has too many activities for its table.
pub fn build(model: &Model, settings: Settings) -> Result<System, TooLarge> {
    let settings = Settings { instances: settings.instances.max(1), ..settings };
    for component in &model.components {
        for (number, task) in component.tasks.iter().enumerate() {
            let activities = component.activities(TaskId(number)).count();
            let cells = activities.saturating_mul(settings.instances).saturating_add(1);
            if cells > MOST_CELLS {
                return Err(TooLarge { task: format!("{}.{}", component.name, task.name), cells });
            }
        }
    }
    Ok(plan::system(model, settings))
}
