//! A session: specifications over one recording, read once.

use std::borrow::Cow;
use std::num::NonZeroUsize;
use std::path::Path;

use lapwing_diag::Style;
use lapwing_react::history::History;
use lapwing_react::{Event, Property, Report, Topic, Warning};
use lapwing_record::{OpenError, ReadError, Reader, Recording};
use lapwing_stream::Time;

use crate::intake::{Intake, Wants};
use crate::live::replay;
use crate::losses::Damage;
use crate::run::{Noting, Run};
use crate::shape;
use crate::spec::Spec;
use crate::watch::Watch;

/// After so many messages a watch is told how far the reading has come.
const TOLD_EVERY: u32 = 256;

/// How a recording is to be checked.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// How it is to be read.
    pub recording: lapwing_record::Options,
    /// Whether to stop at the first violation.
    pub until_first_violation: bool,
    /// Whether to compute by how much each property missed changing its verdict.
    pub margins: bool,
    /// Whether to note how signals and properties go over time, and how many points at most of each: see [`Session::run_noting`].
    pub history: Option<usize>,
    /// How many runs of obligations a property may have open before it is given up as `inconclusive`, where it is not as many as usual:
    /// [`OPEN_LIMIT`](lapwing_check::compile::OPEN_LIMIT).
    pub open_limit: Option<NonZeroUsize>,
}

impl Options {
    /// What is to be noted of each run.
    pub(crate) fn noting(&self) -> Noting {
        Noting { margins: self.margins, history: self.history, open_limit: self.open_limit }
    }
}

/// Specifications over one recording, which is read once. Each specification has its own clock and its own state.
pub struct Session<'s> {
    specs: &'s [Spec],
    recording: Recording,
    wants: Wants,
    runs: Vec<Run<'s>>,
    /// What each of them reads of the recording.
    intakes: Vec<Intake>,
    report: Report,
    options: Options,
}

