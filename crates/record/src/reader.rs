//! Reads a recording from its beginning to its end, decoding the wanted fields.

use std::sync::Arc;

use lapwing_stream::{Name, Time, Value};

use crate::cells::Cells;
use crate::decode::{Decoder, MessageType};
use crate::error::{Loss, Losses, ReadError};
use crate::format::{Head, Source};
use crate::met::Met;
use crate::options::{Limits, Options, TimeSource};
use crate::path::Path;
use crate::recording::Wanted;
use crate::reorder::{Held, Kind, Reorder};
use crate::stamp;

/// What comes next in a recording. It may be looked at until the next call of [`Reader::next`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Item<'a> {
    /// A message of a topic.
    Message {
        /// When.
        time: Time,
        /// Which of the wanted topics; `None` where it is not wanted, or could not be decoded: only its time is known.
        wanted: Option<usize>,
        /// Its topic, as recorded.
        topic: &'a str,
        /// One per wanted field, in order; [`Value::Missing`] where the message has no such field or element.
        values: &'a [Value],
    },
    /// A row of CSV, or the `values` of an NDJSON line.
    Row {
        /// When.
        time: Time,
        /// Those that were [chosen](crate::Recording::read_signals), in that order. Else all: of CSV in the order of
        /// [`Recording::columns`](crate::Recording::columns). An empty cell is [`Value::Missing`].
        cells: Cells<'a>,
    },
    /// An event of NDJSON.
    Event {
        /// When.
        time: Time,
        /// Its name.
        name: &'a str,
        /// All its other keys.
        fields: Cells<'a>,
    },
}

impl Item<'_> {
    /// When it was.
    pub fn time(&self) -> Time {
        match self {
            Item::Message { time, .. } | Item::Row { time, .. } | Item::Event { time, .. } => *time,
        }
    }
}

/// Reads a recording from its beginning to its end. Memory does not grow with its length.
pub struct Reader {
    source: Box<dyn Source>,
    wanted: Vec<Wanted>,
    limits: Limits,
    /// By the source's channels; those that were met late come when they are.
    bindings: Vec<Binding>,
    /// The values of the current message, by wanted topic.
    values: Vec<Vec<Value>>,
    stamp: Vec<Value>,
    by_header: bool,
    order: Option<Reorder>,
    /// The place of the item that was given last.
    given: Option<usize>,
    losses: Losses,
    /// What stopped the reading, while messages before it are still held.
    failed: Option<ReadError>,
    ended: bool,
}

/// What is done with the messages of a channel.
struct Binding {
    topic: Arc<str>,
    wanted: Option<usize>,
    /// How many fields are wanted.
    fields: usize,
    /// Decodes the wanted fields, and after them the stamp where time is by header.
    decoder: Option<Decoder>,
    /// Whether the last two values are the stamp of the header.
    stamped: bool,
    /// Whether the source tells the wanted fields without bytes.
    told: bool,
}

/// An item before it is given.
#[derive(Clone, Copy)]
struct Pulled {
    time: Time,
    what: What,
}

#[derive(Clone, Copy)]
enum What {
    Message { channel: usize, wanted: Option<usize> },
    Row,
    Event,
}

impl Reader {
    pub(crate) fn new(
        mut source: Box<dyn Source>,
        wanted: &[Wanted],
        signals: Option<&[Name]>,
        options: &Options,
    ) -> Reader {
        if let Some(signals) = signals {
            source.choose(signals);
        }
        let by_header = options.time == TimeSource::Header;
        let mut reader = Reader {
            source,
            wanted: wanted.to_vec(),
            limits: options.limits.clone(),
            bindings: Vec::new(),
            values: wanted.iter().map(|_| Vec::new()).collect(),
            stamp: Vec::new(),
            by_header,
            order: by_header.then(|| Reorder::new(options.reorder, options.limits.held)),
            given: None,
            losses: Losses::new(options.limits.losses),
            failed: None,
            ended: false,
        };
        reader.leave_out();
        reader
    }

    /// Tells the source whose messages nobody looks at.
    fn leave_out(&mut self) {
        let Reader { source, wanted, by_header, limits, .. } = self;
        let has_stamp = |ty: &MessageType| Decoder::new(ty, &stamp::paths(), limits.elements).is_ok();
        source.leave_out(&|channel| {
            position(wanted, &channel.topic).is_some() || *by_header && channel.ty.as_ref().is_ok_and(has_stamp)
        });
    }

