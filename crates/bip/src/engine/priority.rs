//! What goes first: larger interactions before smaller ones of their connector, then the rules of compounds; and within atoms, ports.
//!
//! What goes first takes from the window of what yields the moments in which it is possible itself. What remains may fall into pieces: the first
//! piece that is not over counts, and the others are looked at when it is.

use super::atom::Found;
use super::{Engine, Fault, computation};
use crate::code::Table;
use crate::host::Host;
use crate::model::{Atom, Model, among, is_part};
use crate::template;
use crate::time::Window;

/// What remains of a window from now on when others are taken from it: its first piece, and whether there may be later ones.
fn remainder(window: Window, now: i64, masks: &mut [Window]) -> (Window, bool) {
    masks.sort_unstable_by_key(|m| m.first);
    let mut rest = window;
    let mut from = window.first.max(now);
    for mask in masks.iter() {
        if mask.last < from {
            continue;
        }
        if mask.first > from {
            if mask.first <= rest.last {
                rest.last = mask.first - 1;
                rest.open_right = !mask.open_left;
                return (rest, true);
            }
            return (rest, false);
        }
        if mask.last >= rest.last {
            return (Window::NONE, false);
        }
        from = mask.last + 1;
        rest.first = from;
        rest.open_left = !mask.open_right;
    }
    (rest, false)
}

impl<H: Host> Engine<H> {
    /// What others leave of the window of a move: the one at that place among those that are live.
    pub(super) fn left_by_rivals(&mut self, model: &Model, live: &[u32], place: usize, window: Window) -> Window {
        let Some(id) = live.get(place).copied() else { return window };
        let mut masks = std::mem::take(&mut self.scratch.masks);
        masks.clear();
        if !self.rules.without_maximal_progress {
            self.larger(model, live, place, &mut masks);
            self.inner_masks(model, id, &mut masks);
        }
        if !model.rules.is_empty() {
            self.ruled(model, live, id, &mut masks);
        }
        let rest = match masks.is_empty() {
            true => window,
            false => remainder(window, self.now, &mut masks).0,
        };
        self.scratch.masks = masks;
        rest
    }

    /// Windows of larger interactions of the same connector. They come later in the list, the largest last.
    fn larger(&self, model: &Model, live: &[u32], place: usize, masks: &mut Vec<Window>) {
        let Some(one) = live.get(place).and_then(|id| model.moves.get(*id as usize)) else { return };
        let Some(connector) = model.connectors.get(one.connector as usize) else { return };
        let others = live.get(place + 1..).unwrap_or(&[]);
        let count = others.partition_point(|id| *id < connector.moves.end);
        for id in others.iter().take(count).rev() {
            let is_larger = model.moves.get(*id as usize).is_some_and(|other| is_part(&one.leaves, &other.leaves));
            if let Some(other) = self.moves.get(*id as usize).filter(|_| is_larger) {
                masks.push(other.window);
                if other.window == Window::ALL {
                    return;
                }
            }
        }
    }

    /// Windows of inner moves that are larger than what takes part in a move out of a compound.
    fn inner_masks(&self, model: &Model, id: u32, masks: &mut Vec<Window>) {
        let larger = model.moves.get(id as usize).map_or(&[][..], |one| &one.larger);
        for inner in larger.iter().filter(|inner| self.scratch.seen.has(**inner)) {
            masks.extend(self.moves.get(*inner as usize).map(|m| m.window));
        }
    }

    /// Notes which inner moves are seen in this state: those that are possible, and of whose parts none is hidden.
    pub(super) fn judge_inner(&mut self, model: &Model) {
        // What a compound is made of comes before it.
        for id in model.first_inner..model.moves.len() as u32 {
            let is_seen = self.enabled.has(id) && !self.is_hidden(model, id);
            if is_seen { self.scratch.seen.add(id) } else { self.scratch.seen.remove(id) }
        }
    }

