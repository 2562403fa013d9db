//! The graph of future operators.
//!
//! At each position of its context a node is true or false; often that shows only later. Knowledge travels through the graph as
//! [`Decided`] runs of positions, each position once, in passes: one when segments close, one for a deadline, one for a position,
//! one when the trace ends. Within a pass a node sees what those before it decided. What is not decided is unknown, and the nodes
//! combine true, false and unknown as Kleene's three-valued logic does.
//!
//! Cost: a position enters and leaves each node once, and runs of positions that fare alike are handled as one, so a step is
//! amortised constant whatever the bounds. The exceptions are [`replay`] and bounded operators over future formulas whose own
//! deadline has passed; both say so where they are written.

mod and;
mod each;
mod evaluate;
mod eventually;
mod gate;
mod next;
mod replay;
mod scope;
mod segments;
mod survey;
mod until;

use alloc::boxed::Box;
use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::node::View;
use crate::pack::{Pack, Packer, Unpacker, packed};
use crate::program::{Bound, Context, Future, FutureKind, FutureRef};
use crate::times::{Pos, Times};

pub(crate) use segments::{Segment, step_segments};

/// Positions that became known in this pass.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub(crate) struct Decided {
    pub from: Pos,
    pub to: Pos,
    pub value: bool,
}

/// What a pass is about.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Moment {
    /// Some segments close before the position that comes.
    Close,
    /// Bounds that end here are over; `closed` ones after the positions with this stamp, open ones before.
    Deadline { at: i64, closed: bool },
    /// A new position.
    Position(Pos),
    /// The trace is over, its last stamp this: what would hold if it were all. Bounds that reach beyond stay unknown.
    End { last: i64 },
}

/// What a node sees in a pass.
pub(crate) struct Pass<'a> {
    pub moment: Moment,
    pub view: View<'a>,
    pub times: &'a Times,
    pub segments: &'a [Segment],
}

impl Pass<'_> {
    /// The new position, where there is one in this context.
    fn position(&self, context: u32) -> Option<Pos> {
        match self.moment {
            Moment::Position(n) if self.segments[context as usize].active => Some(n),
            _ => None,
        }
    }

    /// The new position, where there is one in this node's context, and somebody asks for its value there.
    fn asked(&self, node: &Future) -> Option<Pos> {
        self.position(node.context).filter(|_| node.asked.is_none_or(|asked| self.view.bool(asked)))
    }

    /// Whether this context's segment closes in this pass.
    fn closes(&self, context: u32) -> bool {
        self.moment == Moment::Close && self.segments[context as usize].closes
    }

    /// The positions that look at `j` under a bound: first and last, where there are any.
    fn looking_at(&self, j: Pos, bound: &Bound) -> Option<(Pos, Pos)> {
        if *bound == Bound::ALL {
            return Some((0, j));
        }
        let stamp = self.times.at(j);
        let first = match (bound.has_end(), bound.hi_closed) {
            (false, _) => 0,
            (true, true) => self.times.first_at_or_after(stamp.saturating_sub(bound.hi)),
            (true, false) => self.times.first_after(stamp.saturating_sub(bound.hi)),
        };
        let beyond = match (bound.lo, bound.lo_closed) {
            (0, true) => j + 1,
            (lo, true) => self.times.first_after(stamp.saturating_sub(lo)),
            (lo, false) => self.times.first_at_or_after(stamp.saturating_sub(lo)),
        };
        let last = beyond.checked_sub(1)?.min(j);
        (first <= last).then_some((first, last))
    }

    /// The positions that `k` looks at under a bound, among those that have come: first and last (perhaps none: first > last).
    fn looked_at(&self, k: Pos, bound: &Bound) -> (Pos, Pos) {
        let stamp = self.times.at(k);
        let first = match (bound.lo, bound.lo_closed) {
            (0, true) => k,
            (lo, true) => self.times.first_at_or_after(stamp.saturating_add(lo)).max(k),
            (lo, false) => self.times.first_after(stamp.saturating_add(lo)).max(k),
        };
        let beyond = match (bound.has_end(), bound.hi_closed) {
            (false, _) => self.times.next(),
            (true, true) => self.times.first_after(stamp.saturating_add(bound.hi)),
            (true, false) => self.times.first_at_or_after(stamp.saturating_add(bound.hi)),
        };
        // With no position looked at the pair is empty; position 0 needs care only there.
        if beyond <= first { (1, 0) } else { (first, beyond - 1) }
    }
}

