//! A station watches a graph: it turns what a connector says into the stream that is judged, wakes up when a deadline passes in
//! silence, and ends when it is told to.

mod acts;
mod arrivals;
mod duty;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use lapwing_react::Report;
use lapwing_react::history::History;
use lapwing_record::TimeSource;
use lapwing_ros::connector::{Connector, Encoding, PublisherId};
use lapwing_stream::Time;

use super::clock::{CLOCK, Clock, ClockChoice};
use super::course::{Course, Seen, Sight};
use super::figures::Figures;
use super::guard::{Guard, guards};
use super::herald::Herald;
use super::reactions::{Reach, Reactions};
use super::tape::Tape;
use super::view::{Rates, View};
use crate::session::Options;
use crate::spec::Spec;
use crate::status::{Cause, Status};
use crate::watch::Watch;
use arrivals::{Met, name_of};
use duty::Duty;

/// At least so often somebody is asked whether to go on.
const PATIENCE: Duration = Duration::from_millis(50);

/// So often the stream says that time goes on though nothing happens, in nanoseconds; by headers it does so more often, since there nothing else
/// moves time.
const ALIVE: i64 = 10_000_000_000;
const ALIVE_BY_HEADER: i64 = 200_000_000;

/// So often it is asked whether to go on while messages come, in nanoseconds.
const ASKED: i64 = 10_000_000;

/// How a graph is to be watched.
#[derive(Clone, Debug, Default)]
pub struct LiveOptions {
    /// How to judge.
    pub checking: Options,
    /// Which clock stamps.
    pub clock: ClockChoice,
    /// Where to record what was seen.
    pub record: Option<PathBuf>,
    /// What may be done to the robot.
    pub reach: Reach,
    /// The name of the node that says on the graph how things stand; without one nothing is said.
    pub herald: Option<String>,
}

/// Who looks on while a graph is watched.
pub trait Onlooker: Watch {
    /// Something worth a line that is no part of the report.
    fn note(&mut self, _text: &str) {}

    /// Whether views are to show what the signals did since the one before.
    fn draws(&self) -> bool {
        false
    }

    /// So often it wants to know how things stand; without a pause never.
    fn pause(&self) -> Option<Duration> {
        None
    }

    /// How things stand. Also told at the end.
    fn look(&mut self, _view: &View) {}

    /// A run begins, at this time of the wall clock. Told after its [start](lapwing_react::Event::Start).
    fn begins(&mut self, _at: Time) {}

    /// Specifications to go on with, where they were read again. If they can be carried out the run ends, and gives them back as what follows it;
    /// else a note says why not.
    fn reloads(&mut self) -> Option<Vec<Spec>> {
        None
    }
}

impl Onlooker for () {}

/// Why a run ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Ended {
    /// The onlooker did not want it to go on.
    Stopped,
    /// The time was up that the specifications give it.
    TimedOut,
    /// There was a violation, and it was to go on until there is one.
    AtViolation,
    /// Other specifications are to follow.
    Reloaded,
    /// A reaction said so.
    ByReaction,
}

/// What a run came to.
#[derive(Debug)]
pub struct Outcome {
    /// The report.
    pub report: Report,
    /// How it went, where that was asked for.
    pub histories: Vec<History>,
    /// Why it ended.
    pub ended: Ended,
    /// The specifications that are to follow, where it ended for them.
    pub next: Option<Vec<Spec>>,
    /// Why the recording is not complete.
    pub unrecorded: Option<String>,
}

/// Watches a graph.
pub struct Station {
    connector: Box<dyn Connector>,
    options: LiveOptions,
    clock: Clock,
    known: BTreeMap<u32, Met>,
    /// Whether something was met that specifications may read which run over topics, and have not been asked about.
    is_unasked: bool,
    /// What cannot be seen now.
    unseen: BTreeSet<(String, Cause)>,
    subscribed: BTreeSet<String>,
    /// What is published, for runs to come.
    publishers: BTreeMap<String, PublisherId>,
    figures: Figures,
    rates: Rates,
    herald: Option<Herald>,
    /// A moment on this process's clock at which nothing was waiting, and what the connector's clock said then.
    epoch: Option<(Instant, Time)>,
}

