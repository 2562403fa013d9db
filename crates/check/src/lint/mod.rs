//! Lints: what is allowed and probably not meant.

mod and_or;
mod float_equality;
mod judged_once;
mod judgement;
mod range;
mod unused;

pub(crate) use float_equality::float_equality;

use lapwing_syntax::ast;

use crate::checked::Expr;
use crate::context::Cx;
use crate::graph::exprs;

/// The lints that look at the text alone.
pub(crate) fn text(cx: &mut Cx) {
    let names = cx.names;
    for entry in names.items.iter().filter(|e| !e.library) {
        exprs(&entry.item.kind).into_iter().for_each(|expr| and_or::check(cx, expr));
    }
    unused::check(cx);
}

/// The lints that look at a whole property, by its first instance.
pub(crate) fn property(cx: &mut Cx, written: &ast::Expr, formula: &Expr, property: usize) {
    judged_once::check(cx, written, formula);
    judgement::check(cx, written, formula, property);
}
