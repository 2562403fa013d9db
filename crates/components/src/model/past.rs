//! Operators over the past with few clocks each.
//!
//! `a since[0, d] b` needs to know of the last position with `b` alone, and of none before: it is the nearest, and `a` has to hold for the shortest time
//! since. `a since[d, ∞) b`, which `held for d` comes to, needs to know of the first alone, since `a` last failed: it is the farthest. So one clock is
//! enough for each, as in the translation of metric temporal logic into automata with a clock for each operator (Alur, Feder and Henzinger, *The
//! Benefits of Relaxing Punctuality*, 1996, section 5).
//!
//! With a beginning and an end every position with `b` counts for a window of time of its own. Windows that touch are one, so that of positions which
//! follow each other closely only the first and the last are to be known: two clocks for each such stretch, and `d / (d − c)` stretches and one more for `[c, d]`
//! (as there, section 4).

use lapwing_bip::ast::{BinaryOp, Expr as Code, Stmt};
use lapwing_check::checked::Bound;
use lapwing_stream::Duration;

use super::formula::{and, is_at, not, set};
use super::ring::inside;

/// A bound with a beginning and an end needs no more stretches than this.
const MOST_STRETCHES: i64 = 32;

/// What an atom keeps of the past for an operator.
pub(super) struct Past {
    number: usize,
    /// What must hold since; nothing where none is.
    chain: Option<Code>,
    witness: Code,
    kind: Kind,
}

/// Which position counts.
enum Kind {
    /// The last; with a bound, up to so many nanoseconds, that moment excluded.
    Last(Option<i64>),
    /// The first, from so many nanoseconds on.
    First(i64),
    /// Any that is so many nanoseconds ago, both ends included; in so many stretches.
    Between { from: i64, to: i64, stretches: usize },
}

/// Something that an atom does because time has passed.
pub(super) struct Turn {
    /// The port.
    pub port: String,
    /// When.
    pub guard: Code,
    /// What.
    pub body: Vec<Stmt>,
    /// In words.
    pub note: &'static str,
}

fn restart(clock: &str) -> Stmt {
    Stmt::assign(clock, Code::int(0))
}

impl Past {
    /// The operator by that number; `None` where its bound is too narrow for how long ago it is.
    pub fn new(number: usize, chain: Option<Code>, witness: Code, bound: Bound) -> Option<Past> {
        let begins_now = bound.lo == Duration::ZERO && bound.lo_closed;
        let kind = match (begins_now, bound.hi) {
            (true, hi) => Kind::Last(hi.map(|hi| hi.nanos().saturating_add(i64::from(bound.hi_closed)))),
            (false, None) => Kind::First(bound.lo.nanos().saturating_add(i64::from(!bound.lo_closed))),
            (false, Some(_)) => {
                let (from, to) = inside(bound)?;
                // Stretches are apart by more than what their windows leave between them.
                let apart = to.saturating_sub(from).max(0).saturating_add(2);
                let stretches = to / apart + 2;
                let count = usize::try_from(stretches).ok().filter(|_| stretches <= MOST_STRETCHES)?;
                Kind::Between { from, to, stretches: count }
            }
        };
        Some(Past { number, chain, witness, kind })
    }

    fn named(&self, word: &str) -> String {
        format!("{word}_{}", self.number)
    }

    fn of(&self, word: &str, stretch: usize) -> String {
        format!("{word}_{}_{stretch}", self.number)
    }

    fn seen(&self) -> String {
        self.named("seen")
    }

    fn ripe(&self) -> String {
        self.named("ripe")
    }

    fn since(&self) -> String {
        self.named("since")
    }

    /// Its clocks.
    pub fn clocks(&self) -> Vec<String> {
        let of_stretches = match self.kind {
            Kind::Between { stretches, .. } => stretches,
            _ => 0,
        };
        let each = (1..=of_stretches).flat_map(|n| [self.of("first", n), self.of("last", n)]);
        std::iter::once(self.since()).chain(each).collect()
    }

    /// Its variables, which are false at first.
    pub fn flags(&self) -> Vec<String> {
        match self.kind {
            Kind::Last(_) => vec![self.seen()],
            Kind::First(_) => vec![self.seen(), self.ripe()],
            Kind::Between { stretches, .. } => {
                let each = (1..=stretches).flat_map(|n| [self.of("grows", n), self.of("seen", n), self.of("ripe", n)]);
                std::iter::once(self.named("near")).chain(each).collect()
            }
        }
    }

