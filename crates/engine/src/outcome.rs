//! What comes out of a monitor.

use alloc::string::String;
use alloc::vec::Vec;

use lapwing_stream::{Time, Value, Verdict};
use serde::{Deserialize, Serialize};

use crate::inputs::Inputs;

/// Failed obligations of one segment and one conjunct at consecutive positions.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default, Serialize, Deserialize)]
pub struct Episode {
    /// When the first of them to fail failed.
    pub failed: Time,
    /// When that one began.
    pub began: Time,
    /// When the last of them failed.
    pub until: Time,
    /// How many failed.
    pub count: u64,
}

/// Something worth telling at once.
#[derive(Clone, Debug)]
pub enum Output<'a> {
    /// An obligation failed that continues no episode.
    Alarm(Alarm<'a>),
    /// Another one of the same conjunct that failed in the same pass and continues no episode either: who reacts has been told already.
    Further(Alarm<'a>),
    /// An instant of the specification's clock is over.
    Instant(Time),
    /// Time went back: every monitor has started anew.
    Jump {
        /// The last stamp before.
        from: Time,
        /// The first after.
        to: Time,
    },
}

/// An episode begins.
#[derive(Clone, Debug)]
pub struct Alarm<'a> {
    /// The number of the property.
    pub property: usize,
    /// The values of its slices.
    pub instance: &'a [Option<Value>],
    /// When the obligation began.
    pub began: Time,
    /// How many positions after the one at which it began have come with that very stamp.
    pub tied: u64,
    /// When it failed.
    pub failed: Time,
    /// What a machine did, where it is one: `illegal transition a -> b`.
    pub why: Option<String>,
    /// Where that is a move that its diagram does not have: which.
    pub illegal: Option<Move>,
}

/// A machine's move from a state to another, by their numbers; `None` where no state fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Move {
    /// The state that it left.
    pub from: Option<usize>,
    /// The state that it is in now.
    pub to: Option<usize>,
}

impl Alarm<'_> {
    /// What failed where it began.
    pub(crate) fn at(time: Time) -> Self {
        Alarm { property: 0, instance: &[], began: time, tied: 0, failed: time, why: None, illegal: None }
    }
}

/// Who wants to be told, with what the world looked like at that moment.
pub trait Observer {
    /// Something happened.
    fn output(&mut self, _inputs: &Inputs, _output: Output<'_>) {}

    /// Whether it wants [`Observer::margin`], which costs time.
    fn wants_margins(&self) -> bool {
        false
    }

    /// By how much the obligations of a property that begin at a position miss changing its verdict; NaN where none begins. It is told where
    /// margins are computed: at the position itself where it is known then, else when the trace is over, and of a property of both kinds twice.
    fn margin(&mut self, _property: usize, _instance: &[Option<Value>], _at: Time, _margin: f64) {}
}

/// Nobody.
impl Observer for () {}

impl<F: FnMut(&Inputs, Output<'_>)> Observer for F {
    fn output(&mut self, inputs: &Inputs, output: Output<'_>) {
        self(inputs, output);
    }
}

/// What is said of a property, or of one instance of it, at the end.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Outcome {
    /// The number of the property.
    pub property: usize,
    /// The values of its slices; empty where it has none.
    pub instance: Vec<Value>,
    /// The verdict.
    pub verdict: Verdict,
    /// Why it is inconclusive.
    pub cause: Option<String>,
    /// Whether a success has a scope or `whenever` that was never triggered.
    pub vacuous: bool,
    /// How often each scope and `whenever` was entered, in the order of the text.
    pub entered: Vec<u64>,
    /// Obligations met, failed and open.
    pub met: u64,
    /// See `met`.
    pub failed: u64,
    /// See `met`.
    pub open: u64,
    /// The failures, by the time of the first failure, then of beginning.
    pub episodes: Vec<Episode>,
    /// When the oldest obligation began that something still had to happen for.
    pub unmet_since: Option<Time>,
    /// How many comparisons met a NaN.
    pub nans: u64,
    /// How many positions it had.
    pub positions: u64,
    /// The worst margin of its obligations, where margins are computed and it has one.
    pub margin: Option<f64>,
    /// Whether its margin would have taken more memory than is allowed.
    pub margin_gave_up: bool,
}

/// Joins what was said on two pieces of a trace, property by property, instance by instance: an instance whose value only one piece
/// saw was judged there alone.
pub(crate) fn join(before: Option<Vec<Outcome>>, later: Vec<Outcome>) -> Vec<Outcome> {
    let Some(mut all) = before else { return later };
    for outcome in later {
        match all.iter_mut().find(|o| (o.property, &o.instance) == (outcome.property, &outcome.instance)) {
            Some(same) => same.join(outcome),
            None => all.push(outcome),
        }
    }
    // Stable: instances stay in the order in which their values were seen.
    all.sort_by_key(|o| o.property);
    all
}

impl Outcome {
    /// Time jumps back: what was unmet can no longer be judged.
    pub(crate) fn cut_off_by_jump(&mut self) {
        if self.verdict == Verdict::Unmet {
            self.verdict = Verdict::Inconclusive;
            self.cause = Some("time jumped before what had to happen happened".into());
        }
    }

    /// Joins the outcome of a later piece of the trace, after a jump back in time.
    fn join(&mut self, later: Outcome) {
        if later.verdict < self.verdict || (later.verdict == self.verdict && self.cause.is_none()) {
            (self.verdict, self.cause) = (later.verdict, later.cause);
        }
        self.entered.iter_mut().zip(&later.entered).for_each(|(a, b)| *a += b);
        self.met += later.met;
        self.failed += later.failed;
        self.open += later.open;
        self.episodes.extend(later.episodes);
        self.unmet_since = self.unmet_since.or(later.unmet_since);
        self.nans += later.nans;
        self.positions += later.positions;
        self.margin_gave_up |= later.margin_gave_up;
        let margins = [self.margin, later.margin].into_iter().flatten();
        self.margin = margins.reduce(f64::min).filter(|_| !self.margin_gave_up);
        self.vacuous = self.verdict.is_success() && self.entered.contains(&0);
    }
}
