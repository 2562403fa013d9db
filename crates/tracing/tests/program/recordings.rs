//! What a monitor writes down is checked again, by the same specification, with the same verdicts.

use std::io::{self, Write};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use lapwing_tracing::{Handlers, ManualClock, Monitor, Report, Time, Value};

use crate::robot::{kicker, sensor_controller};
use crate::support::{Counting, alone, checked, counting, properties, said, spec, verdict};

/// A file in memory.
#[derive(Clone, Default)]
struct Memory(Arc<Mutex<Vec<u8>>>);

impl Memory {
    fn text(&self) -> String {
        String::from_utf8(self.0.lock().expect("a memory").clone()).expect("text")
    }
}

impl Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().expect("a memory").extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A file on a disk that is full.
struct Full;

impl Write for Full {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(io::Error::other("the disk is full"))
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

const TEXT: &str = "event ready_true = return Kicker::ready when result == true
event play = call Kicker::play
event kick = call Kicker::kick when robot == \"a \\\"b\\\"\"
event inner = set SensorController.sonar below Kicker::ball_in_front
property init over (ready_true, play): ltl([](play => <*> ready_true))
property sonar_is_sound: never isnan(sonar)
property soft: for each r of kick.robot: always not (kick and kick.power > 2)
property hears over (inner, kick): whenever kick, previously inner
property bounded: whenever inner, eventually within 2 s kick
";

/// A specification without its reactions: a check carries none out.
fn plain(text: &str) -> String {
    text.lines().filter(|line| !line.starts_with("on violation")).map(|line| format!("{line}\n")).collect()
}

fn same_again(report: &Report, memory: &Memory) {
    assert_eq!(properties(report), properties(&checked(TEXT, &memory.text())));
}

alone! {
    fn a_run_is_judged_again_from_what_was_recorded() {
        let memory = Memory::default();
        let monitor = counting(TEXT).record(memory.clone()).install().expect("a monitor");
        kicker::play();
        kicker::ready(false);
        kicker::ready(true);
        kicker::ball_in_front(|| sensor_controller::set_sonar(0.5));
        kicker::kick("a \"b\"", 3.0);
        kicker::kick("other", 1.0);
        sensor_controller::set_sonar(f64::NAN);
        sensor_controller::set_sonar(f64::INFINITY);
        kicker::ball_in_front(|| sensor_controller::set_sonar(1e-9));
        let report = monitor.finish();
        assert_eq!((verdict(&report, "init"), verdict(&report, "sonar_is_sound")), ("violated", "violated"));
        same_again(&report, &memory);
        let lines = memory.text();
        assert!(lines.starts_with("{\"t_ns\":0,\"event\":\"play\"}\n{\"t_ns\":1000000000,\"event\":\"ready_true\",\"result\":false}\n"));
    }

    fn a_writer_that_raises_events_itself_does_no_harm() {
        struct Loud;
        impl Write for Loud {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                kicker::play();
                Ok(bytes.len())
            }

            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let monitor = counting(TEXT).record(Loud).install().expect("a monitor");
        kicker::ready(true);
        kicker::play();
        let report = monitor.finish();
        assert_eq!(verdict(&report, "init"), "holds");
        assert!(report.warnings.iter().any(|w| w.message.starts_with("what the clock or the writer")));
    }

    fn a_field_of_a_field_has_one_name_at_call_sites_told_and_recorded() {
        let text = "event kick\nproperty near: always not (kick and kick.pose.x > 2)\n";
        let memory = Memory::default();
        let monitor = counting(text).record(memory.clone()).install().expect("a monitor");
        tracing::event!(name: "kick", tracing::Level::INFO, pose.x = 3.0, pose.y = 0.0);
        monitor.event_with("kick", &[("pose.x", 1.0.into())]);
        monitor.event_with("kick", &[("pose.x", 4.0.into())]);
        let report = monitor.finish();
        assert_eq!(said(&report, "near").obligations.failed, 2);
        let lines = memory.text();
        assert!(lines.starts_with("{\"t_ns\":0,\"event\":\"kick\",\"pose.x\":3.0}"), "{lines}");
        assert_eq!(properties(&report), properties(&checked(text, &lines)));
    }

    fn arrays_and_records_are_recorded_whole() {
        let text = "event kick\nproperty first: always not (kick and kick.gaps[0] > 2)\n\
                    property nearest: always not (kick and min(kick.gaps) < 0.5)\n\
                    property named: always not (kick and any(kick.robots, r => r.name == \"a \\\"b\\\"\" and r.at.x > 1))\n\
                    property wide: always max(ranges) < 5\nproperty second: always ranges[1] < 4\n";
        let memory = Memory::default();
        let monitor = counting(text).record(memory.clone()).install().expect("a monitor");
        let pose = |x: f64| Value::Record(vec![("x".into(), x.into()), ("sure".into(), true.into())]);
        let robot = |x: f64| {
            Value::Record(vec![("name".into(), "a \"b\"".into()), ("at".into(), pose(x)), ("load".into(), Value::Missing)])
        };
        let kick = |gaps: Vec<f64>, x: f64| {
            let robots = Value::List(vec![robot(0.0), robot(x)]);
            monitor.event_with("kick", &[("gaps", Value::Nums(gaps)), ("robots", robots)]);
        };
        kick(vec![1.0, f64::INFINITY], 0.0);
        monitor.set("ranges", Value::Nums(vec![1.0, 2.0]));
        kick(vec![3.0, 0.25], 3.0);
        kick(vec![], 0.5);
        monitor.set("ranges", Value::Nums(vec![1.0, 4.5, f64::NAN, 6.0]));
        let report = monitor.finish();
        for name in ["first", "nearest", "named", "wide", "second"] {
            assert_eq!(verdict(&report, name), "violated", "{name}");
        }
        assert_eq!(properties(&report), properties(&checked(text, &memory.text())), "{}", memory.text());
    }

    fn what_many_threads_and_runtimes_do_at_once_is_judged_again() {
        let text = "event begins = call Kicker::dribble
event step = set SensorController.sonar below Kicker::dribble
event over = return Kicker::dribble
event kick = call Kicker::kick
event grabbed = return Kicker::grab
property ends over (begins, over): ltl([](over => <*> begins))
property near over (step): always not step
property soft: for each r of kick.robot: always not (kick and kick.power > 2)
property quick: whenever begins, eventually within 40 s step
property clean over (grabbed, kick): whenever grabbed, next kick
property sound: always sonar < 24
on violation of soft { run kick_softly }
";
        let memory = Memory::default();
        let handlers = Handlers::new().on("kick_softly", |violation, (): &()| {
            let [Value::Str(robot)] = violation.instance() else { return };
            kicker::kick(robot, 1.0);
        });
        let builder = Monitor::builder(spec(text)).handlers((), handlers).clock(Counting::default());
        let monitor = builder.record(memory.clone()).install().expect("a monitor");
        std::panic::set_hook(Box::new(|_| {}));
        let dribble = |steps| {
            kicker::dribble(steps, |n| async move {
                tokio::task::yield_now().await;
                sensor_controller::set_sonar(f64::from(n));
            })
        };
        let many = tokio::runtime::Builder::new_multi_thread().worker_threads(3).build().expect("a runtime");
        std::thread::scope(|scope| {
            let tasks: Vec<_> = (0..8).map(|_| many.spawn(dribble(25))).collect();
            scope.spawn(|| {
                let one = tokio::runtime::Builder::new_current_thread().enable_time().build().expect("a runtime");
                // Dropped halfway: nobody waits as long as it takes.
                let endless = dribble(u32::MAX);
                let waits = async { tokio::time::timeout(Duration::from_millis(20), endless).await };
                one.block_on(waits).expect_err("too long");
            });
            for robot in ["r1", "r2", "r3"] {
                scope.spawn(move || {
                    for power in 1..20 {
                        kicker::kick(robot, f64::from(power % 4));
                        // A span that begins on this thread and ends on another.
                        let span = tracing::info_span!("team", robot);
                        std::thread::spawn(move || span.in_scope(|| kicker::grab(Some(1.0)))).join().expect("a thread");
                        let _ = std::panic::catch_unwind(|| kicker::grab(None));
                    }
                });
            }
            tasks.into_iter().for_each(|task| assert_eq!(many.block_on(task).expect("a task"), 25));
        });
        let report = monitor.finish();
        assert_eq!((verdict(&report, "near"), verdict(&report, "sound")), ("violated", "violated"));
        assert_eq!(properties(&report), properties(&checked(&plain(text), &memory.text())));
    }

    fn time_that_passes_is_recorded_too() {
        let (memory, clock) = (Memory::default(), ManualClock::new());
        let builder = Monitor::builder(spec(TEXT)).clock(clock.clone()).record(memory.clone());
        let monitor = builder.install().expect("a monitor");
        kicker::ready(true);
        kicker::play();
        kicker::kick("other", 1.0);
        kicker::ball_in_front(|| sensor_controller::set_sonar(0.5));
        clock.set(Time(5_000_000_000));
        let report = monitor.finish();
        assert_eq!(verdict(&report, "bounded"), "violated");
        same_again(&report, &memory);
    }
}

#[test]
fn a_recording_that_fails_is_told_of() {
    let monitor = counting("event kick\nalways not kick\n").record(Full).build().expect("a monitor");
    monitor.event("kick");
    let report = monitor.finish();
    assert!(report.warnings.iter().any(|w| w.message == "not everything that arrived was recorded: the disk is full"));
    assert_eq!(report.properties[0].verdict.word(), "violated");
}
