//! Programs without `tracing` say what happens themselves.

use lapwing_tracing::{Handlers, Monitor};

use crate::support::{Counting, counting, same_as_checked, spec, verdict};

const TEXT: &str = "event kick
event play = call Kicker::play
decl range /range Range.range
property close: whenever kick, sonar < 0.1
property soft: always not (kick and kick.power > 2)
property plays: always not play
property ranged: always range < 3
";

#[test]
fn events_and_values_are_told_by_name() {
    let monitor = counting(TEXT).build().expect("a monitor");
    monitor.set_all(&[("sonar", 0.07.into()), ("range", 1.0.into())]);
    monitor.event_with("kick", &[("power", 1.5.into()), ("unread", "x".into())]);
    monitor.set("sonar", 0.5);
    monitor.event_with("kick", &[("power", 3.0.into())]);
    monitor.event("play");
    monitor.set("range", 4.0);
    let lines = "{\"t\": 0, \"values\": {\"sonar\": 0.07, \"range\": 1.0}}\n{\"t\": 1, \"event\": \"kick\", \"power\": 1.5}\n\
                 {\"t\": 2, \"values\": {\"sonar\": 0.5}}\n{\"t\": 3, \"event\": \"kick\", \"power\": 3.0}\n\
                 {\"t\": 4, \"event\": \"play\"}\n{\"t\": 5, \"values\": {\"range\": 4.0}}\n";
    let report = monitor.finish();
    for property in ["close", "soft", "plays", "ranged"] {
        assert_eq!(verdict(&report, property), "violated", "{property}");
    }
    same_as_checked(&report, TEXT, lines);
}

#[test]
fn names_that_the_specification_does_not_know_are_told() {
    let monitor = counting("event kick\nalways not kick\n").build().expect("a monitor");
    monitor.event("kik");
    monitor.set("sonar", 1.0);
    monitor.event("kick");
    let warnings = monitor.finish().warnings;
    assert!(warnings.iter().any(|w| w.message.ends_with("does not read: `kik`, `sonar`")), "{warnings:?}");
}

#[test]
fn a_handler_of_a_told_event_runs_before_the_telling_returns() {
    let text = "event kick\nproperty calm: always not kick\non violation of calm { run aim  publish /stop std_msgs/Bool { data: true } }\n";
    let (aimed, aims) = std::sync::mpsc::channel();
    let aimed = std::sync::Mutex::new(aimed);
    let handlers = Handlers::new().on("aim", |violation, aimed: &std::sync::Mutex<std::sync::mpsc::Sender<String>>| {
        aimed.lock().expect("a sender").send(violation.property().to_owned()).expect("someone listens");
    });
    let builder = Monitor::builder(spec(text)).handlers(aimed, handlers).clock(Counting::default());
    let monitor = builder.build().expect("a monitor");
    monitor.event("kick");
    assert_eq!(aims.try_recv().as_deref(), Ok("calm"));
    let reactions = &monitor.finish().properties[0].reactions;
    assert_eq!(reactions[0], "ran aim");
    assert!(reactions[1].starts_with("did not publish /stop std_msgs/Bool"), "{reactions:?}");
}

#[test]
fn of_many_warnings_the_first_are_kept_and_all_of_the_report_itself() {
    struct Full;
    impl std::io::Write for Full {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(std::io::Error::other("the disk is full"))
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let text = "event kick\nproperty calm: always not kick\non violation of calm { run aim  reset }\n";
    // A resumed panic prints nothing.
    let handlers = Handlers::new().on("aim", |_, count: &std::sync::atomic::AtomicU32| {
        let number = count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        std::panic::resume_unwind(Box::new(format!("no cable {number}")));
    });
    let builder = Monitor::builder(spec(text)).handlers(std::sync::atomic::AtomicU32::new(0), handlers);
    let monitor = builder.clock(Counting::default()).record(Full).build().expect("a monitor");
    (0..100).for_each(|_| monitor.event("kick"));
    monitor.event("kik");
    let messages: Vec<String> = monitor.finish().warnings.into_iter().map(|w| w.message).collect();
    assert_eq!(messages.iter().filter(|m| m.contains("panicked: no cable")).count(), 64);
    let [.., more, recorded, unknown] = messages.as_slice() else { panic!("{messages:?}") };
    assert_eq!(more, "there were more than 64 such warnings; the others are not listed");
    assert_eq!(recorded, "not everything that arrived was recorded: the disk is full");
    assert!(unknown.ends_with("does not read: `kik`"), "{unknown}");
}

#[test]
fn what_a_program_cannot_have_is_inconclusive() {
    let text = "event scan = message /scan\nevent asked = request /set_mode\nevent kick\n\
                property a over (scan, kick): always not scan\nproperty b over (asked, kick): always not asked\n";
    let monitor = counting(text).build().expect("a monitor");
    monitor.event("kick");
    let report = monitor.finish();
    assert_eq!((verdict(&report, "a"), verdict(&report, "b")), ("inconclusive", "inconclusive"));
    let cause = report.properties[1].cause.clone().unwrap_or_default();
    assert_eq!(cause, "a program has no such events: `asked` is `request /set_mode`");
}

#[test]
fn the_same_report_is_given_again_and_nothing_counts_after_it() {
    let monitor = counting("event kick\nproperty calm: always not kick\n").build().expect("a monitor");
    monitor.event("kick");
    let report = monitor.finish();
    monitor.event("kick");
    assert_eq!(monitor.finish(), report);
}
