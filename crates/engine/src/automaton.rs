//! The operators of some positions as a finite automaton: what a change of the signals does to all of them, looked up instead of
//! computed.
//!
//! For `and`, `iff`, and `once` and `since` whose bounds begin where they stand, what follows from the signals depends on a few bits:
//! which operators hold, and of which bounded ones the operand held at the position before. How long ago it held matters at one moment
//! only, when the bound runs out; stamps are kept beside, as the clocks of a timed automaton are (Alur and Dill, 1994). So a move is
//! found by the situation, by the signals that change (the letter), and by the bounds that have run out; those without the latter are
//! kept once they were made, as regular expressions build their automata while they match.
//!
//! The automaton holds nothing that the registers and memories do not say as well: it can be dropped at any time, is not saved, and
//! finds its place again.

use alloc::vec::Vec;

use crate::latest::{Latest, NEVER};
use crate::program::{Alphabet, Bit, Op, bits};

/// So many situations are kept at most, and so many moves; what has more of them is computed wherever one is missing.
const SITUATIONS: usize = 64;
const MOVES: usize = 2048;

/// The place of a situation that is not known.
const NOWHERE: u32 = u32::MAX;

/// Which moves are known, and where it stands.
#[derive(Clone, Debug)]
pub(crate) struct Automaton {
    situations: Vec<Situation>,
    /// By situation, then by letter.
    moves: Vec<Move>,
    /// Where the moves of the situation in which it stands begin, [`NOWHERE`] where that is not known.
    place: u32,
}

impl Default for Automaton {
    fn default() -> Automaton {
        Automaton { situations: Vec::new(), moves: Vec::new(), place: NOWHERE }
    }
}

/// All that tells apart what follows: a bit for each operator.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Situation {
    /// Those that hold.
    word: u64,
    /// Bounded ones whose operand holds. Their stamp is that of the latest position.
    holding: u64,
}

/// What a letter does in a situation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Move {
    /// The operators that hold then.
    pub word: u64,
    /// Bounded ones whose operand holds then.
    holding: u64,
    /// Those whose operand held at the position before for the last time.
    ends: u64,
    /// Those that lose what has been.
    breaks: u64,
    /// The place of the situation that it leads to; [`NOWHERE`] for a move that was not made yet, and where there is no room for another
    /// situation.
    to: u32,
}

const BLANK: Move = Move { word: 0, holding: 0, ends: 0, breaks: 0, to: NOWHERE };

impl Automaton {
    /// The number of the move where the leaves in `letter` change, if it is known; no bound may have run out.
    #[inline]
    pub fn known(&self, letter: u32) -> Option<usize> {
        // A place is a multiple of the number of letters; what is nowhere, or no letter, is beyond all moves.
        let at = (self.place | letter) as usize;
        self.moves.get(at).filter(|known| known.to != NOWHERE).map(|_| at)
    }

    /// Makes a move that is known.
    #[inline]
    pub fn follow(&mut self, known: usize) -> Option<&Move> {
        let made = self.moves.get(known)?;
        self.place = made.to;
        Some(made)
    }

    /// Makes a move that is not known, or that a bound may have to do with.
    #[inline(never)]
    pub fn make(
        &mut self,
        alphabet: &Alphabet,
        ops: &[Op],
        latest: &Latest,
        (old, word): (u64, u64),
        over: u64,
    ) -> Move {
        let from = Situation { word: old, holding: latest.holding[0] };
        let place = self.place(alphabet, from);
        let mut made = from.follow(alphabet, ops, word, over);
        let to = Situation { word: made.word, holding: made.holding };
        made.to = self.place(alphabet, to).map_or(NOWHERE, |to| to as u32);
        // Where nothing has run out the move is the same the next time.
        if over == 0
            && let Some(place) = place
            && let Some(kept) = self.moves.get_mut(place + alphabet.letter(old ^ word) as usize)
        {
            *kept = made;
        }
        self.place = made.to;
        made
    }

    /// Where the moves of a situation begin; a new one as long as there is room.
    fn place(&mut self, alphabet: &Alphabet, of: Situation) -> Option<usize> {
        let known = self.situations.iter().position(|known| *known == of);
        known.map(|number| number << alphabet.width).or_else(|| {
            let letters = 1 << alphabet.width;
            let room = SITUATIONS.min(MOVES / letters);
            if self.situations.len() == room {
                return None;
            }
            // All of it at once: a step does not allocate later.
            self.situations.reserve(room - self.situations.len());
            self.moves.reserve(room * letters - self.moves.len());
            self.situations.push(of);
            self.moves.resize(self.situations.len() * letters, BLANK);
            Some((self.situations.len() - 1) << alphabet.width)
        })
    }
}

impl Situation {
    /// What follows where the letters' registers are as in `letters`, and the bounds of those in `over` have run out.
    fn follow(&self, alphabet: &Alphabet, ops: &[Op], letters: u64, over: u64) -> Move {
        let mut made = BLANK;
        for (i, op) in ops.iter().enumerate() {
            let me = 1 << i;
            let get = |bit: Bit, made: &Move| bit.in_word(made.word);
            let holds = match op {
                _ if alphabet.places[i] != 0 => letters & me != 0,
                Op::And(a, b) => get(*a, &made) & get(*b, &made),
                Op::Iff(a, b) => get(*a, &made) == get(*b, &made),
                Op::OnceWithin(_, of) => self.lasts(me, (true, get(*of, &made)), over, &mut made),
                Op::SinceWithin(_, left, right) => {
                    self.lasts(me, (get(*left, &made), get(*right, &made)), over, &mut made)
                }
                _ => continue,
            };
            made.word |= if holds { me } else { 0 };
        }
        made
    }

    /// A bounded operator: whether it goes on, and whether its operand holds.
    fn lasts(&self, me: u64, (goes_on, of): (bool, bool), over: u64, made: &mut Move) -> bool {
        let (was, held) = (self.word & me != 0, self.holding & me != 0);
        if of {
            made.holding |= me;
            return true;
        }
        if !goes_on {
            made.breaks |= if was || held { me } else { 0 };
            return false;
        }
        made.ends |= me & self.holding;
        (was || held) && over & me == 0
    }
}

impl Move {
    /// What has to be remembered of it.
    #[inline(always)]
    pub fn leave_marks(&self, alphabet: &Alphabet, latest: &mut Latest, before: i64, alarm: &mut i64) {
        latest.holding[0] = self.holding;
        for i in bits(self.ends) {
            latest.stamps[i] = before;
            if self.word & (1 << i) != 0 {
                *alarm = (*alarm).min(before.saturating_add_unsigned(alphabet.over[i]));
            }
        }
        for i in bits(self.breaks) {
            latest.stamps[i] = NEVER;
        }
    }
}

/// The bounded operators of which too much time has passed since their operand held. And when the next of the others runs
/// out.
#[inline(never)]
pub(crate) fn expired(alphabet: &Alphabet, latest: &Latest, (now, before): (i64, i64)) -> (u64, i64) {
    let (mut over, mut alarm) = (0, i64::MAX);
    for i in bits(alphabet.timed) {
        let holds = latest.holding[0] & (1 << i) != 0;
        let since = if holds { before } else { latest.stamps[i] };
        if since == NEVER {
            continue;
        }
        // A distance fits without a sign.
        if now.wrapping_sub(since).cast_unsigned() >= alphabet.over[i] {
            over |= 1 << i;
        } else if !holds {
            alarm = alarm.min(since.saturating_add_unsigned(alphabet.over[i]));
        }
    }
    (over, alarm)
}
