//! Operators over the past with one clock each.
//!
//! `a since[0, d] b` needs to know of the last position with `b` alone, and of none before: it is the nearest, and `a` has to hold for the shortest time
//! since. `a since[d, ∞) b`, which `held for d` comes to, needs to know of the first alone, since `a` last failed: it is the farthest. So one clock is
//! enough for each, as in the translation of metric temporal logic into automata with a clock for each operator (Alur, Feder and Henzinger, *The
//! Benefits of Relaxing Punctuality*, 1996, section 5). With a beginning and an end every position in between could come to count.

use lapwing_bip::ast::{BinaryOp, Expr as Code, Stmt};
use lapwing_check::checked::Bound;
use lapwing_stream::Duration;

use super::formula::{not, set};

/// What an atom keeps of the past for an operator: a variable and a clock, and for a bound that has a beginning another variable.
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

impl Past {
    /// The operator by that number; `None` where its bound has a beginning and an end.
    pub fn new(number: usize, chain: Option<Code>, witness: Code, bound: Bound) -> Option<Past> {
        let begins_now = bound.lo == Duration::ZERO && bound.lo_closed;
        let kind = match (begins_now, bound.hi) {
            (true, hi) => Kind::Last(hi.map(|hi| hi.nanos().saturating_add(i64::from(bound.hi_closed)))),
            (false, None) => Kind::First(bound.lo.nanos().saturating_add(i64::from(!bound.lo_closed))),
            (false, Some(_)) => return None,
        };
        Some(Past { number, chain, witness, kind })
    }

    fn seen(&self) -> String {
        format!("seen_{}", self.number)
    }

    fn ripe(&self) -> String {
        format!("ripe_{}", self.number)
    }

    /// Its clock.
    pub fn clock(&self) -> String {
        format!("since_{}", self.number)
    }

    /// Its variables, which are false at first.
    pub fn flags(&self) -> Vec<String> {
        match self.kind {
            Kind::Last(_) => vec![self.seen()],
            Kind::First(_) => vec![self.seen(), self.ripe()],
        }
    }

    /// Whether it holds at a position, after [`Past::step`].
    pub fn value(&self) -> Code {
        Code::path(match self.kind {
            Kind::Last(_) => self.seen(),
            Kind::First(_) => self.ripe(),
        })
    }

    /// What is done at a position, before anything that asks for the value.
    pub fn step(&self) -> Vec<Stmt> {
        let restart = Stmt::assign(self.clock().as_str(), Code::int(0));
        let seen = self.seen();
        let (is_found, found) = match self.kind {
            Kind::Last(_) => (self.witness.clone(), vec![set(&seen, true), restart]),
            Kind::First(ns) => {
                let is_first = Code::binary(BinaryOp::And, self.witness.clone(), not(Code::path(seen.as_str())));
                (is_first, vec![set(&seen, true), set(&self.ripe(), ns == 0), restart])
            }
        };
        let ends = self.chain.clone().map(|chain| {
            let all = self.flags().iter().map(|flag| set(flag, false)).collect();
            Stmt::choice(not(chain), all, Vec::new())
        });
        ends.into_iter().chain([Stmt::choice(is_found, found, Vec::new())]).collect()
    }

    /// What becomes of it by time alone.
    pub fn turn(&self) -> Option<Turn> {
        let (seen, ripe) = (Code::path(self.seen()), Code::path(self.ripe()));
        let is_at = |ns: i64| Code::binary(BinaryOp::GreaterEqual, Code::path(self.clock()), Code::int(ns));
        match self.kind {
            Kind::Last(ns) => Some(Turn {
                port: format!("forget_{}", self.number),
                guard: Code::binary(BinaryOp::And, seen, is_at(ns?)),
                body: vec![set(&self.seen(), false)],
                note: "It is too long ago.",
            }),
            Kind::First(0) => None,
            Kind::First(ns) => Some(Turn {
                port: format!("ripen_{}", self.number),
                guard: Code::binary(BinaryOp::And, Code::binary(BinaryOp::And, seen, not(ripe)), is_at(ns)),
                body: vec![set(&self.ripe(), true)],
                note: "It is long enough ago.",
            }),
        }
    }
}
