//! Rows of which only some values are wanted.

use lapwing_stream::{Name, Time, Value};

use super::form::Form;
use crate::cells::Cells;
use crate::decode::{DecodeError, json_value, scan::Scanner};
use crate::format::signals::Signals;

/// At most so many forms of lines are learnt. Lines that never look alike are not worth more.
const FORMS: usize = 16;
/// After so many lines of which nothing new was learnt, learning ends: it takes longer than reading.
const FRUITLESS: usize = 1024;

/// The wanted values of the latest row.
#[derive(Debug)]
pub(super) struct Chosen {
    signals: Signals,
    values: Vec<Value>,
    /// Which values the current row has brought.
    seen: Vec<bool>,
    /// The forms of lines met so far, each with the values that it does not bring.
    forms: Vec<(Form, Vec<usize>)>,
    /// The one that the last line had.
    form: usize,
    /// From how many lines nothing new was learnt.
    fruitless: usize,
}

impl Chosen {
    pub fn new(names: &[Name]) -> Chosen {
        let signals = Signals::new(names);
        let seen = vec![false; names.len()];
        Chosen { values: signals.blank(), signals, seen, forms: Vec::new(), form: 0, fruitless: 0 }
    }

    /// Those of the latest row.
    pub fn cells(&self) -> Cells<'_> {
        Cells::new(self.signals.names(), &self.values)
    }

    /// Takes in the line that a text begins with, where it has a known form. Gives its time and its length with its end.
    #[inline]
    pub fn quick(&mut self, text: &[u8]) -> Option<(Time, usize)> {
        let count = self.forms.len();
        for form in (self.form..count).chain(0..self.form) {
            let (known, absent) = &self.forms[form];
            if let Some(read) = known.read(text, &mut self.values) {
                absent.iter().for_each(|&slot| self.values[slot] = Value::Missing);
                self.signals.copy(&mut self.values);
                self.form = form;
                return Some(read);
            }
        }
        None
    }

    /// Takes in the next object. Of two values of one name the first counts.
    pub fn fill(&mut self, scanner: &mut Scanner<'_>, elements: usize) -> Result<(), DecodeError> {
        let mut budget = elements;
        let mut first = true;
        self.seen.fill(false);
        scanner.open(b'{')?;
        while scanner.more(b'}', &mut first)? {
            match self.signals.slot(&scanner.key()?) {
                Some(slot) if !self.seen[slot] => {
                    json_value(scanner, &mut budget, &mut self.values[slot])?;
                    self.seen[slot] = true;
                }
                _ => scanner.skip()?,
            }
        }
        self.blank_unseen();
        self.signals.copy(&mut self.values);
        Ok(())
    }

    fn blank_unseen(&mut self) {
        for (value, _) in self.values.iter_mut().zip(&self.seen).filter(|(_, seen)| !**seen) {
            *value = Value::Missing;
        }
    }

    /// Learns the form of a line that was just taken in, unless it is known: a line that a buffer cuts in two goes the general way too.
    pub fn learn(&mut self, line: &[u8]) {
        if self.forms.len() >= FORMS || self.fruitless >= FRUITLESS {
            return;
        }
        self.seen.fill(false);
        let (signals, seen) = (&self.signals, &mut self.seen);
        let slot = |name: &str| signals.slot(name).filter(|slot| !std::mem::replace(&mut seen[*slot], true));
        match Form::learn(line, slot) {
            Some(form) if self.forms.iter().all(|(known, _)| *known != form) => {
                let absent = (0..self.seen.len()).filter(|slot| !self.seen[*slot]).collect();
                self.forms.push((form, absent));
                self.form = self.forms.len() - 1;
            }
            _ => self.fruitless += 1,
        }
    }
}
