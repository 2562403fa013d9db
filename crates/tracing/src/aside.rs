//! What the filters of other layers said, put aside while the host's code runs in the middle of their being told something.
//!
//! Before layers are told of a span or an event, `tracing-subscriber` asks the filters of all of them, and notes for the thread which said no,
//! a bit each; a layer that said no is skipped when its turn comes, and its bit taken back. What a handler raises is told in between, so that the
//! layers after the monitor would be told of what their filters turned off; and of a span that is not there for them, on which the
//! layer of `tracing_subscriber::fmt` panics.
//!
//! The bits are private. But a subscriber of 64 layers, one for each bit there can be, reads them when it is asked about an event, for only
//! those filters are asked that have said yes, and writes them by what its filters say. It is never made anybody's subscriber.

use std::cell::Cell;
use std::sync::LazyLock;

use tracing::callsite::{Callsite, Identifier};
use tracing::field::{Field, FieldSet, Value};
use tracing::level_filters::LevelFilter;
use tracing::metadata::Kind;
use tracing::subscriber::Interest;
use tracing::{Event, Level, Metadata, Subscriber};
use tracing_subscriber::filter::Filtered;
use tracing_subscriber::layer::{Context, Filter, Identity, Layered, SubscriberExt};
use tracing_subscriber::{Layer, Registry};

thread_local! {
    /// The bits of those who said no, while they are read or written.
    static NOES: Cell<u64> = const { Cell::new(0) };
}

/// A subscriber for each of the bits.
static BITS: LazyLock<Layered<Vec<Filtered<Identity, Bit, Registry>>, Registry>> = LazyLock::new(|| {
    // The registry numbers filters as they come.
    let layers: Vec<_> = (0..u64::BITS).map(|number| Identity::new().with_filter(Bit(1 << number))).collect();
    Registry::default().with(layers)
});

/// A subscriber that turns everything off, for all: where one does, the bits are cleared.
static NOTHING: LazyLock<Layered<LevelFilter, Registry>> = LazyLock::new(|| Registry::default().with(LevelFilter::OFF));

/// Does something as if nobody were being told anything.
pub(crate) fn aside<T>(work: impl FnOnce() -> T) -> T {
    let noes = read();
    NOTHING.enabled(&METADATA);
    let result = work();
    // A panic of another layer may have left bits behind.
    NOTHING.enabled(&METADATA);
    if noes != 0 {
        NOES.set(noes);
        BITS.enabled(&METADATA);
    }
    result
}

/// Who said no to what this thread is being told.
fn read() -> u64 {
    NOES.set(u64::MAX);
    let nothing: [(&Field, Option<&dyn Value>); 0] = [];
    BITS.event_enabled(&Event::new_child_of(None, &METADATA, &METADATA.fields().value_set(&nothing)));
    NOES.get()
}

/// The filter of the layer that has this bit.
struct Bit(u64);

impl<S> Filter<S> for Bit {
    fn enabled(&self, _: &Metadata<'_>, _: &Context<'_, S>) -> bool {
        NOES.get() & self.0 == 0
    }

    fn event_enabled(&self, _: &Event<'_>, _: &Context<'_, S>) -> bool {
        NOES.set(NOES.get() & !self.0);
        true
    }
}

/// What the bits are asked about.
struct Nowhere;

static METADATA: Metadata<'static> = Metadata::new(
    "bits",
    module_path!(),
    Level::ERROR,
    None,
    None,
    None,
    FieldSet::new(&[], Identifier(&Nowhere)),
    Kind::EVENT,
);

impl Callsite for Nowhere {
    fn set_interest(&self, _: Interest) {}

    fn metadata(&self) -> &Metadata<'_> {
        &METADATA
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What was said can only be read by what is told of it afterwards: each bit is one for itself, and what is put aside comes back.
    #[test]
    fn bits_come_back() {
        for noes in [0, 1, 0b1010, 1 << 63, u64::MAX >> 1] {
            NOES.set(noes);
            BITS.enabled(&METADATA);
            assert_eq!(read(), noes);
            aside(|| {
                assert_eq!(read(), 0);
                NOES.set(7);
                BITS.enabled(&METADATA);
            });
            assert_eq!(read(), noes);
            NOTHING.enabled(&METADATA);
        }
    }
}
