//! Where anybody asks for the value of a future operator. `whenever X, eventually Y` is `not (X and not eventually Y)` at each position,
//! and where X does not hold nobody needs to know whether Y comes: what is not asked is not kept open, and has no deadline.

use alloc::vec::Vec;

use super::formula::{Future, FutureKind, FutureRef, Group};
use super::{Bit, Judged, LookKind};

impl Group {
    /// Notes at each future operator where it is asked for.
    pub(super) fn ask(&mut self) {
        let uses = self.uses();
        let asked: Vec<Option<Bit>> = (0..self.futures.len())
            .map(|id| match uses[id] {
                Use::Once(user) => self.condition(id, user),
                Use::Never | Use::Often => None,
            })
            .collect();
        self.futures.iter_mut().zip(asked).for_each(|(future, asked)| future.asked = asked);
    }

    /// By what each node is used.
    fn uses(&self) -> Vec<Use> {
        let mut uses = alloc::vec![Use::Never; self.futures.len()];
        let mut used = |of: FutureRef, by: Use| {
            if let Some(known) = uses.get_mut(of.id as usize) {
                *known = if matches!(known, Use::Never) { by } else { Use::Often };
            }
        };
        for (user, future) in self.futures.iter().enumerate() {
            future.kind.operands().for_each(|of| used(of, Use::Once(user)));
        }
        for tracker in &self.trackers {
            if let Judged::Future(of) = tracker.formula {
                used(of, Use::Often);
            }
        }
        for look in &self.looks {
            if let LookKind::Proves { formula, .. } = look.kind {
                used(formula, Use::Often);
            }
        }
        uses
    }

    /// What decides, where it is false, the only node that uses another one: the state formula beside it in a conjunction.
    fn condition(&self, id: usize, user: usize) -> Option<Bit> {
        let (node, user) = (&self.futures[id], &self.futures[user]);
        let FutureKind::And(l, r) = user.kind else { return None };
        let beside = if l.id as usize == id { r } else { l };
        match self.futures.get(beside.id as usize) {
            Some(&Future { kind: FutureKind::State(bit), context, .. })
                if context == user.context && node.context == user.context =>
            {
                Some(if beside.negated { !bit } else { bit })
            }
            _ => None,
        }
    }
}

/// By what a node is used.
#[derive(Clone, Copy)]
enum Use {
    Never,
    /// By one node, of that number.
    Once(usize),
    /// By more, or by what asks everywhere.
    Often,
}
