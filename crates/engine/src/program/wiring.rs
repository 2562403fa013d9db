//! What makes each operator due: the signals and operators that it reads, and time.

use alloc::vec::Vec;

use crate::latest::over;

use super::cuts::{Cut, constant, cuts};
use super::skim::Skim;
use super::{At, Group, Node, NodeId, Op, Positions, Program, Slot};

/// So many operators have a bit each. Where there are more, all of them run at every position.
const BITS: usize = u64::BITS as usize;

/// Which operators of some positions become due by what, as bits by their numbers.
#[derive(Clone, Debug, Default)]
pub struct Wiring {
    /// For each operator, those that read it.
    pub readers: Vec<u64>,
    /// Those that are due at every position that is looked at.
    pub always: u64,
    /// Those among them because of which every position has to be: all but those that read events which have to concern an instance.
    pub restless: u64,
    /// Those of which a bound may run out.
    pub timed: u64,
    /// Those of which an age may pass a limit.
    pub aged: u64,
    /// Those that read nothing but signals.
    pub leaves: u64,
    /// How the others follow from the leaves, where they are an automaton.
    pub alphabet: Option<Alphabet>,
}

/// What the automaton of some positions reads, where all operators but its leaves are `and`, `iff`, or `once` and `since` whose bounds begin
/// where they stand.
#[derive(Clone, Debug, Default)]
pub struct Alphabet {
    /// For each operator its bit in a letter, zero for those that do not read signals.
    pub places: Vec<u8>,
    /// How many leaves there are: a letter has a bit for each.
    pub width: usize,
    /// The bounded operators, as bits.
    pub timed: u64,
    /// For each operator the distance at which its bound has run out, in nanoseconds; [`u64::MAX`] for never.
    pub over: Vec<u64>,
}

impl Alphabet {
    /// The letter of the leaves among these operators.
    pub fn letter(&self, operators: u64) -> u32 {
        bits(operators).fold(0, |letter, i| letter | u32::from(self.places[i]))
    }
}

/// The numbers of the bits that are set.
#[inline]
pub(crate) fn bits(of: u64) -> Bits {
    Bits(of)
}

/// Yields the numbers of the bits that are set.
pub(crate) struct Bits(u64);

impl Iterator for Bits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let next = self.0.trailing_zeros() as usize;
        self.0 &= self.0 - 1;
        Some(next)
    }
}

/// More leaves make too many letters.
const LETTERS: usize = 6;

/// Operators of a group that read a signal.
#[derive(Clone, Copy, Debug)]
pub struct Wake {
    /// The number of the group.
    pub group: usize,
    /// The operators, as bits.
    pub ops: u64,
    /// The letter that the signal makes where it is a truth value and changes: of the operators that are nothing but the signal.
    pub letter: u32,
}

impl Wake {
    /// No letter tells what a change of the signal does. No move has it, whatever toggles beside.
    pub const NO_LETTER: u32 = 1 << 31;
}

impl Program {
    /// Fills in what follows from the rest of the program. To be called once all of it is there; without it everything runs at every
    /// position.
    pub fn link(&mut self) {
        self.slots.iter_mut().for_each(|slot| *slot = Slot { default: slot.default.take(), ..Slot::default() });
        self.topics.iter_mut().for_each(|topic| topic.wakes.clear());
        for (number, group) in self.groups.iter_mut().enumerate() {
            let wired = wire(&group.at);
            if let Some(wired) = &wired {
                wired.wake(&group.at, number, &mut self.slots);
                for &(topic, ops) in &wired.topics {
                    let wake = Wake { group: number, ops, letter: Wake::NO_LETTER };
                    self.topics.get_mut(topic).into_iter().for_each(|topic| topic.wakes.push(wake));
                }
            }
            group.ask();
            group.at.wiring = wired.map(|w| w.wiring);
            group.rests = group.may_rest();
            group.idles = group.may_idle();
            group.heard = if group.rests || group.idles { group.heard() } else { 0 };
        }
        self.slots.iter_mut().for_each(|slot| slot.cuts.sort_by(|a, b| a.at.total_cmp(&b.at)));
        self.skim = Skim::of(self);
    }

    /// Whether something asks how often a signal got a value.
    pub(crate) fn counts_values(&self) -> bool {
        let groups = self.groups.iter().map(|g| &g.at);
        let all = groups.chain(self.machines.iter().map(|m| &m.at));
        all.flat_map(|at| &at.nodes).any(|node| matches!(node, Node::Updated(_)))
    }
}

impl Group {
    /// What its automaton reads, where its operators are one.
    #[inline]
    pub(crate) fn alphabet(&self) -> Option<&Alphabet> {
        self.at.wiring.as_ref()?.alphabet.as_ref()
    }

    /// Whether anything happens to it by the mere passing of time, beside that operators become due.
    pub(crate) fn waits(&self) -> bool {
        !self.futures.is_empty() || !self.at.ages.is_empty()
    }

