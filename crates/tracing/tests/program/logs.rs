//! Programs that have `log` and no `tracing`.

use log::{LevelFilter, Log, Metadata, Record};
use std::sync::atomic::{AtomicU32, Ordering};

use crate::support::{alone, counting, same_as_checked, verdict};

static HEARD: AtomicU32 = AtomicU32::new(0);

struct Ear;

impl Log for Ear {
    fn enabled(&self, _: &Metadata<'_>) -> bool {
        true
    }

    fn log(&self, _: &Record<'_>) {
        HEARD.fetch_add(1, Ordering::SeqCst);
    }

    fn flush(&self) {}
}

const TEXT: &str = "event kick
event read = set SensorController.sonar
property close: whenever kick, sonar < 0.1
property soft: always not (kick and kick.power > 2)
property reads over (kick, read): whenever kick, previously read
";

alone! {
    fn records_are_events_and_their_pairs_are_fields() {
        let monitor = counting(TEXT).build().expect("a monitor");
        monitor.log_bridge().beside(Ear).install(LevelFilter::Trace).expect("the only logger");
        log::debug!(target: "robot::sensor_controller", sonar = 0.07; "read");
        log::info!(power = 1.5; "kick");
        log::info!("kick it {}", "hard");
        log::debug!(target: "robot::sensor_controller", sonar:% = "0.5"; "read");
        log::info!(power = 3.0; "kick");
        log::info!("kick");
        let report = monitor.finish();
        let lines = "{\"t\": 0, \"values\": {\"sonar\": 0.07}}\n{\"t\": 0, \"event\": \"read\"}\n\
                     {\"t\": 1, \"event\": \"kick\", \"power\": 1.5}\n{\"t\": 2, \"values\": {\"sonar\": 0.5}}\n\
                     {\"t\": 2, \"event\": \"read\"}\n{\"t\": 3, \"event\": \"kick\", \"power\": 3.0}\n\
                     {\"t\": 4, \"event\": \"kick\"}\n";
        same_as_checked(&report, TEXT, lines);
        assert_eq!((verdict(&report, "soft"), verdict(&report, "reads")), ("violated", "violated"));
        assert_eq!(HEARD.load(Ordering::SeqCst), 6);
    }
}
