//! A graph that is made up: a connector that plays a list, on a clock of its own that only goes when it is waited for.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use bytes::Bytes;
use lapwing::live::{Figures, LiveOptions, Onlooker, Outcome, Station, View};
use lapwing::{Options, Report, Session, Spec, Watch};
use lapwing_react::{Event, Format, Style, render};
use lapwing_record::{Dialect, Library, MessageType, RawChannel};
use lapwing_ros::connector::{
    Arrival, CallId, Cause, Connector, Definition, Encoding, Happening, Offer, PublisherId, Refused, StreamId,
};
use lapwing_stream::{Time, Verdict};

/// The beginning: some day, as a wall clock has it.
pub const START: i64 = 1_760_000_000_000_000_000;

/// So many seconds after the beginning.
pub fn at(seconds: f64) -> Time {
    Time(START + (seconds * 1e9).round() as i64)
}

/// What happens on the graph.
#[derive(Clone, Default)]
pub struct Script {
    arrivals: Vec<Arrival>,
    /// Until when it is watched.
    until: f64,
}

impl Script {
    /// Nothing happens for so many seconds.
    pub fn of(seconds: f64) -> Script {
        Script { arrivals: Vec::new(), until: seconds }
    }

    fn add(mut self, seconds: f64, what: Happening) -> Script {
        self.arrivals.push(Arrival { at: at(seconds), what });
        self.arrivals.sort_by_key(|a| a.at);
        self
    }

    /// Somebody publishes a topic of numbers (`std_msgs/Float64`).
    pub fn offers(self, seconds: f64, stream: u32, topic: &str) -> Script {
        self.offers_type(seconds, stream, topic, "std_msgs/Float64", "float64 data\n")
    }

    /// Somebody publishes a topic of that type.
    pub fn offers_type(self, seconds: f64, stream: u32, topic: &str, type_name: &str, definition: &str) -> Script {
        let channel = channel(topic, type_name, definition);
        self.add(seconds, Happening::Stream(Offer { stream: StreamId(stream), channel, latched: false }))
    }

    /// Somebody publishes a topic of numbers and hands the last one to those who come late.
    pub fn offers_latched(self, seconds: f64, stream: u32, topic: &str) -> Script {
        let channel = channel(topic, "std_msgs/Float64", "float64 data\n");
        self.add(seconds, Happening::Stream(Offer { stream: StreamId(stream), channel, latched: true }))
    }

    /// Somebody publishes a topic that nobody has subscribed to, so that its definition is not known.
    pub fn mentions(self, seconds: f64, stream: u32, topic: &str) -> Script {
        let ty = Err("not subscribed to".to_owned());
        let channel = RawChannel { definition: Vec::new(), ty, ..channel(topic, "std_msgs/Float64", "float64 data\n") };
        self.add(seconds, Happening::Stream(Offer { stream: StreamId(stream), channel, latched: false }))
    }

    /// A number.
    pub fn says(self, seconds: f64, stream: u32, number: f64) -> Script {
        self.says_bytes(seconds, stream, &number.to_le_bytes())
    }

    /// Numbers at a rate, from then until then.
    pub fn keeps_saying(self, from: f64, to: f64, every: f64, stream: u32, number: f64) -> Script {
        let count = ((to - from) / every).round() as u32;
        (0..=count).fold(self, |script, k| script.says(from + f64::from(k) * every, stream, number))
    }

    /// A message of these bytes.
    pub fn says_bytes(self, seconds: f64, stream: u32, bytes: &[u8]) -> Script {
        let payload = Bytes::copy_from_slice(bytes);
        self.add(seconds, Happening::Message { stream: StreamId(stream), payload })
    }

    pub fn has_publishers(self, seconds: f64, stream: u32, count: usize) -> Script {
        self.add(seconds, Happening::Publishers { stream: StreamId(stream), count })
    }

    pub fn loses(self, seconds: f64, stream: u32, count: u64) -> Script {
        self.add(seconds, Happening::Lost { stream: StreamId(stream), count })
    }

    pub fn blinds(self, seconds: f64, topic: &str, cause: Cause) -> Script {
        self.add(seconds, Happening::Blind { topic: topic.to_owned(), cause })
    }

    pub fn clears(self, seconds: f64, topic: &str, cause: Cause) -> Script {
        self.add(seconds, Happening::Sees { topic: topic.to_owned(), cause })
    }

    /// Simulated time on stream 99: it begins a little after the run.
    pub fn offers_clock(self) -> Script {
        self.offers_type(0.1, 99, "/clock", "rosgraph_msgs/Clock", "time clock\n")
    }

    /// Simulated time is so many seconds.
    pub fn ticks(self, seconds: f64, simulated: f64) -> Script {
        let nanos = (simulated * 1e9).round() as u64;
        let mut bytes = ((nanos / 1_000_000_000) as u32).to_le_bytes().to_vec();
        bytes.extend(((nanos % 1_000_000_000) as u32).to_le_bytes());
        self.says_bytes(seconds, 99, &bytes)
    }

