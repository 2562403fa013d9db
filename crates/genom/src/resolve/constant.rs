//! The values of constant expressions.

use lapwing_diag::{Code, Diagnostic, Span};

use super::Resolver;
use super::scope::ScopeId;
use crate::ast::{Expr, ExprKind, Quantity};

/// The value of a constant.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Const {
    Int(i128),
    Float(f64),
    Bool(bool),
    Text(String),
    Char(char),
    Enumerator(String),
}

impl Const {
    fn what(&self) -> &'static str {
        match self {
            Const::Int(_) | Const::Float(_) => "a number",
            Const::Bool(_) => "true or false",
            Const::Text(_) => "a text",
            Const::Char(_) => "a character",
            Const::Enumerator(_) => "a value of an enumeration",
        }
    }
}

impl Resolver<'_> {
    /// The value of an expression; `None` where it has none, which has been said.
    pub(super) fn constant(&mut self, scope: ScopeId, expr: &Expr) -> Option<Const> {
        match &expr.kind {
            ExprKind::Int(value) => Some(Const::Int(i128::from(*value))),
            ExprKind::Float(value) => Some(Const::Float(*value)),
            ExprKind::Bool(value) => Some(Const::Bool(*value)),
            ExprKind::Text(value) => Some(Const::Text(value.clone())),
            ExprKind::Char(value) => Some(Const::Char(*value)),
            ExprKind::Name(name) => {
                let found = self.scopes.find(scope, name, |symbol| symbol.value.clone());
                if found.is_none() {
                    self.unknown(scope, name, "constant");
                }
                found
            }
            ExprKind::Unary(sign, operand) => {
                let operand = self.constant(scope, operand)?;
                let value = match (sign, operand) {
                    ('-', Const::Int(value)) => value.checked_neg().map(Const::Int),
                    ('~', Const::Int(value)) => Some(Const::Int(!value)),
                    ('~', Const::Bool(value)) => Some(Const::Bool(!value)),
                    ('-', Const::Float(value)) => Some(Const::Float(-value)),
                    ('+', value @ (Const::Int(_) | Const::Float(_))) => Some(value),
                    _ => None,
                };
                self.computed(value, expr.span)
            }
            ExprKind::Binary(sign, left, right) => {
                let (left, right) = (self.constant(scope, left), self.constant(scope, right));
                let value = joined(sign, left?, right?);
                self.computed(value, expr.span)
            }
        }
    }

    fn computed(&mut self, value: Option<Const>, span: Span) -> Option<Const> {
        if value.is_none() {
            self.report(Diagnostic::new(
                Code::NotConstant,
                span,
                "this has no value: the operator does not fit its operands",
            ));
        }
        value
    }

    /// A whole number that is not negative: the length of an array, a priority.
    pub(super) fn size(&mut self, scope: ScopeId, expr: &Expr) -> Option<u64> {
        let value = self.constant(scope, expr)?;
        let size = match value {
            Const::Int(value) => u64::try_from(value).ok(),
            _ => None,
        };
        if size.is_none() {
            let message = format!("a whole number that is not negative should stand here, and {} does", value.what());
            self.report(Diagnostic::new(Code::TypeMismatch, expr.span, message));
        }
        size
    }

    /// A time in nanoseconds.
    pub(super) fn time(&mut self, scope: ScopeId, quantity: &Quantity) -> Option<u64> {
        let value = self.constant(scope, &quantity.value)?;
        let ns = match value {
            Const::Int(value) => value.checked_mul(i128::from(quantity.unit_ns)).and_then(|ns| u64::try_from(ns).ok()),
            // Rounded, so that `1.5 ms` is 1,500,000 ns whatever the binary fraction is.
            Const::Float(value) => Some((value * quantity.unit_ns as f64).round())
                .filter(|ns| (0.0..9e18).contains(ns))
                .map(|ns| ns as u64),
            _ => None,
        };
        if ns.is_none() {
            let message = match value {
                Const::Int(_) | Const::Float(_) => {
                    "this is no length of time: it is negative, or longer than centuries".to_owned()
                }
                other => format!("a length of time should stand here, and {} does", other.what()),
            };
            self.report(Diagnostic::new(Code::TypeMismatch, quantity.span, message));
        }
        ns
    }
}

fn joined(sign: &str, left: Const, right: Const) -> Option<Const> {
    match (left, right) {
        (Const::Int(left), Const::Int(right)) => whole(sign, left, right).map(Const::Int),
        (Const::Int(left), Const::Float(right)) => fraction(sign, left as f64, right),
        (Const::Float(left), Const::Int(right)) => fraction(sign, left, right as f64),
        (Const::Float(left), Const::Float(right)) => fraction(sign, left, right),
        _ => None,
    }
}

fn whole(sign: &str, left: i128, right: i128) -> Option<i128> {
    let by = || u32::try_from(right).ok().filter(|by| *by < 64);
    match sign {
        "|" => Some(left | right),
        "^" => Some(left ^ right),
        "&" => Some(left & right),
        "<<" => left.checked_mul(1_i128.checked_shl(by()?)?),
        ">>" => left.checked_shr(by()?),
        "+" => left.checked_add(right),
        "-" => left.checked_sub(right),
        "*" => left.checked_mul(right),
        "/" => left.checked_div(right),
        "%" => left.checked_rem(right),
        _ => None,
    }
}

fn fraction(sign: &str, left: f64, right: f64) -> Option<Const> {
    let value = match sign {
        "+" => left + right,
        "-" => left - right,
        "*" => left * right,
        "/" => left / right,
        _ => return None,
    };
    value.is_finite().then_some(Const::Float(value))
}
