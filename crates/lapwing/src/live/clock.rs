//! The clock in use: the wall clock that stamps what arrives, or the simulated time that somebody publishes on `/clock`.
//!
//! Under simulated time everything gets the stamp of the latest `/clock`; what comes before the first one waits for it. Which of the two it
//! is can be said; else whoever publishes `/clock` within a second of the start decides.

use std::collections::{BTreeMap, VecDeque};

use lapwing_record::{Decoder, Path};
use lapwing_stream::{Time, Value};

use super::course::{Seen, Sight};
use super::graph::absolute;
use crate::status::{Status, Stream};

/// The topic of simulated time.
pub(crate) const CLOCK: &str = "/clock";

/// How long a publisher of `/clock` is waited for.
const SETTLES: i64 = 1_000_000_000;

/// So much may wait for the first `/clock`.
const MOST_HELD: usize = 100_000;
const MOST_HELD_BYTES: usize = 64 << 20;

/// A step of simulated time is a leap where it is longer than this, and so many times as long as the steps before.
const LEAP: i64 = 1_000_000_000;
const UNUSUAL: i64 = 20;

/// Which clock stamps.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum ClockChoice {
    /// Simulated time if somebody publishes it within a second of the start, else the wall clock.
    #[default]
    Auto,
    /// The wall clock.
    Wall,
    /// Simulated time: nothing counts before the first `/clock`.
    Simulated,
}

/// The clock of a run.
#[derive(Debug)]
pub(crate) struct Clock {
    mode: Mode,
    /// What waits for a stamp.
    held: VecDeque<Sight>,
    held_bytes: usize,
    /// How many messages of each stream could not wait.
    overflowed: BTreeMap<u32, u64>,
    names: BTreeMap<u32, Stream>,
    stream: Option<u32>,
    decoder: Option<Decoder>,
}

#[derive(Clone, Copy, Debug)]
enum Mode {
    Undecided { since: Option<Time> },
    Wall,
    Simulated { now: Option<Time>, step: i64 },
}

impl Clock {
    pub fn new(choice: ClockChoice) -> Clock {
        let mode = match choice {
            ClockChoice::Auto => Mode::Undecided { since: None },
            ClockChoice::Wall => Mode::Wall,
            ClockChoice::Simulated => Mode::Simulated { now: None, step: 0 },
        };
        Clock {
            mode,
            held: VecDeque::new(),
            held_bytes: 0,
            overflowed: BTreeMap::new(),
            names: BTreeMap::new(),
            stream: None,
            decoder: None,
        }
    }

    /// Whether the wall clock stamps.
    pub fn is_wall(&self) -> bool {
        matches!(self.mode, Mode::Wall)
    }

    /// Whether simulated time stamps.
    pub fn is_simulated(&self) -> bool {
        matches!(self.mode, Mode::Simulated { .. })
    }

    /// Simulated time, where it counts and has begun.
    pub fn simulated_now(&self) -> Option<Time> {
        if let Mode::Simulated { now, .. } = self.mode { now } else { None }
    }

    /// Takes in what was seen at a time of the wall clock. Gives what has a stamp now, in order.
    pub fn stamp(&mut self, sight: Sight, out: &mut Vec<Sight>) {
        self.meet_clock(&sight);
        self.settle(sight.at, out);
        match self.mode {
            Mode::Wall => out.push(sight),
            Mode::Undecided { .. } => self.hold(sight),
            Mode::Simulated { now, step } => {
                let told = self.told(&sight);
                if let Some(told) = told {
                    let went = now.map_or(0, |now| told.0.saturating_sub(now.0));
                    let is_leap = step > 0 && went > LEAP && went > step.saturating_mul(UNUSUAL);
                    self.mode = Mode::Simulated { now: Some(told), step: if is_leap { step } else { went.max(0) } };
                    self.release(told, out);
                    if let Some(from) = now.filter(|_| is_leap) {
                        out.push(Sight { at: told, what: Seen::Status(Status::Leapt { from: from.0 }) });
                    }
                }
                match told.or(now) {
                    Some(at) => out.push(Sight { at, ..sight }),
                    None => self.hold(sight),
                }
            }
        }
    }