    /// Simulated time goes at a rate of 10 Hz, a second a second, from then until then.
    pub fn keeps_ticking(self, from: f64, to: f64, simulated: f64) -> Script {
        let count = ((to - from) * 10.0).round() as u32;
        (0..=count).fold(self, |script, k| {
            let passed = f64::from(k) * 0.1;
            script.ticks(from + passed, simulated + passed)
        })
    }
}

fn channel(topic: &str, type_name: &str, definition: &str) -> RawChannel {
    let layout = Library::default().layout(Dialect::Ros1, type_name, definition).unwrap();
    RawChannel {
        topic: topic.to_owned(),
        type_name: type_name.to_owned(),
        encoding: "ros1msg".to_owned(),
        definition: definition.as_bytes().to_vec(),
        messages: "ros1".to_owned(),
        ty: Ok(MessageType::Ros1(layout)),
    }
}

/// What was asked of the graph.
#[derive(Default)]
pub struct Asked {
    pub subscribed: Vec<String>,
    /// The topics that are published.
    pub advertised: Vec<String>,
    /// What was published, and when in seconds from the beginning.
    pub published: Vec<(f64, String, Vec<u8>)>,
    /// The services that were called, with what they were asked.
    pub called: Vec<(String, Vec<u8>)>,
}

struct Player {
    arrivals: VecDeque<Arrival>,
    now: Arc<AtomicI64>,
    asked: Arc<Mutex<Asked>>,
}

impl Connector for Player {
    fn name(&self) -> String {
        "a script".to_owned()
    }

    fn encoding(&self) -> Encoding {
        Encoding::Ros1
    }

    fn now(&self) -> Time {
        Time(self.now.load(Ordering::Relaxed))
    }

    fn subscribe(&mut self, topics: &[String]) {
        self.asked.lock().unwrap().subscribed.extend_from_slice(topics);
    }

    fn next(&mut self, patience: Duration) -> Option<Arrival> {
        let until = self.now.load(Ordering::Relaxed) + patience.as_nanos() as i64;
        let next = self.arrivals.pop_front_if(|arrival| arrival.at.0 <= until);
        self.now.store(next.as_ref().map_or(until, |arrival| arrival.at.0), Ordering::Relaxed);
        next
    }

    fn advertise(&mut self, channel: &RawChannel, _: bool) -> Result<PublisherId, Refused> {
        let advertised = &mut self.asked.lock().unwrap().advertised;
        assert!(!advertised.contains(&channel.topic), "{} is published already", channel.topic);
        advertised.push(channel.topic.clone());
        Ok(PublisherId(advertised.len() as u32 - 1))
    }

    fn publish(&mut self, publisher: PublisherId, payload: &[u8]) -> Result<(), Refused> {
        let seconds = (self.now.load(Ordering::Relaxed) - START) as f64 / 1e9;
        let mut asked = self.asked.lock().unwrap();
        let topic = asked.advertised[publisher.0 as usize].clone();
        asked.published.push((seconds, topic, payload.to_vec()));
        Ok(())
    }

    fn call(&mut self, service: &str, _: &str, request: &[u8], _: Duration) -> Result<CallId, Refused> {
        let mut asked = self.asked.lock().unwrap();
        asked.called.push((service.to_owned(), request.to_vec()));
        let call = CallId(asked.called.len() as u64);
        let at = Time(self.now.load(Ordering::Relaxed) + 1_000_000);
        // std_srvs/Trigger: it worked, and says `ok`.
        let answer = Ok(Bytes::from_static(&[1, 2, 0, 0, 0, b'o', b'k']));
        self.arrivals.push_front(Arrival { at, what: Happening::Reply { call, answer } });
        Ok(call)
    }

    fn definition(&mut self, type_name: &str) -> Result<Definition, Refused> {
        match type_name {
            "std_msgs/Float64" => Ok(Definition::Message("float64 data\n".to_owned())),
            "std_srvs/srv/Trigger" => {
                Ok(Definition::Service(String::new(), "bool success\nstring message\n".to_owned()))
            }
            _ => Err(Refused(format!("nobody knows {type_name} here"))),
        }
    }
}

/// What an onlooker was told, and when, in seconds from the beginning.
#[derive(Default)]
pub struct Told {
    pub violations: Vec<(f64, String)>,
    pub warnings: Vec<(f64, String)>,
    pub notes: Vec<String>,
    /// How things stood, four times a second.
    pub views: Vec<View>,
}

struct Onlooking {
    now: Arc<AtomicI64>,
    until: i64,
    told: Told,
    /// Specifications that are to follow, and from when on.
    next: Option<(i64, Vec<Spec>)>,
}

impl Onlooking {
    /// Looks on until then.
    fn until(seconds: f64, now: Arc<AtomicI64>) -> Onlooking {
        Onlooking { now, until: at(seconds).0, told: Told::default(), next: None }
    }
}

impl Watch for Onlooking {
    fn event(&mut self, event: Event<'_>) {
        let seconds = (self.now.load(Ordering::Relaxed) - START) as f64 / 1e9;
        match event {
            Event::Violation { property, .. } => self.told.violations.push((seconds, property.name.clone())),
            Event::Warning(warning) => self.told.warnings.push((seconds, warning.message.clone())),
            _ => {}
        }
    }

