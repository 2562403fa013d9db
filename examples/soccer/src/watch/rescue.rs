//! What is done about violations: the handlers that `soccer.rv` runs. The robot's program knows nothing of them, and they do to it what anybody
//! could: they call what it has.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use lapwing_tracing::{Handlers, Violation};

use crate::robot::{InfraredMode, Kicker, Mission, SensorController};

/// What the handlers get of the program.
pub struct Rescue {
    kicker: Arc<Kicker>,
    /// The one property whose violations are answered; all of them without.
    only: Option<String>,
    /// The handlers at work.
    at_work: Mutex<BTreeSet<&'static str>>,
}

/// How often somebody is asked to plug in the cables, and how often the ball is searched for.
const TRIES: u32 = 5;
/// How often the sensors are flushed before the robot gives the seeker up.
const FLUSHES: u32 = 100;
/// How long it waits between two.
const PAUSE: Duration = Duration::from_millis(100);
/// After so many flushes in vain it turns a little, in case the ball lies in the dead zone: by so many degrees, so fast.
const PATIENCE: u32 = 50;
const NUDGE: (f64, f64) = (25.0, 30.0);

impl Rescue {
    /// Help for a kicker; `only` names the one property whose violations are answered, as if no other were watched.
    pub fn new(kicker: Arc<Kicker>, only: Option<String>) -> Rescue {
        Rescue { kicker, only, at_work: Mutex::default() }
    }

    /// Does something, unless it is being done: what a handler does is watched as well, and may violate again what it is to mend. JavaMOP runs the
    /// handler again inside itself then, for as long as the fault lasts.
    fn once(&self, name: &'static str, violation: &Violation<'_>, what: impl FnOnce(&Kicker)) {
        if self.only.as_deref().is_some_and(|only| only != violation.property()) || !self.work().insert(name) {
            return;
        }
        what(&self.kicker);
        self.work().remove(name);
    }

    fn work(&self) -> std::sync::MutexGuard<'_, BTreeSet<&'static str>> {
        self.at_work.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The handlers, by the names that `soccer.rv` calls them by.
pub fn handlers() -> Handlers<Rescue> {
    let known: [(&'static str, fn(&Kicker)); 6] = [
        ("plug_in_cables", plug_in_cables),
        ("find_ball", find_ball),
        ("fetch_ball", fetch_ball),
        ("flush_sensors", flush_sensors),
        ("kick_ball", |kicker| kicker.kick_ball()),
        ("finish", finish),
    ];
    known.into_iter().fold(Handlers::new(), |handlers, (name, what)| {
        handlers.on(name, move |violation, rescue: &Rescue| rescue.once(name, violation, what))
    })
}

/// Asks for help until all cables are where they should be.
fn plug_in_cables(kicker: &Kicker) {
    for _ in 0..TRIES {
        if kicker.ready() {
            return;
        }
        tracing::warn!("please plug in all cables, and press any button");
        kicker.brick().wait_for_any_press();
        kicker.init();
    }
}

/// Searches for the ball.
fn find_ball(kicker: &Kicker) {
    let _found = (0..TRIES).any(|_| kicker.find_ball());
}

/// Fetches the ball, and takes it near the goal.
fn fetch_ball(kicker: &Kicker) {
    find_ball(kicker);
    kicker.goto_goal();
}

/// Stands still and reads the sensors until the seeker has a signal.
///
/// The thesis's own loop goes on while the seeker *has* one (appendix J): it ends with the first failed reading.
fn flush_sensors(kicker: &Kicker) {
    let (Some(sensors), Some(motors)) = (kicker.sensors(), kicker.motors()) else { return };
    motors.stop();
    for flush in 1..=FLUSHES {
        sensors.flush_sensors();
        if has_signal(&sensors) {
            return;
        }
        kicker.brick().delay(PAUSE);
        if flush % PATIENCE == 0 {
            motors.turn(NUDGE.0, NUDGE.1);
        }
    }
}

fn has_signal(sensors: &SensorController) -> bool {
    [InfraredMode::Modulated, InfraredMode::Unmodulated].into_iter().all(|mode| sensors.last_ir(mode).is_some())
}

/// Does what is left to do before the match is over.
fn finish(kicker: &Kicker) {
    kicker.kick_ball();
    kicker.set_ball_kicked_at_goal(kicker.ball_in_front());
}
