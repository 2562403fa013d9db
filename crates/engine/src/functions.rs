//! The functions of values. Transcendental ones go through `libm`, so that every machine gives the same bits.

use crate::program::{Compare, Func};

/// π and 2π as doubles.
const PI: f64 = core::f64::consts::PI;
const TAU: f64 = 2.0 * PI;

/// A comparison with a margin; equal infinities are equal whatever the margin, NaN is only ever unequal.
#[inline]
pub fn compare(op: Compare, a: f64, b: f64, margin: f64) -> bool {
    match op {
        Compare::Lt => a < b + margin,
        Compare::Le => a <= b + margin || is_same_infinity(a, b),
        Compare::Gt => a > b - margin,
        Compare::Ge => a >= b - margin || is_same_infinity(a, b),
        Compare::Eq => equal(a, b, margin),
        Compare::Ne => !equal(a, b, margin),
    }
}

#[inline]
fn equal(a: f64, b: f64, margin: f64) -> bool {
    libm::fabs(a - b) <= margin || is_same_infinity(a, b)
}

#[inline]
fn is_same_infinity(a: f64, b: f64) -> bool {
    a == b && a.is_infinite()
}

/// A function of numbers alone. The number of arguments was checked; a missing one counts as NaN.
pub fn numeric(func: Func, args: &[f64]) -> f64 {
    let a = |i: usize| args.get(i).copied().unwrap_or(f64::NAN);
    match func {
        Func::Abs => libm::fabs(a(0)),
        Func::Sign => sign(a(0)),
        Func::Min => least(args.iter().copied()),
        Func::Max => greatest(args.iter().copied()),
        Func::Sqrt => libm::sqrt(a(0)),
        Func::Sin => libm::sin(a(0)),
        Func::Cos => libm::cos(a(0)),
        Func::Atan2 => libm::atan2(a(0), a(1)),
        Func::Norm => norm(args),
        Func::Roll => roll([a(0), a(1), a(2), a(3)]),
        Func::Pitch => pitch([a(0), a(1), a(2), a(3)]),
        Func::Yaw => yaw([a(0), a(1), a(2), a(3)]),
        Func::AngleDiff => angle_diff(a(0), a(1)),
        Func::AngleBetween => angle_between([a(0), a(1), a(2), a(3)], [a(4), a(5), a(6), a(7)]),
        Func::IntoBody => rotate_back([a(1), a(2), a(3)], [a(4), a(5), a(6), a(7)])[(a(0) as usize).min(2)],
        Func::Deg => a(0) * 180.0 / PI,
        Func::Rad => a(0) * PI / 180.0,
        _ => f64::NAN,
    }
}

fn sign(x: f64) -> f64 {
    match x {
        x if x > 0.0 => 1.0,
        x if x < 0.0 => -1.0,
        x if x.is_nan() => f64::NAN,
        _ => 0.0,
    }
}

/// The least that is not NaN; NaN where there is none.
pub(crate) fn least(of: impl Iterator<Item = f64>) -> f64 {
    first_and_rest(of).map_or(f64::NAN, |(first, rest)| rest.fold(first, |least, x| if x < least { x } else { least }))
}

/// The greatest that is not NaN; NaN where there is none.
pub(crate) fn greatest(of: impl Iterator<Item = f64>) -> f64 {
    first_and_rest(of).map_or(f64::NAN, |(first, rest)| rest.fold(first, |most, x| if x > most { x } else { most }))
}

/// The first that is not NaN, and all after it.
// PERF: from there on one comparison tells, which a NaN never passes.
fn first_and_rest<I: Iterator<Item = f64>>(mut of: I) -> Option<(f64, I)> {
    of.find(|x| !x.is_nan()).map(|first| (first, of))
}

/// The Euclidean norm, summed from the left.
pub(crate) fn norm(of: &[f64]) -> f64 {
    libm::sqrt(of.iter().fold(0.0, |sum, x| sum + x * x))
}

/// Roll of the quaternion `x, y, z, w`, in radians.
fn roll([x, y, z, w]: [f64; 4]) -> f64 {
    libm::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
}

