//! The positions of a property that led to a moment: what its operators over the past look at, as far as it is kept.

use std::cell::Cell;

use lapwing_check::checked::{self, Clock, Expr, Kind, Read, ReadOf, Slice};
use lapwing_stream::{Time, Value};

use crate::moment::{Kept, Moment};
use crate::ring::{Instant, Ring};

/// So many values are computed for one report of what an operator over the past is worth; beyond that it is not said.
const FUEL: u32 = 100_000;

/// Which instants are positions of a property.
#[derive(Clone, Debug, Default)]
pub(crate) struct Positions {
    reads: Vec<Read>,
    alphabet: Option<Vec<usize>>,
    slices: Vec<Slice>,
    /// Whether it has instants of its own, which a ring does not keep.
    has_own: bool,
}

impl Positions {
    /// Those of a property.
    pub fn of(meaning: &checked::Spec, property: &checked::Property) -> Positions {
        // A comparison of an age makes instants where nothing comes.
        let reads_age = meaning.clock == Clock::Events && is_aged(meaning, property);
        Positions {
            reads: property.reads.clone(),
            alphabet: property.alphabet.clone(),
            slices: property.slices.clone(),
            has_own: reads_age,
        }
    }

    /// Adds what has to be kept to tell positions from other instants.
    pub fn keep(&self, kept: &mut Kept) {
        self.alphabet.iter().flatten().for_each(|&event| kept.add_event(event));
        self.reads.iter().for_each(|read| kept.add_read(*read));
    }

    /// Whether a slice hides an event with these fields from the instance with those values.
    fn hides(&self, event: usize, fields: &[Value], params: &[Option<Value>]) -> bool {
        self.slices.iter().zip(params).any(|(slice, param)| {
            let values = slice.fields.iter().filter(|(e, _)| *e == event).filter_map(|(_, f)| fields.get(*f));
            values.filter(|v| **v != Value::Missing).any(|v| param.as_ref() != Some(v))
        })
    }
}

fn is_aged(meaning: &checked::Spec, property: &checked::Property) -> bool {
    let formula = match &property.body {
        checked::Body::Formula(formula) => Some(formula),
        _ => None,
    };
    let machines = meaning.machines.iter().flat_map(checked::Machine::conditions);
    formula.into_iter().chain(machines).any(has_age)
}

fn has_age(e: &Expr) -> bool {
    matches!(e.kind, Kind::Age(_)) || e.children().into_iter().any(has_age)
}

/// What is seen at a [`Point`].
#[derive(Clone, Copy)]
enum Seen<'t> {
    Now(&'t dyn Moment),
    Kept(Instant<'t>),
}

/// The positions of an instance of a property up to now, as far as they are kept.
pub(crate) struct Trail<'t> {
    positions: &'t Positions,
    params: &'t [Option<Value>],
    /// The kept instants that are positions, or come before position 0 and may be looked back at.
    kept: Vec<Instant<'t>>,
    /// The number among them of position 0, where it is kept.
    start: Option<usize>,
    /// The present, after those.
    now: Option<(&'t dyn Moment, Time)>,
    fuel: Cell<u32>,
}

/// A moment as an instance of a property sees it.
#[derive(Clone, Copy)]
pub(crate) struct Point<'t> {
    seen: Seen<'t>,
    /// When it is.
    pub time: Time,
    trail: &'t Trail<'t>,
    /// Its number in the trail; where it lies between two positions, that of the one before it.
    rank: Option<usize>,
}

impl<'t> Trail<'t> {
    /// What led to the present. `now` is the present where it is a position that the ring does not have yet.
    pub fn new(
        ring: &'t Ring,
        positions: &'t Positions,
        params: &'t [Option<Value>],
        now: Option<(&'t dyn Moment, Time)>,
    ) -> Trail<'t> {
        let mut trail = Trail { positions, params, kept: Vec::new(), start: None, now, fuel: Cell::new(FUEL) };
        if !trail.knows_reads(ring) || positions.has_own {
            return Trail { now: None, ..trail };
        }
        trail.kept = ring.instants().filter(|instant| trail.is_position(instant)).collect();
        trail.start = trail.first(ring.is_whole());
        trail
    }

