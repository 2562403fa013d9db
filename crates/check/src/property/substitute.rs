//! `for each r in (…)`: the formula once more, with something else in place of `r`.

use lapwing_syntax::ast::{Bound, Dur, Expr, ExprKind, Ident, Topic};

/// A copy of `expr` with `value` in place of `var`: in every component of a dotted name, and in the `{var}` of a topic.
pub(super) fn substitute(expr: &Expr, var: &str, value: &str) -> Expr {
    Replace { var, value, hidden: false }.expr(expr)
}

/// A topic with `value` in place of `{var}`.
pub(super) fn in_topic(topic: &Topic, var: &str, value: &str) -> Topic {
    Topic { name: topic.name.replace(&format!("{{{var}}}"), value), span: topic.span }
}

#[derive(Clone, Copy)]
struct Replace<'r> {
    var: &'r str,
    value: &'r str,
    /// Whether a variable of `any` or `all` has the same name: then the first component of a name means that one.
    hidden: bool,
}

impl Replace<'_> {
    fn expr(&self, expr: &Expr) -> Expr {
        Expr { kind: self.kind(&expr.kind), span: expr.span, parens: expr.parens }
    }

    fn boxed(&self, expr: &Expr) -> Box<Expr> {
        Box::new(self.expr(expr))
    }

    fn kind(&self, kind: &ExprKind) -> ExprKind {
        match kind {
            ExprKind::Path(idents) => ExprKind::Path(self.path(idents)),
            ExprKind::Topic(topic) => ExprKind::Topic(in_topic(topic, self.var, self.value)),
            ExprKind::Field(e, name) => ExprKind::Field(self.boxed(e), self.ident(name)),
            ExprKind::Index(e, index) => ExprKind::Index(self.boxed(e), *index),
            ExprKind::Call(name, args) => ExprKind::Call(name.clone(), args.iter().map(|a| self.expr(a)).collect()),
            ExprKind::Lambda(var, body) => {
                let inner = Replace { hidden: self.hidden || var.name == self.var, ..*self };
                ExprKind::Lambda(var.clone(), inner.boxed(body))
            }
            ExprKind::Lookback(e, depth) => ExprKind::Lookback(self.boxed(e), *depth),
            ExprKind::Neg(e) => ExprKind::Neg(self.boxed(e)),
            ExprKind::Not(e) => ExprKind::Not(self.boxed(e)),
            ExprKind::Ltl(e) => ExprKind::Ltl(self.boxed(e)),
            ExprKind::Binary(op, l, r) => ExprKind::Binary(*op, self.boxed(l), self.boxed(r)),
            ExprKind::WithMargin(op, l, m, r) => ExprKind::WithMargin(*op, self.boxed(l), self.boxed(m), self.boxed(r)),
            ExprKind::Prefix(prefix, bound, e) => ExprKind::Prefix(*prefix, self.bound(bound), self.boxed(e)),
            ExprKind::Infix(infix, bound, l, r) => {
                ExprKind::Infix(*infix, self.bound(bound), self.boxed(l), self.boxed(r))
            }
            ExprKind::Held(duration, e) => ExprKind::Held(self.duration(duration), self.boxed(e)),
            ExprKind::Scope(scope, x, f) => ExprKind::Scope(*scope, self.boxed(x), self.boxed(f)),
            ExprKind::AfterUntil(x, y, f) => ExprKind::AfterUntil(self.boxed(x), self.boxed(y), self.boxed(f)),
            ExprKind::Number(_) | ExprKind::Str(_) | ExprKind::Bool(_) | ExprKind::Error => kind.clone(),
        }
    }

    fn path(&self, idents: &[Ident]) -> Vec<Ident> {
        let one = |(index, ident): (usize, &Ident)| match index {
            0 if self.hidden => ident.clone(),
            _ => self.ident(ident),
        };
        idents.iter().enumerate().map(one).collect()
    }

    fn ident(&self, ident: &Ident) -> Ident {
        let name = if ident.name == self.var { self.value } else { &ident.name };
        Ident { name: name.to_owned(), span: ident.span }
    }

    fn bound(&self, bound: &Option<Bound>) -> Option<Bound> {
        let bound = bound.as_ref()?;
        let (lo, hi) = (bound.lo.as_ref().map(|lo| self.duration(lo)), self.duration(&bound.hi));
        Some(Bound { lo, hi, ..bound.clone() })
    }

    fn duration(&self, duration: &Dur) -> Dur {
        match duration {
            Dur::Name(name) => Dur::Name(self.ident(name)),
            Dur::Literal(..) => duration.clone(),
        }
    }
}
