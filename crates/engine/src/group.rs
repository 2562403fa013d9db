//! Properties with the same positions, stepped together.

use alloc::boxed::Box;
use alloc::collections::VecDeque;
use alloc::vec::Vec;

use lapwing_stream::{Time, Value};

use crate::future::{Decided, Graph, Moment, Segment, step_segments};
use crate::inputs::Inputs;
use crate::margin::Margins;
use crate::node::{Notes, View};
use crate::outcome::{Observer, Output};
use crate::past::{self, Memory, Registers, Scene};
use crate::program::{Bound, Group, Judged, Look, LookKind, Positions};
use crate::runs::Runs;
use crate::times::{Pos, Times};
use crate::tracker::{TrackerState, is_obliged};

/// Where a machine or a group stands in its positions.
#[derive(Clone, Debug)]
pub(crate) struct Walk {
    /// Whether position 0 has come.
    pub started: bool,
    /// For how many instants each read has been defined.
    waited: Vec<usize>,
    /// What the code computed at the latest instant.
    registers: Registers,
    memories: Vec<Memory>,
    pub notes: Notes,
    /// For each comparison of an age: the message that its flips count from, and the next flip.
    flips: Vec<(Option<i64>, usize)>,
}

impl Walk {
    /// `inputs` are those before anything has come.
    pub fn new(at: &Positions, inputs: &Inputs, counters: usize) -> Walk {
        let mut walk = Walk::blank(at, counters);
        let Walk { registers, memories, notes, .. } = &mut walk;
        let scene = Scene { at, inputs, params: &[], now: 0, notes, seen: &inputs.versions };
        past::prime(&scene, memories, registers);
        walk.notes = Notes::new(counters);
        walk
    }

    fn blank(at: &Positions, counters: usize) -> Walk {
        Walk {
            started: false,
            waited: alloc::vec![0; at.reads.len()],
            registers: Registers::new(at.ops.len()),
            memories: at.ops.iter().map(Memory::new).collect(),
            notes: Notes::new(counters),
            flips: alloc::vec![(None, 0); at.ages.len()],
        }
    }

    /// Takes an instant in; whether it is a position.
    #[inline]
    pub fn enter(&mut self, at: &Positions, inputs: &Inputs, now: i64, params: &[Option<Value>], seen: &[u64]) -> bool {
        if let Some(alphabet) = &at.alphabet {
            let view = self.view(at, inputs, now, params, seen);
            if !alphabet.iter().any(|&e| view.occurrence(e).is_some()) {
                return false;
            }
            self.started = true;
        } else if !self.started {
            self.started = self.is_ready(at, inputs);
        }
        let Walk { registers, memories, notes, started, .. } = self;
        past::run(&Scene { at, inputs, params, now, notes, seen }, memories, *started, registers);
        if !self.started {
            self.notes.nans.iter().for_each(|n| n.set(0));
        }
        self.started
    }

    /// Whether everything has been defined for long enough.
    fn is_ready(&mut self, at: &Positions, inputs: &Inputs) -> bool {
        let mut ready = true;
        for ((read, depth), waited) in at.reads.iter().zip(&mut self.waited) {
            *waited += usize::from(inputs.defined(*read));
            ready &= *waited > *depth;
        }
        ready
    }

    /// The reads that are still missing.
    pub fn missing(&self, at: &Positions) -> impl Iterator<Item = usize> {
        self.waited.iter().zip(&at.reads).enumerate().filter(|(_, (w, (_, depth)))| *w <= depth).map(|(i, _)| i)
    }

