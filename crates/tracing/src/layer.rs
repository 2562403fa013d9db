//! The layer that hears what `tracing` is told, and the filter that asks for no more than the specification reads.

use std::sync::Arc;

use tracing::subscriber::Interest;
use tracing::{Event, Metadata, Subscriber, span};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::{Context, Filter};
use tracing_subscriber::registry::{LookupSpan, SpanRef};

use crate::desk::Bringer;
use crate::monitor::Shared;
use crate::scratch::{ERROR, RESULT, Scratch, Take, TakeReturn};
use crate::site::{Passing, Returned, Site, Source, is_below};
use crate::sites::Entry;
use crate::spans::{Note, Spans};

/// Hears what `tracing` is told: see [`Monitor::layer`](crate::Monitor::layer).
pub struct MonitorLayer {
    shared: Arc<Shared>,
    /// Its own: beneath another subscriber other spans have the same numbers.
    spans: Spans,
}

/// Asks for no more than the specification reads.
pub struct MonitorFilter {
    shared: Arc<Shared>,
}

impl MonitorFilter {
    pub(crate) fn new(shared: Arc<Shared>) -> MonitorFilter {
        MonitorFilter { shared }
    }
}

impl<S> Filter<S> for MonitorFilter {
    fn enabled(&self, metadata: &Metadata<'_>, _: &Context<'_, S>) -> bool {
        self.shared.sites.entry(metadata).is_some()
    }

    fn callsite_enabled(&self, metadata: &'static Metadata<'static>) -> Interest {
        match self.shared.sites.register(metadata) {
            true => Interest::always(),
            false => Interest::never(),
        }
    }
}

impl MonitorLayer {
    pub(crate) fn new(shared: Arc<Shared>) -> MonitorLayer {
        MonitorLayer { shared, spans: Spans::default() }
    }

    /// A span begins: it is noted for what happens inside it, then what its beginning says arrives.
    fn begin<S>(&self, site: &Arc<Site>, attributes: &span::Attributes<'_>, id: &span::Id, context: &Context<'_, S>)
    where
        S: Subscriber + for<'a> LookupSpan<'a>,
    {
        Scratch::with(site.width, |scratch| {
            attributes.record(&mut Take { site, into: scratch });
            let mut below = 0;
            if let Some(plan) = &site.span {
                let carries = self.shared.sites.wants().carries();
                let outer = site.asks_around.then(|| ancestors(context.span(id))).into_iter().flatten();
                self.spans.begin(id.into_u64(), carries, outer, |note| {
                    note.take(scratch.values().get(plan.carried.clone()).unwrap_or_default());
                    (note.site, note.inside) = (Some(site.clone()), note.around | plan.bits);
                    below = note.around;
                    inherit(site, note, scratch);
                });
            } else if site.asks_around {
                below = self.look_around(context.span(id), site, scratch);
            }
            let passing = Passing { values: scratch.values(), below, begins: true };
            self.shared.pass(Bringer::Subscriber, site, passing);
        });
    }

    /// What the spans around one give to what it says, where it is none of those that are noted itself. Gives the functions that it is below.
    fn look_around<'a, S>(&self, span: Option<SpanRef<'a, S>>, site: &Site, scratch: &mut Scratch) -> u64
    where
        S: for<'l> LookupSpan<'l>,
    {
        let look = |note: &Note| {
            inherit(site, note, scratch);
            note.inside
        };
        self.spans.first(ancestors(span), look).unwrap_or(0)
    }

    fn event<S>(&self, site: &Site, event: &Event<'_>, context: &Context<'_, S>)
    where
        S: Subscriber + for<'a> LookupSpan<'a>,
    {
        Scratch::with(site.width, |scratch| {
            event.record(&mut Take { site, into: scratch });
            let mut below = 0;
            if site.asks_around {
                let around = context.event_scope(event).into_iter().flatten().map(|span| span.id().into_u64());
                self.spans.first(around, |note| {
                    below = note.inside;
                    inherit(site, note, scratch);
                });
            }
            let passing = Passing { values: scratch.values(), below, begins: false };
            self.shared.pass(Bringer::Subscriber, site, passing);
        });
    }

    /// A function recorded what it returned.
    fn returned<S>(&self, event: &Event<'_>, context: &Context<'_, S>)
    where
        S: Subscriber + for<'a> LookupSpan<'a>,
    {
        let Some(id) = context.event_span(event).map(|span| span.id().into_u64()) else { return };
        let spans = &self.spans;
        // An inner function whose return nobody wants has no span here, but stands elsewhere.
        let metadata = event.metadata();
        let is_own = |site: &Arc<Site>| site.origin.is_at(metadata.file(), metadata.line());
        let Some(site) = spans.change(id, |note| note.site.clone()).flatten().filter(is_own) else { return };
        if metadata.fields().iter().any(|field| field.name() == "return") {
            site.origin.note_result();
        }
        let record = |scratch: &mut Scratch| event.record(&mut TakeReturn { into: scratch });
        self.tell_return(&site, record, |look| {
            spans.change(id, |note| {
                note.has_returned = true;
                look(note);
            });
        });
    }

    /// Raises what the return of a function raises. `record` puts the result and the error where they belong, `with_note` shows what is known
    /// of the function's span.
    fn tell_return(
        &self,
        site: &Site,
        record: impl FnOnce(&mut Scratch),
        with_note: impl FnOnce(&mut dyn FnMut(&Note)),
    ) {
        let returns = site.span.as_ref().map_or(&[][..], |plan| &plan.returns);
        let width = FIRST + returns.iter().map(|r| r.fields.len()).sum::<usize>();
        Scratch::with(width, |scratch| {
            record(scratch);
            let mut around = 0;
            with_note(&mut |note| {
                around = note.around;
                gather(returns, note, scratch);
            });
            if !returns.iter().any(|r| is_below(r.below, around)) {
                return;
            }
            self.shared.desk.arrive(Bringer::Subscriber, |arrival| {
                let mut rest = &scratch.values()[FIRST..width];
                for returned in returns {
                    let (values, others) = rest.split_at(returned.fields.len());
                    rest = others;
                    if is_below(returned.below, around) {
                        arrival.event(returned.event, values);
                    }
                }
            });
        });
    }
}

