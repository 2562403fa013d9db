//! What expressions come to.

use super::{Address, Bool, Expr, Float, Int, IntOp, Memory, Object, Slot};
use crate::host::Host;
use crate::value::{Type, Value};
use lapwing_diag::Span;

/// Why an expression came to nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Trap {
    /// What happened, in a few words.
    pub what: String,
    /// Where in the model.
    pub at: Span,
}

/// What an expression comes to.
pub(crate) type Eval<T> = Result<T, Box<Trap>>;

/// Surroundings of code that runs.
pub(crate) struct Context<'a> {
    pub memory: &'a mut Memory,
    pub host: &'a mut dyn Host,
    /// Whose code it is: the number of an atom, where it is an atom's.
    pub atom: Option<u32>,
    pub now: i64,
}

/// A call of a function of the host's.
#[derive(Clone, Debug)]
pub(crate) struct Call {
    /// Its number among the functions of the model.
    pub function: u32,
    pub args: Vec<Expr>,
    /// For each argument the variable that the function may change.
    pub places: Vec<Option<Slot>>,
    /// What it gives.
    pub result: Option<Type>,
    pub span: Span,
}

fn trap<T>(at: Span, what: &str) -> Eval<T> {
    Err(Box::new(Trap { what: what.to_owned(), at }))
}

impl Bool {
    pub fn eval<A: Address>(&self, at: A, cx: &mut Context<'_>) -> Eval<bool> {
        Ok(match self {
            Bool::Const(value) => *value,
            Bool::Var(slot) => cell(at, cx, *slot) != 0,
            Bool::Not(inner) => !inner.eval(at, cx)?,
            Bool::And(a, b) => a.eval(at, cx)? && b.eval(at, cx)?,
            Bool::Or(a, b) => a.eval(at, cx)? || b.eval(at, cx)?,
            Bool::Same(a, b) => a.eval(at, cx)? == b.eval(at, cx)?,
            Bool::Ints(cmp, a, b) => {
                let (a, b) = (a.eval(at, cx)?, b.eval(at, cx)?);
                cmp.holds(&a, &b)
            }
            Bool::Floats(cmp, a, b) => {
                let (a, b) = (a.eval(at, cx)?, b.eval(at, cx)?);
                cmp.holds(&a, &b)
            }
            Bool::Objects(a, b) => a.eval(at, cx)? == b.eval(at, cx)?,
            Bool::Call(call) => call.eval(at, cx)?.as_bool().unwrap_or(false),
        })
    }
}

impl Int {
    pub fn eval<A: Address>(&self, at: A, cx: &mut Context<'_>) -> Eval<i64> {
        Ok(match self {
            Int::Const(value) => *value,
            Int::Var(slot) => cell(at, cx, *slot) as i64,
            Int::Minus(inner, span) => match inner.eval(at, cx)?.checked_neg() {
                Some(value) => value,
                None => return trap(*span, OVERFLOW),
            },
            Int::Complement(inner) => !inner.eval(at, cx)?,
            Int::Op(op, a, b, span) => {
                let (a, b) = (a.eval(at, cx)?, b.eval(at, cx)?);
                match op.ints(a, b) {
                    Some(value) => value,
                    None if b == 0 => return trap(*span, "a division by zero"),
                    None => return trap(*span, OVERFLOW),
                }
            }
            Int::Call(call) => call.eval(at, cx)?.as_int().unwrap_or(0),
        })
    }
}

const OVERFLOW: &str = "a number that has more than 64 bits";

impl IntOp {
    #[inline]
    fn ints(self, a: i64, b: i64) -> Option<i64> {
        match self {
            IntOp::Add => a.checked_add(b),
            IntOp::Subtract => a.checked_sub(b),
            IntOp::Multiply => a.checked_mul(b),
            IntOp::Divide => a.checked_div(b),
            IntOp::Remainder => a.checked_rem(b),
            IntOp::And => Some(a & b),
            IntOp::Or => Some(a | b),
            IntOp::Xor => Some(a ^ b),
        }
    }

    /// Of doubles; the checker lets no others than the first four come here.
    fn floats(self, a: f64, b: f64) -> f64 {
        match self {
            IntOp::Add => a + b,
            IntOp::Subtract => a - b,
            IntOp::Multiply => a * b,
            IntOp::Divide => a / b,
            IntOp::Remainder => a % b,
            IntOp::And | IntOp::Or | IntOp::Xor => f64::NAN,
        }
    }
}

impl Float {
    pub fn eval<A: Address>(&self, at: A, cx: &mut Context<'_>) -> Eval<f64> {
        Ok(match self {
            Float::Const(value) => *value,
            Float::Var(slot) => f64::from_bits(cell(at, cx, *slot)),
            Float::Of(inner) => inner.eval(at, cx)? as f64,
            Float::Minus(inner) => -inner.eval(at, cx)?,
            Float::Op(op, a, b) => {
                let (a, b) = (a.eval(at, cx)?, b.eval(at, cx)?);
                op.floats(a, b)
            }
            Float::Call(call) => call.eval(at, cx)?.as_float().unwrap_or(0.0),
        })
    }
}

impl Object {
    pub fn eval<A: Address>(&self, at: A, cx: &mut Context<'_>) -> Eval<Value> {
        match self {
            Object::Const(value) => Ok(value.clone()),
            Object::Var(slot) => Ok(cx.memory.objects.get(at.object(*slot)).cloned().unwrap_or_default()),
            Object::Call(call) => call.eval(at, cx),
        }
    }
}

impl Expr {
    pub fn eval<A: Address>(&self, at: A, cx: &mut Context<'_>) -> Eval<Value> {
        match self {
            Expr::Bool(inner) => inner.eval(at, cx).map(Value::Bool),
            Expr::Int(inner) => inner.eval(at, cx).map(Value::Int),
            Expr::Float(inner) => inner.eval(at, cx).map(Value::Float),
            Expr::Object(_, inner) => inner.eval(at, cx),
        }
    }
}

#[inline]
fn cell<A: Address>(at: A, cx: &Context<'_>, slot: Slot) -> u64 {
    cx.memory.cells.get(at.cell(slot)).copied().unwrap_or(0)
}

impl Call {
    /// Calls the host. What it gives has the type that the model declares: a host that gives something else is a fault.
    pub fn eval<A: Address>(&self, at: A, cx: &mut Context<'_>) -> Eval<Value> {
        let mut args = Vec::with_capacity(self.args.len());
        for arg in &self.args {
            args.push(arg.eval(at, cx)?);
        }
        let result = match cx.host.call(self.function, &mut args, cx.atom) {
            Ok(result) => result,
            Err(what) => return trap(self.span, &what),
        };
        for ((arg, place), value) in self.args.iter().zip(&self.places).zip(&args) {
            if let Some(slot) = place {
                let ty = arg.ty();
                let to = if ty.is_plain() { at.cell(*slot) } else { at.object(*slot) };
                cx.memory.set(ty, u32::try_from(to).unwrap_or(u32::MAX), value);
            }
        }
        match self.result {
            Some(ty) if !fits(ty, &result) => {
                trap(self.span, "a function of the host that gave a value of another type")
            }
            _ => Ok(result),
        }
    }
}

fn fits(ty: Type, value: &Value) -> bool {
    match ty {
        Type::Bool => value.as_bool().is_some(),
        Type::Int => value.as_int().is_some(),
        Type::Float => value.as_float().is_some(),
        Type::Text => value.as_text().is_some(),
        Type::Extern(_) => true,
    }
}
