//! One specification over one recording.

use lapwing_check::{checked, compile};
use lapwing_diag::{Code, Diagnostic, Severity};
use lapwing_engine::inputs::Inputs;
use lapwing_engine::{Observer, Output, Program, State};
use lapwing_react::history::History;
use lapwing_react::{Property, Topic, Violation, Warning};
use lapwing_record::Item;
use lapwing_stream::{Time, Value, Verdict};

use crate::account::{self, Notes};
use crate::explain;
use crate::hints::{self, Latch};
use crate::history::Recorder;
use crate::intake::{Intake, Wants};
use crate::losses::Damage;
use crate::session::Options;
use crate::shown;
use crate::spec::Spec;
use crate::trail::Positions;
use crate::witness::{Interest, Witness};

/// A share of messages that no instant saw, beyond which there is a warning.
const UNSEEN: f64 = 0.1;

/// One specification over one recording.
pub(crate) struct Run<'s> {
    spec: &'s Spec,
    meaning: checked::Spec,
    /// What the recording revealed of the specification.
    pub diagnostics: Vec<Diagnostic>,
    program: Program,
    state: State,
    intake: Intake,
    witness: Witness,
    latches: Vec<Option<Latch>>,
    /// Notes how it goes, where that is asked for.
    recorder: Option<Recorder>,
    /// The properties as they are before anything is known of them.
    pub blanks: Vec<Property>,
    /// How many violations have been told.
    told: usize,
    /// How many jumps have been told.
    jumps_told: usize,
    /// The properties whose margins would have taken too much memory.
    unmeasured: Vec<String>,
}

