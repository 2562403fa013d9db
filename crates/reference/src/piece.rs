//! One piece of a trace: the latest values after each sample, the events, the instants of the clock
//! (language reference, *Traces, instants, values*).

use crate::course::Course;
use crate::trace::{Arrival, first_read};
use crate::world::Tracked;
use lapwing_check::checked::{self, Clock, EventSource, InputSource};
use lapwing_stream::{Time, Value};

/// A piece, looked at by every property and machine.
pub(crate) struct Piece<'a> {
    pub(crate) spec: &'a checked::Spec,
    pub(crate) samples: Vec<(Time, Arrival)>,
    /// The stamp of the first sample that is read.
    pub(crate) t0: Option<Time>,
    /// The stamp of the last sample of any kind.
    pub(crate) last: Time,
    /// `latest[n]`: the value of each input after the first `n` samples, `None` where undefined.
    pub(crate) latest: Vec<Vec<Option<Value>>>,
    /// `updated[n]`: the inputs to which sample `n` gave a value.
    pub(crate) updated: Vec<Vec<usize>>,
    /// `occurrences[n]`: the events that sample `n` is.
    pub(crate) occurrences: Vec<Vec<Occurrence>>,
    /// For each sample, the events whose own condition met with a value of the wrong kind, and how: nobody knows whether they occur.
    pub(crate) unclear: Vec<Vec<(usize, String)>>,
}

/// An event that occurred, with its fields.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Occurrence {
    pub(crate) event: usize,
    pub(crate) values: Vec<Value>,
}

/// An instant: it sees the first `upto` samples, and those from number `from` on are new.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Instant {
    pub(crate) time: Time,
    pub(crate) from: usize,
    pub(crate) upto: usize,
}

impl Instant {
    /// What puts instants in order; no two of a piece have the same.
    pub(crate) fn key(&self) -> (Time, usize) {
        (self.time, self.upto)
    }
}

