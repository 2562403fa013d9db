//! The desk at which everything arrives, one after the other: the order of arrival is the order of the trace.
//!
//! Under the desk's lock an arrival gets its stamp and the monitors step. Then the lock is released, and what is to be done about
//! violations is done on the thread that brought the arrival, before it goes on. What a handler does may arrive here in turn.

use std::any::Any;
use std::cell::Cell;
use std::collections::BTreeSet;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use lapwing::{Monitor, News, Unseen};
use lapwing_check::checked::Action;
use lapwing_react::{Report, Warning};
use lapwing_stream::{Duration, Sample, Time, Value, What};

use crate::aside::aside;
use crate::clock::Clock;
use crate::handlers::Violation;
use crate::reaction::{Done, Reactions};
use crate::recorder::Recorder;

/// Arrivals inside handlers inside handlers … are stepped as deep as this.
pub(crate) const DEEPEST: u32 = 16;

/// So many names that the specification does not know are remembered, to be told.
const MOST_UNKNOWN: usize = 16;

/// So many different warnings of what went wrong in handlers and listeners are kept, to be told.
const MOST_WARNINGS: usize = 64;

/// So many threads may be inside of handlers of what turned out by the mere passing of time. With one more, deadlines wait for the last of them.
const MOST_ANSWERING: usize = 16;

thread_local! {
    /// How many handlers this thread is inside of.
    static DEPTH: Cell<u32> = const { Cell::new(0) };
    /// Whether this thread is at a desk: a clock or a writer that is called there must not bring an arrival itself.
    static AT_DESK: Cell<bool> = const { Cell::new(false) };
}

/// A thread is at a desk, until this is dropped.
struct AtDesk(());

impl AtDesk {
    /// `None` where the thread is at one already.
    fn enter() -> Option<AtDesk> {
        // Made only where it is wanted: dropping it says that the thread has left.
        if AT_DESK.replace(true) { None } else { Some(AtDesk(())) }
    }
}

impl Drop for AtDesk {
    fn drop(&mut self) {
        AT_DESK.set(false);
    }
}

/// Told of every violation.
pub(crate) type Listener = Box<dyn Fn(&Violation<'_>) + Send + Sync>;

/// Who brings an arrival.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Bringer {
    /// `tracing`, in the middle of telling its subscriber something.
    Subscriber,
    /// The host, by a call of its own.
    Host,
}

/// Where everything arrives.
pub(crate) struct Desk {
    inner: Mutex<Inner>,
    /// The deadline has changed, or it is over.
    changed: Condvar,
    clock: Box<dyn Clock>,
    reactions: Reactions,
    listeners: Vec<Listener>,
    /// Whether a thread waits for deadlines.
    has_waker: bool,
    /// How many threads that waited for deadlines are inside of handlers.
    answering: AtomicUsize,
    /// Whether an arrival was turned away because it came from the desk itself.
    has_turned_away: AtomicBool,
}

struct Inner {
    monitor: Monitor,
    /// The deadline that the waker waits for.
    awaited: Option<Time>,
    /// Nothing arrives any more.
    is_over: bool,
    /// The property whose violation stopped it.
    stopped_by: Option<String>,
    /// The events that somebody has raised, by their numbers.
    raised: Vec<bool>,
    unknown: BTreeSet<String>,
    lost: Unseen,
    done: Done,
    recorder: Option<Recorder>,
    warnings: Vec<Warning>,
    /// Whether there were more warnings than are kept.
    has_more_warnings: bool,
    report: Option<Report>,
}

/// What arrives, under the lock.
pub(crate) struct Arrival<'a> {
    inner: &'a mut Inner,
    now: Time,
    is_too_deep: bool,
}

