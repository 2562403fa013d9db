//! The course of a run: from what was seen, in its order and with its stamps, to verdicts.
//!
//! It has no clock, and talks to nobody but the [`Watch`]: a live run feeds it what happens, a check of its recording what was recorded, and
//! both get the same report. A live run also says how far time has come while nothing happens ([`Course::pass`]); that only reveals
//! sooner what is decided by then.

use std::collections::BTreeMap;

use bytes::Bytes;
use lapwing_react::history::History;
use lapwing_react::shown::Origin;
use lapwing_react::{Event, Property, Report, Topic, Violation, Warning};
use lapwing_record::RawChannel;
use lapwing_stream::{Duration, Time};

use super::blind::Ledger;
use super::graph::{Graph, Stream};
use super::order::Order;
use super::post::Post;
use super::rhythm::{Rhythm, Silence};
use super::view::Tally;
use crate::losses::Damage;
use crate::run::Untold;
use crate::session::Options;
use crate::spec::Spec;
use crate::status::{Cause, Kind, Status};
use crate::watch::Watch;

/// So many warnings of one kind about one topic are told; further ones only count in verdicts.
const TOLD: u32 = 20;

/// After this time it is told that nothing is there for a property to read, in nanoseconds.
const GRACE: i64 = 1_000_000_000;

/// The word for warnings of silence.
const SILENCE: &str = "silence";

/// One thing that was seen.
#[derive(Clone, Debug)]
pub(crate) struct Sight {
    /// Its stamp.
    pub at: Time,
    /// What it is.
    pub what: Seen,
}

/// What can be seen.
#[derive(Clone, Debug)]
pub(crate) enum Seen {
    /// A stream of messages is there, or more is known of it.
    Offered {
        /// What it is called from now on.
        stream: u32,
        /// Topic, type and definition.
        channel: Box<RawChannel>,
        /// Whether those who come late are handed its last message.
        latched: bool,
    },
    /// A message.
    Message {
        /// Its stream.
        stream: u32,
        /// Its bytes.
        payload: Bytes,
    },
    /// Anything else.
    Status(Status),
}

/// A violation that is to be answered at once.
#[derive(Debug)]
pub(crate) struct Alarm {
    /// The number of the specification.
    pub spec: usize,
    /// The property, with its instance.
    pub property: Property,
    /// What is known of the violation.
    pub violation: Violation,
}

/// How things stand of a property.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Stand {
    /// Whether it is being judged: it has begun, and everything that it reads can be seen.
    pub is_judged: bool,
    /// How many of its obligations have failed, since time jumped last.
    pub failed: u64,
}

/// The course of a run.
pub(crate) struct Course<'s> {
    pub posts: Vec<Post<'s>>,
    pub graph: Graph,
    pub ledger: Ledger,
    rhythms: BTreeMap<String, Rhythm>,
    order: Option<Order>,
    options: Options,
    report: Report,
    pub damage: Damage,
    /// Whether the graph has changed in a way that a specification minds.
    is_stale: bool,
    /// The stamp of the first message, and of the last thing that was seen.
    heard: Option<Time>,
    last: Option<Time>,
    /// Whether it was told which properties have nothing to read.
    has_counted: bool,
    /// How often something was warned of.
    told: BTreeMap<(Option<String>, &'static str), u32>,
    /// The violations that have not been answered yet, where somebody answers.
    alarms: Option<Vec<Alarm>>,
    /// How many violations there were, in all and of each property.
    pub violations: u64,
    pub tally: Tally,
}

