//! The verdicts: what is said of each property when a piece of trace is over.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use lapwing_stream::{Time, Verdict};

use crate::feed::Ending;
use crate::group::Core;
use crate::instances::INSTANCES;
use crate::margin::Measured;
use crate::node::Notes;
use crate::outcome::{Episode, Outcome};
use crate::piece::Piece;
use crate::program::{Awaited, Group, Judge, Positions, Program, Property, Read};
use crate::standing::GivenUp;
use crate::tracker::can_add;
use crate::walk::Walk;

impl Piece {
    /// What is said of a property: one outcome, or one per instance.
    pub(crate) fn judge(&self, program: &Program, number: usize, ending: &Ending) -> Vec<Outcome> {
        let property = &program.properties[number];
        let blank =
            |cause: String| alloc::vec![Outcome { cause: Some(cause), ..Outcome::blank(number, property.scopes) }];
        if let Some(problem) = &property.problem {
            return blank(problem.clone());
        }
        match property.judge {
            Judge::Nobody => blank("nothing judges it".to_string()),
            _ if self.last().is_none() => blank("the trace has no message".to_string()),
            Judge::Machine(m) => alloc::vec![self.machine_outcome(program, number, m, ending)],
            Judge::Group(g) => {
                let mut outcomes = Vec::new();
                self.groups[g].look_at_each(|key, core| {
                    let instance = key.iter().flatten().cloned().collect();
                    let outcome = self.core_outcome(program, number, &program.groups[g], core, ending);
                    outcomes.push(Outcome { instance, ..outcome });
                });
                outcomes
            }
        }
    }

    fn machine_outcome(&self, program: &Program, number: usize, machine: usize, ending: &Ending) -> Outcome {
        let memory = &self.machines[machine];
        let mut outcome = Outcome {
            met: memory.met,
            failed: memory.failed,
            episodes: sorted(memory.episodes.clone()),
            positions: memory.positions,
            nans: self.nans(program, number, &memory.walk.notes),
            ..Outcome::blank(number, 0)
        };
        let at = &program.machines[machine].at;
        let walk = (&memory.walk, !memory.walk.faults.is_empty());
        outcome.cause = self.cause(program, number, at, walk, ending);
        let limit = memory.deadline(&program.machines[machine], machine, &self.inputs);
        outcome.open = u64::from(limit.is_some());
        let missed = limit.is_some_and(|limit| Some(limit) <= self.last());
        outcome.unmet_since = missed.then(|| memory.since());
        outcome.settle(missed, false, ending);
        outcome
    }

