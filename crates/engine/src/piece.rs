//! A stretch of trace in which time never goes back: the clock, deadlines in their order, instants.

use alloc::vec::Vec;

use lapwing_stream::{Sample, Time, Value, What};
use serde::{Deserialize, Serialize};

use crate::feed::Ending;
use crate::group::{Core, When};
use crate::inputs::Inputs;
use crate::instances::{Instances, only};
use crate::machine::MachineMemory;
use crate::outcome::{Observer, Outcome, Output};
use crate::past::NOW;
use crate::program::{Clock, Judge, Program, Read};
use crate::skim::Row;
use crate::world::ObjectMemory;

/// At most so many instants of a rate between two samples; a longer silence starts everything anew, as a jump back does.
const TICKS: i128 = 10_000_000;

/// A stretch of trace in which time never goes back.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Piece {
    pub(crate) inputs: Inputs,
    pub(crate) machines: Vec<MachineMemory>,
    pub(crate) groups: Vec<Instances>,
    pub(crate) objects: Vec<ObjectMemory>,
    /// The first sample that was read.
    pub(crate) t0: Option<i64>,
    /// The last sample of any kind, [`i64::MIN`] before the first, and the last that the timeout let through, where it let others not.
    pub(crate) newest: i64,
    cut: Option<i64>,
    /// The last instant that all share, [`i64::MIN`] before the first.
    pub(crate) last_instant: i64,
    /// The next instant of a rate.
    pub(crate) tick: u64,
    pub(crate) instants: u64,
    /// Before this time nothing happens by itself, and nothing times out; [`i64::MAX`] if nothing ever does.
    quiet_until: i64,
    /// Whether anything ever does.
    is_timed: bool,
    /// Before this time all groups rest, as long as nothing wakes one; and for each group before when it does.
    pub(crate) calm_until: i64,
    calm: Vec<i64>,
    /// Whether events make instances of a group.
    pub(crate) is_sliced: bool,
    /// Per property: which of its silences was too long, from when to when.
    pub(crate) stale: Vec<Option<(usize, i64, i64)>>,
    /// Whether a property minds the silence of a signal that comes in rows, and when each slot last got a value; for each topic whether one minds
    /// its silence.
    pub(crate) minds_slots: bool,
    pub(crate) minds_topics: Vec<bool>,
    pub(crate) heard: Vec<Option<i64>>,
    /// Per topic: messages in all, and those that no instant saw.
    pub(crate) messages: Vec<(u64, u64)>,
}

impl Piece {
    pub(crate) fn new(program: &Program) -> Piece {
        let counters = program.properties.iter().flat_map(|p| &p.counters).max().map_or(0, |&c| c as usize + 1);
        let inputs = Inputs::new(program);
        Piece {
            machines: program.machines.iter().map(|m| MachineMemory::new(m, &inputs, counters)).collect(),
            groups: program.groups.iter().map(|g| Instances::new(g, &inputs, counters)).collect(),
            inputs,
            objects: alloc::vec![ObjectMemory::default(); program.objects.len()],
            t0: None,
            newest: i64::MIN,
            cut: None,
            last_instant: i64::MIN,
            tick: 0,
            instants: 0,
            quiet_until: if is_timed(program) { i64::MIN } else { i64::MAX },
            calm_until: NOW,
            calm: alloc::vec![NOW; program.groups.len()],
            is_sliced: program.groups.iter().any(|group| !group.at.slices.is_empty()),
            is_timed: is_timed(program),
            stale: alloc::vec![None; program.properties.len()],
            minds_slots: program.properties.iter().flat_map(|p| &p.stale).any(|s| matches!(s.of, Read::Slot(_))),
            minds_topics: (0..program.topics.len()).map(|topic| minds(program, Read::Topic(topic))).collect(),
            heard: alloc::vec![None; program.slots.len()],
            messages: alloc::vec![(0, 0); program.topics.len()],
        }
    }

    /// Computes margins as well.
    pub(crate) fn measure(&mut self, program: &Program) {
        for (instances, plan) in self.groups.iter_mut().zip(&program.groups) {
            instances.for_each(|core, _| core.measure(plan, &self.inputs, program.margin_limit));
        }
    }

