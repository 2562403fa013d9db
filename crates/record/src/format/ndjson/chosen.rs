//! Rows of which only some values are wanted.

use std::borrow::Cow;
use std::mem::replace;

use lapwing_stream::{Name, Time, Value};

use super::form::Form;
use super::others::Others;
use crate::cells::Cells;
use crate::decode::{DecodeError, json_value, scan::Kind, scan::Scanner};
use crate::format::signals::{Key, Signals};
use crate::path::Path;

/// At most so many forms of lines are learnt. Lines that never look alike are not worth more.
const FORMS: usize = 16;
/// After so many lines of which nothing new was learnt, learning ends: it takes longer than reading.
const FRUITLESS: usize = 1024;

/// The wanted values of the latest row.
#[derive(Debug)]
pub(super) struct Chosen {
    signals: Signals,
    values: Vec<Value>,
    /// How long the key was that brought each value of the current row, where one did.
    brought: Vec<Option<usize>>,
    /// Which keys the current row has had.
    met: Vec<bool>,
    /// A value of which parts are wanted.
    whole: Value,
    /// What rows have that nobody wants.
    others: Others,
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
        Chosen {
            values: signals.blank(),
            brought: vec![None; names.len()],
            met: vec![false; signals.keys()],
            whole: Value::Missing,
            others: Others::default(),
            signals,
            forms: Vec::new(),
            form: 0,
            fruitless: 0,
        }
    }

    /// What rows have that nobody wants, as far as it was noticed.
    pub fn others(&self) -> &Others {
        &self.others
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

    /// Takes in the next object. Of two values of one name the first counts; a signal comes from the longest name that leads to it.
    pub fn fill(&mut self, scanner: &mut Scanner<'_>, elements: usize) -> Result<(), DecodeError> {
        let mut budget = elements;
        let mut first = true;
        self.brought.fill(None);
        self.met.fill(false);
        scanner.open(b'{')?;
        while scanner.more(b'}', &mut first)? {
            let key = scanner.key()?;
            let Chosen { signals, values, brought, met, whole, others, .. } = self;
            match signals.wanted(&key) {
                Some(wanted) if !replace(&mut met[wanted.number], true) => {
                    let mut into = Into { values, brought, whole, length: key.len() };
                    if into.take(wanted, scanner, &mut budget)? {
                        others.note(&key, whole);
                    }
                }
                Some(_) => scanner.skip()?,
                None => others.pass(&key, scanner)?,
            }
        }
        self.others.end();
        for (value, _) in self.values.iter_mut().zip(&self.brought).filter(|(_, brought)| brought.is_none()) {
            *value = Value::Missing;
        }
        self.signals.copy(&mut self.values);
        Ok(())
    }

    /// Learns the form of a line that was just taken in, unless it is known: a line that a buffer cuts in two goes the general way too.
    pub fn learn(&mut self, line: &[u8]) {
        if self.forms.len() >= FORMS || self.fruitless >= FRUITLESS {
            return;
        }
        let mut seen = vec![false; self.values.len()];
        let slot = |name: &str| self.signals.slot(name).filter(|slot| !replace(&mut seen[*slot], true));
        match Form::learn(line, slot) {
            Some(form) if self.forms.iter().all(|(known, _)| *known != form) => {
                let absent = (0..seen.len()).filter(|slot| !seen[*slot]).collect();
                self.forms.push((form, absent));
                self.form = self.forms.len() - 1;
            }
            _ => self.fruitless += 1,
        }
    }
}

/// Where what the current row brings goes.
struct Into<'c> {
    values: &'c mut [Value],
    brought: &'c mut [Option<usize>],
    whole: &'c mut Value,
    /// How long the key is whose value is taken in.
    length: usize,
}

impl Into<'_> {
    /// Takes in the value of a key; its parts give way to what a longer key brings. Gives whether it has parts that are wanted: it is in
    /// `whole` then.
    fn take(&mut self, key: &Key, scanner: &mut Scanner<'_>, budget: &mut usize) -> Result<bool, DecodeError> {
        let has_parts = !key.inside.is_empty() && matches!(scanner.kind()?, Kind::Array | Kind::Object);
        match key.whole {
            _ if has_parts => json_value(scanner, budget, self.whole)?,
            None => scanner.skip()?,
            Some(slot) => {
                json_value(scanner, budget, &mut self.values[slot])?;
                self.brought[slot] = Some(self.length);
            }
        }
        if has_parts {
            let itself = key.whole.map(|slot| (None, slot));
            let parts = key.inside.iter().map(|(way, slot)| (Some(way), *slot));
            itself.into_iter().chain(parts).for_each(|(way, slot)| self.put(slot, way));
        }
        Ok(has_parts)
    }

    /// Puts the whole value, or what a way selects of it, where it goes.
    fn put(&mut self, slot: usize, way: Option<&Path>) {
        let Some(found) = way.map_or(Some(Cow::Borrowed(&*self.whole)), |way| way.find_in(self.whole)) else { return };
        if self.brought[slot].is_none_or(|by| by < self.length) {
            self.values[slot].clone_from(&found);
            self.brought[slot] = Some(self.length);
        }
    }
}
