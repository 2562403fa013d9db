//! Requests that are open at once, each with a clock of its own, in a ring of places.
//!
//! Of `whenever p, eventually within [a, b] q` every position with p is to be judged by itself: an answer is one for those requests that are at least a
//! old, and for no younger ones. So each has a place with a clock, in the order in which they came, and a monitor of so many places gives up where more
//! requests are open at once ([`PLACES`]). Requests at positions that follow each other and fail are one violation, as everywhere.

use lapwing_bip::ast::{BinaryOp, Expr as Code, Stmt};
use lapwing_check::checked::Bound;

use super::formula::{and, is_at, not, set};
use super::past::Turn;

/// So many requests can be open at once.
pub(super) const PLACES: usize = 8;

/// What is asked, and what has to come of it.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Ring {
    asked: Code,
    /// What meets a request, or where it must not come, what fails it.
    answer: Code,
    /// Nanoseconds after the request: from when to when an answer counts, both included.
    from: i64,
    to: i64,
    fails: bool,
}

/// The violations to be told: new ones, and those that belong to the one before.
pub(super) const NEWS: &str = "news";
pub(super) const OLDS: &str = "olds";

/// The place that is next, whether the position before has opened one that is not met, whether a request had no place, and whether that has been told.
const NEXT: &str = "next_place";
const PRIOR: &str = "prior";
const LOST: &str = "lost";
const ENDED: &str = "gave_up";

fn place(word: &str, number: usize) -> String {
    format!("{word}_{number}")
}

fn after(number: usize) -> usize {
    number % PLACES + 1
}

fn all() -> std::ops::RangeInclusive<usize> {
    1..=PLACES
}

fn when(condition: Code, then: Vec<Stmt>) -> Stmt {
    Stmt::choice(condition, then, Vec::new())
}

fn one_more(name: &str) -> Stmt {
    Stmt::assign(name, Code::binary(BinaryOp::Add, Code::path(name), Code::int(1)))
}

impl Ring {
    /// Requests that something has to answer within a bound, or where it `fails` them must not follow; `None` where the bound has no end.
    pub fn new(asked: Code, answer: Code, bound: Bound, fails: bool) -> Option<Ring> {
        let (from, to) = inside(bound)?;
        Some(Ring { asked, answer, from, to, fails })
    }

    /// Truth values, which are false at first.
    pub fn flags(&self) -> Vec<String> {
        let of_places = ["used", "ripe", "joined"].into_iter().flat_map(|word| all().map(move |n| place(word, n)));
        of_places.chain([PRIOR, LOST, ENDED].map(str::to_owned)).collect()
    }

    /// Numbers, and what they are at first.
    pub fn numbers(&self) -> [(&'static str, i64); 3] {
        [(NEWS, 0), (OLDS, 0), (NEXT, 1)]
    }

    pub fn clocks(&self) -> Vec<String> {
        all().map(|n| place("open_for", n)).collect()
    }

    /// A position.
    pub fn step(&self) -> Vec<Stmt> {
        let open =
            all().map(|n| when(Code::binary(BinaryOp::Equal, Code::path(NEXT), Code::int(n as i64)), self.open(n)));
        let is_last = Code::binary(BinaryOp::Equal, Code::path(NEXT), Code::int(PLACES as i64));
        let next = Stmt::choice(is_last, vec![Stmt::assign(NEXT, Code::int(1))], vec![one_more(NEXT)]);
        let opens = open.chain([next, set(PRIOR, true)]).collect();
        let is_asked = and(self.asked.clone(), not(Code::path(ENDED)));
        let answered = all().map(|n| {
            let is_answered = and(self.answer.clone(), Code::path(place("ripe", n)));
            when(is_answered, if self.fails { failed(n) } else { met(n) })
        });
        std::iter::once(Stmt::choice(is_asked, opens, vec![set(PRIOR, false)])).chain(answered).collect()
    }

    /// A request takes a place.
    fn open(&self, number: usize) -> Vec<Stmt> {
        let used = place("used", number);
        let taken = vec![
            set(&used, true),
            set(&place("ripe", number), self.from == 0),
            Stmt::assign(place("joined", number).as_str(), Code::path(PRIOR)),
            Stmt::assign(place("open_for", number).as_str(), Code::int(0)),
        ];
        vec![Stmt::choice(Code::path(used.as_str()), vec![set(LOST, true)], taken)]
    }

    /// What it does because time has passed.
    pub fn turns(&self) -> Vec<Turn> {
        let is_used = |n: usize| Code::path(place("used", n));
        let is_open_for = |n: usize, ns: i64| is_at(&place("open_for", n), ns);
        let ripen = all().filter(|_| self.from > 0).map(|n| Turn {
            port: place("ripen_place", n),
            guard: and(and(is_used(n), not(Code::path(place("ripe", n)))), is_open_for(n, self.from)),
            body: vec![set(&place("ripe", n), true)],
            note: "From now on an answer counts.",
        });
        let expire = all().map(|n| Turn {
            port: place("expire", n),
            guard: and(is_used(n), is_open_for(n, self.to.saturating_add(1))),
            body: if self.fails { met(n) } else { failed(n) },
            note: "The time for an answer is over.",
        });
        let gives_up = all().flat_map(|n| [set(&place("used", n), false), set(&place("ripe", n), false)]);
        let lost = Turn {
            port: LOST.to_owned(),
            guard: Code::path(LOST),
            body: gives_up.chain([set(LOST, false), set(ENDED, true)]).collect(),
            note: "More requests are open at once than the monitor has places for: it says nothing more.",
        };
        ripen.chain(expire).chain([lost]).collect()
    }
}

/// The request of a place is met: what follows it does not belong to a violation before.
fn met(number: usize) -> Vec<Stmt> {
    let next = after(number);
    let is_last = Code::binary(BinaryOp::Equal, Code::path(NEXT), Code::int(next as i64));
    vec![
        set(&place("used", number), false),
        set(&place("ripe", number), false),
        set(&place("joined", next), false),
        when(is_last, vec![set(PRIOR, false)]),
    ]
}

fn failed(number: usize) -> Vec<Stmt> {
    vec![
        set(&place("used", number), false),
        set(&place("ripe", number), false),
        Stmt::choice(Code::path(place("joined", number)), vec![one_more(OLDS)], vec![one_more(NEWS)]),
    ]
}

/// The nanoseconds of a bound, both ends included; `None` where it has no end.
pub(super) fn inside(bound: Bound) -> Option<(i64, i64)> {
    let from = bound.lo.nanos().saturating_add(i64::from(!bound.lo_closed));
    let to = bound.hi?.nanos().saturating_sub(i64::from(!bound.hi_closed));
    Some((from, to))
}
