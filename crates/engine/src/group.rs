//! Properties with the same positions, stepped together.

use alloc::boxed::Box;
use alloc::vec::Vec;

use lapwing_stream::{Time, Value};
use serde::{Deserialize, Serialize};

use crate::automaton::Automaton;
use crate::future::{Graph, Moment, step_segments};
use crate::inputs::{Due, Inputs};
use crate::looks::LookState;
use crate::margin::Margins;
use crate::outcome::{Alarm, Observer, Output};
use crate::pack::packed;
use crate::past::{Here, NOW};
use crate::program::{At, Group, Judged};
use crate::standing::GivenUp;
use crate::times::{Pos, Times};
use crate::tracker::{TrackerState, is_obliged};
use crate::walk::Walk;

/// An instant that all share.
#[derive(Clone, Copy)]
pub(crate) struct When {
    pub now: i64,
    /// How many there were before it.
    pub number: u64,
    /// The stamp of the one before.
    pub before: i64,
}

/// One instance of a group.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Core {
    /// The values of the slices; `None` stands for every value not seen so far.
    pub key: Vec<Option<Value>>,
    /// Whether the slices' own events have had all of them: it is an instance, and no template of instances to come.
    pub is_instance: bool,
    pub walk: Walk,
    pub times: Times,
    pub graph: Graph,
    pub trackers: Box<[TrackerState]>,
    pub(crate) looks: Box<[LookState]>,
    pub positions: u64,
    /// Whether positions at which nothing is due need only be counted from now on.
    rests: bool,
    /// Whether that is so of a group with segments or future operators, for as long as nothing is due.
    pub(crate) idles: bool,
    /// How many instants have been looked at, or made up for.
    pub stepped: u64,
    /// The number of faults that have spoilt what stands on them.
    spoilt_by: usize,
    /// By how much its properties missed changing their verdicts, where that is asked for.
    pub margins: Option<Box<Margins>>,
}

packed!(Core { walk, times, graph, trackers, looks, positions, rests, idles, stepped, spoilt_by } without {
    key, is_instance, margins
});

impl Core {
    pub fn new(plan: &Group, inputs: &Inputs, counters: usize) -> Core {
        Core {
            key: alloc::vec![None; plan.at.slices.len()],
            is_instance: plan.at.slices.is_empty(),
            walk: Walk::new(&plan.at, inputs, counters),
            times: Times::default(),
            graph: Graph::new(&plan.contexts, &plan.futures),
            trackers: plan.trackers.iter().map(|_| TrackerState::default()).collect(),
            looks: plan.looks.iter().map(LookState::new).collect(),
            positions: 0,
            rests: false,
            idles: false,
            stepped: 0,
            spoilt_by: 0,
            margins: None,
        }
    }

    /// Computes margins as well, from now on.
    pub fn measure(&mut self, plan: &Group, inputs: &Inputs, limit: usize) {
        let view = self.walk.view(here(plan, inputs, 0, &self.key));
        (self.rests, self.idles) = (false, false);
        self.margins = Some(Box::new(Margins::new(&plan.margins, limit, view)));
    }

    /// Before when the group rests as long as no signal changes: its operators keep their values, and its positions need only be
    /// counted. [`NOW`] where it does not.
    #[inline]
    pub fn rests_until(&self) -> i64 {
        if self.rests || self.idles { self.walk.quiet_until() } else { NOW }
    }

    /// Counts the instants that were not looked at, of `instants` in all until now, the last at `last`: at each of them the verdicts were
    /// what they are.
    pub fn catch_up(&mut self, plan: &Group, instants: u64, last: i64) {
        if plan.rests {
            self.make_up_until(plan, instants, last, self.walk.word());
        } else if self.idles {
            self.make_up_idle(plan, instants, last);
        }
        self.stepped = instants;
    }

    /// Counts the instants before the one with that number that were not looked at; at each of them the registers' `word` held.
    fn make_up_until(&mut self, plan: &Group, number: u64, last: i64, word: u64) {
        let missed = number.saturating_sub(self.stepped);
        if missed == 0 {
            return;
        }
        self.walk.pass_over(last);
        let from = self.positions;
        self.positions += missed;
        for (state, tracker) in self.trackers.iter_mut().zip(&plan.trackers) {
            if let (Judged::State(formula), At::All) = (tracker.formula, tracker.at) {
                state.judge_rest(formula.in_word(word), (from, self.positions - 1), last);
            }
        }
    }

