//! The values that a call site gives, taken without allocating: texts go into buffers that are used again.

use std::cell::Cell;
use std::fmt::{self, Write};

use lapwing_stream::Value;
use tracing::field::{Field, Visit};

use crate::literal::{self, Literal};
use crate::site::Site;

/// So much of a text is kept, in bytes: what a monitor compares is short, and a `Debug` may be an image.
const LONGEST: usize = 4096;

/// So many buffers wait for texts to come.
const MOST_SPARE: usize = 64;

/// A thread's own room for the values of one call site.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    values: Vec<Value>,
    spare: Vec<String>,
}

thread_local! {
    static SCRATCH: Cell<Option<Box<Scratch>>> = const { Cell::new(None) };
}

impl Scratch {
    /// Lends the thread's room, with so many values in it that are all missing. Whoever asks while it is lent gets another.
    pub fn with<T>(width: usize, work: impl FnOnce(&mut Scratch) -> T) -> T {
        let mut scratch = SCRATCH.try_with(Cell::take).ok().flatten().unwrap_or_default();
        scratch.clear(width);
        let result = work(&mut scratch);
        // A thread that is ending has no more room to give back to.
        let _ = SCRATCH.try_with(|cell| cell.set(Some(scratch)));
        result
    }

    fn clear(&mut self, width: usize) {
        for value in self.values.iter_mut() {
            if let Value::Str(text) = std::mem::take(value)
                && self.spare.len() < MOST_SPARE
            {
                self.spare.push(text);
            }
        }
        if self.values.len() < width {
            self.values.resize_with(width, Value::default);
        }
    }

    /// The values.
    pub fn values(&self) -> &[Value] {
        &self.values
    }

    /// Sets a value from elsewhere, where there is none.
    pub fn fill(&mut self, slot: usize, value: &Value) {
        match value {
            _ if !matches!(self.values.get(slot), Some(Value::Missing)) => {}
            Value::Str(text) => self.put_text(slot, text),
            other => self.put(slot, other.clone()),
        }
    }

    /// Copies a value from one place to another.
    pub fn copy(&mut self, from: usize, to: usize) {
        match self.values.get(from) {
            Some(Value::Str(text)) => {
                let mut buffer = self.spare.pop().unwrap_or_default();
                buffer.clone_from(text);
                self.put(to, Value::Str(buffer));
            }
            Some(other) => self.put(to, other.clone()),
            None => {}
        }
    }

    pub fn put(&mut self, slot: usize, value: Value) {
        if let Some(to) = self.values.get_mut(slot) {
            *to = value;
        }
    }

    pub fn put_text(&mut self, slot: usize, text: &str) {
        let mut buffer = self.buffer();
        buffer.push_str(cut(text));
        self.put(slot, Value::Str(buffer));
    }

    /// A text that is read as the literal that it looks like.
    pub fn put_literal(&mut self, slots: &[usize], text: &str) {
        let read = literal::read(text);
        for &slot in slots {
            match read {
                Literal::Bool(b) => self.put(slot, Value::Bool(b)),
                Literal::Num(x) => self.put(slot, Value::Num(x)),
                Literal::Plain(text) => self.put_text(slot, text),
                Literal::Escaped(text) => {
                    let mut buffer = self.buffer();
                    literal::unescape(text, &mut buffer);
                    self.put(slot, Value::Str(buffer));
                }
            }
        }
    }

    /// What writes itself, as text that is read as a literal.
    pub fn put_written(&mut self, slots: &[usize], written: fmt::Arguments<'_>) {
        if slots.is_empty() {
            return;
        }
        let mut text = Bounded(self.buffer());
        // What is too long is cut: that is all that can go wrong here.
        let _ = text.write_fmt(written);
        self.put_literal(slots, &text.0);
        self.spare.push(text.0);
    }

    fn buffer(&mut self) -> String {
        let mut buffer = self.spare.pop().unwrap_or_default();
        buffer.clear();
        buffer
    }
}

