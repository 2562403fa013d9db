//! The state of a run, and how a sample moves it: jumps, the clock, deadlines in their order, instants.

use alloc::string::{String, ToString};
use alloc::vec::Vec;

use lapwing_stream::{Sample, Time, Value, What};

use crate::group::Core;
use crate::inputs::Inputs;
use crate::machine::MachineMemory;
use crate::node::{Notes, View};
use crate::outcome::{Observer, Outcome, Output, join};
use crate::program::{Clock, Group, Positions, Program, Read, Silence};
use crate::world::ObjectMemory;

/// At most so many instances of a property under `for each` over values.
pub(crate) const INSTANCES: usize = 65_536;

/// At most so many instants of a rate between two samples; a longer silence starts everything anew, as a jump back does.
const TICKS: i128 = 10_000_000;

/// Everything that a run of a [`Program`] knows. A clone is a snapshot: it goes on as the original would have.
#[derive(Clone, Debug)]
pub struct State {
    piece: Piece,
    /// What the pieces before the latest jump came to.
    before: Option<Vec<Outcome>>,
    jumps: Vec<(Time, Time)>,
    /// The instants and, per topic, the messages of the pieces before the latest jump.
    counted: (u64, Vec<(u64, u64)>),
    /// Whether margins are computed.
    measures: bool,
}

/// A stretch of trace in which time never goes back.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) inputs: Inputs,
    pub(crate) machines: Vec<MachineMemory>,
    pub(crate) groups: Vec<Instances>,
    pub(crate) objects: Vec<ObjectMemory>,
    /// The first sample that was read.
    pub(crate) t0: Option<i64>,
    /// The last sample of any kind, and the last that the timeout let through.
    pub(crate) newest: Option<i64>,
    pub(crate) last: Option<i64>,
    /// The last instant that all share.
    pub(crate) last_instant: Option<i64>,
    /// The next instant of a rate.
    pub(crate) tick: u64,
    pub(crate) instants: u64,
    /// Before this time nothing happens by itself.
    pub(crate) quiet_until: i64,
    /// Whether anything ever happens by itself.
    pub(crate) is_timed: bool,
    /// Per property: which of its silences was too long, from when to when.
    pub(crate) stale: Vec<Option<(usize, i64, i64)>>,
    /// Whether a property minds the silence of a signal that comes in rows, and when each slot last got a value.
    pub(crate) minds_slots: bool,
    pub(crate) heard: Vec<Option<i64>>,
    /// Per topic: messages in all, and those that no instant saw.
    pub(crate) messages: Vec<(u64, u64)>,
}

/// The instances of a group: one, or with slices one per value seen, beside the template of those to come.
#[derive(Clone, Debug)]
pub(crate) struct Instances {
    pub(crate) cores: Vec<Core>,
    /// Those that count as instances, in the order in which their values were seen.
    pub(crate) seen: Vec<usize>,
    pub(crate) too_many: bool,
}

/// How a trace ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ending {
    /// It broke off: what would be unmet is inconclusive, for this reason.
    pub broke_off: Option<String>,
    /// Topics of which something was lost, and why: what reads one of them and did not fail is inconclusive.
    pub lost: Vec<(usize, String)>,
}

impl State {
    /// Nothing has come yet.
    pub fn new(program: &Program) -> State {
        State {
            piece: Piece::new(program),
            before: None,
            jumps: Vec::new(),
            counted: (0, alloc::vec![(0, 0); program.topics.len()]),
            measures: false,
        }
    }

    /// Nothing has come yet, and [`Outcome::margin`] is wanted. It costs time at every position, and memory where a property has
    /// future operators.
    pub fn with_margins(program: &Program) -> State {
        let mut state = State { measures: true, ..State::new(program) };
        state.piece.measure(program);
        state
    }

    /// Takes a sample in.
    pub fn feed(&mut self, program: &Program, sample: Sample<'_>, observer: &mut impl Observer) {
        let now = sample.time.0;
        if self.piece.newest.is_some_and(|newest| now < newest) || self.piece.is_absurd(program, now) {
            self.jump(program, sample.time, observer);
        }
        self.piece.newest = Some(now);
        if self.piece.is_timed_out(program, now) {
            return;
        }
        if now >= self.piece.quiet_until {
            self.piece.pass_time(program, now, observer);
        }
        self.piece.last = Some(now);
        if !matches!(sample.what, What::Other) {
            self.piece.t0.get_or_insert(now);
            self.piece.take_in(program, sample);
            if program.clock == Clock::Events {
                self.piece.instant(program, now, observer);
            }
        }
        self.piece.look_ahead(program);
    }