/// Pitch, in radians; beyond the poles it stays at them.
fn pitch([x, y, z, w]: [f64; 4]) -> f64 {
    libm::asin((2.0 * (w * y - z * x)).clamp(-1.0, 1.0))
}

/// Yaw, in radians.
fn yaw([x, y, z, w]: [f64; 4]) -> f64 {
    libm::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
}

/// `a - b` wrapped into `(-π, π]`.
fn angle_diff(a: f64, b: f64) -> f64 {
    let mut r = libm::fmod(a - b + PI, TAU);
    if r <= 0.0 {
        r += TAU;
    }
    r - PI
}

/// The angle between two orientations, in `[0, π]`.
fn angle_between(p: [f64; 4], q: [f64; 4]) -> f64 {
    let dot = p.iter().zip(&q).fold(0.0, |sum, (a, b)| sum + a * b) / (norm(&p) * norm(&q));
    2.0 * libm::acos(libm::fabs(dot).min(1.0))
}

/// The vector turned by the quaternion.
pub(crate) fn rotate([x, y, z]: [f64; 3], [qx, qy, qz, qw]: [f64; 4]) -> [f64; 3] {
    let t = [2.0 * (qy * z - qz * y), 2.0 * (qz * x - qx * z), 2.0 * (qx * y - qy * x)];
    [
        x + qw * t[0] + (qy * t[2] - qz * t[1]),
        y + qw * t[1] + (qz * t[0] - qx * t[2]),
        z + qw * t[2] + (qx * t[1] - qy * t[0]),
    ]
}

/// The vector turned by the inverse of the quaternion: from the world's frame into the body's.
pub(crate) fn rotate_back(v: [f64; 3], [x, y, z, w]: [f64; 4]) -> [f64; 3] {
    rotate(v, [-x, -y, -z, w])
}

/// The Hamilton product: first `b`, then `a`.
pub(crate) fn product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    let ([ax, ay, az, aw], [bx, by, bz, bw]) = (a, b);
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comparisons_with_nan_and_infinities() {
        let nan = f64::NAN;
        for op in [Compare::Lt, Compare::Le, Compare::Gt, Compare::Ge, Compare::Eq] {
            assert!(!compare(op, nan, 1.0, 0.5));
        }
        assert!(compare(Compare::Ne, nan, nan, 0.5));
        assert!(compare(Compare::Eq, f64::INFINITY, f64::INFINITY, 0.0));
        assert!(compare(Compare::Lt, 1.2, 1.0, 0.5) && !compare(Compare::Lt, 1.5, 1.0, 0.5));
    }

    #[test]
    fn angles_wrap() {
        assert!((angle_diff(3.0, -3.0) - (6.0 - TAU)).abs() < 1e-12);
        assert_eq!(angle_diff(PI, 0.0), PI);
        assert!((yaw([0.0, 0.0, libm::sin(0.5), libm::cos(0.5)]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn turning_there_and_back() {
        let q = [0.0, 0.0, libm::sin(0.4), libm::cos(0.4)];
        let there = rotate([1.0, 2.0, 3.0], q);
        let back = rotate_back(there, q);
        assert!((0..3).all(|i| (back[i] - [1.0, 2.0, 3.0][i]).abs() < 1e-12));
        assert!((libm::atan2(rotate([1.0, 0.0, 0.0], q)[1], rotate([1.0, 0.0, 0.0], q)[0]) - 0.8).abs() < 1e-12);
    }

    #[test]
    fn least_and_greatest_skip_nan() {
        let nan = f64::NAN;
        assert_eq!(least([nan, 2.0, nan, 1.0, 3.0, nan].into_iter()), 1.0);
        assert_eq!(greatest([2.0, nan, 3.0, nan, 1.0].into_iter()), 3.0);
        let zero = least([0.0, -0.0].into_iter());
        assert!(zero == 0.0 && zero.is_sign_positive(), "of equals the first");
        assert!(greatest([f64::NAN].into_iter()).is_nan());
    }
}
