//! Handlers: when they run, what they may do, and what becomes of it.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};

use lapwing_tracing::{BuildError, Handlers, ManualClock, Monitor, Time};
use tracing_subscriber::layer::SubscriberExt;

use crate::robot::kicker;
use crate::support::{Counting, alone, said, same_as_checked, spec, verdict};

/// What the program and its handlers did, in order.
#[derive(Clone, Default)]
struct Diary(Arc<Mutex<Vec<String>>>);

impl Diary {
    fn note(&self, what: impl Into<String>) {
        self.0.lock().expect("a diary").push(what.into());
    }

    fn read(&self) -> Vec<String> {
        self.0.lock().expect("a diary").clone()
    }
}

fn installed(text: &str, diary: &Diary, handlers: Handlers<Diary>) -> Monitor {
    let builder = Monitor::builder(spec(text)).handlers(diary.clone(), handlers);
    builder.clock(Counting::default()).install().expect("a monitor")
}

const INIT: &str = "event ready_true = return Kicker::ready when result == true
event play = call Kicker::play
property init over (ready_true, play): ltl([](play => <*> ready_true))
on violation of init { run plug_in_cables  reset }
";

alone! {
    fn a_handler_runs_before_the_body_and_what_it_does_is_seen() {
        let diary = Diary::default();
        let plug_in = |violation: &lapwing_tracing::Violation<'_>, diary: &Diary| {
            diary.note(format!("{violation}"));
            assert_eq!(violation.value("ready_true"), Some(&false.into()));
            kicker::ready(true);
        };
        let monitor = installed(INIT, &diary, Handlers::new().on("plug_in_cables", plug_in));
        kicker::play();
        diary.note("played");
        kicker::play();
        let report = monitor.finish();
        // As in JavaMOP, the reset forgets the `ready` that the handler brought about.
        let told = |t: u32| format!("robot.rv:3: init is violated at {t} s");
        assert_eq!(diary.read(), [told(0), "played".to_owned(), told(2)]);
        assert_eq!(said(&report, "init").reactions, ["ran plug_in_cables (2 times)", "reset (2 times)"]);
        assert_eq!(said(&report, "init").violations.len(), 2);
    }

    fn without_a_reset_the_past_counts() {
        let diary = Diary::default();
        let text = INIT.replace("  reset", "");
        let handlers = Handlers::new().on("plug_in_cables", |_, _: &Diary| _ = kicker::ready(true));
        let monitor = installed(&text, &diary, handlers);
        kicker::play();
        kicker::play();
        let report = monitor.finish();
        let lines = "{\"t\": 0, \"event\": \"play\"}\n{\"t\": 1, \"event\": \"ready_true\"}\n{\"t\": 2, \"event\": \"play\"}\n";
        same_as_checked(&report, &text, lines);
    }

    fn a_handler_that_panics_is_told_of_and_the_robot_goes_on() {
        let diary = Diary::default();
        let handlers = Handlers::new().on("plug_in_cables", |_, diary: &Diary| {
            diary.note("panics");
            panic!("no cable");
        });
        let monitor = installed(INIT, &diary, handlers);
        std::panic::set_hook(Box::new(|_| {}));
        kicker::play();
        diary.note("played");
        let report = monitor.finish();
        assert_eq!(diary.read(), ["panics", "played"]);
        assert!(report.warnings.iter().any(|w| w.message == "the handler `plug_in_cables` panicked: no cable"));
        assert_eq!(said(&report, "init").reactions, ["ran plug_in_cables", "reset"]);
    }

    fn a_failure_that_goes_on_is_one_violation() {
        let text = "event kick = call Kicker::kick
property calm: always not kick
on violation of calm { run kick_again }
";
        let calls = Arc::new(AtomicU32::new(0));
        let handlers = Handlers::new().on("kick_again", |_, calls: &Arc<AtomicU32>| {
            calls.fetch_add(1, Ordering::SeqCst);
            kicker::kick("r1", 1.0);
        });
        let builder = Monitor::builder(spec(text)).handlers(calls.clone(), handlers);
        let monitor = builder.clock(Counting::default()).install().expect("a monitor");
        kicker::kick("r1", 1.0);
        assert_eq!(calls.load(Ordering::SeqCst), 1);
        let lines = "{\"t\": 0, \"event\": \"kick\"}\n{\"t\": 1, \"event\": \"kick\"}\n";
        same_as_checked(&monitor.finish(), text, lines);
    }

    fn a_reset_makes_the_next_failure_a_violation_of_its_own() {
        let text = "event kick = call Kicker::kick
property calm: always not kick
property counted: always (kick implies not next kick)
on violation of calm { reset  run kick_again }
";
        let calls = Arc::new(AtomicU32::new(0));
        let handlers = Handlers::new().on("kick_again", |_, calls: &Arc<AtomicU32>| {
            if calls.fetch_add(1, Ordering::SeqCst) < 40 {
                kicker::kick("r1", 1.0);
            }
        });
        let builder = Monitor::builder(spec(text)).handlers(calls.clone(), handlers);
        let monitor = builder.clock(Counting::default()).install().expect("a monitor");
        kicker::kick("r1", 1.0);
        let report = monitor.finish();
        // The first kick and sixteen inside handlers inside handlers were stepped; the seventeenth was not, and so no handler followed it.
        assert_eq!(calls.load(Ordering::SeqCst), 17);
        assert_eq!(said(&report, "calm").obligations.failed, 17);
        assert_eq!(said(&report, "counted").obligations.failed, 16);
    }

    fn what_is_too_deep_is_inconclusive() {
        let text = "event kick = call Kicker::kick
event play = call Kicker::play
property calm: always not kick
property other: always (play implies not next play)
on violation of calm { reset  run go_on }
";
        let calls = Arc::new(AtomicU32::new(0));
        let handlers = Handlers::new().on("go_on", |_, calls: &Arc<AtomicU32>| {
            match calls.fetch_add(1, Ordering::SeqCst) {
                16 => kicker::play(),
                _ => kicker::kick("r1", 1.0),
            }
        });
        let builder = Monitor::builder(spec(text)).handlers(calls, handlers);
        let monitor = builder.clock(Counting::default()).install().expect("a monitor");
        kicker::kick("r1", 1.0);
        let report = monitor.finish();
        assert_eq!(verdict(&report, "other"), "inconclusive");
        let cause = said(&report, "other").cause.clone().unwrap_or_default();
        assert!(cause.contains("more than 16 deep was not seen"), "{cause}");
        assert!(report.warnings.iter().any(|w| w.message.contains("more than 16 deep")), "{:?}", report.warnings);
    }

    fn a_reaction_is_limited_for_each_instance() {
        let text = "event kick = call Kicker::kick
property calm: for each r of kick.robot: always not (kick and kick.power > 2)
on violation of calm at most every 10 s { run note  reset }
";
        let clock = ManualClock::new();
        let diary = Diary::default();
        let note = |violation: &lapwing_tracing::Violation<'_>, diary: &Diary| diary.note(violation.property());
        let builder = Monitor::builder(spec(text)).handlers(diary.clone(), Handlers::new().on("note", note));
        let monitor = builder.clock(clock.clone()).install().expect("a monitor");
        for (second, robot) in [(0, "r1"), (1, "r2"), (9, "r1"), (10, "r1"), (11, "r2")] {
            clock.set(Time(second * 1_000_000_000));
            kicker::kick(robot, 3.0);
            kicker::kick(robot, 1.0);
        }
        assert_eq!(diary.read(), ["calm[r1]", "calm[r2]", "calm[r1]", "calm[r2]"]);
        let report = monitor.finish();
        assert_eq!(said(&report, "calm[r1]").obligations.failed, 3);
    }

    fn stop_ends_the_monitoring() {
        let text = "event kick = call Kicker::kick\nevent play = call Kicker::play\nproperty calm: always not kick\n\
                    property still: always not play\non violation of calm { stop }\n";
        let diary = Diary::default();
        let monitor = installed(text, &diary, Handlers::new());
        kicker::kick("r1", 1.0);
        kicker::play();
        kicker::kick("r1", 1.0);
        assert_eq!(monitor.stopped_by().as_deref(), Some("calm"));
        let report = monitor.finish();
        assert_eq!(said(&report, "calm").obligations.failed, 1);
        assert_eq!(said(&report, "calm").reactions, ["stopped"]);
        assert_eq!(report.span.map(|(start, end)| (start.0, end.0)), Some((0, 0)));
    }

    fn a_handler_under_a_subscriber_for_a_scope_is_refused() {
        let diary = Diary::default();
        let handlers = Handlers::new().on("plug_in_cables", |_, diary: &Diary| diary.note("ran"));
        let builder = Monitor::builder(spec(INIT)).handlers(diary.clone(), handlers);
        let monitor = builder.clock(Counting::default()).build().expect("a monitor");
        let subscriber = tracing_subscriber::registry().with(monitor.layer());
        tracing::subscriber::with_default(subscriber, kicker::play);
        let report = monitor.finish();
        assert!(diary.read().is_empty());
        assert_eq!(verdict(&report, "init"), "violated");
        assert!(report.warnings.iter().any(|w| w.message.contains("install the subscriber for the whole program")));
        assert_eq!(said(&report, "init").reactions[0], "did not run plug_in_cables: a subscriber is set for a scope only");
    }

    fn other_threads_go_on_while_a_handler_runs() {
        let text = "event kick = call Kicker::kick\nevent play = call Kicker::play\nproperty calm: always not kick\n\
                    property plays: eventually play\non violation of calm { run wait }\n";
        let (begin, begun) = std::sync::mpsc::channel();
        let (end, ended) = std::sync::mpsc::channel();
        let context = (Mutex::new(begin), Mutex::new(ended));
        type Context = (Mutex<std::sync::mpsc::Sender<()>>, Mutex<std::sync::mpsc::Receiver<()>>);
        let handlers = Handlers::new().on("wait", |_, (begin, ended): &Context| {
            begin.lock().expect("a sender").send(()).expect("someone listens");
            ended.lock().expect("a receiver").recv().expect("someone ends it");
        });
        let monitor = Monitor::builder(spec(text)).handlers(context, handlers).install().expect("a monitor");
        let kicks = std::thread::spawn(|| kicker::kick("r1", 1.0));
        begun.recv().expect("the handler runs");
        // It holds no lock: this thread is heard, and returns, while the handler waits for it.
        kicker::play();
        end.send(()).expect("the handler waits");
        kicks.join().expect("the other thread");
        assert_eq!(verdict(&monitor.finish(), "plays"), "satisfied");
    }
}

