//! What a report will need of the moments at which something failed, noted when it happens.

use lapwing_engine::inputs::Inputs;
use lapwing_engine::{Observer, Output};
use lapwing_react::{Reading, Row, Violation};
use lapwing_stream::{Duration, Time, Value};

use crate::eval::{self, Moment};
use crate::hints::Latch;
use crate::ring::Ring;
use crate::shown::Shown;

/// So many violations of a property keep their values.
const WITH_VALUES: usize = 10_000;

/// So many violations of a property keep what led to them.
const WITH_HISTORY: usize = 20;

/// How many rows lead to a failure.
const ROWS: usize = 6;

/// How far back rows go, in nanoseconds, where the obligation began later than that.
const BACK: i64 = 1_000_000_000;

/// The longest array whose value is kept.
const LONGEST: usize = 1000;

/// A failure that began an episode.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// The number of the property.
    pub property: usize,
    /// The values of its slices.
    pub instance: Vec<Value>,
    /// What is known of it.
    pub violation: Violation,
}

/// What is to be noted of a property.
#[derive(Debug)]
pub(crate) struct Interest {
    /// What its report shows.
    pub shown: Vec<Shown>,
    /// Its `after X`, where it has one.
    pub latch: Option<Latch>,
}

/// Looks at the engine.
#[derive(Debug)]
pub(crate) struct Witness {
    interests: Vec<Interest>,
    ring: Ring,
    found: Vec<Found>,
    /// How many violations of each property there were.
    counts: Vec<usize>,
    /// For each property, whether it failed although its `after X` had ceased to hold.
    latched: Vec<bool>,
    jumps: Vec<(Time, Time)>,
}

/// What the world looks like to the engine now.
pub(crate) struct Now<'i>(pub &'i Inputs);

impl Moment for Now<'_> {
    fn value(&self, input: usize) -> &Value {
        self.0.value(input)
    }
}

impl Witness {
    /// Of a specification with so many signals, and what is to be noted of each property.
    pub fn new(inputs: usize, interests: Vec<Interest>) -> Witness {
        let mut read = vec![false; inputs];
        let latches = interests.iter().filter_map(|i| i.latch.as_ref().map(|l| &l.x));
        let shown = interests.iter().flat_map(|i| i.shown.iter().map(|s| &s.expr));
        shown.chain(latches).for_each(|e| mark(e, &mut read));
        let properties = interests.len();
        Witness {
            interests,
            ring: Ring::new(inputs, |input| read[input]),
            found: Vec::new(),
            counts: vec![0; properties],
            latched: vec![false; properties],
            jumps: Vec::new(),
        }
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

    /// The values that a property shows, as they are now.
    pub fn readings(&self, property: usize, inputs: &Inputs) -> Vec<Reading> {
        self.interests.get(property).map_or_else(Vec::new, |interest| readings(&interest.shown, &Now(inputs)))
    }

    fn alarm(&mut self, inputs: &Inputs, property: usize, began: Time, failed: Time) -> Option<Violation> {
        let interest = self.interests.get(property)?;
        let count = self.counts.get_mut(property)?;
        *count += 1;
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
        if *count <= WITH_VALUES {
            let values = readings(&interest.shown, &Now(inputs));
            violation.began_values =
                if began == failed { Some(values.clone()) } else { began_values(&self.ring, interest, began) };
            violation.values = Some(values);
        }
        if *count <= WITH_HISTORY {
            violation.history = history(&self.ring, interest, began.min(failed - Duration::from_nanos(BACK)));
            self.latched[property] |=
                interest.latch.as_ref().is_some_and(|latch| has_ceased(latch, &self.ring, inputs));
        }
        Some(violation)
    }
}

impl Observer for Witness {
    fn output(&mut self, inputs: &Inputs, output: Output<'_>) {
        match output {
            Output::Instant(time) => self.ring.push(time, |input| inputs.value(input)),
            Output::Alarm { property, instance, began, failed, why } => {
                if let Some(violation) = self.alarm(inputs, property, began, failed) {
                    let instance = instance.iter().flatten().cloned().collect();
                    self.found.push(Found { property, instance, violation: Violation { why, ..violation } });
                }
            }
            Output::Jump { from, to } => {
                self.ring.clear();
                self.jumps.push((from, to));
            }
        }
    }
}

/// Marks the signals that an expression reads.
fn mark(e: &lapwing_check::checked::Expr, read: &mut [bool]) {
    if let lapwing_check::checked::Kind::Input(input) = e.kind
        && let Some(read) = read.get_mut(input)
    {
        *read = true;
    }
    e.children().into_iter().for_each(|c| mark(c, read));
}

fn readings(shown: &[Shown], at: &dyn Moment) -> Vec<Reading> {
    shown.iter().map(|s| Reading { name: s.name.clone(), value: value(s, at) }).collect()
}

fn value(shown: &Shown, at: &dyn Moment) -> Value {
    match eval::eval(&shown.expr, at).unwrap_or_default() {
        Value::Nums(xs) if xs.len() > LONGEST => Value::Str(format!("an array of {}", xs.len())),
        Value::List(xs) if xs.len() > LONGEST => Value::Str(format!("an array of {}", xs.len())),
        other => other,
    }
}

fn began_values(ring: &Ring, interest: &Interest, began: Time) -> Option<Vec<Reading>> {
    let mut instants = ring.instants().rev().skip_while(|i| i.time() > began);
    instants.next().filter(|i| i.time() == began).map(|i| readings(&interest.shown, &i))
}

/// The values from `since` on where they changed, some of them, the first and the last among them.
fn history(ring: &Ring, interest: &Interest, since: Time) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for instant in ring.instants().filter(|i| i.time() >= since) {
        let values: Vec<Value> = interest.shown.iter().map(|s| value(s, &instant)).collect();
        if rows.last().is_none_or(|last| last.values != values) {
            rows.push(Row { time: instant.time(), values });
        }
    }
    match rows.len() {
        0..=ROWS => rows,
        n => (0..ROWS).filter_map(|k| rows.get(k * (n - 1) / (ROWS - 1)).cloned()).collect(),
    }
}

/// Whether the X of an `after X` was false at some moment after it had been true, as far as it is known.
fn has_ceased(latch: &Latch, ring: &Ring, inputs: &Inputs) -> bool {
    let x = |at: &dyn Moment| eval::condition(&latch.x, at);
    let mut was_true = false;
    let ceased = ring.instants().any(|instant| match x(&instant) {
        Some(true) => {
            was_true = true;
            false
        }
        Some(false) => was_true,
        None => false,
    });
    ceased || x(&Now(inputs)) == Some(false)
}
