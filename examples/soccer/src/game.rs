//! A match: a field, a kicker, a fault perhaps, and those who watch. It takes a process of its own, since the monitors listen to the whole of it.

use std::sync::Arc;

use lapwing_tracing::{BuildError, Monitor};
use serde::{Deserialize, Serialize};
use tracing_subscriber::layer::SubscriberExt;

use crate::fault::{self, Fault};
use crate::field::{Field, Kickoff, Sketch};
use crate::robot::{Kicker, Settings};
use crate::watch::{Entry, Happening, Judged, Listener, Log, Rescue, What, handlers, replay};
pub use crate::watch::{SPEC, spec};

/// What is to be played.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Game {
    /// What chance follows.
    pub seed: u64,
    /// What goes wrong.
    pub fault: Option<Fault>,
    /// The one property whose violations are answered, as if no other were watched; all of them without.
    pub only: Option<String>,
}

/// A match that has been played.
#[derive(Clone, Debug)]
pub struct Played {
    /// What was said, and what was violated.
    pub log: Vec<Entry>,
    /// What can be told of it.
    pub account: Account,
}

/// What can be told of a match.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Account {
    /// What chance followed.
    pub seed: u64,
    /// What went wrong, by its name.
    pub fault: Option<String>,
    /// What happened, in order.
    pub happenings: Vec<Happening>,
    /// The states of the diagram, each with when it was entered.
    pub states: Vec<(i64, String)>,
    /// What the monitors said at the end.
    pub judged: Vec<Judged>,
    /// What the log says when it is gone through once more, without any reset.
    pub rejudged: Vec<Judged>,
    /// Whether the ball is in the goal at the end.
    pub goal: bool,
    /// The field, from time to time.
    pub sketches: Vec<Sketch>,
}

impl Game {
    /// Plays it. A second match in the same process is an error: the subscriber of the first is still there.
    pub fn play(&self) -> Result<Played, BuildError> {
        let (mut kickoff, mut settings) = (self.kickoff(), Settings::default());
        if let Some(fault) = self.fault {
            fault.spoil(&mut kickoff);
            fault.misinform(&mut settings);
        }
        let field = Field::new(&kickoff);
        let kicker = Arc::new(Kicker::new(Arc::new(field.clone()), settings));
        let log = Log::default();
        let monitor = self.watch(&field, &log, kicker.clone())?;
        kicker.init();
        kicker.ready();
        fault::play(&kicker, self.fault);
        let judged = monitor.finish().properties.iter().map(Judged::of).collect();
        let log = log.entries();
        let seen = replay(&log, &spec()?);
        let account = Account {
            seed: self.seed,
            fault: self.fault.map(|fault| fault.to_string()),
            happenings: seen.happenings,
            states: seen.states,
            judged,
            rejudged: seen.judged,
            goal: field.is_in_goal(),
            sketches: field.sketches(),
        };
        Ok(Played { log, account })
    }

    /// The one place where robot and monitors meet: the log first, so that it has what the monitors answer.
    fn watch(&self, field: &Field, log: &Log, kicker: Arc<Kicker>) -> Result<Monitor, BuildError> {
        let violations = log.clone();
        let note = move |violation: &lapwing_tracing::Violation<'_>| {
            violations.add(violation.failed().0, What::Violation(violation.property().to_owned()));
        };
        let monitor = Monitor::builder(spec()?)
            .handlers(Rescue::new(kicker, self.only.clone()), handlers())
            .clock(field.clock())
            .on_violation(note)
            .without_waker()
            .build()?;
        let listener = Listener::new(log.clone(), field.clock());
        let subscriber = tracing_subscriber::registry().with(listener).with(monitor.layer());
        tracing::subscriber::set_global_default(subscriber).map_err(|_| BuildError::AlreadyInstalled)?;
        Ok(monitor)
    }

    /// The ball lies nearly straight ahead, as the seed has it.
    pub fn kickoff(&self) -> Kickoff {
        let mut chance = lapwing_sim::Random::new(self.seed, "kickoff", 0);
        let ball = (chance.between(0.5, 0.7), chance.between(-1.5, 1.5));
        let goal = Settings::default().goal;
        Kickoff { seed: self.seed, ball, hands: Vec::new(), unplugged: Vec::new(), goal }
    }
}
