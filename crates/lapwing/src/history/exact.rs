//! Points that are kept as they are: those around something that failed, whatever becomes of the rest.

use std::collections::VecDeque;

use lapwing_stream::Time;

/// So many failures have all points around them.
const WINDOWS: usize = 10;

/// The points around failures.
#[derive(Clone, Debug)]
pub(super) struct Exact {
    /// So many before a failure and after it.
    length: usize,
    /// The latest, which are kept where something fails next.
    recent: VecDeque<(Time, f64)>,
    kept: Vec<(Time, f64)>,
    /// How many are still to be kept.
    wanted: usize,
    windows: usize,
}

impl Exact {
    /// Keeps so many points before a failure, and as many after.
    pub fn new(length: usize) -> Exact {
        Exact { length, recent: VecDeque::new(), kept: Vec::new(), wanted: 0, windows: 0 }
    }

    /// Another point.
    pub fn push(&mut self, point: (Time, f64)) {
        if self.wanted > 0 {
            self.wanted -= 1;
            self.kept.push(point);
        } else if self.windows < WINDOWS && self.length > 0 {
            if self.recent.len() == self.length {
                self.recent.pop_front();
            }
            self.recent.push_back(point);
        }
    }

    /// Something fails now.
    pub fn keep(&mut self) {
        if self.windows < WINDOWS {
            self.windows += 1;
            self.kept.extend(self.recent.drain(..));
            self.wanted = self.length;
        }
    }

    /// The points that were kept, in the order of time.
    pub fn points(&self) -> &[(Time, f64)] {
        &self.kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_around_a_failure_is_kept() {
        let mut exact = Exact::new(3);
        for t in 0..100 {
            if t == 50 {
                exact.keep();
            }
            exact.push((Time(t), t as f64));
        }
        let kept: Vec<i64> = exact.points().iter().map(|(t, _)| t.0).collect();
        assert_eq!(kept, [47, 48, 49, 50, 51, 52]);
    }

    #[test]
    fn where_nothing_is_to_be_kept_nothing_is() {
        let mut exact = Exact::new(0);
        (0..100).for_each(|t| exact.push((Time(t), 0.0)));
        exact.keep();
        assert!(exact.points().is_empty() && exact.recent.is_empty());
    }

    #[test]
    fn a_failure_after_the_other_does_not_fill_the_memory() {
        let mut exact = Exact::new(3);
        for t in 0..100_000 {
            exact.keep();
            exact.push((Time(t), 0.0));
            (0..9).for_each(|_| exact.push((Time(t), 0.0)));
        }
        assert!(exact.points().len() <= 2 * 3 * WINDOWS, "{} points", exact.points().len());
    }
}
