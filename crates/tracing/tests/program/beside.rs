//! Beside other subscribers, each with a filter of its own: what a handler does is between them and the program.

use std::sync::{Arc, Mutex};

use lapwing_tracing::{Handlers, Monitor};
use tracing::level_filters::LevelFilter;
use tracing::span::{Attributes, Id};
use tracing::{Event, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::{Context, SubscriberExt};
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::util::SubscriberInitExt;

use crate::support::{Counting, alone, said, spec};

mod arm {
    use tracing::instrument;

    #[instrument(level = "debug")]
    pub fn swing() {
        tracing::info!("swings");
    }

    #[instrument(level = "info")]
    pub fn lower() {
        tracing::debug!("lowers");
        tracing::info!("lowered");
    }
}

const SWING: &str = "event swing = call Arm::swing
property still: always not swing
on violation of still { run lower  reset }
";

/// Notes what it hears, as a log does.
#[derive(Clone, Default)]
struct Ear(Arc<Mutex<Vec<String>>>);

impl Ear {
    fn heard(&self) -> Vec<String> {
        self.0.lock().expect("an ear").clone()
    }
}

impl<S: Subscriber + for<'l> LookupSpan<'l>> Layer<S> for Ear {
    fn on_new_span(&self, attributes: &Attributes<'_>, id: &Id, context: Context<'_, S>) {
        assert!(context.span(id).is_some(), "what a layer is told of is there for it");
        self.0.lock().expect("an ear").push(attributes.metadata().name().to_owned());
    }

    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        let mut words = String::new();
        event.record(&mut |field: &tracing::field::Field, value: &dyn std::fmt::Debug| {
            if field.name() == "message" {
                words = format!("{value:?}");
            }
        });
        self.0.lock().expect("an ear").push(words);
    }
}

fn monitor() -> Monitor {
    let handlers = Handlers::new().on("lower", |_, (): &()| arm::lower());
    Monitor::builder(spec(SWING)).clock(Counting::default()).handlers((), handlers).build().expect("a monitor")
}

alone! {
    fn a_filtered_layer_after_the_monitor_hears_what_its_filter_lets_through() {
        let (monitor, info, all) = (monitor(), Ear::default(), Ear::default());
        tracing_subscriber::registry()
            .with(monitor.layer())
            .with(info.clone().with_filter(LevelFilter::INFO))
            .with(all.clone())
            .init();
        arm::swing();
        arm::swing();
        let once = ["lower", "lowered", "swings"];
        assert_eq!(info.heard(), [once, once].concat());
        let once = ["lower", "lowers", "lowered", "swing", "swings"];
        assert_eq!(all.heard(), [once, once].concat());
        assert_eq!(said(&monitor.finish(), "still").reactions, ["ran lower (2 times)", "reset (2 times)"]);
    }

    fn a_filtered_layer_before_the_monitor_hears_what_its_filter_lets_through() {
        let (monitor, info, all) = (monitor(), Ear::default(), Ear::default());
        tracing_subscriber::registry()
            .with(all.clone())
            .with(info.clone().with_filter(LevelFilter::INFO))
            .with(monitor.layer())
            .init();
        arm::swing();
        arm::swing();
        let once = ["lower", "lowered", "swings"];
        assert_eq!(info.heard(), [once, once].concat());
        let once = ["swing", "lower", "lowers", "lowered", "swings"];
        assert_eq!(all.heard(), [once, once].concat());
    }

    fn a_log_after_the_monitor_with_a_filter() {
        let monitor = monitor();
        tracing_subscriber::registry()
            .with(monitor.layer())
            .with(tracing_subscriber::fmt::layer().with_writer(std::io::sink).with_filter(LevelFilter::INFO))
            .init();
        arm::swing();
        arm::swing();
    }
}