    /// Time went back: what has been ends here, and everything starts anew.
    fn jump(&mut self, program: &Program, to: Time, observer: &mut impl Observer) {
        let from = Time(self.piece.newest.unwrap_or_default());
        let mut outcomes = self.piece.finish(program, &Ending::default(), observer);
        outcomes.iter_mut().for_each(Outcome::cut_off_by_jump);
        self.before = Some(join(self.before.take(), outcomes));
        self.jumps.push((from, to));
        self.counted = (self.instants(), (0..program.topics.len()).map(|topic| self.messages(topic)).collect());
        self.piece = Piece::new(program);
        if self.measures {
            self.piece.measure(program);
        }
        observer.output(&self.piece.inputs, Output::Jump { from, to });
    }

    /// The trace is over: the outcome of every property, instances in the order in which they came.
    ///
    /// The state cannot be fed after; to know the outcome so far, finish a clone.
    pub fn finish(&mut self, program: &Program, ending: &Ending, observer: &mut impl Observer) -> Vec<Outcome> {
        let mut outcomes = join(self.before.take(), self.piece.finish(program, ending, observer));
        for (number, property) in program.properties.iter().enumerate() {
            if !outcomes.iter().any(|o| o.property == number) {
                let cause = Some("no value to make an instance of was seen".to_string());
                outcomes.push(Outcome { cause, ..Outcome::blank(number, property.scopes) });
            }
        }
        outcomes.sort_by_key(|o| o.property);
        outcomes
    }

    /// When something happens though nothing comes: a live caller feeds a sample without content once its clock has passed it.
    pub fn next_deadline(&mut self, program: &Program) -> Option<Time> {
        Some(self.piece.next_by_itself(program)).filter(|&at| at != i64::MAX).map(Time)
    }

    /// The latest of everything.
    pub fn inputs(&self) -> &Inputs {
        &self.piece.inputs
    }

    /// The number of instants of the specification's clock so far.
    pub fn instants(&self) -> u64 {
        self.counted.0 + self.piece.instants
    }

    /// The jumps back in time, from and to.
    pub fn jumps(&self) -> &[(Time, Time)] {
        &self.jumps
    }

    /// How many messages of a topic came, and how many of them no instant saw.
    pub fn messages(&self, topic: usize) -> (u64, u64) {
        let of = |messages: &[(u64, u64)]| messages.get(topic).copied().unwrap_or_default();
        let (before, piece) = (of(&self.counted.1), of(&self.piece.messages));
        (before.0 + piece.0, before.1 + piece.1)
    }
}

impl Piece {
    fn new(program: &Program) -> Piece {
        let counters = program.properties.iter().flat_map(|p| &p.counters).max().map_or(0, |&c| c as usize + 1);
        let inputs = Inputs::new(program);
        Piece {
            machines: program.machines.iter().map(|m| MachineMemory::new(m, &inputs, counters)).collect(),
            groups: program.groups.iter().map(|g| Instances::new(g, &inputs, counters)).collect(),
            inputs,
            objects: alloc::vec![ObjectMemory::default(); program.objects.len()],
            t0: None,
            newest: None,
            last: None,
            last_instant: None,
            tick: 0,
            instants: 0,
            quiet_until: i64::MIN,
            is_timed: is_timed(program),
            stale: alloc::vec![None; program.properties.len()],
            minds_slots: program.properties.iter().flat_map(|p| &p.stale).any(|s| matches!(s.of, Read::Slot(_))),
            heard: alloc::vec![None; program.slots.len()],
            messages: alloc::vec![(0, 0); program.topics.len()],
        }
    }

    /// Computes margins as well.
    fn measure(&mut self, program: &Program) {
        for (instances, plan) in self.groups.iter_mut().zip(&program.groups) {
            instances.cores.iter_mut().for_each(|core| core.measure(plan, &self.inputs, program.margin_limit));
        }
    }

    #[inline]
    fn is_timed_out(&self, program: &Program, now: i64) -> bool {
        match (program.timeout, self.t0) {
            (Some(timeout), Some(t0)) => now > t0.saturating_add(timeout.nanos()),
            _ => false,
        }
    }