    /// The present alone, where nobody asks for what led to it.
    pub fn without_past(positions: &'t Positions, params: &'t [Option<Value>]) -> Trail<'t> {
        Trail { positions, params, kept: Vec::new(), start: None, now: None, fuel: Cell::new(FUEL) }
    }

    /// Whether everything that makes position 0 is kept: it must be there by now.
    fn knows_reads(&self, ring: &Ring) -> bool {
        let latest = ring.instants().next_back();
        latest.is_none_or(|latest| self.positions.reads.iter().all(|r| is_defined(*r, &latest)))
            || self
                .now
                .is_some_and(|(now, _)| self.positions.reads.iter().all(|r| is_defined(*r, now)) && ring.is_whole())
    }

    /// Whether the property steps at an instant, or would if it had started.
    pub fn is_position(&self, instant: &Instant<'_>) -> bool {
        let alphabet = self.positions.alphabet.as_ref();
        alphabet.is_none_or(|events| events.iter().any(|&event| self.event(instant, event).is_some()))
    }

    /// The number of position 0, the first at which everything has been defined for long enough; `None` where it is not kept any more.
    fn first(&self, is_whole: bool) -> Option<usize> {
        if self.positions.alphabet.is_some() {
            return is_whole.then_some(0);
        }
        let defined_from = |read: &Read| {
            let kept = self.kept.iter().position(|instant| is_defined(*read, instant));
            let now = || self.now.filter(|(now, _)| is_defined(*read, *now)).map(|_| self.kept.len());
            Some((kept.or_else(now)?, read.depth))
        };
        let reads: Vec<(usize, usize)> = self.positions.reads.iter().map(defined_from).collect::<Option<_>>()?;
        let is_late = reads.iter().any(|(from, _)| *from > 0);
        (is_whole || is_late).then(|| reads.iter().map(|(from, depth)| from + depth).max().unwrap_or(0))
    }

    fn event<'m>(&self, moment: &'m (impl Moment + ?Sized), event: usize) -> Option<&'m [Value]> {
        moment.event(event).filter(|fields| !self.positions.hides(event, fields, self.params))
    }

    /// The present, as the engine sees it.
    pub fn present(&'t self, moment: &'t dyn Moment, time: Time) -> Point<'t> {
        let rank = if self.now.is_some() { Some(self.kept.len()) } else { self.kept.len().checked_sub(1) };
        Point { seen: Seen::Now(moment), time, trail: self, rank }
    }

    /// A moment of the past, that of a kept instant or a later one before the next.
    pub fn past(&'t self, instant: Instant<'t>, time: Time) -> Point<'t> {
        let rank = self.kept.partition_point(|kept| kept.number() <= instant.number()).checked_sub(1);
        Point { seen: Seen::Kept(instant), time, trail: self, rank }
    }

    fn point(&'t self, rank: usize) -> Option<Point<'t>> {
        let (seen, time) = match (self.kept.get(rank), self.now) {
            (Some(instant), _) => (Seen::Kept(*instant), instant.time()),
            (None, Some((now, time))) if rank == self.kept.len() => (Seen::Now(now), time),
            _ => return None,
        };
        Some(Point { seen, time, trail: self, rank: Some(rank) })
    }
}

/// Whether a read has a value at a moment.
fn is_defined(read: Read, moment: &(impl Moment + ?Sized)) -> bool {
    match read.what {
        ReadOf::Input(input) => *moment.value(input) != Value::Missing,
        ReadOf::Topic(topic) => moment.last(topic).is_some(),
    }
}

impl<'t> Point<'t> {
    fn moment(&self) -> &dyn Moment {
        match &self.seen {
            Seen::Now(moment) => *moment,
            Seen::Kept(instant) => instant,
        }
    }

    /// The position so many before the one that it is, or that it follows; before position 0 as well.
    pub fn before(&self, positions: usize) -> Option<Point<'t>> {
        self.trail.point(self.rank?.checked_sub(positions)?)
    }

    /// The positions from the one that it is, or that it follows, back to position 0, and whether that is where they end:
    /// else they end where nothing is kept any more.
    pub fn back(&self) -> (impl Iterator<Item = Point<'t>>, bool) {
        let start = self.trail.start;
        let ranks = self.rank.map(|rank| (start.unwrap_or(0)..=rank).rev()).into_iter().flatten();
        let trail = self.trail;
        (ranks.filter_map(move |rank| trail.point(rank)), start.is_some())
    }

    /// Takes one from what may be spent on a report. Where nothing is left, nothing more is said.
    pub fn spend(&self) -> Option<()> {
        self.trail.fuel.set(self.trail.fuel.get().checked_sub(1)?);
        Some(())
    }
}

impl Moment for Point<'_> {
    fn value(&self, input: usize) -> &Value {
        self.moment().value(input)
    }

    /// No slice hides it. Between two instants none occurs.
    fn event(&self, event: usize) -> Option<&[Value]> {
        let is_between = matches!(self.seen, Seen::Kept(instant) if instant.time() != self.time);
        if is_between { None } else { self.trail.event(self.moment(), event) }
    }

    fn state(&self, machine: usize) -> Option<usize> {
        self.moment().state(machine)
    }

    fn last(&self, topic: usize) -> Option<Time> {
        self.moment().last(topic)
    }

    fn is_fresh(&self, topic: usize) -> bool {
        self.moment().is_fresh(topic)
    }

    fn messages_after(&self, topic: usize, time: Time) -> Option<usize> {
        self.moment().messages_after(topic, time)
    }

    fn param(&self, number: usize) -> Option<&Value> {
        self.trail.params.get(number)?.as_ref()
    }

    fn point(&self) -> Option<Point<'_>> {
        Some(*self)
    }
}