impl Arrival<'_> {
    /// Signals get values.
    pub fn row(&mut self, cells: &[Value]) {
        if self.is_too_deep {
            let given = cells.iter().enumerate().filter(|(_, cell)| !matches!(cell, Value::Missing));
            given.for_each(|(column, _)| _ = self.inner.lost.columns.entry(column).or_insert_with(too_deep));
            return;
        }
        self.inner.recorder.iter_mut().for_each(|recorder| recorder.row(self.now, cells));
        self.inner.monitor.feed(Sample { time: self.now, what: What::Row { cells } });
    }

    /// An event occurs.
    pub fn event(&mut self, event: usize, values: &[Value]) {
        if let Some(raised) = self.inner.raised.get_mut(event) {
            *raised = true;
        }
        if self.is_too_deep {
            self.inner.lost.events.entry(event).or_insert_with(too_deep);
            return;
        }
        self.inner.recorder.iter_mut().for_each(|recorder| recorder.event(self.now, event, values));
        self.inner.monitor.feed(Sample { time: self.now, what: What::Event { event, values } });
    }

    /// Time goes on.
    fn pass(&mut self) {
        if self.inner.monitor.has_begun() {
            self.inner.recorder.iter_mut().for_each(|recorder| recorder.time(self.now));
        }
        self.inner.monitor.pass(self.now);
    }
}

fn too_deep() -> String {
    format!("what happened inside handlers more than {DEEPEST} deep was not seen")
}

