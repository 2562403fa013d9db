//! What an expression means before its surroundings say what they want of it: a number, a condition, a vector, a rotation.

use lapwing_diag::{Code, Diagnostic, Span};
use lapwing_stream::Type;
use lapwing_syntax::ast::Ident;

use crate::checked::{Arith, Dim, Expr, Func, Kind};
use crate::context::{Cx, Env, poison};
use crate::messages;
use crate::place::{Place, Root, describe, field_type};

/// The meaning of an expression.
#[derive(Clone)]
pub(crate) enum Term {
    Expr(Expr),
    Place(Box<Place>),
    Compound(Box<Compound>),
}

/// Several numbers that belong together, and the number that they stand for where one is wanted.
#[derive(Clone)]
pub(crate) struct Compound {
    pub shape: Shape,
    /// The parts; empty where they are not known one by one.
    pub parts: Vec<Expr>,
    /// A velocity's norm, an orientation's yaw.
    pub scalar: Option<Expr>,
    /// How the specification calls it.
    pub label: String,
    pub span: Span,
}

/// The kinds of compounds.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    /// `x y z`
    Vector,
    /// The quaternion `x y z w`
    Rotation,
}

impl Shape {
    /// The names of the parts.
    pub fn names(self) -> &'static [&'static str] {
        match self {
            Shape::Vector => &["x", "y", "z"],
            Shape::Rotation => &["x", "y", "z", "w"],
        }
    }

    fn described(self) -> &'static str {
        match self {
            Shape::Vector => "a vector: something with x, y and z",
            Shape::Rotation => "a rotation: a quaternion with x, y, z and w",
        }
    }
}

impl Term {
    /// Where an error has been reported.
    pub fn poison(span: Span) -> Term {
        Term::Expr(poison(span))
    }

    /// The field of that name below it.
    pub fn field(&self, cx: &mut Cx, env: &Env, name: &Ident) -> Term {
        let span = env.place(name.span);
        match self {
            Term::Place(place) => {
                let mut place = place.field(cx, env, name);
                if let Some(place) = &mut place {
                    place.span = if env.site.is_some() { span } else { place.span.to(name.span) };
                }
                place.map_or_else(|| Term::poison(span), |p| Term::Place(Box::new(p)))
            }
            Term::Expr(expr) => match field_type(cx, env, &expr.ty, name) {
                Some(ty) => Term::Expr(dynamic_field(expr, &name.name, ty)),
                None => Term::poison(span),
            },
            Term::Compound(compound) => compound.field(cx, env, name),
        }
    }

    /// The value as one expression.
    pub fn value(self, cx: &mut Cx, env: &Env) -> Expr {
        match self {
            Term::Expr(expr) => expr,
            Term::Place(place) => place.read(cx, env),
            Term::Compound(compound) => compound.scalar.unwrap_or_else(|| {
                let message = format!("`{}` has several parts, where one value is wanted", compound.label);
                let names = compound.shape.names().iter().map(|n| format!("`{}.{n}`", compound.label));
                let diagnostic = Diagnostic::new(Code::TypeMismatch, compound.span, message)
                    .label("one value is wanted here")
                    .help(format!("name the part that you mean: {}", names.collect::<Vec<_>>().join(", ")))
                    .help(format!("or its length: `norm({})`", compound.label));
                cx.report(env, diagnostic);
                poison(compound.span)
            }),
        }
    }

    /// The value as a number. A stamp counts as its seconds.
    pub fn number(self, cx: &mut Cx, env: &Env) -> Expr {
        if let Some(seconds) = self.seconds(cx, env) {
            return seconds;
        }
        let expr = self.value(cx, env);
        if matches!(expr.ty, Type::Num { .. } | Type::Any) {
            return expr;
        }
        let mut diagnostic = mismatch(&expr, "a number");
        if let Type::Message(schema) = &expr.ty {
            let fields = lapwing_diag::suggest::listed(schema.fields.iter().map(|f| &*f.name));
            diagnostic = diagnostic.help(format!("its fields are {fields}"));
        }
        cx.report(env, diagnostic);
        poison(expr.span)
    }

