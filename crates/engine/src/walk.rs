//! The walk of a machine or a group through its positions: when they begin, and which operators a position makes due.
//!
//! An operator is evaluated where one of its operands changed, where a bound of it runs out, and at the position after if it says so;
//! everywhere else it keeps its value. So a position costs what changed at it, not what there is.

use alloc::boxed::Box;
use alloc::vec::Vec;
use core::cell::Cell;

use serde::{Deserialize, Serialize};

use crate::automaton::{Automaton, Place, expired};
use crate::inputs::Inputs;
use crate::latest::Latest;
use crate::node::{Notes, View};
use crate::pack::packed;
use crate::past::{self, Here, Memory, NOW, Registers, Scene, Stepped};
use crate::program::{Alphabet, Op, Positions, Wiring, bits};

/// Where a machine or a group stands in its positions.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Walk {
    /// Whether position 0 has come.
    pub started: bool,
    /// For how many instants each read has been defined.
    waited: Box<[usize]>,
    /// What the code has computed.
    pub registers: Registers,
    memories: Box<[Memory]>,
    pub(crate) latest: Latest,
    /// The stamp of the latest position.
    pub last: Option<i64>,
    /// The operators that are due at the next position, whatever comes.
    again: u64,
    /// The first position with this stamp or a later one makes all timed operators due.
    pub(crate) alarm: i64,
    pub notes: Notes,
    /// The operators that met a value of another kind than they need: what they say from then on means nothing.
    pub faults: Vec<usize>,
    /// When the first of them did, and with which signal, where that is known.
    pub culprit: Option<(i64, Option<usize>)>,
    /// Where it stands in the automaton that the operators are, where they are one.
    #[serde(skip)]
    pub(crate) place: Place,
    /// For each comparison of an age: the message that its flips count from, and the next flip.
    flips: Box<[(Option<i64>, usize)]>,
}

packed!(Walk { started, waited, registers, memories, latest, last, again, alarm, notes, faults, culprit, flips } without { place });

/// A move that was made.
pub(crate) struct Glide {
    /// The word of all registers before it, and after.
    pub from: u64,
    pub to: u64,
    /// Before when nothing is due as long as no signal changes.
    pub quiet_until: i64,
}

impl Walk {
    /// `inputs` are those before anything has come.
    pub fn new(at: &Positions, inputs: &Inputs, counters: usize) -> Walk {
        let mut walk = Walk::blank(at, counters);
        let Walk { registers, memories, notes, .. } = &mut walk;
        let here = Here { at, inputs, now: 0, params: &[], seen: &inputs.versions };
        past::prime(&Scene { here, before: None, notes }, memories, registers);
        walk.notes = Notes::new(counters);
        walk
    }

    /// Position 0 is still to come. What was remarked stands.
    pub fn start_afresh(&mut self, at: &Positions, inputs: &Inputs) {
        let fresh = Walk::new(at, inputs, self.notes.nans.len());
        let (notes, faults) = (core::mem::take(&mut self.notes), core::mem::take(&mut self.faults));
        *self = Walk { notes, faults, culprit: self.culprit, ..fresh };
    }

    fn blank(at: &Positions, counters: usize) -> Walk {
        Walk {
            started: false,
            waited: alloc::vec![0; at.reads.len()].into(),
            registers: Registers::new(at.ops.len()),
            memories: at.ops.iter().map(Memory::new).collect(),
            latest: Latest::new(at.ops.len()),
            last: None,
            again: 0,
            alarm: i64::MAX,
            notes: Notes::new(counters),
            faults: Vec::new(),
            culprit: None,
            place: Place::default(),
            flips: alloc::vec![(None, 0); at.ages.len()].into(),
        }
    }

    /// Takes an instant in, at which signals that changed made operators due; whether it is a position.
    pub fn enter(&mut self, automaton: &mut Automaton, here: Here<'_>, due: u64) -> bool {
        if let Some(alphabet) = &here.at.alphabet {
            if !self.occurs(alphabet, here) {
                return false;
            }
            self.started = true;
        } else if !self.started {
            self.started = self.is_ready(here.at, here.inputs);
        }
        if self.started {
            self.run(automaton, here, due);
        } else {
            let Walk { registers, memories, notes, .. } = self;
            past::look(&Scene { here, before: None, notes }, memories, registers);
            self.notes.nans.iter().for_each(|n| n.set(0));
            self.notes.fault.set(false);
            self.notes.culprit.set(None);
        }
        self.started
    }