impl<'s> Run<'s> {
    /// A run over a recording that has been checked; `wants` gets what is to be read of it.
    pub fn new(spec: &'s Spec, checked: lapwing_check::Checked, options: &Options, wants: &mut Wants) -> Run<'s> {
        let diagnostics = checked.beyond(&spec.findings().diagnostics).cloned().collect();
        let meaning = checked.spec;
        let program = compile::compile(&meaning);
        let latches: Vec<_> = meaning.properties.iter().map(|p| Latch::of(spec, p)).collect();
        let interest = |(property, latch): (&checked::Property, &Option<Latch>)| Interest {
            shown: shown::everything(spec, &meaning, property),
            positions: Positions::of(&meaning, property),
            latch: latch.clone(),
            latency: explain::latency(property),
            topics: hints::topics(&meaning, property),
        };
        let interests = meaning.properties.iter().zip(&latches).map(interest).collect();
        Run {
            spec,
            diagnostics,
            state: if options.margins { State::with_margins(&program) } else { State::new(&program) },
            intake: Intake::new(&meaning, wants),
            witness: Witness::new(meaning.clock, interests),
            latches,
            blanks: meaning.properties.iter().map(|p| account::blank(spec, &meaning, p)).collect(),
            recorder: options.history.map(|most| Recorder::new(spec, &meaning, most)),
            told: 0,
            jumps_told: 0,
            unmeasured: Vec::new(),
            meaning,
            program,
        }
    }

    /// Takes in what comes next.
    pub fn take(&mut self, item: &Item<'_>) {
        let sample = self.intake.sample(item);
        self.witness.arrives(sample.time);
        match &mut self.recorder {
            None => self.state.feed(&self.program, sample, &mut self.witness),
            Some(recorder) => {
                self.state.feed(&self.program, sample, &mut Both(&mut self.witness, recorder));
                recorder.take(sample);
            }
        }
    }

    /// The next violation that has not been told, with the property that it is of.
    pub fn news(&mut self) -> Option<(Property, Violation)> {
        let found = self.witness.found().get(self.told)?;
        self.told += 1;
        let blank = self.blanks.get(found.property)?;
        let name = account::name(&blank.name, &found.instance);
        Some((Property { name, verdict: Verdict::Violated, ..blank.clone() }, found.violation.clone()))
    }

    /// The next jump of time that has not been told.
    pub fn jump(&mut self) -> Option<Warning> {
        let (from, to) = *self.witness.jumps().get(self.jumps_told)?;
        self.jumps_told += 1;
        let what = match to < from {
            true => format!("time jumped back from {from} to {to}"),
            false => format!("nothing came between {from} and {to}, longer than a rate can count"),
        };
        Some(Warning::plain(format!("{what}: every monitor of {} started anew", self.spec.name())))
    }

    /// How many instants there were.
    pub fn instants(&self) -> u64 {
        self.state.instants()
    }

    /// What came of each topic.
    pub fn topics(&self) -> Vec<Topic> {
        let topic = |(number, topic): (usize, &checked::Topic)| {
            let (messages, unseen) = self.state.messages(number);
            Topic { name: topic.name.clone(), type_name: topic.type_name.clone(), messages, unseen }
        };
        self.meaning.topics.iter().enumerate().map(topic).collect()
    }

    /// A diagnostic of this specification as text.
    pub fn render(&self, diagnostic: &Diagnostic, style: lapwing_diag::Style) -> String {
        lapwing_diag::render(&self.spec.findings().sources, diagnostic, style)
    }

    /// What the recording revealed of the specification, as warnings with their places.
    pub fn revelations(&self) -> Vec<Warning> {
        let worth = self.diagnostics.iter().filter(|d| d.severity != Severity::Note);
        worth
            .map(|d| {
                let (line, column) = self.spec.findings().sources.position(d.primary.span);
                let file = self.spec.findings().sources.name(d.primary.span.file).to_owned();
                Warning { place: Some((file, line, column)), ..Warning::with_code(d.code, d.message.clone()) }
            })
            .collect()
    }

    /// The recording is over.
    pub fn finish(&mut self, damage: &Damage) -> Vec<Property> {
        let ending = damage.ending(&self.meaning.topics);
        let outcomes = match &mut self.recorder {
            None => self.state.finish(&self.program, &ending, &mut self.witness),
            Some(recorder) => {
                let outcomes = self.state.finish(&self.program, &ending, &mut Both(&mut self.witness, recorder));
                recorder.end();
                outcomes
            }
        };
        let mut notes = Notes::new(self.witness.found());
        let mut properties = Vec::new();
        for outcome in &outcomes {
            let Some(blank) = self.blanks.get(outcome.property) else { continue };
            let mut property = account::property(blank.clone(), outcome, &mut notes);
            account::doubt(&mut property, damage);
            if property.verdict == Verdict::Unmet {
                property.at_end = self.witness.readings(outcome.property, &outcome.instance, self.state.inputs());
            }
            if self.witness.is_latched(outcome.property) && property.verdict == Verdict::Violated {
                property.hints.extend(self.latches[outcome.property].as_ref().map(Latch::hint));
            }
            if property.verdict == Verdict::Violated {
                let silences = self.witness.silences(outcome.property).iter().filter_map(|(topic, silent)| {
                    let (messages, _) = self.state.messages(*topic);
                    hints::silence(&self.meaning.topics.get(*topic)?.name, messages, *silent, self.witness.span())
                });
                property.hints.extend(silences);
            }
            account::remark(&mut property);
            if outcome.margin_gave_up {
                self.unmeasured.push(property.name.clone());
            }
            if let Some(recorder) = &mut self.recorder {
                recorder.judged(outcome, &property);
            }
            properties.push(property);
        }
        properties
    }

    /// How it went, where that was asked for.
    pub fn into_history(self) -> Option<History> {
        self.recorder.map(Recorder::finish)
    }

    /// What only the whole run shows.
    pub fn warnings(&self, properties: &[Property]) -> Vec<Warning> {
        let unseen = self.topics().into_iter().filter(|t| t.unseen as f64 > UNSEEN * t.messages as f64).map(|t| {
            let share = 100.0 * t.unseen as f64 / t.messages.max(1) as f64;
            let what = format!("{share:.0} % of the messages of {} ({} of {})", t.name, t.unseen, t.messages);
            let how = format!(
                "came between two instants of {} and went unseen: raise its `__rate__`, or use `clock events`",
                self.spec.name()
            );
            Warning::with_code(Code::SamplingUnseen, format!("{what} {how}"))
        });
        let latched = (0..self.meaning.properties.len()).filter(|p| self.witness.is_latched(*p)).filter_map(|p| {
            let name = &self.blanks.get(p)?.name;
            let failed = properties.iter().any(|p| p.name == *name && p.verdict == Verdict::Violated);
            let message = format!("{name} failed although the X of its `after X` had become false again before");
            failed.then(|| Warning::with_code(Code::LatchedAfter, message))
        });
        let unmeasured = self.unmeasured.iter().map(|name| {
            let limit = self.program.margin_limit;
            let why = format!("more than {limit} values would have to be kept until the end");
            Warning::plain(format!("{name} has no margin: {why}"))
        });
        unseen.chain(latched).chain(unmeasured).collect()
    }
}

/// Two who look at the engine.
struct Both<'b>(&'b mut Witness, &'b mut Recorder);

impl Observer for Both<'_> {
    fn wants_margins(&self) -> bool {
        self.1.wants_margins()
    }

    fn margin(&mut self, property: usize, instance: &[Option<Value>], at: Time, margin: f64) {
        self.1.margin(property, instance, at, margin);
    }

    fn output(&mut self, inputs: &Inputs, output: Output<'_>) {
        self.1.output(inputs, output.clone());
        self.0.output(inputs, output);
    }
}