    /// The value as a condition. What may be a number or not is decided when it is seen; ground truth could still be a column.
    pub fn condition(self, cx: &mut Cx, env: &Env) -> Expr {
        let compound = matches!(self, Term::Compound(_));
        let expr = self.value(cx, env);
        let could_be_column = cx.trace.is_none() && (compound || matches!(expr.kind, Kind::Input(_)));
        match expr.ty {
            Type::Bool => return expr,
            Type::Any => return truth(expr),
            Type::Num { .. } if could_be_column => return truth(expr),
            _ => {}
        }
        let mut diagnostic = mismatch(&expr, "a condition");
        let text = cx.sources.slice(expr.span);
        diagnostic = match expr.ty {
            Type::Num { .. } => diagnostic.help(format!("compare it with something: `{text} > 0`")),
            Type::Str => diagnostic.help(format!("compare it with something: `{text} == \"…\"`")),
            Type::Array(_) => diagnostic.help("ask about its elements: `any(a, v => …)`, `all(a, v => …)`"),
            _ => diagnostic.help("name one of its fields"),
        };
        cx.report(env, diagnostic);
        poison(expr.span)
    }

    /// The value as something that can be compared: a number, a truth value or a text.
    pub fn operand(self, cx: &mut Cx, env: &Env) -> Expr {
        if let Some(seconds) = self.seconds(cx, env) {
            return seconds;
        }
        let expr = self.value(cx, env);
        match expr.ty {
            Type::Message(_) | Type::Array(_) => Term::Expr(expr).number(cx, env),
            _ => expr,
        }
    }

    /// The parts of a vector or rotation. A message without `z` lies in the plane and gives two.
    pub fn parts(&self, cx: &mut Cx, env: &Env, shape: Shape) -> Option<Vec<Expr>> {
        match self {
            Term::Compound(c) if c.shape == shape && !c.parts.is_empty() => Some(c.parts.clone()),
            Term::Place(place) => self.parts_of(cx, env, shape, &place.ty.clone()),
            Term::Expr(expr) => self.parts_of(cx, env, shape, &expr.ty.clone()),
            Term::Compound(c) => {
                let message = format!("the parts of `{}` are not known here, only its value", c.label);
                cx.report(env, Diagnostic::new(Code::TypeMismatch, c.span, message));
                None
            }
        }
    }

    /// Whether it is known to be one value, not something with parts.
    pub fn is_scalar(&self, cx: &Cx) -> bool {
        match self {
            Term::Compound(c) => c.parts.is_empty(),
            Term::Place(place) => match place.ty {
                Type::Any => place.has_column(cx),
                ref ty => !matches!(ty, Type::Message(_)),
            },
            Term::Expr(expr) => match expr.ty {
                Type::Any => !matches!(expr.kind, Kind::Var(_) | Kind::Field(..) | Kind::Index(..)),
                ref ty => !matches!(ty, Type::Message(_)),
            },
        }
    }

    fn parts_of(&self, cx: &mut Cx, env: &Env, shape: Shape, ty: &Type) -> Option<Vec<Expr>> {
        let has = |name: &str| match ty {
            Type::Message(schema) => schema.field(name).is_some(),
            ty => *ty == Type::Any,
        };
        let flat = shape == Shape::Vector && !has("z");
        let wanted = &shape.names()[..if flat { 2 } else { shape.names().len() }];
        if !wanted.iter().all(|n| has(n)) {
            let span = self.span();
            let message = format!("{} is not {}", describe(ty), shape.described());
            cx.report(env, Diagnostic::new(Code::TypeMismatch, span, message).label("no such parts here"));
            return None;
        }
        Some(wanted.iter().map(|name| self.part(cx, env, name)).collect())
    }

    /// A part whose name is known to be right. Where a trace without schemas has no column for `z`, the vector lies in the plane.
    fn part(&self, cx: &mut Cx, env: &Env, name: &str) -> Expr {
        let span = self.span();
        let ident = Ident { name: name.to_owned(), span };
        let part = self.field(cx, env, &ident);
        let (Term::Place(part), Term::Place(whole)) = (&part, self) else { return part.number(cx, env) };
        let in_columns = !matches!(whole.root, Root::Topic(_) | Root::Event(_));
        if name == "z" && in_columns && !part.has_column(cx) {
            let x = whole.field(cx, env, &Ident { name: "x".to_owned(), span });
            if x.is_some_and(|x| x.has_column(cx)) {
                return cx.assume_flat(env, &part.label, span);
            }
        }
        let mut part = part.clone();
        part.span = span;
        Term::Place(part).number(cx, env)
    }

