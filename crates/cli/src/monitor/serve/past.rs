//! How things went lately, for the page: what each look showed, kept for a while and in bounded memory. Everything has a revision, so that a browser
//! asks only for what it does not know yet, and nothing has to be remembered of browsers.

use std::collections::{BTreeMap, VecDeque};

use lapwing::live::{PropertyView, StateNow, TrackView, View};
use lapwing_draw::Graph;
use lapwing_react::Report;
use lapwing_react::history::{Limit, Shape};
use lapwing_react::shown::Origin;
use lapwing_stream::{Duration, Time};

/// So far back the page looks, on the clock in use, in nanoseconds.
pub const REACH: i64 = 120_000_000_000;

/// So many signals have a track; further ones are only shown as values.
const MOST_TRACKS: usize = 64;

/// So many points of a track are kept, and so many changes of a lane.
const MOST_POINTS: usize = 2000;
const MOST_CHANGES: usize = 500;

/// By what a track is known again.
pub type Id = (usize, usize, usize);

/// What was shown lately.
#[derive(Clone, Debug, Default)]
pub struct Past {
    /// Counts the beginnings: what was shown before the latest belongs to another run, or to a time that was before time went back.
    pub run: u64,
    /// Grows with everything that happens.
    pub revision: u64,
    /// The revision since which the properties and what they draw have been the same.
    pub laid_out: u64,
    /// How each property stood.
    pub lanes: Vec<Lane>,
    /// What the signals did.
    pub tracks: BTreeMap<Id, Line>,
    layout: Vec<Layout>,
    last: Option<Time>,
}

/// How a property stood.
#[derive(Clone, Debug, Default)]
pub struct Lane {
    /// Since when it stands how, with the revision that says so.
    pub changes: VecDeque<(u64, Time, &'static str)>,
    /// Its state diagram, where it is one, with the revision that brought it as it is.
    pub diagram: Option<(u64, Graph)>,
    failed: u64,
    instants: u64,
}

/// What a signal did.
#[derive(Clone, Debug, Default)]
pub struct Line {
    /// Its name and unit.
    pub name: String,
    /// See `name`.
    pub unit: Option<String>,
    /// Its points, with the revisions that brought them.
    pub points: VecDeque<(u64, Time, Point)>,
}

/// What a signal is at a time.
#[derive(Clone, PartialEq, Debug)]
pub enum Point {
    /// A number; NaN where there ceases to be one.
    Number(f64),
    /// A state; `None` where it changed too often to tell.
    State(Option<String>),
    /// Something that happened.
    Tick,
}

/// What is drawn of a property.
#[derive(Clone, PartialEq, Debug)]
pub struct Layout {
    name: String,
    file: String,
    /// Its lanes.
    pub lanes: Vec<Id>,
    /// Its curves, and what they are compared with.
    pub plots: Vec<(Vec<Id>, Vec<Limit>)>,
}

impl Past {
    /// A new run begins.
    pub fn begin(&mut self) {
        let (run, revision) = (self.run + 1, self.revision + 1);
        *self = Past { run, revision, laid_out: revision, ..Past::default() };
    }

    /// Something happened that is no look; gives its revision.
    pub fn event(&mut self) -> u64 {
        self.revision += 1;
        self.revision
    }

    /// Somebody looked, and saw this.
    pub fn look(&mut self, view: &View) {
        if self.last.is_some_and(|last| view.now < last) {
            self.begin();
        }
        self.revision += 1;
        self.lay_out(view);
        for (lane, property) in self.lanes.iter_mut().zip(&view.properties) {
            lane.look(property, self.last.unwrap_or(view.now), view.now, self.revision);
        }
        view.tracks.iter().for_each(|track| self.track(track));
        self.forget(Time(view.now.0.saturating_sub(REACH)));
        self.last = Some(view.now);
    }

    /// What is drawn of each property.
    pub fn layout(&self) -> &[Layout] {
        &self.layout
    }

