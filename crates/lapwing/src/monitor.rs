//! A specification over a running program: samples come one by one, and what fails is told at once.

use std::borrow::Cow;
use std::collections::BTreeMap;

use lapwing_check::TraceShape;
use lapwing_check::checked::{self, EventSource};
use lapwing_react::{Property, Report, Violation};
use lapwing_stream::{Sample, Time, Value, Verdict, What};

use crate::losses::Damage;
use crate::meant::Met;
use crate::needs::Needs;
use crate::run::{Noting, Run, Untold};
use crate::spec::Spec;

/// The monitor of a running program. It judges as a [session](crate::Session) over a recording of the same samples would; it knows no clock,
/// and carries no reaction out.
///
/// ```
/// use lapwing::{Monitor, Spec};
/// use lapwing_stream::{Sample, Time, What};
///
/// let spec = Spec::parse("kick.rv", "event aim\nevent kick\nwhenever kick, previously aim\n", &|_| None)?;
/// let mut monitor = Monitor::new(spec);
/// let kick = monitor.event("kick").expect("the specification declares it");
/// monitor.feed(Sample { time: Time(7), what: What::Event { event: kick, values: &[] } });
/// let news = monitor.news().expect("nobody aimed");
/// assert_eq!((news.property.name.as_str(), news.violation.failed), ("line 3", Time(7)));
/// # Ok::<(), lapwing::SpecError>(())
/// ```
pub struct Monitor {
    run: Run<'static>,
    name: String,
    /// What is watched, in words; nothing where it is a program, which has neither messages nor components.
    system: Option<String>,
    span: Option<(Time, Time)>,
}

/// A violation, when it happens.
#[derive(Clone, Debug)]
pub struct News {
    /// The number of the property, in [`checked::Spec::properties`].
    pub number: usize,
    /// The values of its slices under `for each k of EVENT.field`.
    pub instance: Vec<Value>,
    /// The property, or its instance, as far as it is known.
    pub property: Property,
    /// What is known of the violation; how long its episode lasts is not.
    pub violation: Violation,
    /// Whether another one of the property was found at the same moment: who reacts has been told already.
    pub is_further: bool,
    /// When the first sample came, from which times are shown to people where they count in some calendar.
    pub start: Time,
}

/// What a program could not show, and why: what reads it and did not fail is inconclusive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unseen {
    /// By the number of the event, in [`checked::Spec::events`].
    pub events: BTreeMap<usize, String>,
    /// By the number of the column, in [`checked::Spec::columns`].
    pub columns: BTreeMap<usize, String>,
}

impl Monitor {
    /// Nothing has come yet.
    pub fn new(spec: Spec) -> Monitor {
        Monitor::over(spec, &TraceShape::program(), None)
    }

    /// The monitor of something that sends messages of the topics of a shape: `system` is what reports call it.
    pub fn of_system(spec: Spec, shape: &TraceShape, system: &str) -> Monitor {
        Monitor::over(spec, shape, Some(system.to_owned()))
    }

    fn over(spec: Spec, shape: &TraceShape, system: Option<String>) -> Monitor {
        let fitted = spec.fitted(shape, None);
        let name = spec.name().to_owned();
        Monitor { run: Run::new(Cow::Owned(spec), fitted, Noting::default()), name, system, span: None }
    }

    /// What the specification means here: the numbers in samples are those of its tables.
    pub fn meaning(&self) -> &checked::Spec {
        self.run.meaning()
    }

    /// Whether anything ever happens by the mere passing of time.
    pub fn may_wait(&self) -> bool {
        self.run.may_wait()
    }

    /// The number of a declared event.
    pub fn event(&self, name: &str) -> Option<usize> {
        self.meaning().events.iter().position(|e| e.name == name)
    }

    /// Takes in what comes next. Time that goes back starts every monitor anew, as on a recording.
    #[inline]
    pub fn feed(&mut self, sample: Sample<'_>) {
        let (start, end) = self.span.unwrap_or((sample.time, sample.time));
        self.span = Some((start.min(sample.time), end.max(sample.time)));
        self.run.take(sample);
    }

