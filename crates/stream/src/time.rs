//! Time in integer nanoseconds: stamps and durations.

use core::fmt;
use core::ops::{Add, Sub};

use serde::{Deserialize, Serialize};

/// A stamp: nanoseconds since the epoch of the clock in use (Unix time in most recordings, zero in many simulations).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default, Serialize, Deserialize)]
pub struct Time(pub i64);

/// A span of time in nanoseconds, never negative.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default, Serialize, Deserialize)]
pub struct Duration(i64);

/// Nanoseconds in a second.
const SECOND: i64 = 1_000_000_000;

impl Time {
    /// The time from `earlier` to `self`, zero where `earlier` is later.
    #[inline]
    pub fn since(self, earlier: Time) -> Duration {
        Duration(self.0.saturating_sub(earlier.0).max(0))
    }

    /// The stamp in seconds, as nearly as a double can say it.
    pub fn seconds(self) -> f64 {
        self.0 as f64 / 1e9
    }
}

impl Duration {
    /// No time at all.
    pub const ZERO: Duration = Duration(0);

    /// A duration of so many nanoseconds; a negative number gives zero.
    #[inline]
    pub fn from_nanos(nanos: i64) -> Duration {
        Duration(nanos.max(0))
    }

    /// Whole nanoseconds.
    #[inline]
    pub fn nanos(self) -> i64 {
        self.0
    }

    /// Seconds, as nearly as a double can say it.
    pub fn seconds(self) -> f64 {
        self.0 as f64 / 1e9
    }
}

impl Add<Duration> for Time {
    type Output = Time;
    /// Saturates at the end of time rather than wrapping.
    fn add(self, by: Duration) -> Time {
        Time(self.0.saturating_add(by.0))
    }
}

impl Sub<Duration> for Time {
    type Output = Time;
    /// Saturates at the beginning of time rather than wrapping.
    fn sub(self, by: Duration) -> Time {
        Time(self.0.saturating_sub(by.0))
    }
}

impl fmt::Display for Time {
    /// Seconds with as many decimals as are needed: `12.5 s`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_seconds(f, self.0)
    }
}

impl fmt::Display for Duration {
    /// In the largest unit that leaves no fraction below a nanosecond: `100 ms`, `2 s`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            0 => f.write_str("0 s"),
            n if n % 1_000_000 != 0 && n < 1_000_000 => match n % 1000 {
                0 => write!(f, "{} us", n / 1000),
                _ => write!(f, "{n} ns"),
            },
            n if n < SECOND && n % 1_000_000 == 0 => write!(f, "{} ms", n / 1_000_000),
            n => write_seconds(f, n),
        }
    }
}

fn write_seconds(f: &mut fmt::Formatter<'_>, nanos: i64) -> fmt::Result {
    let sign = if nanos < 0 { "-" } else { "" };
    let (whole, mut rest) = (nanos.unsigned_abs() / SECOND as u64, nanos.unsigned_abs() % SECOND as u64);
    if rest == 0 {
        return write!(f, "{sign}{whole} s");
    }
    let mut digits = 9;
    while rest % 10 == 0 {
        rest /= 10;
        digits -= 1;
    }
    write!(f, "{sign}{whole}.{rest:0digits$} s")
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    #[test]
    fn times_and_durations_print_as_people_write_them() {
        let shown = |n| Duration::from_nanos(n).to_string();
        assert_eq!([shown(0), shown(1), shown(1500), shown(2000)], ["0 s", "1 ns", "1500 ns", "2 us"]);
        assert_eq!([shown(100_000_000), shown(1_500_000_000)], ["100 ms", "1.5 s"]);
        assert_eq!(Time(-1_050_000_000).to_string(), "-1.05 s");
        assert_eq!(Time(3_100_000_001).to_string(), "3.100000001 s");
    }

    #[test]
    fn arithmetic_saturates() {
        assert_eq!(Time(i64::MAX) + Duration::from_nanos(1), Time(i64::MAX));
        assert_eq!(Time(0).since(Time(5)), Duration::ZERO);
    }
}
