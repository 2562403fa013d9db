//! All values of an object, by name.

use std::collections::BTreeMap;

use lapwing_stream::{Name, Value};

use crate::cells::Cells;
use crate::decode::{DecodeError, json_value, scan::Scanner};
use crate::options::Limits;

/// All values of the latest object. Names and buffers are used again.
#[derive(Debug, Default)]
pub(super) struct Named {
    names: Vec<Name>,
    values: Vec<Value>,
    /// The names met so far.
    known: BTreeMap<String, Name>,
}

impl Named {
    /// Those of the latest object.
    pub fn cells(&self) -> Cells<'_> {
        Cells::new(&self.names, &self.values)
    }

    /// Takes in the next object, but of it only the names that are wanted.
    pub fn fill(
        &mut self,
        scanner: &mut Scanner<'_>,
        limits: &Limits,
        wanted: impl Fn(&str) -> bool,
    ) -> Result<(), DecodeError> {
        let mut budget = limits.elements;
        let (mut first, mut count) = (true, 0);
        scanner.open(b'{')?;
        while scanner.more(b'}', &mut first)? {
            let key = scanner.key()?;
            if !wanted(&key) {
                scanner.skip()?;
                continue;
            }
            let value = self.place(count, &key, limits.names)?;
            json_value(scanner, &mut budget, value)?;
            count += 1;
        }
        self.names.truncate(count);
        self.values.truncate(count);
        Ok(())
    }

    /// The value of that number, which gets that name.
    fn place(&mut self, at: usize, key: &str, most: usize) -> Result<&mut Value, DecodeError> {
        if self.names.get(at).is_none_or(|name| **name != *key) {
            let name = match self.known.get(key) {
                Some(name) => name.clone(),
                None if self.known.len() >= most => {
                    return Err(DecodeError::new("there are more names than Limits::names allows"));
                }
                None => self.known.entry(key.to_owned()).or_insert_with(|| Name::from(key)).clone(),
            };
            match self.names.get_mut(at) {
                Some(old) => *old = name,
                None => self.names.push(name),
            }
        }
        if self.values.len() <= at {
            self.values.resize_with(at + 1, Value::default);
        }
        Ok(&mut self.values[at])
    }
}
