//! What an instance under `for each` over values takes: few bytes, and nothing of the events of others.

mod support;

use std::ops::Range;

use allocation_counter::measure;
use lapwing_check::checked::Step;
use lapwing_check::{TraceShape, check, compile::compile, load};
use lapwing_diag::SourceMap;
use lapwing_engine::{Ending, Outcome, Program, State};
use lapwing_stream::{Sample, Time, Value, What};

/// When it begins.
const START: i64 = 1_700_000_000_000_000_000;

/// The six properties of the soccer robot, for each of many.
const SOCCER: &str = "
property init over (ready, play): for each r of play.robot: ltl([](play => <*> ready))
property front_until_kick over (turned, lost, kick): for each r of turned.robot: ltl([](turned => o(! lost U kick)))
property close_at_kick over (kick, close): for each r of kick.robot: ltl([](kick => (*) close))
property always_ir over (blind, play): for each r of play.robot: ltl([] ! blind)
property goes_until_in_range over (dribble, turned, arrive): for each r of dribble.robot: \
    ltl([](dribble => o((dribble or turned) U arrive)))
property kicks over (kicking, kick, over): for each r of over.robot: ltl([](over => (<*> kicking and <*> kick)))
";

const EVENTS: [&str; 11] =
    ["ready", "play", "turned", "lost", "kick", "close", "blind", "dribble", "arrive", "kicking", "over"];

/// What one robot does: nothing is violated.
const MATCH: [&str; 20] = [
    "ready", "play", "turned", "close", "kick", "dribble", "turned", "dribble", "arrive", "close", "kick", "kicking",
    "over", "ready", "play", "dribble", "arrive", "turned", "close", "kick",
];

/// A program, and the numbers of its events.
struct Many {
    program: Program,
    /// The names of the events and of the fields that are read of them.
    names: Vec<(String, Vec<String>)>,
    /// The columns that are read, by their numbers among all.
    columns: Vec<usize>,
}

/// The signals that there are beside the events.
const COLUMNS: [&str; 2] = ["battery", "stopped"];

impl Many {
    fn of(text: &str) -> Many {
        let declared: String = EVENTS.iter().map(|event| format!("event {event}\n")).collect();
        let text = format!("{declared}{text}");
        let mut sources = SourceMap::default();
        let file = sources.add("test.rv", &*text);
        let loaded = load(&mut sources, lapwing_syntax::parse(file, &text).file, &|_| None);
        let events = EVENTS.map(String::from).to_vec();
        let columns = COLUMNS.map(String::from).to_vec();
        let shape = TraceShape { schemaless: true, events, columns, ..TraceShape::default() };
        let checked = check(&sources, &loaded, Some(&shape));
        assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
        let first = |path: &[Step]| {
            path.first().map_or(String::new(), |step| match step {
                Step::Field(name) => name.to_string(),
                _ => String::new(),
            })
        };
        let names = checked
            .spec
            .events
            .iter()
            .map(|event| (event.name.clone(), event.fields.iter().map(|field| first(&field.path)).collect()))
            .collect();
        let columns = checked.spec.columns.iter().filter_map(|name| COLUMNS.iter().position(|known| known == name));
        Many { program: compile(&checked.spec), names, columns: columns.collect() }
    }

    /// A row: a value for each of the [`COLUMNS`].
    fn row(&self, state: &mut State, at: i64, values: [Value; 2]) {
        let cells: Vec<Value> = self.columns.iter().map(|&column| values[column].clone()).collect();
        state.feed(&self.program, Sample { time: Time(at), what: What::Row { cells: &cells } }, &mut ());
        state.next_deadline(&self.program);
    }

    /// An event with these fields, if anything reads it.
    fn tell(&self, state: &mut State, at: i64, name: &str, fields: &[(&str, Value)]) {
        let Some(event) = self.names.iter().position(|(known, _)| known == name) else { return };
        let value = |name: &String| fields.iter().find(|(n, _)| n == name).map(|(_, v)| v.clone()).unwrap_or_default();
        let values: Vec<Value> = self.names[event].1.iter().map(value).collect();
        state.feed(&self.program, Sample { time: Time(at), what: What::Event { event, values: &values } }, &mut ());
        state.next_deadline(&self.program);
    }

    /// Each of the robots plays a match, step by step.
    fn play(&self, state: &mut State, start: i64, robots: Range<u32>) {
        for (step, name) in MATCH.iter().enumerate() {
            for robot in robots.clone() {
                self.tell(
                    state,
                    start + step as i64 * 1_000_000_000 + i64::from(robot) * 1_000,
                    name,
                    &[("robot", f64::from(robot).into())],
                );
            }
        }
    }
}

