//! Obligations: where they begin, the automaton that decides them, and what is remembered of those that are open.
//!
//! Without bounds, a count and the oldest beginning for each state of the automaton. With bounds each obligation has its own deadlines, so
//! that each is remembered, in a [`queue`](crate::queue).

use lapwing_engine::program::{At, Bit, Bound, Group, Judged, Tracker};

use crate::automaton::{Automaton, Fate, Target, Tree};
use crate::clock::Clock;
use crate::code::{Block, Expr, Ty, Unit, elem, field, local, since};
use crate::formula::{Beyond, Table};
use crate::past::whole;
use crate::residual::Test;
use crate::segments::Segments;
use crate::value::bit;

/// Where a tracker's obligations are kept.
pub(crate) struct Obligations<'a> {
    tracker: &'a Tracker,
    segments: &'a Segments<'a>,
    pub name: String,
    pub capacity: usize,
    pub how: How,
    /// The contexts of the `before`s that hold failures back, the innermost first.
    pub gates: Vec<usize>,
}

/// How they are kept.
pub(crate) enum How {
    /// They end where they begin.
    AtOnce(Bit),
    Counted(Automaton),
    Queued(Automaton),
}

impl<'a> Obligations<'a> {
    pub fn new(
        group: &Group,
        tracker: &'a Tracker,
        segments: &'a Segments<'a>,
        name: String,
        capacity: usize,
    ) -> Result<Obligations<'a>, Beyond> {
        let mut table = Table::default();
        let (how, gates) = match tracker.formula {
            Judged::State(bit) => (How::AtOnce(bit), Vec::new()),
            Judged::Future(root) => {
                let (root, gates) = table.take(group, root)?;
                let automaton = Automaton::of(&table, root)?;
                (if automaton.is_timed() { How::Queued(automaton) } else { How::Counted(automaton) }, gates)
            }
        };
        Ok(Obligations { tracker, segments, name, capacity, how, gates })
    }

    fn property(&self) -> Expr {
        Expr::Int(self.tracker.property as i64)
    }

    /// Whether each is remembered on its own.
    fn has_queue(&self) -> bool {
        matches!(self.how, How::Queued(_))
    }

    /// The field that says that the queue was too short.
    pub fn full(&self) -> Option<Expr> {
        self.has_queue().then(|| field(format!("{}_full", self.name)))
    }

    fn state(&self, what: &str, state: usize) -> Expr {
        field(format!("{}_{what}{state}", self.name))
    }

    fn gate(&self, what: &str, level: usize) -> Expr {
        field(format!("{}_{what}_before{level}", self.name))
    }

    /// Adds the fields that remember.
    pub fn fields(&self, unit: &mut Unit) {
        for level in 0..self.gates.len() {
            self.counter(unit, &format!("_before{level}"), "failed and wait to be told");
        }
        match &self.how {
            How::AtOnce(_) => {}
            How::Counted(automaton) => {
                for state in 0..automaton.states.len() {
                    self.counter(unit, &state.to_string(), &format!("are open, in state {state}"));
                }
            }
            How::Queued(_) => self.queue_fields(unit),
        }
    }

    fn counter(&self, unit: &mut Unit, which: &str, what: &str) {
        unit.field(&format!("{}_count{which}", self.name), Ty::U64, 0.into(), &format!("How many obligations {what}."));
        unit.field(&format!("{}_oldest{which}", self.name), Ty::I64, 0.into(), "When the oldest of them began.");
    }

    /// The obligations that have met their fate at a time.
    pub fn decide(&self, b: &mut Block, met: bool, count: Expr, at: Expr, began: Expr) {
        if met {
            b.add(&elem("met", self.property()), count);
        } else if self.gates.is_empty() {
            b.call("fail", vec![self.property(), count, at, began]);
        } else {
            self.join(b, self.gate("count", 0), self.gate("oldest", 0), count, began);
        }
    }

    /// Adds obligations to a counter.
    fn join(&self, b: &mut Block, counter: Expr, oldest: Expr, count: Expr, began: Expr) {
        b.when(counter.clone().eq(0) | began.clone().lt(&oldest), |b| b.set(&oldest, began));
        b.add(&counter, count);
    }

    /// A position: segments that close, then obligations that are open, then those that begin. What a queue that was too short spoils is
    /// not judged.
    pub fn position(&self, unit: &mut Unit, b: &mut Block, is_spoilt: Expr) {
        let context = self.tracker.context as usize;
        let now = local("now");
        if context != 0 && !matches!(self.how, How::AtOnce(_)) {
            let name = format!("{}_close", self.name);
            let body = Block::of(|b| self.close(b));
            if unit.function(&name, "A segment closes: what is open in it is decided.", &[("now", Ty::I64)], body) {
                b.when(self.segments.closes(context), |b| b.call(&name, vec![now.clone()]));
            }
        }
        self.open_gates(b);
        let mut inside = Block::default();
        match &self.how {
            How::AtOnce(formula) => {
                inside.when(self.is_obliged(), |b| {
                    b.branch(
                        bit(*formula),
                        |b| self.decide(b, true, 1.into(), now.clone(), now.clone()),
                        |b| self.decide(b, false, 1.into(), now.clone(), now.clone()),
                    );
                });
            }
            How::Counted(automaton) => {
                self.progress_counted(&mut inside, automaton);
                self.begin(&mut inside, automaton);
            }
            How::Queued(automaton) => {
                self.progress_queued(&mut inside, automaton);
                self.begin(&mut inside, automaton);
            }
        }
        b.when(self.segments.active(context) & !is_spoilt, |b| b.0.extend(inside.0));
    }

    fn is_obliged(&self) -> Expr {
        let context = self.tracker.context as usize;
        match self.tracker.at {
            At::All => true.into(),
            At::First => self.segments.first(context),
            At::Within(bound) => is_in(&bound, since(&local("now"), &self.segments.start(context))),
        }
    }

    fn begin(&self, b: &mut Block, automaton: &Automaton) {
        let now = local("now");
        b.when(self.is_obliged(), |b| {
            self.tree(b, &automaton.begin, &|_| now.clone(), &mut |b, fate| match fate {
                Fate::Open(Target { state, .. }) => match &self.how {
                    How::Queued(automaton) => self.push(b, automaton, state),
                    _ => self.join(b, self.state("count", state), self.state("oldest", state), 1.into(), now.clone()),
                },
                fate => self.decide(b, fate == Fate::Met, 1.into(), now.clone(), now.clone()),
            });
        });
    }

    /// A decision tree, with what is to be done at its leaves; `clock` gives when a clock began.
    pub fn tree(
        &self,
        b: &mut Block,
        tree: &Tree,
        clock: &dyn Fn(Clock) -> Expr,
        leaf: &mut dyn FnMut(&mut Block, Fate),
    ) {
        match tree {
            Tree::To(fate) => leaf(b, *fate),
            Tree::If(test, yes, no) => {
                let condition = match test {
                    Test::Holds(register) => bit(Bit::new(*register as u32)),
                    Test::Begun(of, from) => since(&local("now"), &clock(*of)).ge(*from),
                };
                let (mut then, mut other) = (Block::default(), Block::default());
                self.tree(&mut then, yes, clock, leaf);
                self.tree(&mut other, no, clock, leaf);
                b.branch(condition, |b| *b = then, |b| *b = other);
            }
        }
    }

    fn progress_counted(&self, b: &mut Block, automaton: &Automaton) {
        let lone = automaton.states.len() == 1;
        let states = 0..automaton.states.len();
        let (mut counts, mut oldest) = (Vec::new(), Vec::new());
        for state in states {
            counts.push(b.bind(format!("k{}_{state}", self.name), Ty::U64, self.state("count", state)));
            oldest.push(b.bind(format!("w{}_{state}", self.name), Ty::I64, self.state("oldest", state)));
            if !lone {
                b.set(&self.state("count", state), 0);
            }
        }
        for (number, state) in automaton.states.iter().enumerate() {
            let (count, began) = (counts[number].clone(), oldest[number].clone());
            b.when(count.clone().gt(0), |b| {
                self.tree(b, &state.moves, &|_| began.clone(), &mut |b, fate| match fate {
                    Fate::Open(to) if lone && to.state == number => {}
                    Fate::Open(Target { state: to, .. }) => {
                        self.join(b, self.state("count", to), self.state("oldest", to), count.clone(), began.clone());
                    }
                    fate => {
                        if lone {
                            b.set(&self.state("count", number), 0);
                        }
                        self.decide(b, fate == Fate::Met, count.clone(), local("now"), began.clone());
                    }
                });
            });
        }
    }

    /// A segment closes: all in it is decided.
    fn close(&self, b: &mut Block) {
        let now = local("now");
        match &self.how {
            How::AtOnce(_) => {}
            How::Counted(automaton) => {
                for (number, state) in automaton.states.iter().enumerate() {
                    let (count, began) = (self.state("count", number), self.state("oldest", number));
                    b.when(count.clone().gt(0), |b| {
                        self.decide(b, state.closes_met, count.clone(), now.clone(), began)
                    });
                    b.set(&count, 0);
                }
            }
            How::Queued(automaton) => self.close_queue(b, automaton),
        }
    }

    /// What was held back by a `before` is told once its X comes, and dropped where something else closes the segment.
    fn open_gates(&self, b: &mut Block) {
        for (level, &context) in self.gates.iter().enumerate() {
            let (count, oldest) = (self.gate("count", level), self.gate("oldest", level));
            b.when(self.segments.closes(context) & count.clone().gt(0), |b| {
                b.branch(
                    self.segments.closed_by_own(context),
                    |b| match level + 1 < self.gates.len() {
                        true => self.join(
                            b,
                            self.gate("count", level + 1),
                            self.gate("oldest", level + 1),
                            count.clone(),
                            oldest.clone(),
                        ),
                        false => b.call("fail", vec![self.property(), count.clone(), local("now"), oldest.clone()]),
                    },
                    |b| b.add(&elem("met", self.property()), count.clone()),
                );
                b.set(&count, 0);
            });
        }
    }

    /// Adds up what is open, and finds out whether some of it would be missed, were the trace all.
    pub fn tally(&self, b: &mut Block, open: &Expr, missed: &Expr) {
        (0..self.gates.len()).for_each(|level| b.add(open, self.gate("count", level)));
        match &self.how {
            How::AtOnce(_) => {}
            How::Counted(automaton) => {
                for (number, state) in automaton.states.iter().enumerate() {
                    b.add(open, self.state("count", number));
                    if state.is_missed && self.gates.is_empty() {
                        b.when(self.state("count", number).gt(0), |b| b.set(missed, true));
                    }
                }
            }
            How::Queued(automaton) => self.tally_queue(b, automaton, open, missed),
        }
    }

    /// Whether an obligation may still be added.
    pub fn can_add(&self) -> Expr {
        let context = self.tracker.context as usize;
        let (open, new) = self.segments.prospects(context);
        match self.tracker.at {
            At::First => new,
            At::All => new | open,
            At::Within(bound) => match whole(&bound).1 {
                Some(hi) if bound.has_end() => {
                    new | (open & since(&field("last"), &self.segments.start(context)).le(hi))
                }
                Some(_) => new | open,
                None => new,
            },
        }
    }

    /// Whether it would be missed where the property never had a position.
    pub fn is_missed_if_empty(&self) -> bool {
        self.tracker.missed_if_empty
    }
}

/// Whether a distance lies within a bound.
fn is_in(bound: &Bound, distance: Expr) -> Expr {
    let (from, to) = whole(bound);
    let begun = if from == 0 { Expr::Bool(true) } else { distance.clone().ge(from) };
    match to {
        Some(i64::MAX) => begun,
        Some(to) => begun & distance.le(to),
        None => false.into(),
    }
}