    /// Whether more instants of a rate lie before this time than anyone could want.
    #[inline]
    fn is_absurd(&self, program: &Program, now: i64) -> bool {
        let Clock::Rate(rate) = program.clock else { return false };
        match (self.last, self.t0) {
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

    /// Finds out until when nothing happens by itself.
    #[inline]
    fn look_ahead(&mut self, program: &Program) {
        self.quiet_until = if self.is_timed { self.next_by_itself(program) } else { i64::MAX };
    }

    /// The next time at which something happens by itself.
    fn next_by_itself(&mut self, program: &Program) -> i64 {
        let tick = self.next_tick(program);
        [self.next_flip(program), self.next_bound(program), tick].into_iter().flatten().min().unwrap_or(i64::MAX)
    }

    /// Everything that happens before what has the stamp `now` comes in.
    fn pass_time(&mut self, program: &Program, now: i64, tell: &mut impl Observer) {
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
            for core in &mut instances.cores {
                core.advance(plan, &self.inputs, now, tell);
            }
        }
    }

    fn next_bound(&self, program: &Program) -> Option<i64> {
        let machines = self.machines.iter().zip(&program.machines).enumerate();
        let machines = machines.filter_map(|(i, (memory, plan))| memory.deadline(plan, i, &self.inputs));
        let cores = self.groups.iter().flat_map(|g| &g.cores).filter_map(|c| c.graph.deadline().map(|d| d.0));
        machines.chain(cores).min()
    }

    fn next_flip(&mut self, program: &Program) -> Option<i64> {
        let inputs = &self.inputs;
        let machines = self.machines.iter_mut().zip(&program.machines);
        let machines = machines.filter_map(|(memory, plan)| memory.walk.next_flip(&plan.at, inputs));
        let groups = self.groups.iter_mut().zip(&program.groups).filter(|(_, plan)| !plan.at.ages.is_empty());
        let groups = groups.filter_map(|(g, plan)| g.cores.first_mut()?.walk.next_flip(&plan.at, inputs));
        machines.chain(groups).min()
    }

    /// An instant of its own for those whose comparison of an age changes now, unless one has this stamp.
    fn flip(&mut self, program: &Program, at: i64, tell: &mut impl Observer) {
        let is_new = self.last_instant != Some(at);
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
        for (instances, plan) in self.groups.iter_mut().zip(&program.groups) {
            for core in &mut instances.cores {
                if core.walk.next_flip(&plan.at, &self.inputs) == Some(at) {
                    core.walk.pass_flips(&plan.at, at);
                    if is_new {
                        core.advance(plan, &self.inputs, at, tell);
                        core.step(plan, &self.inputs, at, program.open_limit, tell);
                    }
                }
            }
        }
        self.inputs.end_instant();
    }

    /// The sample's values become the latest.
    fn take_in(&mut self, program: &Program, sample: Sample<'_>) {
        match sample.what {
            What::Message { topic, values } => {
                self.message(program, topic, values, sample.time.0);
                self.make_instances(program);
            }
            What::Row { cells } => {
                for &(cell, slot) in &program.columns {
                    if let Some(value) = cells.get(cell) {
                        self.inputs.set(slot, value);
                        if self.minds_slots && !matches!(value, Value::Missing) {
                            self.note_silence(program, Read::Slot(slot), sample.time.0);
                            self.heard[slot] = Some(sample.time.0);
                        }
                    }
                }
            }
            What::Event { event, values } => {
                if let Some(state) = self.inputs.events.get_mut(event) {
                    state.add(values.iter());
                    self.filter_event(program, event);
                    self.make_instances(program);
                }
            }
            What::Other => {}
        }
    }

    /// Values of slices may have been seen for the first time.
    fn make_instances(&mut self, program: &Program) {
        for (instances, plan) in self.groups.iter_mut().zip(&program.groups) {
            if !plan.at.slices.is_empty() {
                instances.make(&plan.at, &self.inputs);
            }
        }
    }

    fn message(&mut self, program: &Program, topic: usize, values: &[Value], now: i64) {
        let Some(plan) = program.topics.get(topic) else { return };
        for (slots, value) in plan.fields.iter().zip(values) {
            slots.iter().for_each(|&slot| self.inputs.set(slot, value));
        }
        self.note_silence(program, Read::Topic(topic), now);
        let state = &mut self.inputs.topics[topic];
        self.messages[topic].0 += 1;
        // A message that comes before the instant after the one before it makes that one unseen.
        self.messages[topic].1 += u64::from(state.fresh);
        (state.last, state.fresh) = (Some(now), true);
        if let Some(window) = plan.window {
            state.stamps.push_back(now);
            while state.stamps.front().is_some_and(|&t| t <= now.saturating_sub(window.nanos())) {
                state.stamps.pop_front();
            }
        }
        for &object in &plan.objects {
            self.objects[object].message(&program.objects[object], topic, values, now, &mut self.inputs);
        }
        for &event in &plan.events {
            if let Some(from) = &program.events[event].from_message {
                self.inputs.events[event].add(from.iter().map(|&f| values.get(f).unwrap_or(&Value::Missing)));
                self.filter_event(program, event);
            }
        }
    }

    /// Takes the latest occurrence of an event back where its condition does not hold.
    fn filter_event(&mut self, program: &Program, event: usize) {
        let Some((at, when)) = &program.events[event].when else { return };
        let notes = Notes::default();
        let view =
            View { at, inputs: &self.inputs, bits: &[], values: &[], params: &[], now: 0, notes: &notes, seen: &[] };
        if !view.holds(*when) {
            self.inputs.events[event].count -= 1;
        }
    }

    /// Marks the properties for which this topic or signal has been silent for too long.
    fn note_silence(&mut self, program: &Program, of: Read, now: i64) {
        let heard = match of {
            Read::Topic(topic) => self.inputs.topics[topic].last,
            Read::Slot(slot) => self.heard[slot],
        };
        let since = heard.or(self.t0).unwrap_or(now);
        for (property, stale) in program.properties.iter().zip(&mut self.stale) {
            let too_long = |s: &Silence| s.of == of && Time(now).since(Time(since)) > s.limit;
            if stale.is_none() {
                *stale = property.stale.iter().position(too_long).map(|i| (i, since, now));
            }
        }
    }

    /// An instant that all share.
    fn instant(&mut self, program: &Program, now: i64, tell: &mut impl Observer) {
        self.instants += 1;
        self.last_instant = Some(now);
        for (i, (memory, plan)) in self.machines.iter_mut().zip(&program.machines).enumerate() {
            memory.step(plan, i, &mut self.inputs, now, tell);
        }
        for (instances, plan) in self.groups.iter_mut().zip(&program.groups) {
            for core in &mut instances.cores {
                core.step(plan, &self.inputs, now, program.open_limit, tell);
            }
        }
        tell.output(&self.inputs, Output::Instant(Time(now)));
        self.inputs.end_instant();
    }

    /// The outcome of every property.
    fn finish(&mut self, program: &Program, ending: &Ending, tell: &mut impl Observer) -> Vec<Outcome> {
        let last = self.last.unwrap_or_default();
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
            for core in &mut instances.cores {
                core.end(plan, &self.inputs, last);
            }
        }
        (0..program.properties.len()).flat_map(|p| self.judge(program, p, ending)).collect()
    }
}

