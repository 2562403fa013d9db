//! Obligations with deadlines: a queue in an array, in the order in which they began. Those of one stamp and one state are one entry.

use lapwing_engine::program::Bit;

use crate::automaton::{Automaton, Fate, State, Tree};
use crate::code::{Bin, Block, Expr, Helper, Stmt, Ty, Unit, call, elem, field, local, since};
use crate::obligations::{How, Obligations};
use crate::residual::Test;
use crate::value::bit;

/// What stands for the state of an entry that has left the queue.
const GONE: i64 = 255;

impl Obligations<'_> {
    fn len(&self) -> Expr {
        field(format!("{}_len", self.name))
    }

    fn index(&self, k: Expr) -> Expr {
        let head = field(format!("{}_head", self.name));
        let from_head = if k == Expr::Int(0) { return head } else { head + k };
        from_head.bin(Bin::Rem, self.capacity as i64)
    }

    fn entry(&self, what: &str, at: Expr) -> Expr {
        elem(format!("{}_{what}", self.name), at)
    }

    /// Adds the fields of the queue.
    pub fn queue_fields(&self, unit: &mut Unit) {
        unit.array(&format!("{}_began", self.name), Ty::I64, self.capacity, 0.into(), "When open obligations began.");
        unit.array(&format!("{}_number", self.name), Ty::U32, self.capacity, 0.into(), "How many began then.");
        unit.array(&format!("{}_state", self.name), Ty::U8, self.capacity, 0.into(), "In which state they are.");
        unit.field(&format!("{}_head", self.name), Ty::U32, 0.into(), "The oldest entry.");
        unit.field(&format!("{}_len", self.name), Ty::U32, 0.into(), "How many entries there are.");
        unit.field(&format!("{}_full", self.name), Ty::Bool, false.into(), "Whether there were too many.");
    }

    pub fn push(&self, b: &mut Block, state: usize) {
        let (len, now) = (self.len(), local("now"));
        let newest = self.index(len.clone() - 1.into());
        let same = len.clone().gt(0)
            & self.entry("began", newest.clone()).eq(&now)
            & self.entry("state", newest.clone()).eq(state as i64);
        let is_full = field(format!("{}_full", self.name));
        b.branch(
            same,
            |b| b.add(&self.entry("number", newest.clone()), 1),
            |b| {
                b.branch(
                    len.clone().lt(self.capacity as i64),
                    |b| {
                        let at = b.bind(format!("at{}_{state}", self.name), Ty::U32, self.index(len.clone()));
                        b.set(&self.entry("began", at.clone()), now.clone());
                        b.set(&self.entry("number", at.clone()), 1);
                        b.set(&self.entry("state", at), state as i64);
                        b.add(&len, 1);
                    },
                    |b| b.set(&is_full, true),
                );
            },
        );
    }

    /// Those in the queue move, if the position moves any.
    pub fn progress_queued(&self, b: &mut Block, automaton: &Automaton) {
        // Where time tells whether a state stays, each obligation has to be asked.
        let moves = match automaton.states.iter().any(|s| s.moves.asks_time()) {
            true => Expr::Bool(true),
            false => {
                let leaves = automaton.states.iter().enumerate().map(|(n, s)| leaves(&s.moves, Fate::Open(n)));
                leaves.fold(Expr::Bool(false), |a, b| a | b)
            }
        };
        let arms = |b: &mut Block, to: &Expr, began: &Expr, count: &Expr| {
            let arm = |(number, state): (usize, &State)| {
                let mut arm = Block::default();
                self.tree(&mut arm, &state.moves, began, &mut |b, fate| {
                    if fate != Fate::Open(number) {
                        self.go(b, fate, to, count, &local("now"), began);
                    }
                });
                (number as u8, arm.0)
            };
            b.0.push(Stmt::Match(to.clone(), automaton.states.iter().enumerate().map(arm).collect()));
        };
        b.when(moves & self.len().gt(0), |b| self.sweep(b, arms));
    }

    /// What becomes of an entry of the queue.
    fn go(&self, b: &mut Block, fate: Fate, to: &Expr, count: &Expr, at: &Expr, began: &Expr) {
        match fate {
            Fate::Open(state) => b.set(to, state as i64),
            fate => {
                b.set(to, GONE);
                self.decide(b, fate == Fate::Met, count.clone(), at.clone(), began.clone());
            }
        }
    }

    /// Goes through the queue; what is [`GONE`] after leaves it.
    fn sweep(&self, b: &mut Block, each: impl FnOnce(&mut Block, &Expr, &Expr, &Expr)) {
        let kept = b.var(format!("kept_{}", self.name), Ty::U32, 0.into());
        b.each("i", self.len(), |b| {
            let at = b.bind("entry", Ty::U32, self.index(local("i")));
            let began = b.bind("began", Ty::I64, self.entry("began", at.clone()));
            let number = b.bind("number", Ty::U32, self.entry("number", at.clone()));
            let to = b.var("to", Ty::U8, self.entry("state", at));
            each(b, &to, &began, &number.clone().cast(Ty::U64));
            b.when(to.clone().ne(GONE), |b| {
                let into = b.bind("into", Ty::U32, self.index(kept.clone()));
                b.set(&self.entry("began", into.clone()), began);
                b.set(&self.entry("number", into.clone()), number);
                b.set(&self.entry("state", into), to);
                b.add(&kept, 1);
            });
        });
        b.set(&self.len(), kept);
    }

    /// Bounds that ended before now are over. Adds a function, and gives its name.
    pub fn expire(&self, unit: &mut Unit) -> Option<String> {
        let How::Queued(automaton) = &self.how else { return None };
        let ends: Vec<(i64, bool, Fate)> = automaton.states.iter().filter_map(|s| s.deadline).collect();
        let first = ends.iter().min_by_key(|e| (e.0, e.1))?;
        let alike = ends.len() == automaton.states.len()
            && ends.iter().all(|e| (e.0, e.1) == (first.0, first.1) && !matches!(e.2, Fate::Open(_)));
        let body = Block::of(|b| {
            if alike { self.pop_expired(b, automaton, *first) } else { self.sweep_expired(b, automaton, first.0) }
        });
        let name = format!("{}_expire", self.name);
        let is_some = unit.function(&name, "Bounds that ended before now are over.", &[("now", Ty::I64)], body);
        is_some.then_some(name)
    }

    /// All entries have the same bound: those that are over are the oldest.
    fn pop_expired(&self, b: &mut Block, automaton: &Automaton, (hi, closed, _): (i64, bool, Fate)) {
        let head = field(format!("{}_head", self.name));
        let began = self.entry("began", head.clone());
        b.repeat(self.len().gt(0) & is_over(&began, hi, closed), |b| {
            let (began, number) = (b.bind("began", Ty::I64, began.clone()), self.entry("number", head.clone()));
            let number = b.bind("number", Ty::U64, number.cast(Ty::U64));
            let at = call(Helper::Later, vec![began.clone(), hi.into()]);
            let arm = |(number_of, state): (usize, &State)| {
                let met = matches!(state.deadline, Some((_, _, Fate::Met)));
                let arm = Block::of(|b| self.decide(b, met, number.clone(), at.clone(), began.clone()));
                (number_of as u8, arm.0)
            };
            let mut arms: Vec<_> = automaton.states.iter().enumerate().map(arm).collect();
            match arms.len() {
                1 => b.0.append(&mut arms[0].1),
                _ => b.0.push(Stmt::Match(self.entry("state", head.clone()), arms)),
            }
            b.set(&head, (head.clone() + 1.into()).bin(Bin::Rem, self.capacity as i64));
            b.set(&self.len(), self.len() - 1.into());
        });
    }

    fn sweep_expired(&self, b: &mut Block, automaton: &Automaton, soonest: i64) {
        let oldest = self.entry("began", self.index(0.into()));
        let arms = |b: &mut Block, to: &Expr, began: &Expr, count: &Expr| {
            let on = b.var("on", Ty::Bool, true.into());
            b.repeat(on.clone(), |b| {
                b.set(&on, false);
                let arm = |(number, state): (usize, &State)| {
                    let (hi, closed, fate) = state.deadline?;
                    let arm = Block::of(|b| {
                        b.when(is_over(began, hi, closed), |b| {
                            let at = call(Helper::Later, vec![began.clone(), hi.into()]);
                            self.go(b, fate, to, count, &at, began);
                            b.set(&on, matches!(fate, Fate::Open(_)));
                        });
                    });
                    Some((number as u8, arm.0))
                };
                b.0.push(Stmt::Match(to.clone(), automaton.states.iter().enumerate().filter_map(arm).collect()));
            });
        };
        b.when(self.len().gt(0) & since(&local("now"), &oldest).ge(soonest), |b| self.sweep(b, arms));
    }

    /// Whether a bound of no length, its end left out, is over where it begins.
    pub fn may_expire_at_once(&self) -> bool {
        match &self.how {
            How::Queued(automaton) => automaton.states.iter().any(|s| matches!(s.deadline, Some((0, false, _)))),
            _ => false,
        }
    }

    /// A segment closes: all in the queue is decided.
    pub fn close_queue(&self, b: &mut Block, automaton: &Automaton) {
        let now = local("now");
        b.each("i", self.len(), |b| {
            let at = b.bind("entry", Ty::U32, self.index(local("i")));
            let began = self.entry("began", at.clone());
            let number = self.entry("number", at.clone()).cast(Ty::U64);
            let arm = |(n, state): (usize, &State)| {
                let arm = Block::of(|b| self.decide(b, state.closes_met, number.clone(), now.clone(), began.clone()));
                (n as u8, arm.0)
            };
            b.0.push(Stmt::Match(self.entry("state", at), automaton.states.iter().enumerate().map(arm).collect()));
        });
        b.set(&self.len(), 0);
    }

    /// Adds up what is open, and finds out whether some of it would be missed, were the trace all.
    pub fn tally_queue(&self, b: &mut Block, automaton: &Automaton, open: &Expr, missed: &Expr) {
        b.each("i", self.len(), |b| {
            let at = b.bind("entry", Ty::U32, self.index(local("i")));
            b.add(open, self.entry("number", at.clone()).cast(Ty::U64));
            if self.gates.is_empty() {
                let gone = b.bind("gone", Ty::U64, since(&field("last"), &self.entry("began", at.clone())));
                let arm = |n: usize| {
                    let mut arm = Block::default();
                    when_missed(&mut arm, automaton, Fate::Open(n), &gone, missed);
                    (n as u8, arm.0)
                };
                b.0.push(Stmt::Match(self.entry("state", at), (0..automaton.states.len()).map(arm).collect()));
            }
        });
    }
}

