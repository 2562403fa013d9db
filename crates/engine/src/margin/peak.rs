//! The greatest value in a window that moves one way: what comes in outdoes what is smaller and leaves earlier.

use alloc::collections::VecDeque;

use serde::{Deserialize, Serialize};

/// The values that may still become the greatest, each with its place, the greatest and oldest first. NaN is skipped.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Peak {
    queue: VecDeque<(i64, f64)>,
}

impl Peak {
    /// A value comes into the window.
    pub fn push(&mut self, place: i64, value: f64) {
        if value.is_nan() {
            return;
        }
        while self.queue.back().is_some_and(|&(_, old)| old <= value) {
            self.queue.pop_back();
        }
        self.queue.push_back((place, value));
    }

    /// A value comes into a window that nothing ever leaves.
    pub fn raise(&mut self, value: f64) {
        if self.queue.front().is_none_or(|&(_, old)| old < value) {
            self.push(0, value);
        }
    }

    /// The oldest values leave the window.
    pub fn forget(&mut self, is_over: impl Fn(i64) -> bool) {
        while self.queue.front().is_some_and(|&(place, _)| is_over(place)) {
            self.queue.pop_front();
        }
    }

    /// The greatest value; NaN where there is none.
    pub fn greatest(&self) -> f64 {
        self.queue.front().map_or(f64::NAN, |&(_, value)| value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_of_a_moving_window() {
        let values = [3.0, 1.0, f64::NAN, 2.0, 2.0, 0.0, 5.0];
        let mut peak = Peak::default();
        let seen = values.iter().enumerate().map(|(i, &value)| {
            peak.push(i as i64, value);
            peak.forget(|place| place + 2 < i as i64);
            peak.greatest()
        });
        assert_eq!(seen.collect::<alloc::vec::Vec<_>>(), [3.0, 3.0, 3.0, 2.0, 2.0, 2.0, 5.0]);
    }
}
