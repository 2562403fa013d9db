//! Obligations with deadlines: a queue in an array, in the order in which they began. Those of one stamp and one state are one entry, and so
//! are those of one state in which no clock runs any more.

use lapwing_engine::program::Bit;

use crate::automaton::{Automaton, Fate, State, Tree};
use crate::clock::{BEGUN, Clock, NOW};
use crate::code::{Bin, Block, Expr, Helper, Stmt, Ty, Unit, call, elem, field, local, since};
use crate::obligations::{How, Obligations};
use crate::residual::{End, Test};
use crate::value::bit;

/// What stands for the state of an entry that has left the queue.
const GONE: i64 = 255;

/// An entry, taken out to be looked at.
struct Entry {
    began: Expr,
    count: Expr,
    /// Its state, and what it becomes.
    to: Expr,
    /// Its clocks beside the one that began with it.
    clocks: Vec<Expr>,
}

impl Entry {
    /// When a clock began.
    fn clock(&self, clock: Clock) -> Expr {
        let later = usize::from(clock).checked_sub(1).and_then(|at| self.clocks.get(at));
        later.unwrap_or(&self.began).clone()
    }
}

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
        if let How::Queued(automaton) = &self.how {
            for clock in 1..=automaton.clocks() {
                let doc = "Since when they wait for what they began to wait for later.";
                unit.array(&format!("{}_clock{clock}", self.name), Ty::I64, self.capacity, 0.into(), doc);
            }
        }
        unit.field(&format!("{}_head", self.name), Ty::U32, 0.into(), "The oldest entry.");
        unit.field(&format!("{}_len", self.name), Ty::U32, 0.into(), "How many entries there are.");
        unit.field(&format!("{}_full", self.name), Ty::Bool, false.into(), "Whether there were too many.");
    }

    /// Adds an obligation, which begins. None of its clocks is younger.
    pub fn push(&self, b: &mut Block, automaton: &Automaton, state: usize) {
        let (len, now) = (self.len(), local("now"));
        let newest = self.index(len.clone() - 1.into());
        let alike = Expr::Bool(is_timeless(&automaton.states[state])) | self.entry("began", newest.clone()).eq(&now);
        let same = len.clone().gt(0) & alike & self.entry("state", newest.clone()).eq(state as i64);
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
                let leaves = automaton.states.iter().enumerate().map(|(n, s)| leaves(&s.moves, automaton.stays(n)));
                leaves.fold(Expr::Bool(false), |a, b| a | b)
            }
        };
        let arms = |b: &mut Block, entry: &Entry| {
            let arm = |(number, state): (usize, &State)| {
                let mut arm = Block::default();
                self.tree(&mut arm, &state.moves, &|clock| entry.clock(clock), &mut |b, fate| {
                    if fate != automaton.stays(number) {
                        self.go(b, fate, entry, &local("now"));
                    }
                });
                (number as u8, arm.0)
            };
            b.0.push(Stmt::Match(entry.to.clone(), automaton.states.iter().enumerate().map(arm).collect()));
        };
        b.when(moves & self.len().gt(0), |b| self.sweep(b, automaton, arms));
    }

    /// What becomes of an entry of the queue.
    fn go(&self, b: &mut Block, fate: Fate, entry: &Entry, at: &Expr) {
        match fate {
            Fate::Open(target) => {
                b.set(&entry.to, target.state as i64);
                // In the order of age: what a clock becomes is never older than what it was, so that nothing is overwritten that is still wanted.
                for (own, (clock, &from)) in (1..).zip(entry.clocks.iter().zip(&target.clocks)) {
                    match from {
                        NOW => b.set(clock, local("now")),
                        from if from == BEGUN || from == own => {}
                        from => b.set(clock, entry.clock(from)),
                    }
                }
            }
            fate => {
                b.set(&entry.to, GONE);
                self.decide(b, fate == Fate::Met, entry.count.clone(), at.clone(), entry.began.clone());
            }
        }
    }

    /// Goes through the queue; what is [`GONE`] after leaves it.
    fn sweep(&self, b: &mut Block, automaton: &Automaton, each: impl FnOnce(&mut Block, &Entry)) {
        let kept = b.var(format!("kept_{}", self.name), Ty::U32, 0.into());
        b.each("i", self.len(), |b| {
            let at = b.bind("entry", Ty::U32, self.index(local("i")));
            let began = b.bind("began", Ty::I64, self.entry("began", at.clone()));
            let number = b.bind("number", Ty::U32, self.entry("number", at.clone()));
            let clock = |b: &mut Block, clock| {
                b.var(format!("clock{clock}"), Ty::I64, self.entry(&format!("clock{clock}"), at.clone()))
            };
            let clocks: Vec<Expr> = (1..=automaton.clocks()).map(|k| clock(b, k)).collect();
            let to = b.var("to", Ty::U8, self.entry("state", at));
            let entry = Entry { began, count: number.clone().cast(Ty::U64), to, clocks };
            each(b, &entry);
            b.when(entry.to.clone().ne(GONE), |b| self.keep(b, automaton, &entry, number, &kept));
        });
        b.set(&self.len(), kept);
    }

    /// An entry stays in the queue, or joins the one that was kept before it, from which nothing tells it apart any more.
    fn keep(&self, b: &mut Block, automaton: &Automaton, entry: &Entry, number: Expr, kept: &Expr) {
        let timeless = automaton.states.iter().enumerate().filter(|(_, state)| is_timeless(state));
        let is_timeless = timeless.fold(Expr::Bool(false), |any, (n, _)| any | entry.to.clone().eq(n as i64));
        let before = self.index(kept.clone() - 1.into());
        let joins = is_timeless & kept.clone().gt(0) & self.entry("state", before.clone()).eq(entry.to.clone());
        b.branch(
            joins,
            |b| b.add(&self.entry("number", before.clone()), number.clone()),
            |b| {
                let into = b.bind("into", Ty::U32, self.index(kept.clone()));
                b.set(&self.entry("began", into.clone()), entry.began.clone());
                b.set(&self.entry("number", into.clone()), number.clone());
                for (k, clock) in (1..).zip(&entry.clocks) {
                    b.set(&self.entry(&format!("clock{k}"), into.clone()), clock.clone());
                }
                b.set(&self.entry("state", into), entry.to.clone());
                b.add(kept, 1);
            },
        );
    }

    /// Bounds that ended before now are over. Adds a function, and gives its name.
    pub fn expire(&self, unit: &mut Unit) -> Option<String> {
        let How::Queued(automaton) = &self.how else { return None };
        let ends = || automaton.states.iter().flat_map(|s| &s.deadlines);
        let &(first, _) = ends().min_by_key(|(end, _)| (end.hi, end.is_in))?;
        let alike = ends().count() == automaton.states.len()
            && ends().all(|(end, fate)| (end.clock, *end) == (BEGUN, first) && !matches!(fate, Fate::Open(_)));
        let body = Block::of(|b| {
            if alike { self.pop_expired(b, automaton, first) } else { self.sweep_expired(b, automaton, first.hi) }
        });
        let name = format!("{}_expire", self.name);
        let is_some = unit.function(&name, "Bounds that ended before now are over.", &[("now", Ty::I64)], body);
        is_some.then_some(name)
    }

    /// All entries have the same bound: those that are over are the oldest.
    fn pop_expired(&self, b: &mut Block, automaton: &Automaton, end: End) {
        let head = field(format!("{}_head", self.name));
        let began = self.entry("began", head.clone());
        b.repeat(self.len().gt(0) & is_over(&began, end), |b| {
            let (began, number) = (b.bind("began", Ty::I64, began.clone()), self.entry("number", head.clone()));
            let number = b.bind("number", Ty::U64, number.cast(Ty::U64));
            let at = call(Helper::Later, vec![began.clone(), end.hi.into()]);
            let arm = |(number_of, state): (usize, &State)| {
                let met = matches!(state.deadlines.as_slice(), [(_, Fate::Met)]);
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
        let arms = |b: &mut Block, entry: &Entry| {
            let on = b.var("on", Ty::Bool, true.into());
            b.repeat(on.clone(), |b| {
                b.set(&on, false);
                let arm = |(number, state): (usize, &State)| {
                    let arm = Block::of(|b| self.end_first(b, &state.deadlines, 0, entry, &on));
                    (!state.deadlines.is_empty()).then_some((number as u8, arm.0))
                };
                let arms = automaton.states.iter().enumerate().filter_map(arm).collect();
                b.0.push(Stmt::Match(entry.to.clone(), arms));
            });
        };
        b.when(self.len().gt(0) & since(&local("now"), &oldest).ge(soonest), |b| self.sweep(b, automaton, arms));
    }

    /// Of the bounds of an entry the one that ends first, if it is over.
    fn end_first(&self, b: &mut Block, deadlines: &[(End, Fate)], which: usize, entry: &Entry, on: &Expr) {
        let Some((end, fate)) = deadlines.get(which) else { return };
        let at = |end: &End| call(Helper::Later, vec![entry.clock(end.clock), end.hi.into()]);
        let others = deadlines.iter().enumerate().filter(|(n, _)| *n != which);
        let is_first = others.fold(Expr::Bool(true), |all, (_, (other, _))| all & at(end).le(at(other)));
        b.branch(
            is_over(&entry.clock(end.clock), *end) & is_first,
            |b| {
                self.go(b, *fate, entry, &at(end));
                b.set(on, matches!(fate, Fate::Open(_)));
            },
            |b| self.end_first(b, deadlines, which + 1, entry, on),
        );
    }

    /// Whether a bound of no length, its end left out, is over where it begins.
    pub fn may_expire_at_once(&self) -> bool {
        match &self.how {
            How::Queued(automaton) => {
                automaton.states.iter().flat_map(|s| &s.deadlines).any(|(end, _)| (end.hi, end.is_in) == (0, false))
            }
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
                let began = self.entry("began", at.clone());
                let later = (1..=automaton.clocks()).map(|k| self.entry(&format!("clock{k}"), at.clone()));
                let clocks: Vec<Expr> = std::iter::once(began).chain(later).collect();
                let arm = |n: usize| {
                    let mut arm = Block::default();
                    when_missed(&mut arm, automaton, automaton.stays(n), &clocks, missed);
                    (n as u8, arm.0)
                };
                b.0.push(Stmt::Match(self.entry("state", at), (0..automaton.states.len()).map(arm).collect()));
            }
        });
    }
}