impl Station {
    /// Watches that graph.
    pub fn new(mut connector: Box<dyn Connector>, options: LiveOptions) -> Station {
        let choice = match (options.clock, connector.simulates_time()) {
            (ClockChoice::Auto, Some(true)) => ClockChoice::Simulated,
            (ClockChoice::Auto, Some(false)) => ClockChoice::Wall,
            (choice, _) => choice,
        };
        Station {
            connector,
            options,
            clock: Clock::new(choice),
            known: BTreeMap::new(),
            is_unasked: false,
            unseen: BTreeSet::new(),
            subscribed: BTreeSet::new(),
            publishers: BTreeMap::new(),
            figures: Figures::default(),
            rates: Rates::default(),
            herald: None,
            epoch: None,
        }
    }

    /// What is watched, as reports call it.
    pub fn name(&self) -> String {
        self.connector.name()
    }

    /// What was measured so far.
    pub fn figures(&self) -> &Figures {
        &self.figures
    }

    /// Where the next run is recorded.
    pub fn record_to(&mut self, path: Option<PathBuf>) {
        self.options.record = path;
    }

    /// Judges until it is to end. Another run may follow; it knows what is on the graph, and nothing else of the one before.
    ///
    /// An error says why it cannot begin: the recording cannot be written, or a reaction cannot be carried out.
    pub fn run(&mut self, specs: &[Spec], watch: &mut dyn Onlooker) -> Result<Outcome, String> {
        loop {
            if let Some(outcome) = self.attempt(specs, watch)? {
                return Ok(outcome);
            }
            self.clock = Clock::new(ClockChoice::Simulated);
            watch.note("somebody publishes /clock: the run begins anew, by simulated time");
        }
    }

    /// Makes ready what specifications do.
    fn prepare(&mut self, specs: &[Spec], reach: &Reach) -> Result<(Reactions, Vec<Guard>, Vec<String>), String> {
        let (mut reactions, notes) = Reactions::prepare(specs, reach, self.publishers.clone(), &mut *self.connector)?;
        let guards = guards(specs, reach, &mut reactions, &mut *self.connector)?;
        match !guards.is_empty() && self.options.checking.recording.time == TimeSource::Header {
            false => Ok((reactions, guards, notes)),
            true => {
                let why =
                    "a guard cannot wait until messages are in the order of their headers: leave --time header out";
                Err(why.to_owned())
            }
        }
    }

    /// A run; nothing where it turns out, before anything was judged, that the graph lives by simulated time.
    fn attempt(&mut self, specs: &[Spec], watch: &mut dyn Onlooker) -> Result<Option<Outcome>, String> {
        let began = self.connector.now();
        let mut course = Course::new(specs, &self.connector.name(), &self.options.checking);
        course.alarm();
        if watch.draws() {
            course.draw();
        }
        let (reactions, guards, notes) = self.prepare(specs, &self.options.reach.clone())?;
        let tape = self.options.record.as_deref().map(|path| Tape::create(path, self.profile())).transpose()?;
        let mut duty = Duty {
            course,
            tape,
            unrecorded: None,
            reactions,
            guards,
            stops: false,
            has_heard: false,
            is_misled: false,
            next: None,
            shown: None,
            watch,
            began,
            spoke: began,
            asked: None,
            lasts: longest(specs),
        };
        duty.course.start(duty.watch);
        duty.watch.begins(began);
        notes.iter().for_each(|note| duty.watch.note(note));
        self.speak_up(&mut duty);
        self.subscribe(duty.course.wanted());
        if self.clock.is_simulated() {
            self.subscribe(vec![CLOCK.to_owned()]);
        }
        self.is_unasked = !self.known.is_empty() && specs.iter().any(Spec::runs_over_topics);
        self.begin(&mut duty);
        let ended = loop {
            if let Some(ended) = self.is_over(&mut duty) {
                break ended;
            }
            if duty.is_misled {
                self.publishers = duty.reactions.into_publishers();
                // The next attempt writes the same file.
                duty.tape.map(Tape::finish).transpose()?;
                return Ok(None);
            }
            let patience = self.patience(&mut duty);
            let arrival = self.connector.next(patience);
            self.ask_for_more(specs, arrival.as_ref());
            match arrival {
                Some(arrival) => self.arrived(specs, arrival, &mut duty),
                None => self.idle(&mut duty),
            }
        };
        Ok(Some(self.end(ended, duty)))
    }

