//! Tasks as one would write them by hand: a thread for each, which sleeps until its next period begins and calls its codels.

use std::path::Path;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use lapwing_components::{Happening, Observer, Run, What};

/// How long a run's threads have had a processor: read while all are there, since those that end take their times along.
#[derive(Default)]
pub struct Meter {
    pub used: f64,
}

impl Observer for Meter {
    fn see(&mut self, _: &mut Run, happening: &Happening) {
        if happening.what == What::Over {
            self.used = used();
        }
    }
}

/// What a codel does.
pub type Work = Arc<dyn Fn() + Send + Sync>;

/// A task: its period, and what it calls in each turn.
pub struct Task {
    pub period: Duration,
    pub calls: Vec<Work>,
}

/// How it went.
pub struct Went {
    /// How much of a core it took.
    pub core: f64,
    /// How many codels were called in a second.
    pub calls: f64,
    /// How many turns began after their period was over.
    pub missed: u64,
}

/// Runs tasks for a while.
pub fn run(tasks: Vec<Task>, seconds: i64) -> Went {
    let origin = Instant::now();
    let end = Duration::from_secs(seconds.unsigned_abs());
    let threads: Vec<_> = tasks.into_iter().map(|task| thread::spawn(move || turns(&task, origin, end))).collect();
    let mut all = Went { core: 0.0, calls: 0.0, missed: 0 };
    for one in threads.into_iter().filter_map(|t| t.join().ok()) {
        all.core += one.core / seconds as f64;
        all.calls += one.calls / seconds as f64;
        all.missed += one.missed;
    }
    all
}

/// One task: its seconds of a core and its calls, not yet divided by the time.
fn turns(task: &Task, origin: Instant, end: Duration) -> Went {
    let (mut calls, mut missed, mut next) = (0, 0, task.period);
    while next < end {
        thread::sleep(next.saturating_sub(origin.elapsed()));
        task.calls.iter().for_each(|work| work());
        calls += task.calls.len();
        next += task.period;
        while next < origin.elapsed() {
            missed += 1;
            next += task.period;
        }
    }
    Went { core: used_by(Path::new("/proc/thread-self")), calls: calls as f64, missed }
}

/// How long the threads of this process have had a processor, in seconds; 0 where the system does not say.
///
/// The times of the whole process, `/proc/self/stat`, are of no use: they are counted in ticks of the clock by which the threads wake.
pub fn used() -> f64 {
    let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    threads.map(|thread| used_by(&thread.path())).sum()
}

fn used_by(thread: &Path) -> f64 {
    let text = std::fs::read_to_string(thread.join("schedstat")).unwrap_or_default();
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(0.0) / 1e9
}
