//! The log of a run, line by line as the original engine writes it.

use crate::engine::{Engine, Fault, MoveId, MoveKind, Offer, Standing};
use crate::host::Host;
use crate::time::Time;
use std::cell::RefCell;
use std::io::Write;
use std::rc::Rc;

/// Where the log goes, and what a model prints: both to one place, in the order in which they come.
pub type Sink<'w> = Rc<RefCell<dyn Write + 'w>>;

/// How much is logged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// What goes wrong.
    Silent,
    /// What is possible and what is done, too.
    #[default]
    Verbose,
}

/// Writes the log of a run.
pub struct Log<'w> {
    sink: Sink<'w>,
    detail: Detail,
    /// The number of the state.
    state: u64,
}

/// What every line begins with.
const PREFIX: &str = "[BIP ENGINE]: ";

impl<'w> Log<'w> {
    /// A log that begins with state 0.
    pub fn new(sink: Sink<'w>, detail: Detail) -> Log<'w> {
        Log { sink, detail, state: 0 }
    }

    /// How many steps there were.
    pub fn state(&self) -> u64 {
        self.state
    }

    pub(crate) fn next_state(&mut self) {
        self.state += 1;
    }

    /// Where nobody reads there is nothing to be done about it.
    fn line(&self, text: std::fmt::Arguments<'_>) {
        let _ = writeln!(self.sink.borrow_mut(), "{PREFIX}{text}");
    }

    /// Gives everything out that has been written.
    pub(crate) fn flush(&self) {
        let _ = self.sink.borrow_mut().flush();
    }

    /// A line of a verbose log.
    pub(crate) fn remark(&self, text: std::fmt::Arguments<'_>) {
        if self.detail == Detail::Verbose {
            self.line(text);
        }
    }

    pub(crate) fn prompt(&self, text: &str) {
        let _ = write!(self.sink.borrow_mut(), "{PREFIX}{text}");
        self.flush();
    }

    pub(crate) fn banner(&self, seed: u64) {
        self.remark(format_args!("BIP Engine (version {} )", env!("CARGO_PKG_VERSION")));
        self.remark(format_args!(""));
        self.remark(format_args!("initialize components..."));
        self.remark(format_args!("random scheduling based on seed={seed}"));
    }

    /// What is possible in the state.
    pub(crate) fn possible<H: Host>(&self, engine: &Engine<H>) {
        if self.detail == Detail::Silent {
            return;
        }
        let count = |kind: MoveKind| engine.offers().iter().filter(|o| engine.kind(o.id) == kind).count();
        let kinds = [
            (count(MoveKind::Interaction), "interaction"),
            (count(MoveKind::Internal), "internal port"),
            (count(MoveKind::External), "external port"),
        ];
        let plural = |n: usize| if n == 1 { "" } else { "s" };
        let named = kinds.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}{}", plural(*n)));
        let counts = named.collect::<Vec<_>>().join(" and ");
        self.line(format_args!("state #{} and global time {}: {counts}:", self.state, engine.now()));
        for (index, Offer { id, window }) in engine.offers().iter().enumerate() {
            self.line(format_args!("  [{index}] {} {window}", engine.show_move(*id)));
        }
    }

    /// What was chosen.
    pub(crate) fn chosen<H: Host>(&self, engine: &Engine<H>, id: MoveId, at: Time) {
        if self.detail == Detail::Silent {
            return;
        }
        let index = engine.offers().iter().position(|o| o.id == id).unwrap_or(0);
        self.line(format_args!("-> choose [{index}] {} at global time {at}", engine.show_move(id)));
    }

    /// A state in which nothing is possible.
    pub(crate) fn stuck(&self, now: Time, standing: Standing) {
        let state = self.state;
        match standing {
            Standing::Open => {}
            Standing::Deadlock => self.remark(format_args!("state #{state} and global time {now}: deadlock!")),
            Standing::TimeLock { at, before: false } => {
                self.remark(format_args!("state #{state} and global time {now}: time-lock at {at}!"));
            }
            Standing::TimeLock { at, before: true } => {
                self.remark(format_args!("state #{state} and global time {now}: time-lock right before {at}!"));
            }
        }
    }

    pub(crate) fn limit(&self, now: Time, limit: u64) {
        let state = self.state;
        self.remark(format_args!("state #{state} and global time {now}: stop (reached limit of {limit} states)"));
    }

    /// A violation that does not end the run.
    pub(crate) fn warning(&self, at: Time, whose: &str, line: &str) {
        let state = self.state;
        self.line(format_args!(
            "WARNING: state #{state} and global time {at}: violation of the following timing constraint {whose}:"
        ));
        self.line(format_args!("  {line}"));
    }

    /// What ends the run.
    pub(crate) fn error(&self, fault: &Fault) {
        match fault {
            Fault::TimeSafety { at, violated } => {
                let state = self.state;
                self.line(format_args!(
                    "ERROR: state #{state} and global time {at}: violation of the following timing constraints:"
                ));
                violated.iter().for_each(|line| self.line(format_args!("  {line}")));
            }
            fault => self.line(format_args!("ERROR: {fault}")),
        }
        self.flush();
    }
}
