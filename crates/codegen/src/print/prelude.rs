//! The functions that generated code brings along, in both languages.

use crate::code::Helper;

/// The name under which a function is called, in Rust and in C, and its text where it has one of its own.
pub(super) struct Spelling {
    pub rust: &'static str,
    pub rust_text: &'static str,
    pub c: &'static str,
    /// `NAME` stands for what every name begins with.
    pub c_text: &'static str,
}

/// How a helper is spelt.
pub(super) fn spelling(helper: Helper) -> Spelling {
    let (rust, rust_text, c, c_text) = match helper {
        Helper::Since => ("since", RUST_SINCE, "since", C_SINCE),
        Helper::Later => ("later", RUST_LATER, "later", C_LATER),
        Helper::Abs => ("absolute", RUST_ABS, "absolute", C_ABS),
        Helper::Sign => ("sign", RUST_SIGN, "sign", C_SIGN),
        Helper::Least => ("least", RUST_LEAST, "least", C_LEAST),
        Helper::Greatest => ("greatest", RUST_GREATEST, "greatest", C_GREATEST),
        Helper::IsNan => ("is_nan", RUST_IS_NAN, "is_nan", C_IS_NAN),
        Helper::Sqrt => ("square_root", RUST_SQRT, "sqrt", ""),
        Helper::Sin => ("libm::sin", "", "sin", ""),
        Helper::Cos => ("libm::cos", "", "cos", ""),
        Helper::Atan2 => ("libm::atan2", "", "atan2", ""),
        Helper::Asin => ("libm::asin", "", "asin", ""),
        Helper::Acos => ("libm::acos", "", "acos", ""),
        Helper::Fmod => ("libm::fmod", "", "fmod", ""),
    };
    Spelling { rust, rust_text, c, c_text }
}

const RUST_SINCE: &str = "
/// The time from one stamp to another that is not earlier, in nanoseconds.
#[inline]
fn since(now: i64, stamp: i64) -> u64 {
    now.wrapping_sub(stamp) as u64
}
";

const C_SINCE: &str = "
/* The time from one stamp to another that is not earlier, in nanoseconds. */
static uint64_t NAME_since(int64_t now, int64_t stamp) {
    return (uint64_t)now - (uint64_t)stamp;
}
";

const RUST_LATER: &str = "
/// A stamp so many nanoseconds later.
#[inline]
fn later(stamp: i64, nanos: u64) -> i64 {
    stamp.saturating_add_unsigned(nanos)
}
";

const C_LATER: &str = "
/* A stamp so many nanoseconds later. */
static int64_t NAME_later(int64_t stamp, uint64_t nanos) {
    uint64_t room = (uint64_t)INT64_MAX - (uint64_t)stamp;
    if (nanos >= room) {
        return INT64_MAX;
    }
    while (nanos > (uint64_t)INT64_MAX) {
        stamp += INT64_MAX;
        nanos -= (uint64_t)INT64_MAX;
    }
    return stamp + (int64_t)nanos;
}
";

const RUST_ABS: &str = "
/// The absolute value.
#[inline]
fn absolute(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & !(1 << 63))
}
";

const C_ABS: &str = "
/* The absolute value; that of a negative zero is zero. */
static double NAME_absolute(double x) {
    return x < 0.0 ? -x : x + 0.0;
}
";

const RUST_SIGN: &str = "
/// -1, 0 or 1; NaN of NaN.
fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else if x == 0.0 {
        0.0
    } else {
        x
    }
}
";

const C_SIGN: &str = "
/* -1, 0 or 1; NaN of NaN. */
static double NAME_sign(double x) {
    return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x == 0.0 ? 0.0 : x;
}
";

const RUST_LEAST: &str = "
/// The lesser of two numbers; the other one, where one is NaN.
fn least(a: f64, b: f64) -> f64 {
    if b < a || is_nan(a) { b } else { a }
}
";

const C_LEAST: &str = "
/* The lesser of two numbers; the other one, where one is NaN. */
static double NAME_least(double a, double b) {
    return b < a || NAME_is_nan(a) ? b : a;
}
";

const RUST_GREATEST: &str = "
/// The greater of two numbers; the other one, where one is NaN.
fn greatest(a: f64, b: f64) -> f64 {
    if b > a || is_nan(a) { b } else { a }
}
";

const C_GREATEST: &str = "
/* The greater of two numbers; the other one, where one is NaN. */
static double NAME_greatest(double a, double b) {
    return b > a || NAME_is_nan(a) ? b : a;
}
";

const RUST_IS_NAN: &str = "
/// Whether it is no number.
#[inline]
fn is_nan(x: f64) -> bool {
    x.is_nan()
}
";

const C_IS_NAN: &str = "
/* Whether it is no number. */
static bool NAME_is_nan(double x) {
    return x != x;
}
";

const RUST_SQRT: &str = "
/// The square root, rounded to the nearest, ties to even: the integer root of the mantissa, and the bit that its remainder rounds.
fn square_root(x: f64) -> f64 {
    if x == 0.0 || x.is_nan() || x == f64::INFINITY {
        return x;
    }
    if x < 0.0 {
        return f64::NAN;
    }
    let bits = x.to_bits();
    let (mut mantissa, mut exponent) = (bits & ((1 << 52) - 1), (bits >> 52) as i64 - 1075);
    if bits >> 52 == 0 {
        exponent += 1;
    } else {
        mantissa |= 1 << 52;
    }
    // So that the root has at least 55 bits, and the exponent is even.
    let mut shift = i64::from(mantissa.leading_zeros()) + 48;
    shift += (exponent - shift) & 1;
    let wide = u128::from(mantissa) << shift;
    let root = wide.isqrt();
    let sticky = u64::from(root * root != wide);
    let root = root as u64;
    let extra = 64 - root.leading_zeros() - 53;
    let half = 1_u64 << (extra - 1);
    let (kept, rest) = (root >> extra, root & ((1 << extra) - 1));
    let up = rest > half || (rest == half && (sticky != 0 || kept & 1 == 1));
    let power = (exponent - shift) / 2 + i64::from(extra);
    (kept + u64::from(up)) as f64 * f64::from_bits(((power + 1023) as u64) << 52)
}
";
