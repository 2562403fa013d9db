//! How things stand at a moment of a live run: for a screen, a page, a scraper of metrics. Plain data, made on demand.

use std::collections::BTreeMap;

use lapwing_draw::Graph;
use lapwing_engine::GivenUp;
use lapwing_react::Reading;
use lapwing_react::history::{Plot, Track};
use lapwing_stream::Time;

use super::course::Course;
use super::figures::Figures;

/// How things stand.
#[derive(Clone, Debug, Default)]
pub struct View {
    /// What is watched.
    pub source: String,
    /// When the run began and what time it is now, on the clock in use.
    pub began: Time,
    /// See `began`.
    pub now: Time,
    /// The properties, in the order of the text, specification by specification.
    pub properties: Vec<PropertyView>,
    /// The topics that are read, by name.
    pub topics: Vec<TopicView>,
    /// What the signals did since the view before, where that was asked for.
    pub tracks: Vec<TrackView>,
    /// What the run has measured of itself.
    pub figures: Figures,
}

/// How a property stands.
#[derive(Clone, Debug)]
pub struct PropertyView {
    /// Its name, with its instance.
    pub name: String,
    /// The file that it stands in.
    pub file: String,
    /// The line of its first token.
    pub line: usize,
    /// Its source text.
    pub text: String,
    /// How it stands.
    pub state: StateNow,
    /// Why it cannot be judged now.
    pub cause: Option<String>,
    /// How many episodes of failures it has had.
    pub violations: u64,
    /// When the latest of them was found.
    pub latest: Option<Time>,
    /// The worst margin so far, where margins are computed.
    pub margin: Option<f64>,
    /// What it shows, as it is now.
    pub values: Vec<Reading>,
    /// How many of its obligations have failed, since time jumped last.
    pub failed: u64,
    /// How many instants its monitor has seen. Where there are no more than before, nothing can have failed.
    pub instants: u64,
    /// The tracks of the view that are drawn as lanes.
    pub lanes: Vec<usize>,
    /// The tracks of the view that are drawn as curves.
    pub plots: Vec<Plot>,
    /// Of a state diagram: the diagram, with the moves that were made although it does not have them.
    pub diagram: Option<Graph>,
}

impl PropertyView {
    /// How it stands in a `diagnostic_msgs/DiagnosticStatus`: its level (0 is OK, 1 WARN, 2 ERROR, 3 STALE) and its message.
    pub fn diagnosis(&self) -> (u8, String) {
        let level = match self.state {
            StateNow::Good => 0,
            StateNow::Waiting => 1,
            StateNow::Violated => 2,
            StateNow::Blind => 3,
        };
        let message = match (&self.cause, self.violations) {
            (Some(cause), _) => cause.clone(),
            (None, 0) => self.state.word().to_owned(),
            (None, 1) => "violated once".to_owned(),
            (None, n) => format!("violated {n} times"),
        };
        (level, message)
    }
}

/// What a signal did since the view before.
#[derive(Clone, Debug)]
pub struct TrackView {
    /// By what it is known again: the number of the specification, of its monitor, and its own.
    pub id: (usize, usize, usize),
    /// What it did.
    pub track: Track,
}

/// The ways in which a property can stand while a run goes on.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum StateNow {
    /// It has failed.
    Violated,
    /// It has not failed, and cannot be judged now.
    Blind,
    /// It waits for something that it reads.
    Waiting,
    /// It has not failed.
    Good,
}

impl StateNow {
    /// The word on screens and in metrics.
    pub fn word(self) -> &'static str {
        match self {
            StateNow::Violated => "violated",
            StateNow::Blind => "blind",
            StateNow::Waiting => "waiting",
            StateNow::Good => "good",
        }
    }
}

/// How a topic stands.
#[derive(Clone, Debug, Default)]
pub struct TopicView {
    /// Its name.
    pub name: String,
    /// The type that it is read with.
    pub type_name: Option<String>,
    /// How many messages came.
    pub messages: u64,
    /// How many came a second, lately.
    pub rate: f64,
    /// How many publish it.
    pub publishers: u64,
    /// Why it cannot be seen now.
    pub causes: Vec<String>,
}

/// The violations of a property so far: how many episodes, and when the latest was found.
pub(crate) type Tally = BTreeMap<(usize, String), (u64, Time)>;

/// Why a property cannot be judged any more.
fn reason(why: GivenUp) -> &'static str {
    match why {
        GivenUp::Spoilt => "a value was of another kind than its formula needs",
        GivenUp::Overflowed => "too many obligations were open at once",
    }
}

