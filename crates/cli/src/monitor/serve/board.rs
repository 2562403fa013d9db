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

/// Where how things stand is put up.
#[derive(Clone, Default)]
pub struct Board {
    shared: Arc<Mutex<Posted>>,
}

/// What is put up.
#[derive(Default)]
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
        let mut posted = self.lock();
        posted.past.begin();
        posted.events.clear();
    }

    /// Something happened, as a line of JSON.
    pub fn event(&self, json: &str) {
        let Ok(Value::Object(mut event)) = serde_json::from_str(json) else { return };
        event.retain(|key, _| SHOWN.contains(&key.as_str()));
        let mut posted = self.lock();
        if posted.events.len() >= MOST_EVENTS {
            posted.events.pop_front();
        }
        let revision = posted.past.event();
        posted.events.push_back((revision, Value::Object(event)));
    }

    /// How things stand now.
    pub fn view(&self, view: &View) {
        let mut posted = self.lock();
        posted.past.look(view);
        // The tracks are in the past already.
        posted.view = View { tracks: Vec::new(), ..view.clone() };
    }

    /// What is posted is whole at any moment, also after a thread that held the lock was given up.
    pub fn lock(&self) -> MutexGuard<'_, Posted> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
