//! What is left of a formula once some positions have been seen: progression, in Kleene's logic.
//!
//! An obligation is decided as soon as its formula is no longer unknown, where every part is true, false or unknown and the connectives
//! combine these as Kleene's logic does. That is what progression computes, as long as only such laws simplify that hold there: those of
//! a distributive lattice and De Morgan's, but not `x or not x`. (Bacchus and Kabanza, "Using temporal logics to express search control
//! knowledge for planning", 2000, progress formulas in this way; two-valued.)

use lapwing_engine::program::{Bit, Bound};

use crate::clock::{Clock, Wait};
use crate::formula::{Formula, Ref, Table};

/// What is left of a formula.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) enum Rest {
    Known(bool),
    Open(Atom, bool),
    /// In order, without doubles; each neither known nor itself an `All`.
    All(Vec<Rest>),
    Any(Vec<Rest>),
}

/// A formula that waits for further positions. In [`Rest::Open`] it stands beside whether it is negated.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) enum Atom {
    /// The formula at the next position.
    Next(Ref),
    /// `eventually` and `until`, which go on; `after`, which waits for its X.
    Still(Wait),
    /// The body of an `until` or `before` scope, until its X comes.
    UpTo(usize, Box<Rest>),
    /// Segment after segment, and the body in the one that is open.
    Each(usize, Option<Box<Rest>>),
}

/// What a position shows.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) enum Test {
    /// A register.
    Holds(usize),
    /// Whether a clock began at least so many nanoseconds ago.
    Begun(Clock, i64),
}

/// Answers tests, or says which one must be answered first.
pub(crate) type Answers<'a> = &'a mut dyn FnMut(Test) -> Result<bool, Test>;

impl Rest {
    pub fn not(self) -> Rest {
        match self {
            Rest::Known(b) => Rest::Known(!b),
            Rest::Open(atom, negated) => Rest::Open(atom, !negated),
            Rest::All(of) => Rest::join(of.into_iter().map(Rest::not).collect(), false),
            Rest::Any(of) => Rest::join(of.into_iter().map(Rest::not).collect(), true),
        }
    }

    fn both(a: Rest, b: Rest) -> Rest {
        Rest::join(vec![a, b], true)
    }

    fn either(a: Rest, b: Rest) -> Rest {
        Rest::join(vec![a, b], false)
    }

    /// The conjunction, or the disjunction, of some, in their one canonical form: flat, in order, without doubles and without what another
    /// part implies: `x and (x or y)` is `x`, and so is `x and y` where y waits for the same and longer.
    fn join(of: Vec<Rest>, all: bool) -> Rest {
        let mut parts: Vec<Rest> = Vec::new();
        for part in of {
            match part {
                Rest::Known(b) if b == all => {}
                Rest::Known(b) => return Rest::Known(b),
                Rest::All(inner) if all => parts.extend(inner),
                Rest::Any(inner) if !all => parts.extend(inner),
                part => parts.push(part),
            }
        }
        parts.sort();
        parts.dedup();
        let mut at = 0;
        while at < parts.len() {
            let is_implied = |(i, other): (usize, &Rest)| {
                i != at && if all { other.implies(&parts[at]) } else { parts[at].implies(other) }
            };
            if parts.iter().enumerate().any(is_implied) {
                parts.remove(at);
            } else {
                at += 1;
            }
        }
        match (parts.len(), all) {
            (0, _) => Rest::Known(all),
            (1, _) => parts.remove(0),
            (_, true) => Rest::All(parts),
            (_, false) => Rest::Any(parts),
        }
    }

    /// How many atoms it has.
    pub fn size(&self) -> usize {
        match self {
            Rest::Known(_) => 0,
            Rest::Open(Atom::UpTo(_, of) | Atom::Each(_, Some(of)), _) => 1 + of.size(),
            Rest::Open(..) => 1,
            Rest::All(of) | Rest::Any(of) => of.iter().map(Rest::size).sum(),
        }
    }
}

impl Table {
    /// What is left of a formula that is asked at a position, once that has been seen.
    pub fn ask(&self, of: Ref, see: Answers<'_>) -> Result<Rest, Test> {
        let rest = match self.get(of.id) {
            Formula::State(bit) => Rest::Known(holds(bit, see)?),
            Formula::And(l, r) => match self.ask(l, see)? {
                Rest::Known(false) => Rest::Known(false),
                left => Rest::both(left, self.ask(r, see)?),
            },
            Formula::Next(f) => Rest::Open(Atom::Next(f), false),
            Formula::Eventually(bound, f) => self.eventually(Wait::by(of.id, &bound), f, bound.contains(0), see)?,
            Formula::Until(bound, l, r) => self.until(Wait::by(of.id, &bound), (l, r), bound.contains(0), see)?,
            Formula::After(..) => self.still(Wait::forever(of.id), see)?,
            Formula::UpTo { weak, x, body } => match holds(x, see)? {
                true => Rest::Known(true),
                false => up_to(of.id, weak, self.ask(body, see)?),
            },
            Formula::Each { .. } => self.each(of.id, None, see)?,
        };
        Ok(if of.negated { rest.not() } else { rest })
    }

