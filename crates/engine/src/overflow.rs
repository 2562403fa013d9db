//! More open obligations than a program allows: the property that has them is given up, with what only it kept. The others go on.

use alloc::vec::Vec;

use crate::group::Core;
use crate::program::{FutureKind, FutureRef, Group, Judged, Look, LookKind};
use crate::standing::GivenUp;

/// For each run of open obligations that a property may have, so many may be kept by an operator that decides them.
const KEPT: usize = 4;

impl Core {
    /// Gives up the properties that have more runs open than `limit`.
    #[cold]
    pub(crate) fn give_up(&mut self, plan: &Group, limit: usize) {
        let too_many = self.too_many(plan, limit);
        if too_many.is_empty() {
            return;
        }
        for (state, tracker) in self.trackers.iter_mut().zip(&plan.trackers) {
            if too_many.contains(&tracker.property) {
                state.give_up(GivenUp::Overflowed);
            }
        }
        self.let_go(plan);
    }

    /// The properties with more runs of open obligations than that, or for which an operator keeps out of proportion many.
    fn too_many(&self, plan: &Group, limit: usize) -> Vec<usize> {
        let most = limit.saturating_mul(KEPT);
        let large: Vec<usize> = self.graph.larger_than(most).collect();
        let keeps_large = |property| {
            let needed = plan.needed(|p| p == property);
            large.iter().any(|&id| needed[id])
        };
        let open = |property| {
            let states = plan.trackers.iter().zip(&self.trackers).filter(|(t, _)| t.property == property);
            states.map(|(_, state)| state.open.len()).sum::<usize>()
        };
        let looks = |property| {
            let of_it = |l: &Look| l.counts.is_some_and(|(p, _)| p == property);
            plan.looks.iter().zip(&self.looks).any(|(look, state)| of_it(look) && state.runs() > most)
        };
        let is_judged = |&property: &usize| {
            plan.trackers.iter().zip(&self.trackers).any(|(t, s)| t.property == property && s.given_up().is_none())
        };
        let properties = plan.properties().into_iter().filter(is_judged);
        properties.filter(|&p| open(p) > limit || looks(p) || (!large.is_empty() && keeps_large(p))).collect()
    }

    /// Lets go of what only properties keep that are not judged any more.
    pub(crate) fn let_go(&mut self, plan: &Group) {
        let judged: Vec<usize> = plan
            .trackers
            .iter()
            .zip(&self.trackers)
            .filter(|(_, state)| state.given_up().is_none())
            .map(|(tracker, _)| tracker.property)
            .collect();
        if judged.len() == plan.trackers.len() {
            return;
        }
        self.graph.let_go(&plan.futures, &plan.needed(|property| judged.contains(&property)));
        for (look, state) in plan.looks.iter().zip(&mut self.looks) {
            if look.counts.is_some_and(|(property, _)| !judged.contains(&property)) {
                state.let_go();
            }
        }
    }
}

impl Group {
    /// The properties that it judges.
    fn properties(&self) -> Vec<usize> {
        let mut properties: Vec<usize> = self.trackers.iter().map(|t| t.property).collect();
        properties.sort_unstable();
        properties.dedup();
        properties
    }

    /// For each future operator, whether one of those properties stands on it.
    fn needed(&self, of: impl Fn(usize) -> bool) -> Vec<bool> {
        let mut needed = alloc::vec![false; self.futures.len()];
        let mut need = |formula: FutureRef| needed[formula.id as usize] = true;
        for tracker in self.trackers.iter().filter(|t| of(t.property)) {
            if let Judged::Future(formula) = tracker.formula {
                need(formula);
            }
        }
        for look in &self.looks {
            if let (LookKind::Proves { formula, .. }, Some((property, _))) = (look.kind, look.counts)
                && of(property)
            {
                need(formula);
            }
        }
        for (id, future) in self.futures.iter().enumerate().rev() {
            if let FutureKind::Survey(survey) = &future.kind {
                needed[id] = of(survey.property);
            }
            if needed[id] {
                future.kind.operands().for_each(|operand| needed[operand.id as usize] = true);
            }
        }
        needed
    }
}