    /// The last sample that the timeout let through.
    pub(crate) fn last(&self) -> Option<i64> {
        // The first may come at the very beginning of time.
        self.cut.or((self.newest != i64::MIN || self.t0.is_some()).then_some(self.newest))
    }

    /// A sample comes that the timeout does not let through.
    pub(crate) fn time_out(&mut self, now: i64) {
        self.cut = self.last();
        self.newest = now;
    }

    #[inline]
    pub(crate) fn is_timed_out(&self, program: &Program, now: i64) -> bool {
        match (program.timeout, self.t0) {
            (Some(timeout), Some(t0)) => now > t0.saturating_add(timeout.nanos()),
            _ => false,
        }
    }

    /// Whether more instants of a rate lie before this time than anyone could want.
    #[inline]
    pub(crate) fn is_absurd(&self, program: &Program, now: i64) -> bool {
        let Clock::Rate(rate) = program.clock else { return false };
        match (self.last(), self.t0) {
            (Some(last), Some(_)) => (i128::from(now) - i128::from(last)) * i128::from(rate) > TICKS * 1_000_000_000,
            _ => false,
        }
    }

    /// The time of the next instant of a rate; there is none beyond the end of time.
    fn next_tick(&self, program: &Program) -> Option<i64> {
        match (program.clock, self.t0) {
            (Clock::Rate(rate), Some(t0)) => {
                let since = i128::from(self.tick) * 1_000_000_000 / i128::from(rate.max(1));
                i64::try_from(i128::from(t0) + since).ok()
            }
            _ => None,
        }
    }

    /// Whether time goes on to `now`, and nothing happens on the way.
    #[inline]
    pub(crate) fn is_quiet_until(&self, now: i64) -> bool {
        self.newest <= now && now < self.quiet_until
    }

    /// Takes a sample in; its time has come.
    #[inline(never)]
    pub(crate) fn take(&mut self, program: &Program, sample: Sample<'_>, tell: &mut impl Observer) {
        let now = sample.time.0;
        self.newest = now;
        let mut waits = false;
        if !matches!(sample.what, What::Other) {
            // A rate and a timeout count from the first one.
            waits = self.t0.is_none() || program.clock != Clock::Events;
            self.t0.get_or_insert(now);
            self.take_in(program, sample);
            if program.clock == Clock::Events {
                waits |= self.instant(program, now, tell);
            }
        }
        if self.is_timed && (waits || now >= self.quiet_until) {
            self.quiet_until = self.look_ahead(program);
        }
    }

    /// Finds out until when nothing happens by itself, and nothing times out.
    fn look_ahead(&mut self, program: &Program) -> i64 {
        let times_out = match (program.timeout, self.t0) {
            (Some(timeout), Some(t0)) => t0.saturating_add(timeout.nanos()).saturating_add(1),
            _ => i64::MAX,
        };
        self.next_by_itself(program).min(times_out)
    }

    /// The next time at which something happens by itself.
    pub(crate) fn next_by_itself(&mut self, program: &Program) -> i64 {
        let tick = self.next_tick(program);
        [self.next_flip(program), self.next_bound(program), tick].into_iter().flatten().min().unwrap_or(i64::MAX)
    }

    /// Everything that happens before what has the stamp `now` comes in.
    pub(crate) fn pass_time(&mut self, program: &Program, now: i64, tell: &mut impl Observer) {
        match program.clock {
            Clock::Rate(_) => {
                while let Some(tick) = self.next_tick(program).filter(|&tick| tick < now) {
                    self.tick(program, tick, tell);
                }
            }
            Clock::Events => {
                while let Some(flip) = self.next_flip(program).filter(|&flip| flip < now) {
                    self.flip(program, flip, tell);
                }
            }
        }
        self.advance(program, now, tell);
    }

    fn tick(&mut self, program: &Program, at: i64, tell: &mut impl Observer) {
        self.advance(program, at, tell);
        self.instant(program, at, tell);
        self.tick += 1;
    }

    /// Bounds that end before `now` are over.
    fn advance(&mut self, program: &Program, now: i64, tell: &mut impl Observer) {
        for (i, (memory, plan)) in self.machines.iter_mut().zip(&program.machines).enumerate() {
            memory.advance(plan, i, &self.inputs, now, tell);
        }
        for (instances, plan) in self.groups.iter_mut().zip(&program.groups) {
            instances.for_each_due(now, |core| core.advance(plan, &self.inputs, now, tell));
        }
    }

