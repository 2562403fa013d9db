//! What is to be done at a call site: which values are taken of it, and what they come to.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use lapwing_stream::Value;

use crate::wants::Place;

/// The plan of a call site. Its values lie side by side in a scratch: the cells of a row, the fields of each event, what a span carries.
#[derive(Debug)]
pub(crate) struct Site {
    /// How many values there are.
    pub width: usize,
    /// For each field, by its number: the places that its value goes to.
    pub routes: Box<[Box<[usize]>]>,
    /// The row of signals, where it sets one.
    pub row: Option<Range<usize>>,
    /// What it raises.
    pub raises: Box<[Raise]>,
    /// Whether what it raises depends on the spans around it.
    pub asks_around: bool,
    /// What a span is besides.
    pub span: Option<SpanPlan>,
    pub origin: Origin,
}

/// An event of the specification that a call site raises.
#[derive(Debug)]
pub(crate) struct Raise {
    /// Its number.
    pub event: usize,
    pub when: When,
    /// Its fields.
    pub values: Range<usize>,
    /// The bit of the function that it has to be below.
    pub below: Option<usize>,
    /// Places of fields that a span around it may have, with their numbers among what spans carry.
    pub inherited: Box<[(usize, usize)]>,
}

/// When an event is raised.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum When {
    /// Whenever the call site is passed.
    Always,
    /// When the span begins.
    Begins,
    /// When the field whose value goes to this place gets one.
    Gets(usize),
}

/// What a span is to those inside it, and at its end.
#[derive(Debug)]
pub(crate) struct SpanPlan {
    /// The functions that it is, of those that events are to be below.
    pub bits: u64,
    /// What its return raises.
    pub returns: Box<[Returned]>,
    /// The places of the fields that it hands on.
    pub carried: Range<usize>,
}

/// An event that a function's return raises.
#[derive(Debug)]
pub(crate) struct Returned {
    pub event: usize,
    pub below: Option<usize>,
    pub fields: Box<[Source]>,
}

/// Where a field of a return comes from.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Source {
    /// What the function returned.
    Result,
    /// The error that it returned.
    Error,
    /// A field of its span, or of one around it.
    Carried(usize),
    /// Nobody has it.
    Nowhere,
}

/// Where a call site stands.
#[derive(Debug)]
pub(crate) struct Origin {
    file: Option<String>,
    line: Option<u32>,
    /// Whether a span of it ended of itself without having recorded what it returned.
    ended_without_return: AtomicBool,
    /// Whether one has recorded what it returned: then one that does not has not returned.
    has_result: AtomicBool,
}

impl Origin {
    pub fn of(place: &Place<'_>) -> Origin {
        Origin {
            file: place.file.map(str::to_owned),
            line: place.line,
            ended_without_return: AtomicBool::default(),
            has_result: AtomicBool::default(),
        }
    }

    /// Whether it is the same place: `#[instrument]` puts what a function returns at the place of its span.
    pub fn is_at(&self, file: Option<&str>, line: Option<u32>) -> bool {
        line.is_some() && self.line == line && self.file.as_deref() == file
    }

    pub fn note_end_without_return(&self) {
        self.ended_without_return.store(true, Ordering::Relaxed);
    }

    pub fn has_ended_without_return(&self) -> bool {
        self.ended_without_return.load(Ordering::Relaxed)
    }

    pub fn note_result(&self) {
        // It is asked for at every end, and said at every return.
        if !self.records_result() {
            self.has_result.store(true, Ordering::Relaxed);
        }
    }

    pub fn records_result(&self) -> bool {
        self.has_result.load(Ordering::Relaxed)
    }
}

/// What is known when a call site is passed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passing<'a> {
    /// The values that it gave, by the plan of the site.
    pub values: &'a [Value],
    /// The functions, of those that events are to be below, whose calls are active.
    pub below: u64,
    /// Whether a span begins here.
    pub begins: bool,
}

impl Site {
    /// The cells of the row that it sets, if any of them got a value.
    pub fn cells<'a>(&self, passing: Passing<'a>) -> Option<&'a [Value]> {
        let cells = passing.values.get(self.row.clone()?)?;
        cells.iter().any(|v| !matches!(v, Value::Missing)).then_some(cells)
    }

    /// The events that it raises, with their fields, in the order of the specification.
    pub fn raised<'a>(&'a self, passing: Passing<'a>) -> impl Iterator<Item = (usize, &'a [Value])> {
        let raises = self.raises.iter().filter(move |raise| raise.is_raised(passing));
        raises.filter_map(move |raise| Some((raise.event, passing.values.get(raise.values.clone())?)))
    }

    /// Whether anything comes of passing it.
    pub fn says_something(&self, passing: Passing<'_>) -> bool {
        self.cells(passing).is_some() || self.raises.iter().any(|raise| raise.is_raised(passing))
    }
}

impl Raise {
    fn is_raised(&self, passing: Passing<'_>) -> bool {
        let happens = match self.when {
            When::Always => true,
            When::Begins => passing.begins,
            When::Gets(slot) => passing.values.get(slot).is_some_and(|v| !matches!(v, Value::Missing)),
        };
        happens && is_below(self.below, passing.below)
    }
}

/// Whether a call of the wanted function is active.
pub(crate) fn is_below(wanted: Option<usize>, active: u64) -> bool {
    wanted.is_none_or(|bit| active & (1 << bit) != 0)
}