    /// Whether larger moves of a compound that it exports are possible whenever a move is.
    pub(super) fn is_hidden(&mut self, model: &Model, id: u32) -> bool {
        let has_larger = model.moves.get(id as usize).is_some_and(|one| !one.larger.is_empty());
        let Some(window) = self.moves.get(id as usize).map(|m| m.window).filter(|_| has_larger) else { return false };
        if self.rules.without_maximal_progress {
            return false;
        }
        let mut masks = std::mem::take(&mut self.scratch.masks);
        masks.clear();
        self.inner_masks(model, id, &mut masks);
        let is_hidden = !masks.is_empty() && remainder(window, self.now, &mut masks).0.is_empty();
        self.scratch.masks = masks;
        is_hidden
    }

    /// Notes which rules hold in this state.
    pub(super) fn judge_rules(&mut self, model: &Model) -> Result<(), Fault> {
        let mut active = std::mem::take(&mut self.scratch.active);
        active.clear();
        for rule in &model.rules {
            let holds = match &rule.guard {
                None => true,
                Some(guard) => {
                    let at = Table { cells: &guard.cells, objects: &guard.objects };
                    guard.condition.eval(at, &mut self.context(None)).map_err(computation("a priority"))?
                }
            };
            active.push(holds);
        }
        self.scratch.active = active;
        if model.may_cycle { self.find_cycle(model) } else { Ok(()) }
    }

    /// Windows of moves that go before one by the rules, directly or by way of others.
    fn ruled(&mut self, model: &Model, live: &[u32], id: u32, masks: &mut Vec<Window>) {
        let mut reached = std::mem::take(&mut self.scratch.reached);
        reached.clear();
        let plain = self.rules.without_maximal_progress;
        let is_active = |rule: &u32| self.scratch.active.get(*rule as usize).copied().unwrap_or(false);
        let yields = |(rule, r): &(u32, &crate::model::Rule)| is_active(rule) && among(r.yielding(plain), id);
        reached.extend((0..).zip(&model.rules).filter(yields).map(|(rule, _)| rule));
        let mut at = 0;
        while let Some(rule) = reached.get(at).and_then(|rule| model.rules.get(*rule as usize)) {
            at += 1;
            let precedes = |other: &&u32| **other != id && among(rule.preceding(plain), **other);
            for other in live.iter().filter(precedes) {
                masks.extend(self.moves.get(*other as usize).map(|m| m.window));
            }
            for next in rule.next.iter().filter(|next| is_active(next)) {
                if !reached.contains(next) {
                    reached.push(*next);
                }
            }
        }
        self.scratch.reached = reached;
    }

    /// Looks for a circle among the moves that are live.
    fn find_cycle(&self, model: &Model) -> Result<(), Fault> {
        let live = &self.scratch.live;
        let goes_before = |low: u32, high: u32| {
            let by_rule = |rule: &crate::model::Rule| among(&rule.low, low) && among(&rule.high, high);
            let rules = self.scratch.active.iter().zip(&model.rules);
            let by_size = || match (model.moves.get(low as usize), model.moves.get(high as usize)) {
                (Some(a), Some(b)) => {
                    a.connector == b.connector && is_part(&a.leaves, &b.leaves) && !self.rules.without_maximal_progress
                }
                _ => false,
            };
            rules.into_iter().any(|(active, rule)| *active && by_rule(rule)) || by_size()
        };
        match cycle(live, goes_before) {
            None => Ok(()),
            Some(all) => {
                let shown = all.into_iter().map(|id| self.show_move(super::MoveId(id)));
                Err(Fault::PriorityCycle(shown.collect()))
            }
        }
    }

