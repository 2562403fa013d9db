//! Vectors and quaternions (x, y, z, w), by the very operations of the engine in their order.

use crate::code::{Expr, Helper, call};

/// The Euclidean norm, summed from the left.
pub(crate) fn norm(of: &[Expr]) -> Expr {
    let squares = of.iter().map(|x| x.clone().mul(x.clone()));
    call(Helper::Sqrt, vec![squares.reduce(|sum, x| sum + x).unwrap_or(Expr::Float(0.0))])
}

/// The inverse of a unit quaternion.
pub(crate) fn inverse([x, y, z, w]: [Expr; 4]) -> [Expr; 4] {
    let minus = |e: Expr| Expr::Neg(Box::new(e));
    [minus(x), minus(y), minus(z), w]
}

/// The Hamilton product of two quaternions.
pub(crate) fn product(a: &[Expr; 4], b: &[Expr; 4]) -> [Expr; 4] {
    let term = |i: usize, j: usize| a[i].clone().mul(b[j].clone());
    [
        term(3, 0) + term(0, 3) + term(1, 2) - term(2, 1),
        term(3, 1) - term(0, 2) + term(1, 3) + term(2, 0),
        term(3, 2) + term(0, 1) - term(1, 0) + term(2, 3),
        term(3, 3) - term(0, 0) - term(1, 1) - term(2, 2),
    ]
}

/// A vector turned by a quaternion. What it is made of several times is given to `name`, which may make it a variable.
pub(crate) fn rotated(of: &[Expr; 3], by: &[Expr; 4], mut name: impl FnMut(usize, Expr) -> Expr) -> [Expr; 3] {
    let axis = [0, 1, 2].map(|i| by[i].clone());
    let twice = [0, 1, 2].map(|i| name(i, Expr::Float(2.0).mul(cross(&axis, of, i))));
    [0, 1, 2].map(|i| of[i].clone() + by[3].clone().mul(twice[i].clone()) + cross(&axis, &twice, i))
}

/// A component of the cross product.
fn cross(a: &[Expr; 3], b: &[Expr; 3], i: usize) -> Expr {
    let (j, k) = ((i + 1) % 3, (i + 2) % 3);
    a[j].clone().mul(b[k].clone()) - a[k].clone().mul(b[j].clone())
}
