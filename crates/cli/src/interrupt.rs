//! Ctrl-C: the first one ends the reading, and what is known is reported; the second one ends everything.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::complain::say;

/// What the shell expects of a program that an interrupt ended.
const KILLED: i32 = 130;

static STOP: AtomicBool = AtomicBool::new(false);
static HEARD: AtomicBool = AtomicBool::new(false);

/// From now on an interrupt is noted.
pub fn listen() {
    let heard = ctrlc::set_handler(|| {
        if HEARD.swap(true, Ordering::Relaxed) {
            std::process::exit(KILLED);
        }
        stop();
        say("interrupted: reporting what is known so far (once more to quit at once)\n");
    });
    // Without a handler an interrupt ends the program, as it does most.
    drop(heard);
}

/// Whether there was an interrupt.
pub fn was_heard() -> bool {
    HEARD.load(Ordering::Relaxed)
}

/// Nothing further is to be read.
pub fn stop() {
    STOP.store(true, Ordering::Relaxed);
}

/// Whether to read no further.
pub fn is_stopped() -> bool {
    STOP.load(Ordering::Relaxed)
}
