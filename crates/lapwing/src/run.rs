//! One specification over what comes, sample by sample: from a recording or from a running program.

use std::borrow::Cow;
use std::num::NonZeroUsize;
use std::sync::Arc;

use lapwing_check::checked;
use lapwing_diag::{Code, Diagnostic, Severity};
use lapwing_engine::inputs::Inputs;
use lapwing_engine::program::{Clock, Future, FutureKind};
use lapwing_engine::{Ending, Observer, Output, Program, Standing, State};
use lapwing_react::history::History;
use lapwing_react::{Property, Reading, Topic, Violation, Warning};
use lapwing_stream::{Sample, Time, Value, Verdict};

use crate::account::{self, Notes};
use crate::fitted::Fitted;
use crate::hints::{self, Latch};
use crate::history::{Recorder, Strip};
use crate::instance;
use crate::losses::Damage;
use crate::meant::{self, Met};
use crate::spec::Spec;
use crate::witness::Witness;

/// A share of messages that no instant saw, beyond which there is a warning.
const UNSEEN: f64 = 0.1;

/// What is noted of a run beside its verdicts.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Noting {
    /// By how much each property missed changing its verdict.
    pub margins: bool,
    /// How signals and properties go over time, and how many points at most of each.
    pub history: Option<usize>,
    /// How many runs of obligations a property may have open, where it is not as many as usual.
    pub open_limit: Option<NonZeroUsize>,
}

/// One specification over what comes.
pub(crate) struct Run<'s> {
    spec: Cow<'s, Spec>,
    fitted: Arc<Fitted>,
    state: State,
    witness: Witness,
    /// Notes how it goes, where that is asked for.
    recorder: Option<Recorder>,
    /// What the signals did lately, where somebody looks on.
    strip: Option<Strip>,
    /// How many violations have been told.
    told: usize,
    /// How many jumps have been told.
    jumps_told: usize,
    /// The properties whose margins would have taken too much memory.
    unmeasured: Vec<String>,
}

/// A violation that has not been told.
pub(crate) struct Untold {
    /// The number of the property.
    pub number: usize,
    /// The values of its slices.
    pub instance: Vec<Value>,
    /// The property, or its instance, as far as it is known.
    pub property: Property,
    /// What is known of the violation.
    pub violation: Violation,
    /// Whether another one of the property was found at the same moment: who reacts has been told already.
    pub is_further: bool,
}

impl<'s> Run<'s> {
    /// A run of a specification that has been made ready for what will come.
    pub fn new(spec: Cow<'s, Spec>, fitted: Arc<Fitted>, noting: Noting) -> Run<'s> {
        let Fitted { meaning, program, interests, .. } = &*fitted;
        Run {
            state: if noting.margins { State::with_margins(program) } else { State::new(program) },
            witness: Witness::new(meaning, interests.clone()),
            recorder: noting.history.map(|most| Recorder::new(&spec, meaning, most)),
            strip: None,
            told: 0,
            jumps_told: 0,
            unmeasured: Vec::new(),
            spec,
            fitted,
        }
    }

    /// What the specification means here.
    pub fn meaning(&self) -> &checked::Spec {
        &self.fitted.meaning
    }

    /// The properties as they are before anything is known of them.
    pub fn blanks(&self) -> &[Property] {
        &self.fitted.blanks
    }

    /// What the recording revealed of the specification.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.fitted.diagnostics
    }

    /// Whether anything ever happens by the mere passing of time.
    pub fn may_wait(&self) -> bool {
        let Program { clock, groups, machines, .. } = &self.fitted.program;
        let ages = groups.iter().map(|g| &g.at).chain(machines.iter().map(|m| &m.at)).any(|at| !at.ages.is_empty());
        let stays = machines.iter().flat_map(|m| &m.states).any(|s| s.at_most.is_some());
        let ends = |future: &Future| match &future.kind {
            FutureKind::Eventually(bound, _) | FutureKind::Until(bound, ..) => bound.has_end(),
            FutureKind::Replay(_) => true,
            _ => false,
        };
        *clock != Clock::Events || ages || stays || groups.iter().flat_map(|g| &g.futures).any(ends)
    }

    /// When something happens though nothing comes.
    pub fn next_deadline(&mut self) -> Option<Time> {
        self.state.next_deadline(&self.fitted.program)
    }

    /// The state in which a machine stands.
    pub fn state_of(&self, machine: &str) -> Option<&str> {
        let number = self.fitted.meaning.machines.iter().position(|m| m.name == machine)?;
        let state = self.state.inputs().state(number)?;
        self.fitted.meaning.machines.get(number)?.states.get(state).map(|s| s.name.as_str())
    }