    /// Time has come to `now`, and nothing else has happened: bounds that ended before are over. Before anything has come at all, no
    /// time passes.
    pub fn pass(&mut self, now: Time) {
        if self.span.is_some() {
            self.feed(Sample { time: now, what: What::Other });
        }
    }

    /// When something happens though nothing comes: [`Monitor::pass`] once the clock has gone beyond it.
    pub fn next_deadline(&mut self) -> Option<Time> {
        self.run.next_deadline()
    }

    /// Whether anything has come at all.
    pub fn has_begun(&self) -> bool {
        self.span.is_some()
    }

    /// The next violation that has not been told.
    #[inline]
    pub fn news(&mut self) -> Option<News> {
        let untold = self.run.news()?;
        let Untold { number, instance, property, violation, is_further } = untold;
        let start = self.span.map_or(violation.began, |(start, _)| start);
        Some(News { number, instance, property, violation, is_further, start })
    }

    /// The monitor of a property, or of an instance of it, starts afresh: its past is forgotten, its violations stand. Returns whether it
    /// could: one without a reaction that says `reset` may share its past with others.
    pub fn reset(&mut self, number: usize, instance: &[Value]) -> bool {
        self.run.reset(number, instance)
    }

    /// The state in which a state diagram stands; `None` where there is no such diagram, or it stands in none of its states.
    pub fn state(&self, machine: &str) -> Option<&str> {
        self.run.state_of(machine)
    }

    /// The program is over, or no longer watched.
    pub fn finish(&mut self, unseen: &Unseen) -> Report {
        let unseen = match self.system {
            Some(_) => unseen.clone(),
            None => self.with_what_programs_lack(unseen),
        };
        let finished = self.run.finish(&Damage::default(), &Met::default());
        let mut properties: Vec<Property> = finished.into_iter().map(|(_, property)| property).collect();
        for property in &mut properties {
            let blank = |name: &str| property.name == name || property.name.starts_with(&format!("{name}["));
            let Some(meant) = self.meaning().properties.iter().find(|p| blank(&p.name)) else { continue };
            doubt(property, &Needs::of(self.meaning(), meant), &unseen);
        }
        let mut warnings = Vec::new();
        while let Some(jump) = self.run.jump() {
            warnings.push(jump);
        }
        warnings.extend(self.run.revelations());
        warnings.extend(self.run.warnings(&properties, &Met::default()));
        Report {
            specs: vec![self.name.clone()],
            trace: self.system.clone().unwrap_or_else(|| "the running program".to_owned()),
            span: self.span,
            instants: self.run.instants(),
            topics: self.run.topics(),
            properties,
            warnings,
            gaps: Vec::new(),
        }
    }

    /// Messages, services and components are not seen from within a program.
    fn with_what_programs_lack(&self, unseen: &Unseen) -> Unseen {
        let mut unseen = unseen.clone();
        for (number, event) in self.meaning().events.iter().enumerate() {
            let what = match &event.source {
                EventSource::Message { topic } => {
                    let topic = self.meaning().topics.get(*topic).map_or("", |t| &t.name);
                    format!("message {topic}")
                }
                EventSource::Program(text) => text.clone(),
                _ => continue,
            };
            let cause = format!("a program has no such events: `{}` is `{what}`", event.name);
            unseen.events.entry(number).or_insert(cause);
        }
        unseen
    }
}

/// What did not fail and rests on what could not be seen is inconclusive.
fn doubt(property: &mut Property, needs: &Needs, unseen: &Unseen) {
    if property.verdict == Verdict::Violated {
        return;
    }
    let events = needs.events.iter().filter_map(|event| unseen.events.get(event));
    let columns = needs.columns.iter().filter_map(|column| unseen.columns.get(column));
    let mut causes: Vec<&str> = property.cause.as_deref().into_iter().collect();
    for cause in events.chain(columns) {
        if !causes.contains(&cause.as_str()) {
            causes.push(cause);
        }
    }
    if !causes.is_empty() {
        (property.cause, property.vacuous) = (Some(causes.join("; ")), false);
        property.verdict = Verdict::Inconclusive;
        property.unmet_since = None;
        property.at_end.clear();
    }
}
