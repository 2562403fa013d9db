//! A monitor in the making.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use lapwing::{Spec, SpecError};
use lapwing_check::checked::{self, Action};
use lapwing_diag::suggest::{listed, nearest};
use lapwing_stream::Time;

use crate::clock::{Clock, SystemClock};
use crate::desk::{Desk, Listener};
use crate::handlers::{Handler, Handlers, Violation};
use crate::monitor::{Monitor, Names, Shared};
use crate::reaction::Reactions;
use crate::recorder::Recorder;
use crate::sites::Sites;
use crate::wants::{MOST, Wants};

/// A monitor in the making. `C` is the context that handlers get.
pub struct Builder<C = ()> {
    spec: Spec,
    context: C,
    handlers: Handlers<C>,
    clock: Box<dyn Clock>,
    listeners: Vec<Listener>,
    assumed: BTreeSet<String>,
    recording: Option<Box<dyn Write + Send>>,
    wakes: bool,
}

impl Builder {
    pub(crate) fn new(spec: Spec) -> Builder {
        Builder {
            spec,
            context: (),
            handlers: Handlers::new(),
            clock: Box::new(SystemClock::new()),
            listeners: Vec::new(),
            assumed: BTreeSet::new(),
            recording: None,
            wakes: true,
        }
    }

    /// What handlers get of the program, and the handlers: every `run NAME` of the specification needs one.
    pub fn handlers<C>(self, context: C, handlers: Handlers<C>) -> Builder<C> {
        let Builder { spec, clock, listeners, assumed, recording, wakes, .. } = self;
        Builder { spec, context, handlers, clock, listeners, assumed, recording, wakes }
    }
}

impl<C: Send + Sync + 'static> Builder<C> {
    /// The clock by which stamps are given: the machine's, unless another is set.
    #[must_use]
    pub fn clock(mut self, clock: impl Clock) -> Builder<C> {
        self.clock = Box::new(clock);
        self
    }

    /// Tells someone of every violation, on the thread that caused it and before its handlers run. A listener must not wait.
    #[must_use]
    pub fn on_violation(mut self, listener: impl Fn(&Violation<'_>) + Send + Sync + 'static) -> Builder<C> {
        self.listeners.push(Box::new(listener));
        self
    }

    /// These functions and fields, named as in the specification, are in the program and instrumented. What is never reached is otherwise taken
    /// for what may be missing, since `tracing` knows a call site only once it is passed: what needs it is inconclusive.
    ///
    /// ```
    /// # use lapwing_tracing::{Monitor, Spec};
    /// # let spec = Spec::parse("a.rv", "event kick = call Kicker::kick\nalways not kick\n", &|_| None).unwrap();
    /// let monitor = Monitor::builder(spec).assume_instrumented(["Kicker::kick"]).build()?;
    /// assert_eq!(monitor.finish().properties[0].verdict.word(), "inconclusive", "nothing at all has come");
    /// # Ok::<(), lapwing_tracing::BuildError>(())
    /// ```
    #[must_use]
    pub fn assume_instrumented<'n>(mut self, names: impl IntoIterator<Item = &'n str>) -> Builder<C> {
        self.assumed.extend(names.into_iter().map(str::to_owned));
        self
    }

    /// Writes down what arrives, as NDJSON: `lapwing check` with the same specification gives the same verdicts on it. A file is best buffered.
    #[must_use]
    pub fn record(mut self, out: impl Write + Send + 'static) -> Builder<C> {
        self.recording = Some(Box::new(out));
        self
    }

    /// No thread waits for deadlines: the host calls [`Monitor::advance`] where it wants them to be noticed, and handlers run on its threads
    /// alone.
    #[must_use]
    pub fn without_waker(mut self) -> Builder<C> {
        self.wakes = false;
        self
    }

    /// The monitor. It watches nothing yet but what it is told.
    pub fn build(self) -> Result<Monitor, BuildError> {
        let Builder { spec, context, handlers, clock, listeners, assumed, recording, wakes } = self;
        let places = |span| spec.findings().sources.position(span).0;
        let monitor = lapwing::Monitor::new(spec.clone());
        let meaning = monitor.meaning();
        let handlers = handlers.bind(context);
        let missing = missing_handlers(meaning, &handlers, spec.name(), &places);
        if !missing.is_empty() {
            return Err(BuildError::MissingHandlers(missing));
        }
        let idle = idle_handlers(meaning, &handlers);
        let wants = Wants::of(meaning).ok_or(BuildError::TooMuch)?;
        let names = Names::of(meaning);
        let reactions = Reactions::new(meaning, handlers);
        let recorder = recording.map(|out| Recorder::new(out, meaning));
        let idle = idle.map(|names| format!("no reaction of {} runs what is registered as {names}", spec.name()));
        let has_waker = wakes && monitor.may_wait() && clock.until_beyond(Time(i64::MAX)).is_some();
        let desk = Arc::new(Desk::new(monitor, clock, reactions, listeners, recorder, has_waker));
        idle.into_iter().for_each(|message| desk.warn(message));
        if has_waker {
            desk.clone().start_watch().map_err(BuildError::NoThread)?;
        }
        Ok(Monitor::new(Shared { desk, sites: Sites::new(wants), names, assumed, is_told: AtomicBool::default() }))
    }

    /// The monitor, watching the whole program: [`Monitor::install`].
    pub fn install(self) -> Result<Monitor, BuildError> {
        let monitor = self.build()?;
        monitor.install()?;
        Ok(monitor)
    }
}

