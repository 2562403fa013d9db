//! Margins of formulas without future operators, position by position. NaN stands for "nothing to count" and is skipped.

use alloc::collections::VecDeque;
use alloc::vec::Vec;

use lapwing_stream::Duration;
use serde::{Deserialize, Serialize};

use super::peak::Peak;
use super::plan::Op;
use super::{IMPOSSIBLE, certain, opposite};
use crate::node::{Val, View};
use crate::program::{Bound, Compare, NodeId};

/// What a step of the code remembers.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) enum Memory {
    None,
    /// The margin at the position before.
    Before(Option<f64>),
    /// The latest margins, a ring: `at` is the oldest.
    Ring {
        values: Vec<f64>,
        at: usize,
    },
    /// The margins that have not reached the lower end of the bound, and those that have.
    Once {
        pending: VecDeque<(i64, f64)>,
        reached: Peak,
    },
    /// The best way to have `left since right`, and whether one stands on a right margin that was skipped.
    Since {
        best: f64,
        is_blank: bool,
    },
    /// The same within a bound: each way by the stamp of its right side.
    Ways(VecDeque<(i64, f64)>),
    /// The stamp of position 0; the stamps in the window, from the position with that number on; the margins, negated.
    Held {
        began: Option<i64>,
        stamps: VecDeque<i64>,
        first: i64,
        worst: Peak,
    },
}

impl Memory {
    /// The memory of a step that has seen nothing.
    pub fn new(op: &Op) -> Memory {
        match op {
            Op::Previously(_) | Op::Becomes(_) => Memory::Before(None),
            Op::Lookback(_, depth) => Memory::Ring { values: alloc::vec![f64::NAN; *depth], at: 0 },
            Op::Once(..) => Memory::Once { pending: VecDeque::new(), reached: Peak::default() },
            Op::Since(Bound::ALL, ..) => Memory::Since { best: IMPOSSIBLE, is_blank: false },
            Op::Since(..) => Memory::Ways(VecDeque::new()),
            Op::Held(..) => Memory::Held { began: None, stamps: VecDeque::new(), first: 0, worst: Peak::default() },
            Op::Distance { .. } | Op::Holds(_) | Op::Not(_) | Op::And(..) | Op::Or(..) => Memory::None,
        }
    }
}

/// Before the first instant: what looks back further than there are instants finds what is computed here.
pub(super) fn prime(ops: &[Op], memories: &mut [Memory], registers: &mut [f64], view: &View<'_>) {
    for (i, (op, memory)) in ops.iter().zip(memories).enumerate() {
        if let (Op::Lookback(of, _), Memory::Ring { values, .. }) = (op, &mut *memory) {
            values.fill(registers[*of as usize]);
        }
        registers[i] = step(op, memory, registers, view, false);
    }
}

/// Runs the code at an instant. Before position 0 (`is_position` is false) only lookback remembers, as with truth values.
pub(super) fn run(ops: &[Op], memories: &mut [Memory], registers: &mut [f64], view: &View<'_>, is_position: bool) {
    for (i, (op, memory)) in ops.iter().zip(memories).enumerate() {
        registers[i] = step(op, memory, registers, view, is_position);
    }
}

fn step(op: &Op, memory: &mut Memory, registers: &[f64], view: &View<'_>, is_position: bool) -> f64 {
    let of = |reg: u32| registers[reg as usize];
    match (op, memory) {
        (Op::Distance { op, margin, left, right, holds }, _) => {
            let sides = number(view, *left).zip(number(view, *right));
            match sides.zip(margin.map_or(Some(0.0), |m| number(view, m))) {
                Some(((a, b), m)) => distance(*op, m, a, b),
                None => certain(view.holds(*holds)),
            }
        }
        (Op::Holds(node), _) => certain(view.holds(*node)),
        (Op::Not(a), _) => opposite(of(*a)),
        (Op::And(a, b), _) => of(*a).min(of(*b)),
        (Op::Or(a, b), _) => of(*a).max(of(*b)),
        (Op::Lookback(a, _), Memory::Ring { values, at }) => look_back(of(*a), values, at),
        _ if !is_position => IMPOSSIBLE,
        (Op::Previously(a), Memory::Before(before)) => before.replace(of(*a)).unwrap_or(IMPOSSIBLE),
        (Op::Becomes(a), Memory::Before(before)) => match before.replace(of(*a)) {
            Some(before) => of(*a).min(opposite(before)),
            None => of(*a),
        },
        (Op::Once(bound, a), Memory::Once { pending, reached }) => once(bound, view.now, of(*a), pending, reached),
        (Op::Since(_, a, b), Memory::Since { best, is_blank }) => since(of(*a), of(*b), best, is_blank),
        (Op::Since(bound, a, b), Memory::Ways(ways)) => since_within(bound, view.now, of(*a), of(*b), ways),
        (Op::Held(duration, a), memory) => held(*duration, view.now, of(*a), memory),
        _ => f64::NAN,
    }
}