#[test]
fn a_handler_that_nobody_registered_is_an_error_with_its_place() {
    let handlers = Handlers::new().on("plug_in_cable", |_, (): &()| {});
    let error = Monitor::builder(spec(INIT)).handlers((), handlers).build().expect_err("no such handler");
    assert_eq!(
        error.to_string(),
        "robot.rv:4: no handler `plug_in_cables` is registered; did you mean `plug_in_cable`?"
    );
    assert!(matches!(error, BuildError::MissingHandlers(missing) if missing.len() == 1));
    let told = |handlers| {
        let built = Monitor::builder(spec(INIT)).handlers((), handlers).build();
        built.expect_err("no such handler").to_string()
    };
    let other = Handlers::new().on("kick", |_, (): &()| {});
    assert_eq!(told(other), "robot.rv:4: no handler `plug_in_cables` is registered; those that are: `kick`");
    assert_eq!(told(Handlers::new()), "robot.rv:4: no handler `plug_in_cables` is registered, nor any other");
}

#[test]
fn a_handler_that_no_reaction_calls_is_told_of() {
    let handlers = Handlers::new().on("plug_in_cables", |_, (): &()| {}).on("kick", |_, (): &()| {});
    let monitor = Monitor::builder(spec(INIT)).handlers((), handlers).build().expect("a monitor");
    let warnings: Vec<String> = monitor.finish().warnings.into_iter().map(|w| w.message).collect();
    assert_eq!(warnings, ["no reaction of robot.rv runs what is registered as `kick`"]);
}

/// By the machine's clock it is some second of 2026, of which nobody wants to know.
#[test]
fn a_violation_is_told_with_the_time_since_the_first_arrival() {
    let told = Arc::new(Mutex::new(Vec::new()));
    let tell = told.clone();
    let note =
        move |violation: &lapwing_tracing::Violation<'_>| tell.lock().expect("a list").push(violation.to_string());
    let clock = ManualClock::new();
    let text = "event kick\nproperty calm: always not (kick and kick.power > 2)\n";
    let builder = Monitor::builder(spec(text)).clock(clock.clone()).on_violation(note);
    let monitor = builder.build().expect("a monitor");
    for (nanos, power) in [(1_795_409_415_000_000_000, 1.0), (1_795_409_418_500_000_000, 3.0)] {
        clock.set(Time(nanos));
        monitor.event_with("kick", &[("power", power.into())]);
    }
    assert_eq!(*told.lock().expect("a list"), ["robot.rv:2: calm is violated at 3.5 s"]);
}