/// Sets `missed` where what has this fate would be false, were the trace all: bounds that reach no further than its end are over then.
/// `clocks` are those that it has before it goes there, the one of the obligation first.
fn when_missed(b: &mut Block, automaton: &Automaton, fate: Fate, clocks: &[Expr], missed: &Expr) {
    match fate {
        Fate::Met => {}
        Fate::Failed => b.set(missed, true),
        Fate::Open(target) => {
            let state = &automaton.states[target.state];
            let later = target.clocks.iter().take(state.clocks);
            let clocks: Vec<Expr> = std::iter::once(&BEGUN)
                .chain(later)
                .filter_map(|&from| clocks.get(usize::from(from)))
                .cloned()
                .collect();
            unless_over(b, automaton, state, &state.deadlines, &clocks, missed);
        }
    }
}

/// [`when_missed`] of a state, some of whose bounds are not over.
fn unless_over(
    b: &mut Block,
    automaton: &Automaton,
    state: &State,
    deadlines: &[(End, Fate)],
    clocks: &[Expr],
    missed: &Expr,
) {
    match deadlines.split_first() {
        None if state.is_missed => b.set(missed, true),
        None => {}
        Some(((end, then), rest)) => {
            let gone = |began: &Expr| since(&field("last"), began).ge(end.hi);
            let over = match clocks.get(usize::from(end.clock)) {
                Some(began) if end.hi > 0 => gone(began),
                _ => Expr::Bool(true),
            };
            b.branch(
                over,
                |b| when_missed(b, automaton, *then, clocks, missed),
                |b| unless_over(b, automaton, state, rest, clocks, missed),
            );
        }
    }
}

/// Whether all obligations in a state fare alike, whenever they began.
fn is_timeless(state: &State) -> bool {
    !state.asks_begin && state.clocks == 0
}

/// Whether a decision tree that asks no time leads elsewhere.
fn leaves(tree: &Tree, stays: Fate) -> Expr {
    match tree {
        Tree::To(fate) => Expr::Bool(*fate != stays),
        Tree::If(Test::Holds(register), yes, no) => {
            bit(Bit::new(*register as u32)).choose(leaves(yes, stays), leaves(no, stays))
        }
        Tree::If(Test::Begun(..), ..) => Expr::Bool(true),
    }
}

/// Whether a bound whose clock began then is over now.
fn is_over(began: &Expr, end: End) -> Expr {
    let gone = since(&local("now"), began);
    if end.is_in { gone.gt(end.hi) } else { gone.ge(end.hi) }
}
