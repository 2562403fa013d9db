//! How often a topic's messages come, and whether it has fallen silent.

use std::collections::VecDeque;

use lapwing_stream::{Duration, Time};

/// The mean is taken over so many messages.
const REMEMBERED: usize = 10;

/// So many must have come before a topic has a period.
const NEEDED: usize = 5;

/// A silence so many times as long as the period is told.
const UNUSUAL: i64 = 5;

/// Where it lasts so long.
const LONG: i64 = 100_000_000;

/// When the messages of a topic came.
#[derive(Debug, Default)]
pub(crate) struct Rhythm {
    stamps: VecDeque<Time>,
    /// After how long a silence is too long for a specification: then nothing else is asked.
    limit: Option<Duration>,
    /// Whether the silence that lasts has been told.
    told: bool,
}

/// A silence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Silence {
    /// Longer than a specification allows.
    TooLong(Duration),
    /// So long, where messages came at that period.
    Unusual(Duration, Duration),
}

impl Rhythm {
    /// A specification minds a silence longer than that; the shortest counts. It lasts from `since` on where nothing has come yet.
    pub fn limit(&mut self, limit: Duration, since: Time) {
        self.limit = Some(self.limit.map_or(limit, |known| known.min(limit)));
        if self.stamps.is_empty() {
            self.stamps.push_back(since);
        }
    }

    /// A message came. Gives how long the silence was, where it had been told.
    pub fn heard(&mut self, at: Time) -> Option<Duration> {
        // A simulated clock goes by steps, and what comes within one says nothing about how often it comes.
        if self.stamps.back() == Some(&at) {
            return None;
        }
        let silence = self.stamps.back().map(|last| at.since(*last)).filter(|_| self.told);
        self.told = false;
        // Over a silence there is no period.
        if silence.is_some() || self.stamps.back().is_some_and(|last| at < *last) {
            self.stamps.clear();
        }
        if self.stamps.len() >= REMEMBERED {
            self.stamps.pop_front();
        }
        self.stamps.push_back(at);
        silence
    }

    /// How long a specification allows it to be silent, where it is silent for longer now.
    pub fn too_long(&self) -> Option<Duration> {
        self.limit.filter(|_| self.told)
    }

    /// The time at which a silence is to be told that lasts until then.
    pub fn deadline(&self) -> Option<Time> {
        let last = *self.stamps.back()?;
        self.silence().filter(|_| !self.told).map(|silence| match silence {
            // Just longer than the limit.
            Silence::TooLong(limit) => last + limit + Duration::from_nanos(1),
            Silence::Unusual(silent, _) => last + silent,
        })
    }

    /// The silence that is told at the deadline.
    pub fn tell(&mut self) -> Option<Silence> {
        self.told = true;
        self.silence()
    }

    fn silence(&self) -> Option<Silence> {
        if let Some(limit) = self.limit {
            return Some(Silence::TooLong(limit));
        }
        let (first, last) = (self.stamps.front()?, self.stamps.back()?);
        let intervals = i64::try_from(self.stamps.len()).ok()?.checked_sub(1)?;
        if self.stamps.len() < NEEDED {
            return None;
        }
        let period = last.since(*first).nanos() / intervals;
        let silent = period.saturating_mul(UNUSUAL).max(LONG);
        Some(Silence::Unusual(Duration::from_nanos(silent), Duration::from_nanos(period)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ms(n: i64) -> Time {
        Time(n * 1_000_000)
    }

    #[test]
    fn five_periods_of_silence_are_unusual_and_told_once() {
        let mut rhythm = Rhythm::default();
        (0..4).for_each(|n| assert_eq!(rhythm.heard(ms(50 * n)), None));
        assert_eq!(rhythm.deadline(), None);
        rhythm.heard(ms(200));
        assert_eq!(rhythm.deadline(), Some(ms(450)));
        let unusual = Silence::Unusual(Duration::from_nanos(250_000_000), Duration::from_nanos(50_000_000));
        assert_eq!(rhythm.tell(), Some(unusual));
        assert_eq!(rhythm.deadline(), None);
        assert_eq!(rhythm.heard(ms(900)), Some(Duration::from_nanos(700_000_000)));
        assert_eq!(rhythm.deadline(), None);
    }

    #[test]
    fn a_clock_that_goes_by_steps_has_no_shorter_period_than_its_own() {
        let mut rhythm = Rhythm::default();
        (0..100).for_each(|n| assert_eq!(rhythm.heard(ms(100 * (n / 10))), None));
        assert_eq!(rhythm.deadline(), Some(ms(900 + 500)));
    }

    #[test]
    fn what_a_specification_says_counts_alone_also_before_the_first_message() {
        let mut rhythm = Rhythm::default();
        rhythm.limit(Duration::from_nanos(2_000_000_000), ms(100));
        rhythm.limit(Duration::from_nanos(3_000_000_000), ms(100));
        assert_eq!(rhythm.deadline(), Some(Time(2_100_000_001)));
        assert_eq!(rhythm.tell(), Some(Silence::TooLong(Duration::from_nanos(2_000_000_000))));
    }
}
