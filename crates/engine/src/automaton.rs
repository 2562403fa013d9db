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
//! a walk finds its place again. Instances of the same properties share one.

use alloc::vec::Vec;

use crate::latest::{Latest, NEVER, has_run_out, runs_out};
use crate::program::{Alphabet, Bit, Op, bits};

/// So many situations are kept at most, and so many moves; what has more of them is computed wherever one is missing.
const SITUATIONS: usize = 64;
const MOVES: usize = 2048;

/// Which situations and moves are known.
#[derive(Clone, Debug, Default)]
pub(crate) struct Automaton {
    situations: Vec<Situation>,
    /// By situation, then by letter.
    moves: Vec<Move>,
}

/// Where the moves of a situation begin; [`Place::NOWHERE`] of one that is not known.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Place(u32);

impl Place {
    const NOWHERE: Place = Place(u32::MAX);

    /// The number of a letter's move from here. Places are multiples of the number of letters; what is nowhere, or no letter, is beyond all
    /// moves.
    #[inline]
    fn number(self, letter: u32) -> usize {
        (self.0 | letter) as usize
    }
}

impl Default for Place {
    fn default() -> Place {
        Place::NOWHERE
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
    /// The distance from the position before at which the first bound of `ends` will have run out; [`i64::MAX`] for never.
    wait: i64,
    /// Whether no bounds run on but those: nothing else is waited for then.
    afresh: bool,
    /// Where it leads to: nowhere for a move that was not made yet, and where there is no room for another situation.
    pub to: Place,
}

const BLANK: Move = Move { word: 0, holding: 0, ends: 0, breaks: 0, wait: i64::MAX, afresh: false, to: Place::NOWHERE };

impl Automaton {
    /// The move from a place where the leaves in `letter` change, if it is known. It holds as long as no bound has run out, of those that
    /// run on neither before it nor after.
    #[inline]
    pub fn known(&self, place: Place, letter: u32) -> Option<&Move> {
        self.moves.get(place.number(letter)).filter(|known| known.to != Place::NOWHERE)
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
        made.to = self.place(alphabet, to);
        // Where nothing has run out the move is the same the next time.
        if over == 0
            && let Some(kept) = self.moves.get_mut(place.number(alphabet.letter(old ^ word)))
        {
            *kept = made;
        }
        made
    }

    /// Where a situation is; a new one has a place as long as there is room.
    fn place(&mut self, alphabet: &Alphabet, of: Situation) -> Place {
        let letters = 1 << alphabet.width;
        let number = self.situations.iter().position(|known| *known == of).unwrap_or(self.situations.len());
        if number == self.situations.len() {
            let room = SITUATIONS.min(MOVES / letters);
            if number == room {
                return Place::NOWHERE;
            }
            // All of it at once: a step does not allocate later.
            self.situations.reserve(room - number);
            self.moves.reserve(room * letters - self.moves.len());
            self.situations.push(of);
            self.moves.resize((number + 1) * letters, BLANK);
        }
        Place((number * letters) as u32)
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
        let over = bits(made.ends & made.word).map(|i| alphabet.over[i]).min();
        made.wait = over.and_then(|over| i64::try_from(over).ok()).unwrap_or(i64::MAX);
        made.afresh = made.word & alphabet.timed & !made.holding & !made.ends == 0;
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
    /// When the next bound runs out that runs on then, `alarm` having been when that was before. Whoever never runs out may be looked at in
    /// some hundred years all the same.
    #[inline(always)]
    pub fn alarm(&self, before: i64, alarm: i64) -> i64 {
        before.checked_add(self.wait).unwrap_or(i64::MAX).min(if self.afresh { i64::MAX } else { alarm })
    }

    /// What has to be remembered of it: sets the stamps of operators, and gives those whose operand holds.
    #[inline(always)]
    pub fn leave_marks(&self, before: i64, mut set: impl FnMut(usize, i64)) -> u64 {
        bits(self.ends).for_each(|i| set(i, before));
        bits(self.breaks).for_each(|i| set(i, NEVER));
        self.holding
    }
}

/// The bounded operators of which too much time has passed since their operand held, and when the next of the others runs out.
#[inline(never)]
pub(crate) fn expired(alphabet: &Alphabet, latest: &Latest, (now, before): (i64, i64)) -> (u64, i64) {
    let (mut over, mut alarm) = (0, i64::MAX);
    for i in bits(alphabet.timed) {
        let holds = latest.holding[0] & (1 << i) != 0;
        let since = if holds { before } else { latest.stamps[i] };
        if since == NEVER {
            continue;
        }
        if has_run_out(now, since, alphabet.over[i]) {
            over |= 1 << i;
        } else if !holds {
            alarm = alarm.min(runs_out(since, alphabet.over[i]));
        }
    }
    (over, alarm)
}
