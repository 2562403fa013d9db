//! A run: automata that move, codels that are called, requests that are made, and time, which passes only where nothing else can happen.
//!
//! [`Run::carry_out`] tells an [`Observer`] one [`Happening`] after the other, and in logical time [`Run::advance`] gives them. Nothing happens in
//! between: who asks for a service on hearing of something does so before time passes. In logical time a codel is called where its automaton begins
//! it, what it has done is there when its time is over, and everything that is drawn comes from the seed; in real time codels run on threads of
//! their tasks.

mod calls;
mod crew;
mod known;
mod moves;
mod stage;
mod table;

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender};

use lapwing_genom::Model;
use lapwing_genom::automata::{self, Part, Settings, System};
use lapwing_genom::model::{CodelId, ServiceId};
use lapwing_genom::mutex::Rules;
use lapwing_stream::{Duration, Time};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

use crate::codel::{Answer, Call, Codels};
use crate::figures::Figures;
use crate::happening::{Happening, Outcome, What, Whose};
use crate::machine::Machine;
use crate::request::{self, Request};
use crate::store::{Locals, Store};
use crate::types::Types;

use known::Known;
use stage::{Job, Word};
use table::Table;

pub use stage::Observer;

/// How components are run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Setup {
    /// Whether time is the machine's; else it is only counted.
    pub is_real: bool,
    /// What chance depends on: the same seed gives the same run in logical time.
    pub seed: u64,
    /// How long it takes; without end where nothing is said.
    pub duration: Option<Duration>,
    /// How many instances of an activity there can be.
    pub instances: usize,
    /// What excludes what.
    pub rules: Rules,
    /// In real time, how long a codel may be away before it counts as hung.
    pub patience: Duration,
    /// In real time, whether every task calls its codels on a thread of its own, also those that return at once: for codels that keep something by
    /// thread.
    pub own_threads: bool,
}

impl Default for Setup {
    fn default() -> Setup {
        Setup {
            is_real: false,
            seed: 0,
            duration: None,
            instances: 2,
            rules: Rules::default(),
            patience: Duration::from_nanos(5_000_000_000),
            own_threads: false,
        }
    }
}

/// How much after its period a turn may begin in real time without being called late: what a scheduler takes on a healthy machine.
const TOLERANCE_NS: i64 = 1_000_000;

/// A request that has been made.
#[derive(Clone, Debug)]
struct Pending {
    id: u64,
    whose: Whose,
    locals: Locals,
    values: Vec<crate::datum::Datum>,
}

/// What a cell of a task serves.
#[derive(Clone, Debug, Default)]
struct Serving {
    pending: Option<Pending>,
    outcome: Option<Outcome>,
    /// What its codel has thrown.
    thrown: Option<String>,
}

/// What a codel has done.
struct Done {
    /// None where nobody has written it: then it has changed nothing.
    call: Option<Call>,
    answer: Answer,
    took: Duration,
}

/// What is due in logical time, and in which order at one time.
type Due = Reverse<(i64, u64, usize)>;

/// A run of components.
pub struct Run {
    model: Arc<Model>,
    system: Arc<System>,
    setup: Setup,
    /// By component and codel.
    codels: Vec<Vec<Known>>,
    machine: Machine,
    store: Store,
    random: Pcg64,
    figures: Figures,
    now: Time,
    /// How many requests have been made.
    requests: u64,
    /// How many codels have been called in logical time: those that are due at once return in this order.
    calls: u64,
    /// By automaton: the codel that is being run.
    flights: Vec<Option<CodelId>>,
    /// By automaton, in logical time: what its codel has done, which is known to nobody before it ends.
    held: Vec<Option<Done>>,
    /// In real time: since when codels are away, and of which automata.
    away: Vec<(i64, usize)>,
    returns: BinaryHeap<Due>,
    /// By the number of the cell.
    serving: Vec<Serving>,
    cell_of_automaton: Table,
    cell_of_var: Table,
    task_of_timer: Table,
    task_of_manager: Table,
    /// When the last period of each task began.
    ticked: Vec<Option<Time>>,
    /// By component: the automaton of the control task, the request that it is busy with, and those that wait.
    controls: Vec<Control>,
    later: BinaryHeap<Due>,
    laters: Vec<Option<Request>>,
    happened: VecDeque<Happening>,
    wake: Option<Time>,
    /// In real time: codels that are to be called, and by whom.
    jobs: Vec<Job>,
    /// In real time: how others say something to it.
    mouth: Option<Sender<Word>>,
    /// What they say, before somebody listens.
    words: Option<Receiver<Word>>,
    is_over: bool,
}