    /// An instant: a position, if it is one for this group.
    #[inline(always)]
    pub fn step(
        &mut self,
        (plan, automaton): (&Group, &mut Automaton),
        inputs: &Inputs,
        due: Due,
        when: When,
        limit: usize,
        tell: &mut impl Observer,
    ) {
        if self.rests && !plan.at.slices.is_empty() {
            self.step_resting((plan, automaton), inputs, due.ops, when, tell);
        } else if self.rests {
            self.step_at_rest((plan, automaton), inputs, due, when, tell);
        } else if self.idles {
            self.step_idle((plan, automaton), inputs, due.ops, when, limit, tell);
        } else {
            self.stepped = when.number + 1;
            self.step_any((plan, automaton), inputs, due.ops, when.now, limit, tell);
        }
    }

    /// An instant of a group that idles: where what is heard of what was due comes to what it was, it does so on.
    #[inline(never)]
    fn step_idle(
        &mut self,
        (plan, automaton): (&Group, &mut Automaton),
        inputs: &Inputs,
        due: u64,
        when: When,
        limit: usize,
        tell: &mut impl Observer,
    ) {
        let word = self.walk.word();
        self.walk.pass_over(when.before);
        self.walk.run(automaton, here(plan, inputs, when.now, &self.key), due);
        let is_same = (word ^ self.walk.word()) & plan.heard == 0;
        if !is_same || self.spoilt_by != self.walk.faults.len() {
            self.make_up_idle(plan, when.number, when.before);
            self.stepped = when.number + 1;
            self.spoil(plan);
            self.take_position(plan, inputs, when.now, Some(word), limit, tell);
        }
    }

    /// Whether positions at which nothing is due need only be counted.
    #[inline(always)]
    pub fn rests(&self) -> bool {
        self.rests
    }

    /// An instant of a group that rests. Gives what [`Core::rests_until`] says then.
    #[inline(always)]
    pub fn step_at_rest(
        &mut self,
        (plan, automaton): (&Group, &mut Automaton),
        inputs: &Inputs,
        due: Due,
        when: When,
        tell: &mut impl Observer,
    ) -> i64 {
        let is_quiet = when.now < self.walk.quiet_until()
            || plan.alphabet().is_some_and(|alphabet| self.walk.is_quiet(alphabet, when.now, when.before));
        if is_quiet && let Some(until) = self.glide((plan, automaton), inputs, due.letter, when, tell) {
            return until;
        }
        self.step_resting((plan, automaton), inputs, due.ops, when, tell);
        self.walk.quiet_until()
    }

    /// An instant of a group that rests, at which nothing is due but what signals make so, where all that it takes is a move of the automaton
    /// that is known. Gives what [`Core::rests_until`] says then; else nothing has happened.
    // PERF: the way of most properties of robots, and of nearly all of their instants, without what only others need.
    #[inline(always)]
    pub fn glide(
        &mut self,
        (plan, automaton): (&Group, &Automaton),
        inputs: &Inputs,
        letter: u32,
        When { now, number, before }: When,
        tell: &mut impl Observer,
    ) -> Option<i64> {
        let glided = self.walk.glide(automaton, letter, now, before)?;
        if (glided.from ^ glided.to) & plan.heard != 0 {
            self.turn(plan, inputs, When { now, number, before }, glided.from, tell);
        }
        Some(glided.quiet_until)
    }

    #[inline(never)]
    fn step_resting(
        &mut self,
        (plan, automaton): (&Group, &mut Automaton),
        inputs: &Inputs,
        due: u64,
        when: When,
        tell: &mut impl Observer,
    ) {
        let word = self.walk.word();
        self.walk.pass_over(when.before);
        self.walk.run(automaton, here(plan, inputs, when.now, &self.key), due);
        let is_same = (word ^ self.walk.word()) & plan.heard == 0;
        if !is_same || self.spoilt_by != self.walk.faults.len() {
            self.turn(plan, inputs, when, word, tell);
        }
    }

    /// A position at which a verdict changes; until it the registers' `word` held.
    #[inline(never)]
    pub fn turn(&mut self, plan: &Group, inputs: &Inputs, when: When, word: u64, tell: &mut impl Observer) {
        self.make_up_until(plan, when.number, when.before, word);
        self.stepped = when.number + 1;
        self.positions += 1;
        self.spoil(plan);
        self.judge(plan, inputs, when.now, tell);
    }

    #[inline(never)]
    pub fn step_any(
        &mut self,
        (plan, automaton): (&Group, &mut Automaton),
        inputs: &Inputs,
        due: u64,
        now: i64,
        limit: usize,
        tell: &mut impl Observer,
    ) {
        let before = self.walk.last.map(|_| self.walk.word());
        let is_position = self.walk.enter(automaton, here(plan, inputs, now, &self.key), due);
        self.rests = plan.rests && self.walk.started && self.margins.is_none();
        self.spoil(plan);
        if self.margins.is_some() {
            self.measure_step(plan, inputs, now, is_position);
            if is_position && tell.wants_margins() {
                self.tell_margins(plan, now, tell);
            }
        }
        if is_position {
            self.take_position(plan, inputs, now, before, limit, tell);
        }
    }

