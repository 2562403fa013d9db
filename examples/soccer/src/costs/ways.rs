//! The ways in which the program runs: nobody listens, somebody counts, one of the thesis's monitors, all of them.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use lapwing_tracing::{Monitor, Spec, Time};
use tracing::{Event, Subscriber, span};
use tracing_subscriber::layer::{Context, Layer, SubscriberExt};

use super::Times;
use super::probe::{Stopwatch, play_once};
use crate::field::{Clock, Field};
use crate::game::{Game, SPEC, spec};
use crate::robot::{Kicker, Settings};
use crate::watch::{DIAGRAM, Rescue, handlers};

/// Who listens to the robot's program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Way {
    /// Nobody.
    Nobody,
    /// A subscriber that counts: what `tracing` itself costs.
    Counted,
    /// The monitor of one property, with the state diagram that gives its events, as in the thesis.
    Property(String),
    /// All of `soccer.rv`.
    All,
}

const NOBODY: &str = "nobody";
const COUNTED: &str = "counted";
const ALL: &str = "all";

impl Way {
    /// All of them: the first is the one that the others are compared with.
    pub fn all() -> Result<Vec<Way>, String> {
        let spec = spec().map_err(|e| e.to_string())?;
        let properties = spec.alone().spec.properties.iter().map(|p| p.name.clone()).filter(|name| name != DIAGRAM);
        let fixed = [Way::Nobody, Way::Counted];
        Ok(fixed.into_iter().chain(properties.map(Way::Property)).chain([Way::All]).collect())
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        match self {
            Way::Nobody => NOBODY,
            Way::Counted => COUNTED,
            Way::Property(name) => name,
            Way::All => ALL,
        }
    }

    /// The way of that name.
    pub fn named(name: &str) -> Result<Way, String> {
        let ways = Way::all()?;
        let known = || ways.iter().map(Way::name).collect::<Vec<_>>().join(", ");
        ways.iter()
            .find(|way| way.name() == name)
            .cloned()
            .ok_or_else(|| format!("no way `{name}`: there are {}", known()))
    }

    /// The specification that it watches by.
    fn specification(&self) -> Option<String> {
        match self {
            Way::Nobody | Way::Counted => None,
            Way::Property(name) => Some(only(SPEC, name)),
            Way::All => Some(SPEC.to_owned()),
        }
    }
}

/// A specification without its properties but one, and without the reactions to the others.
fn only(text: &str, property: &str) -> String {
    let mut kept = String::new();
    let mut is_others = false;
    for line in text.lines() {
        let words: Vec<&str> = line.split([' ', ':', '{']).filter(|word| !word.is_empty()).collect();
        if !line.starts_with(' ') {
            is_others = match words[..] {
                ["property", name, ..] => name != property,
                ["on", "violation", "of", name, ..] => name != property,
                _ => false,
            };
        }
        if !is_others {
            kept.push_str(line);
            kept.push('\n');
        }
    }
    kept
}

/// Plays matches in one way, and gives what each call took. The first match is there to warm up.
pub fn play(way: &Way, matches: u64) -> Result<Times, String> {
    let stopwatch = Stopwatch::default();
    let clock = Hands::default();
    let mut monitor = None;
    for seed in 0..=matches {
        let field = Field::new(&Game { seed, ..Game::default() }.kickoff());
        clock.set(field.clock());
        let kicker = Arc::new(Kicker::new(stopwatch.brick(field), Settings::default()));
        if seed == 0 {
            monitor = listen(way, &kicker, clock.clone())?;
        }
        play_once(&kicker, &stopwatch);
        if seed == 0 {
            stopwatch.forget();
        }
    }
    let judged = monitor.map(|monitor: Monitor| monitor.finish().properties).unwrap_or_default();
    match judged.iter().find(|property| property.verdict.word() != "holds") {
        // A match with a violation has another course, and cannot be compared.
        Some(property) => Err(format!("the robot is healthy, but {} is {}", property.name, property.verdict.word())),
        None => Ok(stopwatch.times()),
    }
}

fn listen(way: &Way, kicker: &Arc<Kicker>, clock: Hands) -> Result<Option<Monitor>, String> {
    if *way == Way::Counted {
        let subscriber = tracing_subscriber::registry().with(Count(AtomicU64::new(0)));
        tracing::subscriber::set_global_default(subscriber).map_err(|e| e.to_string())?;
    }
    let Some(text) = way.specification() else { return Ok(None) };
    let spec = Spec::parse("soccer.rv", &text, &|_| None).map_err(|e| e.to_string())?;
    let builder = Monitor::builder(spec).handlers(Rescue::new(kicker.clone(), None), handlers());
    builder.clock(clock).without_waker().install().map(Some).map_err(|e| e.to_string())
}

/// The clock of the field on which is played just now. It goes back where a match begins, so that every monitor starts anew.
#[derive(Clone, Default)]
struct Hands(Arc<Mutex<Option<Clock>>>);

impl Hands {
    fn set(&self, clock: Clock) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(clock);
    }
}

impl lapwing_tracing::Clock for Hands {
    fn now(&self) -> Time {
        let clock = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        clock.as_ref().map_or(Time(0), lapwing_tracing::Clock::now)
    }
}

/// The least that a subscriber can do.
struct Count(AtomicU64);

impl<S: Subscriber> Layer<S> for Count {
    fn on_event(&self, _: &Event<'_>, _: Context<'_, S>) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn on_new_span(&self, _: &span::Attributes<'_>, _: &span::Id, _: Context<'_, S>) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_property_is_left_with_what_it_needs() {
        for way in Way::all().unwrap() {
            let Way::Property(name) = &way else { continue };
            let spec =
                Spec::parse("one.rv", &way.specification().unwrap(), &|_| None).unwrap_or_else(|e| panic!("{e}"));
            let left: Vec<String> = spec.alone().spec.properties.iter().map(|p| p.name.clone()).collect();
            assert_eq!(left, [DIAGRAM, name]);
        }
    }
}