/// A text that takes no more than it may.
struct Bounded(String);

impl Write for Bounded {
    fn write_str(&mut self, s: &str) -> fmt::Result {
        let room = LONGEST.saturating_sub(self.0.len());
        let end = (0..=s.len().min(room)).rev().find(|&end| s.is_char_boundary(end)).unwrap_or(0);
        self.0.push_str(&s[..end]);
        if end < s.len() { Err(fmt::Error) } else { Ok(()) }
    }
}

fn cut(text: &str) -> &str {
    let end = (0..=text.len().min(LONGEST)).rev().find(|&end| text.is_char_boundary(end)).unwrap_or(0);
    &text[..end]
}

/// Takes the values of a call site's fields.
pub(crate) struct Take<'a> {
    pub site: &'a Site,
    pub into: &'a mut Scratch,
}

impl Take<'_> {
    fn put(&mut self, field: &Field, value: Value) {
        for &slot in self.site.routes.get(field.index()).into_iter().flatten() {
            self.into.put(slot, value.clone());
        }
    }
}

impl Visit for Take<'_> {
    fn record_f64(&mut self, field: &Field, value: f64) {
        self.put(field, Value::Num(value));
    }

    fn record_i64(&mut self, field: &Field, value: i64) {
        self.put(field, Value::Num(value as f64));
    }

    fn record_u64(&mut self, field: &Field, value: u64) {
        self.put(field, Value::Num(value as f64));
    }

    fn record_i128(&mut self, field: &Field, value: i128) {
        self.put(field, Value::Num(value as f64));
    }

    fn record_u128(&mut self, field: &Field, value: u128) {
        self.put(field, Value::Num(value as f64));
    }

    fn record_bool(&mut self, field: &Field, value: bool) {
        self.put(field, Value::Bool(value));
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        for &slot in self.site.routes.get(field.index()).into_iter().flatten() {
            self.into.put_text(slot, value);
        }
    }

    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        if let Some(slots) = self.site.routes.get(field.index()) {
            self.into.put_written(slots, format_args!("{value:?}"));
        }
    }
}

/// Takes what a function returned, of the event that `#[instrument(ret, err)]` makes of it.
pub(crate) struct TakeReturn<'a> {
    pub into: &'a mut Scratch,
}

/// Where the result and the error of a return go.
pub(crate) const RESULT: usize = 0;
pub(crate) const ERROR: usize = 1;

impl Visit for TakeReturn<'_> {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        match field.name() {
            "return" => self.into.put_written(&[RESULT], format_args!("{value:?}")),
            "error" => self.into.put_written(&[ERROR], format_args!("{value:?}")),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_cut_and_their_buffers_used_again() {
        Scratch::with(2, |scratch| {
            scratch.put_written(&[0, 1], format_args!("{:?}", "é".repeat(LONGEST)));
            let Value::Str(text) = &scratch.values()[0] else { return assert_eq!(scratch.values()[0], Value::Missing) };
            assert!(text.len() <= LONGEST && text.starts_with("\"é"));
            scratch.put_written(&[1], format_args!("{}", 0.5));
            assert_eq!(scratch.values()[1], Value::Num(0.5));
        });
        Scratch::with(2, |scratch| {
            assert_eq!(scratch.values(), [Value::Missing, Value::Missing]);
            assert!(!scratch.spare.is_empty());
            scratch.fill(0, &Value::from("north"));
            scratch.fill(0, &Value::from("south"));
            assert_eq!(scratch.values()[0], Value::from("north"));
        });
    }

    #[test]
    fn whoever_asks_while_the_room_is_lent_gets_another() {
        Scratch::with(1, |outer| {
            outer.put(0, Value::Num(1.0));
            Scratch::with(1, |inner| assert_eq!(inner.values()[0], Value::Missing));
            assert_eq!(outer.values()[0], Value::Num(1.0));
        });
    }
}
