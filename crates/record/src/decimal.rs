//! Decimal times, read exactly: no double stands between the text and the nanosecond.

/// Why a text is no time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DecimalError {
    /// It is no decimal number.
    NotANumber,
    /// It is one that 64 bits of nanoseconds cannot hold.
    OutOfRange,
}

impl DecimalError {
    /// The reason, to be put after the text.
    pub fn reason(self) -> &'static str {
        match self {
            DecimalError::NotANumber => "is no decimal number",
            DecimalError::OutOfRange => "is too large: times reach from -9223372036 s to 9223372036 s",
        }
    }
}

/// Digits after the point that a second has in nanoseconds.
pub(crate) const SECONDS: i64 = 9;
/// Digits after the point that a nanosecond has.
pub(crate) const NANOSECONDS: i64 = 0;

/// A decimal such as `1.5`, `-3` or `2e-3`, times ten to the power of `shift`, rounded half to even.
pub(crate) fn scaled(text: &[u8], shift: i64) -> Result<i64, DecimalError> {
    let (negative, text) = match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        rest => (false, rest),
    };
    let magnitude = match simple(text, shift) {
        Some(magnitude) => magnitude,
        None => split(text).ok_or(DecimalError::NotANumber)?.magnitude(shift).ok_or(DecimalError::OutOfRange)?,
    };
    let signed = if negative { -i128::from(magnitude) } else { i128::from(magnitude) };
    i64::try_from(signed).map_err(|_| DecimalError::OutOfRange)
}

/// PERF: the decimals that recorders write, in one pass: no exponent, and no digits beyond the nanosecond. `None` is any other.
fn simple(text: &[u8], shift: i64) -> Option<u64> {
    let (mut value, mut digits, mut point) = (0u64, 0i64, None);
    for byte in text {
        match byte {
            b'0'..=b'9' => {
                value = value.checked_mul(10)?.checked_add(u64::from(byte - b'0'))?;
                digits += 1;
            }
            b'.' if point.is_none() => point = Some(digits),
            _ => return None,
        }
    }
    let missing = shift - point.map_or(0, |at| digits - at);
    let power = 10u64.checked_pow(u32::try_from(missing).ok()?)?;
    if digits == 0 { None } else { value.checked_mul(power) }
}

/// An unsigned decimal taken apart: `whole.fraction` times ten to the power of `exponent`.
struct Parts<'a> {
    whole: &'a [u8],
    fraction: &'a [u8],
    exponent: i64,
}

fn split(text: &[u8]) -> Option<Parts<'_>> {
    let end = text.iter().position(|b| matches!(b, b'e' | b'E'));
    let (mantissa, exponent) = match end {
        Some(at) => (&text[..at], exponent(&text[at + 1..])?),
        None => (text, 0),
    };
    let (whole, fraction) = match mantissa.iter().position(|b| *b == b'.') {
        Some(at) => (&mantissa[..at], &mantissa[at + 1..]),
        None => (mantissa, &mantissa[..0]),
    };
    let digits = whole.iter().chain(fraction).all(u8::is_ascii_digit);
    (digits && whole.len() + fraction.len() > 0).then_some(Parts { whole, fraction, exponent })
}

/// An exponent, held within a range beyond which nothing changes.
fn exponent(text: &[u8]) -> Option<i64> {
    let (sign, digits) = match text {
        [b'-', rest @ ..] => (-1, rest),
        [b'+', rest @ ..] => (1, rest),
        rest => (1, rest),
    };
    if digits.is_empty() || !digits.iter().all(u8::is_ascii_digit) {
        return None;
    }
    let size = digits.iter().fold(0i64, |n, d| (n * 10 + i64::from(d - b'0')).min(1 << 40));
    Some(sign * size)
}

