//! Who looks on while a recording is read: what happens goes out at once where a program reads it, and an interrupt ends the reading.

use indicatif::ProgressBar;
use lapwing::Watch;
use lapwing_react::{Event, Format, line};

use crate::interrupt;
use crate::sink::{Chunk, Sink};

/// Looks on while a recording is read.
#[derive(Default)]
pub struct Onlooker<'w> {
    /// Where what happens goes, where it is told at once.
    pub told: Option<Told<'w>>,
    /// Shows how far it is.
    pub bar: Option<&'w ProgressBar>,
}

/// Where what happens goes.
pub struct Told<'w> {
    /// What the recording is called.
    pub trace: &'w str,
    /// Its number.
    pub number: usize,
    /// Where its report goes.
    pub sink: &'w Sink,
}

impl<'w> Told<'w> {
    /// Only this format tells what happens at once.
    pub fn by(format: Format, trace: &'w str, number: usize, sink: &'w Sink) -> Option<Told<'w>> {
        (format == Format::Ndjson).then_some(Told { trace, number, sink })
    }
}

impl Watch for Onlooker<'_> {
    fn event(&mut self, event: Event<'_>) {
        if let Some(told) = &self.told {
            told.sink.tell(told.number, Chunk::Part(line(told.trace, event)));
        }
    }

    fn progress(&mut self, read: u64, of: u64) {
        let Some(bar) = self.bar else { return };
        if of > 0 {
            bar.set_length(of);
        }
        bar.set_position(read);
    }

    fn goes_on(&mut self) -> bool {
        !interrupt::is_stopped()
    }
}
