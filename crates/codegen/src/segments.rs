//! The segments in which formulas stand: opened and closed by scopes, position by position.

use lapwing_engine::program::{Context, ContextKind, Group};

use crate::code::{Block, Expr, Ty, Unit, field, local};
use crate::value::bit;

/// The contexts of a group.
pub(crate) struct Segments<'a> {
    pub contexts: &'a [Context],
    pub prefix: &'a str,
}

impl<'a> Segments<'a> {
    pub fn of(group: &'a Group, prefix: &'a str) -> Segments<'a> {
        Segments { contexts: &group.contexts, prefix }
    }

    fn name(&self, context: usize, what: &str) -> String {
        format!("{}_c{context}_{what}", self.prefix)
    }

    /// Whether a segment is open.
    fn open(&self, context: usize) -> Expr {
        field(self.name(context, "open"))
    }

    /// Whether the position belongs to a segment; whether it is its first.
    pub fn active(&self, context: usize) -> Expr {
        if context == 0 { Expr::Bool(true) } else { self.open(context) }
    }

    pub fn first(&self, context: usize) -> Expr {
        local(format!("first{context}"))
    }

    /// Whether a segment closed just before this position, and whether by the scope's own condition.
    pub fn closes(&self, context: usize) -> Expr {
        if context == 0 { Expr::Bool(false) } else { local(format!("closes{context}")) }
    }

    pub fn closed_by_own(&self, context: usize) -> Expr {
        local(format!("own{context}"))
    }

    /// The stamp of its first position.
    pub fn start(&self, context: usize) -> Expr {
        field(self.name(context, "start"))
    }

    /// Takes a position into all contexts, the outer before the inner.
    pub fn step(&self, unit: &mut Unit, b: &mut Block) {
        for (i, context) in self.contexts.iter().enumerate() {
            let open = unit.field(&self.name(i, "open"), Ty::Bool, false.into(), "Whether a segment is open.");
            unit.field(&self.name(i, "start"), Ty::I64, 0.into(), "When it began.");
            match context.kind {
                ContextKind::Whole => {
                    b.bind(format!("first{i}"), Ty::Bool, !open.clone());
                    b.set(&open, true);
                }
                kind => self.inner(unit, b, i, kind, context.parent as usize),
            }
            b.when(self.first(i), |b| b.set(&self.start(i), local("now")));
        }
    }

    fn inner(&self, unit: &mut Unit, b: &mut Block, i: usize, kind: ContextKind, parent: usize) {
        let open = self.open(i);
        let outer_closes = b.bind(format!("cut{i}"), Ty::Bool, open.clone() & self.closes(parent));
        let was_open = b.bind(format!("was{i}"), Ty::Bool, open.clone() & !outer_closes.clone());
        let spent = field(self.name(i, "spent"));
        let has_spent = matches!(kind, ContextKind::After { .. } | ContextKind::Until { again: false, .. });
        if has_spent {
            unit.field(&self.name(i, "spent"), Ty::Bool, false.into(), "Whether no further segment can come.");
            b.when(self.first(parent) | outer_closes.clone(), |b| b.set(&spent, false));
        }
        let inside = self.active(parent);
        let is = inside.clone()
            & match kind {
                ContextKind::Whole => Expr::Bool(true),
                ContextKind::After { x } => was_open.clone() | bit(x),
                ContextKind::Until { x, again: true } => !bit(x),
                ContextKind::Until { x, again: false } => !bit(x) & !spent.clone(),
                ContextKind::AfterUntil { x, y } => !bit(y) & (was_open.clone() | bit(x)),
                ContextKind::While { x } => bit(x),
            };
        let is = b.bind(format!("is{i}"), Ty::Bool, is);
        if let ContextKind::Until { x, again: false } = kind {
            b.when(inside.clone() & bit(x), |b| b.set(&spent, true));
        }
        let ends = b.bind(format!("ends{i}"), Ty::Bool, was_open.clone() & !is.clone());
        b.bind(format!("closes{i}"), Ty::Bool, outer_closes | ends.clone());
        b.bind(format!("own{i}"), Ty::Bool, ends & inside);
        b.bind(format!("first{i}"), Ty::Bool, is.clone() & !was_open);
        if let ContextKind::After { .. } = kind {
            b.when(is.clone(), |b| b.set(&spent, true));
        }
        b.set(&open, is);
    }

    /// Whether a context has a segment open, and whether it can have a new one.
    pub fn prospects(&self, context: usize) -> (Expr, Expr) {
        let open = self.open(context);
        if context == 0 {
            return (true.into(), !open);
        }
        let (outer_open, outer_new) = self.prospects(self.contexts[context].parent as usize);
        let spent = field(self.name(context, "spent"));
        match self.contexts[context].kind {
            ContextKind::Whole => (true.into(), false.into()),
            ContextKind::After { .. } => (open, outer_new | (outer_open & !spent)),
            ContextKind::Until { again: false, .. } => (open, outer_new),
            _ => (open, outer_open | outer_new),
        }
    }
}
