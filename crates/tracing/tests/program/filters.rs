//! Beside other subscribers: filters are respected, and nobody else is turned off.

use std::sync::{Arc, Mutex};

use tracing::{Event, Subscriber};
use tracing_subscriber::filter::{EnvFilter, LevelFilter};
use tracing_subscriber::layer::{Context, Layer, SubscriberExt};
use tracing_subscriber::util::SubscriberInitExt;

use crate::robot::{kicker, sensor_controller};
use crate::support::{alone, cause, counting, said, verdict, watched};

const TEXT: &str = "event play = call Kicker::play\nevent kick = call Kicker::kick\n\
                    property calm: always (play implies not kick)\nproperty plays: always not play\n";

/// Notes the events that it hears.
#[derive(Clone, Default)]
struct Ear(Arc<Mutex<Vec<String>>>);

impl<S: Subscriber> Layer<S> for Ear {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        self.0.lock().expect("an ear").push(event.metadata().target().to_owned());
    }
}

alone! {
    fn a_filter_for_all_makes_what_needs_a_call_inconclusive() {
        let monitor = counting(TEXT).build().expect("a monitor");
        let filter = EnvFilter::new("trace,program::robot::sensor_controller=off");
        let text = "event read = set SensorController.sonar\nproperty reads: always not read\n";
        let deaf = counting(text).build().expect("a monitor");
        tracing_subscriber::registry().with(monitor.layer()).with(deaf.layer()).with(filter).init();
        sensor_controller::set_sonar(0.5);
        kicker::play();
        kicker::kick("r1", 1.0);
        assert_eq!((verdict(&monitor.finish(), "calm"), verdict(&deaf.finish(), "reads")), ("holds", "inconclusive"));
    }

    fn a_level_for_all_does_so_too() {
        let monitor = counting(TEXT).build().expect("a monitor");
        tracing_subscriber::registry().with(monitor.layer()).with(LevelFilter::WARN).init();
        kicker::play();
        kicker::kick("r1", 1.0);
        let report = monitor.finish();
        assert_eq!((verdict(&report, "plays"), verdict(&report, "calm")), ("inconclusive", "inconclusive"));
        assert!(cause(&report, "plays").contains("a filter turns it off"), "{}", cause(&report, "plays"));
    }

    fn a_filter_of_another_layer_is_its_own_affair() {
        let monitor = counting(TEXT).build().expect("a monitor");
        let ear = Ear::default();
        tracing_subscriber::registry().with(ear.clone().with_filter(LevelFilter::ERROR)).with(monitor.layer()).init();
        kicker::play();
        let _ = kicker::find_ball(None);
        assert_eq!(*ear.0.lock().expect("an ear"), ["program::robot::kicker"], "the error alone");
        assert_eq!(verdict(&monitor.finish(), "plays"), "violated");
    }

    fn what_no_specification_reads_still_reaches_other_layers() {
        let monitor = counting(TEXT).build().expect("a monitor");
        let ear = Ear::default();
        tracing_subscriber::registry().with(monitor.layer()).with(ear.clone()).init();
        sensor_controller::set_sonar(0.5);
        kicker::play();
        let heard = ear.0.lock().expect("an ear").clone();
        assert_eq!(heard, ["program::robot::sensor_controller", "program::robot::kicker"]);
        assert_eq!(monitor.finish().instants, 1);
    }

    fn what_nobody_reads_is_turned_off() {
        let monitor = watched(TEXT);
        sensor_controller::set_sonar(0.5);
        kicker::play();
        assert!(!tracing::enabled!(target: "program::robot::sensor_controller", tracing::Level::TRACE));
        assert_eq!(monitor.finish().instants, 1);
    }

    fn several_monitors_at_once() {
        let first = counting(TEXT).build().expect("a monitor");
        let second = counting("event kick = call Kicker::kick\nproperty soft: always not (kick and kick.power > 2)\n").build().expect("a monitor");
        tracing_subscriber::registry().with(first.layer()).with(second.layer()).init();
        kicker::kick("r1", 1.0);
        kicker::play();
        kicker::kick("r1", 3.0);
        let (first, second) = (first.finish(), second.finish());
        assert_eq!((first.instants, second.instants), (3, 2));
        assert_eq!((verdict(&first, "calm"), verdict(&second, "soft")), ("holds", "violated"));
        assert_eq!(said(&second, "soft").violations[0].failed.seconds(), 1.0);
    }

    fn a_program_with_a_subscriber_is_told_to_use_the_layer() {
        let monitor = watched(TEXT);
        let error = monitor.install().expect_err("there is one");
        assert!(error.to_string().contains("put `monitor.layer()` beside its layers"));
    }
}
