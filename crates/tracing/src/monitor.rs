//! The monitor as the host holds it, and the plain way to tell it what happens.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use lapwing_check::checked::{self, EventSource};
use lapwing_react::Report;
use lapwing_stream::Value;
use tracing::Subscriber;
use tracing_subscriber::filter::Filtered;
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::{Layer, Registry};

use crate::builder::{BuildError, Builder};
use crate::desk::{Bringer, Desk};
use crate::layer::{MonitorFilter, MonitorLayer};
use crate::scratch::Scratch;
use crate::site::{Passing, Site};
use crate::sites::Sites;
use crate::wants::field_name;

/// A specification at work inside the program. Clones are the same monitor.
///
/// What happens reaches it through `tracing` ([`Monitor::install`], [`Monitor::layer`]), through `log` (`Monitor::log_bridge`) or by
/// telling it: [`Monitor::event`], [`Monitor::set`].
///
/// ```
/// use lapwing_tracing::{Monitor, Spec};
///
/// let spec = Spec::parse("kick.rv", "event kick\nwhenever kick, kick.power < 5 and sonar < 0.1\n", &|_| None)?;
/// let monitor = Monitor::builder(spec).build()?;
/// monitor.set("sonar", 0.07);
/// monitor.event_with("kick", &[("power", 3.0.into())]);
/// monitor.set("sonar", 0.25);
/// monitor.event_with("kick", &[("power", 3.0.into())]);
/// let report = monitor.finish();
/// assert_eq!(report.properties[0].verdict.word(), "violated");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Monitor {
    shared: Arc<Shared>,
}

/// What the monitor's handles, layers and bridges share.
pub(crate) struct Shared {
    pub desk: Arc<Desk>,
    pub sites: Sites,
    pub names: Names,
    /// Functions and fields that are there, even if they are never reached.
    pub assumed: BTreeSet<String>,
    /// Whether the host tells values of signals.
    pub is_told: AtomicBool,
}

impl Drop for Shared {
    fn drop(&mut self) {
        self.desk.close();
    }
}

/// What can be told by name.
#[derive(Debug)]
pub(crate) struct Names {
    /// For each event its number, and the fields that are read of it.
    events: BTreeMap<String, (usize, Vec<String>)>,
    columns: BTreeMap<String, usize>,
}

impl Names {
    pub fn of(meaning: &checked::Spec) -> Names {
        let told = meaning.events.iter().enumerate().filter(|(_, e)| can_be_told(&e.source));
        let fields = |event: &checked::Event| event.fields.iter().map(|f| field_name(&f.path)).collect();
        Names {
            events: told.map(|(number, event)| (event.name.clone(), (number, fields(event)))).collect(),
            columns: meaning.columns.iter().enumerate().map(|(number, name)| (name.clone(), number)).collect(),
        }
    }
}

/// An event of that name, and those of call sites, for programs that do not use `tracing`.
fn can_be_told(source: &EventSource) -> bool {
    match source {
        EventSource::Named => true,
        EventSource::Point(point) => !point.path.is_empty(),
        _ => false,
    }
}

impl Shared {
    /// A call site is passed, by which something may have happened.
    pub fn pass(&self, bringer: Bringer, site: &Site, passing: Passing<'_>) {
        if !site.says_something(passing) {
            return;
        }
        self.desk.arrive(bringer, |arrival| {
            site.cells(passing).into_iter().for_each(|cells| arrival.row(cells));
            site.raised(passing).for_each(|(event, values)| arrival.event(event, values));
        });
    }
}

impl Monitor {
    /// A monitor in the making.
    pub fn builder(spec: crate::Spec) -> Builder {
        Builder::new(spec)
    }

    pub(crate) fn new(shared: Shared) -> Monitor {
        Monitor { shared: Arc::new(shared) }
    }

    /// Watches the whole program: becomes the subscriber of `tracing` on all threads. An error says that there is one already; then
    /// [`Monitor::layer`] belongs beside its layers.
    pub fn install(&self) -> Result<(), BuildError> {
        let subscriber = self.layer().with_subscriber(Registry::default());
        tracing::subscriber::set_global_default(subscriber).map_err(|_| BuildError::AlreadyInstalled)
    }

