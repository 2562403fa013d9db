//! Listens to the robot's program, and keeps a log. It knows no property: any program that says what it does through `tracing` can be listened to.

use lapwing_stream::Value;
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id};
use tracing::{Event, Metadata, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::Context;
use tracing_subscriber::registry::LookupSpan;

use super::log::{Log, What};
use crate::field::Clock;

/// What listens. Only spans and events of the robot's own modules count.
pub struct Listener {
    log: Log,
    clock: Clock,
}

/// Where the robot's program is.
const ROBOT: &str = "soccer::robot";

/// The result of the function whose span has this.
struct Returned;

impl Listener {
    /// Writes to a log, with the time of a clock.
    pub fn new(log: Log, clock: Clock) -> Listener {
        Listener { log, clock }
    }

    fn note(&self, what: What) {
        self.log.add(i64::try_from(self.clock.now().as_nanos()).unwrap_or(i64::MAX), what);
    }
}

fn is_robots(metadata: &Metadata<'_>) -> bool {
    metadata.target().starts_with(ROBOT)
}

/// `Kicker::play` of the function `play` in the module `kicker`.
fn function(metadata: &Metadata<'_>) -> String {
    let module = metadata.target().rsplit("::").next().unwrap_or_default();
    let capital = |word: &str| {
        let mut letters = word.chars();
        letters.next().map(|first| first.to_ascii_uppercase().to_string() + letters.as_str()).unwrap_or_default()
    };
    format!("{}::{}", module.split('_').map(capital).collect::<String>(), metadata.name())
}

impl<S: Subscriber + for<'l> LookupSpan<'l>> Layer<S> for Listener {
    fn on_new_span(&self, attributes: &Attributes<'_>, _: &Id, _: Context<'_, S>) {
        if is_robots(attributes.metadata()) {
            self.note(What::Call(function(attributes.metadata())));
        }
    }

    fn on_event(&self, event: &Event<'_>, context: Context<'_, S>) {
        if !is_robots(event.metadata()) {
            return;
        }
        let mut fields = Fields::default();
        event.record(&mut fields);
        match (fields.result, context.event_span(event)) {
            (Some(result), Some(span)) => {
                span.extensions_mut().insert(Returned);
                self.note(What::Return(function(span.metadata()), result.parse().ok()));
            }
            _ if !fields.set.is_empty() => self.note(What::Set(fields.set)),
            _ => {}
        }
    }

    fn on_close(&self, id: Id, context: Context<'_, S>) {
        let Some(span) = context.span(&id).filter(|span| is_robots(span.metadata())) else { return };
        if span.extensions().get::<Returned>().is_none() {
            self.note(What::Return(function(span.metadata()), None));
        }
    }
}

/// The fields of an event: what `#[instrument(ret)]` records of a result, and numbers and truth values.
#[derive(Default)]
struct Fields {
    result: Option<String>,
    set: Vec<(&'static str, Value)>,
}

impl Visit for Fields {
    fn record_f64(&mut self, field: &Field, value: f64) {
        self.set.push((field.name(), Value::Num(value)));
    }

    fn record_bool(&mut self, field: &Field, value: bool) {
        match field.name() {
            "return" => self.result = Some(value.to_string()),
            name => self.set.push((name, Value::Bool(value))),
        }
    }

    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        if field.name() == "return" {
            self.result = Some(format!("{value:?}"));
        }
    }
}
