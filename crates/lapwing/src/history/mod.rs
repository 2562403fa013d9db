//! How signals and properties go over a recording, noted on the way in bounded memory: what a page draws.
//!
//! What is drawn of each property is planned beforehand ([`plan`]). At each instant the signals are looked at ([`tracks`], [`curve`], [`steps`]). The engine
//! tells when something fails, and which moves a state diagram does not have ([`diagrams`]); beside it the conditions of scopes are judged ([`scopes`]). At the end all of this is put on one axis ([`axis`],
//! [`alarms`], [`stretches`]).
//!
//! While a live run goes on, a [`strip`] hands out what the signals did since it was asked last.

mod alarms;
mod axis;
mod curve;
mod diagrams;
mod exact;
mod margins;
mod plan;
mod scopes;
mod starts;
mod steps;
mod stretches;
mod strip;
mod tracks;

use lapwing_check::checked;
use lapwing_engine::inputs::Inputs;
use lapwing_engine::{Alarm, Observer, Outcome, Output};
use lapwing_react::Property;
use lapwing_react::history::{Course, History, Mark};
use lapwing_stream::{Sample, Time, Value, Verdict};

use crate::explain;
use crate::spec::Spec;
use alarms::Alarms;
use axis::Axis;
use diagrams::Diagrams;
use margins::Margins;
use plan::Plan;
use scopes::Probes;
use starts::Starts;
use stretches::{Known, Stretch, thin};
pub(crate) use strip::Strip;
use tracks::Tracks;

/// At most so many stretches of a property are told apart.
const STRETCHES: usize = 500;

/// Notes how one specification goes over one recording.
#[derive(Debug)]
pub(crate) struct Recorder {
    plan: Plan,
    words: Vec<String>,
    axis: Axis,
    tracks: Tracks,
    alarms: Alarms,
    diagrams: Diagrams,
    margins: Margins,
    starts: Starts,
    probes: Option<Probes>,
    courses: Vec<Course>,
}

impl Recorder {
    /// Keeps at most so many buckets of every curve.
    pub fn new(spec: &Spec, meaning: &checked::Spec, most: usize) -> Recorder {
        let plan = Plan::new(spec, meaning);
        Recorder {
            words: meaning.properties.iter().map(|p| explain::meant(spec, meaning, p)).collect(),
            axis: Axis::default(),
            tracks: Tracks::new(&plan.wanted, most),
            alarms: Alarms::default(),
            diagrams: Diagrams::new(spec, meaning),
            margins: Margins::new(most),
            starts: Starts::new(meaning),
            probes: Probes::new(meaning),
            courses: Vec::new(),
            plan,
        }
    }

    /// The engine has taken this in.
    pub fn take(&mut self, sample: Sample<'_>) {
        self.axis.see(sample.time);
        self.starts.hear(&sample);
        if let Some(probes) = &mut self.probes {
            probes.feed(sample);
        }
    }

    /// The recording is over; what became of each property comes next.
    pub fn end(&mut self) {
        if let Some(probes) = &mut self.probes {
            probes.finish();
        }
    }

    /// What became of a property, or of an instance of it: the next of the report.
    pub fn judged(&mut self, outcome: &Outcome, property: &Property) {
        let number = outcome.property;
        let marks = self.alarms.marks(number, &outcome.instance, &outcome.episodes, &self.axis);
        let known = self.known(outcome, property, &marks);
        self.courses.push(Course {
            words: self.words.get(number).cloned().unwrap_or_default(),
            phases: known.phases(self.axis.pieces()),
            scopes: self.probes.as_ref().map_or_else(Vec::new, |p| p.open(number, STRETCHES)),
            marks,
            diagram: self.diagrams.of(number),
            margin: self.margins.of(number, &outcome.instance),
            ..self.drawn(number)
        });
    }

    fn known(&self, outcome: &Outcome, property: &Property, marks: &[Mark]) -> Known {
        let failed: Vec<Stretch> = marks.iter().map(|m| (m.began.min(m.failed), m.until)).collect();
        let open = self.probes.as_ref().and_then(|p| p.outermost(outcome.property));
        let has_started = outcome.positions > 0 || property.verdict != Verdict::Inconclusive;
        Known {
            starts: if has_started { self.starts.of(outcome.property, &self.axis) } else { Vec::new() },
            failed: thin(failed, STRETCHES),
            open: open.map(|stretches| thin(stretches, STRETCHES)),
            // Of what could not be judged it is not known whether it was missed.
            unmet_since: property.unmet_since.filter(|_| property.verdict == Verdict::Unmet).map(|t| self.axis.now(t)),
            is_unknown: property.verdict == Verdict::Inconclusive,
        }
    }

    fn drawn(&self, property: usize) -> Course {
        let (lanes, plots) = self.plan.drawn(property, |track| self.tracks.is_curve(track));
        Course { lanes, plots, ..Course::default() }
    }

    /// All that was noted.
    pub fn finish(self) -> History {
        let end = self.axis.pieces().last().map(|piece| piece.to);
        let tracks = self.tracks.finish(end, &self.plan.wanted);
        History { pieces: self.axis.pieces().to_vec(), tracks, courses: self.courses }
    }
}

impl Observer for Recorder {
    fn wants_margins(&self) -> bool {
        true
    }

    fn margin(&mut self, property: usize, instance: &[Option<Value>], at: Time, margin: f64) {
        self.margins.note(property, instance, self.axis.now(at), margin);
    }

    fn output(&mut self, inputs: &Inputs, output: Output<'_>) {
        match output {
            Output::Instant(stamp) => {
                self.starts.instant(inputs, stamp, &self.axis);
                self.tracks.instant(inputs, self.axis.now(stamp), &self.plan.wanted);
            }
            Output::Alarm(Alarm { property, instance, illegal, .. })
            | Output::Further(Alarm { property, instance, illegal, .. }) => {
                illegal.into_iter().for_each(|made| self.diagrams.note(property, made));
                self.alarms.note(property, instance, self.axis.piece());
                self.margins.keep(property, instance);
                let groups = self.plan.views.get(property).into_iter().flat_map(|view| &view.groups);
                groups.flat_map(|group| &group.tracks).for_each(|track| self.tracks.keep(*track));
            }
            Output::Jump { to, .. } => {
                self.axis.jump(to);
                self.starts.jump();
                self.margins.jump(self.axis.now(to));
            }
        }
    }
}
