//! Several recordings at once.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::interrupt;

/// As many threads as are wanted, else one for each core.
pub fn threads(wanted: Option<NonZeroUsize>) -> usize {
    let cores = || thread::available_parallelism().map_or(1, NonZeroUsize::get);
    wanted.map_or_else(cores, NonZeroUsize::get)
}

/// Calls `work` for every number below `count`, on so many threads, each number once and in order of their beginnings. After an
/// interrupt no further ones are begun. Gives the results of those that were, by number.
pub fn spread<T: Send>(count: usize, threads: usize, work: impl Fn(usize) -> T + Sync) -> Vec<(usize, T)> {
    let next = AtomicUsize::new(0);
    let one_thread = || {
        let mut results = Vec::new();
        while !interrupt::is_stopped() {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= count {
                break;
            }
            results.push((number, work(number)));
        }
        results
    };
    let mut results: Vec<(usize, T)> = thread::scope(|scope| {
        let threads: Vec<_> = (0..threads.clamp(1, count.max(1))).map(|_| scope.spawn(one_thread)).collect();
        threads.into_iter().filter_map(|t| t.join().ok()).flatten().collect()
    });
    results.sort_by_key(|(number, _)| *number);
    results
}
