//! The bridge for programs that have `log` and no `tracing`.

use std::sync::Arc;

use log::kv::{Error, Key, Value as Given, VisitSource};
use log::{LevelFilter, Log, Metadata, Record, SetLoggerError};

use crate::desk::Bringer;
use crate::monitor::Shared;
use crate::scratch::Scratch;
use crate::site::{Passing, Site};
use crate::wants::{Place, PlaceKind};

/// More keys of one record are not looked at.
const MOST_KEYS: usize = 64;

/// A logger that tells a monitor what the program logs.
///
/// The key-value pairs of a record are fields: they set signals, and are what `set Type.field` waits for, with the record's target as
/// the module. A record whose message is the name of a declared event, word for word, is that event: `info!(power = 3.0; "kick")`.
/// `log` has no spans, so that calls and returns are not seen.
pub struct LogBridge {
    shared: Arc<Shared>,
    beside: Option<Box<dyn Log>>,
}

impl LogBridge {
    pub(crate) fn new(shared: Arc<Shared>) -> LogBridge {
        LogBridge { shared, beside: None }
    }

    /// Another logger that hears everything as well: one that writes it down.
    #[must_use]
    pub fn beside(mut self, logger: impl Log + 'static) -> LogBridge {
        self.beside = Some(Box::new(logger));
        self
    }

    /// Becomes the program's logger, for all levels up to this one. An error says that there is one already.
    pub fn install(self, most: LevelFilter) -> Result<(), SetLoggerError> {
        log::set_boxed_logger(Box::new(self))?;
        log::set_max_level(most);
        Ok(())
    }

    fn tell(&self, record: &Record<'_>) {
        let mut keys = Keys { list: [""; MOST_KEYS], count: 0 };
        let pairs = record.key_values();
        // A source that fails in the middle has given what came before.
        let _ = pairs.visit(&mut keys);
        let place = Place {
            kind: PlaceKind::Event,
            name: record.args().as_str().filter(|text| self.shared.sites.wants().names(text)).unwrap_or(""),
            target: record.target(),
            fields: &keys.list[..keys.count],
            file: record.file(),
            line: record.line(),
        };
        let Some(site) = self.shared.sites.of_log(&place) else { return };
        Scratch::with(site.width, |scratch| {
            let _ = pairs.visit(&mut TakePairs { site: &site, into: scratch, number: 0 });
            let passing = Passing { values: scratch.values(), below: 0, begins: false };
            self.shared.pass(Bringer::Host, &site, passing);
        });
    }
}

impl Log for LogBridge {
    fn enabled(&self, _: &Metadata<'_>) -> bool {
        true
    }

    fn log(&self, record: &Record<'_>) {
        self.tell(record);
        if let Some(beside) = self.beside.as_ref().filter(|b| b.enabled(record.metadata())) {
            beside.log(record);
        }
    }

    fn flush(&self) {
        self.beside.iter().for_each(|beside| beside.flush());
    }
}

/// The keys of a record, in order.
struct Keys<'k> {
    list: [&'k str; MOST_KEYS],
    count: usize,
}

impl<'k> VisitSource<'k> for Keys<'k> {
    fn visit_pair(&mut self, key: Key<'k>, _: Given<'k>) -> Result<(), Error> {
        // A key that has to be made up at every record has no place of its own.
        if let Some(to) = self.list.get_mut(self.count) {
            *to = key.to_borrowed_str().unwrap_or("");
            self.count += 1;
        }
        Ok(())
    }
}

/// Takes the values of a record's pairs.
struct TakePairs<'a> {
    site: &'a Site,
    into: &'a mut Scratch,
    number: usize,
}

impl<'k> VisitSource<'k> for TakePairs<'_> {
    fn visit_pair(&mut self, _: Key<'k>, value: Given<'k>) -> Result<(), Error> {
        let slots: &[usize] = self.site.routes.get(self.number).map_or(&[], |slots| slots);
        self.number += 1;
        for &slot in slots {
            match (value.to_bool(), value.to_f64(), value.to_borrowed_str()) {
                (Some(b), ..) => self.into.put(slot, b.into()),
                (_, Some(x), _) => self.into.put(slot, x.into()),
                (.., Some(text)) => self.into.put_text(slot, text),
                _ => self.into.put_written(&[slot], format_args!("{value}")),
            }
        }
        Ok(())
    }
}
