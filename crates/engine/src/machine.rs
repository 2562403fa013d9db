//! State diagrams: which state the robot is in, and whether it may go there.

use alloc::format;
use alloc::vec::Vec;

use lapwing_stream::Time;
use serde::{Deserialize, Serialize};

use crate::automaton::Automaton;
use crate::inputs::Inputs;
use crate::node::View;
use crate::outcome::{Alarm, Episode, Move, Observer, Output};
use crate::past::Here;
use crate::program::{Edge, Machine, MachineState};
use crate::walk::Walk;

/// Where a machine stands. Its current state is in [`Inputs::machines`], for all to read.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct MachineMemory {
    pub walk: Walk,
    #[serde(skip)]
    automaton: Automaton,
    /// How often each slot had a value at the last sample.
    seen: Vec<u64>,
    /// Since when it is in its state; whether its longest stay has been complained of.
    since: i64,
    overstayed: bool,
    pub met: u64,
    pub failed: u64,
    pub episodes: Vec<Episode>,
    pub positions: u64,
}

impl MachineMemory {
    pub fn new(plan: &Machine, inputs: &Inputs, counters: usize) -> MachineMemory {
        MachineMemory {
            walk: Walk::new(&plan.at, inputs, counters),
            automaton: Automaton::default(),
            seen: alloc::vec![0; inputs.versions.len()],
            since: 0,
            overstayed: false,
            met: 0,
            failed: 0,
            episodes: Vec::new(),
            positions: 0,
        }
    }

    /// An instant: it looks, and moves.
    pub fn step(&mut self, plan: &Machine, number: usize, inputs: &mut Inputs, now: i64, tell: &mut impl Observer) {
        let was_started = self.walk.started;
        let here = Here { at: &plan.at, inputs, now, params: &[], seen: &self.seen };
        let is_position = self.walk.enter(&mut self.automaton, here, u64::MAX);
        if !self.walk.faults.is_empty() {
            return get_lost(plan, number, inputs);
        }
        if !is_position {
            return;
        }
        self.positions += 1;
        if !was_started {
            self.since = now;
        }
        let view = self.walk.view(Here { at: &plan.at, inputs, now, params: &[], seen: &self.seen });
        if plan.sample.is_some_and(|sample| !view.bool(sample)) {
            return;
        }
        let current = inputs.machines[number];
        let chosen = choose(plan, current, &view);
        let allowed = match (current, chosen) {
            (Some(a), Some(b)) if a != b => is_drawn(plan, a, b, &view),
            _ => true,
        };
        self.seen.clone_from(&inputs.versions);
        if chosen != current {
            self.go(plan, number, (current, chosen), allowed, inputs, now, tell);
        }
    }

    #[allow(clippy::too_many_arguments)]
    fn go(
        &mut self,
        plan: &Machine,
        number: usize,
        (from, to): (Option<usize>, Option<usize>),
        allowed: bool,
        inputs: &mut Inputs,
        now: i64,
        tell: &mut impl Observer,
    ) {
        let name = |s: Option<usize>| s.and_then(|s| plan.states.get(s)).map_or("undefined", |s| &*s.name);
        let too_soon = from
            .and_then(|s| plan.states.get(s)?.at_least)
            .filter(|least| Time(now).since(Time(self.since)) < *least)
            .map(|least| format!("left {} before {least} were over", name(from)));
        let why = match (from, to) {
            (_, None) => Some(format!("no state fits after {}", name(from))),
            _ if !allowed => Some(format!("illegal transition {} -> {}", name(from), name(to))),
            _ => None,
        };
        let events = [from.and_then(|s| plan.states.get(s)?.left), to.and_then(|s| plan.states.get(s)?.entered)];
        for event in events.into_iter().flatten() {
            inputs.occur(event, core::iter::empty());
        }
        inputs.machines[number] = to;
        if why.is_none() && from.is_some() {
            self.met += 1;
        }
        let what = Alarm { property: plan.property, ..Alarm::at(Time(now)) };
        if let Some(why) = why {
            let illegal = Some(Move { from, to });
            self.fail(Alarm { why: Some(why), illegal, ..what.clone() }, inputs, tell);
        }
        if let Some(why) = too_soon {
            self.fail(Alarm { why: Some(why), ..what }, inputs, tell);
        }
        (self.since, self.overstayed) = (now, false);
    }

