//! Threads that run codels in real time: one for each task, one for each control task, and one for each activity with `async` codels.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread;
use std::time::Instant;

use lapwing_stream::{Duration, Time};

use crate::codel::{Answer, Call, Codel, Trouble, TroubleKind};
use crate::request::Request;

/// Who runs a codel.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Lane {
    /// The control task of a component.
    Control(usize),
    /// A task of a component.
    Task(usize, usize),
    /// An activity beside its task, by its automaton.
    Beside(usize),
}

/// What a run hears of while it waits.
pub(super) enum Word {
    /// A codel has returned.
    Returned(Box<Returned>),
    /// Somebody asks for a service.
    Request(Request),
    /// It is to end.
    Stop,
}

/// A codel that has returned.
pub(super) struct Returned {
    pub automaton: usize,
    pub call: Call,
    pub answer: Result<Answer, Trouble>,
    pub began: Time,
    pub ended: Time,
}

struct Job {
    automaton: usize,
    call: Call,
    codel: Arc<dyn Codel>,
}

/// The threads, and the clock by which they go.
pub(super) struct Workers {
    origin: Instant,
    lanes: BTreeMap<Lane, Sender<Job>>,
    words: Receiver<Word>,
    mouth: Sender<Word>,
}

impl Workers {
    pub fn new() -> Workers {
        let (mouth, words) = mpsc::channel();
        Workers { origin: Instant::now(), lanes: BTreeMap::new(), words, mouth }
    }

    /// Time begins now.
    pub fn begin(&mut self) {
        self.origin = Instant::now();
    }

    /// How long the run has taken, by the monotonic clock.
    pub fn now(&self) -> Time {
        since(self.origin)
    }

    pub fn mouth(&self) -> Sender<Word> {
        self.mouth.clone()
    }

    /// Has a codel called. `false` where there can be no thread for it.
    pub fn give(&mut self, lane: Lane, automaton: usize, call: Call, codel: Arc<dyn Codel>) -> bool {
        let (origin, mouth) = (self.origin, self.mouth.clone());
        let job = Job { automaton, call, codel };
        let known = self.lanes.get(&lane).cloned();
        let to = match known {
            Some(to) => to,
            None => {
                let (to, jobs) = mpsc::channel();
                let name = format!("{lane:?}");
                if thread::Builder::new().name(name).spawn(move || work(origin, &jobs, &mouth)).is_err() {
                    return false;
                }
                self.lanes.insert(lane, to.clone());
                to
            }
        };
        to.send(job).is_ok()
    }

    /// Waits for a word until a time; `None` when that has come.
    pub fn wait(&self, until: Option<Time>) -> Option<Word> {
        let Some(until) = until else { return self.words.recv().ok() };
        let left = u64::try_from(until.0.saturating_sub(self.now().0)).unwrap_or(0);
        self.words.recv_timeout(std::time::Duration::from_nanos(left)).ok()
    }
}

fn since(origin: Instant) -> Time {
    Time(i64::try_from(origin.elapsed().as_nanos()).unwrap_or(i64::MAX))
}

fn work(origin: Instant, jobs: &Receiver<Job>, mouth: &Sender<Word>) {
    while let Ok(Job { automaton, mut call, codel }) = jobs.recv() {
        let began = since(origin);
        let answer = guarded(&*codel, &mut call);
        let returned = Returned { automaton, call, answer, began, ended: since(origin) };
        if mouth.send(Word::Returned(Box::new(returned))).is_err() {
            return;
        }
    }
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
