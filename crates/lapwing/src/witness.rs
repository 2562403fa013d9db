//! What a report will need of the moments at which something failed, noted when it happens.

use std::sync::Arc;

use lapwing_check::checked::{self, Clock, InputSource, ObjectSource};
use lapwing_engine::inputs::Inputs;
use lapwing_engine::{Alarm, Observer, Output};
use lapwing_react::{Reading, Role, Row, Violation};
use lapwing_stream::{Duration, Sample, Time, Value};

use crate::eval;
use crate::hints::Latch;
use crate::moment::Kept;
pub(crate) use crate::moment::Now;
use crate::ring::{Ring, Source};
use crate::shown::Shown;
use crate::ticks::Ticks;
use crate::trail::{Positions, Trail};

/// So many violations of a property keep their values.
const WITH_VALUES: usize = 10_000;

/// So many violations of a property keep what led to them.
const WITH_HISTORY: usize = 20;

/// So many violations of a property say what its operators over the past are worth, which takes a look at all instants that are kept.
const WITH_PAST: usize = 1000;

/// How many rows lead to a failure.
const ROWS: usize = 6;

/// How far back rows go, in nanoseconds, where the obligation began later than that.
const BACK: i64 = 1_000_000_000;

/// A failure that began an episode.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// The number of the property.
    pub property: usize,
    /// The values of its slices.
    pub instance: Vec<Value>,
    /// What is known of it.
    pub violation: Violation,
    /// Whether another one of the same property was found in the same pass: who reacts has been told already.
    pub is_further: bool,
}

/// What is to be noted of a property.
#[derive(Debug)]
pub(crate) struct Interest {
    /// What its report shows.
    pub shown: Vec<Shown>,
    /// Which instants are its positions.
    pub positions: Positions,
    /// Its `after X`, where it has one.
    pub latch: Option<Latch>,
    /// How long a failure may have begun before it is known, where that is bounded.
    pub latency: Option<Duration>,
    /// The topics of its signals.
    pub topics: Vec<usize>,
}

/// Looks at the engine.
#[derive(Debug)]
pub(crate) struct Witness {
    clock: Clock,
    interests: Arc<[Interest]>,
    ring: Ring,
    /// The first instant since time began or jumped.
    first: Option<Time>,
    /// The stamp of what the engine takes in.
    arriving: Time,
    found: Vec<Found>,
    /// How many violations of each property there were.
    counts: Vec<usize>,
    /// For each property, whether it failed although its `after X` had ceased to hold.
    latched: Vec<bool>,
    /// For each property, for how long each of its topics had been silent when it failed first.
    silences: Vec<Vec<(usize, Duration)>>,
    jumps: Vec<(Time, Time)>,
    /// For each property, whether its monitor has started afresh: then what came before says nothing of it.
    forgotten: Vec<bool>,
}

impl Witness {
    /// Of a specification, and what is to be noted of each of its properties.
    pub fn new(meaning: &checked::Spec, interests: Arc<[Interest]>) -> Witness {
        let mut kept = Kept::default();
        for interest in &*interests {
            interest.shown.iter().for_each(|s| s.keep(&mut kept));
            interest.latch.iter().for_each(|latch| kept.add(&latch.x));
            interest.positions.keep(&mut kept);
        }
        let reach = interests.iter().map(|i| i.latency.map_or(i64::MAX, Duration::nanos)).max().unwrap_or_default();
        let properties = interests.len();
        Witness {
            clock: meaning.clock,
            interests,
            ring: Ring::new(kept, reach, |input| source(meaning, input)),
            first: None,
            arriving: Time(i64::MIN),
            found: Vec::new(),
            counts: vec![0; properties],
            latched: vec![false; properties],
            silences: vec![Vec::new(); properties],
            jumps: Vec::new(),
            forgotten: vec![false; properties],
        }
    }

    /// The engine takes a sample in.
    #[inline]
    pub fn arrives(&mut self, sample: &Sample<'_>) {
        self.arriving = sample.time;
        self.ring.arrive(sample);
    }