    /// A layer beside others. It wants what its specification reads and nothing else, and turns nothing off for other layers.
    ///
    /// Handlers see their own doings only under a subscriber for the whole program (`init()`, `set_global_default`). While one is set
    /// for a scope, handlers are not run, and the report says so.
    pub fn layer<S>(&self) -> Filtered<MonitorLayer, MonitorFilter, S>
    where
        S: Subscriber + for<'a> LookupSpan<'a>,
    {
        MonitorLayer::new(self.shared.clone()).with_filter(MonitorFilter::new(self.shared.clone()))
    }

    /// A logger that tells it what `log` is told.
    #[cfg(feature = "log")]
    pub fn log_bridge(&self) -> crate::LogBridge {
        crate::LogBridge::new(self.shared.clone())
    }

    /// An event occurs: `event NAME`, or one that stands for a call, a return or a field, for programs without `tracing`.
    pub fn event(&self, name: &str) {
        self.event_with(name, &[]);
    }

    /// An event occurs, with fields. A field of a field is given by its whole name, `pose.x`.
    pub fn event_with(&self, name: &str, fields: &[(&str, Value)]) {
        let Some((event, wanted)) = self.shared.names.events.get(name) else {
            return self.shared.desk.note_unknown(name);
        };
        Scratch::with(wanted.len(), |scratch| {
            for (slot, want) in wanted.iter().enumerate() {
                let given = fields.iter().find(|(field, _)| field == want);
                given.into_iter().for_each(|(_, value)| scratch.fill(slot, value));
            }
            let values = &scratch.values()[..wanted.len()];
            self.shared.desk.arrive(Bringer::Host, |arrival| arrival.event(*event, values));
        });
    }

    /// A signal gets a value.
    pub fn set(&self, signal: &str, value: impl Into<Value>) {
        self.set_all(&[(signal, value.into())]);
    }

    /// Several signals get values at once: one instant.
    pub fn set_all(&self, signals: &[(&str, Value)]) {
        self.shared.is_told.store(true, Ordering::Relaxed);
        let width = self.shared.names.columns.len();
        Scratch::with(width, |scratch| {
            let mut is_read = false;
            for (signal, value) in signals {
                match self.shared.names.columns.get(*signal) {
                    Some(&column) => {
                        scratch.fill(column, value);
                        is_read = true;
                    }
                    None => self.shared.desk.note_unknown(signal),
                }
            }
            if is_read {
                let cells = &scratch.values()[..width];
                self.shared.desk.arrive(Bringer::Host, |arrival| arrival.row(cells));
            }
        });
    }

    /// The host's clock has gone on, and nothing else has happened: what should have happened by now has not.
    ///
    /// A bound is over once the clock has gone beyond it. With the machine's clock a thread of the monitor sees to that by itself.
    pub fn advance(&self) {
        self.shared.desk.advance();
    }

    /// The property whose violation ended the monitoring by `stop`, where one did. A clock, or a recording's writer, that asks while it is called
    /// is told of none.
    pub fn stopped_by(&self) -> Option<String> {
        self.shared.desk.stopped_by()
    }

    /// Ends the monitoring: the report that `lapwing check` gives of the same events and values. Asked again, it gives the same report.
    ///
    /// A clock, or a recording's writer, that is called while something arrives cannot end it: its report has no properties, and a gap.
    pub fn finish(&self) -> Report {
        let Shared { desk, sites, assumed, .. } = &*self.shared;
        // A program that tells signals has no call sites for them.
        if !self.shared.is_told.load(Ordering::Relaxed) {
            sites.misnamed(assumed).into_iter().for_each(|message| desk.warn(message));
        }
        desk.finish(|raised| sites.unseen(raised, assumed))
    }
}

impl fmt::Debug for Monitor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Monitor").field("stopped_by", &self.stopped_by()).finish_non_exhaustive()
    }
}
