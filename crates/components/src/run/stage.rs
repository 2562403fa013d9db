//! A run in real time: a thread for each task, each control task and each activity with `async` codels, and one that waits for all else.
//!
//! There is no thread of the engine. Whoever comes upon something that is due, or comes back from a codel, moves the automata on while nobody else does, and
//! tells the observer what happens; then it calls codels, outside of the lock: its own, and those that return at once whosever they are. So where periods
//! begin one thread wakes once, and only what takes its time, or sets something going that does, has a thread of its own woken ([`super::crew`]).
//!
//! ```text
//! Task(C, t)   sleeps ─period─▶ ┤automata, observer├ codel ┤automata, observer├ codel ┤automata, observer├ sleeps
//! carry_out    sleeps ─request, deadline of a monitor, the end, a codel that hangs─▶ ┤automata, observer├ sleeps
//! ```

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Instant;

use lapwing_stream::{Duration, Time};

use super::Run;
use super::crew::{Crew, Errand, GRACE_NS};
use crate::codel::{Answer, Call, Codel, Trouble, TroubleKind};
use crate::happening::Happening;
use crate::request::Request;

/// Who is told what happens. What it asks of the run is done before anything else happens.
///
/// In real time it is called by several threads, though never by two at once.
pub trait Observer: Send {
    /// Something has happened.
    fn see(&mut self, run: &mut Run, happening: &Happening);
}

impl<F: FnMut(&mut Run, &Happening) + Send> Observer for F {
    fn see(&mut self, run: &mut Run, happening: &Happening) {
        self(run, happening);
    }
}

/// Who calls a codel.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Lane {
    /// The control task of a component.
    Control(usize),
    /// A task of a component.
    Task(usize, usize),
    /// An activity beside its task, by its automaton.
    Beside(usize),
}

/// What others say to a run.
pub(super) enum Word {
    /// Somebody asks for a service.
    Request(Request),
    /// It is to end.
    Stop,
    /// It is to look again: something is due sooner than it was, or it is over.
    Look,
}

/// A codel that is to be called.
pub(super) struct Job {
    pub lane: Lane,
    pub automaton: usize,
    /// Its component and its number there.
    pub at: (usize, usize),
    pub call: Call,
    pub codel: Arc<dyn Codel>,
}

/// A codel that has returned.
pub(super) struct Returned {
    pub automaton: usize,
    pub call: Call,
    pub answer: Result<Answer, Trouble>,
    pub began: Time,
    pub ended: Time,
}

/// How long after the beginning of a period another thread looks after it that is busy itself.
const SLACK_NS: i64 = 5_000_000;

impl Run {
    /// Carries it out to its end: in logical time here, in real time by the threads of its tasks as well. Gives itself and the observer back.
    pub fn carry_out<O: Observer + 'static>(mut self, mut observer: O) -> (Run, O) {
        match (self.mouth.clone(), self.words.take()) {
            (Some(mouth), Some(words)) => Shared::new(self, observer, mouth).carry_out(&words),
            _ => {
                while let Some(happening) = self.advance() {
                    observer.see(&mut self, &happening);
                }
                (self, observer)
            }
        }
    }
}

/// What all threads share.
///
/// A codel that hangs keeps its thread and nothing else: who waits for all else ends the run, and takes it away from under the others.
struct Shared<O> {
    origin: Instant,
    mouth: Sender<Word>,
    /// When the thread that waits for all else has something to look at: others have seen to what it was to wake for.
    looks_from: AtomicI64,
    /// Nothing is there when the run is over.
    stage: Mutex<Option<Stage<O>>>,
}

/// The run, and who takes part in it.
struct Stage<O> {
    run: Run,
    observer: O,
    crew: Crew,
    /// When the thread that waits for all else wakes.
    looks_at: i64,
}

