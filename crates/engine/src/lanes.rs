//! What the automaton moves of each instance on the shelf, kept beside its bytes.
//!
//! A signal that a thousand instances read changes for all of them at once. Most do nothing then but make a move of the automaton, which takes
//! a word or two of their state; it is here, so that the rest need not be unpacked and packed again.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use crate::automaton::{Automaton, Place};
use crate::latest::NEVER;
use crate::program::{Alphabet, Group, bits};
use crate::walk::Walk;

/// The lanes of the instances on a shelf, by their numbers. Of one that is not packed it means nothing.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Lanes {
    /// The bounded operators, each of which has a stamp in a lane, as bits.
    timed: u64,
    /// Lane after lane.
    words: Vec<i64>,
}

/// The words of a lane: the registers, the bounded operators whose operand holds, the time at which a bound runs out; then the stamps.
const WORD: usize = 0;
const HOLDING: usize = 1;
const ALARM: usize = 2;
const STAMPS: usize = 3;

/// What the signals are at an instant, as far as it is the same for all instances.
#[derive(Clone, Copy)]
pub(crate) struct Shared {
    /// The operators that read nothing else, of those that are due.
    mask: u64,
    /// Those of them that hold.
    word: u64,
}

impl Shared {
    /// The operators that this instant makes due, where they read nothing but signals.
    pub fn mask(plan: &Group, due: u64) -> Option<u64> {
        let wiring = plan.at.wiring.as_ref().filter(|wiring| wiring.alphabet.is_some())?;
        let leaves = wiring.leaves & !wiring.always;
        (due != 0 && due & !leaves == 0).then_some(due)
    }

    /// What they are to one that has just been stepped. `None` where it had no position.
    pub fn of(mask: u64, walk: &Walk, now: i64) -> Option<Shared> {
        (walk.last == Some(now)).then(|| Shared { mask, word: walk.word() & mask })
    }
}

impl Lanes {
    /// No lane yet. `None` for a group that neither rests nor idles, or is no automaton.
    pub fn new(plan: &Group) -> Option<Lanes> {
        let alphabet = plan.alphabet().filter(|_| plan.rests || plan.idles)?;
        Some(Lanes { timed: alphabet.timed, words: Vec::new() })
    }

    /// Takes over from a walk what a lane has; what the walk has then takes no room when it is packed.
    pub fn take(&mut self, number: usize, walk: &mut Walk) {
        let (timed, width) = (self.timed, self.width());
        if self.words.len() < (number + 1) * width {
            self.words.resize((number + 1) * width, 0);
        }
        let Some(lane) = self.lane(number) else { return };
        lane[WORD] = core::mem::take(&mut walk.registers.bits[0]).cast_signed();
        lane[HOLDING] = core::mem::take(&mut walk.latest.holding[0]).cast_signed();
        lane[ALARM] = core::mem::replace(&mut walk.alarm, i64::MAX);
        for (to, i) in lane[STAMPS..].iter_mut().zip(bits(timed)) {
            *to = core::mem::replace(&mut walk.latest.stamps[i], NEVER);
        }
    }

    /// Gives a walk what its lane has.
    pub fn give(&self, number: usize, walk: &mut Walk) {
        let width = self.width();
        let Some(lane) = self.words.get(number * width..(number + 1) * width) else { return };
        walk.registers.bits[0] = lane[WORD].cast_unsigned();
        walk.latest.holding[0] = lane[HOLDING].cast_unsigned();
        walk.alarm = lane[ALARM];
        for (from, i) in lane[STAMPS..].iter().zip(bits(self.timed)) {
            walk.latest.stamps[i] = *from;
        }
    }

    /// Another instance begins where this one stands.
    pub fn add_like(&mut self, number: usize, new: usize) {
        let width = self.width();
        self.words.resize(new * width, 0);
        match self.words.len() >= (number + 1) * width {
            true => self.words.extend_from_within(number * width..(number + 1) * width),
            false => self.words.resize((new + 1) * width, 0),
        }
    }

    /// Makes the move of one that lies still, at an instant that changes nothing that is heard and at which no bound runs out, where the move
    /// is known. Gives until when it lies still then; else nothing has happened. The instant before it was at `before`.
    #[inline]
    pub fn glide(
        &mut self,
        number: usize,
        (place, automaton): (&mut Place, &Automaton),
        (alphabet, heard): (&Alphabet, u64),
        shared: Shared,
        (now, before): (i64, i64),
    ) -> Option<i64> {
        let timed = self.timed;
        let lane = self.lane(number)?;
        let word = lane[WORD].cast_unsigned();
        let toggled = (word ^ shared.word) & shared.mask;
        let known = automaton.known(*place, alphabet.letter(toggled))?;
        let quiet_until = known.alarm(before, lane[ALARM]);
        if now >= quiet_until || (known.word ^ word) & heard != 0 {
            return None;
        }
        (lane[WORD], lane[ALARM]) = (known.word.cast_signed(), quiet_until);
        let stamp_of = |i: usize| STAMPS + (timed & ((1 << i) - 1)).count_ones() as usize;
        lane[HOLDING] = known.leave_marks(before, |i, stamp| lane[stamp_of(i)] = stamp).cast_signed();
        *place = known.to;
        Some(quiet_until)
    }

    fn width(&self) -> usize {
        STAMPS + self.timed.count_ones() as usize
    }

    #[inline]
    fn lane(&mut self, number: usize) -> Option<&mut [i64]> {
        let width = self.width();
        self.words.get_mut(number * width..(number + 1) * width)
    }
}