/// Where the fields of returns begin in their scratch, behind the result and the error.
const FIRST: usize = 2;

/// Puts the fields of returns where the events want them, one event after the other.
fn gather(returns: &[Returned], note: &Note, scratch: &mut Scratch) {
    for (number, source) in returns.iter().flat_map(|r| &r.fields).enumerate() {
        match source {
            Source::Result => scratch.copy(RESULT, FIRST + number),
            Source::Error => scratch.copy(ERROR, FIRST + number),
            Source::Carried(carried) => scratch.fill(FIRST + number, note.field(*carried)),
            Source::Nowhere => {}
        }
    }
}

/// Fields that a call site does not have itself, or has not set, are those of the spans around it.
fn inherit(site: &Site, note: &Note, scratch: &mut Scratch) {
    for &(slot, carried) in site.raises.iter().flat_map(|raise| &raise.inherited) {
        scratch.fill(slot, note.field(carried));
    }
}

/// The spans around one, from the inside out.
fn ancestors<'a, S>(span: Option<SpanRef<'a, S>>) -> impl Iterator<Item = u64> + use<'a, S>
where
    S: for<'l> LookupSpan<'l>,
{
    span.into_iter().flat_map(|span| span.scope().skip(1)).map(|span| span.id().into_u64())
}

impl<S> Layer<S> for MonitorLayer
where
    S: Subscriber + for<'a> LookupSpan<'a>,
{
    fn on_new_span(&self, attributes: &span::Attributes<'_>, id: &span::Id, context: Context<'_, S>) {
        if let Some(Entry::Site(site)) = self.shared.sites.entry(attributes.metadata()) {
            self.begin(&site, attributes, id, &context);
        }
    }

    fn on_record(&self, id: &span::Id, values: &span::Record<'_>, context: Context<'_, S>) {
        let Some(metadata) = context.metadata(id) else { return };
        let Some(Entry::Site(site)) = self.shared.sites.entry(metadata) else { return };
        Scratch::with(site.width, |scratch| {
            values.record(&mut Take { site: &site, into: scratch });
            let mut below = 0;
            if let Some(plan) = &site.span {
                self.spans.change(id.into_u64(), |note| {
                    note.take(scratch.values().get(plan.carried.clone()).unwrap_or_default());
                    below = note.inside;
                    inherit(&site, note, scratch);
                });
            } else if site.asks_around {
                below = self.look_around(context.span(id), &site, scratch);
            }
            let passing = Passing { values: scratch.values(), below, begins: false };
            self.shared.pass(Bringer::Subscriber, &site, passing);
        });
    }

    fn on_event(&self, event: &Event<'_>, context: Context<'_, S>) {
        match self.shared.sites.entry(event.metadata()) {
            Some(Entry::Site(site)) => self.event(&site, event, &context),
            Some(Entry::Return) => self.returned(event, &context),
            None => {}
        }
    }

    /// A panic leaves a function here, also where somebody catches it and lets go of the function's span later.
    fn on_exit(&self, id: &span::Id, _: Context<'_, S>) {
        if std::thread::panicking() {
            self.spans.change(id.into_u64(), |note| note.has_panicked = note.ends_by_panic());
        }
    }

    /// The end of a function that did not record what it returned is its return, unless a panic ends it, or it is known to record that: then
    /// its future was dropped.
    fn on_close(&self, id: span::Id, _context: Context<'_, S>) {
        let Some(note) = self.spans.end(id.into_u64()) else { return };
        let site = note.site.clone().filter(|site| site.span.as_ref().is_some_and(|s| !s.returns.is_empty()));
        let is_return = |site: &Arc<Site>| !note.has_returned && !note.ends_by_panic() && !site.origin.records_result();
        if let Some(site) = site.filter(is_return) {
            site.origin.note_end_without_return();
            self.tell_return(&site, |_| {}, |look| look(&note));
        }
        self.spans.recycle(id.into_u64(), note);
    }
}
