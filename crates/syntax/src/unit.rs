//! Units: their names, and durations as exact nanoseconds.

use crate::ast::Unit;

impl Unit {
    /// All units.
    pub const ALL: &'static [Unit] = &[
        Unit::Ns,
        Unit::Us,
        Unit::Ms,
        Unit::S,
        Unit::Min,
        Unit::H,
        Unit::Mm,
        Unit::Cm,
        Unit::M,
        Unit::Km,
        Unit::MPerS,
        Unit::MPerS2,
        Unit::Rad,
        Unit::RadPerS,
        Unit::Deg,
        Unit::DegPerS,
        Unit::Hz,
    ];

    /// The unit as it is written.
    pub fn name(self) -> &'static str {
        match self {
            Unit::Ns => "ns",
            Unit::Us => "us",
            Unit::Ms => "ms",
            Unit::S => "s",
            Unit::Min => "min",
            Unit::H => "h",
            Unit::Mm => "mm",
            Unit::Cm => "cm",
            Unit::M => "m",
            Unit::Km => "km",
            Unit::MPerS => "m/s",
            Unit::MPerS2 => "m/s^2",
            Unit::Rad => "rad",
            Unit::RadPerS => "rad/s",
            Unit::Deg => "deg",
            Unit::DegPerS => "deg/s",
            Unit::Hz => "Hz",
        }
    }

    /// How many nanoseconds one of it is; `None` where it measures no time.
    pub fn nanoseconds(self) -> Option<i64> {
        match self {
            Unit::Ns => Some(1),
            Unit::Us => Some(1_000),
            Unit::Ms => Some(1_000_000),
            Unit::S => Some(1_000_000_000),
            Unit::Min => Some(60_000_000_000),
            Unit::H => Some(3_600_000_000_000),
            _ => None,
        }
    }
}

/// Why a number of time units is no duration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DurationError {
    /// More than zero, but less than a nanosecond.
    TooShort,
    /// More than an `i64` of nanoseconds, about 292 years.
    TooLong,
}

/// The decimal number `text` (digits, point, exponent) times `scale`, as whole nanoseconds, rounded half to even.
///
/// No double is involved: `0.1 s` is 100,000,000 ns, and so is `1e-1 s`.
pub fn nanoseconds(text: &str, scale: i64) -> Result<i64, DurationError> {
    let Some(decimal) = Decimal::read(text) else { return Err(DurationError::TooLong) };
    if decimal.digits.is_empty() {
        return Ok(0);
    }
    decimal.times(scale)
}

/// `digits · 10^exponent`, without leading or trailing zeros.
struct Decimal {
    digits: Vec<u8>,
    exponent: i64,
}

/// More digits than any duration has before its last one that counts.
const MOST_DIGITS: i64 = 40;

impl Decimal {
    /// `None` where the exponent itself is beyond all bounds upwards.
    fn read(text: &str) -> Option<Decimal> {
        let (mantissa, power) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let mut digits: Vec<u8> = whole.bytes().chain(fraction.bytes()).map(|b| b.wrapping_sub(b'0')).collect();
        let zeros = digits.iter().take_while(|&&d| d == 0).count();
        digits.drain(..zeros);
        let power = match power.parse::<i64>() {
            Ok(power) => power.clamp(-1_000_000_000, 1_000_000_000),
            Err(_) if digits.is_empty() => 0,
            Err(_) if power.starts_with('-') => -1_000_000_000,
            Err(_) => return None,
        };
        let mut exponent = power - fraction.len() as i64;
        while digits.last() == Some(&0) {
            digits.pop();
            exponent += 1;
        }
        Some(Decimal { digits, exponent })
    }

    fn times(&self, scale: i64) -> Result<i64, DurationError> {
        let places = self.digits.len() as i64 + self.exponent;
        if places > MOST_DIGITS {
            return Err(DurationError::TooLong);
        }
        if places < -MOST_DIGITS {
            return Err(DurationError::TooShort);
        }
        self.rounded(scale)
    }

