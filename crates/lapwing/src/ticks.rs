//! The instants of a rate: the k-th is `floor(k·10⁹ / hz)` nanoseconds after the first.

use lapwing_stream::Time;

const SECOND: i128 = 1_000_000_000;

/// The instants of a rate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ticks {
    /// How many there are in a second.
    pub hz: u32,
    /// The first.
    pub first: Time,
}

impl Ticks {
    /// The last of them at or before a time; before the first, the first.
    pub fn last_until(self, time: Time) -> Time {
        let since = i128::from(time.0) - i128::from(self.first.0);
        if since <= 0 {
            return self.first;
        }
        let hz = i128::from(self.hz.max(1));
        // The last number whose stamp is before the next nanosecond.
        let number = ((since + 1) * hz - 1).div_euclid(SECOND);
        let stamp = i128::from(self.first.0) + (number * SECOND).div_euclid(hz);
        i64::try_from(stamp).map_or(time, Time)
    }

    /// Whether one of them has that stamp.
    pub fn has(self, time: Time) -> bool {
        self.last_until(time) == time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_instant_is_found_from_itself_up_to_the_next() {
        for hz in [1, 3, 7, 30, 1000, 1_000_000_007] {
            let ticks = Ticks { hz, first: Time(-5) };
            let stamp = |k: i128| Time((-5 + (k * SECOND).div_euclid(i128::from(hz))) as i64);
            for k in 0..500 {
                let (this, next) = (stamp(k), stamp(k + 1));
                assert!(ticks.has(this), "{hz} {k}");
                if next.0 > this.0 + 1 {
                    assert_eq!([ticks.last_until(Time(this.0 + 1)), ticks.last_until(Time(next.0 - 1))], [this, this]);
                    assert!(!ticks.has(Time(this.0 + 1)));
                }
            }
            assert_eq!(ticks.last_until(Time(-100)), Time(-5));
        }
    }
}