#[derive(Default)]
struct Control {
    automaton: usize,
    current: Option<Pending>,
    /// The exception for which the current request is refused or ends.
    thrown: Option<String>,
    /// The last codel that it has run for the current request.
    last: Option<CodelId>,
    waiting: VecDeque<Pending>,
}

/// Why components cannot be run.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CannotRun(pub String);

impl std::fmt::Display for CannotRun {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for CannotRun {}

/// With it other threads ask for services while a run goes on in real time.
#[derive(Clone)]
pub struct Client {
    mouth: Sender<Word>,
}

impl Client {
    /// Asks for a service. `false` where the run is over.
    pub fn request(&self, request: Request) -> bool {
        self.mouth.send(Word::Request(request)).is_ok()
    }

    /// Ends the run.
    pub fn stop(&self) -> bool {
        self.mouth.send(Word::Stop).is_ok()
    }
}

impl Run {
    /// Components before anything has happened.
    ///
    /// # Errors
    ///
    /// They are too large.
    pub fn new(model: Arc<Model>, setup: Setup, codels: Codels) -> Result<Run, CannotRun> {
        let settings = Settings { instances: setup.instances, rules: setup.rules, runtime: true, exceptions: true };
        let system = Arc::new(automata::build(&model, settings).map_err(|e| CannotRun(e.to_string()))?);
        let store = Store::new(&model).map_err(CannotRun)?;
        let mut controls: Vec<Control> = model.components.iter().map(|_| Control::default()).collect();
        for (number, automaton) in system.automata.iter().enumerate().filter(|(_, a)| a.part == Part::Control) {
            if let Some(control) = controls.get_mut(automaton.component) {
                control.automaton = number;
            }
        }
        let cells = || system.cells.iter().enumerate();
        let tasks = || system.tasks.iter().enumerate();
        let (mouth, words) = setup.is_real.then(mpsc::channel).unzip();
        Ok(Run {
            machine: Machine::new(system.clone()),
            store,
            random: Pcg64::new(u128::from(setup.seed), 0x9e37_79b9_7f4a_7c15),
            figures: Figures::default(),
            now: Time(0),
            requests: 0,
            calls: 0,
            flights: system.automata.iter().map(|_| None).collect(),
            held: system.automata.iter().map(|_| None).collect(),
            away: Vec::new(),
            returns: BinaryHeap::new(),
            serving: vec![Serving::default(); system.cells.len()],
            cell_of_automaton: Table::new(system.automata.len(), cells().map(|(n, c)| (c.automaton, n))),
            cell_of_var: Table::new(system.variables.len(), cells().map(|(n, c)| (c.status.0, n))),
            task_of_timer: Table::new(system.automata.len(), tasks().filter_map(|(n, t)| Some((t.timer?, n)))),
            task_of_manager: Table::new(system.automata.len(), tasks().map(|(n, t)| (t.manager, n))),
            ticked: vec![None; system.tasks.len()],
            controls,
            later: BinaryHeap::new(),
            laters: Vec::new(),
            happened: VecDeque::new(),
            wake: None,
            jobs: Vec::new(),
            mouth,
            words,
            is_over: false,
            codels: model
                .components
                .iter()
                .map(|c| c.codels.iter().map(|codel| Known::new(&codels, c, codel)).collect())
                .collect(),
            model,
            system,
            setup,
        })
    }

    /// The components.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// The types of their values.
    pub fn types(&self) -> &Types {
        &self.store.types
    }

    /// How it has gone so far.
    pub fn figures(&self) -> &Figures {
        &self.figures
    }

    /// The present time, counted from the beginning.
    pub fn now(&self) -> Time {
        self.now
    }

    /// A part of the internal data of a component: `delay`, `filter.state[3]`.
    pub fn ids(&self, component: &str, path: &str) -> Option<crate::datum::Datum> {
        let number = self.model.components.iter().position(|c| c.name == component)?;
        self.store.ids(number, path)
    }

    /// Who asks for services from other threads; only in real time.
    pub fn client(&self) -> Option<Client> {
        self.mouth.clone().map(|mouth| Client { mouth })
    }

    /// Has a request made at a time; one in the past is made at once.
    pub fn schedule(&mut self, time: Time, request: Request) {
        self.later.push(Reverse((time.0, self.laters.len() as u64, self.laters.len())));
        self.laters.push(Some(request));
    }

    /// Makes a request now, before all that wait. Gives its number.
    pub fn request_first(&mut self, request: Request, by: Option<String>) -> u64 {
        self.ask(request, by, true)
    }

    /// Makes a request now. Gives its number.
    pub fn request(&mut self, request: Request) -> u64 {
        self.ask(request, None, false)
    }