/// When the bound ends for the positions with this stamp: never, where that is beyond the end of time.
fn ends(bound: &Bound, stamp: i64) -> Option<(i64, bool)> {
    if !bound.has_end() {
        return None;
    }
    Some((stamp.checked_add(bound.hi)?, bound.hi_closed))
}

/// The state of a node.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum FutureState {
    State,
    And(and::State),
    Eventually(eventually::State),
    Next(next::State),
    Until(until::State),
    After(scope::AfterState),
    UntilScope(scope::UntilState),
    Each(each::State),
    Gate(gate::State),
    Replay(replay::State),
    Survey(survey::State),
}

impl FutureState {
    pub fn new(kind: &FutureKind) -> FutureState {
        match kind {
            FutureKind::State(_) => FutureState::State,
            FutureKind::And(..) => FutureState::And(Default::default()),
            FutureKind::Eventually(..) => FutureState::Eventually(Default::default()),
            FutureKind::Next(_) => FutureState::Next(Default::default()),
            FutureKind::Until(..) => FutureState::Until(Default::default()),
            FutureKind::After { .. } => FutureState::After(Default::default()),
            FutureKind::UntilScope { .. } => FutureState::UntilScope(Default::default()),
            FutureKind::Each { .. } => FutureState::Each(Default::default()),
            FutureKind::Gate { .. } => FutureState::Gate(Default::default()),
            FutureKind::Replay(_) => FutureState::Replay(Default::default()),
            FutureKind::Survey(_) => FutureState::Survey(Default::default()),
        }
    }

    /// What the node decides in this pass, given what the nodes before it decided.
    pub fn step(&mut self, node: &Future, pass: &Pass<'_>, before: &[Vec<Decided>], out: &mut Vec<Decided>) {
        let of = |r: &FutureRef| Operand { decided: &before[r.id as usize], negated: r.negated };
        match (self, &node.kind) {
            (FutureState::State, FutureKind::State(formula)) => {
                if let Some(n) = pass.position(node.context) {
                    out.push(Decided { from: n, to: n, value: pass.view.bool(*formula) });
                }
            }
            (FutureState::And(s), FutureKind::And(l, r)) => and::step(s, node.context, of(l), of(r), pass, out),
            (FutureState::Eventually(s), FutureKind::Eventually(bound, f)) => {
                eventually::step(s, node, bound, of(f), pass, out);
            }
            (FutureState::Next(s), FutureKind::Next(f)) => next::step(s, node.context, of(f), pass, out),
            (FutureState::Until(s), FutureKind::Until(bound, l, r)) => {
                until::step(s, node, bound, (*l, *r), pass, out);
            }
            (FutureState::After(s), FutureKind::After { x, body, .. }) => {
                scope::step_after(s, node.context, *x, of(body), pass, out);
            }
            (FutureState::UntilScope(s), FutureKind::UntilScope { weak, x, body, .. }) => {
                scope::step_until(s, node.context, *weak, *x, of(body), pass, out);
            }
            (FutureState::Each(s), FutureKind::Each { x, body, inner }) => {
                each::step(s, (node.context, *inner), *x, of(body), pass, out);
            }
            (FutureState::Gate(s), FutureKind::Gate { body, before }) => {
                gate::step(s, *before, of(body), pass, out);
            }
            (FutureState::Replay(s), FutureKind::Replay(formula)) => {
                replay::step(s, node.context, formula, pass, out);
            }
            (FutureState::Survey(s), FutureKind::Survey(survey)) => survey::step(s, node.context, survey, pass),
            _ => {}
        }
    }