/// A number that is there, be it NaN.
fn number(view: &View<'_>, node: NodeId) -> Option<f64> {
    match view.value(node) {
        Val::Num(x) if view.is_there(node) => Some(x),
        _ => None,
    }
}

/// The signed distance of a comparison to changing.
fn distance(op: Compare, m: f64, a: f64, b: f64) -> f64 {
    // Equal infinities are equal.
    let gap = if a == b { 0.0 } else { (a - b).abs() };
    match op {
        Compare::Lt | Compare::Le => b + m - a,
        Compare::Gt | Compare::Ge => a - b + m,
        Compare::Eq => m - gap,
        Compare::Ne => gap - m,
    }
}

fn look_back(now: f64, values: &mut [f64], at: &mut usize) -> f64 {
    let Some(oldest) = values.get_mut(*at) else { return now };
    let then = core::mem::replace(oldest, now);
    *at = (*at + 1) % values.len();
    then
}

fn once(bound: &Bound, now: i64, value: f64, pending: &mut VecDeque<(i64, f64)>, reached: &mut Peak) -> f64 {
    pending.push_back((now, value));
    while let Some(&(stamp, value)) = pending.front().filter(|(stamp, _)| bound.begun(now.saturating_sub(*stamp))) {
        if bound.has_end() {
            reached.push(stamp, value)
        } else {
            reached.raise(value)
        }
        pending.pop_front();
    }
    if bound.has_end() {
        reached.forget(|stamp| !bound.not_over(now.saturating_sub(stamp)));
    }
    reached.greatest().max(IMPOSSIBLE)
}

/// Every way so far is as good as its worst left side since; a skipped right side leaves the left sides alone to count.
fn since(left: f64, right: f64, best: &mut f64, is_blank: &mut bool) -> f64 {
    if !left.is_nan() {
        *best = if *is_blank { left } else { best.min(left) };
        *is_blank = false;
    }
    *is_blank |= right.is_nan();
    *best = best.max(right);
    *best
}

// PERF: linear in the number of positions within the bound.
fn since_within(bound: &Bound, now: i64, left: f64, right: f64, ways: &mut VecDeque<(i64, f64)>) -> f64 {
    ways.iter_mut().for_each(|(_, way)| *way = way.min(left));
    if bound.begun(0) {
        // A later way that is as good stays for longer.
        while ways.back().is_some_and(|&(_, way)| way <= right) {
            ways.pop_back();
        }
    }
    ways.push_back((now, right));
    while ways.front().is_some_and(|&(stamp, _)| !bound.not_over(now.saturating_sub(stamp))) {
        ways.pop_front();
    }
    let begun = ways.iter().filter(|(stamp, _)| bound.begun(now.saturating_sub(*stamp)));
    begun.fold(IMPOSSIBLE, |best, (_, way)| best.max(*way))
}

/// The least over the positions within the duration and the last one before them.
fn held(duration: Duration, now: i64, value: f64, memory: &mut Memory) -> f64 {
    let Memory::Held { began, stamps, first, worst } = memory else { return f64::NAN };
    let from = now.saturating_sub(duration.nanos());
    worst.push(*first + stamps.len() as i64, opposite(value));
    stamps.push_back(now);
    while let (Some(&oldest), Some(&next)) = (stamps.front(), stamps.get(1))
        && oldest < from
        && next <= from
    {
        stamps.pop_front();
        *first += 1;
    }
    worst.forget(|place| place < *first);
    if *began.get_or_insert(now) <= from { opposite(worst.greatest()) } else { IMPOSSIBLE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comparisons_by_their_distance_to_changing() {
        assert!((distance(Compare::Le, 0.0, 2.31, 2.0) + 0.31).abs() < 1e-12);
        assert_eq!(distance(Compare::Gt, 0.5, 1.0, 2.0), -0.5);
        assert_eq!(distance(Compare::Eq, 0.25, 1.0, 2.0), -0.75);
        assert_eq!(distance(Compare::Ne, 0.25, 1.0, 2.0), 0.75);
        assert!(distance(Compare::Lt, 0.0, f64::NAN, 2.0).is_nan());
    }

    #[test]
    fn since_forgets_no_break_of_its_left_operand() {
        let (mut best, mut is_blank, mut ways) = (IMPOSSIBLE, false, VecDeque::new());
        let within = Bound { hi: 100, ..Bound::ALL };
        for (now, (left, right, expected)) in
            [(5.0, 2.0, 2.0), (1.0, -3.0, 1.0), (4.0, -2.0, 1.0)].into_iter().enumerate()
        {
            assert_eq!(since(left, right, &mut best, &mut is_blank), expected);
            assert_eq!(since_within(&within, now as i64, left, right, &mut ways), expected);
        }
    }
}