impl Instances {
    fn new(plan: &Group, inputs: &Inputs, counters: usize) -> Instances {
        let seen = if plan.at.slices.is_empty() { alloc::vec![0] } else { Vec::new() };
        Instances { cores: alloc::vec![Core::new(plan, inputs, counters)], seen, too_many: false }
    }

    /// Makes instances for values that are seen for the first time: each goes on from where its template stands.
    ///
    /// Any event with the field makes one, since from then on its slice differs from the others; it counts as an instance once the
    /// slice's own event has had the value.
    fn make(&mut self, at: &Positions, inputs: &Inputs) {
        for (i, slice) in at.slices.iter().enumerate() {
            for &(event, field) in &slice.hides {
                let Some(state) = inputs.events.get(event) else { continue };
                for value in state.iter().filter_map(|fields| fields.get(field)).filter(|v| **v != Value::Missing) {
                    self.make_for(i, value);
                    if event == slice.event {
                        self.mark(i, value);
                    }
                }
            }
        }
    }

    /// The `i`-th slice's own event had the value.
    fn mark(&mut self, i: usize, value: &Value) {
        for (number, core) in self.cores.iter_mut().enumerate() {
            if core.key[i].as_ref() == Some(value) && !core.is_seen[i] {
                core.is_seen[i] = true;
                if core.is_instance() {
                    self.seen.push(number);
                }
            }
        }
    }

    /// Instances for a value of the `i`-th slice, unless there are some.
    fn make_for(&mut self, i: usize, value: &Value) {
        if self.cores.iter().any(|c| c.key[i].as_ref() == Some(value)) {
            return;
        }
        let templates: Vec<_> = self.cores.iter().filter(|c| c.key[i].is_none()).cloned().collect();
        for mut core in templates {
            if self.cores.len() >= INSTANCES {
                self.too_many = true;
                return;
            }
            core.key[i] = Some(value.clone());
            if let Some(margins) = &mut core.margins {
                margins.share(self.cores.len() + 1);
            }
            self.cores.push(core);
        }
    }
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
    program.clock != Clock::Events || ages || stays || program.groups.iter().any(|g| !g.futures.is_empty())
}
