//! What a connector says, as the stream that is judged; and what it is asked for in turn.

use std::collections::VecDeque;

use bytes::Bytes;
use lapwing_record::RawChannel;
use lapwing_ros::connector::{Arrival, Cause as Unseen, Happening, Offer};
use lapwing_stream::Time;

use super::{Duty, Station};
use crate::live::clock::{CLOCK, ClockChoice};
use crate::live::course::{Seen, Sight};
use crate::live::graph::{Graph, absolute};
use crate::spec::Spec;
use crate::status::{Cause, Kind, Status, Stream};

/// So many last messages of a topic are kept for specifications that are loaded later, where those who come late are handed them.
const LATCHED: usize = 64;

/// What was met on the graph, for specifications that are loaded later.
pub(super) struct Met {
    pub channel: RawChannel,
    pub latched: bool,
    pub publishers: u64,
    /// The last messages, where they are handed to those who come late.
    pub last: VecDeque<Bytes>,
}

impl Station {
    /// Something arrived.
    pub(super) fn arrived(&mut self, specs: &[Spec], arrival: Arrival, duty: &mut Duty<'_, '_>) {
        let Arrival { at, what } = arrival;
        let seen = match what {
            Happening::Stream(offer) => return self.offered(specs, at, offer, duty),
            Happening::Publishers { stream, count } => {
                let count = count as u64;
                let Some(met) = self.known.get_mut(&stream.0) else { return };
                met.publishers = count;
                Seen::Status(Status::Publishers(name_of(&met.channel), count))
            }
            Happening::Message { stream, payload } => {
                if let Some(met) = self.known.get_mut(&stream.0).filter(|met| met.latched) {
                    if met.last.len() >= LATCHED {
                        met.last.pop_front();
                    }
                    met.last.push_back(payload.clone());
                }
                self.figures.messages += 1;
                duty.has_heard = true;
                Seen::Message { stream: stream.0, payload }
            }
            Happening::Lost { stream, count } => {
                self.figures.lost += count;
                let Some(met) = self.known.get(&stream.0) else { return };
                Seen::Status(Status::Lost(name_of(&met.channel), count))
            }
            Happening::Blind { topic, cause } => {
                let (topic, cause) = (absolute(&topic), cause_of(cause));
                if topic == CLOCK && self.clock.is_simulated() {
                    duty.watch.note(&format!("simulated time stands still: /clock cannot be seen: {cause}"));
                }
                self.unseen.insert((topic.clone(), cause.clone()));
                Seen::Status(Status::Blind(Some(topic), cause))
            }
            Happening::Sees { topic, cause } => {
                let (topic, cause) = (absolute(&topic), cause_of(cause));
                self.unseen.remove(&(topic.clone(), cause.clone()));
                Seen::Status(Status::Sees(Some(topic), cause))
            }
            Happening::Reply { call, answer } => {
                let answer = answer.as_ref().map(|bytes| &bytes[..]).map_err(String::as_str);
                let told = duty.reactions.answered(call, answer);
                return told.into_iter().for_each(|text| duty.watch.note(&text));
            }
            Happening::Note(text) => return duty.watch.note(&text),
        };
        self.see(Sight { at, what: seen }, Some(at), duty);
    }

    /// A stream is there, or more is known of it: it may be one that a specification waits for.
    fn offered(&mut self, specs: &[Spec], at: Time, offer: Offer, duty: &mut Duty<'_, '_>) {
        let (stream, topic) = (offer.stream.0, absolute(&offer.channel.topic));
        let met = self.known.entry(stream).or_insert_with(|| Met {
            channel: offer.channel.clone(),
            latched: offer.latched,
            publishers: 1,
            last: VecDeque::new(),
        });
        (met.channel, met.latched) = (offer.channel.clone(), offer.latched);
        let what = Seen::Offered { stream, channel: Box::new(offer.channel), latched: offer.latched };
        let was_wall = self.clock.is_wall();
        self.see(Sight { at, what }, Some(at), duty);
        if topic == CLOCK && self.clock.is_simulated() {
            self.subscribe(vec![CLOCK.to_owned()]);
        } else if topic == CLOCK && was_wall && self.options.clock == ClockChoice::Auto {
            duty.is_misled = !duty.has_heard;
            if duty.has_heard {
                let late = "somebody publishes /clock now, but this run goes by the wall clock";
                duty.watch.note(&format!("{late}: begin it anew, or with --clock sim"));
            }
        }
        self.is_unasked |= specs.iter().any(Spec::runs_over_topics);
    }

    /// Subscribes to what was met and is wanted by specifications that run over topics. One look at a graph makes many offers: they are considered
    /// together, once nothing more is at hand, or messages come again.
    pub(super) fn ask_for_more(&mut self, specs: &[Spec], next: Option<&Arrival>) {
        let is_over = next.is_none_or(|arrival| matches!(arrival.what, Happening::Message { .. }));
        if self.is_unasked && is_over {
            self.is_unasked = false;
            let wanted = self.wanted_of_all(specs);
            self.subscribe(wanted);
        }
    }

    /// The topics that specifications would want if everything that is on the graph could be read.
    fn wanted_of_all(&self, specs: &[Spec]) -> Vec<String> {
        let mut graph = Graph::default();
        for (stream, met) in &self.known {
            graph.offer(Time(0), *stream, met.channel.clone(), met.latched);
        }
        let shape = graph.whole_shape();
        let topics = specs.iter().flat_map(|spec| spec.against(&shape).spec.topics);
        topics.map(|topic| topic.name).filter(|name| !name.contains('{')).collect()
    }

    pub(super) fn subscribe(&mut self, topics: Vec<String>) {
        let new: Vec<String> = topics.into_iter().filter(|topic| self.subscribed.insert(topic.clone())).collect();
        if !new.is_empty() {
            self.connector.subscribe(&new);
        }
    }
}

/// A stream by its name.
pub(super) fn name_of(channel: &RawChannel) -> Stream {
    Stream { topic: channel.topic.clone(), type_name: channel.type_name.clone() }
}

fn cause_of(cause: Unseen) -> Cause {
    match cause {
        Unseen::NoPublisher => Cause::new(Kind::NoPublisher, ""),
        Unseen::Incompatible(what) => Cause::new(Kind::Incompatible, what),
        Unseen::Undefined(what) => Cause::new(Kind::Undefined, what),
        Unseen::Disconnected(what) => Cause::new(Kind::Disconnected, what),
    }
}