    pub fn view<'a>(
        &'a self,
        at: &'a Positions,
        inputs: &'a Inputs,
        now: i64,
        params: &'a [Option<Value>],
        seen: &'a [u64],
    ) -> View<'a> {
        Scene { at, inputs, params, now, notes: &self.notes, seen }.view(&self.registers)
    }

    /// The next time at which a comparison of an age changes its value.
    pub fn next_flip(&mut self, at: &Positions, inputs: &Inputs) -> Option<i64> {
        let mut next: Option<i64> = None;
        for (age, (since, i)) in at.ages.iter().zip(&mut self.flips) {
            let last = inputs.topics.get(age.topic).and_then(|t| t.last);
            if *since != last {
                (*since, *i) = (last, 0);
            }
            if let (Some(last), Some(after)) = (last, age.after.get(*i)) {
                let flip = last.saturating_add(after.nanos());
                next = Some(next.map_or(flip, |n| n.min(flip)));
            }
        }
        next
    }

    /// The flips up to this time are over.
    pub fn pass_flips(&mut self, at: &Positions, until: i64) {
        for (age, (since, i)) in at.ages.iter().zip(&mut self.flips) {
            while let (Some(last), Some(after)) = (*since, age.after.get(*i)) {
                if last.saturating_add(after.nanos()) > until {
                    break;
                }
                *i += 1;
            }
        }
    }
}

/// One instance of a group.
#[derive(Clone, Debug)]
pub(crate) struct Core {
    /// The values of the slices; `None` stands for every value not seen so far.
    pub key: Vec<Option<Value>>,
    /// Whether the slice's own event has had the value.
    pub is_seen: Vec<bool>,
    pub walk: Walk,
    pub times: Times,
    pub graph: Graph,
    pub trackers: Vec<TrackerState>,
    looks: Vec<LookState>,
    pub positions: u64,
    /// More runs were open than allowed.
    pub overflowed: bool,
    /// By how much its properties missed changing their verdicts, where that is asked for.
    pub margins: Option<Box<Margins>>,
}

impl Core {
    pub fn new(plan: &Group, inputs: &Inputs, counters: usize) -> Core {
        Core {
            key: alloc::vec![None; plan.at.slices.len()],
            is_seen: alloc::vec![false; plan.at.slices.len()],
            walk: Walk::new(&plan.at, inputs, counters),
            times: Times::default(),
            graph: Graph::new(&plan.contexts, &plan.futures),
            trackers: plan.trackers.iter().map(|_| TrackerState::default()).collect(),
            looks: plan.looks.iter().map(LookState::new).collect(),
            positions: 0,
            overflowed: false,
            margins: None,
        }
    }

    /// Computes margins as well, from now on.
    pub fn measure(&mut self, plan: &Group, inputs: &Inputs, limit: usize) {
        let view = self.walk.view(&plan.at, inputs, 0, &self.key, &[]);
        self.margins = Some(Box::new(Margins::new(&plan.margins, limit, view)));
    }

    /// Whether it is an instance, and no template of instances to come.
    pub fn is_instance(&self) -> bool {
        self.is_seen.iter().all(|seen| *seen)
    }

    /// An instant: a position, if it is one for this group.
    pub fn step(&mut self, plan: &Group, inputs: &Inputs, now: i64, limit: usize, tell: &mut impl Observer) {
        let is_position = self.walk.enter(&plan.at, inputs, now, &self.key, &[]);
        if self.margins.is_some() {
            self.measure_step(plan, inputs, now, is_position);
        }
        if !is_position {
            return;
        }
        self.positions += 1;
        if self.overflowed {
            return;
        }
        if plan.is_plain() { self.judge(plan, inputs, now, tell) } else { self.decide(plan, inputs, now, limit, tell) }
    }

    #[cold]
    fn measure_step(&mut self, plan: &Group, inputs: &Inputs, now: i64, is_position: bool) {
        // What is over events alone has no instants but its positions.
        if let Some(margins) = &mut self.margins
            && (is_position || plan.at.alphabet.is_none())
        {
            margins.step(&plan.margins, self.walk.view(&plan.at, inputs, now, &self.key, &[]), is_position);
        }
    }

