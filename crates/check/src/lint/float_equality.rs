//! `float-equality`: a float compared by `==` or `!=` with no margin.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_stream::Type;

use crate::checked::{Compare, Dim, Expr, Kind};
use crate::context::{Cx, Env};
use crate::expr::is_float;

/// Looks at one comparison that has no margin.
pub(crate) fn float_equality(cx: &mut Cx, env: &Env, op: Compare, left: &Expr, right: &Expr, span: Span) {
    let number = |e: &Expr| matches!(e.ty, Type::Num { .. } | Type::Any);
    // A field with a physical dimension is a float even where its type is not known.
    let float = |e: &Expr| is_float(e) || (e.ty == Type::Any && e.dim != Dim::UNKNOWN);
    let constant = |e: &Expr| matches!(e.kind, Kind::Num(_));
    let applies = matches!(op, Compare::Eq | Compare::Ne)
        && number(left)
        && number(right)
        && (float(left) || float(right))
        && !(constant(left) && constant(right));
    if !applies {
        return;
    }
    let sign = if op == Compare::Eq { "==" } else { "!=" };
    let always = if op == Compare::Eq { "hardly ever equal" } else { "nearly always different" };
    let diagnostic = Diagnostic::new(Code::FloatEquality, span, format!("floating-point numbers are {always}"))
        .label(format!("`{sign}` without a margin"))
        .help(format!("say how far apart they may be: `{sign}{{0.01}}`"))
        .help("or set a default for the whole file: `__margin__ = 0.01`");
    cx.report(env, diagnostic);
}