    fn eventually(&self, wait: Wait, f: Ref, is_in: bool, see: Answers<'_>) -> Result<Rest, Test> {
        let still = Rest::Open(Atom::Still(wait), false);
        if !is_in {
            return Ok(still);
        }
        match self.ask(f, see)? {
            Rest::Known(true) => Ok(Rest::Known(true)),
            here => Ok(Rest::either(here, still)),
        }
    }

    fn until(&self, wait: Wait, (l, r): (Ref, Ref), is_in: bool, see: Answers<'_>) -> Result<Rest, Test> {
        let here = if is_in { self.ask(r, see)? } else { Rest::Known(false) };
        if here == Rest::Known(true) {
            return Ok(here);
        }
        let on = Rest::both(self.ask(l, see)?, Rest::Open(Atom::Still(wait), false));
        Ok(Rest::either(here, on))
    }

    fn still(&self, wait: Wait, see: Answers<'_>) -> Result<Rest, Test> {
        let begun = |bound: &Bound, see: Answers<'_>| match (wait.clock, crate::past::whole(bound).0) {
            (None, _) | (_, 0) => Ok(true),
            (Some(clock), from) => see(Test::Begun(clock, from)),
        };
        match self.get(wait.id) {
            Formula::Eventually(bound, f) => {
                let is_in = begun(&bound, see)?;
                self.eventually(wait, f, is_in, see)
            }
            Formula::Until(bound, l, r) => {
                let is_in = begun(&bound, see)?;
                self.until(wait, (l, r), is_in, see)
            }
            Formula::After(x, body) if holds(x, see)? => self.ask(body, see),
            _ => Ok(Rest::Open(Atom::Still(wait), false)),
        }
    }

    fn each(&self, id: usize, open: Option<&Rest>, see: Answers<'_>) -> Result<Rest, Test> {
        let Formula::Each { x, y, body } = self.get(id) else { return Ok(Rest::Known(true)) };
        let waits = Rest::Open(Atom::Each(id, None), false);
        let closes = match y {
            Some(y) if open.is_some() => holds(y, see)?,
            None => !holds(x, see)?,
            Some(y) => {
                if !holds(x, see)? || holds(y, see)? {
                    return Ok(waits);
                }
                false
            }
        };
        let inside = match open {
            Some(rest) if closes => return Ok(Rest::both(Rest::Known(self.close(rest)), waits)),
            None if closes => return Ok(waits),
            Some(rest) => self.progress(rest, see)?,
            None => self.ask(body, see)?,
        };
        Ok(each(id, inside))
    }

    /// What is left after one more position.
    pub fn progress(&self, rest: &Rest, see: Answers<'_>) -> Result<Rest, Test> {
        match rest {
            Rest::Known(b) => Ok(Rest::Known(*b)),
            Rest::Open(atom, negated) => {
                let rest = self.progress_atom(atom, see)?;
                Ok(if *negated { rest.not() } else { rest })
            }
            Rest::All(of) | Rest::Any(of) => {
                let all = matches!(rest, Rest::All(_));
                let mut parts = Vec::new();
                for part in of {
                    match self.progress(part, see)? {
                        Rest::Known(b) if b != all => return Ok(Rest::Known(b)),
                        part => parts.push(part),
                    }
                }
                Ok(Rest::join(parts, all))
            }
        }
    }

    fn progress_atom(&self, atom: &Atom, see: Answers<'_>) -> Result<Rest, Test> {
        match atom {
            Atom::Next(f) => self.ask(*f, see),
            Atom::Still(wait) => self.still(*wait, see),
            Atom::UpTo(id, rest) => {
                let Formula::UpTo { weak, x, .. } = self.get(*id) else { return Ok(Rest::Known(true)) };
                match holds(x, see)? {
                    true => Ok(Rest::Known(self.close(rest))),
                    false => Ok(up_to(*id, weak, self.progress(rest, see)?)),
                }
            }
            Atom::Each(id, open) => self.each(*id, open.as_deref(), see),
        }
    }

    /// What it comes to where the segment closes.
    pub fn close(&self, rest: &Rest) -> bool {
        match rest {
            Rest::Known(b) => *b,
            Rest::Open(atom, negated) => self.close_atom(atom) != *negated,
            Rest::All(of) => of.iter().all(|r| self.close(r)),
            Rest::Any(of) => of.iter().any(|r| self.close(r)),
        }
    }

    fn close_atom(&self, atom: &Atom) -> bool {
        match atom {
            Atom::Next(_) => false,
            Atom::Still(wait) => matches!(self.get(wait.id), Formula::After(..)),
            Atom::UpTo(id, _) => matches!(self.get(*id), Formula::UpTo { weak: true, .. }),
            Atom::Each(_, open) => open.as_ref().is_none_or(|rest| self.close(rest)),
        }
    }

    /// What it comes to where the trace, as it is, were all; `None` where it is cut off: by a bound that reaches beyond, by `next`.
    pub fn end(&self, rest: &Rest) -> Option<bool> {
        match rest {
            Rest::Known(b) => Some(*b),
            Rest::Open(atom, negated) => self.end_atom(atom).map(|b| b != *negated),
            Rest::All(of) => kleene(of.iter().map(|r| self.end(r)), true),
            Rest::Any(of) => kleene(of.iter().map(|r| self.end(r)), false),
        }
    }

    fn end_atom(&self, atom: &Atom) -> Option<bool> {
        match atom {
            Atom::Next(_) => None,
            Atom::Still(wait) => match self.get(wait.id) {
                Formula::Eventually(bound, _) | Formula::Until(bound, ..) => (!bound.has_end()).then_some(false),
                _ => Some(true),
            },
            Atom::UpTo(..) => Some(self.close_atom(atom)),
            Atom::Each(_, open) => open.as_ref().map_or(Some(true), |rest| self.end(rest)),
        }
    }

    /// Of each clock, the bound that ends first.
    pub fn ends(&self, rest: &Rest) -> Vec<End> {
        let mut ends = Vec::new();
        self.all_ends(rest, &mut ends);
        ends.sort_unstable();
        ends.dedup_by_key(|end| end.clock);
        ends
    }

    fn all_ends(&self, rest: &Rest, ends: &mut Vec<End>) {
        match rest {
            Rest::Known(_) | Rest::Open(Atom::Next(_) | Atom::Each(_, None), _) => {}
            Rest::Open(Atom::Still(wait), _) => ends.extend(self.end_of(wait)),
            Rest::Open(Atom::UpTo(_, of) | Atom::Each(_, Some(of)), _) => self.all_ends(of, ends),
            Rest::All(of) | Rest::Any(of) => of.iter().for_each(|part| self.all_ends(part, ends)),
        }
    }

    fn end_of(&self, wait: &Wait) -> Option<End> {
        match self.get(wait.id) {
            Formula::Eventually(bound, _) | Formula::Until(bound, ..) if bound.has_end() => {
                Some(End { clock: wait.clock?, hi: bound.hi, is_in: bound.hi_closed })
            }
            _ => None,
        }
    }

    /// What is left once that bound is over.
    pub fn expire(&self, rest: &Rest, over: End) -> Rest {
        let inner = |of: &Rest| self.expire(of, over);
        let (rest, negated) = match rest {
            Rest::Known(b) => return Rest::Known(*b),
            Rest::All(of) => return Rest::join(of.iter().map(inner).collect(), true),
            Rest::Any(of) => return Rest::join(of.iter().map(inner).collect(), false),
            Rest::Open(Atom::Still(wait), negated) if self.end_of(wait) == Some(over) => (Rest::Known(false), negated),
            Rest::Open(Atom::UpTo(id, of), negated) => {
                let weak = matches!(self.get(*id), Formula::UpTo { weak: true, .. });
                (up_to(*id, weak, inner(of)), negated)
            }
            Rest::Open(Atom::Each(id, Some(of)), negated) => (each(*id, inner(of)), negated),
            Rest::Open(..) => return rest.clone(),
        };
        if *negated { rest.not() } else { rest }
    }
}

/// The end of a bound: so long after a clock began, and whether that moment is in.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct End {
    pub clock: Clock,
    pub hi: i64,
    pub is_in: bool,
}

fn holds(bit: Bit, see: Answers<'_>) -> Result<bool, Test> {
    Ok(see(Test::Holds(bit.register()))? != bit.is_negated())
}

/// A segment that is open: a body that failed there failed for good.
fn each(id: usize, body: Rest) -> Rest {
    match body {
        Rest::Known(false) => Rest::Known(false),
        body => Rest::Open(Atom::Each(id, Some(Box::new(body))), false),
    }
}

/// A body that goes the way that X cannot change decides; otherwise it waits for X.
fn up_to(id: usize, weak: bool, body: Rest) -> Rest {
    match body {
        Rest::Known(b) if b == weak => Rest::Known(b),
        body => Rest::Open(Atom::UpTo(id, Box::new(body)), false),
    }
}

fn kleene(of: impl Iterator<Item = Option<bool>>, all: bool) -> Option<bool> {
    let mut sum = Some(all);
    for value in of {
        match value {
            Some(b) if b != all => return Some(b),
            Some(_) => {}
            None => sum = None,
        }
    }
    sum
}
