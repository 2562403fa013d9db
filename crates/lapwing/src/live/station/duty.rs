//! One run of some specifications: what judges, what is recorded, and what may be done to the robot.

use bytes::Bytes;
use lapwing_record::RawChannel;
use lapwing_ros::connector::Connector;
use lapwing_stream::{Duration, Time};

use super::Onlooker;
use crate::live::course::{Course, Seen, Sight};
use crate::live::graph::absolute;
use crate::live::guard::Guard;
use crate::live::reactions::Reactions;
use crate::live::tape::Tape;
use crate::spec::Spec;

/// One run of some specifications.
pub(super) struct Duty<'r, 's> {
    pub course: Course<'s>,
    pub tape: Option<Tape>,
    pub unrecorded: Option<String>,
    pub reactions: Reactions,
    pub guards: Vec<Guard>,
    /// Whether a reaction wants the run to end.
    pub stops: bool,
    /// Whether a message came.
    pub has_heard: bool,
    /// Whether it goes by the wall clock, and should have gone by simulated time.
    pub is_misled: bool,
    /// The specifications that are to follow.
    pub next: Option<Vec<Spec>>,
    /// When it was told last how things stand.
    pub shown: Option<Time>,
    pub watch: &'r mut dyn Onlooker,
    /// When it began, and when the stream last said something, on the wall clock.
    pub began: Time,
    pub spoke: Time,
    /// When somebody was asked last whether to go on.
    pub asked: Option<Time>,
    /// How long it is to last, where the specifications say so.
    pub lasts: Option<Duration>,
}

impl Duty<'_, '_> {
    /// The topic and the bytes of a message that a guard decides on.
    pub fn guarded(&self, sight: &Sight) -> Option<(String, Bytes)> {
        let Seen::Message { stream, payload } = &sight.what else { return None };
        let topic = &self.course.graph.get(*stream)?.topic;
        self.guards.iter().any(|guard| guard.is_from(topic)).then(|| (topic.clone(), payload.clone()))
    }

    /// The type of a guarded topic is known.
    pub fn advertise(&mut self, channel: &RawChannel, connector: &mut dyn Connector) {
        let Duty { guards, reactions, watch, .. } = self;
        let topic = absolute(&channel.topic);
        for guard in guards.iter_mut().filter(|guard| guard.is_from(&topic)) {
            if let Err(why) = guard.advertise(channel, reactions, connector) {
                watch.note(&format!("nothing passes the guard of {}: {why}", channel.topic));
            }
        }
    }

    /// Writes down and judges what was seen.
    pub fn take(&mut self, sight: Sight) {
        let is_written = self.tape.as_ref().is_none_or(|tape| tape.put(sight.clone()));
        if !is_written && let Some(tape) = self.tape.take() {
            let why = tape.finish().err().unwrap_or_else(|| "the file was closed".to_owned());
            self.watch.note(&format!("the recording ends here: {why}"));
            self.unrecorded = Some(why);
        }
        self.course.take(sight, self.watch);
    }
}