impl Parts<'_> {
    /// The value times ten to the power of `shift`, rounded half to even; `None` where it exceeds 64 bits.
    fn magnitude(&self, shift: i64) -> Option<u64> {
        let digits = || self.whole.iter().chain(self.fraction).map(|d| d - b'0');
        // How many of the digits stand before the point once the value is scaled.
        let before = self.whole.len() as i64 + self.exponent + shift;
        let mut value = 0u64;
        for digit in digits().take(usize::try_from(before).unwrap_or(0)) {
            value = value.checked_mul(10)?.checked_add(u64::from(digit))?;
        }
        let zeros = before - (self.whole.len() + self.fraction.len()) as i64;
        if value != 0 {
            for _ in 0..zeros.max(0) {
                value = value.checked_mul(10)?;
            }
        }
        if before < 0 {
            return Some(value);
        }
        let mut rest = digits().skip(before as usize);
        let first = rest.next().unwrap_or(0);
        let up = first > 5 || first == 5 && (rest.any(|d| d != 0) || value % 2 == 1);
        value.checked_add(u64::from(up))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nanos(text: &str) -> Result<i64, DecimalError> {
        scaled(text.as_bytes(), SECONDS)
    }

    #[test]
    fn decimals_are_exact() {
        assert_eq!(nanos("0.1"), Ok(100_000_000));
        assert_eq!(nanos("1727000000.123456789"), Ok(1_727_000_000_123_456_789));
        assert_eq!(nanos("-1.5"), Ok(-1_500_000_000));
        assert_eq!(nanos("+.5"), Ok(500_000_000));
        assert_eq!(nanos("3."), Ok(3_000_000_000));
        assert_eq!(nanos("2e-3"), Ok(2_000_000));
        assert_eq!(nanos("1.5E+2"), Ok(150_000_000_000));
        assert_eq!(nanos("0e999999999999999999999"), Ok(0));
        assert_eq!(nanos("1e-999999999999999999999"), Ok(0));
        assert_eq!(scaled(b"1500000000", NANOSECONDS), Ok(1_500_000_000));
        assert_eq!(scaled(b"1.5e9", NANOSECONDS), Ok(1_500_000_000));
    }

    #[test]
    fn the_short_way_agrees_with_the_long_one() {
        for text in [
            "0",
            "1.5",
            "12345.678901234",
            "1727000000.123456789",
            "0.000000001",
            "00.5",
            "7.",
            ".25",
            "18446744073709551615",
        ] {
            let long = split(text.as_bytes()).and_then(|parts| parts.magnitude(SECONDS));
            assert!(simple(text.as_bytes(), SECONDS).is_none_or(|short| Some(short) == long), "{text}");
        }
    }

    #[test]
    fn halves_go_to_the_even_neighbour() {
        assert_eq!(nanos("0.0000000005"), Ok(0));
        assert_eq!(nanos("0.00000000051"), Ok(1));
        assert_eq!(nanos("0.0000000015"), Ok(2));
        assert_eq!(nanos("0.0000000025"), Ok(2));
        assert_eq!(nanos("-0.0000000025"), Ok(-2));
        assert_eq!(nanos("0.00000000250000000000000000000001"), Ok(3));
        assert_eq!(nanos("5e-11"), Ok(0));
        assert_eq!(nanos("9e-10"), Ok(1));
    }

    #[test]
    fn the_ends_of_time_are_held() {
        assert_eq!(nanos("9223372036.854775807"), Ok(i64::MAX));
        assert_eq!(nanos("-9223372036.854775808"), Ok(i64::MIN));
        assert_eq!(nanos("9223372036.854775808"), Err(DecimalError::OutOfRange));
        assert_eq!(nanos("1e300"), Err(DecimalError::OutOfRange));
        assert_eq!(nanos("000000000000000000000000000001"), Ok(1_000_000_000));
    }

    #[test]
    fn other_texts_are_no_times() {
        for text in ["", ".", "-", "1.2.3", "abc", "1e", "e5", "0x10", "1 ", "nan", "inf", "--1"] {
            assert_eq!(nanos(text), Err(DecimalError::NotANumber), "{text:?}");
        }
    }
}