impl Desk {
    pub fn new(
        monitor: Monitor,
        clock: Box<dyn Clock>,
        reactions: Reactions,
        listeners: Vec<Listener>,
        recorder: Option<Recorder>,
        has_waker: bool,
    ) -> Desk {
        let inner = Inner {
            awaited: None,
            is_over: false,
            stopped_by: None,
            raised: vec![false; monitor.meaning().events.len()],
            unknown: BTreeSet::new(),
            lost: Unseen::default(),
            done: Done::default(),
            recorder,
            warnings: Vec::new(),
            has_more_warnings: false,
            report: None,
            monitor,
        };
        Desk {
            inner: Mutex::new(inner),
            changed: Condvar::new(),
            clock,
            reactions,
            listeners,
            has_waker,
            answering: AtomicUsize::new(0),
            has_turned_away: AtomicBool::new(false),
        }
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// This thread comes to the desk. Whoever stands there already, and so under the lock, is turned away.
    fn come(&self) -> Option<AtDesk> {
        let at_desk = AtDesk::enter();
        if at_desk.is_none() {
            self.has_turned_away.store(true, Ordering::Relaxed);
        }
        at_desk
    }

    /// Something arrives. What it violates is answered before this returns.
    pub fn arrive(&self, bringer: Bringer, what: impl FnOnce(&mut Arrival<'_>)) {
        self.take(what).iter().for_each(|news| self.answer(bringer, news));
    }

    /// Steps what arrives. Gives what it violates.
    fn take(&self, what: impl FnOnce(&mut Arrival<'_>)) -> Vec<News> {
        let mut all_news = Vec::new();
        let Some(_at_desk) = self.come() else { return all_news };
        let mut inner = self.lock();
        if inner.is_over {
            return all_news;
        }
        let now = self.clock.now();
        what(&mut Arrival { inner: &mut inner, now, is_too_deep: DEPTH.get() > DEEPEST });
        while let Some(news) = inner.monitor.news() {
            all_news.push(news);
        }
        self.reschedule(&mut inner);
        all_news
    }

    /// The host's clock has gone on: bounds that ended before are over.
    pub fn advance(&self) {
        self.arrive(Bringer::Host, |arrival| arrival.pass());
    }

    /// Something is to be said in the report.
    pub fn warn(&self, message: String) {
        let Some(_at_desk) = self.come() else { return };
        warn(&mut self.lock(), message);
    }

    /// A name that the specification does not declare was used.
    pub fn note_unknown(&self, name: &str) {
        let Some(_at_desk) = self.come() else { return };
        let mut inner = self.lock();
        if inner.unknown.len() < MOST_UNKNOWN && !inner.unknown.contains(name) {
            inner.unknown.insert(name.to_owned());
        }
    }

    fn answer(&self, bringer: Bringer, news: &News) {
        let violation = Violation::new(news);
        self.listeners.iter().for_each(|listener| self.guarded("a listener", || listener(&violation)));
        if news.is_further {
            return;
        }
        for (number, reaction) in self.reactions.to(news.number) {
            if reaction.at_most_every.is_none_or(|every| self.may(number, every, news)) {
                reaction.actions.iter().for_each(|action| self.act(bringer, action, news));
            }
        }
    }

    /// Whether a reaction that is limited may be carried out now.
    fn may(&self, number: usize, every: Duration, news: &News) -> bool {
        // A clock that raises events would otherwise be asked about the reactions to these in turn, without end.
        let _at_desk = AtDesk::enter();
        let now = self.clock.now();
        self.lock().done.may(number, every, news, now)
    }

    fn act(&self, bringer: Bringer, action: &Action, news: &News) {
        match action {
            Action::Run(name) => self.run(bringer, name, news),
            Action::Reset => {
                let mut inner = self.lock();
                inner.monitor.reset(news.number, &news.instance);
                inner.done.count(news, "reset".to_owned());
            }
            Action::Stop => {
                let mut inner = self.lock();
                inner.done.count(news, "stopped".to_owned());
                inner.is_over = true;
                inner.stopped_by.get_or_insert_with(|| news.property.name.clone());
                self.changed.notify_all();
            }
            Action::Publish(_) | Action::Call(_) | Action::Request(_) | Action::Guard(_) => {
                let words = format!("did not {action}: a program has no robot's graph");
                self.lock().done.count(news, words);
            }
        }
    }

    fn run(&self, bringer: Bringer, name: &str, news: &News) {
        let Some(handler) = self.reactions.handler(name) else { return };
        if bringer == Bringer::Subscriber && is_deaf() {
            let words = format!("did not run {name}: a subscriber is set for a scope only");
            let mut inner = self.lock();
            inner.done.count(news, words);
            let message = format!(
                "the handler `{name}` was not run: while a subscriber is set for a scope only, on any thread, `tracing` hides what a \
                 handler does from its monitor; install the subscriber for the whole program"
            );
            return warn(&mut inner, message);
        }
        self.guarded(&format!("the handler `{name}`"), || handler(&Violation::new(news)));
        self.lock().done.count(news, format!("ran {name}"));
    }

    /// Runs the host's code, one level deeper; a panic of it ends here.
    fn guarded(&self, who: &str, work: impl FnOnce()) {
        DEPTH.set(DEPTH.get() + 1);
        let ended = aside(|| catch_unwind(AssertUnwindSafe(work)));
        DEPTH.set(DEPTH.get().saturating_sub(1));
        if let Err(panic) = ended {
            warn(&mut self.lock(), format!("{who} panicked: {}", words(&*panic)));
        }
    }

    /// Lets the waker know of a deadline before the one that it waits for.
    fn reschedule(&self, inner: &mut Inner) {
        if !self.has_waker {
            return;
        }
        let next = inner.monitor.next_deadline();
        if next.is_some_and(|next| inner.awaited.is_none_or(|awaited| next < awaited)) {
            inner.awaited = next;
            self.changed.notify_all();
        }
    }

    /// Waits for deadlines, and answers what then turns out, until it is over: the work of a thread of its own. While a handler runs, which may
    /// block, another thread keeps watch in its place.
    pub fn keep_watch(self: &Arc<Desk>) {
        let mut inner = self.lock();
        while !inner.is_over {
            inner.awaited = inner.monitor.next_deadline();
            let at_desk = AtDesk::enter();
            let wait = inner.awaited.and_then(|deadline| self.clock.until_beyond(deadline));
            drop(at_desk);
            inner = match wait {
                None => self.changed.wait(inner).unwrap_or_else(PoisonError::into_inner),
                Some(wait) if wait.is_zero() => {
                    drop(inner);
                    let all_news = self.take(|arrival| arrival.pass());
                    let is_relieved = all_news.iter().any(|news| self.runs_a_handler(news)) && self.relieve();
                    all_news.iter().for_each(|news| self.answer(Bringer::Host, news));
                    if is_relieved {
                        self.answering.fetch_sub(1, Ordering::Relaxed);
                        return;
                    }
                    self.lock()
                }
                Some(wait) => self.changed.wait_timeout(inner, wait).unwrap_or_else(PoisonError::into_inner).0,
            };
        }
    }

    fn runs_a_handler(&self, news: &News) -> bool {
        let runs = |action: &Action| matches!(action, Action::Run(_));
        !news.is_further && self.reactions.to(news.number).any(|(_, reaction)| reaction.actions.iter().any(runs))
    }

    /// Whether another thread keeps watch from now on, while this one answers.
    fn relieve(self: &Arc<Desk>) -> bool {
        let desk = self.clone();
        let is_possible = self.answering.fetch_add(1, Ordering::Relaxed) < MOST_ANSWERING && desk.start_watch().is_ok();
        if !is_possible {
            self.answering.fetch_sub(1, Ordering::Relaxed);
        }
        is_possible
    }

    /// A thread waits for deadlines.
    pub fn start_watch(self: Arc<Desk>) -> io::Result<()> {
        let thread = std::thread::Builder::new().name("lapwing deadlines".to_owned());
        thread.spawn(move || self.keep_watch()).map(|_| ())
    }

    /// Nobody watches any more.
    pub fn close(&self) {
        self.lock().is_over = true;
        self.changed.notify_all();
    }

    /// The property whose violation stopped it, where one did; nothing to a thread that stands at the desk.
    pub fn stopped_by(&self) -> Option<String> {
        let _at_desk = AtDesk::enter()?;
        self.lock().stopped_by.clone()
    }

    /// It is over: what is said of every property. `unseen` says what nobody could see, given which events somebody has raised.
    /// A thread that stands at the desk ends nothing, and gets a report that says so.
    pub fn finish(&self, unseen: impl FnOnce(&[bool]) -> Unseen) -> Report {
        self.advance();
        let Some(_at_desk) = self.come() else {
            let gap = "the report was asked for by the clock or the writer of the recording, while something arrived";
            return Report { gaps: vec![gap.to_owned()], ..Report::default() };
        };
        let mut inner = self.lock();
        if let Some(report) = &inner.report {
            return report.clone();
        }
        inner.is_over = true;
        self.changed.notify_all();
        let mut unseen = unseen(&inner.raised);
        if !(inner.lost.events.is_empty() && inner.lost.columns.is_empty()) {
            // What is violated has no cause that would say it.
            warn(&mut inner, too_deep());
        }
        unseen.events.extend(std::mem::take(&mut inner.lost.events));
        unseen.columns.extend(std::mem::take(&mut inner.lost.columns));
        let mut report = inner.monitor.finish(&unseen);
        for property in &mut report.properties {
            property.reactions = inner.done.told(&property.name);
        }
        report.warnings.append(&mut inner.warnings);
        if inner.has_more_warnings {
            report.warnings.push(Warning::plain(format!(
                "there were more than {MOST_WARNINGS} such warnings; the others are not listed"
            )));
        }
        if let Some(error) = inner.recorder.as_mut().and_then(Recorder::finish) {
            let message = format!("not everything that arrived was recorded: {error}");
            report.warnings.push(Warning::plain(message));
        }
        if self.has_turned_away.load(Ordering::Relaxed) {
            let message = "what the clock or the writer of the recording raised was not seen: they are called while something else arrives";
            report.warnings.push(Warning::plain(message));
        }
        report.warnings.extend(unknown(&inner.unknown, report.specs.first()));
        inner.report = Some(report.clone());
        report
    }
}

/// Keeps a warning for the report, once. Those of the report itself are added to it, however many there are of these.
fn warn(inner: &mut Inner, message: String) {
    if inner.warnings.iter().any(|w| w.message == message) {
        return;
    }
    inner.has_more_warnings |= inner.warnings.len() >= MOST_WARNINGS;
    if !inner.has_more_warnings {
        inner.warnings.push(Warning::plain(message));
    }
}

fn unknown(names: &BTreeSet<String>, spec: Option<&String>) -> Option<Warning> {
    let list: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    let spec = spec.map_or("the specification", String::as_str);
    (!list.is_empty())
        .then(|| Warning::plain(format!("the program raised or set what {spec} does not read: {}", list.join(", "))))
}

/// Whether what a handler does would reach no subscriber: `tracing` calls a subscriber that is set for a scope with all others silenced.
fn is_deaf() -> bool {
    tracing::dispatcher::get_default(|dispatch| dispatch.is::<tracing::subscriber::NoSubscriber>())
}

/// What a panic said.
fn words(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("without a message")
}
