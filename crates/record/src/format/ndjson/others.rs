//! The signals of rows that nobody wants: who asked for a name that never comes may have meant one of them.

use std::collections::BTreeSet;

use lapwing_stream::Value;

use crate::cells::fields;
use crate::decode::{DecodeError, json_value, scan::Kind, scan::Scanner};

/// So many names are remembered.
const MOST: usize = 4096;
/// After so many rows without a new name no more are looked for: it takes longer than passing over them.
const FRUITLESS: usize = 1024;
/// An object with more elements is remembered by its own name, not by those of its fields.
const ELEMENTS: usize = 1000;

/// Names of signals that nobody wants, as far as they were noticed. Of a row that is read the quick way nothing is: it looks like an earlier one.
#[derive(Debug, Default)]
pub(super) struct Others {
    names: BTreeSet<String>,
    /// Whether the current row has had a new one.
    is_new: bool,
    fruitless: usize,
    value: Value,
}

impl Others {
    /// Those noticed so far.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(String::as_str)
    }

    /// Passes over a value that nobody wants.
    pub fn pass(&mut self, key: &str, scanner: &mut Scanner<'_>) -> Result<(), DecodeError> {
        if self.fruitless < FRUITLESS {
            let mut value = std::mem::take(&mut self.value);
            // What is wrong with it is found below.
            let is_read = matches!(scanner.kind(), Ok(Kind::Object))
                && json_value(&mut scanner.clone(), &mut { ELEMENTS }, &mut value).is_ok();
            self.note(key, if is_read { &value } else { &Value::Missing });
            self.value = value;
        }
        scanner.skip()
    }

    /// A row has that value under that name.
    pub fn note(&mut self, key: &str, value: &Value) {
        if self.fruitless < FRUITLESS {
            fields(key, value, &mut |name, _| {
                if self.names.len() < MOST && !self.names.contains(name) {
                    self.is_new = self.names.insert(name.to_owned());
                }
            });
        }
    }

    /// The row is over.
    pub fn end(&mut self) {
        self.fruitless = if std::mem::take(&mut self.is_new) { 0 } else { self.fruitless.saturating_add(1) };
    }
}
