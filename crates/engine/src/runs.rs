//! Sets of positions as runs: what is open, kept as few numbers as its shape has.

use alloc::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::pack::packed;
use crate::times::Pos;

/// A set of positions, as runs `(first, last)` in increasing order with gaps between them.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Runs {
    runs: VecDeque<(Pos, Pos)>,
}

packed!(Runs { runs });

impl Runs {
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// The number of runs.
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    /// The number of positions.
    pub fn positions(&self) -> u64 {
        self.runs.iter().map(|(a, b)| b - a + 1).sum()
    }

    pub fn first(&self) -> Option<Pos> {
        self.runs.front().map(|r| r.0)
    }

    pub fn last(&self) -> Option<Pos> {
        self.runs.back().map(|r| r.1)
    }

    pub fn clear(&mut self) {
        self.runs.clear();
    }

    /// Adds a position after all that are in the set.
    pub fn push(&mut self, pos: Pos) {
        match self.runs.back_mut() {
            Some((_, last)) if *last + 1 == pos => *last = pos,
            _ => self.runs.push_back((pos, pos)),
        }
    }

    /// Adds positions anywhere; none of them is in the set.
    pub fn insert(&mut self, from: Pos, to: Pos) {
        let i = self.runs.partition_point(|r| r.1 < from);
        let joins_left = i > 0 && self.runs[i - 1].1 + 1 == from;
        let joins_right = self.runs.get(i).is_some_and(|r| r.0 == to + 1);
        match (joins_left, joins_right) {
            (true, true) => {
                self.runs[i - 1].1 = self.runs[i].1;
                self.runs.remove(i);
            }
            (true, false) => self.runs[i - 1].1 = to,
            (false, true) => self.runs[i].0 = from,
            (false, false) => self.runs.insert(i, (from, to)),
        }
    }

    /// Hands over all runs, in order, and is empty after.
    pub fn drain(&mut self, mut taken: impl FnMut(Pos, Pos)) {
        self.runs.drain(..).for_each(|(a, b)| taken(a, b));
    }

    /// The least position at or after `from`.
    pub fn at_or_after(&self, from: Pos) -> Option<Pos> {
        let i = self.runs.partition_point(|r| r.1 < from);
        self.runs.get(i).map(|r| r.0.max(from))
    }

    /// The first run that reaches `from` or lies after it.
    pub fn run_at_or_after(&self, from: Pos) -> Option<(Pos, Pos)> {
        self.runs.get(self.runs.partition_point(|r| r.1 < from)).copied()
    }

    /// Whether one of `from..=to` is in the set.
    pub fn meets(&self, from: Pos, to: Pos) -> bool {
        self.at_or_after(from).is_some_and(|p| p <= to)
    }

    /// Takes `from..=to` out of the set and hands over, in order, the runs that were in it.
    pub fn take(&mut self, from: Pos, to: Pos, mut taken: impl FnMut(Pos, Pos)) {
        if from > to {
            return;
        }
        let mut i = self.runs.partition_point(|r| r.1 < from);
        while let Some(&(a, b)) = self.runs.get(i) {
            if a > to {
                return;
            }
            let (lo, hi) = (a.max(from), b.min(to));
            taken(lo, hi);
            match (a < lo, hi < b) {
                (false, false) => {
                    self.runs.remove(i);
                }
                (true, false) => {
                    self.runs[i].1 = lo - 1;
                    i += 1;
                }
                (false, true) => {
                    self.runs[i].0 = hi + 1;
                    return;
                }
                (true, true) => {
                    self.runs[i].1 = lo - 1;
                    self.runs.insert(i + 1, (hi + 1, b));
                    return;
                }
            }
        }
    }

    /// The runs, in order.
    pub fn iter(&self) -> impl Iterator<Item = (Pos, Pos)> + '_ {
        self.runs.iter().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    fn runs(of: &[Pos]) -> Runs {
        let mut r = Runs::default();
        of.iter().for_each(|&p| r.push(p));
        r
    }

    #[test]
    fn neighbours_join() {
        assert_eq!(runs(&[1, 2, 3, 7, 8]).iter().collect::<Vec<_>>(), [(1, 3), (7, 8)]);
    }

    #[test]
    fn taking_splits_and_reports() {
        let mut r = runs(&[1, 2, 3, 4, 5, 8, 9]);
        let mut got = Vec::new();
        r.take(3, 8, |a, b| got.push((a, b)));
        assert_eq!(got, [(3, 5), (8, 8)]);
        assert_eq!(r.iter().collect::<Vec<_>>(), [(1, 2), (9, 9)]);
        r = runs(&[1, 2, 3, 4, 5]);
        r.take(2, 3, |_, _| ());
        assert_eq!(r.iter().collect::<Vec<_>>(), [(1, 1), (4, 5)]);
        assert_eq!((r.at_or_after(2), r.at_or_after(6), r.meets(2, 3), r.meets(0, 1)), (Some(4), None, false, true));
    }
}
