//! Expressions without time: literals, names, arithmetic, comparisons and connectives.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_stream::Type;
use lapwing_syntax::ast::{self, Binary, ExprKind};

use crate::checked::{Arith, Compare, Connective, Dim, Expr, Kind};
use crate::context::{Cx, Env};
use crate::dims::in_si;
use crate::place::describe;
use crate::term::Term;

/// So far back `@{…}` may look: each instant is kept.
const MOST_BACK: usize = 1_000_000;

impl Cx<'_> {
    /// What an expression or formula means.
    pub fn lower(&mut self, env: &Env, expr: &ast::Expr) -> Term {
        let span = env.place(expr.span);
        if !self.allows(env, expr.span) {
            return Term::poison(span);
        }
        match &expr.kind {
            ExprKind::Number(number) => Term::Expr(literal(number, span)),
            ExprKind::Str(text) => Term::Expr(plain(Kind::Str(text.clone()), Type::Str, span)),
            ExprKind::Bool(value) => Term::Expr(plain(Kind::Bool(*value), Type::Bool, span)),
            ExprKind::Path(idents) => self.path(&env.deeper(), idents, expr.span),
            ExprKind::Topic(topic) => self.stray_topic(env, topic, span),
            ExprKind::Field(of, name) => {
                let term = self.lower(&env.deeper(), of);
                term.field(self, env, name).at(span)
            }
            ExprKind::Index(of, index) => self.index(env, of, *index, span),
            ExprKind::Call(name, args) => self.call(env, name, args, expr.span),
            ExprKind::Lambda(var, _) => {
                let message = format!("`{} => …` can only stand in `any(array, …)` and `all(array, …)`", var.name);
                self.report(env, Diagnostic::new(Code::Misplaced, expr.span, message));
                Term::poison(span)
            }
            ExprKind::Lookback(of, depth) => {
                let of = self.lower(&env.inside("`@{…}`", expr.span), of);
                if *depth > MOST_BACK {
                    let message = format!("`@{{…}}` looks back {depth} instants; it may look back {MOST_BACK}");
                    let help = "what is longer ago can be found by `once within …`, `max_over` and the like";
                    self.report(env, Diagnostic::new(Code::TooLarge, expr.span, message).help(help));
                    return Term::poison(span);
                }
                self.lookback(env, of, *depth, span)
            }
            ExprKind::Neg(of) => {
                let of = self.lower(&env.inside("a sum", expr.span), of).number(self, env);
                let (ty, dim) = (of.ty.clone(), of.dim);
                Term::Expr(Expr { kind: Kind::Neg(Box::new(of)), ty, dim, span })
            }
            ExprKind::Not(of) => {
                let of = self.lower(&env.deeper(), of).condition(self, env);
                Term::Expr(plain(Kind::Not(Box::new(of)), Type::Bool, span))
            }
            ExprKind::Binary(op, left, right) => Term::Expr(self.binary(env, *op, left, right, expr.span)),
            ExprKind::WithMargin(op, left, margin, right) => match comparison(*op) {
                Some(op) => Term::Expr(self.compare(env, op, Some(margin), left, right, expr.span)),
                None => Term::poison(span),
            },
            ExprKind::Ltl(of) => self.lower(&env.deeper(), of),
            ExprKind::Error => {
                self.found.failed = true;
                Term::poison(span)
            }
            _ => Term::Expr(self.temporal(env, expr)),
        }
    }

    /// A formula or condition.
    pub fn formula_of(&mut self, env: &Env, expr: &ast::Expr) -> Expr {
        let term = self.lower(env, expr);
        term.condition(self, env)
    }

    /// `@{x, -n}`; of a vector or rotation that is each of its parts then.
    fn lookback(&mut self, env: &Env, of: Term, depth: usize, span: Span) -> Term {
        let back = |of: Expr| {
            let (ty, dim) = (of.ty.clone(), of.dim);
            Expr { kind: Kind::Lookback(Box::new(of), depth), ty, dim, span }
        };
        match of {
            Term::Compound(mut compound) => {
                compound.parts = compound.parts.into_iter().map(back).collect();
                compound.scalar = compound.scalar.map(back);
                compound.span = span;
                Term::Compound(compound)
            }
            of => Term::Expr(back(of.value(self, env))),
        }
    }

    fn stray_topic(&mut self, env: &Env, topic: &ast::Topic, span: Span) -> Term {
        let name = topic.absolute();
        let message = format!("the topic {name} is no value");
        let diagnostic = Diagnostic::new(Code::Misplaced, topic.span, message)
            .label("a value is wanted here")
            .help(format!("declare the field that you mean: `decl x {name} Type.field`"))
            .help(format!("or ask about its messages: `age({name})`, `frequency({name}, 2 s)`, `fresh({name})`"));
        self.report(env, diagnostic);
        Term::poison(span)
    }

    fn index(&mut self, env: &Env, of: &ast::Expr, index: usize, span: Span) -> Term {
        let of = self.lower(&env.deeper(), of).value(self, env);
        let ty = match &of.ty {
            Type::Array(inner) => (**inner).clone(),
            Type::Any => Type::Any,
            other => {
                let message = format!("{} has no element {index}", describe(other));
                self.report(
                    env,
                    Diagnostic::new(Code::TypeMismatch, of.span, message).label("an array is wanted here"),
                );
                return Term::poison(span);
            }
        };
        let dim = of.dim;
        Term::Expr(Expr { kind: Kind::Index(Box::new(of), index), ty, dim, span })
    }

    fn binary(&mut self, env: &Env, op: Binary, left: &ast::Expr, right: &ast::Expr, span: Span) -> Expr {
        if let Some(op) = arithmetic(op) {
            return self.arithmetic(env, op, left, right, span);
        }
        if let Some(op) = comparison(op) {
            return self.compare(env, op, None, left, right, span);
        }
        let op = match op {
            Binary::And => Connective::And,
            Binary::Or => Connective::Or,
            Binary::Implies => Connective::Implies,
            _ => Connective::Iff,
        };
        let inner = env.deeper();
        let left = self.formula_of(&inner, left);
        let right = self.formula_of(&inner, right);
        plain(Kind::Connective(op, Box::new(left), Box::new(right)), Type::Bool, env.place(span))
    }

    fn arithmetic(&mut self, env: &Env, op: Arith, left: &ast::Expr, right: &ast::Expr, span: Span) -> Expr {
        let inner = env.inside("a sum", span);
        let left = self.lower(&inner, left).number(self, env);
        let right = self.lower(&inner, right).number(self, env);
        let dim = match op {
            Arith::Add | Arith::Sub => self.agree(env, &left, &right, "added"),
            Arith::Mul => left.dim.times(right.dim),
            Arith::Div => left.dim.per(right.dim),
        };
        let float = op == Arith::Div || is_float(&left) || is_float(&right);
        let kind = Kind::Arith(op, Box::new(left), Box::new(right));
        Expr { kind, ty: Type::Num { float }, dim, span: env.place(span) }
    }

    /// The dimension of two things that must have the same; it is an error where they have not.
    pub fn agree(&mut self, env: &Env, left: &Expr, right: &Expr, done: &str) -> Dim {
        if !left.dim.fits(right.dim) {
            let (l, r) = (left.dim.unit(), right.dim.unit());
            let message = format!("{l} and {r} cannot be {done}");
            let diagnostic = Diagnostic::new(Code::DimensionMismatch, right.span, message)
                .label(format!("in {r}"))
                .also(left.span, format!("in {l}"))
                .help("a bare number fits everything; a unit after it says what it is: `0.5 m`, `2 m/s`, `100 ms`, `30 deg`");
            self.report(env, diagnostic);
        }
        left.dim.or(right.dim)
    }

    fn compare(
        &mut self,
        env: &Env,
        op: Compare,
        margin: Option<&ast::Expr>,
        left: &ast::Expr,
        right: &ast::Expr,
        span: Span,
    ) -> Expr {
        if let Some(in_state) = self.state_test(env, op, left, right, span) {
            return in_state;
        }
        let inner = env.inside("a comparison", span);
        let left = self.lower(&inner, left).operand(self, env);
        let given = margin.map(|m| self.lower(&inner, m).number(self, env));
        let right = self.lower(&inner, right).operand(self, env);
        self.comparable(env, op, &left, &right);
        let dim = self.agree(env, &left, &right, "compared");
        if let Some(margin) = &given
            && left.dim.fits(right.dim)
        {
            let whole = if left.dim.0.is_some() { &left } else { &right };
            self.agree(env, whole, margin, "compared");
        }
        let numbers = |e: &Expr| matches!(e.ty, Type::Num { .. } | Type::Any);
        let default = self.margin.filter(|m| *m != 0.0).map(|m| Expr {
            kind: Kind::Num(m),
            ty: Type::Num { float: true },
            dim: Dim::UNKNOWN,
            span: env.place(span),
        });
        let margin = if numbers(&left) && numbers(&right) { given.clone().or(default) } else { None };
        if given.is_none() && self.margin.is_none() {
            crate::lint::float_equality(self, env, op, &left, &right, span);
        }
        let kind = Kind::Compare { op, margin: margin.map(Box::new), left: Box::new(left), right: Box::new(right) };
        Expr { kind, ty: Type::Bool, dim, span: env.place(span) }
    }

    /// Reports two things that cannot be compared.
    fn comparable(&mut self, env: &Env, op: Compare, left: &Expr, right: &Expr) {
        let known = |e: &Expr| e.ty != Type::Any;
        if matches!(op, Compare::Eq | Compare::Ne) {
            let same = std::mem::discriminant(&left.ty) == std::mem::discriminant(&right.ty);
            if known(left) && known(right) && !same {
                let (l, r) = (describe(&left.ty), describe(&right.ty));
                let diagnostic = Diagnostic::new(Code::TypeMismatch, right.span, format!("{l} is never equal to {r}"))
                    .label(format!("this is {r}"))
                    .also(left.span, format!("this is {l}"));
                self.report(env, diagnostic);
            }
            return;
        }
        for side in [left, right] {
            if known(side) && !matches!(side.ty, Type::Num { .. }) {
                let message = format!("{} is neither greater nor smaller than anything", describe(&side.ty));
                let diagnostic = Diagnostic::new(Code::TypeMismatch, side.span, message)
                    .label("a number is wanted here")
                    .help("what is no number can be compared by `==` and `!=` only");
                self.report(env, diagnostic);
            }
        }
    }
}