impl<'s> Session<'s> {
    /// Opens a recording, and checks the specifications against what it carries.
    pub fn open(specs: &'s [Spec], trace: &Path, options: &Options) -> Result<Session<'s>, OpenError> {
        let recording = shape::open(specs, trace, &options.recording)?;
        Ok(Session::over(specs, recording, trace, options))
    }

    /// Checks the specifications against a recording that is open already; `trace` is what reports call it. What a program says
    /// without a file comes this way.
    pub fn over(specs: &'s [Spec], recording: Recording, trace: &Path, options: &Options) -> Session<'s> {
        let shape = shape::of(&recording);
        let mut wants = Wants::default();
        let noting = options.noting();
        let run = |spec: &'s Spec| Run::new(Cow::Borrowed(spec), spec.fitted(&shape, noting.open_limit), noting);
        let runs: Vec<Run> = specs.iter().map(run).collect();
        let intakes = runs.iter().map(|run| Intake::new(run.meaning(), &mut wants)).collect();
        let mut report = blank(specs, trace);
        report.properties = runs.iter().flat_map(Run::blanks).cloned().collect();
        report.topics = topics(&runs, &recording);
        Session { specs, recording, wants, runs, intakes, report, options: options.clone() }
    }

    /// What the recording revealed of the specifications, as text with places: topics that are not there, fields that types lack.
    pub fn findings(&self, style: Style) -> Vec<String> {
        let of_run = |run: &Run| run.diagnostics().iter().map(|d| run.render(d, style)).collect::<Vec<_>>();
        // What a live run did not see is told as it happened.
        let is_of_a_run = replay::is_of_a_run(&self.recording);
        self.runs.iter().filter(|_| !is_of_a_run).flat_map(of_run).collect()
    }

    /// Reads the recording to its end.
    pub fn run(self, watch: &mut dyn Watch) -> Report {
        self.run_noting(watch).0
    }

    /// Reads the recording to its end, and gives for each specification how its signals and properties went over time, where
    /// [`Options::history`] asks for it. The properties of the report are those of the first specification, then those of the second, and so on.
    pub fn run_noting(self, watch: &mut dyn Watch) -> (Report, Vec<History>) {
        let Session { specs, recording, wants, mut runs, intakes, mut report, options } = self;
        if replay::is_of_a_run(&recording) {
            return replay::replay(specs, recording, Path::new(&report.trace), &options, watch);
        }
        watch.event(Event::Start(&report));
        runs.iter().flat_map(Run::revelations).for_each(|w| warn(&mut report, w, watch));
        let types: Vec<Topic> = std::mem::take(&mut report.topics);
        let reader = recording.read_signals(wants.list(), wants.signals());
        let mut course = Course { reader, pace: Pace::default(), intakes, report: &mut report, watch };
        let damage = course.read(&mut runs, &options);
        let met = course.reader.met().into();
        for run in &mut runs {
            let properties: Vec<Property> =
                run.finish(&damage, &met).into_iter().map(|(_, property)| property).collect();
            course.tell(run);
            run.warnings(&properties, &met).into_iter().for_each(|w| course.warn(w));
            course.report.properties.extend(properties);
        }
        report.topics = types.into_iter().map(|topic| counted(topic, &runs)).collect();
        report.instants = runs.iter().map(Run::instants).max().unwrap_or_default();
        report.gaps = damage.gaps;
        report.properties.iter().for_each(|p| watch.event(Event::Verdict(p)));
        watch.event(Event::End(&report));
        (report, runs.into_iter().filter_map(Run::into_history).collect())
    }
}

/// The report on a recording that cannot be opened: nothing can be judged.
pub fn unopened(specs: &[Spec], trace: &Path, why: &OpenError, watch: &mut dyn Watch) -> Report {
    let mut report = blank(specs, trace);
    let cause = format!("the recording cannot be opened: {why}");
    for spec in specs {
        let meaning = &spec.alone().spec;
        let blanks = meaning.properties.iter().map(|p| crate::account::blank(spec, meaning, p));
        report.properties.extend(blanks.map(|p| lapwing_react::Property {
            cause: Some(cause.clone()),
            reactions: Vec::new(),
            ..p
        }));
    }
    report.gaps.push(why.to_string());
    watch.event(Event::Start(&report));
    report.properties.iter().for_each(|p| watch.event(Event::Verdict(p)));
    watch.event(Event::End(&report));
    report
}

fn blank(specs: &[Spec], trace: &Path) -> Report {
    let specs = specs.iter().map(|s| s.name().to_owned()).collect();
    Report { specs, trace: trace.to_string_lossy().into_owned(), ..Report::default() }
}

/// The topics that are read, each once, with the types that the recording has them with.
fn topics(runs: &[Run], recording: &Recording) -> Vec<Topic> {
    let mut topics: Vec<Topic> = Vec::new();
    for topic in runs.iter().flat_map(Run::topics) {
        if topics.iter().all(|t| t.name != topic.name) {
            let recorded = recording
                .topics()
                .iter()
                .find(|t| t.name.trim_start_matches('/') == topic.name.trim_start_matches('/'));
            let recorded = recorded.map(|t| t.type_name.clone()).filter(|name| !name.is_empty());
            topics.push(Topic { type_name: recorded.or_else(|| topic.type_name.clone()), ..topic });
        }
    }
    topics
}

/// A topic with what came of it: of several clocks, with the most that went unseen.
fn counted(topic: Topic, runs: &[Run]) -> Topic {
    let same = |run: &Run| run.topics().into_iter().find(|t| t.name == topic.name);
    let all: Vec<Topic> = runs.iter().filter_map(same).collect();
    Topic {
        messages: all.iter().map(|t| t.messages).max().unwrap_or_default(),
        unseen: all.iter().map(|t| t.unseen).max().unwrap_or_default(),
        ..topic
    }
}

fn warn(report: &mut Report, warning: Warning, watch: &mut dyn Watch) {
    watch.event(Event::Warning(&warning));
    report.warnings.push(warning);
}

/// How far the reading has come.
#[derive(Default)]
struct Pace {
    /// From the earliest item to the latest.
    span: Option<(Time, Time)>,
    /// The time of the last item.
    last: Option<Time>,
    /// How many items there were.
    count: u32,
}

impl Pace {
    #[inline]
    fn note(&mut self, time: Time) {
        let (start, end) = self.span.unwrap_or((time, time));
        (self.span, self.last) = (Some((start.min(time), end.max(time))), Some(time));
        self.count = self.count.wrapping_add(1);
    }

    /// Whether it is time to tell how far it is.
    fn is_due(&self) -> bool {
        self.count.is_multiple_of(TOLD_EVERY)
    }

    /// Whether it will be after the next item.
    #[inline]
    fn is_next_due(&self) -> bool {
        self.count.wrapping_add(1).is_multiple_of(TOLD_EVERY)
    }
}

/// The reading of a recording.
struct Course<'c> {
    reader: Reader,
    pace: Pace,
    intakes: Vec<Intake>,
    report: &'c mut Report,
    watch: &'c mut dyn Watch,
}

impl Course<'_> {
    /// Reads to the end, or as far as is wanted. Gives what could not be read.
    fn read(&mut self, runs: &mut [Run], options: &Options) -> Damage {
        self.report.properties.clear();
        let (mut error, mut stopped) = (None, None);
        while stopped.is_none() {
            let step = self.step(runs);
            let told: usize = runs.iter_mut().filter(|run| run.has_news()).map(|run| self.tell(run)).sum();
            if told > 0 && options.until_first_violation {
                stopped = Some("stopped at the first violation, as asked");
            } else if !self.watch.goes_on() {
                stopped = Some("interrupted");
            }
            match step {
                Step::Went => {}
                Step::End => break,
                Step::Broke(e) => {
                    error = Some(e);
                    break;
                }
            }
            if self.pace.is_due() {
                let (read, of) = self.reader.progress();
                self.watch.progress(read, of);
            }
        }
        self.report.span = self.pace.span;
        let last = self.pace.last;
        // Who has stopped is told nothing of an input that could not be waited for.
        let mut damage = Damage::new(self.reader.losses(), error.as_ref().filter(|_| stopped.is_none()), last);
        if let Some(why) = stopped {
            damage.break_off(why.to_owned());
        }
        damage
    }

    fn step(&mut self, runs: &mut [Run]) -> Step {
        let Course { reader, intakes, watch, pace, .. } = self;
        let passes = |time| {
            let is_all = !pace.is_next_due() && watch.goes_on() && runs.iter_mut().all(|run| run.passes_quietly(time));
            if is_all {
                pace.note(time);
            }
            is_all
        };
        match reader.next_but(passes) {
            None => Step::End,
            Some(Err(error)) => Step::Broke(error),
            Some(Ok(item)) => {
                pace.note(item.time());
                runs.iter_mut().zip(intakes).for_each(|(run, intake)| run.take(intake.sample(&item)));
                Step::Went
            }
        }
    }

    /// Tells what happened in a run since it was last asked. Gives how many violations that were.
    fn tell(&mut self, run: &mut Run) -> usize {
        while let Some(warning) = run.jump() {
            self.warn(warning);
        }
        let mut told = 0;
        while let Some(news) = run.news() {
            self.watch.event(Event::Violation { property: &news.property, violation: &news.violation });
            told += 1;
        }
        told
    }

    fn warn(&mut self, warning: Warning) {
        warn(self.report, warning, self.watch);
    }
}

/// What a step of the reading came to.
enum Step {
    Went,
    End,
    Broke(ReadError),
}
