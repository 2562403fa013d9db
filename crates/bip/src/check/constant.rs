//! Constants, and numbers of which no digit is lost.

use super::names::Names;
use super::{Check, Checker};
use crate::ast::{ConstData, Expr, ExprKind, Literal, UnaryOp};
use crate::code::{Base, Context, FINE, Memory};
use crate::host::Host;
use crate::value::{Type, Value};
use lapwing_diag::Code;

/// A constant of a package.
#[derive(Clone, Debug)]
pub(super) struct Constant {
    pub ty: Type,
    pub value: Value,
    /// The number as written, where it is one: bounds of clocks are computed from it exactly.
    pub digits: Option<String>,
}

/// Nobody to call: constants are known before anything runs.
pub(crate) struct Nobody;

impl Host for Nobody {
    fn call(&mut self, _: u32, _: &mut [Value], _: Option<u32>) -> Result<Value, String> {
        Err("a call where a constant is expected".to_owned())
    }
}

impl Checker<'_> {
    pub(super) fn constant(&mut self, constant: &ConstData) -> Check<Constant> {
        let ty = self.data_type(&constant.ty)?;
        let names = Names::default();
        let value = self.expr_as(&names, &constant.value, ty)?;
        let mut memory = Memory::default();
        let mut cx = Context { memory: &mut memory, host: &mut Nobody, atom: None, now: 0 };
        match value.eval(Base::default(), &mut cx) {
            Ok(value) => Ok(Constant { ty, value, digits: self.digits(&constant.value) }),
            Err(trap) => {
                let message = format!("the value of `{}` cannot be computed: {}", constant.name.text, trap.what);
                self.fail(Code::BipConst, constant.value.span, message)
            }
        }
    }

    /// A number as written, if the expression is one or names one.
    pub(super) fn digits(&self, expr: &Expr) -> Option<String> {
        match &expr.kind {
            ExprKind::Literal(Literal::Int(value)) => Some(value.to_string()),
            ExprKind::Literal(Literal::Real(text)) => Some(text.clone()),
            ExprKind::Path(path) => self.scope.constant(&path.text()).and_then(|c| c.digits.clone()),
            ExprKind::Unary(UnaryOp::Plus, inner) => self.digits(inner),
            ExprKind::Unary(UnaryOp::Minus, inner) => {
                let digits = self.digits(inner)?;
                Some(digits.strip_prefix('-').map_or(format!("-{digits}"), str::to_owned))
            }
            _ => None,
        }
    }
}

/// A decimal number times a whole one, in 10⁻⁹: exact, save that digits behind the ninth are rounded down. `None` where it is too large.
pub(super) fn scaled(digits: &str, unit: i64) -> Option<i128> {
    let (sign, digits) = digits.strip_prefix('-').map_or((1, digits), |rest| (-1, rest));
    let (mantissa, exponent) = match digits.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (digits, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let mut value = i128::from(unit).checked_mul(FINE)?;
    let number = format!("{whole}{fraction}").trim_start_matches('0').to_owned();
    if number.is_empty() {
        return Some(0);
    }
    let mut shift = exponent.checked_sub(i32::try_from(fraction.len()).ok()?)?;
    value = value.checked_mul(number.parse::<i128>().ok()?)?;
    while shift > 0 {
        value = value.checked_mul(10)?;
        shift -= 1;
    }
    while shift < 0 && value != 0 {
        value /= 10;
        shift += 1;
    }
    Some(sign * value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_digit_is_lost() {
        assert_eq!(scaled("1.5", 1_000_000), Some(1_500_000 * FINE));
        assert_eq!(scaled("0.2", 1_000_000), Some(200_000 * FINE));
        assert_eq!(scaled("0.3", 1), Some(3 * FINE / 10));
        assert_eq!(scaled("-2e3", 1), Some(-2000 * FINE));
        assert_eq!(scaled("12e-1", 10), Some(12 * FINE));
        assert_eq!(scaled("0.0", 1), Some(0));
    }

    #[test]
    fn what_is_too_large_or_too_small() {
        assert_eq!(scaled("1e300", 1), None);
        assert_eq!(scaled("1e-300", 1), Some(0));
        assert_eq!(scaled("1e999999999999", 1), None);
        assert_eq!(scaled(&"9".repeat(60), 1), None);
    }
}
