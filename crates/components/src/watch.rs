//! Monitors over a run: specifications see what happens as messages, and what they do about violations is done before time passes.

use std::collections::BTreeMap;

use lapwing::{Monitor, News, Report, Spec, Unseen};
use lapwing_check::checked::{self, Action, Path, Step};
use lapwing_diag::{Code, Diagnostic, Severity, Style, render};
use lapwing_stream::{Duration, Sample, Time, Value, What as Sampled};

use crate::happening::{Happening, What};
use crate::request::Request;
use crate::run::Run;
use crate::signals::{Message, Signals};

/// A specification that does not go with the components: what is wrong, with places.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Mismatch(pub String);

impl std::fmt::Display for Mismatch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Mismatch {}

/// The monitors of a run.
pub struct Watch {
    all: Vec<Guard>,
    signals: Signals,
    has_begun: bool,
    /// Violations that nobody has been told of.
    news: Vec<News>,
}

/// The monitor of a specification.
struct Guard {
    monitor: Monitor,
    /// By the number of a topic of the system: its number in the specification, and the ways to the fields that are wanted.
    wanted: BTreeMap<usize, (usize, Vec<Path>)>,
    reactions: Vec<Reaction>,
    /// When each reaction was carried out last, by the instance of the property.
    last: BTreeMap<(usize, String), Time>,
    /// What was done, by property, and how often.
    done: BTreeMap<String, Vec<(String, u64)>>,
    values: Vec<Value>,
}

/// What is to be done on a violation of some properties.
struct Reaction {
    properties: Vec<usize>,
    at_most_every: Option<Duration>,
    deeds: Vec<Deed>,
}

#[derive(Clone)]
enum Deed {
    Request(Request, String),
    Reset,
    Stop,
    /// What cannot be done here, in words.
    Not(String),
}

impl Watch {
    /// Monitors of specifications over a run that has not begun.
    ///
    /// # Errors
    ///
    /// A specification names what the components do not have, or a reaction asks for a service that is not there or needs values.
    pub fn new(specs: Vec<Spec>, run: &Run, style: Style) -> Result<Watch, Mismatch> {
        let signals = Signals::new(run.model(), run.types());
        let mut all = Vec::new();
        let mut wrong = String::new();
        for spec in specs {
            match Guard::new(spec, run, &signals, style) {
                Ok(guard) => all.push(guard),
                Err(Mismatch(text)) => wrong += &text,
            }
        }
        if wrong.is_empty() {
            Ok(Watch { all, signals, has_begun: false, news: Vec::new() })
        } else {
            Err(Mismatch(wrong))
        }
    }

    /// Nobody writes the run down: messages that no specification reads are left empty.
    pub fn skip_unread(&mut self) {
        let all = &self.all;
        self.signals.want_only(|topic| all.iter().any(|guard| guard.wanted.contains_key(&topic)));
    }

    /// The topics of the system.
    pub fn signals(&self) -> &Signals {
        &self.signals
    }

    /// Something has happened. Reactions are carried out on the run. Gives the messages that say what happened.
    pub fn see(&mut self, run: &mut Run, happening: &Happening) -> Vec<Message> {
        let mut messages = Vec::new();
        if !self.has_begun {
            self.has_begun = true;
            messages = self.signals.first();
        }
        messages.extend(self.signals.of(happening));
        if happening.what == What::Over {
            self.pass(run, happening.time);
            messages.push(self.signals.last());
        }
        for message in &messages {
            for guard in &mut self.all {
                guard.feed(happening.time, message);
            }
            self.react(run);
        }
        if happening.what == What::Woken {
            self.pass(run, happening.time);
        }
        run.wake_at(self.deadline());
        messages
    }

    /// The next violation that has not been told.
    pub fn news(&mut self) -> Option<News> {
        (!self.news.is_empty()).then(|| self.news.remove(0))
    }

    /// The run is over: what is said of all properties. A gap says why not everything could be seen.
    pub fn finish(mut self, gap: Option<String>) -> Report {
        let mut whole = Report::default();
        for guard in &mut self.all {
            let mut report = guard.monitor.finish(&Unseen::default());
            for property in &mut report.properties {
                property.reactions = guard.told(&property.name);
            }
            whole.trace = report.trace;
            whole.specs.extend(report.specs);
            whole.properties.extend(report.properties);
            whole.warnings.extend(report.warnings);
            whole.instants = whole.instants.max(report.instants);
            for topic in report.topics {
                if whole.topics.iter().all(|t| t.name != topic.name) {
                    whole.topics.push(topic);
                }
            }
            whole.span = match (whole.span, report.span) {
                (Some((a, b)), Some((c, d))) => Some((a.min(c), b.max(d))),
                (one, other) => one.or(other),
            };
        }
        whole.gaps.extend(gap);
        whole
    }

    /// Just beyond the earliest bound that ends although nothing happens.
    fn deadline(&mut self) -> Option<Time> {
        let all = self.all.iter_mut().filter_map(|guard| guard.monitor.next_deadline());
        all.min().map(|at| Time(at.0.saturating_add(1)))
    }

    fn pass(&mut self, run: &mut Run, now: Time) {
        for guard in &mut self.all {
            guard.monitor.pass(now);
        }
        self.react(run);
    }

    fn react(&mut self, run: &mut Run) {
        for guard in &mut self.all {
            while let Some(news) = guard.monitor.news() {
                if !news.is_further {
                    guard.answer(run, &news);
                }
                self.news.push(news);
            }
        }
    }
}

