//! The engine under the control of a caller: events, violations, variables, and how it answers what is not possible.

mod support;

use lapwing_bip::{
    Detail, Engine, Event, Fault, Host, Log, MoveId, Options, Policy, Registry, Rules, Run, Simulated, Sink, Standing,
    Time, Value, Violation,
};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use support::model;

/// An atom whose work is done elsewhere: it begins, and later an event says that it is over.
fn worker(policy: &str) -> String {
    format!(
        "package p
port type Go()
port type Done(int result)
connector type Single(Go p) define p end
atom type Worker()
  data int result
  clock x unit millisecond
  export port Go begin(), next()
  extern port Done done(result) {policy}
  place idle, busy, test
  initial to idle
  on begin from idle to busy eager do {{ x = 0; }}
  on done from busy to test eager resume (x <= 5)
  on next from test to idle provided (result > 0) eager
end
compound type Top()
  component Worker W()
  connector Single begin(W.begin), next(W.next)
end
end"
    )
}

/// The first move on offer, made at its first moment.
fn step<H: Host>(engine: &mut Engine<H>) -> String {
    assert_eq!(engine.look(), Ok(Standing::Open));
    let offer = engine.offers()[0];
    let shown = engine.show_move(offer.id);
    engine.make(offer.id, Time(offer.window.first)).unwrap_or_else(|f| panic!("{shown}: {f}"));
    shown
}

#[test]
fn the_end_of_work_is_an_event() {
    let mut engine = support::engine(&worker("remember"));
    assert_eq!(step(&mut engine), "ROOT.begin: W.begin()");
    assert_eq!(engine.settle(engine.now(), 0), Ok(vec![]));
    assert_eq!(engine.look(), Ok(Standing::Deadlock), "but an event may come");
    assert!(engine.awaits_events());
    let done = engine.model().external("ROOT.W.done").expect("the port");
    engine.notify(done, &[Value::Int(7)], Time(3_000_000)).expect("the event is taken");
    assert_eq!(step(&mut engine), "ROOT.W.done");
    assert_eq!(engine.now(), Time(3_000_000));
    assert!(engine.is_unsettled());
    assert_eq!(engine.look(), Ok(Standing::Deadlock), "the action has not been carried out yet");
    assert_eq!(engine.settle(Time(4_000_000), 0), Ok(vec![]));
    assert_eq!(engine.now(), Time(4_000_000));
    assert_eq!(engine.variable(0, "result"), Some(Value::Int(7)));
    assert_eq!(engine.places(0), ["test"]);
    assert_eq!(step(&mut engine), "ROOT.next: W.next()");
}

#[test]
fn work_that_took_too_long_is_named() {
    let mut engine = support::engine(&worker("remember"));
    step(&mut engine);
    let done = engine.model().external("ROOT.W.done").expect("the port");
    engine.notify(done, &[Value::Int(1)], Time(6_000_000)).expect("the event is taken");
    step(&mut engine);
    let violations = engine.settle(Time(6_500_000), 0).expect("it goes on");
    assert!(matches!(violations[..], [Violation::Resume { atom: 0, .. }]), "{violations:?}");
    assert_eq!(engine.show_violation(&violations[0]), "ROOT.W resume [ -INFTY, 5ms ]");
    assert_eq!(engine.violator(&violations[0]), "ROOT.W");
}

#[test]
fn events_that_nobody_waits_for() {
    let early = |policy: &str| {
        let mut engine = support::engine(&worker(policy));
        let done = engine.model().external("ROOT.W.done").expect("the port");
        let answer = engine.notify(done, &[Value::Int(1)], Time(1_000_000));
        step(&mut engine);
        answer.map(|()| {
            engine.look().expect("a state");
            engine.offers().len()
        })
    };
    assert_eq!(early("remember"), Ok(1), "it is taken when the atom waits for it");
    assert_eq!(early("ignore"), Ok(0));
    let fault = early("error").err();
    assert_eq!(fault, Some(Fault::UnexpectedEvent { port: "ROOT.W.done".to_owned(), at: Time(1_000_000) }));
    assert_eq!(fault.map(|f| f.code()), Some(6));
}

#[test]
fn events_that_are_kept_are_bounded() {
    let mut engine = support::engine(&worker("remember"));
    let done = engine.model().external("ROOT.W.done").expect("the port");
    let answers = (0..100_000).map(|n| engine.notify(done, &[], Time(n)));
    let refused = answers.filter_map(Result::err).next();
    assert_eq!(refused, Some(Fault::TooManyEvents { port: "ROOT.W.done".to_owned() }));
}

#[test]
fn events_come_into_a_run() {
    let model = model("worker", &worker("remember"));
    let port = model.external("ROOT.W.done").expect("the port");
    let event = |ms: i64, value| Event { port, values: vec![Value::Int(value)], at: Time(ms * 1_000_000) };
    let world = Simulated::with_events(vec![event(30, 1), event(10, 1), event(50, -1)]);
    let buffer = Rc::new(RefCell::new(Vec::new()));
    let sink: Sink<'_> = buffer.clone();
    let host = Registry::default().bind(&model).expect("no functions");
    let ending =
        Run::new(Options::default(), world, Log::new(sink, Detail::Verbose)).policy(Policy::Warn).run(model, host);
    let log = String::from_utf8_lossy(&buffer.borrow()).into_owned();
    assert_eq!(ending.code(), 0);
    for at in ["10ms", "30ms", "50ms"] {
        assert!(log.contains(&format!("-> choose [0] ROOT.W.done at global time {at}")), "{log}");
    }
    assert!(log.contains("1 external port:"), "{log}");
    assert!(
        log.contains("WARNING: state #2 and global time 10ms: violation of the following timing constraint ROOT.W:"),
        "{log}"
    );
    assert!(log.ends_with("state #8 and global time 50ms: deadlock!\n"), "{log}");
}