    /// A position of a group without segments and future operators: its obligations end where they begin.
    #[inline]
    fn judge(&mut self, plan: &Group, inputs: &Inputs, now: i64, tell: &mut impl Observer) {
        let Core { key, walk, graph, trackers, positions, .. } = self;
        let n = *positions - 1;
        let whole = &mut graph.segments[0];
        if n == 0 {
            (whole.open, whole.active, whole.first, whole.start_stamp) = (true, true, true, now);
        } else {
            whole.first = false;
        }
        let view = walk.view(&plan.at, inputs, now, key, &[]);
        for (state, tracker) in trackers.iter_mut().zip(&plan.trackers) {
            if let Judged::State(formula) = tracker.formula
                && is_obliged(tracker, whole, now)
                && let Some(began) = state.judge(view.bool(formula), n, now)
            {
                alarm(inputs, tracker.property, key, began, now, tell);
            }
        }
    }

    /// A position of any other group.
    fn decide(&mut self, plan: &Group, inputs: &Inputs, now: i64, limit: usize, tell: &mut impl Observer) {
        let n = self.times.push(now);
        let Core { key, walk, times, graph, trackers, looks, .. } = self;
        let view = walk.view(&plan.at, inputs, now, key, &[]);
        if step_segments(&plan.contexts, &mut graph.segments, n, &view) {
            graph.pass(&plan.futures, Moment::Close, view, times);
            decide_looks(plan, graph, looks);
            for (state, tracker) in trackers.iter_mut().zip(&plan.trackers) {
                if let Some(began) = state.decide(tracker, &graph.decided, now, times) {
                    alarm(inputs, tracker.property, key, began, now, tell);
                }
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
            if let Some(began) = state.position(tracker, n, segment, &view, &graph.decided, times) {
                alarm(inputs, tracker.property, key, began, now, tell);
            }
        }
        // An open bound of no length at all is over where it begins.
        self.advance(plan, inputs, now, tell);
        self.forget(plan, n, limit);
    }

    /// Time goes on to `now`: bounds that end before are over, each at its own time.
    #[inline]
    pub fn advance(&mut self, plan: &Group, inputs: &Inputs, now: i64, tell: &mut impl Observer) {
        while let Some((at, closed)) = self.graph.deadline() {
            if !(at < now || (!closed && at == now)) {
                return;
            }
            let Core { key, walk, times, graph, trackers, looks, .. } = self;
            let view = walk.view(&plan.at, inputs, at, key, &[]);
            graph.pass(&plan.futures, Moment::Deadline { at, closed }, view, times);
            decide_looks(plan, graph, looks);
            for (state, tracker) in trackers.iter_mut().zip(&plan.trackers) {
                if let Some(began) = state.decide(tracker, &graph.decided, at, times) {
                    alarm(inputs, tracker.property, key, began, at, tell);
                }
            }
        }
    }

    /// The trace is over: what would be missed if it were all.
    pub fn end(&mut self, plan: &Group, inputs: &Inputs, last: i64) {
        let Core { key, walk, times, graph, trackers, looks, .. } = self;
        let view = walk.view(&plan.at, inputs, last, key, &[]);
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
        let runs = self.graph.runs() + self.trackers.iter().map(|t| t.open.len()).sum::<usize>();
        if runs > limit {
            self.give_up(plan);
        }
    }

    /// Too much is open: from here on nothing is judged, and what was kept for it goes. Failures that were counted stand.
    fn give_up(&mut self, plan: &Group) {
        self.overflowed = true;
        self.graph = Graph::new(&plan.contexts, &plan.futures);
        self.times = Times::default();
        for tracker in &mut self.trackers {
            tracker.open.clear();
            tracker.seal_all();
        }
    }

    /// How often each scope of a property was entered.
    pub fn entered(&self, plan: &Group, property: usize, scopes: usize) -> Vec<u64> {
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

/// Tells the looks what the graph decided in its latest pass.
fn decide_looks(plan: &Group, graph: &Graph, looks: &mut [LookState]) {
    for (state, look) in looks.iter_mut().zip(&plan.looks) {
        state.decide(look, &graph.decided);
    }
}

fn alarm(inputs: &Inputs, property: usize, key: &[Option<Value>], began: i64, failed: i64, tell: &mut impl Observer) {
    // A template of instances that do not exist yet is nobody's alarm.
    if key.iter().all(Option::is_some) {
        let (began, failed) = (Time(began), Time(failed));
        tell.output(inputs, Output::Alarm { property, instance: key, began, failed, why: None });
    }
}

/// Whether a scope is looked at, and how often it was entered.
#[derive(Clone, Debug, Default)]
struct LookState {
    /// Whether the latest position is looked at.
    now: bool,
    /// Whether a position before is looked at that has not had its X.
    pending: bool,
    /// What it saw at the position before.
    before: bool,
    /// Stamps of positions that are looked at, before and after the lower end of a bound.
    queue: VecDeque<i64>,
    reached: Option<i64>,
    /// Positions that are looked at and where the future formula is unknown.
    asked: Runs,
    /// Entries: inside the innermost context that awaits its X, inside the next, …, and last those that count.
    counts: Vec<u64>,
}

impl LookState {
    fn new(look: &Look) -> LookState {
        LookState { counts: alloc::vec![0; look.awaits.len() + 1], ..LookState::default() }
    }

    /// The graph decided something.
    fn decide(&mut self, look: &Look, decided: &[Vec<Decided>]) {
        let LookKind::Proves { formula, .. } = look.kind else { return };
        for d in &decided[formula.id as usize] {
            let holds = d.value != formula.negated;
            let count = &mut self.counts[0];
            self.asked.take(d.from, d.to, |a, b| *count += if holds { b - a + 1 } else { 0 });
        }
    }

    fn step(&mut self, look: &Look, n: Pos, segments: &[Segment], looks: &[LookState], view: &View<'_>) {
        let segment = &segments[look.context as usize];
        if segment.closes || segment.first {
            (self.pending, self.before, self.reached) = (false, false, None);
            self.queue.clear();
        }
        for (i, &context) in look.awaits.iter().enumerate() {
            let awaited = &segments[context as usize];
            if awaited.closes {
                let entries = core::mem::take(&mut self.counts[i]);
                self.counts[i + 1] += if awaited.closed_by_own { entries } else { 0 };
            }
        }
        self.now = segment.active && self.sees(look, n, segment, looks, view);
        self.counts[0] += u64::from(self.now);
    }

    fn sees(&mut self, look: &Look, n: Pos, segment: &Segment, looks: &[LookState], view: &View<'_>) -> bool {
        let at = |of: u32| looks[of as usize].now;
        match look.kind {
            LookKind::First => segment.first,
            LookKind::Within(bound) => {
                bound == Bound::ALL || bound.contains(view.now.saturating_sub(segment.start_stamp))
            }
            LookKind::Same { of } => at(of),
            LookKind::Proves { of, .. } => {
                if at(of) {
                    self.asked.push(n);
                }
                false
            }
            LookKind::Where { of, x } => at(of) && view.bool(x),
            LookKind::Unless { of, x } => at(of) && !view.bool(x),
            LookKind::Next { of } => core::mem::replace(&mut self.before, at(of)),
            LookKind::From { of, bound } => past::once(&bound, at(of), view.now, &mut self.queue, &mut self.reached),
            LookKind::FirstWith { of, x } => {
                self.pending |= at(of);
                let here = self.pending && view.bool(x);
                self.pending &= !here;
                here
            }
            LookKind::Opens { of, x, y } => {
                self.before |= at(of);
                self.pending |= at(of);
                let (opens, closes) = (self.pending && view.bool(x), view.bool(y));
                // A close, also at the opening position, lets the search go on.
                self.pending = (self.pending && !opens) || (closes && self.before);
                opens
            }
            LookKind::Runs { of, x } => {
                self.pending |= at(of);
                let here = view.bool(x);
                let was_here = core::mem::replace(&mut self.before, here);
                here && (at(of) || (self.pending && !was_here))
            }
        }
    }
}
