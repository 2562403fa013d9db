//! Where reports go: in the order of the recordings, whatever the order in which they are done.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};

use indicatif::MultiProgress;

use crate::complain::say;
use crate::interrupt;

/// Where reports go. What the first unfinished recording says is passed on at once; what later ones say waits for its turn.
pub struct Sink {
    state: Mutex<State>,
    between: &'static str,
    bars: MultiProgress,
}

#[derive(Default)]
struct State {
    /// The first recording that is not done.
    turn: usize,
    waiting: BTreeMap<usize, Vec<Chunk>>,
    done: BTreeSet<usize>,
    /// Whether a part has been written.
    begun: bool,
    /// The notes that were said: several recordings often deserve the same.
    said: BTreeSet<String>,
    /// Whether nobody reads what is written.
    closed: bool,
}

/// Something that a recording says.
#[derive(Clone, Debug)]
pub enum Chunk {
    /// A part of the document, on stdout.
    Part(String),
    /// A note, on stderr.
    Note(String),
}

impl Sink {
    /// A document with `between` between two parts; bars that may be on the screen are moved out of the way.
    pub fn new(between: &'static str, bars: MultiProgress) -> Sink {
        Sink { state: Mutex::default(), between, bars }
    }

    /// What frames the document: said when no recording is being read.
    pub fn frame(&self, text: &str) {
        let mut state = self.lock();
        self.out(&mut state, text);
    }

    /// The recording of that number says something.
    pub fn tell(&self, number: usize, chunk: Chunk) {
        let mut state = self.lock();
        match state.turn == number {
            true => self.write(&mut state, chunk),
            false => state.waiting.entry(number).or_default().push(chunk),
        }
    }

    /// The recording of that number is done.
    pub fn done(&self, number: usize) {
        let mut state = self.lock();
        state.done.insert(number);
        while state.done.contains(&state.turn) {
            state.turn += 1;
            let turn = state.turn;
            for chunk in state.waiting.remove(&turn).unwrap_or_default() {
                self.write(&mut state, chunk);
            }
        }
    }

    fn write(&self, state: &mut State, chunk: Chunk) {
        match chunk {
            Chunk::Part(text) if text.is_empty() => {}
            Chunk::Part(text) => {
                if std::mem::replace(&mut state.begun, true) {
                    self.out(state, self.between);
                }
                self.out(state, &text);
            }
            Chunk::Note(text) => {
                if state.said.insert(text.clone()) {
                    self.bars.suspend(|| say(&text));
                }
            }
        }
    }

    /// Writes to stdout. Where nobody reads any more, as behind `head`, nothing more is written or read.
    fn out(&self, state: &mut State, text: &str) {
        if state.closed || text.is_empty() {
            return;
        }
        let written = self.bars.suspend(|| {
            let mut stdout = io::stdout().lock();
            stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush())
        });
        if let Err(error) = written {
            state.closed = true;
            interrupt::stop();
            if error.kind() != io::ErrorKind::BrokenPipe {
                say(&format!("error: the report cannot be written: {error}\n"));
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