impl<'s> Course<'s> {
    /// Of specifications over something that reports call `source`.
    pub fn new(specs: &'s [Spec], source: &str, options: &Options) -> Course<'s> {
        let posts: Vec<Post> = specs.iter().map(Post::new).collect();
        let report = Report {
            specs: specs.iter().map(|s| s.name().to_owned()).collect(),
            trace: source.to_owned(),
            properties: posts.iter().flat_map(|post| post.blanks().cloned()).collect(),
            topics: topics(&posts),
            ..Report::default()
        };
        Course {
            posts,
            graph: Graph::default(),
            ledger: Ledger::default(),
            rhythms: BTreeMap::new(),
            order: Order::wanted(&options.recording),
            options: options.clone(),
            report,
            damage: Damage::default(),
            is_stale: true,
            heard: None,
            last: None,
            has_counted: false,
            told: BTreeMap::new(),
            alarms: None,
            violations: 0,
            tally: Tally::default(),
        }
    }

    /// Somebody looks on, and wants to see what the signals do.
    pub fn draw(&mut self) {
        self.posts.iter_mut().for_each(|post| post.draws = true);
    }

    /// Somebody answers violations, and takes the alarms after every step: without that none are kept.
    pub fn alarm(&mut self) {
        self.alarms = Some(Vec::new());
    }

    /// The violations since this was asked last.
    pub fn take_alarms(&mut self) -> Vec<Alarm> {
        self.alarms.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Says what is watched.
    pub fn start(&mut self, watch: &mut dyn Watch) {
        watch.event(Event::Start(&self.report));
    }

    /// The topics that are to be subscribed to, as far as they are known.
    pub fn wanted(&self) -> Vec<String> {
        topics(&self.posts).into_iter().map(|topic| topic.name).collect()
    }

    /// What is watched, as reports call it.
    pub fn source(&self) -> &str {
        &self.report.trace
    }

    /// Whether margins are computed.
    pub fn measures(&self) -> bool {
        self.options.margins
    }

    /// The topics that are read, each once.
    pub fn topics(&self) -> Vec<Topic> {
        topics(&self.posts)
    }

    /// Takes in what was seen.
    pub fn take(&mut self, sight: Sight, watch: &mut dyn Watch) {
        let Some(order) = &mut self.order else { return self.see(sight, watch) };
        order.push(sight);
        while let Some(sight) = self.order.as_mut().and_then(Order::pop) {
            self.see(sight, watch);
        }
    }

    /// Time has come so far, and nothing was seen meanwhile.
    pub fn pass(&mut self, now: Time, watch: &mut dyn Watch) {
        if self.order.is_none() && self.last.is_none_or(|last| last <= now) {
            self.silences(now, watch);
            self.posts.iter_mut().flat_map(|post| &mut post.shifts).for_each(|shift| shift.pass(now));
            self.tell(watch);
        }
    }

    /// When something happens though nothing is seen.
    pub fn next_deadline(&mut self) -> Option<Time> {
        if self.order.is_some() {
            return None;
        }
        let counts = self.counts_at().filter(|_| !self.has_counted);
        let shifts = self.posts.iter_mut().flat_map(|post| &mut post.shifts);
        let deadlines = shifts.filter_map(|shift| shift.run.next_deadline());
        deadlines.chain(self.rhythms.values().filter_map(Rhythm::deadline)).chain(counts).min()
    }

    /// When it is told which properties have nothing to read.
    fn counts_at(&self) -> Option<Time> {
        self.first().map(|first| first + Duration::from_nanos(GRACE))
    }

    /// How things stand of a property of a specification, all of its instances together.
    pub fn stand(&self, spec: usize, property: &str) -> Stand {
        let Some(post) = self.posts.get(spec) else { return Stand::default() };
        post.stand(property, |topic| self.causes_now(topic).next().is_none())
    }

    /// Why nothing can be judged now that reads a topic, as far as that is so: what stands in the way of seeing it, and that it has been silent
    /// for longer than a specification allows.
    pub fn causes_now(&self, topic: &str) -> impl Iterator<Item = String> {
        let silence = self.rhythms.get(topic).and_then(Rhythm::too_long);
        let silence = silence.map(|limit| format!("nothing came for longer than {limit}, its `stale after`"));
        self.ledger.now(topic).map(ToString::to_string).chain(silence)
    }

    /// The stamp of the first thing that was seen.
    pub fn first(&self) -> Option<Time> {
        self.report.span.map(|(first, _)| first)
    }

    /// The stamp of the last thing that was seen.
    pub fn last(&self) -> Option<Time> {
        self.last
    }

    /// A part of the recording could not be read.
    pub fn damaged(&mut self, damage: Damage) {
        self.damage = damage;
    }

    /// The run is over.
    pub fn finish(mut self, watch: &mut dyn Watch) -> (Report, Vec<History>) {
        while let Some(sight) = self.order.as_mut().and_then(Order::drain) {
            self.see(sight, watch);
        }
        let last = self.last.unwrap_or_default();
        if self.is_stale {
            self.refresh(last, watch);
        }
        self.ledger.end_all(last);
        let origin = Origin::of(&self.report);
        self.report.properties.clear();
        for number in 0..self.posts.len() {
            let Some(post) = self.posts.get_mut(number) else { continue };
            let properties = post.finish(&self.damage, &self.ledger, origin);
            let warnings = post.warnings(&properties);
            self.tell(watch);
            warnings.into_iter().for_each(|w| self.warn(w, watch));
            self.report.properties.extend(properties);
        }
        self.report.topics = self.counted();
        let runs = || self.posts.iter().flat_map(|post| &post.shifts).map(|shift| &shift.run);
        self.report.instants = runs().map(|run| run.instants()).max().unwrap_or_default();
        self.report.gaps = std::mem::take(&mut self.damage.gaps);
        self.report.properties.iter().for_each(|p| watch.event(Event::Verdict(p)));
        watch.event(Event::End(&self.report));
        let histories: Vec<History> = self.posts.into_iter().filter_map(Post::into_history).collect();
        // A chart stands beside its property: where one is missing there are none.
        let drawn: usize = histories.iter().map(|history| history.courses.len()).sum();
        let is_whole = drawn == self.report.properties.len();
        (self.report, if is_whole { histories } else { Vec::new() })
    }

    /// Takes in what comes next in the order of time.
    fn see(&mut self, Sight { at, what }: Sight, watch: &mut dyn Watch) {
        if let Some(last) = self.last.filter(|last| at < *last) {
            self.ledger.jump(last, at);
            self.graph.forget(at);
            self.rhythms.clear();
            // Silences count from the new beginning on.
            (self.heard, self.is_stale) = (None, true);
        }
        self.last = Some(at);
        let (start, end) = self.report.span.unwrap_or((at, at));
        self.report.span = Some((start.min(at), end.max(at)));
        self.silences(at, watch);
        match what {
            Seen::Offered { stream, channel, latched } => self.offered(at, stream, *channel, latched, watch),
            Seen::Message { stream, payload } => self.message(at, stream, &payload, watch),
            Seen::Status(status) => self.status(at, status, watch),
        }
        self.tell(watch);
    }

    fn offered(&mut self, at: Time, stream: u32, channel: RawChannel, latched: bool, watch: &mut dyn Watch) {
        let is_readable = channel.ty.is_ok();
        self.graph.offer(at, stream, channel, latched);
        self.posts.iter_mut().flat_map(|post| &mut post.shifts).for_each(|shift| shift.unbind(stream));
        let topic = self.graph.get(stream).map(|s| s.topic.clone()).unwrap_or_default();
        let is_minded = self.posts.iter().any(|post| post.minds(&topic));
        self.is_stale |= is_minded;
        if is_minded && is_readable {
            self.reveal(watch);
        }
        self.mind_types(at, &topic, watch);
        self.published(at, watch);
    }

    /// Says at once what a type that has become known shows of the specifications, though nothing may come of it for long.
    fn reveal(&mut self, watch: &mut dyn Watch) {
        let shape = self.graph.shape();
        let Course { posts, options, .. } = self;
        let warnings: Vec<Warning> = posts.iter_mut().flat_map(|post| post.reveal(&shape, options)).collect();
        warnings.into_iter().for_each(|w| self.warn(w, watch));
    }

    fn message(&mut self, at: Time, stream: u32, payload: &Bytes, watch: &mut dyn Watch) {
        self.heard.get_or_insert(at);
        if self.is_stale {
            self.refresh(at, watch);
        }
        self.graph.message(stream, at, payload);
        let Course { posts, graph, rhythms, .. } = self;
        let (mut is_read, mut fault) = (false, None);
        for shift in posts.iter_mut().flat_map(|post| &mut post.shifts) {
            match shift.message(graph, at, stream, payload) {
                Ok(reads) => is_read |= reads,
                Err(why) => fault = Some(why),
            }
        }
        let Some(Stream { topic, latched, .. }) = graph.get(stream) else { return };
        // What is handed to those who come late has no rhythm.
        if is_read
            && !latched
            && let Some(silent) = heard(rhythms, topic, at)
        {
            let topic = topic.clone();
            let message = format!("{topic} is back after {} of silence", brief(silent));
            self.warn_of(at, Some(&topic), SILENCE, message, watch);
        }
        self.undecodable(at, stream, fault, is_read, watch);
    }

    /// A message that cannot be decoded blinds, until one can.
    fn undecodable(&mut self, at: Time, stream: u32, fault: Option<String>, is_read: bool, watch: &mut dyn Watch) {
        let Some(Stream { topic, .. }) = self.graph.get(stream) else { return };
        match (fault, self.ledger.is_open(topic, Kind::Undecodable)) {
            (Some(why), false) => self.blind(at, Some(topic.clone()), Cause::new(Kind::Undecodable, why), watch),
            (None, true) if is_read => {
                let (topic, now) = (topic.clone(), self.ledger.now(topic));
                let causes: Vec<Cause> = now.filter(|c| c.kind == Kind::Undecodable).cloned().collect();
                causes.into_iter().for_each(|cause| self.sees(at, Some(topic.clone()), &cause, watch));
            }
            _ => {}
        }
    }

    fn status(&mut self, at: Time, status: Status, watch: &mut dyn Watch) {
        self.posts.iter_mut().flat_map(|post| &mut post.shifts).for_each(|shift| shift.pass(at));
        match status {
            Status::Began { .. } | Status::Offered { .. } => {}
            Status::Alive => {
                if self.is_stale {
                    self.refresh(at, watch);
                }
            }
            Status::Publishers(of, count) => {
                let topic = super::graph::absolute(&of.topic);
                if let Some(stream) = self.graph.find(&topic, &of.type_name) {
                    self.graph.publish(stream, count);
                }
                self.is_stale |= count > 0 && self.posts.iter().any(|post| post.minds(&topic));
                self.mind_types(at, &topic, watch);
                self.published(at, watch);
            }
            Status::Lost(of, count) => {
                let topic = super::graph::absolute(&of.topic);
                self.ledger.moment(at, &Some(topic.clone()), &Cause::new(Kind::Lost, ""));
                let what = if count == 1 { "1 message of".to_owned() } else { format!("{count} messages of") };
                self.warn_of(
                    at,
                    Some(&topic),
                    Kind::Lost.word(),
                    format!("{what} {topic} were lost: too many came at once"),
                    watch,
                );
            }
            Status::Blind(topic, cause) => self.blind(at, topic, cause, watch),
            Status::Sees(topic, cause) => self.sees(at, topic, &cause, watch),
            Status::Leapt { from } => {
                let by = at.since(Time(from));
                let cause = Cause::new(Kind::Leapt, format!("by {by}"));
                self.ledger.moment(at, &None, &cause);
                self.warn_of(at, None, Kind::Leapt.word(), format!("{cause}, from {} to {at}", Time(from)), watch);
            }
            Status::Reset(property) => self.posts.iter_mut().for_each(|post| post.reset(&property)),
            Status::Ended(None) => {}
            Status::Ended(Some(why)) => self.damage.break_off(why),
        }
    }

    /// Publishers came or went: a specification may count them.
    fn published(&mut self, at: Time, watch: &mut dyn Watch) {
        if !self.posts.iter().any(Post::counts_publishers) {
            return;
        }
        if self.is_stale {
            self.refresh(at, watch);
        }
        let Course { posts, graph, .. } = self;
        posts.iter_mut().for_each(|post| post.count_publishers(graph, at));
    }

    /// A topic that is published with two types is read with one of them: then not all of it can be seen.
    fn mind_types(&mut self, at: Time, topic: &str, watch: &mut dyn Watch) {
        if !self.posts.iter().any(|post| post.is_concerned(topic)) {
            return;
        }
        let other = self.graph.other_types(topic);
        let open: Vec<Cause> = self.ledger.now(topic).filter(|c| c.kind == Kind::OtherType).cloned().collect();
        let of = || Some(topic.to_owned());
        for cause in open.iter().filter(|cause| !other.contains(&cause.detail)) {
            self.sees(at, of(), cause, watch);
        }
        for detail in other {
            let cause = Cause::new(Kind::OtherType, detail);
            if !open.contains(&cause) {
                self.blind(at, of(), cause, watch);
            }
        }
    }

    fn blind(&mut self, at: Time, of: Option<String>, cause: Cause, watch: &mut dyn Watch) {
        let is_concerned = of.as_ref().is_none_or(|topic| self.posts.iter().any(|post| post.is_concerned(topic)));
        if self.ledger.begin(at, &of, &cause) && is_concerned {
            let topic = of.as_deref().unwrap_or("the graph");
            let meant = if cause.kind == Kind::NoPublisher { self.graph.meant_by(topic) } else { None };
            let question = meant.map(|other| format!("; did you mean {other}?")).unwrap_or_default();
            let message = format!("{topic} cannot be seen: {cause}{question}");
            self.warn_of(at, of.as_deref(), cause.kind.word(), message, watch);
        }
    }

    fn sees(&mut self, at: Time, of: Option<String>, cause: &Cause, watch: &mut dyn Watch) {
        let Some(since) = self.ledger.end(at, &of, cause) else { return };
        if let (Some(topic), Kind::NoPublisher) = (&of, cause.kind) {
            self.posts.iter_mut().for_each(|post| post.had_nobody(topic, at));
        }
        let is_concerned = of.as_ref().is_none_or(|topic| self.posts.iter().any(|post| post.is_concerned(topic)));
        if is_concerned {
            let (topic, lasted) = (of.as_deref().unwrap_or("the graph"), brief(at.since(since)));
            let left = of.as_deref().and_then(|topic| self.ledger.now(topic).next());
            let message = match (left, cause.kind) {
                (Some(left), _) => {
                    format!("{topic} still cannot be seen: {left} (and no more, after {lasted}: {cause})")
                }
                (None, Kind::NoPublisher) if !self.graph.had(topic, since) => {
                    format!("{topic} is published now, after {lasted}")
                }
                (None, Kind::NoPublisher) => format!("{topic} is published again after {lasted}"),
                (None, _) => format!("{topic} can be seen again after {lasted}"),
            };
            self.warn_of(at, of.as_deref(), cause.kind.word(), message, watch);
        }
    }

    /// Looks at the graph anew.
    fn refresh(&mut self, at: Time, watch: &mut dyn Watch) {
        self.is_stale = false;
        let shape = self.graph.shape();
        let Course { posts, graph, options, .. } = self;
        let warnings: Vec<Warning> =
            posts.iter_mut().flat_map(|post| post.refresh(graph, &shape, at, options)).collect();
        warnings.into_iter().for_each(|w| self.warn(w, watch));
        let since = self.heard.unwrap_or(at);
        for (topic, limit) in self.posts.iter().flat_map(|post| &post.limits) {
            self.rhythms.entry(topic.clone()).or_default().limit(*limit, since);
        }
    }

    /// Tells, once, which properties cannot be judged and read no topic of which that could be told.
    fn count(&mut self, now: Time, watch: &mut dyn Watch) {
        let Some(at) = self.counts_at().filter(|at| !self.has_counted && *at <= now) else { return };
        self.has_counted = true;
        let idle: Vec<String> = self.posts.iter().flat_map(Post::idle).collect();
        idle.into_iter().for_each(|message| self.warn(Warning { at: Some(at), ..Warning::plain(message) }, watch));
    }

    /// Tells of topics that have been silent for too long by then, and of properties that have none.
    fn silences(&mut self, now: Time, watch: &mut dyn Watch) {
        self.count(now, watch);
        let due = |(topic, rhythm): (&String, &Rhythm)| {
            rhythm.deadline().filter(|deadline| *deadline <= now).map(|deadline| (deadline, topic.clone()))
        };
        let mut due: Vec<(Time, String)> = self.rhythms.iter().filter_map(due).collect();
        due.sort();
        for (deadline, topic) in due {
            let message = match self.rhythms.get_mut(&topic).and_then(Rhythm::tell) {
                Some(Silence::TooLong(limit)) => {
                    format!("nothing came on {topic} for longer than {limit}, its `stale after`")
                }
                Some(Silence::Unusual(silent, period)) => {
                    format!(
                        "nothing came on {topic} for {}: before, a message came every {}",
                        brief(silent),
                        brief(period)
                    )
                }
                None => continue,
            };
            self.warn_of(deadline, Some(&topic), SILENCE, message, watch);
        }
    }

    /// Tells what the monitors have found since they were last asked.
    fn tell(&mut self, watch: &mut dyn Watch) {
        let mut warnings = Vec::new();
        for (spec, post) in self.posts.iter_mut().enumerate() {
            for run in post.shifts.iter_mut().map(|shift| &mut shift.run) {
                warnings.extend(std::iter::from_fn(|| run.jump()));
                while let Some(Untold { property, violation, is_further, .. }) = run.news() {
                    watch.event(Event::Violation { property: &property, violation: &violation });
                    let (count, latest) = self.tally.entry((spec, property.name.clone())).or_default();
                    (*count, *latest) = (*count + 1, violation.failed);
                    self.violations += 1;
                    if let (Some(alarms), false) = (&mut self.alarms, is_further) {
                        alarms.push(Alarm { spec, property, violation });
                    }
                }
            }
        }
        warnings.dedup();
        warnings.into_iter().for_each(|w| self.warn(w, watch));
    }

    fn warn_of(&mut self, at: Time, of: Option<&str>, kind: &'static str, message: String, watch: &mut dyn Watch) {
        let told = self.told.entry((of.map(str::to_owned), kind)).or_default();
        *told += 1;
        match (*told).cmp(&TOLD) {
            std::cmp::Ordering::Less => self.warn(Warning { at: Some(at), ..Warning::plain(message) }, watch),
            std::cmp::Ordering::Equal => {
                let message = format!("{message} (further warnings like this one are left out)");
                self.warn(Warning { at: Some(at), ..Warning::plain(message) }, watch);
            }
            std::cmp::Ordering::Greater => {}
        }
    }

    fn warn(&mut self, warning: Warning, watch: &mut dyn Watch) {
        watch.event(Event::Warning(&warning));
        self.report.warnings.push(warning);
    }

    /// The topics with what came of each.
    fn counted(&self) -> Vec<Topic> {
        let runs = || self.posts.iter().flat_map(|post| &post.shifts).map(|shift| &shift.run);
        let counts: Vec<Topic> = runs().flat_map(|run| run.topics()).collect();
        let mut topics = topics(&self.posts);
        for topic in &mut topics {
            let same = || counts.iter().filter(|t| t.name == topic.name);
            let (messages, unseen) = (same().map(|t| t.messages).max(), same().map(|t| t.unseen).max());
            (topic.messages, topic.unseen) = (messages.unwrap_or_default(), unseen.unwrap_or_default());
        }
        topics
    }
}

/// A message of a topic came. Gives how long the silence before it was, where it had been told.
fn heard(rhythms: &mut BTreeMap<String, Rhythm>, topic: &str, at: Time) -> Option<Duration> {
    // An entry would take a copy of the name for each message.
    match rhythms.get_mut(topic) {
        Some(rhythm) => rhythm.heard(at),
        None => rhythms.entry(topic.to_owned()).or_default().heard(at),
    }
}

/// The topics of all specifications, each once.
fn topics(posts: &[Post<'_>]) -> Vec<Topic> {
    let mut topics: Vec<Topic> = Vec::new();
    for topic in posts.iter().flat_map(|post| post.topics()) {
        match topics.iter_mut().find(|t| t.name == topic.name) {
            Some(known) => known.type_name = known.type_name.take().or_else(|| topic.type_name.clone()),
            None => topics.push(topic.clone()),
        }
    }
    topics
}

/// A duration to the millisecond, for people.
fn brief(duration: Duration) -> String {
    let whole = duration.nanos() / 1_000_000 * 1_000_000;
    if whole == 0 { duration.to_string() } else { Duration::from_nanos(whole).to_string() }
}
