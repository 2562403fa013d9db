//! A run: an engine that draws lots, a clock, and a log.

mod interactive;
mod world;

pub use world::{Event, Monotonic, Simulated, Woken, World};

use crate::engine::{Engine, Fault, MoveId, Rules, Standing, Violation};
use crate::host::Host;
use crate::log::Log;
use crate::model::Model;
use crate::schedule::{Schedule, Scheduler};
use crate::time::Time;
use std::io::BufRead;
use std::sync::Arc;

/// What is done when time went on further than the model allows.
pub enum Policy<'p, H> {
    /// A warning is logged, and the run goes on.
    Warn,
    /// The run ends, with exit code 7.
    Stop,
    /// Somebody is asked, after a warning: whether the run goes on. The engine may be told of events.
    React(&'p mut dyn FnMut(&mut Engine<H>, &Violation, Time) -> bool),
}

/// How a model is run.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// How moves are chosen.
    pub schedule: Schedule,
    /// Which lots are drawn.
    pub seed: u64,
    /// After how many steps the run ends.
    pub limit: Option<u64>,
    /// What the engine leaves out of the language's rules.
    pub rules: Rules,
    /// By how many nanoseconds deadlines and invariants may be missed without a word.
    pub tolerance: i64,
    /// Whether deadlines are not looked at at all; `resume` is.
    pub relaxed: bool,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            schedule: Schedule::default(),
            seed: 0,
            limit: None,
            rules: Rules::default(),
            tolerance: 1_000_000,
            relaxed: false,
        }
    }
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// Nothing was possible any more.
    Stuck(Standing),
    /// As many steps were made as had been asked for.
    Limit,
    /// Whoever chose the steps did not want any more.
    Quit,
    /// Something went wrong.
    Fault(Fault),
}

impl Ending {
    /// The exit code of the run.
    pub fn code(&self) -> u8 {
        match self {
            Ending::Stuck(_) | Ending::Limit | Ending::Quit => 0,
            Ending::Fault(fault) => fault.code(),
        }
    }
}

/// A run of a model.
pub struct Run<'r, H, W> {
    options: Options,
    policy: Policy<'r, H>,
    world: W,
    log: Log<'r>,
    scheduler: Scheduler,
    /// Who chooses the steps, instead of the lots.
    input: Option<Box<dyn BufRead + 'r>>,
}

/// What is done next.
enum Choice {
    Make(MoveId, Time),
    Quit,
}

impl<'r, H: Host, W: World> Run<'r, H, W> {
    /// A run that has not begun.
    pub fn new(options: Options, world: W, log: Log<'r>) -> Run<'r, H, W> {
        let scheduler = Scheduler::new(options.schedule, options.seed);
        Run { options, policy: Policy::Stop, world, log, scheduler, input: None }
    }

    /// With another policy than [`Policy::Stop`].
    pub fn policy(mut self, policy: Policy<'r, H>) -> Run<'r, H, W> {
        self.policy = policy;
        self
    }

    /// Lets somebody choose the steps who answers questions in the log.
    pub fn interactive(mut self, input: impl BufRead + 'r) -> Run<'r, H, W> {
        self.input = Some(Box::new(input));
        self
    }

    /// Runs the model to its end.
    pub fn run(mut self, model: Arc<Model>, host: H) -> Ending {
        self.log.banner(self.options.seed);
        let ending = match Engine::new(model, host, self.options.rules) {
            Ok(mut engine) => self.steps(&mut engine).unwrap_or_else(Ending::Fault),
            Err(fault) => Ending::Fault(fault),
        };
        if let Ending::Fault(fault) = &ending {
            self.log.error(fault);
        }
        self.log.flush();
        ending
    }

    fn steps(&mut self, engine: &mut Engine<H>) -> Result<Ending, Fault> {
        self.settle(engine)?;
        loop {
            if let Some(limit) = self.options.limit.filter(|limit| self.log.state() >= *limit) {
                self.log.limit(engine.now(), limit);
                return Ok(Ending::Limit);
            }
            for event in self.world.events(engine.now()) {
                engine.notify(event.port, &event.values, event.at)?;
            }
            let standing = engine.look()?;
            if standing != Standing::Open {
                if engine.awaits_events() && self.world.wait_until(engine.patience()) == Woken::ByEvent {
                    continue;
                }
                self.log.stuck(engine.now(), standing);
                return Ok(Ending::Stuck(standing));
            }
            match self.choose(engine) {
                Choice::Quit => return Ok(Ending::Quit),
                Choice::Make(id, at) => self.step(engine, id, at)?,
            }
        }
    }

    fn choose(&mut self, engine: &Engine<H>) -> Choice {
        let Some(input) = &mut self.input else {
            return match self.scheduler.choose(engine) {
                Some((id, at)) => Choice::Make(id, at),
                None => Choice::Quit,
            };
        };
        self.log.possible(engine);
        interactive::choose(engine, &mut self.scheduler, &self.log, input)
    }

    /// Waits for the moment and makes the move, unless an event comes first.
    fn step(&mut self, engine: &mut Engine<H>, id: MoveId, at: Time) -> Result<(), Fault> {
        if self.world.wait_until(at) == Woken::ByEvent {
            return Ok(());
        }
        if self.input.is_none() {
            self.log.possible(engine);
        }
        self.log.chosen(engine, id, at);
        self.log.next_state();
        engine.make(id, at)?;
        self.settle(engine)
    }

    /// The actions have been carried out: looks at the clock.
    fn settle(&mut self, engine: &mut Engine<H>) -> Result<(), Fault> {
        let actual = self.world.actual(engine.now());
        let tolerance = if self.options.relaxed { i64::MAX } else { self.options.tolerance };
        let violations = engine.settle(actual, tolerance)?;
        if violations.is_empty() {
            return Ok(());
        }
        let violated = |engine: &Engine<H>| violations.iter().map(|v| engine.show_violation(v)).collect();
        let stop = |engine: &Engine<H>| Err(Fault::TimeSafety { at: actual, violated: violated(engine) });
        if matches!(self.policy, Policy::Stop) {
            return stop(engine);
        }
        for violation in &violations {
            self.log.warning(actual, &engine.violator(violation), &engine.show_violation(violation));
            if let Policy::React(react) = &mut self.policy
                && !react(engine, violation, actual)
            {
                return stop(engine);
            }
        }
        Ok(())
    }
}
