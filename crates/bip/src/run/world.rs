//! What is outside of a run: a clock, and events.

use crate::model::External;
use crate::time::Time;
use crate::value::Value;
use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Something that happened outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Where it comes in.
    pub port: External,
    /// Values for the variables of the port.
    pub values: Vec<Value>,
    /// When it happened.
    pub at: Time,
}

/// Why a wait has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Woken {
    /// The moment has come.
    ByTime,
    /// An event has come before it.
    ByEvent,
    /// No event will ever come, and the moment never does.
    ByNothing,
}

/// What is outside of a run.
pub trait World {
    /// How late it is, where by the model it is `model`.
    fn actual(&mut self, model: Time) -> Time;

    /// Waits for a moment, or for an event that comes before it.
    fn wait_until(&mut self, at: Time) -> Woken;

    /// The events that have come since they were last asked for, the oldest first.
    fn events(&mut self, model: Time) -> Vec<Event>;
}

/// Simulated time: it is always as late as the model says, and nothing takes any.
#[derive(Clone, Debug, Default)]
pub struct Simulated {
    /// What is going to happen, in the order of its moments.
    events: VecDeque<Event>,
    now: Time,
}

impl Simulated {
    /// A world in which these events happen, and no others.
    pub fn with_events(mut events: Vec<Event>) -> Simulated {
        events.sort_by_key(|e| e.at);
        Simulated { events: events.into(), now: Time::ZERO }
    }
}

impl World for Simulated {
    fn actual(&mut self, model: Time) -> Time {
        model
    }

    fn wait_until(&mut self, at: Time) -> Woken {
        match self.events.front() {
            Some(event) if event.at <= at => {
                self.now = self.now.max(event.at);
                Woken::ByEvent
            }
            None if at == Time::MAX => Woken::ByNothing,
            _ => {
                self.now = self.now.max(at);
                Woken::ByTime
            }
        }
    }

    fn events(&mut self, model: Time) -> Vec<Event> {
        self.now = self.now.max(model);
        let due = self.events.partition_point(|e| e.at <= self.now);
        self.events.drain(..due).collect()
    }
}

/// Real time, by the clock that nobody sets.
#[derive(Debug)]
pub struct Monotonic {
    start: Instant,
    incoming: Option<Receiver<Event>>,
    arrived: Vec<Event>,
}

impl Monotonic {
    /// A world that begins now, in which nothing happens.
    pub fn start() -> Monotonic {
        Monotonic { start: Instant::now(), incoming: None, arrived: Vec::new() }
    }

    /// A world that begins now, in which other threads make things happen.
    pub fn with_events(incoming: Receiver<Event>) -> Monotonic {
        Monotonic { start: Instant::now(), incoming: Some(incoming), arrived: Vec::new() }
    }

    fn now(&self) -> Time {
        Time(i64::try_from(self.start.elapsed().as_nanos()).unwrap_or(i64::MAX))
    }

    /// How long it is until a moment; `None` where it never comes.
    fn until(&self, at: Time) -> Option<Duration> {
        let left = u64::try_from(at.0.saturating_sub(self.now().0)).unwrap_or(0);
        (at != Time::MAX).then(|| Duration::from_nanos(left))
    }
}

impl World for Monotonic {
    fn actual(&mut self, _: Time) -> Time {
        self.now()
    }

    fn wait_until(&mut self, at: Time) -> Woken {
        let left = self.until(at);
        let Some(incoming) = &self.incoming else {
            return match left {
                None => Woken::ByNothing,
                Some(left) => {
                    std::thread::sleep(left);
                    Woken::ByTime
                }
            };
        };
        let received = match left {
            None => incoming.recv().map_err(|_| RecvTimeoutError::Disconnected),
            Some(left) => incoming.recv_timeout(left),
        };
        match received {
            Ok(event) => {
                self.arrived.push(event);
                Woken::ByEvent
            }
            Err(RecvTimeoutError::Timeout) => Woken::ByTime,
            Err(RecvTimeoutError::Disconnected) => {
                // Nobody is left who could make something happen: from now on it is only time.
                self.incoming = None;
                self.wait_until(at)
            }
        }
    }

    fn events(&mut self, _: Time) -> Vec<Event> {
        let mut events = std::mem::take(&mut self.arrived);
        events.extend(self.incoming.iter().flat_map(Receiver::try_iter));
        events
    }
}