/// Sets `missed` where what has this fate would be false, were the trace all: bounds that reach no further than its end are over then.
fn when_missed(b: &mut Block, automaton: &Automaton, fate: Fate, gone: &Expr, missed: &Expr) {
    match fate {
        Fate::Met => {}
        Fate::Failed => b.set(missed, true),
        Fate::Open(number) => {
            let state = &automaton.states[number];
            let here = |b: &mut Block| {
                if state.is_missed {
                    b.set(missed, true)
                }
            };
            match state.deadline {
                None => here(b),
                Some((hi, _, then)) => {
                    let over = if hi == 0 { Expr::Bool(true) } else { gone.clone().ge(hi) };
                    b.branch(over, |b| when_missed(b, automaton, then, gone, missed), here);
                }
            }
        }
    }
}

/// Whether a decision tree that asks no time leads elsewhere.
fn leaves(tree: &Tree, stays: Fate) -> Expr {
    match tree {
        Tree::To(fate) => Expr::Bool(*fate != stays),
        Tree::If(Test::Holds(register), yes, no) => {
            bit(Bit::new(*register as u32)).choose(leaves(yes, stays), leaves(no, stays))
        }
        Tree::If(Test::Begun(_), ..) => Expr::Bool(true),
    }
}

/// Whether a bound that began then is over now.
fn is_over(began: &Expr, hi: i64, closed: bool) -> Expr {
    let gone = since(&local("now"), began);
    if closed { gone.gt(hi) } else { gone.ge(hi) }
}
