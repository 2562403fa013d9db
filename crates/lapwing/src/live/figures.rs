//! What a run measures of itself.

use std::time::Duration;

/// Buckets of a doubling of time: four, so that a quantile is at most a fifth too high.
const PARTS: u32 = 4;

/// From a microsecond on so many doublings are told apart: up to 17 minutes.
const DOUBLINGS: u32 = 30;

/// And so many are told one by one: up to 17 seconds.
const SHOWN: u32 = 24;

/// How long something took, again and again: a histogram with buckets that grow by a fifth, in constant memory.
#[derive(Clone, Debug)]
pub struct Latency {
    buckets: Vec<u64>,
    count: u64,
    sum: Duration,
    most: Duration,
}

impl Default for Latency {
    fn default() -> Latency {
        Latency {
            buckets: vec![0; (DOUBLINGS * PARTS + 1) as usize],
            count: 0,
            sum: Duration::ZERO,
            most: Duration::ZERO,
        }
    }
}

impl Latency {
    /// It took so long once more.
    pub fn note(&mut self, took: Duration) {
        let bucket = bucket(took).min(self.buckets.len() - 1);
        if let Some(count) = self.buckets.get_mut(bucket) {
            *count += 1;
        }
        self.count += 1;
        self.sum = self.sum.saturating_add(took);
        self.most = self.most.max(took);
    }

    /// How often it was measured.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// All of it together.
    pub fn sum(&self) -> Duration {
        self.sum
    }

    /// The longest.
    pub fn most(&self) -> Duration {
        self.most
    }

    /// What that share of all did not exceed, at most a fifth too high: the median for 0.5. `None` where nothing was measured.
    pub fn quantile(&self, share: f64) -> Option<Duration> {
        let rank = (share.clamp(0.0, 1.0) * self.count as f64).ceil().max(1.0) as u64;
        let mut seen = 0;
        let found = self.buckets.iter().position(|count| {
            seen += count;
            seen >= rank
        });
        found.filter(|_| self.count > 0).map(|bucket| upper(bucket).min(self.most))
    }

    /// Upper ends, each twice the one before, with how many lie at or below each. They are always the same: who compares two looks, as Prometheus
    /// does, must find each end in both.
    pub fn cumulative(&self) -> impl Iterator<Item = (Duration, u64)> {
        let ends = (0..=SHOWN).map(|doublings| (doublings * PARTS) as usize);
        ends.map(|end| (upper(end), self.buckets.iter().take(end + 1).sum()))
    }
}

/// The bucket of a duration: the first goes up to a microsecond.
fn bucket(took: Duration) -> usize {
    let micros = took.as_nanos() as f64 / 1000.0;
    if micros <= 1.0 { 0 } else { (micros.log2() * f64::from(PARTS)).ceil() as usize }
}

/// The upper end of a bucket.
fn upper(bucket: usize) -> Duration {
    Duration::from_secs_f64((bucket as f64 / f64::from(PARTS)).exp2() * 1e-6)
}

/// What a run measures of itself.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    /// From the arrival of a message to everything that it decides.
    pub judged: Latency,
    /// From the arrival of a message to the reaction to what it decided, handed to the transport.
    pub reacted: Latency,
    /// From the arrival of a guarded message to its being passed on, or what stands in its place.
    pub guarded: Latency,
    /// Messages taken in.
    pub messages: u64,
    /// Messages that were lost on the way.
    pub lost: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_at_most_a_fifth_too_high() {
        let mut latency = Latency::default();
        assert_eq!(latency.quantile(0.5), None);
        (1..=1000).for_each(|n| latency.note(Duration::from_micros(n)));
        for (share, exact) in [(0.5, 500.0), (0.99, 990.0), (1.0, 1000.0)] {
            let micros = latency.quantile(share).unwrap().as_secs_f64() * 1e6;
            assert!((exact * 0.999..=exact * 1.2).contains(&micros), "{share}: {micros}");
        }
        assert_eq!((latency.count(), latency.most()), (1000, Duration::from_millis(1)));
        let ends: Vec<(Duration, u64)> = latency.cumulative().collect();
        assert_eq!((ends.len(), ends[9].1, ends[24].1), (25, 512, 1000));
        assert_eq!(ends.len(), Latency::default().cumulative().count(), "the ends are there before anything is");
    }

    #[test]
    fn what_is_out_of_all_bounds_is_counted_all_the_same() {
        let mut latency = Latency::default();
        latency.note(Duration::ZERO);
        latency.note(Duration::from_secs(1 << 40));
        assert_eq!((latency.count(), latency.quantile(0.0)), (2, Some(Duration::from_micros(1))));
    }
}