    fn goes_on(&mut self) -> bool {
        self.now.load(Ordering::Relaxed) < self.until
    }
}

impl Onlooker for Onlooking {
    fn note(&mut self, text: &str) {
        self.told.notes.push(text.to_owned());
    }

    fn draws(&self) -> bool {
        true
    }

    fn pause(&self) -> Option<Duration> {
        Some(Duration::from_millis(250))
    }

    fn look(&mut self, view: &View) {
        self.told.views.push(view.clone());
    }

    fn reloads(&mut self) -> Option<Vec<Spec>> {
        let now = self.now.load(Ordering::Relaxed);
        self.next.take_if(|(from, _)| *from <= now).map(|(_, specs)| specs)
    }
}

/// A run that is over.
pub struct Over {
    pub outcome: Outcome,
    pub told: Told,
    pub asked: Asked,
    pub figures: Figures,
    /// Its recording.
    pub recording: PathBuf,
    specs: Vec<Spec>,
    checking: Options,
    _folder: tempfile::TempDir,
}

/// Watches a script with a specification.
pub fn watch(spec: &str, script: Script) -> Over {
    watch_as(spec, script, LiveOptions::default())
}

/// Watches a script with a specification and options.
pub fn watch_as(spec: &str, script: Script, options: LiveOptions) -> Over {
    try_watch(spec, script, options).unwrap_or_else(|why| panic!("{why}"))
}

/// The same; an error says why it cannot begin.
pub fn try_watch(spec: &str, script: Script, options: LiveOptions) -> Result<Over, String> {
    watch_until(spec, None, script, options)
}

/// Watches a script with a specification that is to be followed by another one, so many seconds from the beginning.
pub fn watch_followed(spec: &str, next: (f64, &str), script: Script, options: LiveOptions) -> Over {
    let next = (at(next.0).0, parsed(next.1));
    watch_until(spec, Some(next), script, options).unwrap_or_else(|why| panic!("{why}"))
}

fn parsed(spec: &str) -> Vec<Spec> {
    vec![Spec::parse("live.rv", spec, &|_| None).unwrap_or_else(|e| panic!("{e}"))]
}

fn watch_until(
    spec: &str,
    next: Option<(i64, Vec<Spec>)>,
    script: Script,
    options: LiveOptions,
) -> Result<Over, String> {
    let specs = parsed(spec);
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("run.mcap");
    let now = Arc::new(AtomicI64::new(START));
    let asked = Arc::new(Mutex::new(Asked::default()));
    let mut onlooker = Onlooking { next, ..Onlooking::until(script.until, now.clone()) };
    let player = Player { arrivals: script.arrivals.into(), now, asked: asked.clone() };
    let checking = options.checking.clone();
    let mut station = Station::new(Box::new(player), LiveOptions { record: Some(recording.clone()), ..options });
    let outcome = station.run(&specs, &mut onlooker)?;
    assert_eq!(outcome.unrecorded, None);
    let figures = station.figures().clone();
    let asked = std::mem::take(&mut *asked.lock().unwrap());
    Ok(Over { outcome, told: onlooker.told, asked, figures, recording, specs, checking, _folder: folder })
}

/// What is asked of a graph by two specifications, one after the other at the same station: each watches one half of the script.
pub fn asked_by_both(first: &str, second: &str, script: Script) -> Asked {
    let now = Arc::new(AtomicI64::new(START));
    let asked = Arc::new(Mutex::new(Asked::default()));
    let halves = [(first, script.until / 2.0), (second, script.until)];
    let player = Player { arrivals: script.arrivals.into(), now: now.clone(), asked: asked.clone() };
    let mut station = Station::new(Box::new(player), LiveOptions::default());
    for (spec, until) in halves {
        let mut onlooker = Onlooking::until(until, now.clone());
        station.run(&parsed(spec), &mut onlooker).unwrap();
    }
    std::mem::take(&mut *asked.lock().unwrap())
}

impl Over {
    /// The verdict on a property with its cause.
    pub fn verdict(&self, name: &str) -> (Verdict, String) {
        let property = self.outcome.report.properties.iter().find(|p| p.name == name);
        let property = property.unwrap_or_else(|| panic!("no {name}: {:?}", self.names()));
        (property.verdict, property.cause.clone().unwrap_or_default())
    }

    pub fn names(&self) -> Vec<&str> {
        self.outcome.report.properties.iter().map(|p| p.name.as_str()).collect()
    }

    /// Checks the recording, and that the report of it is that of the run, to the last byte but for its name.
    pub fn agrees(&self) -> Report {
        let checked = check(&self.specs, &self.recording, &self.checking);
        let named = Report { trace: self.outcome.report.trace.clone(), ..checked.clone() };
        assert_eq!(json(&self.outcome.report), json(&named));
        checked
    }
}

/// The report on a recording.
pub fn check(specs: &[Spec], recording: &Path, options: &Options) -> Report {
    Session::open(specs, recording, options).unwrap().run(&mut ())
}

fn json(report: &Report) -> String {
    render(report, Format::Json, Style::Plain).replace(",\"", ",\n\"")
}
