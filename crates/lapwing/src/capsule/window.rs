//! Which part of a recording a clip is.

use lapwing_check::checked::Clock;
use lapwing_react::Violation;
use lapwing_stream::{Duration, Time};

use crate::ticks::Ticks;

/// Before the beginning of what failed, in nanoseconds.
const BEFORE: i64 = 5_000_000_000;
/// The same, where that is not enough.
const LONG_BEFORE: i64 = 60_000_000_000;
/// After the failure.
const AFTER: i64 = 2_000_000_000;

/// Which part of a recording a clip is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    /// Its beginning; `None` for that of the recording.
    pub from: Option<Time>,
    /// Its end.
    pub to: Time,
    /// Whether it begins with the latest message of each topic before it, and the latest value of each column, with the stamp of its
    /// beginning: what a signal was worth then.
    pub carries: bool,
    /// The rate of the specification: its beginning is moved back to one of its instants.
    pub rate: Option<u32>,
}

impl Window {
    /// From five seconds before the beginning to two after the failure.
    pub fn plain(violation: &Violation) -> Window {
        Window {
            from: Some(violation.began - Duration::from_nanos(BEFORE)),
            to: violation.failed + Duration::from_nanos(AFTER),
            carries: false,
            rate: None,
        }
    }

    /// Whether what has this stamp is in it.
    pub fn has(&self, from: Option<Time>, time: Time) -> bool {
        from.is_none_or(|from| time >= from) && time <= self.to
    }

    /// Where it begins in a recording of which the specification read its first message at that time: at an instant of its rate.
    pub fn beginning(&self, first: Option<Time>) -> Option<Time> {
        let (from, Some(first), Some(hz)) = (self.from?, first, self.rate) else { return self.from };
        Some(Ticks { hz, first }.last_until(from))
    }
}

/// The clips to try, from the shortest to all that led to the violation.
pub(super) fn candidates(violation: &Violation, clock: &Clock) -> Vec<Window> {
    let rate = match clock {
        Clock::Events => None,
        Clock::Rate(rate) => Some(*rate),
    };
    let plain = Window { rate, ..Window::plain(violation) };
    vec![
        plain,
        Window { carries: true, ..plain },
        Window { from: Some(violation.began - Duration::from_nanos(LONG_BEFORE)), ..plain },
        Window { from: Some(violation.began - Duration::from_nanos(LONG_BEFORE)), carries: true, ..plain },
        Window { from: None, ..plain },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clip_for_a_rate_begins_at_one_of_its_instants() {
        let window = Window { from: Some(Time(7_000_000_000)), to: Time(9_000_000_000), carries: true, rate: Some(30) };
        let beginning = window.beginning(Some(Time(500_000_000))).unwrap();
        assert_eq!(beginning, Time(500_000_000 + 195 * 1_000_000_000 / 30));
        assert!(beginning <= Time(7_000_000_000));
        assert_eq!(window.beginning(Some(Time(8_000_000_000))), Some(Time(8_000_000_000)));
        assert_eq!(Window { rate: None, ..window }.beginning(Some(Time(1))), Some(Time(7_000_000_000)));
    }
}
