//! Moments, spans of moments, and how they are written.
//!
//! Model time is whole nanoseconds since the beginning of a run. A guard is a [`Window`] of such moments; whether its ends belong to it
//! matters beyond the moments it holds, since `x < 5` has no last moment at which something could be made to happen.

use std::fmt;

/// Model time: nanoseconds since the beginning of the run.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub struct Time(pub i64);

impl Time {
    /// Before everything.
    pub const MIN: Time = Time(i64::MIN);
    /// After everything.
    pub const MAX: Time = Time(i64::MAX);
    /// The beginning of a run.
    pub const ZERO: Time = Time(0);
}

impl fmt::Display for Time {
    /// The parts that are not zero: `1min3s230ms653us976ns`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Time::MAX => return f.write_str("+INFTY"),
            Time::MIN => return f.write_str("-INFTY"),
            Time(0) => return f.write_str("0"),
            Time(t) if t < 0 => f.write_str("-")?,
            _ => {}
        }
        let mut rest = self.0.unsigned_abs();
        let parts =
            [(86_400_000_000_000, "day"), (3_600_000_000_000, "h"), (60_000_000_000, "min"), (1_000_000_000, "s")];
        for (length, unit) in parts.into_iter().chain([(1_000_000, "ms"), (1_000, "us"), (1, "ns")]) {
            if rest >= length {
                write!(f, "{}{unit}", rest / length)?;
                rest %= length;
            }
        }
        Ok(())
    }
}

/// A span of moments.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Window {
    /// The first moment in it.
    pub first: i64,
    /// The last moment in it; none where this is before `first`.
    pub last: i64,
    /// Whether it was written without its left end, which is then the moment before `first`.
    pub open_left: bool,
    /// Whether it was written without its right end, which is then the moment after `last`.
    pub open_right: bool,
}

impl Window {
    /// All moments.
    pub const ALL: Window = Window { first: i64::MIN, last: i64::MAX, open_left: false, open_right: false };
    /// No moment.
    pub const NONE: Window = Window { first: i64::MAX, last: i64::MIN, open_left: false, open_right: false };

    /// From a moment on.
    pub fn from(first: i64) -> Window {
        Window { first, ..Window::ALL }
    }

    /// Up to and with a moment.
    pub fn until(last: i64) -> Window {
        Window { last, ..Window::ALL }
    }

    /// Whether it has no moment.
    pub fn is_empty(self) -> bool {
        self.first > self.last
    }

    /// Whether a moment lies in it.
    pub fn holds(self, at: i64) -> bool {
        self.first <= at && at <= self.last
    }

    /// The moments that lie in both.
    #[inline]
    pub fn and(self, other: Window) -> Window {
        let (first, open_left) = match self.first.cmp(&other.first) {
            std::cmp::Ordering::Less => (other.first, other.open_left),
            std::cmp::Ordering::Equal => (self.first, self.open_left || other.open_left),
            std::cmp::Ordering::Greater => (self.first, self.open_left),
        };
        let (last, open_right) = match self.last.cmp(&other.last) {
            std::cmp::Ordering::Less => (self.last, self.open_right),
            std::cmp::Ordering::Equal => (self.last, self.open_right || other.open_right),
            std::cmp::Ordering::Greater => (other.last, other.open_right),
        };
        Window { first, last, open_left, open_right }
    }

    /// The left end as written.
    pub fn left(self) -> i64 {
        if self.open_left { self.first.saturating_sub(1) } else { self.first }
    }

    /// The right end as written.
    pub fn right(self) -> i64 {
        if self.open_right { self.last.saturating_add(1) } else { self.last }
    }
}

impl fmt::Display for Window {
    /// `[ 0, 5s ]`; a bracket is turned outwards where the end does not belong to the window.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (left, right) = (if self.open_left { ']' } else { '[' }, if self.open_right { '[' } else { ']' });
        write!(f, "{left} {}, {} {right}", Time(self.left()), Time(self.right()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_show_what_is_not_zero() {
        let shown = |ns| Time(ns).to_string();
        assert_eq!([shown(0), shown(5_000_000_000), shown(63_230_653_976)], ["0", "5s", "1min3s230ms653us976ns"]);
        assert_eq!(
            [shown(26_591_324_108), shown(i64::MAX), shown(i64::MIN)],
            ["26s591ms324us108ns", "+INFTY", "-INFTY"]
        );
        assert_eq!([shown(90_000_000_000_000), shown(-1)], ["1day1h", "-1ns"]);
    }

    #[test]
    fn windows_keep_how_they_were_written() {
        let open = Window { open_left: true, ..Window::from(6) };
        assert_eq!(open.to_string(), "] 5ns, +INFTY ]");
        assert_eq!(open.and(Window::until(9)).to_string(), "] 5ns, 9ns ]");
        assert_eq!(Window::from(6).and(open).left(), 5, "of two equal ends the open one is the stricter");
        assert!(open.and(Window::until(5)).is_empty());
        assert!(open.holds(6) && !open.holds(5));
        assert!(Window::NONE.is_empty() && Window::NONE.and(Window::ALL).is_empty());
    }
}