    /// Whether one of these events occurs at this instant.
    fn occurs(&mut self, events: &[usize], here: Here<'_>) -> bool {
        let mut occurs = false;
        for &event in events {
            occurs |= match here.occurs(event) {
                Some(occurs) => occurs,
                None => {
                    if here.inputs.is_unclear(event) {
                        self.faults = (0..here.at.ops.len()).collect();
                        self.culprit.get_or_insert((here.now, None));
                    }
                    self.view(here).occurrence(event).is_some()
                }
            };
        }
        occurs
    }

    /// Runs what is due at a position.
    #[inline]
    pub fn run(&mut self, automaton: &mut Automaton, here: Here<'_>, due: u64) {
        match &here.at.wiring {
            Some(wiring) if let Some(before) = self.last => self.run_due(automaton, here, wiring, before, due),
            _ => self.run_all(here),
        }
        self.last = Some(here.now);
    }

    /// Whether nothing is due at a position but what signals make so. The position before is at `before`.
    #[inline]
    pub fn is_quiet(&mut self, alphabet: &Alphabet, now: i64, before: i64) -> bool {
        if self.again == 0 && now >= self.alarm {
            let (over, next) = expired(alphabet, &self.latest, (now, before));
            if over == 0 {
                self.alarm = next;
            }
        }
        now < self.quiet_until()
    }

    /// Makes the automaton's move for a position at which nothing is due but what makes the letter, where it is known and no bound has run out.
    /// Else nothing has happened.
    // PERF: the signals of most logical formulas are truth values, and most of their moves have been made before.
    #[inline(always)]
    pub fn glide(&mut self, automaton: &Automaton, letter: u32, now: i64, before: i64) -> Option<Glide> {
        let Walk { place, latest, alarm, registers, .. } = self;
        let known = automaton.known(*place, letter)?;
        let quiet_until = known.alarm(before, *alarm);
        if now >= quiet_until {
            return None;
        }
        latest.holding[0] = known.leave_marks(before, |i, stamp| latest.stamps[i] = stamp);
        (*alarm, *place) = (quiet_until, known.to);
        let from = core::mem::replace(&mut registers.bits[0], known.word);
        Some(Glide { from, to: known.word, quiet_until })
    }

    /// Runs what is due. All truth values are in one word.
    #[inline]
    fn run_due(&mut self, automaton: &mut Automaton, here: Here<'_>, wiring: &Wiring, before: i64, due: u64) {
        let due = due | core::mem::take(&mut self.again) | wiring.always;
        let old = self.registers.bits[0];
        // What reads nothing but signals comes first; nothing else decides what is due then.
        let leaves = self.sweep(here, old, due & wiring.leaves, |_| 0);
        self.registers.bits[0] = match &wiring.alphabet {
            Some(alphabet) => self.go(automaton, here, alphabet, before, (old, leaves)),
            None => {
                let mut due = due & !wiring.leaves;
                if here.now >= self.alarm {
                    due |= wiring.timed;
                    self.alarm = i64::MAX;
                }
                due |= bits(old ^ leaves).fold(0, |all, leaf| all | wiring.readers[leaf]);
                self.sweep(here, leaves, due, |changed| wiring.readers[changed])
            }
        };
    }

    /// What the automaton makes of a position at which the leaves are as in `leaves`, the registers having been `old`.
    #[inline(never)]
    fn go(
        &mut self,
        automaton: &mut Automaton,
        here: Here<'_>,
        alphabet: &Alphabet,
        before: i64,
        (old, leaves): (u64, u64),
    ) -> u64 {
        let letter = alphabet.letter(old ^ leaves);
        if self.is_quiet(alphabet, here.now, before)
            && let Some(glided) = self.glide(automaton, letter, here.now, before)
        {
            return glided.to;
        }
        let Walk { place, latest, alarm, .. } = self;
        let (over, next) = expired(alphabet, latest, (here.now, before));
        *alarm = next;
        let made = automaton.make(alphabet, &here.at.ops, latest, (old, leaves), over);
        latest.holding[0] = made.leave_marks(before, |i, stamp| latest.stamps[i] = stamp);
        (*alarm, *place) = (made.alarm(before, *alarm), made.to);
        made.word
    }

    /// Evaluates operators in their order; `follow` tells which others the change of one makes due. Gives the word of all registers then.
    #[inline(always)]
    fn sweep(&mut self, here: Here<'_>, mut word: u64, mut due: u64, follow: impl Fn(usize) -> u64) -> u64 {
        let ops = &here.at.ops[..];
        let mut alarm = self.alarm;
        while due != 0 {
            let i = due.trailing_zeros() as usize;
            due &= due - 1;
            let quick =
                past::quick((i, &ops[i]), &mut self.latest, &here, self.last, &mut alarm, |of| of.in_word(word));
            let (bit, has_moved) = quick.map(|bit| (bit, false)).unwrap_or_else(|| {
                let Stepped { holds, next, has_moved } = self.step(i, word, here);
                self.again |= u64::from(next == NOW) << i;
                alarm = if next == NOW { alarm } else { alarm.min(next) };
                (holds, has_moved)
            });
            let is_other = ((word >> i) & 1 == 1) != bit;
            word ^= u64::from(is_other) << i;
            if is_other | has_moved {
                due |= follow(i);
            }
        }
        self.alarm = alarm;
        word
    }