impl<O: Observer + 'static> Shared<O> {
    fn new(run: Run, observer: O, mouth: Sender<Word>) -> Arc<Shared<O>> {
        let crew = Crew::new(!run.setup.own_threads, run.codels.iter().map(Vec::len));
        let stage = Stage { run, observer, crew, looks_at: i64::MAX };
        let looks_from = AtomicI64::new(i64::MIN);
        Arc::new(Shared { origin: Instant::now(), mouth, looks_from, stage: Mutex::new(Some(stage)) })
    }

    fn now(&self) -> Time {
        Time(i64::try_from(self.origin.elapsed().as_nanos()).unwrap_or(i64::MAX))
    }

    fn lock(&self) -> MutexGuard<'_, Option<Stage<O>>> {
        self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The thread that waits for all that is nobody's turn.
    fn carry_out(self: &Arc<Self>, words: &Receiver<Word>) -> (Run, O) {
        let mut word = Some(Word::Look);
        loop {
            let mut place = self.lock();
            let mut taken = place.take();
            if self.stage.is_poisoned() {
                taken.take().iter().for_each(Stage::dismiss);
            }
            // Nobody else takes it away, so that an observer has panicked on another thread, which has said so.
            let Some(mut stage) = taken else { resume_unwind(Box::new("who was told of a run has panicked")) };
            stage.run.now = self.now().max(stage.run.now);
            match word {
                Some(Word::Request(request)) => _ = stage.run.request(request),
                Some(Word::Stop) => stage.run.stop(),
                Some(Word::Look) => {}
                None => stage.run.hung(),
            }
            self.go_on(&mut stage);
            stage.crew.scatter(stage.run.now.0);
            if stage.run.is_over {
                stage.dismiss();
                return (stage.run, stage.observer);
            }
            stage.looks_at = stage.looks();
            let until = stage.looks_at;
            self.looks_from.store(until, Ordering::Relaxed);
            *place = Some(stage);
            drop(place);
            word = self.listen(words, until);
        }
    }

    /// What is said before it is time to look; `None` where nothing is.
    fn listen(&self, words: &Receiver<Word>, mut until: i64) -> Option<Word> {
        loop {
            if until == i64::MAX {
                return words.recv().ok();
            }
            match words.recv_timeout(wait(self.now(), until)) {
                Ok(word) => return Some(word),
                Err(RecvTimeoutError::Disconnected) => return Some(Word::Look),
                Err(RecvTimeoutError::Timeout) => {}
            }
            // PERF: without a look at the stage, which is not in this processor's cache (`examples/navigation/examples/speed.rs`).
            let later = self.looks_from.load(Ordering::Relaxed);
            if later <= self.now().0 {
                return None;
            }
            until = later;
        }
    }

    /// A thread that calls codels, until the run is over.
    fn play(self: &Arc<Self>, lane: Lane) {
        let _says = SaysSo(&self.mouth);
        let mut place = self.lock();
        loop {
            let Some(stage) = place.as_mut() else { return };
            stage.run.now = self.now().max(stage.run.now);
            self.go_on(stage);
            stage.see_to_it_that_somebody_looks(&self.mouth);
            if let Some((job, errand)) = stage.next(lane) {
                drop(place);
                let returned = job.carry_out(|| self.now());
                place = self.lock();
                let Some(stage) = place.as_mut() else { return };
                stage.run.now = returned.ended.max(stage.run.now);
                stage.crew.note(lane, errand, returned.ended.0.saturating_sub(returned.began.0), stage.run.now.0);
                stage.run.returned(returned);
                continue;
            }
            let (Some(until), Some(wakes)) = (stage.sleep(lane), stage.crew.wakes(lane)) else { return };
            self.looks_from.store(stage.looks(), Ordering::Relaxed);
            place = match until {
                i64::MAX => wakes.wait(place).unwrap_or_else(PoisonError::into_inner),
                until => {
                    let wait = wait(self.now(), until);
                    wakes.wait_timeout(place, wait).unwrap_or_else(PoisonError::into_inner).0
                }
            };
            if let Some(stage) = place.as_mut() {
                stage.crew.rise(lane);
            }
        }
    }

    /// Everything that happens before time passes; codels go to those who call them.
    fn go_on(self: &Arc<Self>, stage: &mut Stage<O>) {
        loop {
            while let Some(happening) = stage.run.step() {
                stage.observer.see(&mut stage.run, &happening);
            }
            if stage.run.jobs.is_empty() || stage.run.is_over {
                return;
            }
            for job in std::mem::take(&mut stage.run.jobs) {
                self.assign(stage, job);
            }
        }
    }

    /// Has a codel called; its task gets a thread where it has none.
    fn assign(self: &Arc<Self>, stage: &mut Stage<O>, job: Job) {
        let lane = job.lane;
        if !stage.crew.has(lane) {
            let shared = self.clone();
            let named = thread::Builder::new().name(format!("{lane:?}"));
            if named.spawn(move || shared.play(lane)).is_err() {
                return stage.run.stranded(job.automaton);
            }
            stage.crew.add(lane);
        }
        stage.crew.assign(job, stage.run.now.0);
    }
}

impl<O> Stage<O> {
    /// It is over: who sleeps wakes, finds nothing and goes.
    fn dismiss(&self) {
        self.crew.dismiss();
    }