    /// Takes from ports of an atom what its priorities give to others.
    pub(super) fn apply_priorities(
        &mut self,
        atom: &Atom,
        ty: &template::Atom,
        id: u32,
        found: &mut Vec<Found>,
    ) -> Result<(), Fault> {
        let mut pairs = Vec::new();
        for rule in &ty.priorities {
            let holds = match &rule.guard {
                None => true,
                Some(guard) => guard.eval(atom.base, &mut self.context(Some(id))).map_err(computation(&atom.path))?,
            };
            let ports = 0..ty.ports.len() as u32;
            let side = |wanted: Option<u32>| ports.clone().filter(move |port| wanted.is_none_or(|w| w == *port));
            for low in side(rule.low).filter(|_| holds) {
                pairs.extend(side(rule.high).filter(|high| *high != low).map(|high| (low, high)));
            }
        }
        let shown: Vec<u32> = found.iter().map(|f| f.port).collect();
        if let Some(circle) = cycle(&shown, |low, high| pairs.contains(&(low, high))) {
            let name = |port: u32| ty.ports.get(port as usize).map(|p| p.name.clone());
            let ports = circle.into_iter().filter_map(name).collect();
            return Err(Fault::AtomPriorityCycle { atom: atom.path.clone(), ports });
        }
        let before = found.clone();
        let mut changes_at = self.atoms.get(id as usize).map_or(i64::MAX, |s| s.changes_at);
        found.retain_mut(|one| {
            let above = above(one.port, &pairs);
            let others = before.iter().filter(|other| other.port != one.port && above.contains(&other.port));
            let mut masks: Vec<Window> = others.map(|other| other.window).collect();
            let end = masks.iter().map(|m| m.last).filter(|last| *last >= self.now && *last < one.window.last).min();
            let (window, has_more) = remainder(one.window, self.now, &mut masks);
            if has_more {
                changes_at = changes_at.min(end.map_or(i64::MAX, |last| last + 1));
            }
            one.window = window;
            !window.is_empty()
        });
        self.set_change(id, changes_at);
        Ok(())
    }
}

/// The ports that go before one, directly or by way of others.
fn above(port: u32, pairs: &[(u32, u32)]) -> Vec<u32> {
    let mut all = Vec::new();
    let mut left = vec![port];
    while let Some(at) = left.pop() {
        for (_, high) in pairs.iter().filter(|(low, _)| *low == at) {
            if !all.contains(high) {
                all.push(*high);
                left.push(*high);
            }
        }
    }
    all
}

/// Nodes of a graph that follow one another in a circle.
fn cycle(nodes: &[u32], follows: impl Fn(u32, u32) -> bool) -> Option<Vec<u32>> {
    // Nodes that nothing follows are taken away until none is left, or only those are that lead into a circle.
    let mut left: Vec<u32> = nodes.to_vec();
    loop {
        let kept: Vec<u32> = left.iter().copied().filter(|a| left.iter().any(|b| follows(*a, *b))).collect();
        if kept.len() == left.len() {
            break;
        }
        left = kept;
    }
    let mut path = vec![*left.first()?];
    loop {
        let at = *path.last()?;
        let next = left.iter().copied().find(|b| follows(at, *b))?;
        if let Some(start) = path.iter().position(|seen| *seen == next) {
            return path.get(start..).map(<[u32]>::to_vec);
        }
        path.push(next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(first: i64, last: i64) -> Window {
        Window { first, last, ..Window::ALL }
    }

    #[test]
    fn what_remains_of_a_window() {
        let rest = |masks: &[Window]| remainder(window(0, 20), 0, &mut masks.to_vec()).0.to_string();
        assert_eq!(rest(&[]), "[ 0, 20ns ]");
        assert_eq!(rest(&[window(5, 10)]), "[ 0, 5ns [", "the piece before");
        assert_eq!(rest(&[window(3, 8), window(0, 5)]), "] 8ns, 20ns ]", "pieces that overlap, in any order");
        assert_eq!(rest(&[window(-5, 30)]), Window::NONE.to_string());
        assert_eq!(
            remainder(window(0, 20), 9, &mut [window(5, 10)]).0.to_string(),
            "] 10ns, 20ns ]",
            "the piece after"
        );
        assert_eq!(rest(&[window(30, 40)]), "[ 0, 20ns ]");
    }

    #[test]
    fn circles_are_found() {
        let follows = |pairs: &'static [(u32, u32)]| move |a, b| pairs.contains(&(a, b));
        assert_eq!(cycle(&[1, 2, 3], follows(&[(1, 2), (2, 3)])), None);
        assert_eq!(cycle(&[1, 2, 3], follows(&[(1, 2), (2, 3), (3, 2)])), Some(vec![2, 3]));
        assert_eq!(cycle(&[], follows(&[])), None);
    }
}