    fn lay_out(&mut self, view: &View) {
        let id = |number: &usize| view.tracks.get(*number).map(|track| track.id);
        let layout = |p: &PropertyView| Layout {
            name: p.name.clone(),
            file: p.file.clone(),
            lanes: p.lanes.iter().filter_map(id).collect(),
            plots: p
                .plots
                .iter()
                .map(|plot| (plot.tracks.iter().filter_map(id).collect(), plot.limits.clone()))
                .collect(),
        };
        let layout: Vec<Layout> = view.properties.iter().map(layout).collect();
        if layout == self.layout {
            return;
        }
        let same = |a: &Layout, b: &Layout| (&a.name, &a.file) == (&b.name, &b.file);
        let mut before: Vec<(Layout, Lane)> = self.layout.drain(..).zip(self.lanes.drain(..)).collect();
        for new in &layout {
            let known = before.iter().position(|(old, _)| same(old, new));
            self.lanes.push(known.map(|at| before.swap_remove(at).1).unwrap_or_default());
        }
        (self.layout, self.laid_out) = (layout, self.revision);
    }

    fn track(&mut self, fresh: &TrackView) {
        if !self.tracks.contains_key(&fresh.id) && self.tracks.len() >= MOST_TRACKS {
            return;
        }
        let line = self.tracks.entry(fresh.id).or_insert_with(|| Line {
            name: fresh.track.name.clone(),
            unit: fresh.track.unit.clone(),
            ..Line::default()
        });
        match &fresh.track.shape {
            Shape::Curve(points) => points.iter().for_each(|(at, x)| line.number(self.revision, *at, *x)),
            Shape::Steps { changes, labels } => {
                for (at, state) in changes {
                    line.state(self.revision, *at, state.and_then(|n| labels.get(n).cloned()));
                }
            }
            Shape::Ticks(times) => {
                times.iter().for_each(|at| line.points.push_back((self.revision, *at, Point::Tick)));
            }
        }
    }

    fn forget(&mut self, before: Time) {
        for lane in &mut self.lanes {
            shorten(&mut lane.changes, MOST_CHANGES, |(_, at, _)| *at < before);
        }
        for line in self.tracks.values_mut() {
            shorten(&mut line.points, MOST_POINTS, |(_, at, _)| *at < before);
        }
    }
}

/// Drops what is over. What came last before the rest says how things stood then, and stays.
fn shorten<T>(list: &mut VecDeque<T>, most: usize, is_over: impl Fn(&T) -> bool) {
    while list.len() > most || list.get(1).is_some_and(&is_over) {
        list.pop_front();
    }
}

impl Lane {
    /// How it stands now; `before` is when somebody looked last.
    fn look(&mut self, property: &PropertyView, before: Time, now: Time, revision: u64) {
        let has_failed = property.failed > self.failed;
        let is_still = property.instants == self.instants;
        (self.failed, self.instants) = (property.failed, property.instants);
        if self.diagram.as_ref().map(|(_, graph)| graph) != property.diagram.as_ref() {
            self.diagram = property.diagram.clone().map(|graph| (revision, graph));
        }
        let last = self.changes.back().map(|(_, _, kind)| *kind);
        let kind = match property.state {
            StateNow::Waiting => "waiting",
            StateNow::Blind => "inconclusive",
            _ if has_failed => "violated",
            // Nothing came: what stood stands.
            _ if is_still && last == Some("violated") => "violated",
            _ => "holds",
        };
        if last != Some(kind) {
            // What failed did so after the look before, and of what fails no more nothing has failed since then.
            let is_past = kind == "violated" || last == Some("violated");
            self.changes.push_back((revision, if is_past { before } else { now }, kind));
        }
    }
}

impl Line {
    /// Of a value that lasts the first and the last time are enough.
    fn number(&mut self, revision: u64, at: Time, x: f64) {
        let is_same = |point: Option<&(u64, Time, Point)>| matches!(point, Some((_, _, Point::Number(y))) if *y == x);
        let length = self.points.len();
        if length > 1 && is_same(self.points.back()) && is_same(self.points.get(length - 2)) {
            self.points.pop_back();
        }
        self.points.push_back((revision, at, Point::Number(x)));
    }

    fn state(&mut self, revision: u64, at: Time, state: Option<String>) {
        let point = Point::State(state);
        if self.points.back().is_none_or(|(_, _, last)| *last != point) {
            self.points.push_back((revision, at, point));
        }
    }
}

/// From when the page counts seconds: zero, or the beginning of a run that counts in a calendar.
pub fn origin(view: &View) -> Time {
    Origin::of(&Report { span: Some((view.began, view.began)), ..Report::default() }).0
}

/// A time in seconds from an origin.
pub fn seconds(at: Time, origin: Time) -> f64 {
    let since: Duration = at.since(origin);
    since.seconds()
}

#[cfg(test)]
mod tests {
    use lapwing_react::history::{Plot, Track};