    /// The monitor of an instance of a property starts afresh. Returns whether it could.
    pub fn reset(&mut self, property: usize, instance: &[Value]) -> bool {
        self.witness.forget(property);
        self.state.reset_instance(&self.fitted.program, property, instance)
    }

    /// Takes in what comes next.
    #[inline]
    pub fn take(&mut self, sample: Sample<'_>) {
        self.witness.arrives(&sample);
        if self.recorder.is_none() && self.strip.is_none() {
            return self.state.feed(&self.fitted.program, sample, &mut self.witness);
        }
        let Run { witness, recorder, strip, state, fitted, .. } = self;
        state.feed(
            &fitted.program,
            sample,
            &mut Lookers { witness, recorder: recorder.as_mut(), strip: strip.as_mut() },
        );
        recorder.iter_mut().for_each(|recorder| recorder.take(sample));
    }

    /// Something came that it does not read, and nothing happens by then: nobody need be told but that time goes on. Returns whether it is so; else
    /// nothing has happened.
    #[inline]
    pub fn passes_quietly(&mut self, time: Time) -> bool {
        let is_quiet = self.recorder.is_none() && self.strip.is_none() && self.state.passes_quietly(time);
        if is_quiet {
            self.witness.passes(time);
        }
        is_quiet
    }

    /// From now on it is noted what the signals do, for whoever looks on.
    pub fn draw(&mut self) {
        self.strip = Some(Strip::new(&self.spec, &self.fitted.meaning));
    }

    /// What the signals did lately, where somebody looks on.
    pub fn strip(&mut self) -> Option<&mut Strip> {
        self.strip.as_mut()
    }

    /// How things stand of a property now, by its name.
    pub fn standing(&self, name: &str) -> Standing {
        let number = self.fitted.blanks.iter().position(|blank| blank.name == name);
        number.map_or_else(Standing::default, |number| self.state.standing(&self.fitted.program, number))
    }

    /// What a property shows, as it is now.
    pub fn present(&self, name: &str) -> Vec<Reading> {
        let number = self.fitted.blanks.iter().position(|blank| blank.name == name);
        number.map_or_else(Vec::new, |number| self.witness.readings(number, &[], self.state.inputs()))
    }

    /// The worst margins of properties so far, where margins are computed. It takes a copy of the state: not for every step.
    pub fn margins(&self) -> Vec<(String, f64)> {
        let outcomes = self.state.clone().finish(&self.fitted.program, &Ending::default(), &mut ());
        let named = outcomes.iter().filter_map(|o| Some((self.fitted.blanks.get(o.property)?.name.clone(), o.margin?)));
        named.collect()
    }

    /// Whether there is anything that has not been told.
    #[inline]
    pub fn has_news(&self) -> bool {
        self.told < self.witness.found().len() || self.jumps_told < self.witness.jumps().len()
    }

    /// The next violation that has not been told, with the property that it is of.
    pub fn news(&mut self) -> Option<Untold> {
        let found = self.witness.found().get(self.told)?;
        self.told += 1;
        let blank = self.fitted.blanks.get(found.property)?;
        let name = instance::name(&blank.name, &found.instance);
        Some(Untold {
            number: found.property,
            instance: found.instance.clone(),
            property: Property { name, verdict: Verdict::Violated, ..blank.clone() },
            violation: found.violation.clone(),
            is_further: found.is_further,
        })
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
        self.fitted.meaning.topics.iter().enumerate().map(topic).collect()
    }

    /// A diagnostic of this specification as text.
    pub fn render(&self, diagnostic: &Diagnostic, style: lapwing_diag::Style) -> String {
        lapwing_diag::render(&self.spec.findings().sources, diagnostic, style)
    }

    /// What the recording revealed of the specification, as warnings with their places.
    pub fn revelations(&self) -> Vec<Warning> {
        let worth = self.fitted.diagnostics.iter().filter(|d| d.severity != Severity::Note);
        worth
            .map(|d| {
                let (line, column) = self.spec.findings().sources.position(d.primary.span);
                let file = self.spec.findings().sources.name(d.primary.span.file).to_owned();
                let place = Some((file, line, column));
                Warning { place, is_shown: true, ..Warning::with_code(d.code, d.message.clone()) }
            })
            .collect()
    }

