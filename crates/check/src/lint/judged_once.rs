//! `judged-once`: a formula that mixes a state with the future at its top looks at the first position only.

use lapwing_diag::{Code, Diagnostic};

use crate::checked::{Connective, Expr, Kind};
use crate::context::{Cx, Env};

/// Looks at the top of a formula.
pub(super) fn check(cx: &mut Cx, formula: &Expr) {
    let Some((state, rest, op)) = mixed(formula) else { return };
    let text = |e: &Expr| cx.sources.slice(e.span).to_owned();
    let mut diagnostic = Diagnostic::new(Code::JudgedOnce, formula.span, "this is judged once, at the beginning")
        .label("not checked again later")
        .also(state.span, "only its first value counts");
    diagnostic = match op {
        Connective::Implies => {
            let cure = format!("whenever {}, {}", text(state), text(rest));
            diagnostic.help(format!("to check it every time, write `{cure}`")).fix(formula.span, cure)
        }
        _ => diagnostic.help(format!("to check it at every instant, write `always ({})`", text(formula))),
    };
    cx.report(&Env::default(), diagnostic);
}

/// The state part and the future part of a mixture.
fn mixed(formula: &Expr) -> Option<(&Expr, &Expr, Connective)> {
    match &formula.kind {
        Kind::Not(inner) => mixed(inner),
        Kind::Connective(op, left, right) => match (left.has_future(), right.has_future()) {
            (false, true) => Some((left, right, *op)),
            // Read backwards the proposal would say something else.
            (true, false) => Some((right, left, if *op == Connective::Implies { Connective::Or } else { *op })),
            (true, true) => mixed(left).or_else(|| mixed(right)),
            (false, false) => None,
        },
        _ => None,
    }
}
