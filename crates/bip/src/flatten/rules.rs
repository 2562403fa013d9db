//! Priorities as rules between moves.

use super::instance::{Child, Tree};
use super::{Builder, Flat, limit, too_large};
use crate::model::{Connector, Rule, RuleGuard};
use crate::template::{Compound, Priority, PriorityGuard, Side};
use std::ops::Range;

impl Builder<'_> {
    /// The rules of a compound and of those that it is made of.
    pub(super) fn rules(&mut self, tree: &Tree) -> Flat<Vec<Rule>> {
        let mut rules = Vec::new();
        self.collect(tree, &mut rules)?;
        let follows = |rule: &Rule, other: &Rule| overlap(&rule.around_high, &other.within_low);
        let next: Vec<Vec<u32>> = rules
            .iter()
            .map(|rule| (0..).zip(&rules).filter(|(_, other)| follows(rule, other)).map(|(id, _)| id).collect())
            .collect();
        for (rule, next) in rules.iter_mut().zip(next) {
            rule.next = next;
        }
        Ok(rules)
    }

    fn collect(&mut self, tree: &Tree, rules: &mut Vec<Rule>) -> Flat<()> {
        let library = self.library;
        let Some(compound) = library.compounds.get(tree.ty as usize) else { return Ok(()) };
        if rules.len() + compound.priorities.len() > limit::RULES {
            return too_large(compound.span, format!("the model has more than {} priorities", limit::RULES));
        }
        for priority in &compound.priorities {
            let rule = self.rule(tree, compound, priority);
            rules.push(rule);
        }
        for child in &tree.children {
            if let Child::Compound(inner) = child {
                self.collect(inner, rules)?;
            }
        }
        Ok(())
    }

    fn rule(&mut self, tree: &Tree, compound: &Compound, priority: &Priority) -> Rule {
        let side = |side, speaks_of| self.side(tree, side, speaks_of);
        let (low, high) = (side(&priority.low, is_same), side(&priority.high, is_same));
        let (within_low, around_high) = (side(&priority.low, is_within), side(&priority.high, is_around));
        let all = || Some(tree.moves.iter().flatten().cloned().collect::<Vec<_>>());
        // `*:*` is everything but what stands on the other side.
        let (low, high) = match (low, high) {
            (None, high) => (without(all(), high.as_deref()), high.unwrap_or_default()),
            (Some(low), None) => {
                let high = without(all(), Some(&low));
                (low, high)
            }
            (Some(low), Some(high)) => (low, high),
        };
        let (within_low, around_high) =
            (within_low.unwrap_or_else(|| low.clone()), around_high.unwrap_or_else(|| high.clone()));
        let guard = priority.guard.as_ref().map(|guard| self.guard(tree, compound, guard));
        Rule { low, high, within_low, around_high, guard, next: Vec::new() }
    }

    /// The moves that a side speaks of, by the ports that it names and those of the move; none where it is `*:*`.
    fn side(&self, tree: &Tree, side: &Side, speaks_of: fn(&[u32], &[u32]) -> bool) -> Option<Vec<Range<u32>>> {
        let moves = |connector: u32| tree.moves.get(connector as usize).cloned().flatten();
        match side {
            Side::Any => None,
            Side::Connector(connector) => Some(moves(*connector).into_iter().collect()),
            Side::Interaction(connector, ports) => {
                let is_it = |id: &u32| {
                    let labels = self.moves.get(*id as usize).map(|m| m.parts.iter().map(|(label, _)| *label));
                    labels.is_some_and(|labels| speaks_of(ports, &labels.collect::<Vec<u32>>()))
                };
                Some(moves(*connector)?.filter(is_it).map(|id| id..id + 1).collect())
            }
        }
    }

    /// A guard with the places of what it names: parameters of the compound get places of their own.
    fn guard(&mut self, tree: &Tree, compound: &Compound, guard: &PriorityGuard) -> RuleGuard {
        let (mut cells, mut objects) = (Vec::new(), Vec::new());
        let own = compound.frame.vars.iter().zip(&tree.args);
        let own: Vec<_> = own.map(|(var, value)| (var.ty, var.slot, self.memory.allocate(var.ty, value))).collect();
        let seen = guard.seen.iter().filter_map(|(var, component, name)| {
            let (_, at) = self.exported(tree.children.get(*component as usize)?, name)?;
            Some((var.ty, var.slot, at))
        });
        for (ty, slot, at) in own.into_iter().chain(seen) {
            let list = if ty.is_plain() { &mut cells } else { &mut objects };
            if list.len() <= slot as usize {
                list.resize(slot as usize + 1, u32::MAX);
            }
            if let Some(place) = list.get_mut(slot as usize) {
                *place = at;
            }
        }
        RuleGuard { condition: guard.condition.clone(), cells: cells.into(), objects: objects.into() }
    }
}

/// Whether the ports of a move are those that are named.
fn is_same(named: &[u32], one: &[u32]) -> bool {
    named == one
}

/// Whether the ports of a move are among those that are named.
fn is_within(named: &[u32], one: &[u32]) -> bool {
    one.iter().all(|port| named.contains(port))
}

/// Whether the ports that are named are among those of a move.
fn is_around(named: &[u32], one: &[u32]) -> bool {
    is_within(one, named)
}

/// Moves that are not among others.
fn without(all: Option<Vec<Range<u32>>>, others: Option<&[Range<u32>]>) -> Vec<Range<u32>> {
    let others = others.unwrap_or(&[]);
    let single = all.unwrap_or_default().into_iter().flatten().filter(|id| !crate::model::among(others, *id));
    let mut ranges: Vec<Range<u32>> = Vec::new();
    for id in single {
        match ranges.last_mut() {
            Some(last) if last.end == id => last.end += 1,
            _ => ranges.push(id..id + 1),
        }
    }
    ranges
}

fn overlap(some: &[Range<u32>], others: &[Range<u32>]) -> bool {
    some.iter().any(|a| others.iter().any(|b| a.start < b.end && b.start < a.end))
}

/// Whether rules, together with the precedence of larger interactions of a connector, can go in a circle.
pub(super) fn may_cycle(connectors: &[Connector], rules: &[Rule]) -> bool {
    let meets = |range: &Range<u32>| connectors.iter().position(|c| c.moves.contains(&range.start));
    // Connectors are asked for and not moves: within a connector larger interactions go first.
    let sides: Vec<(Vec<usize>, Vec<usize>)> = rules
        .iter()
        .map(|r| (r.low.iter().filter_map(meets).collect(), r.high.iter().filter_map(meets).collect()))
        .collect();
    let follows = |from: usize, to: usize| match (sides.get(from), sides.get(to)) {
        (Some((_, high)), Some((low, _))) => high.iter().any(|c| low.contains(c)),
        _ => false,
    };
    // Rules that nothing can follow any more are taken away until none is left or all that are left follow one another.
    let mut left: Vec<usize> = (0..rules.len()).collect();
    loop {
        let kept: Vec<usize> =
            left.iter().copied().filter(|rule| left.iter().any(|other| follows(*rule, *other))).collect();
        if kept.is_empty() || kept.len() == left.len() {
            return !kept.is_empty();
        }
        left = kept;
    }
}