    /// Whether, where no operator is due, a position need only be counted.
    fn may_rest(&self) -> bool {
        let untimed = self.at.alphabet.is_none();
        // An obligation that stops arising at some distance from the start would be a change that nothing announces.
        let steady = self.trackers.iter().all(|t| matches!(t.at, At::First | At::All));
        let still = self.at.wiring.as_ref().is_some_and(|wiring| wiring.restless == 0);
        self.is_plain() && untimed && steady && still
    }
}

impl Positions {
    /// Whether a property that reads signals as well has an instance for each value of a field of this event.
    fn concerns_some(&self, event: usize) -> bool {
        match &self.slices[..] {
            [slice] if self.alphabet.is_none() => slice.hides.iter().any(|(hidden, _)| *hidden == event),
            _ => false,
        }
    }
}

/// The topic whose age a comparison compares with a constant, where what it comes to changes only with a message, and at the distances from
/// it that are listed.
fn aged(at: &Positions, node: &Node) -> Option<usize> {
    let Node::Compare { margin, left, right, .. } = node else { return None };
    let is_constant = |node: NodeId| constant(at, node).is_some();
    let topic = |node: NodeId| match at.nodes.get(node as usize)? {
        Node::Age(topic) => Some(*topic),
        _ => None,
    };
    let (topic, other) = topic(*left).map(|t| (t, *right)).or_else(|| topic(*right).map(|t| (t, *left)))?;
    let is_steady = margin.is_none_or(is_constant) && is_constant(other) && at.alphabet.is_none();
    let is_listed = at.ages.iter().any(|age| age.topic == topic);
    (is_steady && is_listed).then_some(topic)
}

/// The wiring of some positions, and for each slot that is read the operators that read it; those among them that only compare it with
/// constants, each with its slot and the numbers at which its truth changes.
struct Wired {
    wiring: Wiring,
    slots: Vec<(usize, u64)>,
    /// The topics whose messages make operators due.
    topics: Vec<(usize, u64)>,
    comparisons: Vec<(usize, u64, Vec<f64>)>,
}

fn wire(at: &Positions) -> Option<Wired> {
    if at.ops.len() > BITS {
        return None;
    }
    let wiring = Wiring { readers: alloc::vec![0; at.ops.len()], ..Wiring::default() };
    let mut wired = Wired { wiring, slots: Vec::new(), topics: Vec::new(), comparisons: Vec::new() };
    for (i, op) in at.ops.iter().enumerate() {
        wired.op(at, 1 << i, op);
        wired.comparisons.extend(cuts(at, op).map(|(slot, changes)| (slot, 1 << i, changes)));
    }
    let inner = wired.wiring.readers.iter().fold(0, |all, readers| all | readers);
    // What an age makes due comes with the bounds that run out.
    wired.wiring.leaves = expressions(at) & !inner & !wired.wiring.aged;
    wired.wiring.alphabet = alphabet(at, &wired.wiring);
    Some(wired)
}

/// The operators without a memory that may read signals.
fn expressions(at: &Positions) -> u64 {
    let reads = |op: &Op| matches!(op, Op::Slot { .. } | Op::Event(_) | Op::Holds(_));
    at.ops.iter().enumerate().filter(|(_, op)| reads(op)).fold(0, |all, (i, _)| all | (1 << i))
}

/// The alphabet, where the operators make an automaton.
fn alphabet(at: &Positions, wiring: &Wiring) -> Option<Alphabet> {
    let width = wiring.leaves.count_ones() as usize;
    if width > LETTERS || wiring.aged != 0 {
        return None;
    }
    let places = alloc::vec![0; at.ops.len()];
    let overs = alloc::vec![u64::MAX; at.ops.len()];
    let mut alphabet = Alphabet { width, places, over: overs, timed: wiring.timed };
    let mut next = 1;
    for (i, op) in at.ops.iter().enumerate() {
        match op {
            _ if wiring.leaves & (1 << i) != 0 => {
                alphabet.places[i] = next;
                next <<= 1;
            }
            Op::And(..) | Op::Iff(..) => {}
            Op::OnceWithin(most, _) | Op::SinceWithin(most, ..) => {
                alphabet.over[i] = over(*most);
            }
            _ => return None,
        }
    }
    Some(alphabet)
}

impl Wired {
    /// Notes at the slots what they make due in the group of that number.
    fn wake(&self, at: &Positions, group: usize, slots: &mut [Slot]) {
        for &(number, ops) in &self.slots {
            let Some(slot) = slots.get_mut(number) else { continue };
            slot.wakes.push(Wake { group, ops, letter: self.letter(at, ops) });
            let comparisons = || self.comparisons.iter().filter(|(of, ..)| *of == number);
            let others = comparisons().fold(ops, |others, (_, me, _)| others & !me);
            if others != 0 {
                slot.every.push(Wake { group, ops: others, letter: Wake::NO_LETTER });
            }
            for (_, me, changes) in comparisons() {
                let letter = self.wiring.alphabet.as_ref().map_or(Wake::NO_LETTER, |alphabet| alphabet.letter(*me));
                let wake = Wake { group, ops: *me, letter };
                slot.cuts.extend(changes.iter().map(|&at| Cut { at, wake }));
            }
        }
    }

