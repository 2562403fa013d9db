//! Where a monitor's time comes from.

use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use lapwing_stream::Time;

/// A clock. The monitor reads it under its lock, once for everything that arrives, so that stamps are in the order of arrival: it must
/// neither wait for anything nor raise events.
pub trait Clock: Send + Sync + 'static {
    /// The time now. A clock that goes back starts every monitor anew, as a recording whose time jumps does.
    fn now(&self) -> Time;

    /// How long it takes until the clock has gone beyond a time: zero where it has. `None` where nobody can tell, as in a simulation: then the
    /// host says so itself, by [`Monitor::advance`](crate::Monitor::advance).
    fn until_beyond(&self, _time: Time) -> Option<std::time::Duration> {
        None
    }
}

/// The machine's monotonic clock, told as Unix time: it is set by the calendar once, when it is made, and never steps after.
#[derive(Clone, Copy, Debug)]
pub struct SystemClock {
    origin: Instant,
    unix: i64,
}

impl SystemClock {
    /// A clock that shows the calendar's time now.
    pub fn new() -> SystemClock {
        let unix = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        SystemClock { origin: Instant::now(), unix: i64::try_from(unix.as_nanos()).unwrap_or(i64::MAX) }
    }
}

impl Default for SystemClock {
    fn default() -> SystemClock {
        SystemClock::new()
    }
}

impl Clock for SystemClock {
    fn now(&self) -> Time {
        let elapsed = i64::try_from(self.origin.elapsed().as_nanos()).unwrap_or(i64::MAX);
        Time(self.unix.saturating_add(elapsed))
    }

    fn until_beyond(&self, time: Time) -> Option<std::time::Duration> {
        let now = self.now();
        let nanos = time.0.saturating_add(1).saturating_sub(now.0).max(0);
        Some(std::time::Duration::from_nanos(nanos.unsigned_abs()))
    }
}

/// A clock that the host sets: the time of a simulation, or of a test. Clones show the same time.
///
/// ```
/// use lapwing_stream::Time;
/// use lapwing_tracing::{Clock, ManualClock};
///
/// let clock = ManualClock::new();
/// let same = clock.clone();
/// clock.set(Time(2_000_000_000));
/// assert_eq!(same.now(), Time(2_000_000_000));
/// ```
#[derive(Clone, Debug, Default)]
pub struct ManualClock(Arc<AtomicI64>);

impl ManualClock {
    /// A clock that shows zero.
    pub fn new() -> ManualClock {
        ManualClock::default()
    }

    /// Sets the time.
    pub fn set(&self, time: Time) {
        self.0.store(time.0, Ordering::SeqCst);
    }
}

impl Clock for ManualClock {
    fn now(&self) -> Time {
        Time(self.0.load(Ordering::SeqCst))
    }
}