impl<'a> Piece<'a> {
    pub(crate) fn new(spec: &'a checked::Spec, samples: Vec<(Time, Arrival)>) -> Piece<'a> {
        let last = samples.last().map_or(Time(0), |(time, _)| *time);
        let (latest, updated) = values(spec, &samples);
        let t0 = first_read(&samples);
        let (occurrences, unclear) = (Vec::new(), Vec::new());
        let mut piece = Piece { spec, t0, last, latest, updated, occurrences, unclear, samples };
        for n in 0..piece.samples.len() {
            let (occurrences, faults) = piece.occurrences_of(n);
            piece.occurrences.push(occurrences);
            piece.unclear.push(faults);
        }
        piece
    }

    /// The instants that the clock makes for everyone, in order.
    pub(crate) fn clock_instants(&self) -> Vec<Instant> {
        match self.spec.clock {
            Clock::Events => self.instants_of_samples(),
            Clock::Rate(rate) => self.instants_at_rate(rate),
        }
    }

    /// Each sample that is read is an instant.
    fn instants_of_samples(&self) -> Vec<Instant> {
        let read = self.samples.iter().enumerate().filter(|(_, (_, arrival))| arrival.is_read());
        read.map(|(n, (time, _))| Instant { time: *time, from: n, upto: n + 1 }).collect()
    }

    /// Instants at `t0 + floor(k * 10^9 / rate)`, up to the last sample; each sees all samples that are not later.
    fn instants_at_rate(&self, rate: u32) -> Vec<Instant> {
        let Some(t0) = self.t0 else { return Vec::new() };
        let mut instants = Vec::new();
        let mut from = 0;
        for k in 0i128.. {
            let time = i128::from(t0.0) + k * 1_000_000_000 / i128::from(rate.max(1));
            if time > i128::from(self.last.0) {
                break;
            }
            let time = Time(time as i64);
            let upto = self.arrived(time);
            instants.push(Instant { time, from, upto });
            from = upto;
        }
        instants
    }

    /// How many samples have a stamp that is not later.
    pub(crate) fn arrived(&self, time: Time) -> usize {
        self.samples.iter().filter(|(t, _)| *t <= time).count()
    }

    /// The stamps of a topic's messages among the first `upto` samples.
    pub(crate) fn messages(&self, topic: usize, upto: usize) -> Vec<Time> {
        let of_topic = |a: &Arrival| matches!(a, Arrival::Message { topic: t, .. } if *t == topic);
        self.samples[..upto].iter().filter(|(_, a)| of_topic(a)).map(|(time, _)| *time).collect()
    }

    /// The events that a sample is, conditions tested, and what went wrong with the conditions.
    fn occurrences_of(&self, n: usize) -> (Vec<Occurrence>, Vec<(usize, String)>) {
        let (time, arrival) = &self.samples[n];
        let instant = Instant { time: *time, from: n, upto: n + 1 };
        let (mut found, mut faults) = (Vec::new(), Vec::new());
        for (event, declared) in self.spec.events.iter().enumerate() {
            let Some(values) = fields(event, declared, arrival) else { continue };
            let occurrence = Occurrence { event, values };
            let wanted = declared.when.as_ref().is_none_or(|when| {
                let alone = Course::alone(self, instant, occurrence.clone());
                let holds = alone.holds(when, 0);
                faults.extend(alone.fault().map(|fault| (event, fault)));
                holds
            });
            if wanted {
                found.push(occurrence);
            }
        }
        (found, faults)
    }
}

/// The fields of an event where a sample is one.
fn fields(event: usize, declared: &checked::Event, arrival: &Arrival) -> Option<Vec<Value>> {
    match (arrival, &declared.source) {
        (Arrival::Event { event: e, values }, _) if *e == event => Some(values.clone()),
        (Arrival::Message { topic, values }, EventSource::Message { topic: t }) if topic == t => {
            let field = |f: &checked::EventField| f.wanted.and_then(|w| values.get(w)).cloned().unwrap_or_default();
            Some(declared.fields.iter().map(field).collect())
        }
        _ => None,
    }
}

type Latest = Vec<Vec<Option<Value>>>;
type Updated = Vec<Vec<usize>>;

/// The latest value of each input after each sample, and the inputs that each sample updates.
fn values(spec: &checked::Spec, samples: &[(Time, Arrival)]) -> (Latest, Updated) {
    let mut now: Vec<Option<Value>> = spec.inputs.iter().map(|i| i.default.clone()).collect();
    let mut tracked: Vec<Tracked> = spec.objects.iter().map(|_| Tracked::default()).collect();
    let mut latest = vec![now.clone()];
    let mut all_updated = Vec::new();
    for (time, arrival) in samples {
        let mut deliveries = Vec::new();
        for (object, tracked) in spec.objects.iter().zip(&mut tracked) {
            deliveries.push(match arrival {
                Arrival::Message { topic, values } => tracked.deliver(object, *time, *topic, values),
                _ => None,
            });
        }
        let mut updated = Vec::new();
        for (n, input) in spec.inputs.iter().enumerate() {
            let value = match (&input.source, arrival) {
                (InputSource::Field { topic, field }, Arrival::Message { topic: t, values }) if topic == t => {
                    values.get(*field).cloned()
                }
                (InputSource::Column(column), Arrival::Row { cells }) => cells.get(*column).cloned(),
                (InputSource::World { object, part }, _) => {
                    deliveries.get(*object).and_then(Option::as_ref).and_then(|d| d.part(*part)).map(Value::Num)
                }
                _ => None,
            };
            // No value: what was there before stays.
            if let Some(value) = value.filter(|v| *v != Value::Missing) {
                now[n] = Some(value);
                updated.push(n);
            }
        }
        latest.push(now.clone());
        all_updated.push(updated);
    }
    (latest, all_updated)
}
