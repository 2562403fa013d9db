//! A recording of a live run, seen once more: the same things in the same order with the same stamps, and so the same report.

use std::collections::BTreeMap;
use std::path::Path;

use bytes::Bytes;
use lapwing_react::Report;
use lapwing_react::history::History;
use lapwing_record::{RawChannel, RawReader, Recording};

use super::course::{Course, Seen, Sight};
use super::graph::absolute;
use crate::losses::Damage;
use crate::session::Options;
use crate::spec::Spec;
use crate::status::{Status, Stream, TOPIC};
use crate::watch::Watch;

/// Whether a live run was recorded there.
pub(crate) fn is_of_a_run(recording: &Recording) -> bool {
    recording.topics().iter().any(|topic| absolute(&topic.name) == TOPIC)
}

/// Judges what was recorded.
pub(crate) fn replay(
    specs: &[Spec],
    recording: Recording,
    trace: &Path,
    options: &Options,
    watch: &mut dyn Watch,
) -> (Report, Vec<History>) {
    let topics: Vec<String> = recording.topics().iter().map(|topic| topic.name.clone()).collect();
    let mut course = Course::new(specs, &trace.to_string_lossy(), options);
    course.start(watch);
    let mut seen =
        Replay { reader: recording.read_raw(&topics), numbers: BTreeMap::new(), faults: Vec::new(), ended: false };
    let mut stopped = None;
    while stopped.is_none() {
        match seen.next() {
            Some(sight) => course.take(sight, watch),
            None => break,
        }
        if options.until_first_violation && course.violations > 0 {
            stopped = Some("stopped at the first violation, as asked");
        } else if !watch.goes_on() {
            stopped = Some("interrupted");
        }
    }
    let ended = seen.damage(&mut course, stopped);
    course.damaged(ended);
    course.finish(watch)
}

/// Reads a recording as what was seen.
struct Replay {
    reader: RawReader,
    /// The numbers of the streams.
    numbers: BTreeMap<Stream, u32>,
    /// What could not be understood.
    faults: Vec<String>,
    /// Whether the run came to its end.
    ended: bool,
}

impl Replay {
    /// The next thing that was seen.
    fn next(&mut self) -> Option<Sight> {
        loop {
            let message = match self.reader.next()? {
                Ok(message) => message,
                Err(error) => {
                    self.faults.push(error.to_string());
                    return None;
                }
            };
            let (at, number, payload) = (message.time, message.channel, message.payload.map(Bytes::copy_from_slice));
            let (Some(channel), Some(payload)) = (self.reader.channel(number), payload) else { continue };
            let seen = match absolute(&channel.topic) == TOPIC {
                true => self.status(&payload),
                false => {
                    let stream = Stream { topic: channel.topic.clone(), type_name: channel.type_name.clone() };
                    self.numbers.get(&stream).map(|number| Seen::Message { stream: *number, payload })
                }
            };
            if let Some(what) = seen {
                return Some(Sight { at, what });
            }
        }
    }

    fn status(&mut self, text: &[u8]) -> Option<Seen> {
        match Status::read(text) {
            Ok(Some(Status::Offered { of, is_defined, is_latched })) => {
                let next = u32::try_from(self.numbers.len()).unwrap_or(u32::MAX);
                let stream = *self.numbers.entry(of.clone()).or_insert(next);
                let channel = Box::new(if is_defined { self.channel(&of) } else { undefined(&of) });
                Some(Seen::Offered { stream, channel, latched: is_latched })
            }
            Ok(status) => {
                self.ended |= matches!(status, Some(Status::Ended(_)));
                status.map(Seen::Status)
            }
            Err(why) => {
                if self.faults.len() < MOST_FAULTS {
                    self.faults.push(format!("a message of {TOPIC} cannot be read: {why}"));
                }
                None
            }
        }
    }

    /// What the recording says of a stream.
    fn channel(&self, of: &Stream) -> RawChannel {
        let mut channels = (0..).map_while(|number| self.reader.channel(number));
        let found = channels.find(|c| c.topic == of.topic && c.type_name == of.type_name);
        found.cloned().unwrap_or_else(|| undefined(of))
    }

    /// What of the run is not in the recording, after it was read so far.
    fn damage(&self, course: &mut Course<'_>, stopped: Option<&str>) -> Damage {
        let mut damage = std::mem::take(&mut course.damage);
        let of_reader = Damage::new(self.reader.losses(), None, course.last());
        damage.gaps.extend(of_reader.gaps);
        damage.topics.extend(of_reader.topics);
        damage.hole = damage.hole.or(of_reader.hole).or_else(|| self.faults.first().cloned());
        damage.broke_off = damage.broke_off.or(of_reader.broke_off);
        damage.gaps.extend(self.faults.iter().cloned());
        match stopped {
            Some(why) => damage.break_off(why.to_owned()),
            None if !self.ended => damage.break_off("the run was cut off: its recording has no end".to_owned()),
            None => {}
        }
        damage
    }
}

/// So many messages that cannot be read are told.
const MOST_FAULTS: usize = 20;

/// A stream of which nothing is known but its name and type.
fn undefined(of: &Stream) -> RawChannel {
    RawChannel {
        topic: of.topic.clone(),
        type_name: of.type_name.clone(),
        encoding: String::new(),
        definition: Vec::new(),
        messages: String::new(),
        ty: Err("its definition was not known".to_owned()),
    }
}
