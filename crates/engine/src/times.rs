//! The stamps of positions.

use alloc::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::pack::packed;

/// A position of a property: 0, 1, 2, …
pub(crate) type Pos = u64;

/// How many stamps are kept at most: beyond, the oldest go, and what began there is told as begun at the oldest stamp kept.
const KEPT: usize = 1 << 22;

/// The stamps of the positions from the oldest that something still asks for to the newest.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Times {
    first: Pos,
    stamps: VecDeque<i64>,
}

packed!(Times { first, stamps });

impl Times {
    /// Adds the stamp of the next position and returns its number.
    pub fn push(&mut self, stamp: i64) -> Pos {
        if self.stamps.len() == KEPT {
            self.stamps.pop_front();
            self.first += 1;
        }
        self.stamps.push_back(stamp);
        self.next() - 1
    }

    /// The number of the next position.
    pub fn next(&self) -> Pos {
        self.first + self.stamps.len() as u64
    }

    /// The stamp of a position; for one too old, the oldest that is kept.
    pub fn at(&self, pos: Pos) -> i64 {
        let i = pos.saturating_sub(self.first) as usize;
        self.stamps.get(i).or(self.stamps.back()).copied().unwrap_or(0)
    }

    /// The first position with a stamp of at least `stamp`.
    pub fn first_at_or_after(&self, stamp: i64) -> Pos {
        self.first + self.stamps.partition_point(|&t| t < stamp) as u64
    }

    /// The first position with a later stamp than `stamp`.
    pub fn first_after(&self, stamp: i64) -> Pos {
        self.first + self.stamps.partition_point(|&t| t <= stamp) as u64
    }

    /// Lets go of everything before `pos`.
    pub fn forget_before(&mut self, pos: Pos) {
        while self.first < pos && self.stamps.len() > 1 {
            self.stamps.pop_front();
            self.first += 1;
        }
    }

    /// The number of stamps kept.
    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.stamps.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_found_by_stamp() {
        let mut t = Times::default();
        [0, 10, 10, 20].into_iter().for_each(|s| {
            t.push(s);
        });
        assert_eq!((t.first_at_or_after(10), t.first_after(10), t.first_after(20)), (1, 3, 4));
        t.forget_before(2);
        assert_eq!((t.at(3), t.at(0), t.next(), t.len()), (20, 10, 4, 2));
    }
}