    use super::*;

    fn view(now: i64, failed: u64, points: &[(i64, f64)]) -> View {
        let property = PropertyView {
            name: "calm".to_owned(),
            file: "a.rv".to_owned(),
            line: 1,
            text: String::new(),
            state: if failed > 0 { StateNow::Violated } else { StateNow::Good },
            cause: None,
            violations: 0,
            latest: None,
            margin: None,
            values: Vec::new(),
            failed,
            instants: u64::try_from(now).unwrap(),
            lanes: Vec::new(),
            plots: vec![Plot { tracks: vec![0], limits: Vec::new() }],
            diagram: None,
        };
        let shape = Shape::Curve(points.iter().map(|(t, x)| (Time(*t), *x)).collect());
        let track = Track { name: "speed".to_owned(), unit: None, shape, is_thinned: false };
        View {
            now: Time(now),
            properties: vec![property],
            tracks: vec![TrackView { id: (0, 0, 0), track }],
            ..View::default()
        }
    }

    fn kinds(past: &Past) -> Vec<(i64, &'static str)> {
        past.lanes[0].changes.iter().map(|(_, at, kind)| (at.0, *kind)).collect()
    }

    #[test]
    fn a_lane_shows_when_something_failed_and_not_that_it_ever_did() {
        let mut past = Past::default();
        for (now, failed) in [(1, 0), (2, 0), (3, 2), (4, 5), (4, 5), (5, 5)] {
            past.look(&view(now, failed, &[]));
        }
        assert_eq!(kinds(&past), [(1, "holds"), (2, "violated"), (4, "holds")]);
        let blind = View {
            properties: vec![PropertyView { state: StateNow::Blind, ..view(7, 5, &[]).properties[0].clone() }],
            ..view(7, 5, &[])
        };
        past.look(&blind);
        assert_eq!(kinds(&past).last(), Some(&(7, "inconclusive")));
    }

    #[test]
    fn what_is_too_long_ago_is_forgotten_but_for_how_it_stood() {
        let mut past = Past::default();
        for step in 0..10_000_i64 {
            let now = step * REACH / 1000;
            past.look(&view(now, 0, &[(now, step as f64)]));
        }
        let line = &past.tracks[&(0, 0, 0)];
        assert!((1000..=1003).contains(&line.points.len()), "{}", line.points.len());
        assert_eq!(kinds(&past).len(), 1);
        // However fast time goes, there is a limit.
        (0..10_000).for_each(|step| past.look(&view(REACH * 10 + step, 0, &[(REACH * 10 + step, step as f64)])));
        assert!(past.tracks[&(0, 0, 0)].points.len() <= MOST_POINTS);
    }

    #[test]
    fn a_value_that_lasts_is_two_points() {
        let mut past = Past::default();
        past.look(&view(9, 0, &[(0, 1.0), (1, 1.0), (2, 1.0), (3, 1.0), (4, 2.0)]));
        let times: Vec<i64> = past.tracks[&(0, 0, 0)].points.iter().map(|(_, at, _)| at.0).collect();
        assert_eq!(times, [0, 3, 4]);
    }

    #[test]
    fn a_diagram_is_new_where_another_move_was_made() {
        let mut past = Past::default();
        let mut graph = Graph::default();
        let mut look = |graph: &Graph| {
            let mut view = view(1, 0, &[]);
            view.properties[0].diagram = Some(graph.clone());
            past.look(&view);
            past.lanes[0].diagram.clone().map(|(revision, graph)| (past.revision - revision, graph.edges.len()))
        };
        assert_eq!((look(&graph), look(&graph)), (Some((0, 0)), Some((1, 0))));
        graph.wrong(0, 0, "illegal, once");
        assert_eq!((look(&graph), look(&graph)), (Some((0, 1)), Some((1, 1))));
    }

    #[test]
    fn when_time_goes_back_the_page_begins_anew() {
        let mut past = Past::default();
        past.look(&view(9, 0, &[(9, 1.0)]));
        let (run, revision) = (past.run, past.revision);
        past.look(&view(1, 0, &[(1, 2.0)]));
        assert!(past.run > run && past.revision > revision && past.laid_out > revision);
        assert_eq!(past.tracks[&(0, 0, 0)].points.len(), 1);
    }
}