    /// Something comes that the engine does not read.
    #[inline]
    pub fn passes(&mut self, time: Time) {
        self.arriving = time;
        self.ring.settle(None);
    }

    /// The failures so far, in the order in which they were told.
    pub fn found(&self) -> &[Found] {
        &self.found
    }

    /// The jumps of time so far, from and to.
    pub fn jumps(&self) -> &[(Time, Time)] {
        &self.jumps
    }

    /// Whether a property failed although its `after X` had ceased to hold.
    pub fn is_latched(&self, property: usize) -> bool {
        self.latched.get(property).copied().unwrap_or_default()
    }

    /// How long it lasts so far, since the first instant or the latest jump.
    pub fn span(&self) -> Duration {
        self.first.map_or(Duration::ZERO, |first| self.arriving.since(first))
    }

    /// The monitor of a property starts afresh.
    pub fn forget(&mut self, property: usize) {
        if let Some(forgotten) = self.forgotten.get_mut(property) {
            *forgotten = true;
        }
    }

    /// For how long each topic of a property had been silent when it failed first.
    pub fn silences(&self, property: usize) -> &[(usize, Duration)] {
        self.silences.get(property).map_or(&[], Vec::as_slice)
    }

    /// The values that an instance of a property shows, as they are at the end.
    pub fn readings(&self, property: usize, instance: &[Value], inputs: &Inputs) -> Vec<Reading> {
        let Some(interest) = self.interests.get(property) else { return Vec::new() };
        let params: Vec<Option<Value>> = instance.iter().cloned().map(Some).collect();
        let trail = Trail::new(&self.ring, &interest.positions, &params, None);
        let now = Now(inputs);
        interest.shown.iter().map(|s| s.reading(&trail.present(&now, self.arriving))).collect()
    }

    /// Whether an instant has that stamp, of those that the engine is about to step through.
    fn is_instant(&self, time: Time) -> bool {
        match (self.clock, self.first) {
            (Clock::Events, _) => time == self.arriving,
            (Clock::Rate(_), None) => true,
            (Clock::Rate(hz), Some(first)) => Ticks { hz, first }.has(time),
        }
    }

    fn find(&mut self, inputs: &Inputs, alarm: Alarm<'_>, is_further: bool) {
        if let Some(violation) = self.violation(inputs, &alarm) {
            let Alarm { property, instance, why, .. } = alarm;
            let instance = instance.iter().flatten().cloned().collect();
            self.found.push(Found { property, instance, violation: Violation { why, ..violation }, is_further });
        }
    }

    fn violation(&mut self, inputs: &Inputs, alarm: &Alarm<'_>) -> Option<Violation> {
        let Alarm { property, instance: params, began, tied, failed, .. } = *alarm;
        let count = self.counts.get_mut(property)?;
        *count += 1;
        let count = *count;
        let interest = self.interests.get(property)?;
        let mut violation = Violation {
            began,
            failed,
            until: failed,
            count: 1,
            values: None,
            began_values: None,
            history: Vec::new(),
            why: None,
        };
        if count > WITH_VALUES {
            return Some(violation);
        }
        if count == 1 {
            let silent = |topic: &usize| Some((*topic, failed.since(inputs.last(*topic)?)));
            self.silences[property] = interest.topics.iter().filter_map(silent).collect();
        }
        let now = Now(inputs);
        let is_new =
            self.ring.instants().next_back().is_none_or(|last| last.time() < failed || self.clock == Clock::Events);
        let present = (is_new && self.is_instant(failed)).then_some((&now as &dyn eval::Moment, failed));
        let asks_past = count <= WITH_PAST && !self.forgotten[property];
        let trail = match asks_past && interest.shown.iter().any(Shown::has_memory) {
            true => Trail::new(&self.ring, &interest.positions, params, present),
            false => Trail::without_past(&interest.positions, params),
        };
        let account = Account { interest, ring: &self.ring, trail: &trail };
        let here = trail.present(&now, failed);
        let values: Vec<Reading> = interest.shown.iter().map(|s| s.reading(&here)).collect();
        violation.began_values = match tied {
            0 if began == failed => Some(values.clone()),
            // The present is none of the instants that are kept yet.
            _ if began == failed && present.is_some() => account.values_at(began, tied - 1),
            _ => account.values_at(began, tied),
        };
        violation.values = Some(values);
        if count <= WITH_HISTORY {
            violation.history = account.history(began.min(failed - Duration::from_nanos(BACK)));
            self.latched[property] |= interest.latch.as_ref().is_some_and(|latch| account.has_ceased(latch, &here));
        }
        Some(violation)
    }
}

