//! Formulas about the future, as the automaton's construction takes them: the engine's graph and its replayed formulas in one table.

use lapwing_engine::program::{Bit, Bound, ContextKind, FutureKind, FutureRef, Group, Replay, Term};

/// A formula of the table, or its negation.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct Ref {
    pub id: usize,
    pub negated: bool,
}

impl std::ops::Not for Ref {
    type Output = Ref;
    fn not(self) -> Ref {
        Ref { negated: !self.negated, ..self }
    }
}

/// A formula over those before it in the table.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Formula {
    State(Bit),
    And(Ref, Ref),
    Eventually(Bound, Ref),
    Next(Ref),
    /// left until right
    Until(Bound, Ref, Ref),
    /// `after X, body`
    After(Bit, Ref),
    /// `until X, body`; with `weak`, `before X, body`
    UpTo {
        weak: bool,
        x: Bit,
        body: Ref,
    },
    /// `after_until X, Y, body`; without Y, `while X, body`
    Each {
        x: Bit,
        y: Option<Bit>,
        body: Ref,
    },
}

/// What a formula cannot be generated for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Beyond {
    /// A scope that opens or closes on a formula about the future.
    OpensLate,
    /// Bounds that begin at ever more positions, of which none tells more than the others.
    LateBound,
    /// An automaton of more states or moves than are worth writing down.
    TooLarge,
}

/// The formulas of a group.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    formulas: Vec<Formula>,
}

impl Table {
    pub fn get(&self, id: usize) -> Formula {
        self.formulas[id]
    }

    fn add(&mut self, formula: Formula) -> Ref {
        let found = self.formulas.iter().position(|f| *f == formula);
        let id = found.unwrap_or_else(|| {
            self.formulas.push(formula);
            self.formulas.len() - 1
        });
        Ref { id, negated: false }
    }

    pub fn state(&mut self, bit: Bit) -> Ref {
        self.add(Formula::State(bit))
    }

    /// Takes a node of a group's graph in, and what it stands on. Gives the gates that stand before it as well, the innermost first.
    pub fn take(&mut self, group: &Group, of: FutureRef) -> Result<(Ref, Vec<usize>), Beyond> {
        let mut gates = Vec::new();
        let mut of = of;
        while let FutureKind::Gate { body, before } = group.futures[of.id as usize].kind {
            // Gates are never negated: they stand outermost.
            gates.push(before as usize);
            of = body;
        }
        gates.reverse();
        Ok((self.node(group, of)?, gates))
    }

    fn node(&mut self, group: &Group, of: FutureRef) -> Result<Ref, Beyond> {
        let formula = match &group.futures[of.id as usize].kind {
            FutureKind::State(bit) => Formula::State(*bit),
            FutureKind::And(l, r) => Formula::And(self.node(group, *l)?, self.node(group, *r)?),
            FutureKind::Eventually(bound, f) => Formula::Eventually(*bound, self.node(group, *f)?),
            FutureKind::Next(f) => Formula::Next(self.node(group, *f)?),
            FutureKind::Until(bound, l, r) => {
                let (l, r) = (self.state(*l), self.state(*r));
                Formula::Until(*bound, l, r)
            }
            FutureKind::After { x, body, .. } => Formula::After(*x, self.node(group, *body)?),
            FutureKind::UntilScope { weak, x, body, .. } => {
                Formula::UpTo { weak: *weak, x: *x, body: self.node(group, *body)? }
            }
            FutureKind::Each { x, body, inner } => {
                let y = match group.contexts[*inner as usize].kind {
                    ContextKind::AfterUntil { y, .. } => Some(y),
                    _ => None,
                };
                Formula::Each { x: *x, y, body: self.node(group, *body)? }
            }
            // No obligation stands on a survey.
            FutureKind::Gate { .. } | FutureKind::Survey(_) => return Err(Beyond::OpensLate),
            FutureKind::Replay(replay) => {
                let is = self.replayed(replay)?;
                return Ok(if of.negated { !is } else { is });
            }
        };
        let is = self.add(formula);
        Ok(if of.negated { !is } else { is })
    }

    fn replayed(&mut self, replay: &Replay) -> Result<Ref, Beyond> {
        let mut refs: Vec<Ref> = Vec::new();
        for term in &replay.terms {
            let is = self.term(replay, term, &refs)?;
            refs.push(is);
        }
        refs.last().copied().ok_or(Beyond::OpensLate)
    }

    fn term(&mut self, replay: &Replay, term: &Term, refs: &[Ref]) -> Result<Ref, Beyond> {
        let leaf = |i: usize| match &replay.terms[i] {
            Term::Leaf(leaf) => Ok(replay.leaves[*leaf]),
            _ => Err(Beyond::OpensLate),
        };
        let formula = match *term {
            Term::Leaf(leaf) => Formula::State(replay.leaves[leaf]),
            Term::Not(f) => return Ok(!refs[f]),
            Term::And(l, r) => Formula::And(refs[l], refs[r]),
            Term::Or(l, r) => return Ok(!self.add(Formula::And(!refs[l], !refs[r]))),
            Term::Iff(l, r) => {
                let one = self.add(Formula::And(refs[l], !refs[r]));
                let other = self.add(Formula::And(refs[r], !refs[l]));
                Formula::And(!one, !other)
            }
            Term::Always(bound, f) => return Ok(!self.add(Formula::Eventually(bound, !refs[f]))),
            Term::Eventually(bound, f) => Formula::Eventually(bound, refs[f]),
            Term::Next(f) => Formula::Next(refs[f]),
            Term::Until(bound, l, r) => Formula::Until(bound, refs[l], refs[r]),
            Term::After(x, f) => Formula::After(leaf(x)?, refs[f]),
            Term::UntilScope(x, f) => Formula::UpTo { weak: false, x: leaf(x)?, body: refs[f] },
            Term::Before(x, f) => Formula::UpTo { weak: true, x: leaf(x)?, body: refs[f] },
            Term::AfterUntil(x, y, f) => Formula::Each { x: leaf(x)?, y: Some(leaf(y)?), body: refs[f] },
            Term::While(x, f) => Formula::Each { x: leaf(x)?, y: None, body: refs[f] },
        };
        Ok(self.add(formula))
    }
}