    /// The next item, in the order of the file or, by header, of time. After an error there are no more.
    #[expect(clippy::should_implement_trait, reason = "an item borrows from the reader, which no iterator can say")]
    pub fn next(&mut self) -> Option<Result<Item<'_>, ReadError>> {
        self.next_but(|_| false)
    }

    /// The next item but for messages that nobody looks at, and of which the time is all there is to know: `passes` is told it, and says whether
    /// that was enough. If not, it comes as an item as well.
    // PERF: of most recordings most messages are so, and what is made of an item costs more than they do.
    #[inline]
    pub fn next_but(&mut self, mut passes: impl FnMut(Time) -> bool) -> Option<Result<Item<'_>, ReadError>> {
        if self.order.is_some() {
            return self.next_in_order();
        }
        while !self.ended {
            match self.source.advance(&mut self.losses) {
                Ok(Some((time, Head::Message(channel)))) if self.passes_over(channel) => {
                    self.losses.last = Some(time);
                    if !passes(time) {
                        return Some(Ok(self.item(Pulled { time, what: What::Message { channel, wanted: None } })));
                    }
                }
                Ok(Some((time, head))) => {
                    let pulled = self.pulled(time, head);
                    return Some(Ok(self.item(pulled)));
                }
                Ok(None) => self.ended = true,
                Err(error) => {
                    self.ended = true;
                    return Some(Err(error));
                }
            }
        }
        None
    }

    /// Whether nobody looks at the messages of a channel.
    #[inline]
    fn passes_over(&self, channel: usize) -> bool {
        self.bindings.get(channel).is_some_and(|binding| binding.decoder.is_none())
    }

    /// What could not be read so far.
    pub fn losses(&self) -> &[Loss] {
        self.losses.list()
    }

    /// What the recording turned out to carry, as far as it was read.
    pub fn met(&self) -> Met {
        self.source.met()
    }

    /// How much was read, and of how much: bytes, rows or parts of files. The second is 0 where it is not known.
    pub fn progress(&self) -> (u64, u64) {
        self.source.progress()
    }

    /// Reads the next item from the source.
    fn pull(&mut self) -> Result<Option<Pulled>, ReadError> {
        if self.ended {
            return Ok(None);
        }
        let found = self.source.advance(&mut self.losses);
        self.ended = !matches!(found, Ok(Some(_)));
        Ok(found?.map(|(time, head)| self.pulled(time, head)))
    }

    /// What the source has found, its fields decoded.
    #[inline]
    fn pulled(&mut self, time: Time, head: Head) -> Pulled {
        let pulled = match head {
            Head::Message(channel) => self.message(time, channel),
            Head::Row => Pulled { time, what: What::Row },
            Head::Event => Pulled { time, what: What::Event },
        };
        self.losses.last = Some(pulled.time);
        pulled
    }

    fn message(&mut self, time: Time, channel: usize) -> Pulled {
        while self.bindings.len() < self.source.channels().len() {
            self.bind();
        }
        let nothing = Pulled { time, what: What::Message { channel, wanted: None } };
        let Some(binding) = self.bindings.get_mut(channel) else { return nothing };
        if let (true, Some(wanted)) = (binding.told, binding.wanted) {
            self.source.tell(&mut self.values[wanted]);
            return Pulled { time, what: What::Message { channel, wanted: Some(wanted) } };
        }
        let Some(decoder) = &mut binding.decoder else { return nothing };
        let values = match binding.wanted {
            Some(wanted) => &mut self.values[wanted],
            None => &mut self.stamp,
        };
        values.resize_with(binding.fields + stamp::PARTS, Value::default);
        let slots = if binding.stamped { binding.fields + stamp::PARTS } else { binding.fields };
        let decoded = self
            .source
            .payload()
            .and_then(|message| decoder.decode(message, &mut values[..slots]).map_err(|e| e.to_string()));
        match decoded {
            Ok(()) => {}
            Err(_) if binding.wanted.is_none() => return nothing,
            Err(what) => {
                self.losses.add_of(self.source.place(), &binding.topic, format!("a message is lost: {what}"));
                return nothing;
            }
        }
        let time = if binding.stamped { stamp::time(&values[binding.fields..]).unwrap_or(time) } else { time };
        Pulled { time, what: What::Message { channel, wanted: binding.wanted } }
    }

    /// Decides what is done with the next channel that has no binding yet.
    fn bind(&mut self) {
        let channel = &self.source.channels()[self.bindings.len()];
        let (topic, ty) = (channel.topic.clone(), channel.ty.clone());
        let wanted = position(&self.wanted, &topic);
        let fields = wanted.map_or(&[][..], |k| &self.wanted[k].fields);
        let (decoder, stamped) = match ty {
            Ok(ty) => self.decoder(&ty, fields, wanted.is_some()),
            Err(why) => (Err(why), false),
        };
        if let (Err(why), Some(_)) = (&decoder, wanted) {
            self.losses.add_of(self.source.place(), &topic, format!("its messages are lost: {why}"));
        }
        let told =
            wanted.is_some() && !self.by_header && decoder.is_ok() && self.source.tells(self.bindings.len(), fields);
        if let (true, Some(wanted)) = (told, wanted) {
            self.values[wanted].resize_with(fields.len(), Value::default);
        }
        self.bindings.push(Binding { topic, wanted, fields: fields.len(), decoder: decoder.ok(), stamped, told });
    }

    /// A decoder of the wanted fields, and whether it also reads the stamp of the header.
    fn decoder(&self, ty: &MessageType, fields: &[Path], wanted: bool) -> (Result<Decoder, String>, bool) {
        let new = |fields: &[Path]| Decoder::new(ty, fields, self.limits.elements).map_err(|e| e.to_string());
        if self.by_header {
            let with_stamp: Vec<Path> = fields.iter().cloned().chain(stamp::paths()).collect();
            match new(&with_stamp) {
                Ok(decoder) if wanted => return (Ok(decoder), true),
                Ok(decoder) => return (Ok(decoder.prefix_only()), true),
                Err(_) => {}
            }
        }
        let decoder = if wanted { new(fields) } else { Err(String::new()) };
        (decoder, false)
    }

    fn item(&self, pulled: Pulled) -> Item<'_> {
        let time = pulled.time;
        match pulled.what {
            What::Message { channel, wanted } => {
                let topic = self.bindings.get(channel).map_or("", |b| &b.topic);
                Item::Message { time, wanted, topic, values: self.fields(wanted) }
            }
            What::Row => Item::Row { time, cells: self.source.cells() },
            What::Event => Item::Event { time, name: self.source.event(), fields: self.source.cells() },
        }
    }

    /// The values of a wanted topic without its stamp.
    fn fields(&self, wanted: Option<usize>) -> &[Value] {
        let Some(wanted) = wanted else { return &[] };
        self.values[wanted].get(..self.wanted[wanted].fields.len()).unwrap_or_default()
    }

    fn next_in_order(&mut self) -> Option<Result<Item<'_>, ReadError>> {
        loop {
            let order = self.order.as_mut()?;
            if let Some(given) = self.given.take() {
                order.release(given);
            }
            if let Some((at, forced)) = order.pop() {
                if forced {
                    self.losses.add(
                        self.source.place(),
                        "messages are out of order: more than Limits::held lie within the reorder window; shorten it",
                    );
                }
                self.given = Some(at);
                return Some(Ok(self.held_item(at)));
            }
            if order.is_waiting() {
                continue;
            }
            if self.ended {
                return self.failed.take().map(Err);
            }
            match self.pull() {
                Ok(Some(pulled)) => self.hold(pulled),
                Ok(None) => self.finish(),
                Err(error) => {
                    self.failed = Some(error);
                    self.finish();
                }
            }
        }
    }

    fn finish(&mut self) {
        if let Some(order) = &mut self.order {
            order.finish();
        }
    }

    fn hold(&mut self, pulled: Pulled) {
        let Some(order) = &mut self.order else { return };
        let (at, held) = order.room();
        held.time = pulled.time;
        held.kind = match pulled.what {
            What::Message { channel, wanted } => {
                if let Some(wanted) = wanted {
                    std::mem::swap(&mut held.values, &mut self.values[wanted]);
                }
                let topic = self.bindings.get(channel).map_or_else(|| Arc::from(""), |b| b.topic.clone());
                Kind::Message { topic, wanted }
            }
            What::Row => {
                hold_cells(held, self.source.cells());
                Kind::Row
            }
            What::Event => {
                hold_cells(held, self.source.cells());
                Kind::Event(self.source.event().to_owned())
            }
        };
        order.push(at);
    }

    fn held_item(&self, at: usize) -> Item<'_> {
        let Some(Held { time, kind, values, names }) = self.order.as_ref().map(|o| o.get(at)) else {
            return Item::Row { time: Time::default(), cells: Cells::default() };
        };
        let time = *time;
        let cells = Cells::new(names, values);
        match kind {
            Kind::Message { topic, wanted } => {
                let count = wanted.map_or(0, |w| self.wanted[w].fields.len());
                Item::Message { time, wanted: *wanted, topic, values: values.get(..count).unwrap_or_default() }
            }
            Kind::Row => Item::Row { time, cells },
            Kind::Event(name) => Item::Event { time, name, fields: cells },
        }
    }
}

fn hold_cells(held: &mut Held, cells: Cells<'_>) {
    cells.names().clone_into(&mut held.names);
    cells.values().clone_into(&mut held.values);
}

/// Which of the wanted topics that is.
fn position(wanted: &[Wanted], topic: &str) -> Option<usize> {
    wanted.iter().position(|w| without_slash(&w.topic) == without_slash(topic))
}

fn without_slash(topic: &str) -> &str {
    topic.strip_prefix('/').unwrap_or(topic)
}
