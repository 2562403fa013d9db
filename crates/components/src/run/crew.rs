//! The threads that call codels: which of them calls what, and which wakes when.
//!
//! To wake a thread takes a processor longer than most codels do. So a codel that has returned at once the last times is called by whoever comes upon it, and
//! tasks whose codels all do so *share*: one of their threads wakes for all of them. What takes its time has the thread of its task, as
//! everything has at first, and delays nobody.
//!
//! A codel that used to return at once, and once does not, keeps the others waiting that were due with it: until the thread that waits for all else
//! looks, [`GRACE_NS`] after the beginning of their period, and has them called by threads of their own.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Condvar};

use super::stage::{Job, Lane};

/// A codel that is back within this time returns at once: what it takes to wake a thread, and not much more.
const QUICK_NS: i64 = 50_000;

/// How often in a row a codel has to return at once before others than its own thread call it.
const TRUSTED: u8 = 4;

/// How often in a row the codels of a task have to before its thread does not wake by itself.
const SHARES: u8 = 8;

/// So long codels that return at once may take one after the other before the rest is left to their own threads.
const VISIT_NS: i64 = 200_000;

/// A thread that wakes by itself so soon is not woken.
const SOON_NS: i64 = 100_000;

/// How long after the beginning of a period somebody looks whether who shares has been seen to.
pub(super) const GRACE_NS: i64 = 500_000;

/// The threads that call codels.
pub(super) struct Crew {
    players: BTreeMap<Lane, Player>,
    /// What whoever is awake calls, and since when the first of them waits.
    common: VecDeque<Job>,
    common_since: i64,
    /// By component and codel: how often in a row it has returned at once.
    habits: Vec<Vec<u8>>,
    /// How many threads are away for codels that return at once, and come back for what is common.
    attending: usize,
    /// Whether tasks share threads at all.
    shares: bool,
}

/// A thread that calls codels.
#[derive(Default)]
struct Player {
    jobs: VecDeque<Job>,
    wakes: Arc<Condvar>,
    /// While it sleeps: until when.
    sleeps_until: Option<i64>,
    /// How often in a row a codel of its own has returned at once.
    streak: u8,
    /// How long the codels took that it has called since it woke.
    visited: i64,
}

impl Player {
    fn shares(&self) -> bool {
        self.streak >= SHARES
    }

    fn wake(&mut self, now: i64) {
        self.wakes.notify_one();
        self.sleeps_until = self.sleeps_until.map(|_| now);
    }
}

/// What is to be remembered of a codel while it is called.
#[derive(Clone, Copy)]
pub(super) struct Errand {
    lane: Lane,
    codel: (usize, usize),
    /// Whether whoever calls it comes back for what is common.
    pub is_attended: bool,
}

impl Crew {
    /// Nobody yet. `shares` is whether codels that return at once may be called by threads of other tasks, `codels` how many each component has.
    pub fn new(shares: bool, codels: impl Iterator<Item = usize>) -> Crew {
        Crew {
            players: BTreeMap::new(),
            common: VecDeque::new(),
            common_since: 0,
            habits: codels.map(|count| vec![0; count]).collect(),
            attending: 0,
            shares,
        }
    }

    /// Whether there is a thread for a lane.
    pub fn has(&self, lane: Lane) -> bool {
        self.players.contains_key(&lane)
    }

    /// A thread has begun.
    pub fn add(&mut self, lane: Lane) {
        self.players.insert(lane, Player::default());
    }

    /// Whether the thread of a lane does not wake by itself when its period begins.
    pub fn shares(&self, lane: Lane) -> bool {
        self.players.get(&lane).is_some_and(Player::shares)
    }

    /// How a thread is woken.
    pub fn wakes(&self, lane: Lane) -> Option<Arc<Condvar>> {
        self.players.get(&lane).map(|player| player.wakes.clone())
    }

    /// Everybody wakes, finds that it is over, and goes.
    pub fn dismiss(&self) {
        self.players.values().for_each(|player| player.wakes.notify_all());
    }

    /// A codel is to be called.
    pub fn assign(&mut self, job: Job, now: i64) {
        let habit = self.habits.get(job.at.0).and_then(|of| of.get(job.at.1));
        let returns_at_once = habit.is_some_and(|habit| *habit >= TRUSTED);
        if self.shares && returns_at_once && self.shares(job.lane) {
            if self.common.is_empty() {
                self.common_since = now;
            }
            self.common.push_back(job);
        } else {
            self.hand_over(job, now);
        }
    }

