//! How many messages a second arrive from rospy without loss, and how long they wait in the queue.
//!
//! ```console
//! $ rosmaster --core -p 11499 &
//! $ cargo run --release -p lapwing-ros --features ros1 --example ros1_load -- http://127.0.0.1:11499 10
//! ```
//!
//! Prints one line a second: messages, messages that the publisher numbered and that never came, the time from the stamp of arrival to
//! the look at the message, and this process's share of a processor. `crates/ros/examples/ros1_flood.py` is the publisher.

use std::collections::BTreeMap;
use std::env::args;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use lapwing_ros::connector::{Happening, Refused, StreamId};
use lapwing_ros::ros1::connect;

fn main() -> Result<(), Refused> {
    let (uri, seconds) = (args().nth(1), args().nth(2).and_then(|s| s.parse().ok()).unwrap_or(10));
    let mut graph = connect(uri.as_deref(), "/load")?;
    graph.subscribe(&["/flood".to_owned()]);
    let mut tally = Tally::default();
    let (begin, mut second) = (Instant::now(), Instant::now());
    while begin.elapsed() < Duration::from_secs(seconds) {
        if let Some(arrival) = graph.next(Duration::from_millis(100)) {
            let late = wall().saturating_sub(arrival.at.0);
            tally.take(arrival.what, late);
        }
        if second.elapsed() >= Duration::from_secs(1) {
            tally.say(second.elapsed());
            second = Instant::now();
        }
    }
    tally.sum_up();
    Ok(())
}

/// What has come.
#[derive(Default)]
struct Tally {
    last: BTreeMap<StreamId, u32>,
    messages: u64,
    missed: u64,
    dropped: u64,
    /// Since the last line.
    recent: u64,
    waits: Vec<i64>,
    processor: f64,
    all: u64,
}

impl Tally {
    fn take(&mut self, what: Happening, late: i64) {
        match what {
            Happening::Message { stream, payload } => {
                self.recent += 1;
                self.messages += 1;
                self.waits.push(late);
                self.count(stream, &payload);
            }
            Happening::Lost { count, .. } => self.dropped += count,
            other => println!("{other:?}"),
        }
    }

    /// The publisher numbers its messages in their first field.
    fn count(&mut self, stream: StreamId, payload: &[u8]) {
        let Some(number) = payload.first_chunk().map(|bytes| u32::from_le_bytes(*bytes)) else { return };
        if let Some(last) = self.last.insert(stream, number) {
            self.missed += u64::from(number.wrapping_sub(last).wrapping_sub(1));
        }
    }

    fn say(&mut self, time: Duration) {
        self.waits.sort_unstable();
        let quantile = |share: f64| {
            let at = (self.waits.len() as f64 * share) as usize;
            self.waits.get(at.min(self.waits.len().saturating_sub(1))).copied().unwrap_or_default() as f64 / 1e3
        };
        let (used, rate) = (processor_seconds(), self.recent as f64 / time.as_secs_f64());
        println!(
            "{rate:8.0} messages a second, {} missed, {} dropped, wait p50 {:.0} us p99 {:.0} us, processor {:.0} %",
            self.missed,
            self.dropped,
            quantile(0.5),
            quantile(0.99),
            100.0 * (used - self.processor) / time.as_secs_f64(),
        );
        self.processor = used;
        self.all += self.recent;
        self.recent = 0;
        self.waits.clear();
    }

    fn sum_up(&self) {
        println!("{} messages, {} missed, {} dropped", self.messages, self.missed, self.dropped);
    }
}

/// The time of the wall clock, in nanoseconds: that of arrivals begins with it.
fn wall() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since.as_nanos()).unwrap_or(i64::MAX)
}

/// What this process has used of a processor, in seconds, where the system says so.
fn processor_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = text.rsplit(") ").next().unwrap_or_default().split(' ').collect();
    let ticks = |at: usize| fields.get(at).and_then(|f| f.parse::<f64>().ok()).unwrap_or_default();
    (ticks(11) + ticks(12)) / 100.0
}
