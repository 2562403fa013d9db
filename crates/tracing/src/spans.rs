//! The open spans that matter, with what they hand on to whatever happens inside them.
//!
//! The registry of `tracing-subscriber` keeps spans too, but what a layer stores with one of its spans is boxed anew each time. These
//! notes are used again, so that a span that was warmed up allocates nothing here.

use std::collections::HashMap;
use std::hash::BuildHasherDefault;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use lapwing_stream::Value;

use crate::site::Site;
use crate::sites::ByAddress;

/// Threads that work in different spans seldom wait for each other.
const SHARDS: usize = 16;

/// So many notes of closed spans wait to be used again, in each shard.
const MOST_SPARE: usize = 64;

/// The open spans that matter.
#[derive(Debug, Default)]
pub(crate) struct Spans {
    shards: [Mutex<Shard>; SHARDS],
}

#[derive(Debug, Default)]
struct Shard {
    notes: HashMap<u64, Note, BuildHasherDefault<ByAddress>>,
    spare: Vec<Note>,
}

/// What is known of a span.
#[derive(Clone, Debug, Default)]
pub(crate) struct Note {
    /// Its call site.
    pub site: Option<Arc<Site>>,
    /// The functions, of those that events are to be below, that are active around it.
    pub around: u64,
    /// The same for what happens inside it.
    pub inside: u64,
    /// The fields that events may read, its own before those of the spans around it: those whose bit is set, the rest are buffers.
    carried: Vec<Value>,
    has: u64,
    /// Whether its return was recorded.
    pub has_returned: bool,
    /// Whether its thread was panicking already when it began: it clears up, and ends as any other.
    clears_up: bool,
    /// Whether a panic has left it.
    pub has_panicked: bool,
}

impl Note {
    /// Nothing is around.
    fn clear(&mut self, carries: usize) {
        (self.site, self.around, self.inside, self.has) = (None, 0, 0, 0);
        (self.has_returned, self.has_panicked, self.clears_up) = (false, false, std::thread::panicking());
        self.carried.resize_with(carries, Value::default);
    }

    /// It is inside another.
    fn enter(&mut self, outer: &Note) {
        self.around = outer.inside;
        (0..outer.carried.len()).for_each(|number| self.set(number, outer.field(number)));
    }

    /// Its own fields come before those around it.
    pub fn take(&mut self, own: &[Value]) {
        own.iter().enumerate().for_each(|(number, value)| self.set(number, value));
    }

    /// Whether it is a panic that ends it, where it ends now on this thread.
    pub fn ends_by_panic(&self) -> bool {
        self.has_panicked || (!self.clears_up && std::thread::panicking())
    }

    fn set(&mut self, number: usize, value: &Value) {
        if let Some(to) = self.carried.get_mut(number).filter(|_| !matches!(value, Value::Missing)) {
            to.clone_from(value);
            self.has |= 1 << number;
        }
    }

    /// A field that it carries, by its number.
    pub fn field(&self, number: usize) -> &Value {
        let value = self.carried.get(number).filter(|_| self.has & (1 << number) != 0);
        value.unwrap_or(&Value::Missing)
    }
}

impl Spans {
    /// A span begins inside the first of these that is known. `fill` sees the note before anyone else does.
    pub fn begin(&self, id: u64, carries: usize, outer: impl Iterator<Item = u64>, fill: impl FnOnce(&mut Note)) {
        let mut note = self.shard(id).spare.pop().unwrap_or_default();
        note.clear(carries);
        self.first(outer, |outer| note.enter(outer));
        fill(&mut note);
        self.shard(id).notes.insert(id, note);
    }

    /// Looks at the first of these spans that is known.
    pub fn first<T>(&self, mut ids: impl Iterator<Item = u64>, look: impl FnOnce(&Note) -> T) -> Option<T> {
        let mut look = Some(look);
        ids.find_map(|id| {
            let shard = self.shard(id);
            let note = shard.notes.get(&id)?;
            look.take().map(|look| look(note))
        })
    }

    /// Changes what is known of a span.
    pub fn change<T>(&self, id: u64, change: impl FnOnce(&mut Note) -> T) -> Option<T> {
        self.shard(id).notes.get_mut(&id).map(change)
    }

    /// A span is over: what was known of it, to be [recycled](Spans::recycle).
    pub fn end(&self, id: u64) -> Option<Note> {
        self.shard(id).notes.remove(&id)
    }

    /// The buffers of a note serve a later span.
    pub fn recycle(&self, id: u64, note: Note) {
        let mut shard = self.shard(id);
        if shard.spare.len() < MOST_SPARE {
            shard.spare.push(note);
        }
    }

    fn shard(&self, id: u64) -> MutexGuard<'_, Shard> {
        let shard = &self.shards[id as usize % SHARDS];
        shard.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_hands_on_what_it_has_and_what_is_around_it() {
        let spans = Spans::default();
        spans.begin(1, 2, std::iter::empty(), |note| {
            note.take(&[Value::from("r1"), Value::from(1.0)]);
            note.inside = 0b1;
        });
        spans.begin(2, 2, [7, 1].into_iter(), |note| {
            note.take(&[Value::Missing, Value::from(2.0)]);
            note.inside = note.around | 0b10;
        });
        spans.first([2].into_iter(), |note| {
            assert_eq!((note.around, note.inside), (0b1, 0b11));
            assert_eq!([note.field(0), note.field(1)], [&Value::from("r1"), &Value::from(2.0)]);
        });
        let note = spans.end(2).unwrap_or_default();
        spans.recycle(2, note);
        spans.begin(2, 2, std::iter::empty(), |note| assert_eq!(note.field(0), &Value::Missing));
        assert!(spans.end(9).is_none());
    }
}
