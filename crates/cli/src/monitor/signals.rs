//! Signals that a run heeds: SIGTERM ends it as Ctrl-C does, SIGHUP asks for the specifications to be read again.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What was heard since it was asked for last.
#[derive(Clone, Debug, Default)]
pub struct Signals {
    ends: Arc<AtomicBool>,
    reloads: Arc<AtomicBool>,
}

impl Signals {
    /// From now on signals are noted.
    pub fn listen() -> io::Result<Signals> {
        let signals = Signals::default();
        #[cfg(unix)]
        {
            use signal_hook::consts::{SIGHUP, SIGTERM};
            signal_hook::flag::register(SIGTERM, signals.ends.clone())?;
            signal_hook::flag::register(SIGHUP, signals.reloads.clone())?;
        }
        Ok(signals)
    }

    /// Whether the run is to end.
    pub fn end(&self) -> bool {
        self.ends.load(Ordering::Relaxed)
    }

    /// Whether the specifications are to be read again; each request is told once.
    pub fn reload(&self) -> bool {
        self.reloads.swap(false, Ordering::Relaxed)
    }
}
