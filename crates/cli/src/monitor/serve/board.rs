//! Where how things stand is put up, for whoever asks.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use lapwing::live::View;
use serde_json::Value;

use super::past::Past;

/// So many events are kept for the page.
const MOST_EVENTS: usize = 200;

/// The keys of events that the page shows. What led to a violation is in the report.
const SHOWN: [&str; 11] =
    ["type", "name", "file", "text", "message", "values", "verdict", "cause", "failed_ns", "began_ns", "time_ns"];

/// Where how things stand is put up. Who judges must not wait for who reads: what is handed out stays as it is, and what happens meanwhile goes
/// into a copy, so that the lock is held for no longer than it takes to hand something out.
#[derive(Clone, Default)]
pub struct Board {
    shared: Arc<Mutex<Arc<Posted>>>,
}

/// What is put up.
#[derive(Clone, Default)]
pub struct Posted {
    /// How things stand.
    pub view: View,
    /// How they went lately.
    pub past: Past,
    /// What happened, the latest last, with its revision.
    pub events: VecDeque<(u64, Value)>,
}

impl Board {
    /// A new run begins.
    pub fn begin(&self) {
        self.change(|posted| {
            posted.past.begin();
            posted.events.clear();
        });
    }

    /// Something happened, as a line of JSON.
    pub fn event(&self, json: &str) {
        let Ok(Value::Object(mut event)) = serde_json::from_str(json) else { return };
        event.retain(|key, _| SHOWN.contains(&key.as_str()));
        self.change(|posted| {
            if posted.events.len() >= MOST_EVENTS {
                posted.events.pop_front();
            }
            let revision = posted.past.event();
            posted.events.push_back((revision, Value::Object(event)));
        });
    }

    /// How things stand now.
    pub fn view(&self, view: &View) {
        // The tracks are in the past already.
        let untracked = View { tracks: Vec::new(), ..view.clone() };
        self.change(|posted| {
            posted.past.look(view);
            posted.view = untracked;
        });
    }

    /// What is put up at this moment.
    pub fn posted(&self) -> Arc<Posted> {
        self.lock().clone()
    }

    fn change(&self, change: impl FnOnce(&mut Posted)) {
        change(Arc::make_mut(&mut self.lock()));
    }

    /// What is posted is whole at any moment, also after a thread that held the lock was given up.
    fn lock(&self) -> MutexGuard<'_, Arc<Posted>> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_reads_holds_up_nobody_and_sees_nothing_change() {
        let board = Board::default();
        board.begin();
        board.event("{\"type\":\"start\"}\n");
        // While somebody reads, this thread goes on.
        let read = board.posted();
        board.event("{\"type\":\"warning\"}\n");
        board.view(&View { source: "a robot".to_owned(), ..View::default() });
        assert_eq!((read.events.len(), read.view.source.as_str()), (1, ""));
        let now = board.posted();
        assert_eq!((now.events.len(), now.view.source.as_str()), (2, "a robot"));
    }
}