    fn profile(&self) -> &'static str {
        match self.connector.encoding() {
            Encoding::Ros1 => "ros1",
            Encoding::Cdr => "ros2",
        }
    }

    /// The stream begins with what is known already.
    fn begin(&mut self, duty: &mut Duty<'_, '_>) {
        let at = duty.began;
        let mut seen = vec![Seen::Status(Status::Began {
            source: self.connector.name(),
            is_simulated: self.clock.is_simulated(),
        })];
        for (stream, met) in &self.known {
            seen.push(Seen::Offered { stream: *stream, channel: Box::new(met.channel.clone()), latched: met.latched });
            seen.push(Seen::Status(Status::Publishers(name_of(&met.channel), met.publishers)));
        }
        seen.extend(
            self.unseen.iter().map(|(topic, cause)| Seen::Status(Status::Blind(Some(topic.clone()), cause.clone()))),
        );
        for (stream, met) in &self.known {
            seen.extend(met.last.iter().map(|payload| Seen::Message { stream: *stream, payload: payload.clone() }));
        }
        seen.into_iter().for_each(|what| self.see(Sight { at, what }, None, duty));
    }

    /// How long to wait for the next arrival.
    fn patience(&mut self, duty: &mut Duty<'_, '_>) -> Duration {
        if self.is_unasked {
            return Duration::ZERO;
        }
        let deadline = if self.clock.is_wall() { duty.course.next_deadline() } else { None };
        // Just beyond the deadline: at it, more may come with its stamp.
        let left = deadline.map(|at| Duration::from_nanos(at.since(self.connector.now()).nanos().unsigned_abs() + 1));
        left.map_or(PATIENCE, |left| left.min(PATIENCE))
    }

    /// Whether the run is over, and why. What takes a look at the world is asked a hundred times a second.
    fn is_over(&mut self, duty: &mut Duty<'_, '_>) -> Option<Ended> {
        if self.options.checking.until_first_violation && duty.course.violations > 0 {
            return Some(Ended::AtViolation);
        }
        if duty.stops {
            return Some(Ended::ByReaction);
        }
        let now = self.connector.now();
        if duty.asked.is_some_and(|asked| now.since(asked).nanos() < ASKED) {
            return None;
        }
        duty.asked = Some(now);
        self.show(duty);
        match () {
            () if !duty.watch.goes_on() => Some(Ended::Stopped),
            () if self.is_followed(duty) => Some(Ended::Reloaded),
            () if self.is_timed_out(duty) => Some(Ended::TimedOut),
            () => None,
        }
    }

    /// Whether other specifications are to follow, and can.
    fn is_followed(&mut self, duty: &mut Duty<'_, '_>) -> bool {
        let Some(specs) = duty.watch.reloads() else { return false };
        // What cannot be made ready must not end what runs.
        let trial = Reach { dry: true, ..self.options.reach.clone() };
        match self.prepare(&specs, &trial) {
            Ok(_) => duty.next = Some(specs),
            Err(why) => duty.watch.note(&format!("error: {why}\n  help: what runs goes on as it is")),
        }
        duty.next.is_some()
    }

    /// Whether the time is up that the specifications set themselves, on the clock in use.
    fn is_timed_out(&self, duty: &Duty<'_, '_>) -> bool {
        let Some(lasts) = duty.lasts else { return false };
        let (from, to) = match self.clock.is_simulated() {
            true => match (duty.course.first(), self.clock.simulated_now()) {
                (Some(from), Some(to)) => (from, to),
                _ => return false,
            },
            false => (duty.began, self.connector.now()),
        };
        to.since(from) >= lasts
    }

    /// Nothing arrived for a while.
    fn idle(&mut self, duty: &mut Duty<'_, '_>) {
        let now = self.connector.now();
        self.epoch = Some((Instant::now(), now));
        let mut out = Vec::new();
        self.clock.settle(now, &mut out);
        self.take_all(out, None, duty);
        if !self.clock.is_wall() {
            return;
        }
        let pause = if self.options.checking.recording.time == TimeSource::Header { ALIVE_BY_HEADER } else { ALIVE };
        if now.since(duty.spoke).nanos() >= pause {
            self.see(Sight { at: now, what: Seen::Status(Status::Alive) }, None, duty);
        } else if duty.course.next_deadline().is_some_and(|deadline| deadline < now) {
            duty.course.pass(now, duty.watch);
            self.react(None, duty);
        }
    }

    /// Something was seen at a time of the wall clock: it gets its stamp and is judged. `arrived` is when a message came.
    fn see(&mut self, sight: Sight, arrived: Option<Time>, duty: &mut Duty<'_, '_>) {
        duty.spoke = sight.at;
        let is_message = matches!(sight.what, Seen::Message { .. });
        let mut out = Vec::new();
        self.clock.stamp(sight, &mut out);
        let is_judged = is_message && !out.is_empty();
        self.take_all(out, arrived, duty);
        if let Some(took) = arrived.filter(|_| is_judged).and_then(|arrived| self.since(arrived)) {
            self.figures.judged.note(took);
        }
    }

    /// What has its stamp is judged, and acted upon.
    fn take_all(&mut self, sights: Vec<Sight>, arrived: Option<Time>, duty: &mut Duty<'_, '_>) {
        for sight in sights {
            let guarded = duty.guarded(&sight);
            if let Seen::Offered { channel, .. } = &sight.what
                && channel.ty.is_ok()
            {
                duty.advertise(channel, &mut *self.connector);
            }
            duty.take(sight);
            // Somebody waits for the message: it comes before what nobody was promised.
            if let Some((topic, payload)) = guarded {
                self.guard(&topic, &payload, arrived, duty);
            }
            self.react(arrived, duty);
        }
    }

    fn end(&mut self, ended: Ended, mut duty: Duty<'_, '_>) -> Outcome {
        let mut out = Vec::new();
        let at = self.clock.finish(self.connector.now(), &mut out);
        out.into_iter().for_each(|sight| duty.take(sight));
        let cut_short = (ended == Ended::AtViolation).then(|| "stopped at the first violation, as asked".to_owned());
        duty.take(Sight { at, what: Seen::Status(Status::Ended(cut_short)) });
        let mut view = self.view(&duty.course);
        duty.course.fill_strips(&mut view);
        duty.watch.look(&view);
        let Duty { course, tape, unrecorded, watch, reactions, next, .. } = duty;
        self.publishers = reactions.into_publishers();
        let (report, histories) = course.finish(watch);
        let unrecorded = tape.and_then(|tape| tape.finish().err()).or(unrecorded);
        Outcome { report, histories, ended, next, unrecorded }
    }
}

/// For how long specifications want to be watched, where each of them says so.
fn longest(specs: &[Spec]) -> Option<lapwing_stream::Duration> {
    let timeouts: Option<Vec<lapwing_stream::Duration>> = specs.iter().map(|s| s.alone().spec.timeout).collect();
    timeouts?.into_iter().max()
}