    /// The recording is over; it had what was `met`, and that damage. What became of each property, with its number; of one with instances, each of
    /// them.
    pub fn finish(&mut self, damage: &Damage, met: &Met) -> Vec<(usize, Property)> {
        let ending = damage.ending(&self.fitted.meaning.topics);
        let Run { witness, recorder, strip, state, fitted, .. } = self;
        let mut lookers = Lookers { witness, recorder: recorder.as_mut(), strip: strip.as_mut() };
        let outcomes = state.finish(&fitted.program, &ending, &mut lookers);
        recorder.iter_mut().for_each(Recorder::end);
        let mut notes = Notes::new(self.witness.found());
        let mut properties = Vec::new();
        for outcome in &outcomes {
            let Some(blank) = self.fitted.blanks.get(outcome.property) else { continue };
            let mut property = account::property(blank.clone(), outcome, &mut notes);
            account::doubt(&mut property, damage);
            self.guess(outcome.property, &mut property, met);
            if property.verdict == Verdict::Unmet {
                property.at_end = self.witness.readings(outcome.property, &outcome.instance, self.state.inputs());
            }
            if self.witness.is_latched(outcome.property) && property.verdict == Verdict::Violated {
                property.hints.extend(self.fitted.latches[outcome.property].as_ref().map(Latch::hint));
            }
            if property.verdict == Verdict::Violated {
                let silences = self.witness.silences(outcome.property).iter().filter_map(|(topic, silent)| {
                    let (messages, _) = self.state.messages(*topic);
                    hints::silence(
                        &self.fitted.meaning.topics.get(*topic)?.name,
                        messages,
                        *silent,
                        self.witness.span(),
                    )
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
            properties.push((outcome.property, property));
        }
        properties
    }

    /// Adds to the cause of a property that waited in vain what may have been meant.
    fn guess(&self, number: usize, property: &mut Property, met: &Met) {
        let (Some(checked), Some(cause)) = (self.fitted.meaning.properties.get(number), &mut property.cause) else {
            return;
        };
        if let Some(guess) = meant::instead(&self.fitted.meaning, checked, cause, self.state.inputs(), met) {
            *cause += &format!("; {guess}");
        }
    }

    /// How it went, where that was asked for.
    pub fn into_history(self) -> Option<History> {
        self.recorder.map(Recorder::finish)
    }

    /// What only the whole run shows.
    pub fn warnings(&self, properties: &[Property], met: &Met) -> Vec<Warning> {
        let unseen = self.topics().into_iter().filter(|t| t.unseen as f64 > UNSEEN * t.messages as f64).map(|t| {
            let share = 100.0 * t.unseen as f64 / t.messages.max(1) as f64;
            let what = format!("{share:.0} % of the messages of {} ({} of {})", t.name, t.unseen, t.messages);
            let how = format!(
                "came between two instants of {} and went unseen: raise its `__rate__`, or use `clock events`",
                self.spec.name()
            );
            Warning::with_code(Code::SamplingUnseen, format!("{what} {how}"))
        });
        let latched =
            (0..self.fitted.meaning.properties.len()).filter(|p| self.witness.is_latched(*p)).filter_map(|p| {
                let Property { name, file, line, column, .. } = self.fitted.blanks.get(p)?;
                let failed = properties.iter().any(|p| p.name == *name && p.verdict == Verdict::Violated);
                let message = format!("{name} failed although the X of its `after X` had become false again before");
                let place = Some((file.clone(), *line, *column));
                failed.then(|| Warning { place, ..Warning::with_code(Code::LatchedAfter, message) })
            });
        let unmeasured = self.unmeasured.iter().map(|name| {
            let limit = self.fitted.program.margin_limit;
            let why = format!("more than {limit} values would have to be kept until the end");
            Warning::plain(format!("{name} has no margin: {why}"))
        });
        let strangers = meant::events(&self.fitted.meaning, met);
        unseen.chain(latched).chain(unmeasured).chain(strangers).collect()
    }
}

/// All who look at the engine.
struct Lookers<'l> {
    witness: &'l mut Witness,
    recorder: Option<&'l mut Recorder>,
    strip: Option<&'l mut Strip>,
}

impl Observer for Lookers<'_> {
    fn wants_margins(&self) -> bool {
        self.recorder.as_ref().is_some_and(|recorder| recorder.wants_margins())
    }

    fn margin(&mut self, property: usize, instance: &[Option<Value>], at: Time, margin: f64) {
        if let Some(recorder) = &mut self.recorder {
            recorder.margin(property, instance, at, margin);
        }
    }

    fn output(&mut self, inputs: &Inputs, output: Output<'_>) {
        if let Some(recorder) = &mut self.recorder {
            recorder.output(inputs, output.clone());
        }
        if let Some(strip) = &mut self.strip {
            strip.output(inputs, output.clone());
        }
        self.witness.output(inputs, output);
    }
}
