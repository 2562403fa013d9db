//! Checked code: expressions of one type each, statements, guards. It runs on a [`Memory`], through an [`Address`] that says
//! where the variables of the code lie.

mod eval;
mod guard;
mod memory;
mod stmt;

pub(crate) use eval::{Call, Context, Eval, Trap};
pub(crate) use guard::{Bound, Guard};
pub(crate) use memory::{Address, Base, Clock, FINE, Memory, Table};
pub(crate) use stmt::Stmt;

use crate::value::{Type, Value};
use lapwing_diag::Span;

/// The number of a variable within the code's own frame; variables of plain types and objects are counted apart.
pub(crate) type Slot = u32;

/// How two values are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cmp {
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
}

impl Cmp {
    #[inline]
    fn holds<T: PartialOrd>(self, a: &T, b: &T) -> bool {
        match self {
            Cmp::Equal => a == b,
            Cmp::NotEqual => a != b,
            Cmp::Less => a < b,
            Cmp::LessEqual => a <= b,
            Cmp::Greater => a > b,
            Cmp::GreaterEqual => a >= b,
        }
    }

    /// `a < b` is `b > a`.
    pub(crate) fn mirrored(self) -> Cmp {
        match self {
            Cmp::Less => Cmp::Greater,
            Cmp::LessEqual => Cmp::GreaterEqual,
            Cmp::Greater => Cmp::Less,
            Cmp::GreaterEqual => Cmp::LessEqual,
            same => same,
        }
    }

    /// What holds where this does not.
    pub(crate) fn negated(self) -> Cmp {
        match self {
            Cmp::Equal => Cmp::NotEqual,
            Cmp::NotEqual => Cmp::Equal,
            Cmp::Less => Cmp::GreaterEqual,
            Cmp::LessEqual => Cmp::Greater,
            Cmp::Greater => Cmp::LessEqual,
            Cmp::GreaterEqual => Cmp::Less,
        }
    }
}

/// An expression that gives a truth value.
#[derive(Clone, Debug)]
pub(crate) enum Bool {
    Const(bool),
    Var(Slot),
    Not(Box<Bool>),
    And(Box<Bool>, Box<Bool>),
    Or(Box<Bool>, Box<Bool>),
    Same(Box<Bool>, Box<Bool>),
    Ints(Cmp, Box<Int>, Box<Int>),
    Floats(Cmp, Box<Float>, Box<Float>),
    Objects(Box<Object>, Box<Object>),
    Call(Box<Call>),
}

/// Arithmetic on whole numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum IntOp {
    Add,
    Subtract,
    Multiply,
    Divide,
    Remainder,
    And,
    Or,
    Xor,
}

/// An expression that gives a whole number.
#[derive(Clone, Debug)]
pub(crate) enum Int {
    Const(i64),
    Var(Slot),
    Minus(Box<Int>, Span),
    Complement(Box<Int>),
    Op(IntOp, Box<Int>, Box<Int>, Span),
    Call(Box<Call>),
}

/// An expression that gives a double.
#[derive(Clone, Debug)]
pub(crate) enum Float {
    Const(f64),
    Var(Slot),
    Of(Box<Int>),
    Minus(Box<Float>),
    Op(IntOp, Box<Float>, Box<Float>),
    Call(Box<Call>),
}

/// An expression that gives a text, or something of the host's.
#[derive(Clone, Debug)]
pub(crate) enum Object {
    Const(Value),
    Var(Slot),
    Call(Box<Call>),
}

/// An expression.
#[derive(Clone, Debug)]
pub(crate) enum Expr {
    Bool(Bool),
    Int(Int),
    Float(Float),
    Object(Type, Object),
}

impl Expr {
    pub(crate) fn ty(&self) -> Type {
        match self {
            Expr::Bool(_) => Type::Bool,
            Expr::Int(_) => Type::Int,
            Expr::Float(_) => Type::Float,
            Expr::Object(ty, _) => *ty,
        }
    }

    /// A variable.
    pub(crate) fn var(ty: Type, slot: Slot) -> Expr {
        match ty {
            Type::Bool => Expr::Bool(Bool::Var(slot)),
            Type::Int => Expr::Int(Int::Var(slot)),
            Type::Float => Expr::Float(Float::Var(slot)),
            _ => Expr::Object(ty, Object::Var(slot)),
        }
    }

    /// A value that is known.
    pub(crate) fn constant(ty: Type, value: &Value) -> Expr {
        match value {
            Value::Bool(value) => Expr::Bool(Bool::Const(*value)),
            Value::Int(value) if ty == Type::Float => Expr::Float(Float::Const(*value as f64)),
            Value::Int(value) => Expr::Int(Int::Const(*value)),
            Value::Float(value) => Expr::Float(Float::Const(*value)),
            other => Expr::Object(ty, Object::Const(other.clone())),
        }
    }

    /// The variable that it is, if it is one.
    pub(crate) fn slot(&self) -> Option<Slot> {
        match self {
            Expr::Bool(Bool::Var(slot)) | Expr::Int(Int::Var(slot)) | Expr::Float(Float::Var(slot)) => Some(*slot),
            Expr::Object(_, Object::Var(slot)) => Some(*slot),
            _ => None,
        }
    }
}
