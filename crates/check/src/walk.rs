//! Ways through the syntax tree that more than one part of the check needs.

use lapwing_syntax::ast::{Bound, Dur, Expr, ExprKind, Ident};

/// Calls `visit` for an expression and all below it, without recursion.
pub(crate) fn every<'e>(expr: &'e Expr, mut visit: impl FnMut(&'e Expr)) {
    let mut open = vec![expr];
    while let Some(expr) = open.pop() {
        visit(expr);
        open.extend(expr.children().into_iter().rev());
    }
}

/// The names of durations in one node: of a bound or of `held for`.
pub(crate) fn duration_names(expr: &Expr) -> Vec<&Ident> {
    let durations: Vec<&Dur> = match &expr.kind {
        ExprKind::Prefix(_, Some(bound), _) | ExprKind::Infix(_, Some(bound), _, _) => ends(bound),
        ExprKind::Held(dur, _) => vec![dur],
        _ => Vec::new(),
    };
    durations.into_iter().filter_map(|d| if let Dur::Name(ident) = d { Some(ident) } else { None }).collect()
}

fn ends(bound: &Bound) -> Vec<&Dur> {
    bound.lo.iter().chain([&bound.hi]).collect()
}

/// Whether an operator of time stands at this very node.
pub(crate) fn is_temporal(expr: &Expr) -> bool {
    matches!(
        expr.kind,
        ExprKind::Prefix(..)
            | ExprKind::Infix(..)
            | ExprKind::Held(..)
            | ExprKind::Scope(..)
            | ExprKind::AfterUntil(..)
            | ExprKind::Ltl(_)
    )
}