    /// Makes a request of a service without arguments, or whose parameters all have defaults.
    ///
    /// # Errors
    ///
    /// There is no such service, or it needs values.
    pub fn plain_request(&self, name: &str) -> Result<Request, String> {
        let (component, service) = request::service_of(&self.model, name)?;
        request::plain(&self.model, &self.store.types, component, service)
    }

    /// When [`What::Woken`] is to happen, although nothing else does; `None` for never.
    pub fn wake_at(&mut self, time: Option<Time>) {
        self.wake = time;
    }

    /// Ends it a while after a time, unless it would end before.
    pub fn stop_at(&mut self, time: Time, after: Duration) {
        let end = Duration::from_nanos(time.0.saturating_add(after.nanos()));
        self.setup.duration = Some(self.setup.duration.map_or(end, |before| before.min(end)));
    }

    /// Ends it.
    pub fn stop(&mut self) {
        self.end();
    }

    /// What happens next, in logical time; `None` where it is over.
    pub fn advance(&mut self) -> Option<Happening> {
        loop {
            if let Some(next) = self.step() {
                return Some(next);
            }
            if self.is_over {
                return None;
            }
            match self.next_due().filter(|_| !self.setup.is_real) {
                Some(at) => self.now = Time(at.max(self.now.0)),
                None => self.end(),
            }
        }
    }

    /// What happens next before time passes.
    fn step(&mut self) -> Option<Happening> {
        loop {
            if let Some(next) = self.happened.pop_front() {
                return Some(next);
            }
            if self.is_over {
                return None;
            }
            match self.machine.next(self.now) {
                Some(next) => self.handle(next),
                None if !self.due() => return None,
                None => {}
            }
        }
    }

    fn ask(&mut self, request: Request, by: Option<String>, first: bool) -> u64 {
        self.requests += 1;
        let id = self.requests;
        let whose = Whose { component: request.component, service: request.service };
        self.tell(What::Requested { id, whose, values: request.values.clone(), by });
        let service = self.model.components.get(whose.component).and_then(|c| c.services.get(whose.service.0));
        let (Some(service), Some(control)) = (service, self.controls.get_mut(whose.component)) else { return id };
        let locals = Locals::new(&self.store.types, service, &request.values);
        let pending = Pending { id, whose, locals, values: request.values };
        if first {
            control.waiting.push_front(pending);
        } else {
            control.waiting.push_back(pending);
        }
        let automaton = control.automaton;
        self.machine.rouse(automaton);
        id
    }

    fn tell(&mut self, what: What) {
        self.happened.push_back(Happening { time: self.now, what });
    }

    fn end(&mut self) {
        if !self.is_over {
            self.is_over = true;
            self.tell(What::Over);
        }
    }

    /// When the next thing is due.
    fn next_due(&self) -> Option<i64> {
        let returns = self.returns.peek().map(|Reverse((at, ..))| *at);
        let timer = self.machine.next_timer().map(|t| t.0);
        [returns, timer, self.next_wanted()].into_iter().flatten().min()
    }

    /// When next something is due that somebody outside has asked for.
    fn next_wanted(&self) -> Option<i64> {
        let later = self.later.peek().map(|Reverse((at, ..))| *at);
        let end = self.setup.duration.map(|d| d.nanos());
        [later, self.wake.map(|t| t.0), end].into_iter().flatten().min()
    }

    /// Does one thing that is due by now: codels return, then requests are made, then periods begin, then somebody is woken, then it ends. `false`
    /// where there is none.
    fn due(&mut self) -> bool {
        let now = self.now.0;
        let take = |heap: &mut BinaryHeap<Due>| {
            let is_due = heap.peek().is_some_and(|Reverse((at, ..))| *at <= now);
            if is_due { heap.pop().map(|Reverse((_, _, number))| number) } else { None }
        };
        if let Some(automaton) = take(&mut self.returns) {
            self.land(automaton);
        } else if let Some(number) = take(&mut self.later) {
            if let Some(request) = self.laters.get_mut(number).and_then(Option::take) {
                self.ask(request, None, false);
            }
        } else if let Some((at, next)) = self.machine.tick(self.now) {
            self.ticks(at, next);
        } else if self.wake.is_some_and(|wake| wake.0 <= now) {
            self.wake = None;
            self.tell(What::Woken);
        } else if self.setup.duration.is_some_and(|end| end.nanos() <= now) {
            self.end();
        } else {
            return false;
        }
        true
    }

    /// Evenly from 0 to 1, 1 excluded.
    fn unit(&mut self) -> f64 {
        (self.random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn service(&self, whose: Whose) -> Option<&lapwing_genom::model::Service> {
        self.model.components.get(whose.component)?.services.get(whose.service.0)
    }
}

impl Whose {
    /// The service of that number in a component.
    pub fn new(component: usize, service: ServiceId) -> Whose {
        Whose { component, service }
    }
}
