//! Operators of time: what they are made of, and where they may not stand.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_stream::{Duration, Type};
use lapwing_syntax::ast::{self, ExprKind, Infix, Prefix};

use crate::checked::{Bound, Clock, Expr, Kind, Scope};
use crate::context::{Cx, Env, poison};
use crate::expr::plain;

impl Cx<'_> {
    /// A formula whose outermost operator is about time.
    pub fn temporal(&mut self, env: &Env, expr: &ast::Expr) -> Expr {
        let kind = match &expr.kind {
            ExprKind::Prefix(prefix, bound, of) => self.prefix(env, *prefix, bound.as_ref(), of, expr.span),
            ExprKind::Infix(infix, bound, left, right) => {
                self.infix(env, *infix, bound.as_ref(), left, right, expr.span)
            }
            ExprKind::Held(duration, of) => {
                let duration = self.duration(env, duration);
                if let Some(duration) = duration {
                    self.under_three_periods(env, duration, expr.span);
                }
                let of = self.formula_of(&env.inside("`held`", expr.span), of);
                Kind::Held(duration.unwrap_or_default(), Box::new(of))
            }
            ExprKind::Scope(scope, trigger, body) => {
                let inner = self.future(env, scope_word(*scope), expr.span);
                let trigger = self.formula_of(&inner, trigger);
                Kind::Scope(scope_of(*scope), Box::new(trigger), Box::new(self.formula_of(&inner, body)))
            }
            ExprKind::AfterUntil(opens, closes, body) => {
                let inner = self.future(env, "after_until", expr.span);
                let opens = self.formula_of(&inner, opens);
                let closes = self.formula_of(&inner, closes);
                Kind::AfterUntil(Box::new(opens), Box::new(closes), Box::new(self.formula_of(&inner, body)))
            }
            _ => return poison(env.place(expr.span)),
        };
        plain(kind, Type::Bool, env.place(expr.span))
    }

    fn prefix(&mut self, env: &Env, prefix: Prefix, bound: Option<&ast::Bound>, of: &ast::Expr, span: Span) -> Kind {
        let word = prefix_word(prefix);
        let takes_bound = matches!(prefix, Prefix::Always | Prefix::Eventually | Prefix::Once | Prefix::Historically);
        if bound.is_some() && !takes_bound {
            // The parser has reported it.
            self.found.failed = true;
        }
        let bound = bound.filter(|_| takes_bound).map_or(Bound::ALL, |b| self.bound(env, b));
        let is_past = matches!(prefix, Prefix::Previously | Prefix::Once | Prefix::Historically | Prefix::Becomes);
        let inner = if is_past { env.inside("an operator about the past", span) } else { self.future(env, word, span) };
        let of = Box::new(self.formula_of(&inner, of));
        match prefix {
            Prefix::Always => Kind::Always(bound, of),
            Prefix::Never => {
                let span = of.span;
                Kind::Always(Bound::ALL, Box::new(plain(Kind::Not(of), Type::Bool, span)))
            }
            Prefix::Eventually => Kind::Eventually(bound, of),
            Prefix::Next => Kind::Next(of),
            Prefix::Previously => Kind::Previously(of),
            Prefix::Once => Kind::Once(bound, of),
            Prefix::Historically => Kind::Historically(bound, of),
            Prefix::Becomes => Kind::Becomes(of),
        }
    }

    fn infix(
        &mut self,
        env: &Env,
        infix: Infix,
        bound: Option<&ast::Bound>,
        left: &ast::Expr,
        right: &ast::Expr,
        span: Span,
    ) -> Kind {
        let bound = bound.map_or(Bound::ALL, |b| self.bound(env, b));
        let inner = match infix {
            Infix::Until => self.future(env, "until", span),
            Infix::Since => env.inside("an operator about the past", span),
        };
        let left = Box::new(self.formula_of(&inner, left));
        let right = Box::new(self.formula_of(&inner, right));
        match infix {
            Infix::Until => Kind::Until(bound, left, right),
            Infix::Since => Kind::Since(bound, left, right),
        }
    }

    /// The inside of an operator about the future, which may not stand everywhere.
    fn future<'e>(&mut self, env: &Env<'e>, word: &str, span: Span) -> Env<'e> {
        if let Some((what, place)) = env.no_future {
            let message = format!("`{word}` looks into the future and cannot stand inside {what}");
            let mut diagnostic = Diagnostic::new(Code::FutureInside, span, message)
                .label("about the future")
                .help("what is past or is compared must be known at once; put the operator about the future outside");
            if place != span {
                diagnostic = diagnostic.also(place, format!("inside {what}"));
            }
            self.report(env, diagnostic);
        }
        env.deeper()
    }

    /// A time bound.
    fn bound(&mut self, env: &Env, bound: &ast::Bound) -> Bound {
        let lo = bound.lo.as_ref().map_or(Some(Duration::ZERO), |lo| self.duration(env, lo));
        let hi = self.duration(env, &bound.hi);
        let (Some(lo), Some(hi)) = (lo, hi) else { return Bound::ALL };
        if lo > hi {
            let message = format!("this bound is empty: {lo} comes after {hi}");
            let mut diagnostic = Diagnostic::new(Code::EmptyBound, bound.span, message).label("no time lies in it");
            if let (Some(ast::Dur::Literal(_, first)), ast::Dur::Literal(_, second)) = (&bound.lo, &bound.hi) {
                let (first_text, second_text) = (self.sources.slice(*first), self.sources.slice(*second));
                let whole = self.sources.slice(bound.span);
                let swapped = whole.replacen(first_text, "\0", 1).replacen(second_text, first_text, 1).replacen(
                    '\0',
                    second_text,
                    1,
                );
                diagnostic =
                    diagnostic.help(format!("the earlier end comes first: `{swapped}`")).fix(bound.span, swapped);
            }
            self.report(env, diagnostic);
        }
        self.under_three_periods(env, hi, bound.span);
        Bound { lo, lo_closed: bound.lo_closed, hi: Some(hi), hi_closed: bound.hi_closed }
    }

    /// The lint on bounds that a clock cannot resolve.
    fn under_three_periods(&mut self, env: &Env, bound: Duration, span: Span) {
        let Clock::Rate(rate) = self.spec.clock else { return };
        if bound == Duration::ZERO || i128::from(bound.nanos()) * i128::from(rate) >= 3_000_000_000 {
            return;
        }
        let message = format!("{bound} is less than three periods of the clock, which ticks {rate} times a second");
        let diagnostic = Diagnostic::new(Code::BoundUnderThreePeriods, span, message)
            .label(format!("one period is {:.4} s", 1.0 / f64::from(rate)))
            .help("raise `__rate__`, or leave it out: then every message is looked at");
        self.report(env, diagnostic);
    }
}

fn scope_of(scope: ast::Scope) -> Scope {
    match scope {
        ast::Scope::After => Scope::After,
        ast::Scope::Until => Scope::Until,
        ast::Scope::Before => Scope::Before,
        ast::Scope::While => Scope::While,
        ast::Scope::Whenever => Scope::Whenever,
    }
}

fn scope_word(scope: ast::Scope) -> &'static str {
    match scope {
        ast::Scope::After => "after",
        ast::Scope::Until => "until",
        ast::Scope::Before => "before",
        ast::Scope::While => "while",
        ast::Scope::Whenever => "whenever",
    }
}

fn prefix_word(prefix: Prefix) -> &'static str {
    match prefix {
        Prefix::Always => "always",
        Prefix::Never => "never",
        Prefix::Eventually => "eventually",
        Prefix::Next => "next",
        Prefix::Previously => "previously",
        Prefix::Once => "once",
        Prefix::Historically => "historically",
        Prefix::Becomes => "becomes",
    }
}
