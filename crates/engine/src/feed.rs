//! The state of a run, and how a sample moves it.

use alloc::string::{String, ToString};
use alloc::vec::Vec;

use lapwing_stream::{Sample, Time, Value, What};
use serde::{Deserialize, Serialize};

use crate::inputs::Inputs;
use crate::outcome::{Observer, Outcome, Output, join};
use crate::piece::Piece;
use crate::program::Program;

/// Everything that a run of a [`Program`] knows. A clone is a snapshot: it goes on as the original would have.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct State {
    /// The stretch of trace since time began or jumped.
    pub(crate) piece: Piece,
    /// What the pieces before the latest jump came to.
    before: Option<Vec<Outcome>>,
    jumps: Vec<(Time, Time)>,
    /// The instants and, per topic, the messages of the pieces before the latest jump.
    counted: (u64, Vec<(u64, u64)>),
    /// Whether margins are computed.
    measures: bool,
}

/// How a trace ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ending {
    /// It broke off: what would be unmet is inconclusive, for this reason.
    pub broke_off: Option<String>,
    /// Topics of which something was lost, and why: what reads one of them and did not fail is inconclusive.
    pub lost: Vec<(usize, String)>,
}

impl State {
    /// Nothing has come yet.
    pub fn new(program: &Program) -> State {
        State {
            piece: Piece::new(program),
            before: None,
            jumps: Vec::new(),
            counted: (0, alloc::vec![(0, 0); program.topics.len()]),
            measures: false,
        }
    }

    /// Nothing has come yet, and [`Outcome::margin`] is wanted. It costs time at every position, and memory where a property has
    /// future operators.
    pub fn with_margins(program: &Program) -> State {
        let mut state = State { measures: true, ..State::new(program) };
        state.piece.measure(program);
        state
    }

    /// Takes a sample in.
    // PERF: rows of truth values are skimmed where they come from; what else there is to do costs more than a call.
    #[inline(always)]
    pub fn feed(&mut self, program: &Program, sample: Sample<'_>, observer: &mut impl Observer) {
        match sample.what {
            What::Row { cells } if self.piece.skim(program, sample.time.0, cells, observer) => {}
            What::Row { cells } => self.take_row(program, sample.time, cells, observer),
            _ => self.take(program, sample, observer),
        }
    }

    /// Time goes on to where nothing happens by itself: what [`State::feed`] does with [`What::Other`] then. Returns whether it is so; else nothing
    /// has happened.
    // PERF: of most recordings most messages are read by nobody.
    #[inline]
    pub fn passes_quietly(&mut self, time: Time) -> bool {
        let is_quiet = self.piece.is_quiet_until(time.0);
        if is_quiet {
            self.piece.newest = time.0;
        }
        is_quiet
    }

    // PERF: where rows are skimmed there is no sample in memory.
    #[inline(never)]
    fn take_row(&mut self, program: &Program, time: Time, cells: &[Value], observer: &mut impl Observer) {
        self.take(program, Sample { time, what: What::Row { cells } }, observer);
    }

    #[inline]
    fn take(&mut self, program: &Program, sample: Sample<'_>, observer: &mut impl Observer) {
        let now = sample.time.0;
        if self.piece.is_quiet_until(now) || self.reach(program, now, observer) {
            self.piece.take(program, sample, observer);
        }
    }

    /// Time goes on to `now`, or back. Returns whether what comes then still counts.
    #[inline(never)]
    fn reach(&mut self, program: &Program, now: i64, observer: &mut impl Observer) -> bool {
        if now < self.piece.newest || self.piece.is_absurd(program, now) {
            self.jump(program, Time(now), observer);
        }
        if self.piece.is_timed_out(program, now) {
            self.piece.time_out(now);
            return false;
        }
        self.piece.newest = now;
        self.piece.pass_time(program, now, observer);
        true
    }

    /// Time went back: what has been ends here, and everything starts anew.
    fn jump(&mut self, program: &Program, to: Time, observer: &mut impl Observer) {
        let from = Time(self.piece.newest);
        let mut outcomes = self.piece.finish(program, &Ending::default(), observer);
        outcomes.iter_mut().for_each(Outcome::cut_off_by_jump);
        self.before = Some(join(self.before.take(), outcomes));
        self.jumps.push((from, to));
        self.counted = (self.instants(), (0..program.topics.len()).map(|topic| self.messages(topic)).collect());
        self.piece = Piece::new(program);
        if self.measures {
            self.piece.measure(program);
        }
        observer.output(&self.piece.inputs, Output::Jump { from, to });
    }

    /// The trace is over: the outcome of every property, instances in the order in which they came.
    ///
    /// The state cannot be fed after; to know the outcome so far, finish a clone.
    pub fn finish(&mut self, program: &Program, ending: &Ending, observer: &mut impl Observer) -> Vec<Outcome> {
        let mut outcomes = join(self.before.take(), self.piece.finish(program, ending, observer));
        for (number, property) in program.properties.iter().enumerate() {
            if !outcomes.iter().any(|o| o.property == number) {
                let cause = Some("no value to make an instance of was seen".to_string());
                outcomes.push(Outcome { cause, ..Outcome::blank(number, property.scopes) });
            }
        }
        outcomes.sort_by_key(|o| o.property);
        outcomes
    }

    /// When something happens though nothing comes: a live caller feeds a sample without content once its clock has passed it.
    pub fn next_deadline(&mut self, program: &Program) -> Option<Time> {
        Some(self.piece.next_by_itself(program)).filter(|&at| at != i64::MAX).map(Time)
    }

    /// The latest of everything.
    pub fn inputs(&self) -> &Inputs {
        &self.piece.inputs
    }

    /// The number of instants of the specification's clock so far.
    pub fn instants(&self) -> u64 {
        self.counted.0 + self.piece.instants
    }

    /// The jumps back in time, from and to.
    pub fn jumps(&self) -> &[(Time, Time)] {
        &self.jumps
    }

    /// How many messages of a topic came, and how many of them no instant saw.
    pub fn messages(&self, topic: usize) -> (u64, u64) {
        let of = |messages: &[(u64, u64)]| messages.get(topic).copied().unwrap_or_default();
        let (before, piece) = (of(&self.counted.1), of(&self.piece.messages));
        (before.0 + piece.0, before.1 + piece.1)
    }
}