fn arithmetic(op: Binary) -> Option<Arith> {
    Some(match op {
        Binary::Add => Arith::Add,
        Binary::Sub => Arith::Sub,
        Binary::Mul => Arith::Mul,
        Binary::Div => Arith::Div,
        _ => return None,
    })
}

fn comparison(op: Binary) -> Option<Compare> {
    Some(match op {
        Binary::Eq => Compare::Eq,
        Binary::Ne => Compare::Ne,
        Binary::Lt => Compare::Lt,
        Binary::Le => Compare::Le,
        Binary::Gt => Compare::Gt,
        Binary::Ge => Compare::Ge,
        _ => return None,
    })
}

/// Whether its value is a floating-point number for sure.
pub(crate) fn is_float(expr: &Expr) -> bool {
    expr.ty == Type::Num { float: true }
}

/// An expression without a dimension.
pub(crate) fn plain(kind: Kind, ty: Type, span: Span) -> Expr {
    Expr { kind, ty, dim: Dim::UNKNOWN, span }
}

fn literal(number: &ast::Number, span: Span) -> Expr {
    let (value, dim) = number.unit.map_or((number.value, Dim::UNKNOWN), |unit| in_si(number.value, unit));
    let float = number.unit.is_some() || number.text.contains(['.', 'e', 'E']);
    Expr { kind: Kind::Num(value), ty: Type::Num { float }, dim, span }
}
