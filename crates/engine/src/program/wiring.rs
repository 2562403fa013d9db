//! What makes each operator due: the signals and operators that it reads, and time.

use alloc::vec::Vec;

use super::{At, Group, Node, NodeId, Op, Positions, Program};

/// So many operators have a bit each. Where there are more, all of them run at every position.
const BITS: usize = u64::BITS as usize;

/// Which operators of some positions become due by what, as bits by their numbers.
#[derive(Clone, Debug, Default)]
pub struct Wiring {
    /// For each operator, those that read it.
    pub readers: Vec<u64>,
    /// Those that are due at every position.
    pub always: u64,
    /// Those of which a bound may run out.
    pub timed: u64,
}

/// Operators of a group that read a signal.
#[derive(Clone, Copy, Debug)]
pub struct Wake {
    /// The number of the group.
    pub group: usize,
    /// The operators, as bits.
    pub ops: u64,
}

impl Program {
    /// Fills in what follows from the rest of the program. To be called once all of it is there; without it everything runs at every
    /// position.
    pub fn link(&mut self) {
        self.slots.iter_mut().for_each(|slot| slot.wakes.clear());
        for (number, group) in self.groups.iter_mut().enumerate() {
            let wired = wire(&group.at);
            for (slot, ops) in wired.iter().flat_map(|w| w.slots.iter().copied()) {
                if let Some(slot) = self.slots.get_mut(slot) {
                    slot.wakes.push(Wake { group: number, ops });
                }
            }
            group.at.wiring = wired.map(|w| w.wiring);
            group.rests = group.may_rest();
        }
        for column in &mut self.columns {
            column.wakes = self.slots.get(column.slot).map(|slot| slot.wakes.clone()).unwrap_or_default();
        }
    }

    /// Whether something asks how often a signal got a value.
    pub(crate) fn counts_values(&self) -> bool {
        let groups = self.groups.iter().map(|g| &g.at);
        let all = groups.chain(self.machines.iter().map(|m| &m.at));
        all.flat_map(|at| &at.nodes).any(|node| matches!(node, Node::Updated(_)))
    }
}

impl Group {
    /// Whether, where no operator is due, a position need only be counted.
    fn may_rest(&self) -> bool {
        let untimed = self.at.alphabet.is_none() && self.at.ages.is_empty() && self.at.slices.is_empty();
        // An obligation that stops arising at some distance from the start would be a change that nothing announces.
        let steady = self.trackers.iter().all(|t| matches!(t.at, At::First | At::All));
        let still = self.at.wiring.as_ref().is_some_and(|wiring| wiring.always == 0);
        self.is_plain() && untimed && steady && still
    }
}

/// The wiring of some positions, and for each slot that is read the operators that read it.
struct Wired {
    wiring: Wiring,
    slots: Vec<(usize, u64)>,
}

fn wire(at: &Positions) -> Option<Wired> {
    if at.ops.len() > BITS {
        return None;
    }
    let wiring = Wiring { readers: alloc::vec![0; at.ops.len()], ..Wiring::default() };
    let mut wired = Wired { wiring, slots: Vec::new() };
    for (i, op) in at.ops.iter().enumerate() {
        wired.op(at, 1 << i, op);
    }
    Some(wired)
}

impl Wired {
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
            // They take in every position.
            Op::Count(..) | Op::Lookback(..) | Op::Delta(_) | Op::Rate(_) | Op::Window(..) => self.wiring.always |= me,
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

    /// An expression is due where one of its signals or operators changes, and at every position where something in it may change without
    /// either.
    fn reads_node(&mut self, at: &Positions, node: NodeId, me: u64) {
        let mut nodes = alloc::vec![node];
        while let Some(node) = nodes.pop() {
            let Some(node) = at.nodes.get(node as usize) else { continue };
            match node {
                Node::Slot(slot) => self.reads_slot(*slot, me),
                Node::Bit(bit) => self.reads(bit.register(), me),
                // A value is filled anew at every position.
                Node::Reg(_)
                | Node::Event(_)
                | Node::EventField { .. }
                | Node::InState { .. }
                | Node::Updated(_)
                | Node::Param(_)
                | Node::Age(_)
                | Node::Frequency(..)
                | Node::Fresh(_) => self.wiring.always |= me,
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