    /// A position whose operators have been evaluated; before it the registers' word was `before`.
    #[inline]
    fn take_position(
        &mut self,
        plan: &Group,
        inputs: &Inputs,
        now: i64,
        before: Option<u64>,
        limit: usize,
        tell: &mut impl Observer,
    ) {
        self.positions += 1;
        if plan.is_plain() {
            self.judge(plan, inputs, now, tell);
        } else {
            let is_same = before.is_some_and(|before| (before ^ self.walk.word()) & plan.heard == 0);
            let n = self.decide(plan, inputs, now, tell);
            self.idles = plan.idles && is_same && self.is_still(plan, n, now);
            // An open bound of no length at all is over where it begins.
            self.advance(plan, inputs, now, tell);
            self.forget(plan, n, limit);
        }
    }

    /// Operators that met a value of another kind than they need spoil what stands on them.
    #[inline]
    fn spoil(&mut self, plan: &Group) {
        if self.spoilt_by == self.walk.faults.len() {
            return;
        }
        self.spoilt_by = self.walk.faults.len();
        let mut is_anew = false;
        for (state, tracker) in self.trackers.iter_mut().zip(&plan.trackers) {
            if state.given_up().is_none() && self.walk.faults.iter().any(|op| tracker.ops.contains(op)) {
                state.give_up(GivenUp::Spoilt);
                is_anew = true;
            }
        }
        if is_anew {
            self.let_go(plan);
        }
    }

    #[cold]
    fn measure_step(&mut self, plan: &Group, inputs: &Inputs, now: i64, is_position: bool) {
        // What is over events alone has no instants but its positions.
        if let Some(margins) = &mut self.margins
            && (is_position || plan.at.alphabet.is_none())
        {
            margins.step(&plan.margins, self.walk.view(here(plan, inputs, now, &self.key)), is_position);
        }
    }

    /// A position of a group without segments and future operators: its obligations end where they begin.
    #[inline]
    fn judge(&mut self, plan: &Group, inputs: &Inputs, now: i64, tell: &mut impl Observer) {
        let Core { key, walk, graph, trackers, positions, .. } = self;
        let n = *positions - 1;
        let whole = &mut graph.segments[0];
        if !whole.open {
            (whole.open, whole.active, whole.first, whole.start_stamp) = (true, true, true, now);
        } else {
            whole.first = false;
        }
        for (state, tracker) in trackers.iter_mut().zip(&plan.trackers) {
            if let Judged::State(formula) = tracker.formula
                && is_obliged(tracker, whole, now)
                && state.judge(walk.registers.bit(formula), n, now)
            {
                let alarm = Alarm { property: tracker.property, instance: key, ..Alarm::at(Time(now)) };
                raise(inputs, Output::Alarm(alarm), tell);
            }
        }
    }

    /// A position of any other group: which one.
    fn decide(&mut self, plan: &Group, inputs: &Inputs, now: i64, tell: &mut impl Observer) -> Pos {
        let n = self.times.push(now);
        let Core { key, walk, times, graph, trackers, looks, .. } = self;
        let view = walk.view(here(plan, inputs, now, key));
        if step_segments(&plan.contexts, &mut graph.segments, n, &view) {
            graph.pass(&plan.futures, Moment::Close, view, times);
            decide_looks(plan, graph, looks);
            for (state, tracker) in trackers.iter_mut().zip(&plan.trackers) {
                let alarms = alarms(inputs, (tracker.property, key), now, times, tell);
                state.decide(tracker, &graph.decided, now, times, alarms);
                if graph.segments[tracker.context as usize].closes {
                    state.segment_closed();
                }
            }
        }
        for i in 0..plan.looks.len() {
            let (before, rest) = looks.split_at_mut(i);
            rest[0].step(&plan.looks[i], n, &graph.segments, before, &view);
        }
        if !plan.futures.is_empty() {
            graph.pass(&plan.futures, Moment::Position(n), view, times);
            decide_looks(plan, graph, looks);
        }
        for (state, tracker) in trackers.iter_mut().zip(&plan.trackers) {
            let segment = &graph.segments[tracker.context as usize];
            let alarms = alarms(inputs, (tracker.property, key), now, times, tell);
            state.position(tracker, n, segment, &view, &graph.decided, times, alarms);
        }
        n
    }