    /// What a thread calls next.
    fn next(&mut self, lane: Lane) -> Option<(Job, Errand)> {
        if self.run.is_over {
            return None;
        }
        let now = self.run.now.0;
        let (job, errand) = self.crew.next(lane, now)?;
        if !errand.is_attended {
            // It may be away for long.
            self.crew.scatter(now);
            self.crew.appoint(self.common_period(), now);
        }
        Some((job, errand))
    }

    /// A thread goes to sleep. Gives when it wakes if nobody wakes it.
    fn sleep(&mut self, lane: Lane) -> Option<i64> {
        if self.run.is_over {
            return Some(i64::MAX);
        }
        let common = self.common_period();
        let until = self.crew.sleep(lane, self.run.period_of(lane).unwrap_or(i64::MAX), common);
        self.crew.appoint(common, self.run.now.0);
        Some(until)
    }

    /// When the first period begins of those whose threads do not wake by themselves.
    fn common_period(&self) -> i64 {
        let shares = |automaton| self.run.lane_of_timer(automaton).is_some_and(|lane| self.crew.shares(lane));
        let common = self.run.machine.timers().filter(|(_, automaton)| shares(*automaton));
        common.map(|(at, _)| at.0).min().unwrap_or(i64::MAX)
    }

    /// When the thread that waits for all else has to look: at what others want, at codels that hang, and at periods that begin while the thread of
    /// their task is not there, or away.
    fn looks(&self) -> i64 {
        let period = |(at, automaton): (Time, usize)| {
            let slack = match self.run.lane_of_timer(automaton).filter(|lane| self.crew.has(*lane)) {
                Some(lane) if self.crew.shares(lane) => GRACE_NS,
                Some(_) => SLACK_NS,
                None => 0,
            };
            at.0.saturating_add(slack)
        };
        let periods = self.run.machine.timers().map(period).min();
        [periods, self.run.next_due_beside(), self.run.hangs_at()].into_iter().flatten().min().unwrap_or(i64::MAX)
    }

    /// Has the thread that waits for all else look again where it would come too late.
    fn see_to_it_that_somebody_looks(&mut self, mouth: &Sender<Word>) {
        let wanted = self.run.next_due_beside().unwrap_or(i64::MAX).min(self.crew.forgotten_at());
        let patience = self.run.now.0.saturating_add(self.run.setup.patience.nanos());
        if self.run.is_over || wanted.min(patience) < self.looks_at {
            self.looks_at = wanted.min(patience);
            drop(mouth.send(Word::Look));
        }
    }
}

impl Run {
    /// When the next thing is due that is no task's: what somebody wants, and the end of codels that nobody has written.
    fn next_due_beside(&self) -> Option<i64> {
        let returns = self.returns.peek().map(|due| due.0.0);
        [returns, self.next_wanted()].into_iter().flatten().min()
    }

    /// The thread of the task that a timer is of.
    fn lane_of_timer(&self, automaton: usize) -> Option<Lane> {
        let task = self.system.tasks.get(self.task_of_timer.get(automaton)?)?;
        Some(Lane::Task(task.component, task.task.0))
    }

    /// When the next period of a task begins, by its thread.
    fn period_of(&self, lane: Lane) -> Option<i64> {
        let own = self.machine.timers().filter(|(_, automaton)| self.lane_of_timer(*automaton) == Some(lane));
        own.map(|(at, _)| at.0).min()
    }
}

impl Job {
    fn carry_out(self, now: impl Fn() -> Time) -> Returned {
        let Job { automaton, mut call, codel, .. } = self;
        let began = now();
        let answer = guarded(&*codel, &mut call);
        Returned { automaton, call, answer, began, ended: now() }
    }
}

/// Tells the thread that waits for all else when another one panics.
struct SaysSo<'s>(&'s Sender<Word>);

impl Drop for SaysSo<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            drop(self.0.send(Word::Look));
        }
    }
}

/// How long it is until a moment.
fn wait(now: Time, until: i64) -> std::time::Duration {
    std::time::Duration::from_nanos(u64::try_from(until.saturating_sub(now.0)).unwrap_or(0))
}

/// Calls a codel; a panic of it ends here.
pub(super) fn guarded(codel: &dyn Codel, call: &mut Call) -> Result<Answer, Trouble> {
    let ended = catch_unwind(AssertUnwindSafe(|| codel.call(call)));
    ended.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<&str>().copied().map(str::to_owned);
        let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
        let message = format!("it panicked: {}", text.unwrap_or_else(|| "without a message".to_owned()));
        Err(Trouble { kind: TroubleKind::Crashed, message })
    })
}

/// The time between two.
pub(super) fn between(from: Time, to: Time) -> Duration {
    Duration::from_nanos(to.0.saturating_sub(from.0))
}