    /// The wall clock has come so far: an open question may be decided by it.
    pub fn settle(&mut self, now: Time, out: &mut Vec<Sight>) {
        let Mode::Undecided { since } = self.mode else { return };
        let since = since.unwrap_or(now);
        self.mode = Mode::Undecided { since: Some(since) };
        if self.stream.is_some() {
            self.mode = Mode::Simulated { now: None, step: 0 };
            self.replay_held(out);
        } else if now.since(since).nanos() >= SETTLES {
            self.mode = Mode::Wall;
            out.extend(std::mem::take(&mut self.held));
            self.held_bytes = 0;
            self.tell_overflow(now, out);
        }
    }

    /// The run ends at a time of the wall clock: what still waits gets a stamp. Gives the stamp of the end.
    pub fn finish(&mut self, now: Time, out: &mut Vec<Sight>) -> Time {
        match self.mode {
            Mode::Wall => {}
            Mode::Undecided { .. } => out.extend(std::mem::take(&mut self.held)),
            Mode::Simulated { now, .. } => self.release(now.unwrap_or_default(), out),
        }
        if self.is_simulated() { self.simulated_now().unwrap_or_default() } else { now }
    }

    /// Notes the stream of simulated time when it is met.
    fn meet_clock(&mut self, sight: &Sight) {
        let Seen::Offered { stream, channel, .. } = &sight.what else { return };
        self.names.insert(*stream, Stream { topic: channel.topic.clone(), type_name: channel.type_name.clone() });
        if absolute(&channel.topic) != CLOCK {
            return;
        }
        self.stream = Some(*stream);
        let paths = [Path::of_names(["clock", "sec"]), Path::of_names(["clock", "nanosec"])];
        self.decoder = channel.ty.as_ref().ok().and_then(|ty| Decoder::new(ty, &paths, 1).ok());
    }

    /// The time that a message tells.
    fn told(&mut self, sight: &Sight) -> Option<Time> {
        let Seen::Message { stream, payload } = &sight.what else { return None };
        if self.stream != Some(*stream) {
            return None;
        }
        let mut values = [Value::Missing, Value::Missing];
        self.decoder.as_mut()?.decode(payload, &mut values).ok()?;
        let [Value::Num(seconds), Value::Num(nanoseconds)] = values else { return None };
        Some(Time((seconds as i64).checked_mul(1_000_000_000)?.checked_add(nanoseconds as i64)?))
    }

    /// What was held while the question was open, taken in once more.
    fn replay_held(&mut self, out: &mut Vec<Sight>) {
        self.held_bytes = 0;
        for sight in std::mem::take(&mut self.held) {
            self.stamp(sight, out);
        }
    }

    /// What waited has this stamp.
    fn release(&mut self, at: Time, out: &mut Vec<Sight>) {
        self.held_bytes = 0;
        out.extend(std::mem::take(&mut self.held).into_iter().map(|sight| Sight { at, ..sight }));
        self.tell_overflow(at, out);
    }

    /// What could not wait is lost, and told.
    fn tell_overflow(&mut self, at: Time, out: &mut Vec<Sight>) {
        for (stream, count) in std::mem::take(&mut self.overflowed) {
            let name = self.names.get(&stream).cloned();
            out.extend(name.map(|name| Sight { at, what: Seen::Status(Status::Lost(name, count)) }));
        }
    }

    fn hold(&mut self, sight: Sight) {
        if let Seen::Message { stream, payload } = &sight.what {
            if self.held.len() >= MOST_HELD || self.held_bytes + payload.len() > MOST_HELD_BYTES {
                *self.overflowed.entry(*stream).or_default() += 1;
                return;
            }
            self.held_bytes += payload.len();
        }
        self.held.push_back(sight);
    }
}