    /// Time goes on to `now`: bounds that end before are over, each at its own time.
    #[inline]
    pub fn advance(&mut self, plan: &Group, inputs: &Inputs, now: i64, tell: &mut impl Observer) {
        while let Some((at, closed)) = self.graph.deadline() {
            if !(at < now || (!closed && at == now)) {
                return;
            }
            let Core { key, walk, times, graph, trackers, looks, .. } = self;
            let view = walk.view(here(plan, inputs, at, key));
            graph.pass(&plan.futures, Moment::Deadline { at, closed }, view, times);
            decide_looks(plan, graph, looks);
            for (state, tracker) in trackers.iter_mut().zip(&plan.trackers) {
                let alarms = alarms(inputs, (tracker.property, key), at, times, tell);
                state.decide(tracker, &graph.decided, at, times, alarms);
            }
        }
    }

    /// The trace is over: what would be missed if it were all.
    pub fn end(&mut self, plan: &Group, inputs: &Inputs, last: i64) {
        let Core { key, walk, times, graph, trackers, looks, .. } = self;
        let view = walk.view(here(plan, inputs, last, key));
        graph.pass(&plan.futures, Moment::End { last }, view, times);
        decide_looks(plan, graph, looks);
        for (state, tracker) in trackers.iter_mut().zip(&plan.trackers) {
            state.end(tracker, &graph.decided, times);
            state.seal_all();
        }
    }

    /// Lets go of stamps that nothing can ask for, and looks whether too much is open.
    fn forget(&mut self, plan: &Group, n: u64, limit: usize) {
        let open = self.trackers.iter().filter_map(|t| t.open.first()).min();
        let keep = [self.graph.oldest(), open].into_iter().flatten().min().unwrap_or(n);
        self.times.forget_before(keep);
        let obligations = self.trackers.iter().map(|t| t.open.len()).sum::<usize>();
        if self.graph.runs() + obligations > limit {
            self.give_up(plan, limit);
        }
    }

    /// The monitor starts afresh after so many instants, the last at `last`; what it has counted stands.
    pub fn start_afresh(&mut self, plan: &Group, inputs: &Inputs, instants: u64, last: i64) {
        self.catch_up(plan, instants, last);
        (self.rests, self.idles) = (false, false);
        self.walk.start_afresh(&plan.at, inputs);
        self.times = Times::default();
        self.graph = Graph::new(&plan.contexts, &plan.futures);
        self.graph.give_up_surveys();
        self.let_go(plan);
        self.trackers.iter_mut().for_each(TrackerState::start_afresh);
        for (state, look) in self.looks.iter_mut().zip(&plan.looks) {
            let entries = state.counts.last().copied().unwrap_or(0);
            *state = LookState::new(look);
            state.counts.last_mut().into_iter().for_each(|counted| *counted = entries);
        }
    }

    /// How often each scope of a property was entered.
    pub fn entered(&self, plan: &Group, property: usize, scopes: usize) -> Vec<u64> {
        if let Some(counted) = self.graph.entered(&plan.futures, property) {
            return counted.to_vec();
        }
        let mut counts = alloc::vec![0; scopes];
        for (look, state) in plan.looks.iter().zip(&self.looks) {
            if let Some((p, scope)) = look.counts
                && p == property
                && let Some(count) = counts.get_mut(scope)
            {
                *count += state.counts.last().copied().unwrap_or(0);
            }
        }
        counts
    }
}

/// An instant as a group sees it.
#[inline]
fn here<'a>(plan: &'a Group, inputs: &'a Inputs, now: i64, key: &'a [Option<Value>]) -> Here<'a> {
    Here { at: &plan.at, inputs, now, params: key, seen: &[] }
}

/// Tells the looks what the graph decided in its latest pass.
fn decide_looks(plan: &Group, graph: &Graph, looks: &mut [LookState]) {
    for (state, look) in looks.iter_mut().zip(&plan.looks) {
        state.decide(look, &graph.decided);
    }
}

/// Tells of the episodes of one conjunct that begin in one pass, given the positions at which their obligations began.
fn alarms<'a>(
    inputs: &'a Inputs,
    (property, instance): (usize, &'a [Option<Value>]),
    failed: i64,
    times: &'a Times,
    tell: &'a mut impl Observer,
) -> impl FnMut(Pos) + 'a {
    let mut is_further = false;
    move |from| {
        let began = times.at(from);
        let tied = times.first_after(began).saturating_sub(from + 1);
        let alarm = Alarm { property, instance, began: Time(began), tied, ..Alarm::at(Time(failed)) };
        raise(inputs, if is_further { Output::Further(alarm) } else { Output::Alarm(alarm) }, tell);
        is_further = true;
    }
}

/// Tells of an alarm, unless it is that of a template of instances that do not exist yet.
fn raise(inputs: &Inputs, output: Output<'_>, tell: &mut impl Observer) {
    if let Output::Alarm(alarm) | Output::Further(alarm) = &output
        && alarm.instance.iter().all(Option::is_some)
    {
        tell.output(inputs, output);
    }
}