    /// Evaluates an operator that is not quick.
    #[inline(never)]
    fn step(&mut self, i: usize, word: u64, here: Here<'_>) -> Stepped {
        let op = &here.at.ops[i];
        let scene = Scene { here, before: self.last, notes: &self.notes };
        // PERF: what a logical formula does not say with truth values is an expression, nearly always.
        let stepped = if let Op::Holds(node) = op {
            Stepped::truth(past::expression((i, *node), &scene, &[word], &self.registers.values))
        } else {
            let memory = &mut self.memories[i];
            if let Some(known) = past::delayed(op, memory, here.now, |of| of.in_word(word)) {
                return known;
            }
            past::slow((i, op), memory, &scene, &[word], &mut self.registers.values)
        };
        note_fault(&self.notes, (&mut self.faults, &mut self.culprit), i, here.now);
        stepped
    }

    /// Runs everything: at position 0, and where there is more than can be kept account of.
    #[inline(never)]
    fn run_all(&mut self, here: Here<'_>) {
        let Walk { registers, memories, latest, notes, again, alarm, faults, culprit, .. } = self;
        let Registers { bits, values } = registers;
        let scene = Scene { here, before: self.last, notes };
        (*again, *alarm) = (0, i64::MAX);
        for (i, memory) in memories.iter_mut().enumerate() {
            let Stepped { holds, next, .. } = past::step(i, (memory, latest), &scene, bits, values);
            past::set(bits, i, holds);
            note_fault(notes, (faults, culprit), i, here.now);
            match next {
                NOW => *again |= 1_u64.checked_shl(i as u32).unwrap_or(0),
                next => *alarm = (*alarm).min(next),
            }
        }
    }

    /// How much there was to remark of what was evaluated.
    pub fn remarks(&self) -> u64 {
        self.faults.len() as u64 + self.notes.nans.iter().map(Cell::get).sum::<u64>()
    }

    /// The truth values of the first sixty-four operators.
    #[inline]
    pub fn word(&self) -> u64 {
        self.registers.bits[0]
    }

    /// Positions up to this time were passed over.
    #[inline]
    pub fn pass_over(&mut self, until: i64) {
        self.last = self.last.max(Some(until));
    }

    /// Before when nothing is due as long as no signal changes.
    #[inline]
    pub fn quiet_until(&self) -> i64 {
        if self.again == 0 { self.alarm } else { NOW }
    }

    /// Whether everything has been defined for long enough.
    fn is_ready(&mut self, at: &Positions, inputs: &Inputs) -> bool {
        let mut ready = true;
        for ((read, depth), waited) in at.reads.iter().zip(&mut *self.waited) {
            *waited += usize::from(inputs.defined(*read));
            ready &= *waited > *depth;
        }
        ready
    }

    /// The reads that are still missing.
    pub fn missing(&self, at: &Positions) -> impl Iterator<Item = usize> {
        self.waited.iter().zip(&at.reads).enumerate().filter(|(_, (w, (_, depth)))| *w <= depth).map(|(i, _)| i)
    }

    pub fn view<'a>(&'a self, here: Here<'a>) -> View<'a> {
        let Registers { bits, values } = &self.registers;
        Scene { here, before: self.last, notes: &self.notes }.view(bits, values)
    }

    /// The next time at which a comparison of an age changes its value.
    pub fn next_flip(&mut self, at: &Positions, inputs: &Inputs) -> Option<i64> {
        let mut next: Option<i64> = None;
        for (age, (since, i)) in at.ages.iter().zip(&mut *self.flips) {
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
        for (age, (since, i)) in at.ages.iter().zip(&mut *self.flips) {
            while let (Some(last), Some(after)) = (*since, age.after.get(*i)) {
                if last.saturating_add(after.nanos()) > until {
                    break;
                }
                *i += 1;
            }
        }
    }
}

/// Remembers that an operator met a fault, where it did.
#[inline]
fn note_fault(
    notes: &Notes,
    (faults, culprit): (&mut Vec<usize>, &mut Option<(i64, Option<usize>)>),
    op: usize,
    now: i64,
) {
    if notes.fault.take() {
        let signal = notes.culprit.take();
        culprit.get_or_insert((now, signal));
        if !faults.contains(&op) {
            faults.push(op);
        }
    }
}
