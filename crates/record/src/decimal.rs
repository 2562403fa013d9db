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
    let plain = Plain::at(text, 0).filter(|plain| plain.end == text.len() && !plain.negative)?;
    plain.shifted(shift)
}

/// A decimal without an exponent, and with so few digits that 64 bits hold them: what recorders write nearly always.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plain {
    negative: bool,
    /// The digits without the point.
    digits: u64,
    /// How many of them stand after the point.
    places: usize,
    /// Where in the text it ends.
    pub end: usize,
}

/// So many digits fit into 64 bits, whatever they are.
const MOST_DIGITS: usize = 19;
/// A whole number up to here is a double, and so is a power of ten up to the 22nd.
const EXACT: u64 = 1 << 53;
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

impl Plain {
    /// The one that begins there; what follows it is the caller's to look at. `None` where none begins there, and where it
    /// has too many digits.
    #[inline(always)]
    pub fn at(text: &[u8], at: usize) -> Option<Plain> {
        let negative = text.get(at) == Some(&b'-');
        let start = at + usize::from(negative);
        let (point, mut digits) = digits(text, start, 0);
        let (mut end, mut places) = (point, 0);
        if text.get(point) == Some(&b'.') {
            (end, digits) = self::digits(text, point + 1, digits);
            places = end - point - 1;
        }
        let is_plain = point > start && point - start + places <= MOST_DIGITS;
        is_plain.then_some(Plain { negative, digits, places, end })
    }

    /// As a double, rounded as the standard library rounds. `None` where that takes more than one division of two exact doubles.
    #[inline]
    pub fn number(self) -> Option<f64> {
        if self.digits > EXACT {
            return None;
        }
        let mut size = self.digits as f64;
        // PERF: a division takes longer than all the rest.
        if self.places > 0 {
            size /= POWERS.get(self.places)?;
        }
        Some(if self.negative { -size } else { size })
    }

    /// Times ten to the power of `shift`. `None` where digits are left over, or 64 bits cannot hold it.
    #[inline]
    pub fn scaled(self, shift: i64) -> Option<i64> {
        let size = i64::try_from(self.shifted(shift)?).ok()?;
        Some(if self.negative { -size } else { size })
    }

    fn shifted(self, shift: i64) -> Option<u64> {
        let missing = usize::try_from(shift).ok()?.checked_sub(self.places)?;
        self.digits.checked_mul(*WHOLE_POWERS.get(missing)?)
    }
}

/// What stands between a unit of time and the nanosecond.
const WHOLE_POWERS: [u64; 10] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000, 1_000_000_000];

/// Reads digits from `at` on, after those of `value`: where they end, and all of them. They are only right where there are no more than
/// [`MOST_DIGITS`].
///
/// PERF: one by one. Eight at once take fewer instructions, but then the next cell waits for them, where a branch predictor runs ahead.
#[inline(always)]
fn digits(text: &[u8], mut at: usize, mut value: u64) -> (usize, u64) {
    while let Some(digit) = text.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|digit| *digit < 10) {
        value = value.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    (at, value)
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
    fn digits_are_counted_and_read_whatever_follows_them() {
        let mut random = 1u64;
        for _ in 0..100_000 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let mut text = format!("{}", random >> (random & 63)).into_bytes();
            text.extend(random.rotate_left(17).to_le_bytes());
            let count = text.iter().take_while(|b| b.is_ascii_digit()).count();
            let value = std::str::from_utf8(&text[..count]).unwrap().parse::<u64>();
            let found = digits(&text, 0, 0);
            assert_eq!(found.0, count, "{}", text.escape_ascii());
            assert!(count > MOST_DIGITS || Ok(found.1) == value, "{}: {}", text.escape_ascii(), found.1);
        }
    }

    #[test]
    fn plain_decimals_are_the_doubles_that_the_library_reads() {
        let mut random = 1u64;
        let mut exact = 0;
        for _ in 0..200_000 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let mut text = format!("{}{}", if random & 64 == 0 { "-" } else { "" }, random >> (random & 63));
            text.insert(text.len() - (random >> 8) as usize % text.trim_start_matches('-').len(), '.');
            let Some(number) = Plain::at(text.as_bytes(), 0).and_then(Plain::number) else { continue };
            assert_eq!(number.to_bits(), text.parse::<f64>().unwrap().to_bits(), "{text}");
            exact += 1;
        }
        assert!(exact > 100_000, "{exact}");
        for text in ["0", "-0", "9007199254740992", "0.000000000000000001", "5."] {
            let number = Plain::at(text.as_bytes(), 0).and_then(Plain::number);
            assert_eq!(number.map(f64::to_bits), text.parse().map(f64::to_bits).ok(), "{text}");
        }
        for text in ["", "-", ".5", "9007199254740993", "12345678901234567890"] {
            assert_eq!(Plain::at(text.as_bytes(), 0).and_then(Plain::number), None, "{text}");
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
