//! Which of several possible moves is made, and when: by lot, or as soon as possible.
//!
//! Lots are drawn with the generator PCG XSL RR 128/64 (M. O'Neill, *PCG: A Family of Simple Fast Space-Efficient Statistically Good
//! Algorithms for Random Number Generation*, 2014): the same seed gives the same run, on every machine and in every version.

use crate::engine::{Engine, MoveId, MoveKind, Offer};
use crate::time::{Time, Window};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::Rng;

/// How moments and moves are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Schedule {
    /// Each move is planned for its first possible moment, not for one that is drawn.
    pub asap: bool,
    /// The move is made that is possible first, not the one that is planned first.
    pub first_enabled: bool,
}

/// Chooses moves by lot.
#[derive(Clone, Debug)]
pub struct Scheduler {
    schedule: Schedule,
    generator: Pcg64,
}

impl Scheduler {
    /// A scheduler that draws the lots of a seed.
    pub fn new(schedule: Schedule, seed: u64) -> Scheduler {
        Scheduler { schedule, generator: Pcg64::new(u128::from(seed), 0x6c61_7077_696e_6721) }
    }

    /// One of the moves that are possible, and a moment in its window: the move that comes first, by lot among several that do.
    pub fn choose<H>(&mut self, engine: &Engine<H>) -> Option<(MoveId, Time)> {
        let mut best: Option<(MoveId, i64, i64)> = None;
        let mut equals = 0_u64;
        for Offer { id, window } in engine.offers() {
            let planned = self.plan(*window).0;
            let criterion = if self.schedule.first_enabled { window.first } else { planned };
            let is_better = match best {
                None => true,
                Some((_, _, least)) if criterion != least => criterion < least,
                // What comes from outside goes before what happens inside.
                Some((other, ..))
                    if engine.kind(other) != engine.kind(*id) && engine.kind(*id) == MoveKind::External =>
                {
                    true
                }
                Some(_) => {
                    equals += 1;
                    if self.below(equals) == equals - 1 {
                        best = Some((*id, planned, criterion));
                    }
                    false
                }
            };
            if is_better {
                equals = 1;
                best = Some((*id, planned, criterion));
            }
        }
        best.map(|(id, planned, _)| (id, Time(planned)))
    }

    /// A moment of a window: its first, or one by lot. Where it has no end, the first moments are the likeliest: 10 ns behind the first on
    /// average.
    pub fn plan(&mut self, window: Window) -> Time {
        if self.schedule.asap || window.first >= window.last {
            return Time(window.first);
        }
        if window.last == i64::MAX {
            let mut at = window.first;
            while self.below(11) != 0 {
                at = at.saturating_add(1);
            }
            return Time(at);
        }
        let length = window.last.abs_diff(window.first);
        Time(window.first.wrapping_add_unsigned(self.below(length.saturating_add(1))))
    }

    /// A number below another, each as likely as every other (D. Lemire, *Fast Random Integer Generation in an Interval*, 2019).
    fn below(&mut self, count: u64) -> u64 {
        if count <= 1 {
            return 0;
        }
        let threshold = count.wrapping_neg() % count;
        loop {
            let product = u128::from(self.generator.next_u64()) * u128::from(count);
            if product as u64 >= threshold {
                return (product >> 64) as u64;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lots_of_a_seed_stay() {
        let draw = |seed| {
            let mut scheduler = Scheduler::new(Schedule::default(), seed);
            [0; 4].map(|_| scheduler.plan(Window { first: 0, last: 999, ..Window::ALL }).0)
        };
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
    }

    #[test]
    fn lots_lie_within_their_window_and_everywhere_in_it() {
        let mut scheduler = Scheduler::new(Schedule::default(), 7);
        let mut seen = [false; 5];
        for _ in 0..200 {
            let at = scheduler.plan(Window { first: 10, last: 14, ..Window::ALL }).0;
            seen[(at - 10) as usize] = true;
        }
        assert_eq!(seen, [true; 5]);
        let mean = (0..2000).map(|_| scheduler.plan(Window::from(0)).0).sum::<i64>() / 2000;
        assert!((8..=12).contains(&mean), "{mean}");
    }

    #[test]
    fn soon_is_at_once() {
        let mut scheduler = Scheduler::new(Schedule { asap: true, ..Schedule::default() }, 7);
        assert_eq!(scheduler.plan(Window { first: 10, last: 14, ..Window::ALL }), Time(10));
    }
}