    /// The product, where the number of places is known to be small: whole part and remainder by long multiplication.
    fn rounded(&self, scale: i64) -> Result<i64, DurationError> {
        // product = digits · scale, as decimal digits; the last -exponent of them stand after the point.
        let mut product = multiply(&self.digits, scale as u64);
        let after = (-self.exponent).max(0) as usize;
        product.extend(std::iter::repeat_n(0, self.exponent.max(0) as usize));
        let missing = (after + 1).saturating_sub(product.len());
        product.splice(0..0, std::iter::repeat_n(0, missing));
        let (whole, fraction) = product.split_at(product.len() - after);
        let mut value: i64 = 0;
        for &digit in whole {
            let next = value.checked_mul(10).and_then(|v| v.checked_add(i64::from(digit)));
            value = next.ok_or(DurationError::TooLong)?;
        }
        if value == 0 {
            return Err(DurationError::TooShort);
        }
        if rounds_up(fraction, value % 2 == 1) {
            value = value.checked_add(1).ok_or(DurationError::TooLong)?;
        }
        Ok(value)
    }
}

/// The decimal digits of `digits` (most significant first) times `by`.
fn multiply(digits: &[u8], by: u64) -> Vec<u8> {
    let mut product = Vec::with_capacity(digits.len() + 20);
    let mut carry = 0u128;
    for &digit in digits.iter().rev() {
        carry += u128::from(digit) * u128::from(by);
        product.push((carry % 10) as u8);
        carry /= 10;
    }
    while carry > 0 {
        product.push((carry % 10) as u8);
        carry /= 10;
    }
    product.reverse();
    product
}

/// Whether the digits after the point round the whole part up: more than half, or half and the whole part odd.
fn rounds_up(fraction: &[u8], odd: bool) -> bool {
    match fraction.split_first() {
        None => false,
        Some((5, rest)) => odd || rest.iter().any(|&d| d != 0),
        Some((first, _)) => *first > 5,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_exact() {
        assert_eq!(nanoseconds("0.1", 1_000_000_000), Ok(100_000_000));
        assert_eq!(nanoseconds("1e-1", 1_000_000_000), Ok(100_000_000));
        assert_eq!(nanoseconds("1.5", 60_000_000_000), Ok(90_000_000_000));
        assert_eq!(nanoseconds("0", 1), Ok(0));
        assert_eq!(nanoseconds("0.000", 1_000), Ok(0));
        assert_eq!(nanoseconds("0e999999999999999999999", 1), Ok(0));
        assert_eq!(nanoseconds("9223372036.854775807", 1_000_000_000), Ok(i64::MAX));
    }

    #[test]
    fn halves_go_to_even() {
        assert_eq!(nanoseconds("1.5", 1), Ok(2));
        assert_eq!(nanoseconds("2.5", 1), Ok(2));
        assert_eq!(nanoseconds("2.50000000000000000000000000000000000000000000000000001", 1), Ok(3));
        assert_eq!(nanoseconds("3.4999999999999999999999999999999999999999999", 1), Ok(3));
    }

    #[test]
    fn what_is_out_of_range_is_said_so() {
        assert_eq!(nanoseconds("0.9", 1), Err(DurationError::TooShort));
        assert_eq!(nanoseconds("1e-400", 3_600_000_000_000), Err(DurationError::TooShort));
        assert_eq!(nanoseconds("1e-99999999999999999999", 1), Err(DurationError::TooShort));
        assert_eq!(nanoseconds("9223372036.854775808", 1_000_000_000), Err(DurationError::TooLong));
        assert_eq!(nanoseconds("1e30", 1), Err(DurationError::TooLong));
        assert_eq!(nanoseconds("1e99999999999999999999", 1), Err(DurationError::TooLong));
    }
}