/// What a signal may get a value from.
fn source(meaning: &checked::Spec, input: usize) -> Source {
    match meaning.inputs.get(input).map(|input| &input.source) {
        Some(InputSource::Field { topic, .. }) => Source::Topic(*topic),
        Some(InputSource::Column(_)) => Source::Rows,
        Some(InputSource::World { object, .. }) => match meaning.objects.get(*object).map(|object| &object.source) {
            Some(
                ObjectSource::ModelStates { topic, .. }
                | ObjectSource::Odometry { topic, .. }
                | ObjectSource::Pose { topic, .. },
            ) => Source::Topic(*topic),
            Some(ObjectSource::Tf { .. }) | None => Source::Any,
        },
        None => Source::Any,
    }
}

/// What the instants that are kept say of a property.
struct Account<'a> {
    interest: &'a Interest,
    ring: &'a Ring,
    trail: &'a Trail<'a>,
}

impl Account<'_> {
    /// The values at an earlier time: at the last instant up to it but so many that came with that very stamp.
    fn values_at(&self, time: Time, tied: u64) -> Option<Vec<Reading>> {
        let mut until = self.ring.back_from(time).filter(|i| i.time() < time || self.trail.is_position(i));
        let instant = until.nth(usize::try_from(tied).ok()?)?;
        let point = self.trail.past(instant, time);
        Some(self.interest.shown.iter().map(|s| s.reading(&point)).collect())
    }

    /// The values from `since` on where they changed, some of them, the first and the last among them.
    fn history(&self, since: Time) -> Vec<Row> {
        let mut changes = Vec::new();
        let mut before: Option<Vec<Value>> = None;
        let tabled = || self.interest.shown.iter().filter(|s| s.role == Role::Value);
        for instant in self.ring.instants().filter(|i| i.time() >= since) {
            let point = self.trail.past(instant, instant.time());
            let values = tabled().map(|s| s.value(&point)).collect();
            if before.as_ref() != Some(&values) {
                changes.push(instant);
                before = Some(values);
            }
        }
        let chosen: Vec<_> = match changes.len() {
            0..=ROWS => changes,
            n => (0..ROWS).filter_map(|k| changes.get(k * (n - 1) / (ROWS - 1)).copied()).collect(),
        };
        let row = |instant: crate::ring::Instant<'_>| {
            let point = self.trail.past(instant, instant.time());
            Row { time: instant.time(), values: self.interest.shown.iter().map(|s| s.value(&point)).collect() }
        };
        chosen.into_iter().map(row).collect()
    }

    /// Whether the X of an `after X` was false at some moment after it had been true, as far as it is known.
    fn has_ceased(&self, latch: &Latch, here: &dyn eval::Moment) -> bool {
        let mut was_true = false;
        let mut ceased = |x: Option<bool>| {
            was_true |= x == Some(true);
            was_true && x == Some(false)
        };
        let past = self.ring.instants().any(|i| ceased(eval::condition(&latch.x, &self.trail.past(i, i.time()))));
        past || eval::condition(&latch.x, here) == Some(false)
    }
}

impl Observer for Witness {
    fn output(&mut self, inputs: &Inputs, output: Output<'_>) {
        match output {
            Output::Instant(time) => {
                self.first.get_or_insert(time);
                self.ring.push(time, &Now(inputs));
            }
            Output::Alarm(alarm) => self.find(inputs, alarm, false),
            Output::Further(alarm) => self.find(inputs, alarm, true),
            Output::Jump { from, to } => {
                self.ring.clear();
                self.first = None;
                self.jumps.push((from, to));
            }
        }
    }
}
