//! When something that is published regularly is due.

/// A rhythm.
#[derive(Clone, Debug)]
pub struct Ticker {
    /// Both in nanoseconds.
    period: i64,
    next: i64,
}

impl Ticker {
    /// So many times a second, first after a delay: topics of the same rate need not come together.
    pub fn new(rate: f64, delay_ms: i64) -> Ticker {
        Ticker { period: libm::round(1e9 / rate) as i64, next: delay_ms * 1_000_000 }
    }

    /// Whether it is due at that time, in nanoseconds; if so, it is due again a period later.
    pub fn is_due(&mut self, now: i64) -> bool {
        let is_due = now >= self.next;
        if is_due {
            self.next += self.period;
        }
        is_due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thirty_times_a_second_is_that_on_average() {
        let mut ticker = Ticker::new(30.0, 10);
        let due = (1..=2000).filter(|k| ticker.is_due(k * 5_000_000)).count();
        assert!((299..=301).contains(&due), "{due}");
    }
}