    /// The seconds of something that has `sec` and `nanosec`.
    fn seconds(&self, cx: &mut Cx, env: &Env) -> Option<Expr> {
        let ty = match self {
            Term::Place(place) => &place.ty,
            Term::Expr(expr) => &expr.ty,
            Term::Compound(_) => return None,
        };
        let Type::Message(schema) = ty else { return None };
        let names = [("sec", "nanosec"), ("secs", "nsecs"), ("seconds", "nanos"), ("sec", "nsec")];
        let (sec, nanosec) = names.into_iter().find(|(s, n)| schema.field(s).is_some() && schema.field(n).is_some())?;
        let span = self.span();
        let (sec, nanosec) = (self.part(cx, env, sec), self.part(cx, env, nanosec));
        let number = |kind| Expr { kind, ty: Type::Num { float: true }, dim: Dim::TIME, span };
        let fraction = Kind::Arith(Arith::Mul, Box::new(nanosec), Box::new(number(Kind::Num(1e-9))));
        Some(number(Kind::Arith(Arith::Add, Box::new(sec), Box::new(number(fraction)))))
    }

    /// Its place in the source.
    pub fn span(&self) -> Span {
        match self {
            Term::Expr(expr) => expr.span,
            Term::Place(place) => place.span,
            Term::Compound(compound) => compound.span,
        }
    }

    /// The same, at another place: that of the pattern that names it.
    pub fn at(mut self, span: Span) -> Term {
        match &mut self {
            Term::Expr(expr) => expr.span = span,
            Term::Place(place) => place.span = span,
            Term::Compound(compound) => compound.span = span,
        }
        self
    }
}

impl Compound {
    fn field(&self, cx: &mut Cx, env: &Env, name: &Ident) -> Term {
        let span = env.place(name.span);
        if let Some(index) = self.shape.names().iter().position(|n| *n == name.name)
            && let Some(part) = self.parts.get(index)
        {
            return Term::Expr(part.clone()).at(span);
        }
        let turn = match name.name.as_str() {
            "roll" => Some(Func::Roll),
            "pitch" => Some(Func::Pitch),
            "yaw" => Some(Func::Yaw),
            _ => None,
        };
        if let (Shape::Rotation, Some(func), false) = (self.shape, turn, self.parts.is_empty()) {
            return Term::Expr(angle(func, self.parts.clone(), span));
        }
        if let (Shape::Rotation, Some(Func::Yaw), Some(yaw)) = (self.shape, turn, &self.scalar) {
            return Term::Expr(yaw.clone()).at(span);
        }
        let names = lapwing_diag::suggest::listed(self.shape.names().iter().copied());
        let message = format!("`{}` has no part `{}`", self.label, name.name);
        let diagnostic = Diagnostic::new(Code::UnknownField, name.span, message).help(format!("its parts are {names}"));
        cx.report(env, diagnostic);
        Term::poison(span)
    }
}

/// A value whose type will be seen, as a condition.
fn truth(expr: Expr) -> Expr {
    let (dim, span) = (Dim::UNKNOWN, expr.span);
    Expr { kind: Kind::Truth(Box::new(expr)), ty: Type::Bool, dim, span }
}

/// A function whose value is an angle.
pub(crate) fn angle(func: Func, args: Vec<Expr>, span: Span) -> Expr {
    Expr { kind: Kind::Call(func, args), ty: Type::Num { float: true }, dim: Dim::ANGLE, span }
}

fn dynamic_field(expr: &Expr, name: &str, ty: Type) -> Expr {
    let message = match &expr.ty {
        Type::Message(schema) => {
            schema.name.split_once('/').and_then(|(p, short)| messages::known_type(Some(p), short))
        }
        _ => None,
    };
    let dim = messages::field(message, expr.dim, name).dim;
    Expr { kind: Kind::Field(Box::new(expr.clone()), name.to_owned()), ty, dim, span: expr.span }
}

fn mismatch(expr: &Expr, wanted: &str) -> Diagnostic {
    let message = format!("{} stands where {wanted} is wanted", describe(&expr.ty));
    Diagnostic::new(Code::TypeMismatch, expr.span, message).label(format!("{wanted} is wanted here"))
}

impl Cx<'_> {
    /// Zero for the missing `z` of a vector in a trace of columns; where the column may still come, zero until it does.
    pub fn assume_flat(&mut self, env: &Env, column: &str, span: Span) -> Expr {
        let message = format!("there is no column `{column}`: it counts as 0");
        let note = Diagnostic::new(Code::AssumedFlat, span, message).label("taken to lie in the plane");
        self.report(env, note);
        let ty = Type::Num { float: true };
        if !self.trace.is_some_and(|t| t.columns_open) {
            return Expr { kind: Kind::Num(0.0), ty, dim: Dim::UNKNOWN, span };
        }
        let source = crate::checked::InputSource::Column(self.column(column));
        let default = Some(lapwing_stream::Value::Num(0.0));
        let label = column.to_owned();
        self.input(
            crate::checked::Input { label, source, ty: Type::Any, dim: Dim::UNKNOWN, default, stale: None },
            span,
        )
    }
}
