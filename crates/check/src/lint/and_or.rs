//! `mixed-and-or`: `a and b or c` without brackets.

use lapwing_diag::{Code, Diagnostic};
use lapwing_syntax::ast::{Binary, Expr, ExprKind};

use crate::context::{Cx, Env};
use crate::walk;

/// Looks at an expression and all below it.
pub(super) fn check(cx: &mut Cx, expr: &Expr) {
    let mut found = Vec::new();
    walk::every(expr, |e| {
        if let ExprKind::Binary(Binary::Or, left, right) = &e.kind {
            let bare = |e: &&Expr| !e.parens && matches!(e.kind, ExprKind::Binary(Binary::And, ..));
            found.extend([&**left, &**right].into_iter().filter(bare));
        }
    });
    for and in found {
        let text = cx.sources.slice(and.span);
        let diagnostic = Diagnostic::new(Code::MixedAndOr, and.span, "`and` beside `or` without brackets")
            .label("this is joined first")
            .help("put brackets around what belongs together, so that nobody has to know")
            .fix(and.span, format!("({text})"));
        cx.report(&Env::default(), diagnostic);
    }
}
