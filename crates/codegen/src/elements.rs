//! What is said of an element of an array: of a number, or of the fields of a message.

use lapwing_check::checked::{self, Arith, Connective, Func, Kind};
use lapwing_engine::program::Compare;
use lapwing_stream::Type;

use crate::code::{Expr, Helper, call, local};
use crate::interface::{self, identifier};
use crate::value::compare;

/// A part of each element that is read, and handed over as an array of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// The field, or the fields on the way to it; none for the element itself.
    pub path: Vec<String>,
    /// What it is.
    pub kind: interface::Kind,
}

impl Column {
    /// The name of the array that it is handed over as.
    pub fn name(&self) -> String {
        if self.path.is_empty() { "of".to_owned() } else { identifier(&format!("of_{}", self.path.join("_"))) }
    }

    /// The name of one of its elements.
    pub(crate) fn element(&self) -> String {
        if self.path.is_empty() { "x".to_owned() } else { identifier(&format!("x_{}", self.path.join("_"))) }
    }
}

/// What is said of an element, where it depends on nothing else, and what of the element that reads.
pub(crate) fn said(body: &checked::Expr) -> Option<(Expr, Vec<Column>)> {
    let mut said = Said { columns: Vec::new() };
    let body = said.truth(body)?;
    Some((body, said.columns))
}

/// The way from an element, the variable, to a part of it.
pub(crate) fn path_from(e: &checked::Expr, is_element: &impl Fn(&Kind) -> bool) -> Option<Vec<String>> {
    match &e.kind {
        Kind::Field(of, name) => {
            let mut path = path_from(of, is_element)?;
            path.push(name.clone());
            Some(path)
        }
        kind => is_element(kind).then(Vec::new),
    }
}

struct Said {
    columns: Vec<Column>,
}

impl Said {
    /// A part of the element, if it is one, as a value of that kind.
    fn part(&mut self, e: &checked::Expr, kind: interface::Kind) -> Option<Expr> {
        let path = path_from(e, &|kind| *kind == Kind::Var(0))?;
        let column = Column { path, kind };
        let is_taken = |known: &Column| known.path == column.path || known.name() == column.name();
        match self.columns.iter().find(|known| is_taken(known)) {
            Some(known) if *known != column => return None,
            Some(_) => {}
            None => self.columns.push(column.clone()),
        }
        Some(local(column.element()))
    }

    fn truth(&mut self, e: &checked::Expr) -> Option<Expr> {
        Some(match &e.kind {
            Kind::Bool(b) => Expr::Bool(*b),
            Kind::Not(of) => !self.truth(of)?,
            Kind::Connective(op, l, r) => {
                let (l, r) = (self.truth(l)?, self.truth(r)?);
                match op {
                    Connective::And => l & r,
                    Connective::Or => l | r,
                    Connective::Implies => !l | r,
                    Connective::Iff => l.same(r),
                }
            }
            Kind::Compare { op, margin, left, right } => match (&left.kind, &right.kind) {
                (Kind::Str(text), _) => self.is_text(*op, right, text)?,
                (_, Kind::Str(text)) => self.is_text(*op, left, text)?,
                _ => {
                    let margin = match margin {
                        Some(margin) => Some(self.number(margin)?),
                        None => None,
                    };
                    compare(operator(*op), self.number(left)?, self.number(right)?, margin)
                }
            },
            Kind::Truth(of) => self.part(of, interface::Kind::Truth)?,
            _ => self.part(e, interface::Kind::Truth).filter(|_| e.ty == Type::Bool)?,
        })
    }

    fn is_text(&mut self, op: checked::Compare, of: &checked::Expr, text: &str) -> Option<Expr> {
        let same = Expr::Same(Box::new(self.part(of, interface::Kind::Text)?), text.to_owned());
        match op {
            checked::Compare::Eq => Some(same),
            checked::Compare::Ne => Some(!same),
            _ => None,
        }
    }

    /// A part of an element of which no type tells is taken for a number.
    fn number(&mut self, e: &checked::Expr) -> Option<Expr> {
        Some(match &e.kind {
            Kind::Num(x) => Expr::Float(*x),
            Kind::Neg(of) => Expr::Neg(Box::new(self.number(of)?)),
            Kind::Arith(op, l, r) => {
                let (l, r) = (self.number(l)?, self.number(r)?);
                match op {
                    Arith::Add => l + r,
                    Arith::Sub => l - r,
                    Arith::Mul => l.mul(r),
                    Arith::Div => l.div(r),
                }
            }
            Kind::Call(Func::Abs, args) => call(Helper::Abs, vec![self.number(args.first()?)?]),
            _ => self.part(e, interface::Kind::Number).filter(|_| matches!(e.ty, Type::Num { .. } | Type::Any))?,
        })
    }
}

fn operator(op: checked::Compare) -> Compare {
    match op {
        checked::Compare::Eq => Compare::Eq,
        checked::Compare::Ne => Compare::Ne,
        checked::Compare::Lt => Compare::Lt,
        checked::Compare::Le => Compare::Le,
        checked::Compare::Gt => Compare::Gt,
        checked::Compare::Ge => Compare::Ge,
    }
}

/// What is said of any element, or of all, where it compares them with one value: the least or the greatest element tells.
pub(crate) fn by_extreme(is_all: bool, array: &checked::Expr, body: &checked::Expr) -> Option<Kind> {
    let Kind::Compare { op, margin, left, right } = &body.kind else { return None };
    if !margin.as_ref().is_none_or(|m| matches!(m.kind, Kind::Num(m) if m.is_finite())) {
        return None;
    }
    let is_left = left.kind == Kind::Var(0);
    let other = if is_left { right } else { left };
    if (!is_left && right.kind != Kind::Var(0)) || has_variable(other) {
        return None;
    }
    let is_below = match op {
        checked::Compare::Lt | checked::Compare::Le => is_left,
        checked::Compare::Gt | checked::Compare::Ge => !is_left,
        checked::Compare::Eq | checked::Compare::Ne => return None,
    };
    let func = if is_below == is_all { Func::MaxOf } else { Func::MinOf };
    let number = Type::Num { float: true };
    let extreme =
        checked::Expr { kind: Kind::Call(func, vec![array.clone()]), ty: number, dim: other.dim, span: array.span };
    let mut tells = body.clone();
    if let Kind::Compare { left, right, .. } = &mut tells.kind {
        **(if is_left { left } else { right }) = extreme.clone();
    }
    if !is_all {
        return Some(tells.kind);
    }
    // All of no elements are anything.
    let mut is_empty = body.clone();
    is_empty.kind = Kind::Call(Func::IsNan, vec![extreme]);
    Some(Kind::Connective(Connective::Or, Box::new(is_empty), Box::new(tells)))
}

fn has_variable(e: &checked::Expr) -> bool {
    matches!(e.kind, Kind::Var(_)) || e.children().into_iter().any(has_variable)
}
