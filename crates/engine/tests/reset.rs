//! `reset`: the monitor of one property starts afresh, and no other.

use lapwing_check::{Checked, TraceShape, check, compile::compile, load};
use lapwing_diag::SourceMap;
use lapwing_engine::{Ending, Outcome, Program, State};
use lapwing_stream::{Sample, Time, Value, Verdict, What};

fn checked(text: &str) -> Checked {
    let mut sources = SourceMap::default();
    let file = sources.add("reset.rv", text);
    let loaded = load(&mut sources, lapwing_syntax::parse(file, text).file, &|_| None);
    let columns = vec!["p".to_owned()];
    check(&sources, &loaded, Some(&TraceShape { columns, columns_open: true, ..TraceShape::program() }))
}

/// A program with its state; events and rows come a second apart.
struct Trial {
    checked: Checked,
    program: Program,
    state: State,
    seconds: i64,
}

impl Trial {
    fn of(text: &str) -> Trial {
        let checked = checked(text);
        assert!(!checked.has_errors(), "{:?}", checked.diagnostics);
        let program = compile(&checked.spec);
        Trial { state: State::new(&program), checked, program, seconds: 0 }
    }

    fn event(&mut self, name: &str, values: &[Value]) {
        let event = self.checked.spec.events.iter().position(|e| e.name == name).expect("the event is declared");
        self.feed(What::Event { event, values });
    }

    fn row(&mut self, p: bool) {
        self.feed(What::Row { cells: &[Value::Bool(p)] });
    }

    fn feed(&mut self, what: What<'_>) {
        let time = Time(self.seconds * 1_000_000_000);
        self.state.feed(&self.program, Sample { time, what }, &mut ());
        self.seconds += 1;
    }

    fn reset(&mut self, name: &str) -> bool {
        let number = self.number(name);
        self.state.reset(&self.program, number)
    }

    fn number(&self, name: &str) -> usize {
        self.program.properties.iter().position(|p| p.name == name).expect("the property is there")
    }

    fn outcomes(&self, name: &str) -> Vec<Outcome> {
        let outcomes = self.state.clone().finish(&self.program, &Ending::default(), &mut ());
        outcomes.into_iter().filter(|o| o.property == self.number(name)).collect()
    }

    fn counts(&self, name: &str) -> (u64, u64, usize) {
        let outcome = &self.outcomes(name)[0];
        (outcome.met, outcome.failed, outcome.episodes.len())
    }
}

#[test]
fn the_past_is_forgotten_and_what_was_counted_stands() {
    let mut trial = Trial::of(
        "event ready\nevent play\nproperty init: always (play implies once ready)\n\
         property same: always (play implies once ready)\non violation of init { reset }\n",
    );
    for event in ["ready", "play"] {
        trial.event(event, &[]);
    }
    assert!(trial.reset("init"));
    trial.event("play", &[]);
    assert_eq!((trial.counts("init"), trial.counts("same")), ((2, 1, 1), (3, 0, 0)));
    trial.event("play", &[]);
    assert_eq!(trial.counts("init"), (2, 2, 1), "the same episode");
    assert!(trial.reset("init"));
    trial.event("play", &[]);
    assert_eq!(trial.counts("init"), (2, 3, 2), "another");
    assert_eq!(trial.outcomes("init")[0].verdict, Verdict::Violated);
}

#[test]
fn what_was_waited_for_is_given_up() {
    let mut trial = Trial::of(
        "event ask\nevent answer\nproperty answers: whenever ask, eventually within 2 s answer\n\
         on violation of answers { reset }\n",
    );
    trial.event("ask", &[]);
    assert_eq!(trial.state.next_deadline(&trial.program), Some(Time(2_000_000_000)));
    assert!(trial.reset("answers"));
    assert_eq!(trial.state.next_deadline(&trial.program), None);
    trial.seconds = 10;
    trial.event("ask", &[]);
    trial.event("answer", &[]);
    assert_eq!(trial.counts("answers"), (2, 0, 0));
}

#[test]
fn instants_at_which_a_property_rested_are_counted_first() {
    let mut trial = Trial::of("calm: always not p\nother: always not p\non violation of calm { reset }\n");
    [false, false, false, true].into_iter().for_each(|p| trial.row(p));
    assert!(trial.reset("calm"));
    [true, true, false].into_iter().for_each(|p| trial.row(p));
    assert_eq!(trial.counts("calm"), (4, 3, 2));
    assert_eq!(trial.counts("other"), (4, 3, 1));
}

#[test]
fn one_instance_starts_afresh_alone() {
    let mut trial = Trial::of(
        "event ready\nevent play\nproperty init: for each r of play.robot: always (play implies once ready)\n\
         on violation of init { reset }\n",
    );
    let (r1, r2) = ([Value::from("r1")], [Value::from("r2")]);
    for (event, robot) in [("ready", &r1), ("ready", &r2), ("play", &r1), ("play", &r2)] {
        trial.event(event, robot);
    }
    let number = trial.number("init");
    assert!(trial.state.reset_instance(&trial.program, number, &r1));
    trial.event("play", &r1);
    trial.event("play", &r2);
    let failed: Vec<_> = trial.outcomes("init").iter().map(|o| (o.instance.clone(), o.met, o.failed)).collect();
    assert_eq!(failed, [(r1.to_vec(), 2, 1), (r2.to_vec(), 3, 0)]);
}

#[test]
fn a_machine_stands_in_its_initial_state_again() {
    let mut trial = Trial::of(
        "event go\nevent stop\nmachine m {\n    initial idle\n    state idle on stop\n    state driving on go\n    idle -> driving\n}\n\
         on violation of m { reset }\n",
    );
    trial.event("go", &[]);
    assert!(trial.reset("m"));
    trial.event("go", &[]);
    assert_eq!(trial.counts("m"), (2, 0, 0), "from idle twice");
    trial.event("stop", &[]);
    assert_eq!(trial.counts("m"), (2, 1, 1));
}

#[test]
fn what_shares_its_positions_cannot_start_afresh_alone() {
    let mut trial = Trial::of("calm: always not p\nstill: always not p or p\n");
    trial.row(true);
    assert!(!trial.reset("calm"));
    assert_eq!(trial.counts("calm"), (0, 1, 1));
}
