//! Which of many instances has the next deadline: a tree of least values, so that neither asking nor changing one visits the others.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

/// A deadline that there is not.
const NONE: i64 = i64::MAX;

/// A time for each number, or none. It takes no memory until there is one.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Earliest {
    /// A complete binary tree in the order of its levels, the root at 1: in each node the least of those below. The leaves are the second half.
    tree: Vec<i64>,
}

impl Earliest {
    /// A number's time.
    pub fn of(&self, number: usize) -> Option<i64> {
        self.tree.get(self.leaves() + number).copied().filter(|&at| number < self.leaves() && at != NONE)
    }

    /// The least of all times.
    pub fn least(&self) -> Option<i64> {
        self.tree.get(1).copied().filter(|&at| at != NONE)
    }

    /// The least number from `from` on whose time is not later than `until`.
    pub fn next_until(&self, from: usize, until: i64) -> Option<usize> {
        let leaves = self.leaves();
        let is_due = |node: usize| self.tree.get(node).is_some_and(|&at| at != NONE && at <= until);
        if from >= leaves {
            return None;
        }
        // Up, until something to the right of the way is due; then down again, to the left as long as that is.
        let mut node = leaves + from;
        while !is_due(node) {
            while node % 2 == 1 {
                node /= 2;
            }
            if node == 0 {
                return None;
            }
            node += 1;
        }
        while node < leaves {
            node = 2 * node + usize::from(!is_due(2 * node));
        }
        Some(node - leaves)
    }

    /// A number's time is another. The end of time itself comes a nanosecond early.
    #[inline]
    pub fn set(&mut self, number: usize, at: Option<i64>) {
        let at = at.map_or(NONE, |at| at.min(NONE - 1));
        if number >= self.leaves() {
            if at == NONE {
                return;
            }
            self.grow(number);
        }
        let mut node = self.leaves() + number;
        if self.tree[node] == at {
            return;
        }
        self.tree[node] = at;
        while node > 1 {
            node /= 2;
            let least = self.tree[2 * node].min(self.tree[2 * node + 1]);
            if self.tree[node] == least {
                return;
            }
            self.tree[node] = least;
        }
    }

    fn leaves(&self) -> usize {
        self.tree.len() / 2
    }

    fn grow(&mut self, number: usize) {
        let (old, leaves) = (self.leaves(), (number + 1).next_power_of_two());
        let mut tree = alloc::vec![NONE; 2 * leaves];
        tree[leaves..leaves + old].copy_from_slice(&self.tree[old..]);
        for node in (1..leaves).rev() {
            tree[node] = tree[2 * node].min(tree[2 * node + 1]);
        }
        self.tree = tree;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_and_all_that_are_due_in_their_order() {
        let mut times = Earliest::default();
        assert_eq!((times.least(), times.next_until(0, i64::MAX)), (None, None));
        let mut plain: Vec<Option<i64>> = alloc::vec![None; 40];
        let mut chance = 1_u64;
        for _ in 0..2000 {
            chance = chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let (number, at) = ((chance >> 33) as usize % 40, Some((chance >> 50) as i64 % 9).filter(|&at| at > 0));
            plain[number] = at;
            times.set(number, at);
            assert_eq!(times.least(), plain.iter().copied().flatten().min());
            for until in [0, 3, 8] {
                let mut found = Vec::new();
                let mut from = 0;
                while let Some(number) = times.next_until(from, until) {
                    found.push(number);
                    from = number + 1;
                }
                let due = (0..40).filter(|&n| plain[n].is_some_and(|at| at <= until));
                assert_eq!(found, due.collect::<Vec<_>>());
            }
        }
    }
}