    fn next_bound(&self, program: &Program) -> Option<i64> {
        let machines = self.machines.iter().zip(&program.machines).enumerate();
        let machines = machines.filter_map(|(i, (memory, plan))| memory.deadline(plan, i, &self.inputs));
        machines.chain(self.groups.iter().filter_map(Instances::deadline)).min()
    }

    fn next_flip(&mut self, program: &Program) -> Option<i64> {
        let inputs = &self.inputs;
        let machines = self.machines.iter_mut().zip(&program.machines);
        let machines = machines.filter_map(|(memory, plan)| memory.walk.next_flip(&plan.at, inputs));
        let groups = self.groups.iter_mut().zip(&program.groups).filter(|(_, plan)| !plan.at.ages.is_empty());
        let groups = groups.filter_map(|(g, plan)| g.first(|core| core.walk.next_flip(&plan.at, inputs)));
        machines.chain(groups).min()
    }

    /// An instant of its own for those whose comparison of an age changes now, unless one has this stamp.
    fn flip(&mut self, program: &Program, at: i64, tell: &mut impl Observer) {
        let is_new = self.last_instant != at;
        self.inputs.end_instant();
        for (i, (memory, plan)) in self.machines.iter_mut().zip(&program.machines).enumerate() {
            if memory.walk.next_flip(&plan.at, &self.inputs) == Some(at) {
                memory.walk.pass_flips(&plan.at, at);
                if is_new {
                    memory.advance(plan, i, &self.inputs, at, tell);
                    memory.step(plan, i, &mut self.inputs, at, tell);
                }
            }
        }
        for (number, (instances, plan)) in self.groups.iter_mut().zip(&program.groups).enumerate() {
            instances.for_each(|core, automaton| {
                if core.walk.next_flip(&plan.at, &self.inputs) == Some(at) {
                    core.walk.pass_flips(&plan.at, at);
                    if is_new {
                        core.catch_up(plan, self.instants, self.last_instant);
                        core.advance(plan, &self.inputs, at, tell);
                        let (due, limit) = (self.inputs.due[number].ops, program.open_limit);
                        core.step_any((plan, automaton), &self.inputs, due, at, limit, tell);
                    }
                }
            });
        }
        self.disturb();
        self.inputs.end_instant();
    }

    /// Nobody knows any more until when groups rest.
    fn disturb(&mut self) {
        self.calm_until = NOW;
        self.calm.fill(NOW);
    }

    /// An instant that all share. Returns whether what happens next by itself may be something else now.
    #[inline]
    fn instant(&mut self, program: &Program, now: i64, tell: &mut impl Observer) -> bool {
        let mut waits = false;
        // PERF: most instants of most recordings change nothing that matters; where all rest they cost no more than this.
        if self.inputs.woken || now >= self.calm_until {
            waits = self.step_alone(program, now, tell).unwrap_or_else(|| self.step(program, now, tell));
        }
        self.instants += 1;
        self.last_instant = now;
        tell.output(&self.inputs, Output::Instant(Time(now)));
        self.inputs.end_instant();
        waits
    }

    /// An instant of the only group of a program without machines, where it rests: whether it waits for anything. Else nothing has happened.
    #[inline(always)]
    fn step_alone(&mut self, program: &Program, now: i64, tell: &mut impl Observer) -> Option<bool> {
        let (plan, automaton, core) = only(&program.groups, &mut self.groups)?;
        if !core.rests() || !self.machines.is_empty() {
            return None;
        }
        let due = self.inputs.settle();
        let when = When { now, number: self.instants, before: self.last_instant };
        self.calm_until = core.step_at_rest((plan, automaton), &self.inputs, due, when, tell);
        Some(plan.waits())
    }