impl Course<'_> {
    /// How things stand, but for rates and figures.
    pub fn view(&self) -> View {
        let mut view = View {
            source: self.source().to_owned(),
            began: self.first().unwrap_or_default(),
            now: self.last().unwrap_or_default(),
            ..View::default()
        };
        for (spec, post) in self.posts.iter().enumerate() {
            let margins: BTreeMap<String, f64> = match self.measures() {
                true => post.shifts.iter().flat_map(|shift| shift.run.margins()).collect(),
                false => BTreeMap::new(),
            };
            for (blank, topics) in post.known() {
                let (violations, latest) = match self.tally.get(&(spec, blank.name.clone())) {
                    Some((count, at)) => (*count, Some(*at)),
                    None => self.of_instances(spec, &blank.name),
                };
                let shift = post.shifts.iter().find(|shift| shift.owned.contains(&blank.name));
                let standing = shift.map(|shift| shift.run.standing(&blank.name)).unwrap_or_default();
                let of_topic = |topic: &String| -> Vec<String> {
                    self.causes_now(topic).map(|cause| format!("{topic}: {cause}")).collect()
                };
                let mut causes: Vec<String> = topics.iter().flat_map(of_topic).collect();
                causes.extend(standing.given_up.map(|why| reason(why).to_owned()));
                let state = match () {
                    () if violations > 0 => StateNow::Violated,
                    () if !causes.is_empty() => StateNow::Blind,
                    () if !standing.started => StateNow::Waiting,
                    () => StateNow::Good,
                };
                let cause = if causes.is_empty() { blank.cause.clone() } else { Some(causes.join("; ")) };
                view.properties.push(PropertyView {
                    name: blank.name.clone(),
                    file: blank.file.clone(),
                    line: blank.line,
                    text: blank.text.clone(),
                    state,
                    cause: cause.filter(|_| matches!(state, StateNow::Blind | StateNow::Waiting)),
                    violations,
                    latest,
                    margin: margins.get(&blank.name).copied(),
                    values: shift.map(|shift| shift.run.present(&blank.name)).unwrap_or_default(),
                    failed: standing.failed,
                    instants: shift.map_or(0, |shift| shift.run.instants()),
                    lanes: Vec::new(),
                    plots: Vec::new(),
                    diagram: None,
                });
            }
        }
        view.topics = self.topics_now();
        view
    }

    /// Adds to a view what the signals did since this was asked last.
    pub fn fill_strips(&mut self, view: &mut View) {
        let View { properties, tracks, .. } = view;
        let mut properties = properties.iter_mut();
        for (spec, post) in self.posts.iter_mut().enumerate() {
            let names: Vec<String> = post.known().map(|(blank, _)| blank.name.clone()).collect();
            let mut drawn: BTreeMap<String, (Vec<usize>, Vec<Plot>, Option<Graph>)> = BTreeMap::new();
            for (number, shift) in post.shifts.iter_mut().enumerate() {
                let own: Vec<(usize, String)> = shift.own().collect();
                let Some(strip) = shift.run.strip() else { continue };
                let first = tracks.len();
                let fresh = strip.take().into_iter().enumerate();
                tracks.extend(fresh.map(|(k, track)| TrackView { id: (spec, number, k), track }));
                let moved = |track: &usize| first + track;
                for (property, name) in own {
                    let (lanes, plots) = strip.drawn(property);
                    let plot = |plot: Plot| Plot { tracks: plot.tracks.iter().map(moved).collect(), ..plot };
                    let lanes = lanes.iter().map(moved).collect();
                    drawn.insert(name, (lanes, plots.into_iter().map(plot).collect(), strip.diagram(property)));
                }
            }
            for (name, property) in names.iter().zip(&mut properties) {
                (property.lanes, property.plots, property.diagram) = drawn.remove(name).unwrap_or_default();
            }
        }
    }

    /// The violations of the instances of a property that are made of the values of events.
    fn of_instances(&self, spec: usize, name: &str) -> (u64, Option<Time>) {
        let prefix = format!("{name}[");
        let of = self.tally.iter().filter(|((s, n), _)| *s == spec && n.starts_with(&prefix));
        of.fold((0, None), |(sum, latest), (_, (count, at))| (sum + count, latest.max(Some(*at))))
    }

    fn topics_now(&self) -> Vec<TopicView> {
        let topic = |topic: lapwing_react::Topic| TopicView {
            messages: self.graph.messages(&topic.name),
            publishers: self.graph.publishers(&topic.name),
            causes: self.causes_now(&topic.name).collect(),
            rate: 0.0,
            type_name: topic.type_name,
            name: topic.name,
        };
        self.topics().into_iter().map(topic).collect()
    }
}

/// Rates of topics, from how many messages had come when they were asked for last.
#[derive(Debug, Default)]
pub(crate) struct Rates {
    last: Option<Time>,
    counts: BTreeMap<String, (u64, f64)>,
}

/// How much the latest stretch weighs against what was before.
const WEIGHT: f64 = 0.5;

impl Rates {
    /// Fills in the rates of a view that is taken at a time of the wall clock.
    pub fn fill(&mut self, view: &mut View, at: Time) {
        let seconds = self.last.map_or(0.0, |last| at.since(last).seconds());
        self.last = Some(at);
        for topic in &mut view.topics {
            let (count, rate) = self.counts.entry(topic.name.clone()).or_insert((topic.messages, 0.0));
            if seconds > 0.0 {
                let fresh = topic.messages.saturating_sub(*count) as f64 / seconds;
                *rate = if *rate == 0.0 { fresh } else { WEIGHT * fresh + (1.0 - WEIGHT) * *rate };
            }
            *count = topic.messages;
            topic.rate = *rate;
        }
    }
}
