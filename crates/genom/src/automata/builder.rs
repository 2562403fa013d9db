//! An automaton while it is being made.

use lapwing_diag::Span;

use super::{Action, Automaton, Class, ClockGuard, Cond, Edge, LocId, Location, Part};
use crate::model::CodelId;

/// Makes an automaton: locations by name, edges with names of their own.
pub(super) struct Builder {
    automaton: Automaton,
}

/// An edge but for its name and what is rarely said.
pub(super) struct Draft {
    pub from: LocId,
    pub to: LocId,
    pub class: Class,
    pub guard: Cond,
    pub actions: Vec<Action>,
    pub span: Span,
}

impl Builder {
    pub(super) fn new(name: String, part: Part, component: usize, span: Span) -> Builder {
        Builder { automaton: Automaton { name, part, component, span, locations: Vec::new(), edges: Vec::new() } }
    }

    /// Adds a location; a name that is taken gets a number.
    pub(super) fn location(
        &mut self,
        name: &str,
        codel: Option<CodelId>,
        invariant_ns: Option<u64>,
        span: Span,
    ) -> LocId {
        let name = unique(name, |n| self.automaton.locations.iter().any(|l| l.name == n));
        self.automaton.locations.push(Location { name, invariant_ns, codel, span });
        LocId(self.automaton.locations.len() - 1)
    }

    /// Adds an edge that is neither eager nor bound to the clock, under the names of its ends.
    pub(super) fn edge(&mut self, draft: Draft) -> &mut Edge {
        let name = |id: LocId| self.automaton.locations.get(id.0).map_or("", |l| l.name.as_str());
        let name = format!("{}_to_{}", name(draft.from), name(draft.to));
        self.named(&name, draft)
    }

    /// Adds an edge under a name.
    pub(super) fn named(&mut self, name: &str, draft: Draft) -> &mut Edge {
        let name = unique(name, |n| self.automaton.edges.iter().any(|e| e.name == n));
        self.automaton.edges.push(Edge {
            name,
            from: draft.from,
            to: draft.to,
            class: draft.class,
            request: None,
            guard: draft.guard,
            clock: None,
            eager: false,
            actions: draft.actions,
            resets: false,
            call: None,
            is_refusal: false,
            concludes: None,
            span: draft.span,
        });
        let last = self.automaton.edges.len() - 1;
        &mut self.automaton.edges[last]
    }

    pub(super) fn finish(self) -> Automaton {
        self.automaton
    }
}

impl Edge {
    /// Time may not pass while it can be taken.
    pub(super) fn eager(&mut self) -> &mut Edge {
        self.eager = true;
        self
    }

    /// It sets the clock to zero, or does not.
    pub(super) fn resets(&mut self, resets: bool) -> &mut Edge {
        self.resets = resets;
        self
    }

    /// It waits for the clock.
    pub(super) fn clock(&mut self, guard: ClockGuard) -> &mut Edge {
        self.clock = Some(guard);
        self
    }
}

/// A name that is not taken: itself, or itself with a number.
pub(super) fn unique(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    if !is_taken(name) {
        return name.to_owned();
    }
    let mut number = 2_usize;
    loop {
        let numbered = format!("{name}_{number}");
        if !is_taken(&numbered) {
            return numbered;
        }
        number += 1;
    }
}
