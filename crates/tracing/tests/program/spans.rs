//! Spans around an event: below a call, on threads and in async code, and the fields that they hand on.

use futures::executor::{ThreadPool, block_on};
use futures::task::SpawnExt;
use tracing::Instrument;
use tracing_subscriber::layer::SubscriberExt;

use crate::robot::{kicker, sensor_controller};
use crate::support::{alone, counting, said, same_as_checked, verdict, watched};

const BELOW: &str = "event inner = set SensorController.sonar below Kicker::ball_in_front
event any = set SensorController.sonar
property seen over (inner, any): always not inner
property last: whenever any, sonar < 1.0
";

alone! {
    fn below_is_while_the_call_is_active() {
        let monitor = watched(BELOW);
        sensor_controller::set_sonar(0.5);
        kicker::ball_in_front(|| {
            kicker::ball_in_front(|| sensor_controller::set_sonar(2.0));
        });
        sensor_controller::set_sonar(0.25);
        let report = monitor.finish();
        // The signal gets its value, then the events of the same call site occur.
        let set = |t: u32, sonar: f64, events: &[&str]| {
            let value = format!("{{\"t\": {t}, \"values\": {{\"sonar\": {sonar}}}}}\n");
            events.iter().fold(value, |all, event| all + &format!("{{\"t\": {t}, \"event\": \"{event}\"}}\n"))
        };
        let lines = [set(0, 0.5, &["any"]), set(1, 2.0, &["inner", "any"]), set(2, 0.25, &["any"])].concat();
        same_as_checked(&report, BELOW, &lines);
        assert_eq!((verdict(&report, "seen"), verdict(&report, "last")), ("violated", "violated"));
    }

    fn calls_and_returns_can_be_below_a_call_too() {
        let text = "event plays = call Kicker::play below Kicker::ball_in_front
event played = return Kicker::play below Kicker::ball_in_front
event ready = return Kicker::ready when result == true below Kicker::ball_in_front
event looked = return Kicker::ball_in_front
property inside over (plays, played, ready, looked): always (looked implies once ready)
property pairs: whenever plays, next played
";
        let monitor = watched(text);
        kicker::play();
        kicker::ready(true);
        kicker::ball_in_front(kicker::play);
        kicker::ball_in_front(|| {
            kicker::ready(true);
        });
        let report = monitor.finish();
        let line = |t: u32, event: &str| format!("{{\"t\": {t}, \"event\": \"{event}\"}}\n");
        let lines = [line(0, "plays"), line(1, "played"), line(2, "looked"), line(3, "ready"), line(4, "looked")].concat();
        assert_eq!((verdict(&report, "inside"), verdict(&report, "pairs")), ("violated", "holds"));
        same_as_checked(&report, text, &lines);
    }

    fn a_value_that_a_span_records_later_is_below_what_is_around_the_span() {
        let text = "event inner = set SensorController.range below Kicker::ball_in_front
event any = set SensorController.range
property seen over (inner, any): always not inner
";
        let monitor = watched(text);
        sensor_controller::measure(1.0);
        kicker::ball_in_front(|| sensor_controller::measure(2.0));
        let report = monitor.finish();
        let line = |t: u32, event: &str| format!("{{\"t\": {t}, \"event\": \"{event}\"}}\n");
        let lines = [line(0, "any"), line(1, "inner"), line(1, "any")].concat();
        assert_eq!(verdict(&report, "seen"), "violated");
        same_as_checked(&report, text, &lines);
    }

    fn a_value_that_a_span_records_later_belongs_to_the_robot_of_the_spans_around() {
        let text = "event read = set SensorController.range
property once_each: for each r of read.robot: always (read implies not previously once read)
";
        let monitor = watched(text);
        for robot in ["r1", "r2", "r2"] {
            tracing::info_span!("team", robot).in_scope(|| sensor_controller::measure(1.0));
        }
        let report = monitor.finish();
        assert_eq!((verdict(&report, "once_each[r1]"), verdict(&report, "once_each[r2]")), ("holds", "violated"));
    }

    fn another_thread_is_below_only_if_its_span_says_so() {
        let monitor = watched(BELOW);
        kicker::ball_in_front(|| {
            std::thread::spawn(|| sensor_controller::set_sonar(0.5)).join().expect("a thread");
        });
        assert_eq!(said(&monitor.finish(), "seen").obligations.failed, 0);
    }

    fn spans_of_two_subscribers_are_not_taken_for_each_other() {
        let monitor = counting(BELOW).build().expect("a monitor");
        let watched = |work: &dyn Fn()| {
            let subscriber = tracing_subscriber::registry().with(monitor.layer());
            tracing::subscriber::with_default(subscriber, work);
        };
        watched(&|| {
            kicker::ball_in_front(|| {
                watched(&|| kicker::ball_in_front(|| {}));
                sensor_controller::set_sonar(0.5);
            });
        });
        assert_eq!(said(&monitor.finish(), "seen").obligations.failed, 1);
    }

    fn a_thread_inside_the_span_is_below() {
        let monitor = watched(BELOW);
        kicker::ball_in_front(|| {
            let span = tracing::Span::current();
            std::thread::spawn(move || span.in_scope(|| sensor_controller::set_sonar(0.5))).join().expect("a thread");
        });
        assert_eq!(said(&monitor.finish(), "seen").obligations.failed, 1);
    }

    fn tasks_that_take_turns_on_one_thread_keep_their_spans() {
        let text = "event step = set SensorController.sonar below Kicker::dribble
event any = set SensorController.sonar
event over = return Kicker::dribble
property inside over (step, any, over): whenever any, previously step
";
        let monitor = watched(text);
        let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a runtime");
        runtime.block_on(async {
            let dribbles = kicker::dribble(2, |_| async {
                tokio::task::yield_now().await;
                sensor_controller::set_sonar(1.0);
            });
            let other = async {
                tokio::task::yield_now().await;
                sensor_controller::set_sonar(2.0);
            };
            tokio::join!(dribbles, other)
        });
        let report = monitor.finish();
        let met = said(&report, "inside").obligations;
        assert_eq!((met.met, met.failed), (5, 1), "two steps of two events, the other's one, the end");
    }

    fn tasks_on_many_threads_are_in_the_order_of_arrival() {
        let text = "event begins = call Kicker::dribble
event step = set SensorController.sonar below Kicker::dribble
event over = return Kicker::dribble
property count over (begins, step, over): always (over implies once step)
";
        let monitor = watched(text);
        let pool = ThreadPool::builder().pool_size(4).create().expect("a pool");
        let tasks: Vec<_> = (0..8)
            .map(|robot| {
                let task = kicker::dribble(25, |n| async move { sensor_controller::set_sonar(f64::from(n)) });
                pool.spawn_with_handle(task.instrument(tracing::info_span!("team", robot))).expect("a task")
            })
            .collect();
        tasks.into_iter().for_each(|task| assert_eq!(block_on(task), 25));
        let report = monitor.finish();
        assert_eq!((verdict(&report, "count"), report.instants), ("holds", 8 * (1 + 25 + 1)));
        // One second each by the clock that counts: nobody shares a stamp, and none is lost.
        let (start, end) = report.span.expect("a span");
        assert_eq!((start.seconds(), end.seconds()), (0.0, f64::from(8 * 27)));
    }

    fn spans_hand_their_fields_on_and_make_instances() {
        let text = "event read = set SensorController.ball_dir
event seen = set SensorController.ball_dir when ball_dir < 3 and robot == \"r2\"
property each_sees: for each r of read.robot: always (read implies read.ball_dir < 3)
property r2 over (read, seen): eventually seen
property calls: for each r of call.robot: always not (kick and kick.power > 4)
event kick = call Kicker::kick
";
        let monitor = watched(text);
        sensor_controller::read_ir("r1", Some(1.5));
        sensor_controller::read_ir("r2", Some(4.0));
        sensor_controller::read_ir("r1", None);
        sensor_controller::read_ir("r2", Some(2.5));
        kicker::kick("r1", 5.0);
        kicker::kick("r2", 3.0);
        let report = monitor.finish();
        assert_eq!((verdict(&report, "each_sees[r1]"), verdict(&report, "each_sees[r2]")), ("holds", "violated"));
        assert_eq!(verdict(&report, "r2"), "satisfied");
        assert_eq!((verdict(&report, "calls[r1]"), verdict(&report, "calls[r2]")), ("violated", "holds"));
        let value = &said(&report, "each_sees[r2]").violations[0].values.as_ref().expect("values");
        assert!(value.iter().any(|r| r.name == "read.ball_dir" && r.value == 4.0.into()), "{value:?}");
    }
}