    /// The next time at which a bound of this node ends for some position.
    pub fn deadline(&self, node: &Future, times: &Times) -> Option<(i64, bool)> {
        match (self, &node.kind) {
            (FutureState::Eventually(s), FutureKind::Eventually(bound, _)) => s.deadline(bound, times),
            (FutureState::Until(s), FutureKind::Until(bound, ..)) => s.deadline(bound, times),
            (FutureState::Replay(s), _) => s.deadline(),
            _ => None,
        }
    }

    /// The oldest position whose stamp the node may still ask for.
    pub fn oldest(&self) -> Option<Pos> {
        match self {
            FutureState::Eventually(s) => s.oldest(),
            FutureState::Until(s) => s.oldest(),
            FutureState::Replay(s) => s.oldest(),
            _ => None,
        }
    }

    /// Whether position `n`, which is the newest, decided nothing but itself, and another one like it would do no more.
    fn is_still(&self, node: &Future, n: Pos, decided: &[Decided]) -> bool {
        let is_decided = match self {
            FutureState::State => true,
            FutureState::And(s) => s.newest() != Some(n),
            FutureState::Eventually(s) => s.newest() != Some(n),
            FutureState::Until(s) => s.newest() != Some(n),
            _ => self.runs() == 0,
        };
        // What looks at positions from some time on only may be hit by the very next one.
        let looks_at_once = match node.kind {
            FutureKind::Eventually(bound, _) | FutureKind::Until(bound, ..) => (bound.lo, bound.lo_closed) == (0, true),
            _ => true,
        };
        is_decided && decided.iter().all(|d| (d.from, d.to) == (n, n)) && (looks_at_once || self.runs() == 0)
    }

    /// How many runs of undecided positions it keeps.
    pub fn runs(&self) -> usize {
        match self {
            FutureState::State | FutureState::Survey(_) => 0,
            FutureState::And(s) => s.runs(),
            FutureState::Eventually(s) => s.runs(),
            FutureState::Next(s) => s.runs(),
            FutureState::Until(s) => s.runs(),
            FutureState::After(s) => s.runs(),
            FutureState::UntilScope(s) => s.runs(),
            FutureState::Each(s) => s.runs(),
            FutureState::Gate(s) => s.runs(),
            FutureState::Replay(s) => s.runs(),
        }
    }
}

/// What it is of, the program says.
impl Pack for FutureState {
    fn pack(&self, to: &mut Packer) {
        match self {
            FutureState::State => {}
            FutureState::And(state) => state.pack(to),
            FutureState::Eventually(state) => state.pack(to),
            FutureState::Next(state) => state.pack(to),
            FutureState::Until(state) => state.pack(to),
            FutureState::After(state) => state.pack(to),
            FutureState::UntilScope(state) => state.pack(to),
            FutureState::Each(state) => state.pack(to),
            FutureState::Gate(state) => state.pack(to),
            FutureState::Replay(state) => state.pack(to),
            FutureState::Survey(state) => state.pack(to),
        }
    }

    fn unpack(&mut self, from: &mut Unpacker<'_>) {
        match self {
            FutureState::State => {}
            FutureState::And(state) => state.unpack(from),
            FutureState::Eventually(state) => state.unpack(from),
            FutureState::Next(state) => state.unpack(from),
            FutureState::Until(state) => state.unpack(from),
            FutureState::After(state) => state.unpack(from),
            FutureState::UntilScope(state) => state.unpack(from),
            FutureState::Each(state) => state.unpack(from),
            FutureState::Gate(state) => state.unpack(from),
            FutureState::Replay(state) => state.unpack(from),
            FutureState::Survey(state) => state.unpack(from),
        }
    }
}

/// What an operand decided in this pass.
#[derive(Clone, Copy)]
pub(crate) struct Operand<'a> {
    pub decided: &'a [Decided],
    pub negated: bool,
}