/// What an instance takes, after each has played.
fn bytes_an_instance(text: &str, robots: u32) -> i64 {
    let many = Many::of(text);
    let mut state = State::new(&many.program);
    many.row(&mut state, START - 1, [90.0.into(), false.into()]);
    many.play(&mut state, START, 0..1);
    let taken = measure(|| many.play(&mut state, START + 60_000_000_000, 1..robots + 1)).bytes_current;
    let outcomes: Vec<Outcome> = state.finish(&many.program, &Ending::default(), &mut ());
    for outcome in &outcomes {
        assert!(outcome.failed == 0 && outcome.cause.is_none() && outcome.positions > 1, "{outcome:?}");
    }
    let instances = outcomes.len() as i64;
    assert_eq!(instances, many.program.properties.len() as i64 * (i64::from(robots) + 1));
    taken / (instances - many.program.properties.len() as i64)
}

#[test]
fn a_thousand_robots_take_less_than_three_hundred_bytes_a_property_each() {
    let all = bytes_an_instance(SOCCER, 1_000);
    assert!(all < 300, "{all} bytes an instance");
    for property in SOCCER.trim().split("\nproperty ").map(|text| text.trim_start_matches("property ")) {
        let bytes = bytes_an_instance(&format!("property {property}\n"), 1_000);
        assert!(bytes < 300, "{bytes} bytes an instance: {property}");
    }
}

/// Formulas over two events with a field; some keep more than can be packed.
const FORMULAS: [&str; 8] = [
    "always (play implies once ready)",
    "always (play implies ready.power < 5 or once within 3 s ready)",
    "always (ready implies eventually within 2 s play)",
    "always (ready implies next (ready or play))",
    "always (play implies count(ready, 1000 s) < 60)",
    "always (ready implies ready.power <= max_over(ready.power, 1000 s) or @{ready.word, -3} == \"a word\")",
    "after_until ready and ready.power > 4, play, always ready.word != \"b\"",
    "ltl([] (ready => (ready.power > 2 or play) U play))",
];