    /// A codel is called by the thread of its task.
    fn hand_over(&mut self, job: Job, now: i64) {
        let Some(player) = self.players.get_mut(&job.lane) else { return };
        player.jobs.push_back(job);
        if player.sleeps_until.is_some_and(|until| until > now.saturating_add(SOON_NS)) {
            player.wake(now);
        }
    }

    /// What is common is called by the threads of its tasks after all, unless somebody will soon be here for it.
    pub fn scatter(&mut self, now: i64) {
        let soon = now.saturating_add(SOON_NS);
        let has_waited = now.saturating_sub(self.common_since) > GRACE_NS / 2;
        let comes = |player: &Player| player.shares() && player.sleeps_until.is_some_and(|until| until <= soon);
        if self.common.is_empty() || !has_waited && (self.attending > 0 || self.players.values().any(comes)) {
            return;
        }
        for job in std::mem::take(&mut self.common) {
            self.hand_over(job, now);
        }
    }

    /// What a thread calls next: its own codels before those of others.
    pub fn next(&mut self, lane: Lane, now: i64) -> Option<(Job, Errand)> {
        if self.players.get(&lane)?.visited > VISIT_NS {
            self.scatter(now);
        }
        let own = self.players.get_mut(&lane)?.jobs.pop_front();
        let is_attended = own.is_none();
        let job = own.or_else(|| self.common.pop_front())?;
        self.attending += usize::from(is_attended);
        let errand = Errand { lane: job.lane, codel: job.at, is_attended };
        Some((job, errand))
    }

    /// A thread is back from a codel that took so long.
    pub fn note(&mut self, by: Lane, errand: Errand, took: i64, now: i64) {
        if let Some(player) = self.players.get_mut(&by) {
            player.visited = player.visited.saturating_add(took);
        }
        self.attending -= usize::from(errand.is_attended && self.attending > 0);
        let further = |streak: u8| if took <= QUICK_NS { streak.saturating_add(1) } else { 0 };
        if let Some(habit) = self.habits.get_mut(errand.codel.0).and_then(|of| of.get_mut(errand.codel.1)) {
            *habit = further(*habit);
        }
        let Some(player) = self.players.get_mut(&errand.lane).filter(|_| !matches!(errand.lane, Lane::Beside(_)))
        else {
            return;
        };
        let shared = player.shares();
        player.streak = further(player.streak);
        // From now on it has to wake by itself, and does not know.
        if shared && !player.shares() && player.sleeps_until.is_some() {
            player.wake(now);
        }
    }

    /// A thread goes to sleep until its own period begins, or where it shares, until that of the first who does, unless another wakes then. `period` is that
    /// of its own, `common` that of the first who shares. Gives when it wakes.
    pub fn sleep(&mut self, lane: Lane, period: i64, common: i64) -> i64 {
        let until = match (self.shares(lane), self.is_awaited(common)) {
            (false, _) => period,
            (true, true) => i64::MAX,
            (true, false) => common,
        };
        if let Some(player) = self.players.get_mut(&lane) {
            player.sleeps_until = Some(until);
            player.visited = 0;
        }
        until
    }

    /// Whether one of those who share wakes by then.
    fn is_awaited(&self, common: i64) -> bool {
        self.players.values().any(|p| p.shares() && p.sleeps_until.is_some_and(|until| until <= common))
    }

    /// A thread is awake again.
    pub fn rise(&mut self, lane: Lane) {
        if let Some(player) = self.players.get_mut(&lane) {
            player.sleeps_until = None;
        }
    }

    /// Sees to it that somebody who shares wakes when the period of the first of them begins, or is awake.
    pub fn appoint(&mut self, common: i64, now: i64) {
        if common == i64::MAX || self.attending > 0 || self.is_awaited(common) {
            return;
        }
        let asleep = self.players.values_mut().find(|p| p.shares() && p.sleeps_until.is_some());
        if let Some(player) = asleep {
            player.wake(now);
        }
    }

    /// When somebody has to look whether what is common is still there.
    pub fn forgotten_at(&self) -> i64 {
        if self.common.is_empty() { i64::MAX } else { self.common_since.saturating_add(2 * GRACE_NS) }
    }
}