impl Guard {
    fn new(spec: Spec, run: &Run, signals: &Signals, style: Style) -> Result<Guard, Mismatch> {
        let shape = signals.shape();
        let checked = spec.against(&shape);
        let sources = spec.findings().sources.clone();
        let mut wrong: Vec<Diagnostic> =
            checked.beyond(&spec.findings().diagnostics).filter(|d| is_fatal(d)).cloned().collect();
        let mut reactions = Vec::new();
        for reaction in &checked.spec.reactions {
            let mut deeds = Vec::new();
            for action in &reaction.actions {
                match deed(action, run) {
                    Ok(deed) => deeds.push(deed),
                    Err(why) => wrong.push(Diagnostic::new(Code::UnknownName, reaction.span, why)),
                }
            }
            let of = |n: &usize| checked.spec.properties.get(*n).is_some_and(|p| reaction.is_of(p));
            let properties = (0..checked.spec.properties.len()).filter(of).collect();
            reactions.push(Reaction { properties, at_most_every: reaction.at_most_every, deeds });
        }
        if !wrong.is_empty() {
            return Err(Mismatch(wrong.iter().map(|d| render(&sources, d, style)).collect()));
        }
        let monitor = Monitor::of_system(spec, &shape, "the components");
        let wanted = wanted(monitor.meaning(), signals);
        Ok(Guard { monitor, wanted, reactions, last: BTreeMap::new(), done: BTreeMap::new(), values: Vec::new() })
    }

    fn feed(&mut self, time: Time, message: &Message) {
        let what = match self.wanted.get(&message.topic) {
            None => Sampled::Other,
            Some((topic, paths)) => {
                self.values.clear();
                self.values.extend(paths.iter().map(|path| part(&message.value, path)));
                Sampled::Message { topic: *topic, values: &self.values }
            }
        };
        self.monitor.feed(Sample { time, what });
    }

    fn answer(&mut self, run: &mut Run, news: &News) {
        let name = news.property.name.clone();
        let mut wanted = Vec::new();
        for (number, reaction) in self.reactions.iter().enumerate().filter(|(_, r)| r.properties.contains(&news.number))
        {
            let (key, now) = ((number, name.clone()), run.now());
            if let Some(every) = reaction.at_most_every {
                let last = self.last.get(&key);
                if last.is_some_and(|last| now.since(*last) < every) {
                    continue;
                }
                self.last.insert(key, now);
            }
            wanted.extend(reaction.deeds.iter().cloned());
        }
        for deed in wanted {
            let words = match deed {
                Deed::Request(request, words) => {
                    run.request_first(request, Some(name.clone()));
                    words
                }
                Deed::Reset => {
                    self.monitor.reset(news.number, &news.instance);
                    "reset".to_owned()
                }
                Deed::Stop => {
                    run.stop();
                    "stopped".to_owned()
                }
                Deed::Not(words) => words,
            };
            self.count(&name, words);
        }
    }

    fn count(&mut self, property: &str, words: String) {
        let counts = self.done.entry(property.to_owned()).or_default();
        match counts.iter_mut().find(|(known, _)| *known == words) {
            Some((_, count)) => *count += 1,
            None => counts.push((words, 1)),
        }
    }

    fn told(&self, property: &str) -> Vec<String> {
        let counts = self.done.get(property).into_iter().flatten();
        counts
            .map(|(words, count)| if *count == 1 { words.clone() } else { format!("{words} ({count} times)") })
            .collect()
    }
}

/// Whether what is found means that a property could never be judged on these components.
pub(crate) fn is_fatal(diagnostic: &Diagnostic) -> bool {
    let is_absence =
        matches!(diagnostic.code, Code::MissingTopic | Code::TopicType | Code::MissingEvent | Code::MissingColumn);
    diagnostic.severity == Severity::Error || is_absence
}

fn deed(action: &Action, run: &Run) -> Result<Deed, String> {
    match action {
        Action::Request(name) => {
            let request = run.plain_request(name)?;
            Ok(Deed::Request(request, format!("requested {name}")))
        }
        Action::Reset => Ok(Deed::Reset),
        Action::Stop => Ok(Deed::Stop),
        other => Ok(Deed::Not(format!("did not {other}: components have services and ports, and nothing else"))),
    }
}

/// What a specification wants of the topics of a system.
fn wanted(meaning: &checked::Spec, signals: &Signals) -> BTreeMap<usize, (usize, Vec<Path>)> {
    let place = |name: &str| signals.topics().iter().position(|t| t.name == name);
    let all = meaning.topics.iter().enumerate();
    all.filter_map(|(number, topic)| Some((place(&topic.name)?, (number, topic.fields.clone())))).collect()
}

/// The part of a message at the end of a way.
fn part(value: &Value, path: &[Step]) -> Value {
    let Some((step, rest)) = path.split_first() else { return value.clone() };
    let next = match (step, value) {
        (Step::Field(name), value) => value.field(name),
        (Step::Index(index), Value::List(items)) => items.get(*index),
        (Step::Index(index), Value::Nums(numbers)) => {
            return numbers.get(*index).filter(|_| rest.is_empty()).map_or(Value::Missing, |x| Value::Num(*x));
        }
        _ => None,
    };
    next.map_or(Value::Missing, |next| part(next, rest))
}
