//! What had to happen by now and has not: nothing has to arrive for that to be noticed.

use std::sync::{Arc, OnceLock, mpsc};
use std::time::Duration;

use lapwing_tracing::{Clock, Handlers, ManualClock, Monitor, Time};

use crate::support::{said, same_as_checked, spec, verdict};

const TEXT: &str = "event asked\nevent answered\nproperty answers: whenever asked, eventually within 2 s answered\n";

fn at(clock: &ManualClock, seconds: f64) {
    clock.set(Time((seconds * 1e9) as i64));
}

#[test]
fn a_host_with_a_clock_of_its_own_says_when_time_has_passed() {
    let clock = ManualClock::new();
    let (tell, told) = mpsc::channel();
    let builder = Monitor::builder(spec(TEXT)).clock(clock.clone());
    let tell = std::sync::Mutex::new(tell);
    let monitor = builder
        .on_violation(move |v| tell.lock().expect("a sender").send(v.failed()).expect("someone listens"))
        .build()
        .expect("a monitor");
    monitor.event("asked");
    at(&clock, 2.0);
    monitor.advance();
    assert!(told.try_recv().is_err(), "an answer with this very stamp would still count");
    at(&clock, 2.5);
    monitor.advance();
    assert_eq!(told.try_recv(), Ok(Time(2_000_000_000)), "it failed when its time was over, not when that was noticed");
    at(&clock, 3.0);
    monitor.event("answered");
    let lines = "{\"t\": 0, \"event\": \"asked\"}\n{\"t\": 3, \"event\": \"answered\"}\n";
    same_as_checked(&monitor.finish(), TEXT, lines);
}

#[test]
fn with_the_machines_clock_a_thread_notices_by_itself() {
    let text = TEXT.replace("2 s", "20 ms");
    let (tell, told) = mpsc::channel();
    let tell = std::sync::Mutex::new(tell);
    let builder = Monitor::builder(spec(&text));
    let monitor = builder
        .on_violation(move |v| {
            tell.lock().expect("a sender").send(v.failed().since(v.began())).expect("someone listens")
        })
        .build()
        .expect("a monitor");
    monitor.event("asked");
    let late = told.recv_timeout(Duration::from_secs(60)).expect("nobody answers");
    assert_eq!(late.nanos(), 20_000_000);
    assert_eq!(verdict(&monitor.finish(), "answers"), "violated");
}

#[test]
fn a_handler_that_waits_holds_no_other_deadline_back() {
    let text = "event asked\nevent answered\nproperty soon: whenever asked, eventually within 20 ms answered\n\
                property later: whenever asked, eventually within 40 ms answered\non violation of soon { run wait }\non violation of later { run tell }\n";
    let ((tell, told), (end, ended)) = (mpsc::channel(), mpsc::channel());
    type Context = std::sync::Mutex<(mpsc::Sender<()>, mpsc::Sender<bool>, Option<mpsc::Receiver<()>>)>;
    let context: Context = std::sync::Mutex::new((tell, end, Some(told)));
    let handlers = Handlers::new()
        .on("wait", |_, context: &Context| {
            let (told, end) = {
                let mut all = context.lock().expect("what is shared");
                (all.2.take().expect("it runs once"), all.1.clone())
            };
            // Nothing else arrives: but for the other deadline it would wait in vain.
            end.send(told.recv_timeout(Duration::from_secs(20)).is_ok()).expect("someone listens");
        })
        .on("tell", |_, context: &Context| context.lock().expect("what is shared").0.send(()).expect("someone waits"));
    let monitor = Monitor::builder(spec(text)).handlers(context, handlers).build().expect("a monitor");
    monitor.event("asked");
    assert_eq!(ended.recv_timeout(Duration::from_secs(60)), Ok(true));
    assert_eq!(verdict(&monitor.finish(), "later"), "violated");
}

#[test]
fn a_clock_that_goes_back_starts_everything_anew() {
    let clock = ManualClock::new();
    let monitor = Monitor::builder(spec(TEXT)).clock(clock.clone()).build().expect("a monitor");
    at(&clock, 5.0);
    monitor.event("asked");
    at(&clock, 1.0);
    monitor.event("asked");
    at(&clock, 1.5);
    monitor.event("answered");
    let report = monitor.finish();
    assert_eq!(said(&report, "answers").obligations.met, 2);
    assert!(report.warnings.iter().any(|w| w.message.contains("time jumped back from 5 s to 1 s")));
}

#[test]
fn a_clock_that_talks_to_its_monitor_is_turned_away() {
    /// Does all that a clock must not.
    #[derive(Clone, Default)]
    struct Loud(Arc<OnceLock<Monitor>>);

    impl Clock for Loud {
        fn now(&self) -> Time {
            if let Some(monitor) = self.0.get() {
                monitor.event("asked");
                monitor.event("nobody knows this");
                monitor.set("nor this", 1.0);
                let report = monitor.finish();
                assert_eq!((monitor.stopped_by(), report.properties.len(), report.gaps.len()), (None, 0, 1));
            }
            Time(0)
        }
    }

    let text = "event asked\nproperty calm: always not asked\non violation of calm at most every 1 s { reset }\n";
    let clock = Loud::default();
    let monitor = Monitor::builder(spec(text)).clock(clock.clone()).build().expect("a monitor");
    assert!(clock.0.set(monitor.clone()).is_ok());
    monitor.event("asked");
    let report = monitor.finish();
    let calm = said(&report, "calm");
    assert_eq!((calm.obligations.failed, calm.reactions.as_slice()), (1, &["reset".to_owned()][..]));
    let [warning] = report.warnings.as_slice() else { panic!("{:?}", report.warnings) };
    assert!(warning.message.starts_with("what the clock or the writer"), "{warning:?}");
}
