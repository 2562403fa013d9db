//! `judged-once`: a formula that mixes a state with the future at its top looks at the first position only.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_syntax::ast;

use crate::checked::{Connective, Expr, Kind};
use crate::context::{Cx, Env};
use crate::walk;

/// Looks at the top of a formula, which was written so; a conjunction of formulas about the future is two of them.
pub(super) fn check(cx: &mut Cx, written: &ast::Expr, formula: &Expr) {
    if let Kind::Connective(Connective::And, left, right) = &formula.kind
        && left.has_future()
        && right.has_future()
    {
        check(cx, written, left);
        return check(cx, written, right);
    }
    let Some((state, rest)) = mixed(formula) else { return };
    let text = |e: &Expr| cx.sources.slice(e.span).to_owned();
    let mut diagnostic = Diagnostic::new(Code::JudgedOnce, formula.span, "this is judged once, at the beginning")
        .label("not checked again later")
        .also(state.span, "only its first value counts");
    // Only what stands in the order of the proposal, with nothing around it, means the same there.
    let is_response = matches!(&formula.kind, Kind::Connective(Connective::Implies, left, right) if !left.has_future() && right.has_future());
    diagnostic = match () {
        () if symbolic(written, formula.span).is_some() => {
            let cure = format!("[] ({})", text(formula));
            diagnostic.help(format!("to check it every time, write `{cure}`")).fix(formula.span, cure)
        }
        () if is_response => {
            // Outside `ltl(…)` what stands in it means nothing without it.
            let whole = |e: &Expr| cx.sources.slice(symbolic(written, e.span).unwrap_or(e.span)).to_owned();
            let cure = format!("whenever {}, {}", whole(state), whole(rest));
            diagnostic.help(format!("to check it every time, write `{cure}`")).fix(formula.span, cure)
        }
        () => diagnostic.help(format!("to check it at every instant, write `always ({})`", text(formula))),
    };
    cx.report(&Env::default(), diagnostic);
}

/// The `ltl(…)` around a place.
fn symbolic(written: &ast::Expr, span: Span) -> Option<Span> {
    let mut around = None;
    walk::every(written, |e| {
        let holds = e.span.file == span.file && e.span.start <= span.start && span.end <= e.span.end;
        if holds && matches!(e.kind, ast::ExprKind::Ltl(_)) {
            around = Some(e.span);
        }
    });
    around
}

/// The state part and the future part of a mixture.
fn mixed(formula: &Expr) -> Option<(&Expr, &Expr)> {
    match &formula.kind {
        Kind::Not(inner) => mixed(inner),
        Kind::Connective(_, left, right) => match (left.has_future(), right.has_future()) {
            (false, true) => Some((left, right)),
            (true, false) => Some((right, left)),
            (true, true) => mixed(left).or_else(|| mixed(right)),
            (false, false) => None,
        },
        _ => None,
    }
}
