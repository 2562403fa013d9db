//! Which of several states something was in, in bounded memory: where it changes too often to keep every change, a stretch of time only says so.

use lapwing_stream::Time;

/// More states than this are not told apart.
const LABELS: usize = 24;

/// The states of something over time. Times never go back.
#[derive(Clone, Debug)]
pub(super) struct Steps {
    labels: Vec<String>,
    /// Since when it is in which state; `None` where it changed too often to tell.
    changes: Vec<(Time, Option<usize>)>,
    most: usize,
    /// A stretch in which changes are not told apart is this power of two of nanoseconds wide.
    shift: u32,
    is_thinned: bool,
}

impl Steps {
    /// Keeps at most so many changes.
    pub fn new(most: usize) -> Steps {
        Steps { labels: Vec::new(), changes: Vec::new(), most: most.max(4), shift: 0, is_thinned: false }
    }

    /// It is in this state now.
    pub fn push(&mut self, time: Time, label: &str) {
        let state = self.number(label);
        if self.changes.last().is_some_and(|(_, now)| *now == state && state.is_some()) {
            return;
        }
        if self.is_crowded(time) {
            self.changes.pop();
            if let Some(first) = self.changes.last_mut() {
                first.1 = None;
            }
            self.is_thinned = true;
        }
        self.changes.push((time, state));
        while self.changes.len() > self.most {
            self.shift += 1;
            self.coarsen();
        }
    }

    /// The changes that are kept.
    pub fn changes(&self) -> &[(Time, Option<usize>)] {
        &self.changes
    }

    /// What the states are called.
    pub fn labels(&self) -> &[String] {
        &self.labels
    }

    /// Whether there were more changes.
    pub fn is_thinned(&self) -> bool {
        self.is_thinned
    }

    fn number(&mut self, label: &str) -> Option<usize> {
        let known = self.labels.iter().position(|l| l == label);
        match known {
            None if self.labels.len() < LABELS => {
                self.labels.push(label.to_owned());
                Some(self.labels.len() - 1)
            }
            known => known,
        }
    }

    /// Whether a stretch has two changes already.
    fn is_crowded(&self, time: Time) -> bool {
        let is_same = |other: &(Time, _)| self.place(other.0) == self.place(time);
        matches!(self.changes.as_slice(), [.., first, last] if is_same(first) && is_same(last))
    }

    /// The number of the stretch that a time belongs to. From 64 on there is one for all.
    fn place(&self, time: Time) -> u64 {
        let start = self.changes.first().map_or(time, |c| c.0);
        (time.0.wrapping_sub(start.0) as u64).checked_shr(self.shift).unwrap_or(0)
    }

    /// Of several changes within a stretch only the first and the last stay, with something unclear between.
    fn coarsen(&mut self) {
        let mut kept: Vec<(Time, Option<usize>)> = Vec::with_capacity(self.changes.len());
        for group in self.changes.chunk_by(|a, b| self.place(a.0) == self.place(b.0)) {
            match group {
                [first, _, .., last] => kept.extend([(first.0, None), *last]),
                few => kept.extend(few),
            }
        }
        self.is_thinned |= kept.len() < self.changes.len();
        kept.dedup_by(|next, before| next.1 == before.1);
        self.changes = kept;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_kept_and_repetitions_are_not() {
        let mut steps = Steps::new(10);
        for (t, label) in [(0, "idle"), (1, "idle"), (2, "drive"), (3, "idle")] {
            steps.push(Time(t), label);
        }
        assert_eq!(steps.changes(), [(Time(0), Some(0)), (Time(2), Some(1)), (Time(3), Some(0))]);
        assert_eq!(steps.labels(), ["idle", "drive"]);
    }

    #[test]
    fn what_flickers_is_unclear_and_what_is_steady_stays() {
        let mut steps = Steps::new(64);
        for t in 0..100_000_i64 {
            let label = if t < 50_000 {
                "steady"
            } else if t % 2 == 0 {
                "a"
            } else {
                "b"
            };
            steps.push(Time(t), label);
        }
        assert!(steps.is_thinned() && steps.changes().len() <= 64);
        assert_eq!(steps.changes()[0], (Time(0), Some(0)));
        assert!(steps.changes()[1].0 >= Time(49_000) && steps.changes().iter().any(|(_, state)| state.is_none()));
    }

    #[test]
    fn too_many_states_are_one() {
        let mut steps = Steps::new(1000);
        (0..100).for_each(|t| steps.push(Time(t), &t.to_string()));
        assert_eq!(steps.labels().len(), LABELS);
    }
}