/// What a robot does: when, what, which of them, and with which power and word.
type Chance = (i64, &'static str, u32, [Value; 2]);

/// What robots do by chance.
fn chances() -> Vec<Chance> {
    let mut next = support::chance(7);
    let mut clock = support::clock(7);
    let one = |_| {
        let word = ["a word", "b", "a word that is longer than others"][next() as usize % 3];
        let values = [Value::Num((next() % 8) as f64), Value::from(word)];
        (clock() * 100, ["ready", "play"][next() as usize % 2], next() as u32 % 4, values)
    };
    (0..1500).map(one).collect()
}

/// A robot does something.
fn act(many: &Many, state: &mut State, (at, name, robot, [power, word]): Chance) {
    many.tell(state, at, name, &[("robot", f64::from(robot).into()), ("power", power), ("word", word)]);
}

/// The outcomes of a text, what comes of each chance being told by `tell`. Saved and resumed now and then.
fn outcomes_of(text: &str, mut tell: impl FnMut(&Many, &mut State, usize, Chance)) -> Vec<Outcome> {
    let many = Many::of(text);
    let mut state = State::new(&many.program);
    for (n, chance) in chances().into_iter().enumerate() {
        tell(&many, &mut state, n, chance);
        if n % 50 == 49 {
            state = State::resume(&many.program, &state.save(&many.program)).unwrap_or_else(|e| panic!("{e}"));
        }
    }
    let last = chances().last().map_or(0, |last| last.0);
    state.feed(&many.program, Sample { time: Time(last), what: What::Other }, &mut ());
    state.finish(&many.program, &Ending::default(), &mut ())
}

/// Each of the four instances has the outcome of its robot alone; one of them has more positions than that.
fn fare_alone(formula: &str, together: Vec<Outcome>, positions: u64, alone: impl Fn(u32) -> Vec<Outcome>) {
    assert_eq!(together.len(), 4, "{formula}");
    assert!(together.iter().any(|outcome| outcome.positions > positions), "{formula}");
    for mut outcome in together {
        let [Value::Num(robot)] = outcome.instance[..] else { panic!("{outcome:?}") };
        outcome.instance.clear();
        assert_eq!(alone(robot as u32), [outcome], "{formula}");
    }
}

/// The outcomes of a text; where one robot is named, only what it does counts.
fn outcomes(text: &str, only: Option<u32>) -> Vec<Outcome> {
    outcomes_of(text, |many, state, _, chance| {
        if only.is_none_or(|only| only == chance.2) {
            act(many, state, chance);
        }
    })
}

#[test]
fn an_instance_fares_as_if_there_were_no_others() {
    for formula in FORMULAS {
        let together =
            outcomes(&format!("property all over (ready, play): for each r of ready.robot: {formula}\n"), None);
        fare_alone(formula, together, 300, |robot| {
            outcomes(&format!("property all over (ready, play): {formula}\n"), Some(robot))
        });
    }
}

/// What reads signals beside the events of its instances.
const WITH_SIGNALS: &str = "\
property charged: for each r of play.robot: always (play implies battery > 20)
property prepared: for each r of play.robot: whenever play, once ready and not stopped
property arrives: for each r of dribble.robot: whenever dribble, eventually (arrive or turned or battery < 10)
property stands: for each r of kick.robot: after kick, always (battery > 20 or not stopped)
";

#[test]
fn instances_that_read_signals_take_as_little() {
    let all = bytes_an_instance(WITH_SIGNALS, 1_000);
    assert!(all < 300, "{all} bytes an instance");
    for property in WITH_SIGNALS.lines() {
        let bytes = bytes_an_instance(property, 1_000);
        assert!(bytes < 300, "{bytes} bytes an instance: {property}");
    }
}

/// Formulas over two events with a field and two signals; of some no instance ever lies still.
const FORMULAS_WITH_SIGNALS: [&str; 18] = [
    "always (play implies battery > 4)",
    "always (battery > 1 or once within 3 s ready)",
    "always (ready.power < 5 implies previously (play or stopped))",
    "whenever ready and battery > 3, eventually within 2 s (play or stopped)",
    "always (ready implies next (ready or battery > 2))",
    "eventually within 4 s (play and delta(battery) >= 0)",
    "always (play implies max_over(battery, 3 s) > 5)",
    "after_until ready and ready.power > 4, play, always (battery > 0 or ready.word != \"b\")",
    "always (@{ready.power, -2} > 3 implies battery > 2 or stopped)",
    "always (becomes (not ready) implies battery != 7 since within 5 s play)",
    "always (ready implies once within 2 s battery > 4)",
    "always (play implies (battery > 2 since within 4 s ready) or stopped)",
    "whenever play, battery > 1 or ready",
    "while stopped, eventually within 3 s (ready or battery < 8)",
    "always 2 > 1",
    "whenever ready, not play until within [1 s, 9 s] (stopped and battery > 6)",
    "whenever ready, (eventually within 6 s (play and stopped)) and (eventually battery > 7)",
    "whenever play, eventually within [2 s, 60 s] (ready and battery < 3)",
];

/// The outcomes of a text where signals come between what robots do; where one robot is named, what the others do are instants at which nothing comes.
fn outcomes_with_signals(text: &str, only: Option<u32>) -> Vec<Outcome> {
    let mut next = support::chance(11);
    outcomes_of(text, |many, state, n, chance| {
        let at = chance.0;
        // What robots do begins later than what signals do.
        for early in 0..if n == 0 { 3 } else { 0 } {
            many.row(state, at - 3 + early, [Value::Missing, Value::Missing]);
        }
        if n < 2 || next().is_multiple_of(5) {
            let kept = |next: &mut dyn FnMut() -> u64, value: Value| {
                if n > 2 && next().is_multiple_of(2) { Value::Missing } else { value }
            };
            let (battery, stopped) = ((next() % 9) as f64, next().is_multiple_of(3));
            let battery = if n > 2 && next().is_multiple_of(16) { f64::NAN } else { battery };
            let cells = [kept(&mut next, battery.into()), kept(&mut next, stopped.into())];
            many.row(state, at, cells);
        }
        if only.is_none_or(|only| only == chance.2) {
            act(many, state, chance);
        } else {
            many.row(state, at, [Value::Missing, Value::Missing]);
        }
    })
}

#[test]
fn an_instance_that_reads_signals_fares_as_if_there_were_no_others() {
    for formula in FORMULAS_WITH_SIGNALS {
        let together = outcomes_with_signals(&format!("property all: for each r of ready.robot: {formula}\n"), None);
        fare_alone(formula, together, 1_000, |robot| {
            outcomes_with_signals(&format!("property all: {formula}\n"), Some(robot))
        });
    }
}

/// Properties of which every robot has an obligation open once it has dribbled.
const WAITING: [&str; 4] = [
    "whenever dribble, eventually (arrive and not stopped)",
    "whenever dribble, eventually within 1000 s (arrive or battery < 10)",
    "whenever dribble, not turned until battery < 10",
    "whenever dribble, always within 1000 s battery > 10",
];

/// How many bytes of the state another instant changes, at which nothing comes, while so many robots wait for something.
fn changed_by_an_instant(formula: &str, robots: u32) -> usize {
    let many = Many::of(&format!("property waits: for each r of dribble.robot: {formula}\n"));
    let mut state = State::new(&many.program);
    many.row(&mut state, START, [90.0.into(), false.into()]);
    for robot in 0..robots {
        many.tell(&mut state, START + i64::from(robot), "dribble", &[("robot", f64::from(robot).into())]);
    }
    let mut instant = |at: i64| {
        many.row(&mut state, START + 1_000_000 + at, [Value::Missing, Value::Missing]);
        state.save(&many.program)
    };
    let [_, _, before, after] = [1, 2, 3, 4].map(&mut instant);
    assert_eq!(before.len(), after.len(), "{formula}");
    let outcomes = state.finish(&many.program, &Ending::default(), &mut ());
    assert!(outcomes.iter().all(|outcome| outcome.open == 1 && outcome.failed == 0), "{:?}", outcomes[0]);
    before.iter().zip(&after).filter(|(before, after)| before != after).count()
}

#[test]
fn an_instant_does_not_touch_those_that_wait() {
    for formula in WAITING {
        let (few, many) = (changed_by_an_instant(formula, 10), changed_by_an_instant(formula, 300));
        assert!(many < few + 10, "{many} bytes of 300 instances change, and {few} of 10: {formula}");
    }
}