    /// The letter of a signal that these operators read.
    fn letter(&self, at: &Positions, ops: u64) -> u32 {
        let are_bare = bits(ops).all(|i| matches!(at.ops[i], Op::Slot { .. }));
        let alphabet = self.wiring.alphabet.as_ref().filter(|_| are_bare);
        alphabet.map_or(Wake::NO_LETTER, |alphabet| alphabet.letter(ops))
    }

    /// Notes what makes an operator due; `me` is its bit.
    fn op(&mut self, at: &Positions, me: u64, op: &Op) {
        match op {
            Op::Slot { slot, .. } => self.reads_slot(*slot, me),
            Op::Holds(node) => self.reads_node(at, *node, me),
            Op::And(a, b) | Op::Iff(a, b) => [a, b].into_iter().for_each(|bit| self.reads(bit.register(), me)),
            Op::Previously(of) | Op::Becomes(of) => self.reads(of.register(), me),
            Op::Once(_, of) | Op::OnceWithin(_, of) | Op::Held(_, of) => {
                self.reads(of.register(), me);
                self.wiring.timed |= me;
            }
            Op::Since(_, a, b) | Op::SinceWithin(_, a, b) => {
                [a, b].into_iter().for_each(|bit| self.reads(bit.register(), me));
                self.wiring.timed |= me;
            }
            // What they look back at is due, and so are they until that has settled.
            Op::Delta(node) | Op::Lookback(node, _) if at.alphabet.is_none() => self.reads_node(at, *node, me),
            // An event is over with its instant.
            Op::Event(event) => self.reads_event(at, *event, me),
            // They take in every position.
            Op::Count(..) | Op::Lookback(..) | Op::Delta(_) | Op::Rate(_) | Op::Window(..) => self.is_restless(me),
        }
    }

    fn reads(&mut self, register: usize, me: u64) {
        if let Some(readers) = self.wiring.readers.get_mut(register) {
            *readers |= me;
        }
    }

    fn reads_slot(&mut self, slot: usize, me: u64) {
        match self.slots.iter_mut().find(|(s, _)| *s == slot) {
            Some((_, ops)) => *ops |= me,
            None => self.slots.push((slot, me)),
        }
    }

    fn is_restless(&mut self, me: u64) {
        self.wiring.always |= me;
        self.wiring.restless |= me;
    }

    /// An event is over with its instant. Of one that concerns some instances the others need not know.
    fn reads_event(&mut self, at: &Positions, event: usize, me: u64) {
        self.wiring.always |= me;
        if !at.concerns_some(event) {
            self.wiring.restless |= me;
        }
    }

    /// An expression is due where one of its signals or operators changes, and at every position where something in it may change without
    /// either.
    fn reads_node(&mut self, at: &Positions, node: NodeId, me: u64) {
        let mut nodes = alloc::vec![node];
        while let Some(node) = nodes.pop() {
            let Some(node) = at.nodes.get(node as usize) else { continue };
            match node {
                Node::Slot(slot) => self.reads_slot(*slot, me),
                Node::Bit(bit) => self.reads(bit.register(), me),
                Node::Reg(register) => self.reads(*register as usize, me),
                Node::Compare { .. } if let Some(topic) = aged(at, node) => {
                    self.topics.push((topic, me));
                    self.wiring.timed |= me;
                    self.wiring.aged |= me;
                }
                Node::Event(event) | Node::EventField { event, .. } => self.reads_event(at, *event, me),
                Node::InState { .. }
                | Node::Updated(_)
                | Node::Param(_)
                | Node::Age(_)
                | Node::Frequency(..)
                | Node::Fresh(_) => self.is_restless(me),
                Node::Bool(_) | Node::Num(_) | Node::Str(_) | Node::Var(_) => {}
                Node::Field(of, _) | Node::Index(of, _) | Node::Truth(of) | Node::Neg(of) | Node::Not(of) => {
                    nodes.push(*of);
                }
                Node::Arith(_, a, b) | Node::And(a, b) | Node::Or(a, b) | Node::Iff(a, b) => nodes.extend([a, b]),
                Node::Compare { margin, left, right, .. } | Node::CompareAny { margin, left, right, .. } => {
                    nodes.extend([left, right].into_iter().chain(margin));
                }
                Node::Call(_, args) => nodes.extend(args),
                Node::Any { array, body } => nodes.extend([array, body]),
            }
        }
    }
}