    /// Whether it holds at a position, after [`Past::step`].
    pub fn value(&self) -> Code {
        match self.kind {
            Kind::Last(_) => Code::path(self.seen()),
            Kind::First(_) => Code::path(self.ripe()),
            Kind::Between { stretches, .. } => (2..=stretches).fold(Code::path(self.of("ripe", 1)), |all, n| {
                Code::binary(BinaryOp::Or, all, Code::path(self.of("ripe", n)))
            }),
        }
    }

    /// What is done at a position, before anything that asks for the value.
    pub fn step(&self) -> Vec<Stmt> {
        let seen = self.seen();
        let since = self.since();
        let (is_found, found) = match self.kind {
            Kind::Last(_) => (self.witness.clone(), vec![set(&seen, true), restart(&since)]),
            Kind::First(ns) => {
                let is_first = and(self.witness.clone(), not(Code::path(seen.as_str())));
                (is_first, vec![set(&seen, true), set(&self.ripe(), ns == 0), restart(&since)])
            }
            Kind::Between { stretches, .. } => (self.witness.clone(), self.found_between(stretches)),
        };
        let ends = self.chain.clone().map(|chain| {
            let is_kept = |flag: &String| flag.starts_with("grows_");
            let all = self.flags().iter().filter(|flag| !is_kept(flag)).map(|flag| set(flag, false)).collect();
            Stmt::choice(not(chain), all, Vec::new())
        });
        ends.into_iter().chain([Stmt::choice(is_found, found, Vec::new())]).collect()
    }

    /// A position counts: the stretch that grows has a new end, or the next one begins.
    fn found_between(&self, stretches: usize) -> Vec<Stmt> {
        let grows = |n: usize| self.of("grows", n);
        let extend = (1..=stretches)
            .map(|n| Stmt::choice(Code::path(grows(n)), vec![restart(&self.of("last", n))], Vec::new()))
            .collect();
        let open = |n: usize| {
            vec![
                set(&grows(n), true),
                set(&self.of("seen", n), true),
                set(&self.of("ripe", n), false),
                restart(&self.of("first", n)),
                restart(&self.of("last", n)),
            ]
        };
        let begin = (1..=stretches).rev().fold(open(1), |otherwise, n| {
            let mut next = vec![set(&grows(n), false)];
            next.extend(open(n % stretches + 1));
            vec![Stmt::choice(Code::path(grows(n)), next, otherwise)]
        });
        let near = self.named("near");
        vec![Stmt::choice(Code::path(near.as_str()), extend, begin), set(&near, true), restart(&self.since())]
    }

    /// What becomes of it by time alone.
    pub fn turns(&self) -> Vec<Turn> {
        let (seen, ripe, since) = (Code::path(self.seen()), Code::path(self.ripe()), self.since());
        match self.kind {
            Kind::Last(None) | Kind::First(0) => Vec::new(),
            Kind::Last(Some(ns)) => vec![Turn {
                port: self.named("forget"),
                guard: and(seen, is_at(&since, ns)),
                body: vec![set(&self.seen(), false)],
                note: "It is too long ago.",
            }],
            Kind::First(ns) => vec![Turn {
                port: self.named("ripen"),
                guard: and(and(seen, not(ripe)), is_at(&since, ns)),
                body: vec![set(&self.ripe(), true)],
                note: "It is long enough ago.",
            }],
            Kind::Between { from, to, stretches } => self.turns_between(from, to, stretches),
        }
    }

    fn turns_between(&self, from: i64, to: i64, stretches: usize) -> Vec<Turn> {
        let near = self.named("near");
        let parts = Turn {
            port: self.named("part"),
            guard: and(Code::path(near.as_str()), is_at(&self.since(), to.saturating_sub(from).saturating_add(2))),
            body: vec![set(&near, false)],
            note: "What comes next counts by itself.",
        };
        let each = (1..=stretches).flat_map(|n| {
            let (seen, ripe) = (self.of("seen", n), self.of("ripe", n));
            let is_unripe = and(Code::path(seen.as_str()), not(Code::path(ripe.as_str())));
            let ripen = Turn {
                port: self.of("ripen", n),
                guard: and(is_unripe, is_at(&self.of("first", n), from)),
                body: vec![set(&ripe, true)],
                note: "It is long enough ago.",
            };
            let forget = Turn {
                port: self.of("forget", n),
                guard: and(Code::path(seen.as_str()), is_at(&self.of("last", n), to.saturating_add(1))),
                body: vec![set(&seen, false), set(&ripe, false)],
                note: "It is too long ago.",
            };
            [ripen, forget]
        });
        std::iter::once(parts).chain(each).collect()
    }
}