#[test]
fn somebody_may_react_to_violations() {
    let text = worker("remember");
    let model = model("worker", &text);
    let port = model.external("ROOT.W.done").expect("the port");
    let world = Simulated::with_events(vec![Event { port, values: vec![Value::Int(1)], at: Time(9_000_000) }]);
    let mut seen = Vec::new();
    let mut react = |engine: &mut Engine<lapwing_bip::Bound<'static>>, violation: &Violation, at: Time| {
        seen.push((engine.show_violation(violation), at));
        false
    };
    let sink: Sink<'_> = Rc::new(RefCell::new(std::io::sink()));
    let host = Registry::default().bind(&model).expect("no functions");
    let ending = Run::new(Options::default(), world, Log::new(sink, Detail::Silent))
        .policy(Policy::React(&mut react))
        .run(model, host);
    assert_eq!(ending.code(), 7);
    assert_eq!(seen, [("ROOT.W resume [ -INFTY, 5ms ]".to_owned(), Time(9_000_000))]);
}

#[test]
fn moves_that_are_not_on_offer_are_refused() {
    let mut engine = support::engine(&worker("remember"));
    engine.look().expect("a state");
    let offer = engine.offers()[0];
    assert_eq!(engine.make(offer.id, Time(-1)), Err(Fault::NotOffered));
    assert_eq!(engine.make(offer.id, Time(0)), Ok(()));
    assert_eq!(engine.make(offer.id, Time(0)), Err(Fault::NotOffered), "only once");
}

#[test]
fn a_function_may_change_what_it_is_given() {
    let text = "package p
extern function int next(int, const int)
extern data type blob
extern operator bool ==(blob, blob)
extern function blob make(int)
atom type A()
  data int i = 3, step = 2, r
  data blob one, other
  data bool same
  place a
  initial to a do { r = next(i, step); one = make(1); other = make(2); same = one == other; }
end
compound type Top() component A a() end
end";
    let model = model("functions", text);
    let host = Registry::default()
        .with("next", |args| match args {
            [Value::Int(i), Value::Int(step)] => {
                *i += *step;
                *step = 99;
                Ok(Value::Int(*i * 10))
            }
            _ => Err("two numbers".to_owned()),
        })
        .with("make", |args| Ok(Value::opaque(args[0].as_int().unwrap_or(0))))
        .with("==", |args| Ok(Value::Bool(args[0].as_opaque::<i64>() < args[1].as_opaque::<i64>())))
        .bind(&model)
        .unwrap_or_else(|d| panic!("{d:?}"));
    let engine = Engine::new(model, host, Rules::default()).unwrap_or_else(|f| panic!("{f}"));
    let values = ["i", "step", "r", "same"].map(|name| engine.variable(0, name));
    assert_eq!(values, [Value::Int(5), Value::Int(2), Value::Int(50), Value::Bool(true)].map(Some));
    assert_eq!(engine.variable(0, "one").as_ref().and_then(Value::as_opaque), Some(&1_i64));
}

#[test]
fn a_function_that_fails_ends_the_run() {
    let text = "package p extern function fail() atom type A() place a initial to a do { fail(); } end
compound type Top() component A a() end end";
    let model = model("functions", text);
    let host = Registry::default().with("fail", |_| Err("no laser".to_owned())).bind(&model);
    let fault = Engine::new(model, host.unwrap_or_else(|d| panic!("{d:?}")), Rules::default()).err();
    assert!(matches!(&fault, Some(Fault::Computation { whose, what, .. }) if whose == "ROOT.a" && what == "no laser"));
    assert_eq!(fault.map(|f| f.code()), Some(8));
}

#[test]
fn what_a_model_is_made_of() {
    let model = model("worker", &worker("remember"));
    assert_eq!(model.atoms().iter().map(|a| a.path.as_str()).collect::<Vec<_>>(), ["ROOT.W"]);
    assert_eq!((model.atom("ROOT.W"), model.atom("ROOT.V"), model.interactions()), (Some(0), None, 2));
    assert!(model.external("ROOT.W.begin").is_none() && model.external("done").is_none());
}

#[test]
fn an_engine_can_go_to_another_thread() {
    fn is_send<T: Send>(_: &T) {}
    struct Silent;
    impl Host for Silent {
        fn call(&mut self, _: u32, _: &mut [Value], _: Option<u32>) -> Result<Value, String> {
            Ok(Value::Unset)
        }
    }
    let model: Arc<lapwing_bip::Model> = model("worker", &worker("remember"));
    let engine = Engine::new(model, Silent, Rules::default()).unwrap_or_else(|f| panic!("{f}"));
    is_send(&engine);
    let _: Option<MoveId> = engine.offers().first().map(|o| o.id);
}