    /// The machines and the groups take an instant in, but for those that rest. Returns whether one of those that did waits for anything.
    #[inline(never)]
    fn step(&mut self, program: &Program, now: i64, tell: &mut impl Observer) -> bool {
        let mut calm_until = i64::MAX;
        let mut waits = !self.machines.is_empty();
        if waits {
            self.step_machines(program, now, tell);
            calm_until = NOW;
        }
        self.inputs.woken = false;
        let when = When { now, number: self.instants, before: self.last_instant };
        // Aside, while groups look at the inputs.
        let mut dues = core::mem::take(&mut self.inputs.due);
        let groups = self.groups.iter_mut().zip(&program.groups).zip(&mut self.calm).zip(&mut dues);
        for (((instances, plan), calm), due) in groups {
            if due.ops != 0 || now >= *calm {
                let due = core::mem::take(due);
                // Of the instances only those were asked that this instant concerns.
                let is_sliced = !plan.at.slices.is_empty();
                *calm = if is_sliced { NOW } else { i64::MAX };
                instances.for_each_concerned(plan, &self.inputs, (due, when), |core, automaton| {
                    if is_sliced || due.ops != 0 || now >= core.rests_until() {
                        core.step((plan, automaton), &self.inputs, due, when, program.open_limit, tell);
                    }
                    *calm = (*calm).min(core.rests_until());
                });
                waits |= plan.waits();
            }
            calm_until = calm_until.min(*calm);
        }
        self.inputs.due = dues;
        self.calm_until = calm_until;
        waits
    }

    #[inline(never)]
    fn step_machines(&mut self, program: &Program, now: i64, tell: &mut impl Observer) {
        for (i, (memory, plan)) in self.machines.iter_mut().zip(&program.machines).enumerate() {
            memory.step(plan, i, &mut self.inputs, now, tell);
        }
    }

    /// The monitor of a property starts afresh: of one instance, where one is given. Returns whether it could.
    pub(crate) fn reset(&mut self, program: &Program, property: usize, instance: Option<&[Value]>) -> bool {
        let judge = program.properties.get(property).map(|p| p.judge);
        match judge {
            Some(Judge::Group(group)) => {
                let (plan, instants, last) = (&program.groups[group], self.instants, self.last_instant);
                let is_alone = plan.trackers.iter().all(|t| t.property == property);
                if is_alone {
                    let start_afresh = |core: &mut Core| core.start_afresh(plan, &self.inputs, instants, last);
                    self.groups[group].for_each_of(instance, start_afresh);
                    self.disturb();
                    self.inputs.row = Row::NONE;
                }
                is_alone
            }
            Some(Judge::Machine(machine)) => {
                self.machines[machine].start_afresh(&program.machines[machine], machine, &mut self.inputs);
                true
            }
            _ => false,
        }
    }

    /// The outcome of every property.
    pub(crate) fn finish(&mut self, program: &Program, ending: &Ending, tell: &mut impl Observer) -> Vec<Outcome> {
        let last = self.last().unwrap_or_default();
        while let Some(tick) = self.next_tick(program).filter(|&tick| tick <= last) {
            self.tick(program, tick, tell);
        }
        for topic in 0..program.topics.len() {
            self.note_silence(program, Read::Topic(topic), last);
            self.messages[topic].1 += u64::from(self.inputs.topics[topic].fresh);
        }
        if self.minds_slots {
            (0..program.slots.len()).for_each(|slot| self.note_silence(program, Read::Slot(slot), last));
        }
        for (instances, plan) in self.groups.iter_mut().zip(&program.groups) {
            instances.for_each(|core, _| {
                core.catch_up(plan, self.instants, self.last_instant);
                core.end(plan, &self.inputs, last);
                if tell.wants_margins() {
                    core.tell_late_margins(plan, last, tell);
                }
            });
        }
        (0..program.properties.len()).flat_map(|p| self.judge(program, p, ending)).collect()
    }
}

/// Whether a property minds a silence.
fn minds(program: &Program, of: Read) -> bool {
    program.properties.iter().flat_map(|property| &property.stale).any(|silence| silence.of == of)
}

/// Whether anything in a program happens by the mere passing of time.
fn is_timed(program: &Program) -> bool {
    let ages = program
        .groups
        .iter()
        .map(|g| &g.at)
        .chain(program.machines.iter().map(|m| &m.at))
        .any(|at| !at.ages.is_empty());
    let stays = program.machines.iter().flat_map(|m| &m.states).any(|s| s.at_most.is_some());
    let waits = program.groups.iter().any(|g| !g.futures.is_empty());
    program.clock != Clock::Events || program.timeout.is_some() || ages || stays || waits
}