/// The handlers that reactions call by names that nobody has registered, with their places.
fn missing_handlers(
    meaning: &checked::Spec,
    handlers: &BTreeMap<String, Handler>,
    file: &str,
    line: &dyn Fn(lapwing_diag::Span) -> usize,
) -> Vec<MissingHandler> {
    let called = meaning.reactions.iter().flat_map(|r| r.actions.iter().map(move |action| (r, action)));
    let missing = called.filter_map(|(reaction, action)| match action {
        Action::Run(name) if !handlers.contains_key(name) => Some(MissingHandler {
            name: name.clone(),
            file: file.to_owned(),
            line: line(reaction.span),
            known: handlers.keys().cloned().collect(),
        }),
        _ => None,
    });
    missing.collect()
}

/// The handlers that no reaction calls, in words.
fn idle_handlers(meaning: &checked::Spec, handlers: &BTreeMap<String, Handler>) -> Option<String> {
    let actions = || meaning.reactions.iter().flat_map(|r| &r.actions);
    let is_called = |name: &str| actions().any(|action| matches!(action, Action::Run(called) if called == name));
    let idle: Vec<&str> = handlers.keys().map(String::as_str).filter(|name| !is_called(name)).collect();
    (!idle.is_empty()).then(|| listed(idle))
}

/// Why there is no monitor.
#[derive(Debug)]
pub enum BuildError {
    /// The specification is wrong.
    Spec(SpecError),
    /// Reactions call handlers that nobody has registered.
    MissingHandlers(Vec<MissingHandler>),
    /// More functions follow `below`, or more fields of events are read, than can be kept account of.
    TooMuch,
    /// The program has a subscriber already.
    AlreadyInstalled,
    /// There is no thread to wait for deadlines.
    NoThread(std::io::Error),
}

/// A handler that nobody has registered.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct MissingHandler {
    /// Its name, as the reaction says it.
    pub name: String,
    /// Where the reaction stands.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// The names of the handlers that there are.
    pub known: Vec<String>,
}

impl fmt::Display for MissingHandler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: no handler `{}` is registered", self.file, self.line, self.name)?;
        let known = || self.known.iter().map(String::as_str);
        match nearest(&self.name, known()) {
            Some(near) => write!(f, "; did you mean `{near}`?"),
            None if self.known.is_empty() => f.write_str(", nor any other"),
            None => write!(f, "; those that are: {}", listed(known())),
        }
    }
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            BuildError::Spec(error) => error.fmt(f),
            BuildError::MissingHandlers(missing) => {
                let lines: Vec<String> = missing.iter().map(MissingHandler::to_string).collect();
                f.write_str(&lines.join("\n"))
            }
            BuildError::TooMuch => write!(
                f,
                "more than {MOST} functions follow `below`, or more than {MOST} fields of events are read: break the specification up"
            ),
            BuildError::AlreadyInstalled => f.write_str(
                "the program has a subscriber of `tracing` already: put `monitor.layer()` beside its layers instead",
            ),
            BuildError::NoThread(error) => write!(f, "no thread can be started to wait for deadlines: {error}"),
        }
    }
}

impl std::error::Error for BuildError {}

impl From<SpecError> for BuildError {
    fn from(error: SpecError) -> BuildError {
        BuildError::Spec(error)
    }
}