    fn fail(&mut self, what: Alarm<'_>, inputs: &Inputs, tell: &mut impl Observer) {
        self.failed += 1;
        self.episodes.push(Episode { failed: what.failed, began: what.began, until: what.failed, count: 1 });
        tell.output(inputs, Output::Alarm(what));
    }

    /// It stands in its initial state, as before its first sample. What it has counted stands.
    pub fn start_afresh(&mut self, plan: &Machine, number: usize, inputs: &mut Inputs) {
        self.walk.start_afresh(&plan.at, inputs);
        self.seen.clone_from(&inputs.versions);
        (self.since, self.overstayed) = (0, false);
        inputs.machines[number] = Some(plan.initial);
    }

    /// Since when it is in its state.
    pub fn since(&self) -> Time {
        Time(self.since)
    }

    /// The time at which it has been in its state for too long.
    pub fn deadline(&self, plan: &Machine, number: usize, inputs: &Inputs) -> Option<i64> {
        if !self.walk.started || self.overstayed || !self.walk.faults.is_empty() {
            return None;
        }
        let state = plan.states.get(inputs.machines[number]?)?;
        state.at_most.map(|most| self.since.saturating_add(most.nanos()))
    }

    /// Time goes on to `now`.
    pub fn advance(&mut self, plan: &Machine, number: usize, inputs: &Inputs, now: i64, tell: &mut impl Observer) {
        if let Some(at) = self.deadline(plan, number, inputs).filter(|&at| at < now) {
            self.overstayed = true;
            let name = inputs.machines[number].and_then(|s| plan.states.get(s)).map_or("", |s| &*s.name);
            let (began, why) = (Time(self.since), Some(format!("still in {name}")));
            self.fail(Alarm { property: plan.property, began, why, ..Alarm::at(Time(at)) }, inputs, tell);
        }
    }
}

/// From here on nobody knows where a machine stands, nor whether it moves.
fn get_lost(plan: &Machine, number: usize, inputs: &mut Inputs) {
    inputs.lost[number] = true;
    let events = plan.states.iter().flat_map(|state| [state.entered, state.left]).flatten();
    for event in events {
        inputs.events[event].is_unclear = true;
    }
}

/// The state that a sample shows: the first listed whose condition holds, else what the machine does without one.
fn choose(plan: &Machine, current: Option<usize>, view: &View<'_>) -> Option<usize> {
    let fits = |(i, state): (usize, &MachineState)| match (state.when, state.on) {
        (None, None) => is_led_to(plan, current, i, view),
        (when, on) => when.is_none_or(|w| view.bool(w)) && on.is_none_or(|e| view.occurrence(e).is_some()),
    };
    if let Some(i) = plan.states.iter().enumerate().position(fits) {
        return Some(i);
    }
    let stays = match current.and_then(|s| plan.states.get(s)) {
        Some(state) => state.when.is_none() || state.on.is_some() || plan.else_stay,
        None => false,
    };
    let no_conditions = plan.states.iter().all(|s| s.when.is_none());
    if stays || no_conditions { current } else { None }
}

/// Whether an edge with a trigger leads from the current state to one without a condition of its own.
fn is_led_to(plan: &Machine, current: Option<usize>, to: usize, view: &View<'_>) -> bool {
    plan.edges
        .iter()
        .any(|e| Some(e.from) == current && e.to == to && (e.on.is_some() || e.when.is_some()) && is_open(e, view))
}

fn is_drawn(plan: &Machine, from: usize, to: usize, view: &View<'_>) -> bool {
    plan.edges.iter().any(|e| (e.from, e.to) == (from, to) && is_open(e, view))
}

fn is_open(edge: &Edge, view: &View<'_>) -> bool {
    edge.on.is_none_or(|e| view.occurrence(e).is_some()) && edge.when.is_none_or(|w| view.bool(w))
}