impl Operand<'_> {
    pub fn iter(&self) -> impl Iterator<Item = Decided> + '_ {
        self.decided.iter().map(|d| Decided { value: d.value != self.negated, ..*d })
    }
}

/// The states of all contexts and nodes of a group.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Graph {
    pub segments: Box<[Segment]>,
    nodes: Box<[FutureState]>,
    /// What each node decided in the latest pass.
    pub decided: Vec<Vec<Decided>>,
    deadline: Option<(i64, bool)>,
    /// The nodes that nobody asks for any more; nothing where there is none.
    off: Vec<bool>,
}

// What was decided in a pass is not asked for after it.
packed!(Graph { segments, nodes, deadline, off } without { decided });

impl Graph {
    pub fn new(contexts: &[Context], futures: &[Future]) -> Graph {
        Graph {
            segments: contexts.iter().map(|_| Segment::default()).collect(),
            nodes: futures.iter().map(|f| FutureState::new(&f.kind)).collect(),
            decided: futures.iter().map(|_| Vec::new()).collect(),
            deadline: None,
            off: Vec::new(),
        }
    }

    /// Sends a moment through the graph.
    pub fn pass(&mut self, futures: &[Future], moment: Moment, view: View<'_>, times: &Times) {
        let pass = Pass { moment, view, times, segments: &self.segments };
        for (i, (state, node)) in self.nodes.iter_mut().zip(futures).enumerate() {
            let (before, rest) = self.decided.split_at_mut(i);
            let out = &mut rest[0];
            out.clear();
            if self.off.get(i) != Some(&true) {
                state.step(node, &pass, before, out);
            }
        }
        self.deadline = self.nodes.iter().zip(futures).filter_map(|(s, n)| s.deadline(n, times)).min();
    }

    /// The next deadline: its time, and whether positions with that very stamp still count.
    pub fn deadline(&self) -> Option<(i64, bool)> {
        self.deadline
    }

    /// The oldest position whose stamp is still asked for.
    pub fn oldest(&self) -> Option<Pos> {
        self.nodes.iter().filter_map(FutureState::oldest).min()
    }

    /// Whether position `n`, which is the newest, decided nothing but itself, and others like it would do no more.
    pub fn is_still(&self, futures: &[Future], n: Pos) -> bool {
        let mut nodes = self.nodes.iter().zip(futures).zip(&self.decided);
        nodes.all(|((state, node), decided)| state.is_still(node, n, decided))
    }

    /// How many runs of undecided positions there are in all.
    pub fn runs(&self) -> usize {
        self.nodes.iter().map(FutureState::runs).fold(0, usize::saturating_add)
    }

    /// How often the scopes of a property were entered, where a survey has counted that.
    pub fn entered(&self, futures: &[Future], property: usize) -> Option<&[u64]> {
        self.nodes.iter().zip(futures).find_map(|(state, node)| match (state, &node.kind) {
            (FutureState::Survey(state), FutureKind::Survey(survey)) if survey.property == property => state.entered(),
            _ => None,
        })
    }

    /// The positions up to now are no longer known to what counts at the end.
    pub fn give_up_surveys(&mut self) {
        for node in &mut self.nodes {
            if let FutureState::Survey(state) = node {
                state.give_up();
            }
        }
    }

    /// The nodes that keep more runs than that.
    pub fn larger_than(&self, runs: usize) -> impl Iterator<Item = usize> {
        self.nodes.iter().enumerate().filter(move |(_, node)| node.runs() > runs).map(|(id, _)| id)
    }

    /// Lets go of the nodes that are not `needed`.
    pub fn let_go(&mut self, futures: &[Future], needed: &[bool]) {
        self.off = needed.iter().map(|needed| !needed).collect();
        for ((state, node), _) in self.nodes.iter_mut().zip(futures).zip(needed).filter(|(_, needed)| !**needed) {
            *state = FutureState::new(&node.kind);
        }
    }
}