    fn core_outcome(&self, program: &Program, number: usize, plan: &Group, core: &Core, ending: &Ending) -> Outcome {
        let scopes = program.properties[number].scopes;
        let of_property = || plan.trackers.iter().zip(&core.trackers).filter(|(t, _)| t.property == number);
        let mut outcome = Outcome {
            entered: core.entered(plan, number, scopes),
            positions: core.positions,
            nans: self.nans(program, number, &core.walk.notes),
            ..Outcome::blank(number, scopes)
        };
        let last = self.last().unwrap_or_default();
        let mut more_to_come = false;
        for (tracker, state) in of_property() {
            outcome.met += state.met;
            outcome.failed += state.failed;
            outcome.open += state.open.positions();
            outcome.episodes.extend_from_slice(&state.done);
            outcome.unmet_since = match (outcome.unmet_since, state.unmet_since.map(Time)) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            };
            more_to_come |= can_add(tracker, &plan.contexts, &core.graph.segments, last);
        }
        outcome.episodes = sorted(outcome.episodes);
        let missed = outcome.unmet_since.is_some()
            || (core.positions == 0 && of_property().any(|(tracker, _)| tracker.missed_if_empty));
        let is_given_up = |why| of_property().any(|(_, state)| state.given_up() == Some(why));
        let is_spoilt = is_given_up(GivenUp::Spoilt);
        outcome.cause = self.cause(program, number, &plan.at, (&core.walk, is_spoilt), ending);
        if is_given_up(GivenUp::Overflowed) && outcome.cause.is_none() {
            outcome.cause = Some(format!("more than {} runs of obligations were open at once", program.open_limit));
        }
        if self.groups.iter().any(|g| g.too_many) && !plan.at.slices.is_empty() && outcome.cause.is_none() {
            outcome.cause = Some(format!("more than {INSTANCES} values were seen"));
        }
        outcome.settle(missed, !more_to_come, ending);
        if let Some(margins) = core.margins.as_ref().filter(|_| !is_spoilt) {
            outcome.set_margin(margins.of(&plan.margins, number, last));
        }
        outcome
    }

    /// Why a property that did not fail cannot be judged.
    fn cause(
        &self,
        program: &Program,
        number: usize,
        at: &Positions,
        (walk, is_spoilt): (&Walk, bool),
        ending: &Ending,
    ) -> Option<String> {
        let property = &program.properties[number];
        if let Some((_, why)) = ending.lost.iter().find(|(topic, _)| property.topics.contains(topic)) {
            return Some(why.clone());
        }
        if at.alphabet.is_none() && !walk.started {
            let mut names: Vec<&str> = Vec::new();
            for name in walk.missing(at).filter_map(|i| self.missed(property.waits_for.get(i)?, at.reads.get(i)?.0)) {
                if !names.contains(&name) {
                    names.push(name);
                }
            }
            return Some(match names.is_empty() {
                true => "it never had a position".to_string(),
                false => format!("no value ever came: {}", names.join(", ")),
            });
        }
        if let Some((silence, from, to)) = self.stale[number] {
            let name = property.stale.get(silence).map_or("a topic", |s| &*s.name);
            return Some(format!("{name} was silent from {} to {}", Time(from), Time(to)));
        }
        if is_spoilt {
            return Some(of_another_kind(property, at, walk));
        }
        property.rests_on.iter().find_map(|&machine| self.cause_of_machine(program, machine, ending))
    }

    /// Why a machine cannot be judged, and with it what only its events make positions for.
    fn cause_of_machine(&self, program: &Program, machine: usize, ending: &Ending) -> Option<String> {
        let plan = &program.machines[machine];
        let name = &program.properties.get(plan.property)?.name;
        let walk = &self.machines[machine].walk;
        let cause = self.cause(program, plan.property, &plan.at, (walk, !walk.faults.is_empty()), ending)?;
        Some(format!("the state diagram `{name}`: {cause}"))
    }

    /// What to call what did not come.
    fn missed<'p>(&self, awaited: &'p Awaited, read: Read) -> Option<&'p str> {
        Some(match &awaited.in_messages {
            Some((topic, part)) if self.inputs.last(*topic).is_some() && !self.inputs.defined(read) => part,
            _ => &awaited.name,
        })
    }

    fn nans(&self, program: &Program, number: usize, notes: &Notes) -> u64 {
        let counters = &program.properties[number].counters;
        counters.iter().filter_map(|&c| notes.nans.get(c as usize)).map(|n| n.get()).sum()
    }
}

/// The cause of a property whose formula met a value that it can do nothing with.
fn of_another_kind(property: &Property, at: &Positions, walk: &Walk) -> String {
    let (time, signal) = walk.culprit.unwrap_or_default();
    let read = signal.and_then(|signal| at.reads.iter().position(|(read, _)| *read == Read::Slot(signal)));
    let name = read.and_then(|read| property.waits_for.get(read)).map(|awaited| &*awaited.name);
    let what = name.map_or_else(|| "a value".to_string(), |name| format!("the value of {name}"));
    format!("{what} at {} was of another kind than the formula needs", Time(time))
}

impl Outcome {
    /// Nothing is known yet.
    pub(crate) fn blank(property: usize, scopes: usize) -> Outcome {
        Outcome {
            property,
            instance: Vec::new(),
            verdict: Verdict::Inconclusive,
            cause: None,
            vacuous: false,
            entered: alloc::vec![0; scopes],
            met: 0,
            failed: 0,
            open: 0,
            episodes: Vec::new(),
            unmet_since: None,
            nans: 0,
            positions: 0,
            margin: None,
            margin_gave_up: false,
        }
    }

    fn set_margin(&mut self, measured: Measured) {
        (self.margin, self.margin_gave_up) = (measured.margin, measured.gave_up);
    }

    /// The verdict, from the counts and the cause: whether something was missed, and whether no obligation can be added any more.
    fn settle(&mut self, missed: bool, is_complete: bool, ending: &Ending) {
        if missed && self.cause.is_none() {
            self.cause.clone_from(&ending.broke_off);
        }
        self.verdict = match () {
            () if self.failed > 0 => Verdict::Violated,
            () if self.cause.is_some() => Verdict::Inconclusive,
            () if missed => Verdict::Unmet,
            () if self.open == 0 && is_complete => Verdict::Satisfied,
            () => Verdict::Holds,
        };
        self.vacuous = self.verdict.is_success() && self.entered.contains(&0);
        if self.verdict != Verdict::Inconclusive {
            // A violation stands, whatever else was not seen.
            self.cause = None;
        }
    }
}

/// By the time of the first failure, then of beginning, then in the order of the text.
fn sorted(mut episodes: Vec<Episode>) -> Vec<Episode> {
    episodes.sort_by_key(|e| (e.failed, e.began));
    episodes
}
